//! Many random operations on a foam of fifty bubbles, and many wild motions, with the invariants looked at all along.
//!
//! ```text
//! cargo run --release -p froth_surface --example soak -- 100000 1
//! ```
//!
//! Arguments: operations (default 100000), seed (default 1), motions of 3 `L` (default 100). After every operation the invariants
//! around it are checked, after every 500th all of them; after every motion, and the remeshing pass that follows it, all of them.
//! A foam of which more than half the bubbles are gone, or that operations have filled with faces, is built anew. Where an invariant
//! does not hold, seed and number of the operation are printed, and the operations before it are written to `soak-<seed>.log`: the
//! same arguments fail in the same way.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program prints")]

#[path = "../tests/common/random.rs"]
mod random;
#[path = "../tests/common/voxels.rs"]
mod voxels;

use std::process::ExitCode;
use std::time::Instant;

use froth_surface::Tracker;
use froth_surface::shapes::lattice;
use glam::DVec3;
use random::{Dice, Foam, LOCAL, wild_motions};

/// Bubbles below which the foam is built anew.
const FEWEST_BUBBLES: usize = 25;
/// Faces above which the foam is built anew: some five times those at the start.
const MOST_FACES: usize = 10_000;

/// What failed, at which number, and the foam in which it did.
struct Failure {
    number: u64,
    problem: String,
    foam: Box<Foam>,
}

fn main() -> ExitCode {
    let argument = |place: usize, usual: u64| std::env::args().nth(place).and_then(|s| s.parse().ok()).unwrap_or(usual);
    let (operations, seed, motions) = (argument(1, 100_000), argument(2, 1), argument(3, 100));
    let mut dice = Dice::new(seed);
    match run_operations(operations, &mut dice).and_then(|()| run_motions(motions, &mut dice)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => report(seed, &failure),
    }
}

fn run_operations(operations: u64, dice: &mut Dice) -> Result<(), Failure> {
    let (mut foam, mut rebuilt, begun) = (fifty_bubbles(), 0, Instant::now());
    for number in 1..=operations {
        if let Err(problem) = foam.operate(dice, &LOCAL, number % 500 == 0) {
            return Err(Failure { number, problem, foam: Box::new(foam) });
        }
        rebuilt += u32::from(build_anew_if_spent(&mut foam));
        if number % 10_000 == 0 {
            print_state(&format!("{number} operations"), begun, &foam);
            println!("  {:?}", foam.counts);
        }
    }
    println!("{operations} operations, foam built anew {rebuilt} times: every invariant held");
    Ok(())
}

fn run_motions(motions: u64, dice: &mut Dice) -> Result<(), Failure> {
    let (mut foam, mut rebuilt, begun) = (fifty_bubbles(), 0, Instant::now());
    let (mut tracker, mut limited) = (Tracker::default(), 0.0);
    for number in 1..=motions {
        match wild_motions(&mut foam, &mut tracker, dice, 1) {
            Ok(part) => limited += part / motions as f64,
            Err(problem) => return Err(Failure { number, problem, foam: Box::new(foam) }),
        }
        if build_anew_if_spent(&mut foam) {
            (tracker, rebuilt) = (Tracker::default(), rebuilt + 1);
        }
        if number % 10 == 0 {
            print_state(&format!("{number} motions"), begun, &foam);
        }
    }
    let limited = 100.0 * limited;
    println!(
        "{motions} motions of 3 L, foam built anew {rebuilt} times: no crossing; {limited:.1} % of vertices limited"
    );
    Ok(())
}

fn fifty_bubbles() -> Foam {
    Foam::new(&lattice(DVec3::ZERO, [5, 5, 2], 1.0, 0.5), 0.5)
}

/// Puts fifty new bubbles in place of a foam that has too few, or too many faces; whether it did.
fn build_anew_if_spent(foam: &mut Foam) -> bool {
    let is_spent = foam.bubbles() < FEWEST_BUBBLES || foam.surface.mesh.face_count() > MOST_FACES;
    if is_spent {
        *foam = Foam { counts: foam.counts, number: foam.number, ..fifty_bubbles() };
    }
    is_spent
}

fn print_state(done: &str, begun: Instant, foam: &Foam) {
    let (faces, seconds) = (foam.surface.mesh.face_count(), begun.elapsed().as_secs_f64());
    println!("{done}: {seconds:.0} s, {} bubbles, {faces} faces", foam.bubbles());
}

fn report(seed: u64, failure: &Failure) -> ExitCode {
    let path = format!("soak-{seed}.log");
    let last = format!("seed {seed}, number {}: {}", failure.number, failure.problem);
    eprintln!("{last}");
    match std::fs::write(&path, format!("{}{last}\n", failure.foam.history())) {
        Ok(()) => eprintln!("the operations before it are in {path}"),
        Err(error) => eprintln!("{path} could not be written: {error}"),
    }
    ExitCode::FAILURE
}
