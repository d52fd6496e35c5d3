//! The fast sum keeps the bound that it was given, on sheets of every kind, and what is exact in the direct sum stays exact.

mod common;

use common::{Sheet, relative_error, relative_error_of_numbers, sheets, sphere, waves};
use froth_biot_savart::{KernelOrder, PairSum, PanelSums, SheetKernel, Summation};
use froth_surface::shapes::icosphere;
use glam::DVec3;

fn sums(sheet: &Sheet, kernel: SheetKernel, summation: Summation) -> PanelSums {
    let mut pairs = PairSum::new(kernel, summation).unwrap();
    pairs.place(&sheet.centres);
    let mut sums = PanelSums::default();
    pairs.potentials_and_gradients(&sheet.strengths, &mut sums).unwrap();
    sums
}

/// Relative error of normal velocities over the bound.
fn error_over_bound(sheet: &Sheet, kernel: SheetKernel, direct: &PanelSums, tolerance: f64) -> f64 {
    let fast = sums(sheet, kernel, Summation::Fast { tolerance });
    let velocities = |sums: &PanelSums| sheet.normal_velocities(&sums.potentials);
    let error = relative_error_of_numbers(&velocities(&fast), &velocities(direct));
    let gradients = relative_error(&fast.energy_gradients, &direct.energy_gradients);
    // Energy gradients carry no bound, but should not be much worse.
    assert!(gradients < 3.0 * tolerance, "{}: gradients {gradients} at {tolerance}", sheet.name);
    error / tolerance
}

fn assert_bounds(sheet: &Sheet, kernel: SheetKernel, tolerances: &[f64]) {
    let direct = sums(sheet, kernel, Summation::Direct);
    for tolerance in tolerances {
        let used = error_over_bound(sheet, kernel, &direct, *tolerance);
        assert!(used < 1.0, "{} of {} panels at {tolerance}: {used}", sheet.name, sheet.centres.len());
    }
}

#[test]
fn normal_velocities_keep_their_bound_on_sheets_of_every_kind() {
    for edge in [0.16, 0.08] {
        for sheet in sheets(edge) {
            assert_bounds(&sheet, sheet.kernel(), &[1e-2, 1e-3, 1e-4, 1e-5, 1e-6]);
        }
    }
}

#[test]
fn the_bound_holds_as_panels_grow_in_number() {
    let sheet = sphere(0.025);
    assert_bounds(&sheet, sheet.kernel(), &[1e-2, 1e-3, 1e-4]);
}

#[test]
fn the_bound_holds_for_every_kernel_and_smoothing_length() {
    let edge = 0.06;
    let sheet = sphere(edge);
    for order in [KernelOrder::First, KernelOrder::Second, KernelOrder::Third] {
        for factor in [0.25, 0.5, 1.0, 2.0] {
            assert_bounds(&sheet, SheetKernel { order, smoothing_length: factor * edge }, &[1e-3, 1e-4]);
        }
    }
}

#[test]
fn the_bound_holds_for_strengths_without_any_pattern() {
    let edge = 0.06;
    let noise = |x: DVec3| (1e6 * x.x + 7e5 * x.y + 3e5 * x.z).sin();
    let sheet = Sheet::new("noise", edge, icosphere(DVec3::ZERO, 1.0, edge), noise);
    assert_bounds(&sheet, sheet.kernel(), &[1e-2, 1e-3, 1e-4]);
}

#[test]
fn the_bound_holds_for_small_bubbles_beside_large_ones() {
    let mut films = icosphere(DVec3::ZERO, 1.0, 0.08);
    films.append(&icosphere(DVec3::new(1.05, 0.3, 0.1), 0.09, 0.005));
    let sheet = Sheet::new("small and large", 0.08, films, |x| waves(x) + 0.1 * (50.0 * x.y).sin());
    for smoothing_length in [0.005, 0.06] {
        assert_bounds(&sheet, SheetKernel::third_order(smoothing_length), &[1e-2, 1e-3, 1e-4]);
    }
}

#[test]
fn the_matrix_of_the_fast_sum_is_symmetric() {
    let edge = 0.06;
    let sheet = sphere(edge);
    let other = Sheet::new("other", edge, sheet.films.clone(), |x| (3.0 * x.x + x.z).sin() + waves(x));
    for summation in [Summation::Direct, Summation::Fast { tolerance: 1e-2 }] {
        let mut pairs = sheet.sum(summation);
        let mut product = |strengths: &[DVec3], with: &[DVec3]| -> f64 {
            let mut potentials = vec![];
            pairs.potentials(strengths, &mut potentials).unwrap();
            with.iter().zip(&potentials).map(|(g, a)| g.dot(*a)).sum()
        };
        let (there, back) = (product(&sheet.strengths, &other.strengths), product(&other.strengths, &sheet.strengths));
        let size = product(&sheet.strengths, &sheet.strengths);
        assert!((there - back).abs() < 1e-13 * size, "{summation:?}: {there} {back}");
    }
}

#[test]
fn energy_gradients_add_up_to_nothing() {
    // Pairs push each other apart or together with equal force: expansions depend on differences of places only.
    let sheet = &sheets(0.1)[1];
    for summation in [Summation::Direct, Summation::Fast { tolerance: 1e-2 }] {
        let gradients = sums(sheet, sheet.kernel(), summation).energy_gradients;
        let size: f64 = gradients.iter().map(|s| s.length()).sum();
        assert!(gradients.iter().sum::<DVec3>().length() < 1e-13 * size, "{summation:?}");
    }
}

#[test]
fn auto_sums_few_panels_directly_and_many_fast() {
    for (edge, like) in [(0.2, Summation::Direct), (0.06, Summation::Fast { tolerance: 1e-3 })] {
        let sheet = sphere(edge);
        let auto = sums(&sheet, sheet.kernel(), Summation::Auto { tolerance: 1e-3 });
        assert_eq!(auto, sums(&sheet, sheet.kernel(), like));
    }
}
