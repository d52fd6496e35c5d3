//! Waves about a sphere at rest neither grow nor decay, on any mesh: the linear operator has real, positive squares of frequencies.
//!
//! At rest, with displacements `xi` measured by the volumes that they sweep (`x = N xi / |N|^2`), the linear system is
//! `d xi/dt = B Gamma`, `dGamma/dt = -H xi / rho`: `B` from circulations to fluxes is the kinetic energy's matrix, `H` from displacements to
//! pressures the second variation of `T A - p V`. Where both are symmetric and `B` is positive, `B H` has real eigenvalues
//! `omega^2`; a mode grows at the rate `sqrt(-omega^2)`.

#![allow(clippy::needless_range_loop, reason = "matrices are read by row and column")]

mod common;

use common::spheres::{even_sphere, exact_frequency, uneven_sphere};
use common::{Film, Settings, report};
use froth_sheet::Sliding;
use froth_surface::LabelledTriangles;
use froth_surface::shapes::random::Random;
use glam::DVec3;

/// Displacements for differences, R = 1.
const DIFFERENCE: f64 = 1e-4;

/// A square matrix, row by row.
type Matrix = Vec<Vec<f64>>;

/// A sphere whose mesh has come to rest: the least area of its volume.
fn at_rest(set: &LabelledTriangles) -> Film {
    let settings = Settings { sliding: Sliding::everywhere(0.1), ..Settings::default() };
    let mut film = Film::new(set, settings);
    for _ in 0..1000 {
        let dt = film.capillary_step(0.4);
        film.step(dt);
        film.state.potentials.iter_mut().for_each(|phi| *phi *= (-12.0 * dt).exp());
    }
    film.settings.sliding = Sliding::NONE;
    film
}

/// What the bubble has more than the outside, per vertex.
fn jumps(film: &Film, sides: &[f64]) -> Vec<f64> {
    let starts = (0..film.state.positions.len()).map(|v| film.sheet.layout.sides_of(v).start);
    starts.map(|start| sides[start + 1] - sides[start]).collect()
}

/// Volume gradients of the bubble, per vertex.
fn gradients(film: &Film) -> Vec<DVec3> {
    let starts = (0..film.state.positions.len()).map(|v| film.sheet.layout.sides_of(v).start);
    starts.map(|start| film.sheet.geometry.gradients[start + 1]).collect()
}

/// `B`, by columns: volumes per second that a unit of the bubble's potential at one vertex sweeps at all.
fn flux_matrix(film: &mut Film) -> Matrix {
    let normals = gradients(film);
    let column = |v: usize| {
        film.state.potentials.iter_mut().for_each(|phi| *phi = 0.0);
        film.state.potentials[film.sheet.layout.sides_of(v).start + 1] = 1.0;
        film.evaluate(1.0);
        normals.iter().zip(&film.sheet.velocities).map(|(n, w)| n.dot(*w)).collect()
    };
    (0..normals.len()).map(column).collect()
}

/// `H`, by columns and central differences: pressures by which the film at all vertices answers to a volume swept at one.
fn tension_matrix(film: &mut Film) -> Matrix {
    film.state.potentials.iter_mut().for_each(|phi| *phi = 0.0);
    let (normals, rest) = (gradients(film), film.state.positions.clone());
    let column = |v: usize| {
        let way = normals[v].normalize() * DIFFERENCE;
        let mut pressures = [way, -way].map(|way| {
            film.state.positions.clone_from(&rest);
            film.state.positions[v] += way;
            film.evaluate(1.0);
            jumps(film, &film.sheet.pressures)
        });
        let swept = 2.0 * DIFFERENCE * normals[v].length();
        let [plus, minus] = &mut pressures;
        plus.iter().zip(minus).map(|(plus, minus)| (plus - *minus) / swept).collect()
    };
    let columns = (0..normals.len()).map(column).collect();
    film.state.positions = rest;
    columns
}

/// Largest difference of a matrix from its transpose over its largest entry; the matrix becomes the mean of both.
fn symmetrise(matrix: &mut Matrix) -> f64 {
    let (mut largest, mut worst) = (0.0f64, 0.0f64);
    for i in 0..matrix.len() {
        for j in 0..=i {
            let (a, b) = (matrix[i][j], matrix[j][i]);
            largest = largest.max(a.abs());
            worst = worst.max((a - b).abs());
            (matrix[i][j], matrix[j][i]) = (0.5 * (a + b), 0.5 * (a + b));
        }
    }
    worst / largest
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let entry = |i: usize, j: usize| (0..b.len()).map(|k| a[i][k] * b[k][j]).sum();
    (0..a.len()).map(|i| (0..b.len()).map(|j| entry(i, j)).collect()).collect()
}

/// Eigenvalues of a symmetric matrix, and its eigenvectors as rows: cyclic Jacobi rotations.
fn eigen(mut a: Matrix) -> (Vec<f64>, Matrix) {
    let count = a.len();
    let mut vectors: Matrix = (0..count).map(|i| (0..count).map(|j| f64::from(i == j)).collect()).collect();
    for _ in 0..12 {
        for p in 0..count {
            for q in p + 1..count {
                if a[p][q].abs() <= f64::EPSILON * (a[p][p].abs() + a[q][q].abs()) * 1e-2 {
                    continue;
                }
                let theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
                let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
                let (c, s) = (t.hypot(1.0).recip(), t * t.hypot(1.0).recip());
                let turn = |rows: &mut Matrix| {
                    for k in 0..count {
                        let (x, y) = (rows[p][k], rows[q][k]);
                        (rows[p][k], rows[q][k]) = (c * x - s * y, s * x + c * y);
                    }
                };
                turn(&mut a);
                a.iter_mut().for_each(|row| (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]));
                turn(&mut vectors);
            }
        }
    }
    ((0..count).map(|i| a[i][i]).collect(), vectors)
}

/// The symmetric root of a positive matrix, and its eigenvalues, ascending.
fn root(matrix: Matrix) -> (Matrix, Vec<f64>) {
    let (mut values, vectors) = eigen(matrix);
    let count = values.len();
    let entry =
        |i: usize, j: usize| (0..count).map(|k| vectors[k][i] * values[k].max(0.0).sqrt() * vectors[k][j]).sum();
    let root = (0..count).map(|i| (0..count).map(|j| entry(i, j)).collect()).collect();
    values.sort_by(f64::total_cmp);
    (root, values)
}

#[test]
fn squares_of_frequencies_are_real_and_not_negative() {
    for set in [even_sphere(4), uneven_sphere(4, 3)] {
        let mut film = at_rest(&set);
        let (mut flux, mut tension) = (flux_matrix(&mut film), tension_matrix(&mut film));
        let (flux_skew, tension_skew) = (symmetrise(&mut flux), symmetrise(&mut tension));
        let (root, inertia) = root(flux);
        let (mut squares, _) = eigen(product(&product(&root, &tension), &root));
        squares.sort_by(f64::total_cmp);
        let lowest = exact_frequency(2).powi(2);
        report(format!(
            "skew {flux_skew:.1e} and {tension_skew:.1e}; B from {:.1e}, {:.1e}; squares {:.2?}",
            inertia[0],
            inertia[1],
            &squares[..9]
        ));
        assert!(flux_skew < 1e-14, "B: round-off alone");
        // At rest the normals' parts of the forces are even; what lies along the film is small, not nothing.
        assert!(tension_skew < 2e-4, "H: {tension_skew:.1e}");
        // A constant in the bubble moves nothing; all else has inertia.
        assert!(inertia[0].abs() < 1e-14 && inertia[1] > 0.01 * inertia[inertia.len() - 1]);
        assert!(squares[0] > -1e-8 * lowest, "omega^2 = {:.1e}: a mode grows", squares[0]);
        // A constant, three translations, five modes of l = 2.
        assert!(squares[3] < 0.01 * lowest && squares[4] > 0.95 * lowest && squares[8] < 1.05 * lowest);
    }
}

#[test]
fn noise_on_a_sphere_neither_grows_nor_decays() {
    for set in [even_sphere(4), uneven_sphere(4, 3)] {
        let mut film = at_rest(&set);
        let mut dice = Random::new(5);
        let noise: Vec<f64> = film.state.positions.iter().map(|_| 1.0 + 1e-5 * dice.next_signed()).collect();
        film.state.positions.iter_mut().zip(noise).for_each(|(x, stretch)| *x *= stretch);
        film.reshape(|x| x);
        film.state.potentials.iter_mut().for_each(|phi| *phi = 0.0);
        let mut kinetic = Vec::new();
        let period = std::f64::consts::TAU / exact_frequency(2);
        film.run(0.4, film.time + 100.0 * period, 1, |film| kinetic.push(film.sheet.measured.kinetic_energy));
        let fifth = kinetic.len() / 5;
        let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
        let [first, last] = [&kinetic[..fifth], &kinetic[kinetic.len() - fifth..]].map(mean);
        let rate = (last / first).ln() / (2.0 * 80.0 * period);
        report(format!("kinetic energy {first:.3e}, then {last:.3e}: growth {rate:.1e}"));
        // A sample of a hundred periods: the mean of a fifth of it is known to a thousandth or so.
        assert!(rate.abs() < 1e-5, "{rate:.1e}");
    }
}
