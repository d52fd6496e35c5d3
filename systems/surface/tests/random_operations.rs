//! Whatever operations follow each other, on whatever foam: every invariant holds after each.

#![allow(clippy::print_stdout, reason = "counts are worth seeing")]

#[path = "common/random.rs"]
mod random;
#[path = "common/voxels.rs"]
mod voxels;

use froth_surface::Tracker;
use froth_surface::invariants::check_all;
use froth_surface::shapes::lattice;
use glam::DVec3;
use proptest::prelude::*;
use random::{Dice, Foam, KINDS, LOCAL, MIXED, small_foam, wild_motions};

/// Operations on a small foam, everything checked after each.
fn run(kind: usize, seed: u64, operations: u64) -> Foam {
    let mut dice = Dice::new(seed);
    let (set, edge) = small_foam(kind, &mut dice);
    let mut foam = Foam::new(&set, edge);
    if let Err(violation) = check_all(&foam.surface) {
        panic!("foam {kind} seed {seed}: {violation}");
    }
    for number in 1..=operations {
        if let Err(problem) = foam.operate(&mut dice, &MIXED, true) {
            panic!("foam {kind} seed {seed} operation {number}: {problem}\n{}", foam.history());
        }
    }
    foam
}

#[test]
fn everything_holds_after_every_operation_on_small_foams() {
    let mut done = [0; 7];
    for kind in 0..KINDS {
        for seed in 0..3 {
            let c = run(kind, seed, 300).counts;
            let counts = [c.splits, c.face_splits, c.collapses, c.separations, c.snaps, c.flips, c.bursts];
            done.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
        }
    }
    println!("splits, face splits, collapses, separations, snaps, flips, bursts: {done:?}");
    assert!(done.iter().all(|count| *count > 10), "every operation is among them: {done:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn everything_holds_after_every_operation(kind in 0..KINDS, seed in any::<u64>(), operations in 1..150_u64) {
        run(kind, seed, operations);
    }
}

#[test]
fn two_thousand_operations_on_fifty_bubbles_leave_everything_in_order() {
    let mut dice = Dice::new(1);
    let mut foam = Foam::new(&lattice(DVec3::ZERO, [5, 5, 2], 1.0, 0.5), 0.5);
    for number in 1..=2000 {
        if let Err(problem) = foam.operate(&mut dice, &LOCAL, number % 500 == 0) {
            panic!("seed 1 operation {number}: {problem}\n{}", foam.history());
        }
    }
    println!("{} bubbles, {} faces, {:?}", foam.bubbles(), foam.surface.mesh.face_count(), foam.counts);
}

#[test]
fn random_motions_of_three_edge_lengths_never_make_films_cross() {
    let mut dice = Dice::new(7);
    let mut foam = Foam::new(&lattice(DVec3::ZERO, [2, 2, 2], 1.0, 0.5), 0.5);
    let limited = wild_motions(&mut foam, &mut Tracker::default(), &mut dice, 25).unwrap();
    println!("{:.0} % of vertices limited", 100.0 * limited);
}
