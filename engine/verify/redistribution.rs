//! Carriers slide along the film; the film and what it carries stay.
//!
//! # Equation
//! The distance of the carriers from the analytic surface stays 0, scalars that slide along keep their value in space,
//! and the thickness that material particles show (`V Gamma/S`, with the concentration of the carriers around) does
//! not change.
//!
//! # Limits
//! Among carriers so irregular that a weight of the transfer would be negative, only constants are interpolated exactly,
//! which lowers the order of the thickness shown.

use froth_components::authored::shape::{Ellipsoid, Place, Radii, Shape};
use froth_components::motion::Position;
use froth_systems::melp::carriers::{moved_values, refit};
use froth_systems::melp::gather::gather_scalar;
use froth_systems::melp::links::Carriers;
use froth_systems::melp::redistribution::{Spread, lift, unevenness};
use froth_systems::melp::scatter::interpolate;
use froth_systems::melp::tiles::Rows;
use froth_systems::operators::conjugate_gradient::{StopRule, Workspace};
use froth_systems::sampling::harmonic::Harmonic;
use glam::DVec3;

use super::finding::{Finding, Refinement};
use super::operators::sphere;
use super::sampled::{Sampled, root_mean_square};
use super::{Effort, LawError};

const RADII: DVec3 = DVec3::new(0.06, 0.05, 0.04);
const PASSES: usize = 20;
/// Displacement of the carriers before they are spread again, in spacings along each axis.
const NOISE: f64 = 0.3;
/// Least order of the thickness shown: 1, since some carriers interpolate constants only, less the scatter of single layouts.
const LIQUID_ORDER: f64 = 0.7;

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let counts: &[usize] = effort.choose(&[500, 1000, 2000], &[1000, 2000, 4000, 8000]);
    let ellipsoid = Shape::Ellipsoid(Ellipsoid { centre: Place::ZERO, radii: Radii::from_si(RADII) });
    let mut findings = Vec::new();
    for (name, shape, radii) in [("sphere", sphere(), DVec3::splat(0.05)), ("ellipsoid", ellipsoid, RADII)] {
        let outcomes = counts.iter().map(|count| spread(shape, radii, *count)).collect::<Result<Vec<_>, _>>()?;
        findings.extend(shape_findings(name, &outcomes));
    }
    Ok(findings)
}

/// What is left of a noisy film after several passes.
struct Outcome {
    spacing: f64,
    /// Unevenness after, relative to before.
    unevenness: f64,
    /// Root mean square and mean distance from the surface, relative to the size.
    roughness: f64,
    inflation: f64,
    /// Root mean square change of the thickness shown, relative.
    shown: f64,
    /// Root mean square error of a scalar that slid along, relative to its largest value.
    carried: f64,
}

fn shape_findings(name: &str, outcomes: &[Outcome]) -> Vec<Finding> {
    let Some(finest) = outcomes.last() else { return Vec::new() };
    let order = |f: fn(&Outcome) -> f64| -> Refinement { outcomes.iter().map(|o| (o.spacing, f(o))).collect() };
    vec![
        Finding::vanishing(format!("{name}: unevenness left after {PASSES} passes, relative"), finest.unevenness, 0.2),
        Finding::vanishing(format!("{name}: rms distance from the surface, relative to size"), finest.roughness, 1e-3)
            .converging(&order(|o| o.roughness), 1.7),
        Finding::vanishing(format!("{name}: mean distance from the surface, relative to size"), finest.inflation, 1e-4)
            .converging(&order(|o| o.inflation), 1.7),
        Finding::vanishing(format!("{name}: rms error of a scalar slid along"), finest.carried, 5e-3)
            .converging(&order(|o| o.carried), 1.7),
        Finding::vanishing(format!("{name}: rms change of the thickness shown, relative"), finest.shown, 5e-3)
            .converging(&order(|o| o.shown), LIQUID_ORDER),
    ]
}

fn spread(shape: Shape, radii: DVec3, count: usize) -> Result<Outcome, LawError> {
    let mut film = Sampled::with_liquid(shape, count, 4)?;
    let even = unevenness(&spread_of(&film, &[0..film.count()]).excess());
    film.jitter(NOISE);
    film.film.positions.iter_mut().for_each(|x| x.0 /= (x.0 / radii).length());
    film.rebuild();
    refit(&film.stencil, film.spacing, &film.film.positions, &mut film.film.normals, &mut film.film.shapes);
    let harmonic = Harmonic::new(2, 1);
    // A concentration that varies by a tenth, carried by the carriers alone.
    let field = |x: &Position| 1.0 + 0.1 * harmonic.at(x.0);
    let mut carried: Vec<f64> = film.positions().iter().map(field).collect();
    let first = unevenness(&spread_of(&film, &[0..film.count()]).excess());
    let shown_before = shown(&film, &carried);
    for _ in 0..PASSES {
        carried = pass(&mut film, carried)?;
    }
    let last = unevenness(&spread_of(&film, &[0..film.count()]).excess());
    let size = shape.size();
    // Distance along the normal, to first order.
    let gap = |x: &Position| {
        let level = x.0 / radii;
        0.5 * (level.length_squared() - 1.0) / (level / radii).length() / size
    };
    let gaps: Vec<f64> = film.positions().iter().map(gap).collect();
    let shown_after = shown(&film, &carried);
    Ok(Outcome {
        spacing: film.spacing,
        unevenness: (last - even).max(0.0) / first,
        roughness: root_mean_square(gaps.iter().copied()),
        inflation: gaps.iter().sum::<f64>() / gaps.len() as f64,
        carried: root_mean_square(film.positions().iter().zip(&carried).map(|(x, q)| q - field(x))) / 0.1,
        shown: root_mean_square(shown_after.iter().zip(&shown_before).map(|(a, b)| a / b - 1.0)),
    })
}

fn spread_of<'a>(film: &'a Sampled, films: &'a [std::ops::Range<usize>]) -> Spread<'a> {
    Spread {
        stencil: &film.stencil,
        positions: film.positions(),
        wall: &[],
        normals: &film.film.normals,
        films,
        spacing: film.spacing,
    }
}

/// One redistribution as a step does it; returns the scalar at the new places.
fn pass(film: &mut Sampled, carried: Vec<f64>) -> Result<Vec<f64>, LawError> {
    let films = [0..film.count()];
    let spread = spread_of(film, &films);
    let stop = StopRule { tolerance: 1e-3, max_iterations: 4000 };
    let moves = spread.moves(&spread.excess(), stop, &mut Workspace::default())?;
    let moved = moved_values(&film.stencil, film.positions(), &film.film.normals, &moves.displacement, &carried);
    let inner = &mut film.film;
    lift(&film.stencil, film.spacing, &mut inner.positions, &inner.normals, &inner.shapes, &moves.displacement);
    film.rebuild();
    refit(&film.stencil, film.spacing, &film.film.positions, &mut film.film.normals, &mut film.film.shapes);
    Ok(moved)
}

/// Thickness that the material particles show, as a multiple of what they hold.
fn shown(film: &Sampled, concentration: &[f64]) -> Vec<f64> {
    let carriers = Carriers {
        positions: film.positions(),
        normals: &film.film.normals,
        regions: &film.regions,
        cells: &film.stencil.cells,
        spacing: film.spacing,
    };
    let (positions, normals) = (&film.film.liquid_positions, &film.film.liquid_normals);
    let regions = vec![film.regions[0]; positions.len()];
    let mut links = Vec::new();
    let rows = Rows { positions, normals, regions: &regions };
    let _areas = gather_scalar(carriers, rows, &mut links, |_| 1.0);
    interpolate(carriers, rows, &links, |e| concentration[e])
}
