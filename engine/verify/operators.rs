//! The surface operators on points that no lattice orders.
//!
//! | | exact for |
//! |---|---|
//! | Laplacian, flux divergence | constants; their sums over the film vanish |
//! | least-squares gradient | linear fields, also at walls and for displaced carriers |
//! | adjoint gradient | duality with the divergence |
//! | transfer weights | constants; linear fields away from rims |
//!
//! Symmetric weights cannot be exact for linear fields at single particles as well; their error there is that of the
//! sampling, and what counts, the sums against smooth fields, converges: eigenvalues of the Laplacian on a sphere.

use froth_components::authored::shape::{Disc, Place, Shape, Sphere};
use froth_components::motion::{Normal, Position};
use froth_components::quantity::{Direction, Length};
use froth_systems::melp::gather::gather_scalar;
use froth_systems::melp::links::Carriers;
use froth_systems::melp::scatter::interpolate;
use froth_systems::melp::tiles::Rows;
use froth_systems::sampling::harmonic::Harmonic;
use glam::DVec3;

use super::finding::{Finding, Refinement};
use super::sampled::{Sampled, largest, root_mean_square};
use super::{Effort, LawError};

const RADIUS: f64 = 0.05;
const SLOPE: DVec3 = DVec3::new(0.7, -1.3, 0.0);

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let mut walled = Sampled::new(disc(), 600)?;
    walled.jitter(0.2);
    let mut findings = exactness(&walled);
    findings.extend(transfers(&walled));
    findings.extend(eigenvalues(effort)?);
    findings.extend(divergence(effort)?);
    Ok(findings)
}

fn disc() -> Shape {
    Shape::Disc(Disc { centre: Place::ZERO, radius: Length::from_si(RADIUS), normal: Direction::Z })
}

pub(super) fn sphere() -> Shape {
    Shape::Sphere(Sphere { centre: Place::ZERO, radius: Length::from_si(RADIUS) })
}

/// Identities that hold to round-off on a walled disc of displaced carriers.
fn exactness(walled: &Sampled) -> Vec<Finding> {
    let Sampled { stencil, film, .. } = walled;
    let (positions, normals) = (walled.positions(), film.normals.as_slice());
    let rows = || 0..walled.count();
    let constant = largest(rows().map(|i| stencil.laplacian(i, |_| 4.2)));
    let linear = |j: usize| 3.0 + SLOPE.dot(positions[j].0);
    let slope_error = |i: usize| stencil.gradient(positions, normals, i, linear).distance(SLOPE) / SLOPE.length();
    let u = |i: usize| DVec3::new((i as f64).sin(), (2.0 * i as f64).cos(), 0.0);
    let q = |i: usize| (0.7 * i as f64).sin();
    let divergence = |i: usize| stencil.flux_divergence(positions, i, u);
    let size: f64 = rows().map(|i| divergence(i).abs()).sum();
    let work: f64 = rows().map(|i| q(i) * divergence(i)).sum();
    let adjoint: f64 = rows().map(|i| u(i).dot(stencil.adjoint_gradient(positions, normals, i, q))).sum();
    vec![
        Finding::vanishing("Laplacian of a constant, at walls too", constant, 1e-12),
        Finding::vanishing(
            "least-squares gradient of a linear field, relative, at walls too",
            largest(rows().map(slope_error)),
            1e-12,
        ),
        Finding::vanishing("sum of the flux divergence, relative", rows().map(divergence).sum::<f64>() / size, 1e-14),
        Finding::vanishing("divergence plus adjoint of the gradient, relative", (work + adjoint) / size, 1e-14),
    ]
}

/// The weights between the particle sets, at places between the carriers.
fn transfers(walled: &Sampled) -> Vec<Finding> {
    let carriers = Carriers {
        positions: walled.positions(),
        normals: &walled.film.normals,
        regions: &walled.regions,
        cells: &walled.stencil.cells,
        spacing: walled.spacing,
    };
    let between = DVec3::new(0.31, 0.17, 0.0) * walled.spacing;
    let positions: Vec<Position> = walled.positions().iter().map(|x| Position(x.0 + between)).collect();
    let rows = Rows { positions: &positions, normals: &walled.film.normals, regions: &walled.regions };
    let mut links = Vec::new();
    let _areas = gather_scalar(carriers, rows, &mut links, |_| 1.0);
    let linear = interpolate(carriers, rows, &links, |j| 3.0 + SLOPE.dot(walled.positions()[j].0));
    let ones = interpolate(carriers, rows, &links, |_| 1.0);
    let inner =
        (0..walled.count()).filter(|i| walled.is_inner(*i)).map(|i| linear[i] - 3.0 - SLOPE.dot(positions[i].0));
    let whole = ones.iter().map(|sum| sum - 1.0);
    vec![
        Finding::vanishing("interpolation of a constant, at walls too", largest(whole), 1e-13),
        Finding::vanishing(
            "interpolation of a linear field, relative, inside",
            largest(inner) / (SLOPE.length() * RADIUS),
            1e-12,
        ),
    ]
}

/// `-R^2 <Y, lap Y>/<Y, Y>` on a sphere against `l (l + 1)`.
fn eigenvalues(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let films = spheres(effort)?;
    let finding = |degree: u32| {
        let (harmonic, exact) = (Harmonic::new(degree, 1), f64::from(degree * (degree + 1)));
        let value = |film: &Sampled| {
            let y: Vec<f64> = film.positions().iter().map(|x| harmonic.at(x.0)).collect();
            let bent: f64 = (0..y.len()).map(|i| y[i] * film.stencil.laplacian(i, |j| y[j])).sum();
            let whole: f64 = y.iter().zip(&film.stencil.areas).map(|(y, a)| a * y * y).sum();
            -RADIUS * RADIUS * bent / whole
        };
        let refinement: Refinement = films.iter().map(|film| (film.spacing, value(film) - exact)).collect();
        let measured = films.last().map_or(f64::NAN, value);
        Finding::relative(format!("eigenvalue of the Laplacian, l = {degree}"), exact, measured, 0.02)
            .converging(&refinement, 1.9)
    };
    // Degree 1 is the place itself: the weights are scaled by it, and nothing is left to converge.
    Ok([2, 3, 4].map(finding).into())
}

/// Divergence and gradient of smooth fields at single carriers of an even sphere: `grad Y`, and `div grad Y`.
fn divergence(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let films = spheres(effort)?;
    let harmonic = Harmonic::new(3, 1);
    let slope = |x: DVec3| {
        const STEP: f64 = 1e-5 * RADIUS;
        let along = |axis: DVec3| (harmonic.at(x + axis * STEP) - harmonic.at(x - axis * STEP)) / (2.0 * STEP);
        DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
    };
    let gradient = |film: &Sampled| {
        let (x, n): (&[Position], &[Normal]) = (film.positions(), &film.film.normals);
        let value: Vec<f64> = x.iter().map(|x| harmonic.at(x.0)).collect();
        let wrong = |i: usize| (film.stencil.gradient(x, n, i, |j| value[j]) - slope(x[i].0)).length() * RADIUS;
        root_mean_square((0..film.count()).map(wrong))
    };
    let divergence = |film: &Sampled| {
        let x = film.positions();
        let flow: Vec<DVec3> = x.iter().map(|x| slope(x.0)).collect();
        let exact = |i: usize| -12.0 * harmonic.at(x[i].0) / (RADIUS * RADIUS);
        let found = |i: usize| film.stencil.flux_divergence(x, i, |j| flow[j]) / film.stencil.areas[i];
        root_mean_square((0..film.count()).map(|i| (found(i) - exact(i)) * RADIUS * RADIUS / 12.0))
    };
    let last = |f: &dyn Fn(&Sampled) -> f64| films.last().map_or(f64::NAN, f);
    let refinement =
        |f: &dyn Fn(&Sampled) -> f64| films.iter().map(|film| (film.spacing, f(film))).collect::<Refinement>();
    Ok(vec![
        Finding::vanishing(
            "least-squares gradient of Y31, rms error times R",
            last(&gradient),
            effort.choose(0.04, 0.01),
        )
        .converging(&refinement(&gradient), 1.9),
        Finding::vanishing("flux divergence of grad Y31, rms error relative to its largest", last(&divergence), 0.02)
            .converging(&refinement(&divergence), 0.0),
    ])
}

/// Spheres of ever more carriers.
pub(super) fn spheres(effort: Effort) -> Result<Vec<Sampled>, LawError> {
    let counts: &[usize] = effort.choose(&[500, 1000, 2000], &[1000, 2000, 4000, 8000]);
    counts.iter().map(|count| Ok(Sampled::new(sphere(), *count)?)).collect()
}
