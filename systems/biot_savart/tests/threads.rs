//! The number of threads changes no bit of a sum.

mod common;

use common::Sheet;
use froth_biot_savart::{PanelSums, Summation};
use glam::DVec3;

fn all_sums(sheet: &Sheet, summation: Summation, threads: usize) -> (PanelSums, Vec<DVec3>) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let mut pairs = sheet.sum(summation);
        let (mut sums, mut velocities) = (PanelSums::default(), vec![]);
        pairs.potentials_and_gradients(&sheet.strengths, &mut sums).unwrap();
        pairs.velocities_at(&sheet.strengths, &sheet.films.positions, &mut velocities).unwrap();
        (sums, velocities)
    })
}

#[test]
fn one_two_and_three_threads_give_the_same_bytes() {
    let sheet = common::sphere(0.04);
    for summation in [Summation::Direct, Summation::Fast { tolerance: 1e-3 }] {
        let alone = all_sums(&sheet, summation, 1);
        for threads in [2, 3] {
            assert_eq!(all_sums(&sheet, summation, threads), alone, "{summation:?}, {threads} threads");
        }
    }
}
