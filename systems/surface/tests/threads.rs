//! The number of threads changes no bit of a run.

mod common;

use common::Films;
use froth_surface::shapes::lattice;
use froth_surface::{Face, Region, Surface};
use glam::DVec3;

/// Everything that a run goes on from.
#[derive(Debug, PartialEq)]
struct State {
    faces: Vec<Face>,
    numbers: Vec<[u64; 3]>,
    gas: Vec<(Region, u64)>,
}

fn bits(x: &DVec3) -> [u64; 3] {
    x.to_array().map(f64::to_bits)
}

fn state_of(films: &Films) -> State {
    let Surface { mesh, positions, .. } = &films.surface;
    let (pressures, targets) = (&films.state.pressures, &films.state.target_volumes);
    State {
        faces: mesh.faces().map(|(_, face)| *face).collect(),
        numbers: positions.iter().chain(films.state.velocities.iter()).map(bits).collect(),
        gas: pressures.iter().chain(targets).map(|(region, value)| (*region, value.to_bits())).collect(),
    }
}

/// A foam of cells that come apart where four of them meet, fine enough for every stage to share its work out.
fn run_on(threads: usize, steps: usize) -> (State, usize) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let mut films = Films::new(&lattice(DVec3::ZERO, [3; 3], 1.4, 0.35), 0.35, 0.005);
        (0..steps).for_each(|_| films.step(|_, _| ()));
        (state_of(&films), films.events.len())
    })
}

#[test]
fn one_two_and_three_threads_give_the_same_bytes_over_fifty_steps_of_a_foam() {
    let (alone, events) = run_on(1, 50);
    assert!(events > 50, "the foam rearranges: {events} events");
    for threads in [2, 3] {
        assert_eq!(run_on(threads, 50).0, alone, "{threads} threads");
    }
}
