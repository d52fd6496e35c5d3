//! The direct sum against the plainest program for the same formula; input that is small, doubled, far off or wrong.

use froth_biot_savart::{
    Accuracy, Instructions, KernelOrder, PairSum, PairSumError, PanelSums, SheetKernel, Summation,
};
use glam::DVec3;
use proptest::prelude::*;

const ORDERS: [KernelOrder; 3] = [KernelOrder::First, KernelOrder::Second, KernelOrder::Third];

const FOUR_PI: f64 = 4.0 * std::f64::consts::PI;

/// Every way to sum, the fast ones as fine as they can.
const SUMMATIONS: [Summation; 3] = [
    Summation::Direct,
    Summation::Fast { tolerance: 1e-6 },
    Summation::Expansions(Accuracy { order: 8, opening: 0.3 }),
];

#[derive(Clone, Debug)]
struct Panels {
    centres: Vec<DVec3>,
    strengths: Vec<DVec3>,
}

/// Some panels in a box of size 2; the smoothing length suits about a tenth of that.
fn panels(most: usize) -> impl Strategy<Value = Panels> {
    let vector = || prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from);
    prop::collection::vec((vector(), vector()), 0..most).prop_map(|panels| {
        let (centres, strengths) = panels.into_iter().unzip();
        Panels { centres, strengths }
    })
}

fn plain_potential(kernel: &SheetKernel, panels: &Panels, at: DVec3) -> DVec3 {
    let parts =
        panels.centres.iter().zip(&panels.strengths).map(|(c, g)| *g * kernel.potential(at.distance_squared(*c)));
    parts.sum::<DVec3>() / FOUR_PI
}

fn plain_gradient(kernel: &SheetKernel, panels: &Panels, at: DVec3, strength: DVec3) -> DVec3 {
    let parts = panels.centres.iter().zip(&panels.strengths).map(|(c, g)| {
        let d = at - *c;
        -strength.dot(*g) * kernel.velocity(d.length_squared()) * d
    });
    parts.sum::<DVec3>() / FOUR_PI
}

fn plain_velocity(kernel: &SheetKernel, panels: &Panels, at: DVec3) -> DVec3 {
    let parts = panels.centres.iter().zip(&panels.strengths).map(|(c, g)| {
        let d = at - *c;
        g.cross(d) * kernel.velocity(d.length_squared())
    });
    parts.sum::<DVec3>() / FOUR_PI
}

fn sums(kernel: SheetKernel, summation: Summation, instructions: Instructions, panels: &Panels) -> PanelSums {
    let mut pairs = PairSum::new(kernel, summation).unwrap().with_instructions(instructions);
    pairs.place(&panels.centres);
    let mut sums = PanelSums::default();
    pairs.potentials_and_gradients(&panels.strengths, &mut sums).unwrap();
    let mut alone = vec![];
    pairs.potentials(&panels.strengths, &mut alone).unwrap();
    assert!(close(&alone, &sums.potentials, 1e-14), "potentials with and without gradients");
    sums
}

/// Whether vectors agree to a fraction of the longest.
fn close(found: &[DVec3], expected: &[DVec3], relative: f64) -> bool {
    let size = expected.iter().map(|x| x.length()).fold(0.0, f64::max);
    found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| a.distance(*b) <= relative * size)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn the_direct_sum_is_the_plain_sum(panels in panels(700), alpha in 0.05..0.5f64) {
        for order in ORDERS {
            let kernel = SheetKernel { order, smoothing_length: alpha };
            let at = |f: &dyn Fn(DVec3, DVec3) -> DVec3| -> Vec<DVec3> {
                panels.centres.iter().zip(&panels.strengths).map(|(c, g)| f(*c, *g)).collect()
            };
            let potentials = at(&|c, _| plain_potential(&kernel, &panels, c));
            let gradients = at(&|c, g| plain_gradient(&kernel, &panels, c, g));
            for instructions in [Instructions::Widest, Instructions::Scalar] {
                let found = sums(kernel, Summation::Direct, instructions, &panels);
                prop_assert!(close(&found.potentials, &potentials, 1e-12), "{kernel:?} {instructions:?}");
                prop_assert!(close(&found.energy_gradients, &gradients, 1e-12), "{kernel:?} {instructions:?}");
            }
        }
    }

    #[test]
    fn vector_instructions_give_the_scalar_result(panels in panels(500)) {
        let kernel = SheetKernel::third_order(0.1);
        for summation in SUMMATIONS {
            let [widest, scalar] = [Instructions::Widest, Instructions::Scalar]
                .map(|instructions| sums(kernel, summation, instructions, &panels));
            prop_assert!(close(&widest.potentials, &scalar.potentials, 1e-12), "{summation:?}");
            prop_assert!(close(&widest.energy_gradients, &scalar.energy_gradients, 1e-12), "{summation:?}");
        }
    }

    #[test]
    fn fine_expansions_of_every_kernel_are_the_plain_sum(panels in panels(700)) {
        for order in ORDERS {
            let kernel = SheetKernel { order, smoothing_length: 0.1 };
            let direct = sums(kernel, Summation::Direct, Instructions::Widest, &panels);
            let fast = sums(kernel, SUMMATIONS[2], Instructions::Widest, &panels);
            prop_assert!(close(&fast.potentials, &direct.potentials, 1e-6));
            prop_assert!(close(&fast.energy_gradients, &direct.energy_gradients, 1e-5));
        }
    }

    #[test]
    fn anywhere_in_space_potentials_and_velocities_are_the_plain_sums(panels in panels(400), places in panels(200)) {
        for (summation, error) in SUMMATIONS.into_iter().zip([1e-12, 1e-5, 1e-5]) {
            let kernel = SheetKernel::third_order(0.1);
            let mut pairs = PairSum::new(kernel, summation).unwrap();
            pairs.place(&panels.centres);
            let mut found = vec![];
            pairs.potentials_at(&panels.strengths, &places.centres, &mut found).unwrap();
            let expected: Vec<_> = places.centres.iter().map(|x| plain_potential(&kernel, &panels, *x)).collect();
            prop_assert!(close(&found, &expected, error), "{summation:?}");
            pairs.velocities_at(&panels.strengths, &places.centres, &mut found).unwrap();
            let expected: Vec<_> = places.centres.iter().map(|x| plain_velocity(&kernel, &panels, *x)).collect();
            prop_assert!(close(&found, &expected, error), "{summation:?}");
        }
    }

    #[test]
    fn all_is_the_same_at_every_scale(panels in panels(300), exponent in -20..=20i32) {
        // Powers of two: scaling by them is exact.
        let scale = 2f64.powi(exponent);
        let scaled = Panels { centres: panels.centres.iter().map(|x| *x * scale).collect(), ..panels.clone() };
        for summation in SUMMATIONS {
            let one = sums(SheetKernel::third_order(0.125), summation, Instructions::Widest, &panels);
            let other = sums(SheetKernel::third_order(0.125 * scale), summation, Instructions::Widest, &scaled);
            let potentials: Vec<_> = other.potentials.iter().map(|a| *a * scale).collect();
            let gradients: Vec<_> = other.energy_gradients.iter().map(|s| *s * scale * scale).collect();
            prop_assert_eq!(&potentials, &one.potentials);
            prop_assert_eq!(&gradients, &one.energy_gradients);
        }
    }
}

#[test]
fn no_panels_have_no_sums() {
    for summation in SUMMATIONS {
        let none = Panels { centres: vec![], strengths: vec![] };
        assert_eq!(sums(SheetKernel::third_order(1.0), summation, Instructions::Widest, &none), PanelSums::default());
        let mut pairs = PairSum::new(SheetKernel::third_order(1.0), summation).unwrap();
        pairs.place(&[]);
        let mut velocities = vec![];
        pairs.velocities_at(&[], &[DVec3::ONE], &mut velocities).unwrap();
        assert_eq!(velocities, [DVec3::ZERO]);
    }
}

#[test]
fn one_panel_sees_itself() {
    for summation in SUMMATIONS {
        let kernel = SheetKernel::third_order(0.25);
        let one = Panels { centres: vec![DVec3::new(3.0, -2.0, 1.0)], strengths: vec![DVec3::Z] };
        let found = sums(kernel, summation, Instructions::Widest, &one);
        assert!(close(&found.potentials, &[DVec3::Z * kernel.potential(0.0) / FOUR_PI], 1e-14));
        assert_eq!(found.energy_gradients, [DVec3::ZERO]);
    }
}

#[test]
fn a_thousand_panels_at_one_place_act_as_one() {
    for summation in SUMMATIONS {
        let kernel = SheetKernel::third_order(0.25);
        let heap = Panels { centres: vec![DVec3::ONE; 1000], strengths: vec![DVec3::Z; 1000] };
        let found = sums(kernel, summation, Instructions::Widest, &heap);
        assert!(close(&found.potentials, &[DVec3::Z * kernel.potential(0.0) * 1000.0 / FOUR_PI; 1000], 1e-13));
        assert!(found.energy_gradients.iter().all(|s| *s == DVec3::ZERO));
    }
}

#[test]
fn two_heaps_far_apart_act_as_two_points() {
    for summation in SUMMATIONS {
        let kernel = SheetKernel::third_order(1e-3);
        let centres = (0..600).map(|i| if i % 2 == 0 { DVec3::ZERO } else { DVec3::X }).collect();
        let heaps = Panels { centres, strengths: vec![DVec3::Z; 600] };
        let found = sums(kernel, summation, Instructions::Widest, &heaps);
        let expected = 300.0 * (kernel.potential(0.0) + kernel.potential(1.0)) / FOUR_PI;
        assert!(close(&found.potentials, &[DVec3::Z * expected; 600], 1e-13));
        let push = 300.0 * kernel.velocity(1.0) / FOUR_PI;
        assert!((found.energy_gradients[0].x - push).abs() < 1e-12 * push);
    }
}

#[test]
fn numbers_that_are_not_finite_spoil_sums_and_nothing_else() {
    for summation in SUMMATIONS {
        for bad in [f64::NAN, f64::INFINITY] {
            let mut centres: Vec<DVec3> = (0..200).map(|i| DVec3::splat(f64::from(i))).collect();
            centres[77].y = bad;
            let mut pairs = PairSum::new(SheetKernel::third_order(1.0), summation).unwrap();
            pairs.place(&centres);
            let mut potentials = vec![];
            pairs.potentials(&[DVec3::ONE; 200], &mut potentials).unwrap();
            assert!(potentials.iter().any(|a| !a.is_finite()), "{summation:?} {bad}");
        }
    }
}

#[test]
fn a_strength_too_few_is_an_error_and_leaves_the_sum_usable() {
    let mut pairs = PairSum::new(SheetKernel::third_order(1.0), Summation::Direct).unwrap();
    pairs.place(&[DVec3::ZERO, DVec3::X]);
    let mut out = vec![];
    let wrong = PairSumError::StrengthCount { panels: 2, strengths: 1 };
    assert_eq!(pairs.potentials(&[DVec3::Z], &mut out), Err(wrong));
    assert_eq!(pairs.velocities_at(&[DVec3::Z], &[], &mut out), Err(wrong));
    assert_eq!(pairs.potentials(&[DVec3::Z; 2], &mut out), Ok(()));
}

#[test]
fn settings_that_cannot_work_are_refused() {
    let flat = SheetKernel::third_order(0.0);
    assert!(matches!(PairSum::new(flat, Summation::Direct), Err(PairSumError::SmoothingLength { .. })));
    let sound = SheetKernel::third_order(1.0);
    for summation in [Summation::Fast { tolerance: 0.0 }, Summation::Auto { tolerance: 1e-12 }] {
        assert!(matches!(PairSum::new(sound, summation), Err(PairSumError::Tolerance { .. })));
    }
    let wild = Summation::Expansions(Accuracy { order: 99, opening: 0.5 });
    assert!(matches!(PairSum::new(sound, wild), Err(PairSumError::Accuracy { .. })));
}
