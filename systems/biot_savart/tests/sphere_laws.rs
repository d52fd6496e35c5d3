//! Sheets on a sphere against closed forms, and what energy and its gradient owe each other.
//!
//! A jump `Γ = φ_out - φ_in = Y_l` on the unit sphere moves it with `u_n = -l(l+1)/(2l+1) Y_l`. For l = 1, `Γ = z`, the sphere
//! moves as a whole: inside `u = -2/3 ẑ` and `A = -1/3 ẑ × x`, outside a dipole with `A = -1/3 ẑ × x/r³`.

mod common;

use common::{Sheet, relative_error};
use froth_biot_savart::{PairSum, PanelSums, SheetKernel, Summation};
use froth_surface::shapes::icosphere;
use glam::DVec3;
use proptest::prelude::*;

const EDGES: [f64; 3] = [0.3, 0.15, 0.075];

/// Smoothing length over edge length at which a wave as short as the lattice of panels is damped to below 1 % of a smooth one.
const WITHOUT_LATTICE: f64 = 1.25;

fn sphere(edge: f64, jump: impl Fn(DVec3) -> f64) -> Sheet {
    Sheet::new("sphere", edge, icosphere(DVec3::ZERO, 1.0, edge), jump)
}

/// Potentials at centroids with a smoothing length in edge lengths.
fn potentials(sheet: &Sheet, smoothing: f64) -> Vec<DVec3> {
    let kernel = SheetKernel::third_order(smoothing * sheet.edge);
    let mut pairs = PairSum::new(kernel, Summation::Direct).unwrap();
    pairs.place(&sheet.centres);
    let mut potentials = vec![];
    pairs.potentials(&sheet.strengths, &mut potentials).unwrap();
    potentials
}

/// Order of convergence over two halvings; the errors themselves for the message.
fn observed_order(errors: [f64; 3]) -> f64 {
    (errors[0] / errors[2]).log2() / 2.0
}

#[test]
fn a_moving_sphere_has_its_vector_potential() {
    let error = |edge, smoothing| {
        let sheet = sphere(edge, |x| x.z);
        let expected: Vec<DVec3> = sheet.centres.iter().map(|x| -DVec3::Z.cross(*x) / 3.0).collect();
        relative_error(&potentials(&sheet, smoothing), &expected)
    };
    let smooth = EDGES.map(|edge| error(edge, WITHOUT_LATTICE));
    assert!(smooth[2] < 2e-3 && observed_order(smooth) > 1.8, "{smooth:?}");
    // At 0.75 edge lengths the lattice of panels shows, a fraction of the edge length at every panel alike.
    let lattice = EDGES.map(|edge| error(edge, 0.75) / edge);
    assert!(lattice.iter().all(|share| *share < 0.06), "{lattice:?}");
}

#[test]
fn within_a_moving_sphere_air_moves_as_a_whole_and_outside_as_round_a_dipole() {
    let places: Vec<DVec3> = (0..20).map(|i| DVec3::new(0.02, 0.3, -0.5) * (0.1 * f64::from(i))).collect();
    let (inside, outside): (Vec<DVec3>, Vec<DVec3>) = places.into_iter().partition(|x| x.length() < 0.6);
    let outside: Vec<DVec3> = outside.into_iter().map(|x| x * 2.5).collect();
    let dipole = |x: &DVec3| {
        let (r, n) = (x.length(), x.normalize());
        -(3.0 * n.z * n - DVec3::Z) / (3.0 * r.powi(3))
    };
    let errors = EDGES.map(|edge| {
        let sheet = sphere(edge, |x| x.z);
        let mut pairs = sheet.sum(Summation::Direct);
        let (mut within, mut beyond) = (vec![], vec![]);
        pairs.velocities_at(&sheet.strengths, &inside, &mut within).unwrap();
        pairs.velocities_at(&sheet.strengths, &outside, &mut beyond).unwrap();
        let expected: Vec<DVec3> = outside.iter().map(dipole).collect();
        let rigid = vec![-2.0 / 3.0 * DVec3::Z; inside.len()];
        relative_error(&within, &rigid).max(relative_error(&beyond, &expected))
    });
    assert!(errors[2] < 5e-3 && observed_order(errors) > 1.8, "{errors:?}");
}

/// Real part of `(x + iy)^l`: a spherical harmonic on the unit sphere.
fn sectoral(x: DVec3, degree: i32) -> f64 {
    x.truncate().length().powi(degree) * (f64::from(degree) * x.y.atan2(x.x)).cos()
}

/// Relative error of the normal velocity, least squares over the sphere.
fn velocity_error(edge: f64, degree: i32, smoothing: f64) -> f64 {
    let sheet = sphere(edge, |x| sectoral(x, degree));
    let velocities = sheet.normal_velocities(&potentials(&sheet, smoothing));
    let waves: Vec<f64> = sheet.films.positions.iter().map(|x| sectoral(*x, degree)).collect();
    // Two regions: outside and the sphere's.
    let product: f64 = velocities.chunks(2).zip(&waves).map(|(u, y)| u[1] * y).sum();
    let l = f64::from(degree);
    product / waves.iter().map(|y| y * y).sum::<f64>() / (-l * (l + 1.0) / (2.0 * l + 1.0)) - 1.0
}

#[test]
fn waves_move_a_sphere_as_fast_as_they_should() {
    // Second order in the edge length times the degree, at the smoothing length in use.
    for degree in 2..=6 {
        let [coarse, fine] = [0.15, 0.075].map(|edge| velocity_error(edge, degree, 0.75));
        let allowed = 0.09 * (f64::from(degree) / 6.0).powi(2) + 3e-3;
        assert!(coarse.abs() < allowed && fine.abs() < 0.25 * allowed + 2e-3, "degree {degree}: {coarse} {fine}");
    }
}

#[test]
fn the_velocity_of_waves_converges_with_the_edge_length() {
    for degree in 2..=6 {
        let errors = [0.15, 0.075, 0.0375].map(|edge| velocity_error(edge, degree, WITHOUT_LATTICE).abs());
        assert!(observed_order(errors) > 1.8, "degree {degree}: {errors:?}");
    }
}

/// `K/ρ = ½ Σ G·A`.
fn energy(sheet: &Sheet, centres: &[DVec3], summation: Summation) -> f64 {
    let mut pairs = sheet.sum(summation);
    pairs.place(centres);
    let mut potentials = vec![];
    pairs.potentials(&sheet.strengths, &mut potentials).unwrap();
    0.5 * sheet.strengths.iter().zip(&potentials).map(|(g, a)| g.dot(*a)).sum::<f64>()
}

#[test]
fn the_energy_gradient_is_the_gradient_of_the_energy() {
    let sheet = sphere(0.1, |x| (3.0 * x.x + x.z).sin() + sectoral(x, 4));
    let shift = |x: &DVec3| DVec3::new((2.0 * x.y).sin(), x.x * x.z, (x.z + x.y).cos());
    let shifts: Vec<DVec3> = sheet.centres.iter().map(shift).collect();
    // The fast sum's energy jumps by its own error when a panel changes cells, so its slope is held against the direct sum's.
    for (summation, tolerance) in [(Summation::Direct, 1e-6), (Summation::Fast { tolerance: 1e-3 }, 2e-3)] {
        let mut sums = PanelSums::default();
        sheet.sum(summation).potentials_and_gradients(&sheet.strengths, &mut sums).unwrap();
        let slope: f64 = sums.energy_gradients.iter().zip(&shifts).map(|(s, d)| s.dot(*d)).sum();
        let h = 1e-4;
        let moved = |by: f64| -> Vec<DVec3> { sheet.centres.iter().zip(&shifts).map(|(x, d)| *x + by * *d).collect() };
        let [ahead, behind] = [h, -h].map(|by| energy(&sheet, &moved(by), Summation::Direct));
        let difference = (ahead - behind) / (2.0 * h);
        assert!((slope - difference).abs() < tolerance * difference.abs(), "{summation:?}: {slope} {difference}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn energy_is_positive_whatever_the_jump(seed in 0.0..1.0f64, fast in any::<bool>()) {
        let noise = |x: DVec3| (1e6 * (x.x + seed) + 7e5 * x.y + 3e5 * x.z).sin();
        let sheet = sphere(0.15, noise);
        let summation = if fast { Summation::Fast { tolerance: 1e-3 } } else { Summation::Direct };
        prop_assert!(energy(&sheet, &sheet.centres, summation) > 0.0);
    }
}

#[test]
fn velocity_is_the_curl_of_the_vector_potential() {
    let sheet = sphere(0.15, |x| sectoral(x, 3) + x.z);
    let mut pairs = sheet.sum(Summation::Direct);
    let (place, h) = (DVec3::new(0.5, -0.4, 0.3), 1e-4);
    let steps = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| [place + h * axis, place - h * axis]);
    let (mut at, mut velocity) = (vec![], vec![]);
    pairs.potentials_at(&sheet.strengths, steps.as_flattened(), &mut at).unwrap();
    pairs.velocities_at(&sheet.strengths, &[place], &mut velocity).unwrap();
    let [dx, dy, dz] = [0, 1, 2].map(|axis| (at[2 * axis] - at[2 * axis + 1]) / (2.0 * h));
    let curl = DVec3::new(dy.z - dz.y, dz.x - dx.z, dx.y - dy.x);
    assert!(velocity[0].distance(curl) < 1e-6 * curl.length(), "{} {curl}", velocity[0]);
}
