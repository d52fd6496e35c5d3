//! Areas that agree with the transfer, concentration, thickness, enclosed volume.
//!
//! # Equation
//! Dual area `a*_E = sum_E' w(E, E') a_E'`: the transfer applied to the area itself, so that uniform liquid gives
//! uniform thickness. Concentration `Gamma* = S_E / a*_E`. Thickness `eta = (V_E / S_E) Gamma`: liquid and surfactant
//! are gathered with the same sampling error, which their ratio does not have.
//! Volume `V = 1/3 sum a (x - o) . n`.
//!
//! # Source
//! Deng 2022, Algorithm 2, Eqs 9 and 11 (sign corrected). DEVIATION: thickness from the dual area (8 % off with the
//! paper's at walls, 0.3 % so) and from the ratio to the surfactant; no evolution of thickness on L (Eq. 8).

use super::gather::gather_scalar;
use super::links::Carriers;
use super::state::{FilmStencil, Transfers};
use crate::observe::Observables;
use crate::operators::stencil::Stencil;
use crate::rows::reduce::ordered_sum;
use crate::rows::{columns, columns_mut};
use bevy_ecs::query::With;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::clock::Clock;
use froth_components::film::{
    Area, LiquidVolume, MeanCurvature, ShapeOperator, Surfactant, SurfactantAmount, Thickness,
};
use froth_components::gas::{GasExponent, GasPressure, GasVolume, IdealGas, ReferencePressure, ReferenceVolume};
use froth_components::identity::InRegion;
use froth_components::kind::{BoundaryParticle, EulerianParticle, Region};
use froth_components::lamella::Lamellae;
use froth_components::material::Liquid;
use froth_components::motion::{Normal, Position};
use glam::DVec3;
use std::ops::Range;

/// The dual area of every carrier, m^2, given their areas.
#[must_use]
pub fn dual_areas(carriers: Carriers, areas: &[f64]) -> Vec<f64> {
    gather_scalar(carriers, carriers.rows(), &mut Vec::new(), |i| areas[i])
}

/// Volume between the film in `rows` and `origin`, measured from its particles, m^3: the enclosed one where the film is
/// closed, or where a flat ground through `origin` closes it.
#[must_use]
pub fn enclosed_volume(
    positions: &[Position],
    normals: &[Normal],
    areas: &[f64],
    rows: Range<usize>,
    origin: DVec3,
) -> f64 {
    let start = rows.start;
    let term = |i: usize| areas[start + i] * (positions[start + i].0 - origin).dot(normals[start + i].0);
    ordered_sum(rows.len(), 0.0, term) / 3.0
}

/// Centre of the film in `rows`, m. A closed film's volume is measured from here: from afar, what its sampled normals leave
/// of `sum a n = 0` would count.
fn centre(positions: &[Position], areas: &[f64], rows: Range<usize>) -> DVec3 {
    let start = rows.start;
    let first = ordered_sum(rows.len(), DVec3::ZERO, |k| positions[start + k].0 * areas[start + k]);
    first / ordered_sum(rows.len(), 0.0, |k| areas[start + k])
}

/// Measures areas and curvature from the stencil.
pub fn measure_geometry(
    mut carriers: Query<(&Position, &Normal, &ShapeOperator, &mut Area, &mut MeanCurvature), With<EulerianParticle>>,
    walls: Query<&Position, With<BoundaryParticle>>,
    stencil: Res<FilmStencil>,
) {
    let stencil = &stencil.0;
    let wall = if walls.is_empty() { &[][..] } else { columns(&walls) };
    let (positions, normals, shapes, mut areas, mut curvatures) = columns_mut(&mut carriers);
    let areas = areas.bypass_change_detection();
    let curvatures = curvatures.bypass_change_detection();
    areas.iter_mut().zip(curvatures).enumerate().for_each(|(i, (area, curvature))| {
        area.0 = stencil.areas[i];
        curvature.0 = mean_curvature(stencil, positions, normals, shapes, wall, i);
    });
}

/// `-sum w (x_j - x_i) . n / a`; near a rim, where the film may meet the wall layers at an angle, the fit's trace.
fn mean_curvature(
    stencil: &Stencil,
    positions: &[Position],
    normals: &[Normal],
    shapes: &[ShapeOperator],
    wall: &[Position],
    i: usize,
) -> f64 {
    if stencil.wall_pairs(positions, wall, i).next().is_some() {
        let s = shapes[i].0;
        return s.x_axis.x + s.y_axis.y + s.z_axis.z;
    }
    let pull: DVec3 = stencil.weighted_offsets(positions, i).map(|(_, w, d)| d * w).sum();
    -pull.dot(normals[i].0) / stencil.areas[i]
}

/// Measures the concentration of what was gathered.
pub fn measure_concentration(
    carriers: Query<(&Position, &Normal, &InRegion, &SurfactantAmount), With<EulerianParticle>>,
    lamellae: Res<Lamellae>,
    stencil: Res<FilmStencil>,
    mut transfers: ResMut<Transfers>,
) {
    let (positions, normals, regions, amounts) = columns(&carriers);
    let carriers = Carriers { positions, normals, regions, cells: &stencil.0.cells, spacing: lamellae.spacing };
    let areas = dual_areas(carriers, &stencil.0.areas);
    transfers.concentration.clear();
    transfers.concentration.extend(amounts.iter().zip(&areas).map(|(s, a)| s.0 / a));
    transfers.dual_areas = areas;
}

/// Measures the thickness: the liquid per surfactant stays as gathered while the concentration changes.
pub fn measure_thickness(
    mut carriers: Query<(&LiquidVolume, &SurfactantAmount, &Surfactant, &mut Thickness), With<EulerianParticle>>,
    liquid: Res<Liquid>,
    transfers: Res<Transfers>,
) {
    let (volumes, amounts, surfactant, mut thickness) = columns_mut(&mut carriers);
    let elastic = liquid.elasticity > 0.0;
    for (i, eta) in thickness.bypass_change_detection().iter_mut().enumerate() {
        let area = if elastic { amounts[i].0 / surfactant[i].0 } else { transfers.dual_areas[i] };
        eta.0 = volumes[i].0 / area;
    }
}

/// Time in which the evolved volume follows the measured one, s.
const VOLUME_MEMORY: f64 = 0.02;

/// Measures the pressure of the gas in every closed region.
///
/// The volume is evolved by the film's flux, since the measured one jitters by 1e-4 (10 Pa at 1 atm) as carriers move
/// along the film. But redistribution displaces the film by its interpolation error, which the flux does not see, so
/// the evolved volume follows the measured one slowly; how far it went is recorded.
pub fn measure_pressure(
    carriers: Query<(&Position, &Normal), With<EulerianParticle>>,
    mut regions: Query<
        (&mut GasVolume, &ReferenceVolume, &ReferencePressure, &GasExponent, &mut GasPressure),
        With<Region>,
    >,
    stencil: Res<FilmStencil>,
    lamellae: Res<Lamellae>,
    clock: Res<Clock>,
    mut observables: ResMut<Observables>,
) {
    let (positions, normals) = columns(&carriers);
    for (film, region) in lamellae.films.iter().zip(&mut regions) {
        let (mut volume, reference_volume, reference_pressure, exponent, mut pressure) = region;
        if film.encloses_gas() {
            let rows = film.carriers.clone();
            let areas = &stencil.0.areas;
            let origin = match film.rim {
                None => centre(positions, areas, rows.clone()),
                Some(_) => film.volume_origin(),
            };
            let measured = enclosed_volume(positions, normals, areas, rows, origin);
            let share = -(-clock.substep_length() / VOLUME_MEMORY).exp_m1();
            let follow = share * (measured - volume.0);
            observables.record(&format!("measured_volume_{}", film.region.0), "m^3", measured);
            observables.add("volume_followed", "1", follow / volume.0);
            volume.0 += follow;
            let law = IdealGas::of(reference_volume, reference_pressure, exponent);
            pressure.0 = law.pressure(volume.0);
        }
    }
}
