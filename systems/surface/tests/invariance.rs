//! Neither the unit of length nor the place, the direction and the way faces are written decide anything.

#[path = "common/random.rs"]
mod random;
#[path = "common/voxels.rs"]
mod voxels;

use froth_surface::invariants::check_all;
use froth_surface::motion::{MotionSettings, advance};
use froth_surface::shapes::{kelvin_cells, lattice};
use froth_surface::transfer::NoData;
use froth_surface::{Face, LabelledTriangles, Policy, Region, Surface, Tracker, VertexRow};
use glam::{DMat3, DQuat, DVec3};
use random::Dice;

/// What is left of a run: faces, places, and the operations of each step.
#[derive(Debug, PartialEq)]
struct Outcome {
    faces: Vec<Face>,
    positions: Vec<DVec3>,
    operations: Vec<String>,
}

/// Steps of remeshing and of motion towards the middle of the neighbours, in films mapped by `map` with edges of `edge`.
fn run(set: &LabelledTriangles, edge: f64, map: impl Fn(DVec3) -> DVec3, steps: usize) -> Outcome {
    let mut surface = Surface::from_triangles(set);
    surface.positions.iter_mut().for_each(|x| *x = map(*x));
    let (mut tracker, policy) = (Tracker::default(), Policy { flips: true, snap: 0.2, ..Policy::new(edge) });
    let mut operations = Vec::new();
    for _ in 0..steps {
        let done = tracker.remesh(&mut surface, &policy, &mut NoData);
        let kinds: Vec<_> = done.events.iter().map(|event| (event.kind, event.regions.clone())).collect();
        operations.push(format!("{:?} {kinds:?}", done.counts));
        let towards = |v: VertexRow| {
            let neighbours = surface.mesh.neighbours(v);
            let middle = neighbours.iter().map(|w| surface.positions[*w]).sum::<DVec3>() / neighbours.len() as f64;
            surface.positions[v].lerp(middle, 0.25)
        };
        let proposed: Vec<DVec3> = (0..surface.positions.len() as u32).map(|v| towards(VertexRow(v))).collect();
        let _ = advance(&mut surface, &proposed, &MotionSettings::new(edge));
    }
    check_all(&surface).unwrap();
    let faces = surface.mesh.faces().map(|(_, face)| *face).collect();
    Outcome { faces, positions: surface.positions.0, operations }
}

/// Foams without symmetry: every place is shaken a little.
fn foams() -> [(LabelledTriangles, f64); 2] {
    let mut dice = Dice::new(11);
    let mut foams = [(lattice(DVec3::ZERO, [2, 2, 2], 1.0, 0.5), 0.5), (kelvin_cells(DVec3::ZERO, 1.5, 2, 0.5), 0.5)];
    for (set, edge) in &mut foams {
        set.positions.iter_mut().for_each(|x| *x += 0.02 * *edge * dice.vector());
    }
    foams
}

#[test]
fn powers_of_two_change_no_bit_of_the_outcome() {
    for (set, edge) in foams() {
        let unit = run(&set, edge, |x| x, 20);
        assert_ne!(unit.faces.len(), set.triangles.len(), "something happens");
        for factor in [2f64.powi(-10), 0.5, 4.0, 2f64.powi(10), 2f64.powi(20)] {
            let scaled = run(&set, factor * edge, |x| factor * x, 20);
            assert_eq!(scaled.operations, unit.operations, "factor {factor}");
            assert_eq!(scaled.faces, unit.faces);
            let back: Vec<DVec3> = scaled.positions.iter().map(|x| *x / factor).collect();
            assert_eq!(back, unit.positions);
        }
    }
}

#[test]
fn other_units_of_length_change_no_decision() {
    for (set, edge) in foams() {
        let unit = run(&set, edge, |x| x, 20);
        for factor in [1e-3, 0.7, 3.3, 1e3] {
            let scaled = run(&set, factor * edge, |x| factor * x, 20);
            assert_same_steps(&scaled, &unit);
        }
    }
}

/// The same operations in every step, and the same faces at the end.
fn assert_same_steps(found: &Outcome, wanted: &Outcome) {
    for (step, (one, other)) in found.operations.iter().zip(&wanted.operations).enumerate() {
        assert_eq!(one, other, "step {step}");
    }
    assert_eq!(found.faces, wanted.faces);
}

#[test]
fn turning_and_moving_all_films_changes_no_decision() {
    for (set, edge) in foams() {
        let unit = run(&set, edge, |x| x, 20);
        let turns = [DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 2.0), DQuat::from_rotation_y(2.7)];
        for turn in turns {
            let matrix = DMat3::from_quat(turn);
            let turned = run(&set, edge, |x| matrix * x + DVec3::new(3.0, -7.0, 0.4), 20);
            assert_same_steps(&turned, &unit);
            let off = turned.positions.iter().zip(&unit.positions);
            let farthest = off.map(|(x, y)| x.distance(matrix * *y + DVec3::new(3.0, -7.0, 0.4))).fold(0.0, f64::max);
            assert!(farthest < 1e-6 * edge, "{farthest}");
        }
    }
}

#[test]
fn the_winding_in_which_faces_are_written_changes_nothing() {
    let mut dice = Dice::new(2);
    for (set, edge) in foams() {
        let mut turned = set.clone();
        for (triangle, labels) in turned.triangles.iter_mut().zip(&mut turned.labels) {
            triangle.rotate_left(dice.below(3));
            if dice.below(2) == 0 {
                triangle.swap(0, 1);
                labels.swap(0, 1);
            }
        }
        assert_ne!(turned, set);
        assert_eq!(run(&turned, edge, |x| x, 20), run(&set, edge, |x| x, 20));
    }
}

#[test]
fn the_same_films_have_the_same_fate_on_any_number_of_threads() {
    let (set, edge) = foams()[0].clone();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&set, edge, |x| x, 10))
    };
    assert_eq!(on(1), on(3));
    assert!(on(1).faces.iter().all(|face| face.labels()[0] != face.labels()[1] && face.labels()[0] < Region(99)));
}
