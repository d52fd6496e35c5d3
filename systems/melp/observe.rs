//! What a run of MELP measures in every step.

use super::contact::Contacts;
use super::gather::MaterialColumns;
use super::state::FilmStencil;
use crate::observe::Observables;
use crate::rows::columns;
use crate::rows::reduce::{ordered_max, ordered_sum};
use bevy_ecs::query::With;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::clock::Clock;
use froth_components::film::{SurfaceTension, Surfactant, Thickness};
use froth_components::gas::{GasExponent, GasVolume, IdealGas, ReferencePressure, ReferenceVolume};
use froth_components::kind::{EulerianParticle, LagrangianParticle, Region};
use froth_components::lamella::Lamellae;
use froth_components::material::{Atmosphere, Liquid};
use froth_components::motion::{NormalSpeed, Position, Velocity};
use glam::DVec3;

/// Records area, volumes, pressures, energies and speeds at the end of the step, before the carriers were spread.
pub fn observe_films(
    carriers: Query<
        (&Position, &Velocity, &NormalSpeed, &SurfaceTension, &Surfactant, &Thickness),
        With<EulerianParticle>,
    >,
    gases: Query<(&GasVolume, &ReferenceVolume, &ReferencePressure, &GasExponent), With<Region>>,
    lamellae: Res<Lamellae>,
    liquid: Res<Liquid>,
    atmosphere: Res<Atmosphere>,
    stencil: Res<FilmStencil>,
    contacts: Res<Contacts>,
    clock: Res<Clock>,
    mut observables: ResMut<Observables>,
) {
    let (positions, velocities, speeds, tension, surfactant, thickness) = columns(&carriers);
    let (areas, count) = (&stencil.0.areas, positions.len());
    let sum = |f: &(dyn Fn(usize) -> f64 + Sync)| ordered_sum(count, 0.0, f);
    // Two sheets that are one film count half each.
    let film_area = |i: usize| areas[i] * contacts.interfaces(i);
    observables.record("area", "m^2", sum(&film_area));
    observables.raise("max_speed", "m/s", ordered_max(count, 0.0, |i| velocities[i].0.length()));
    observables.record("surface_energy", "J", sum(&|i| 2.0 * tension[i].0 * film_area(i)));
    let mut air = vec![0.0; count];
    for film in &lamellae.films {
        air[film.carriers.clone()].fill(film.air_mass);
    }
    let mass = |i: usize| (liquid.density * thickness[i].0 + air[i]) * areas[i];
    observables.record("normal_kinetic_energy", "J", sum(&|i| 0.5 * mass(i) * speeds[i].0 * speeds[i].0));
    observables.record("max_normal_speed", "m/s", ordered_max(count, 0.0, |i| speeds[i].0.abs()));
    if liquid.elasticity > 0.0 {
        let rest = liquid.reference_surfactant();
        let strain = sum(&|i| areas[i] * (surfactant[i].0 / rest - 1.0).powi(2)) / sum(&|i| areas[i]);
        observables.record("surfactant_deviation", "1", strain.sqrt());
    }
    observables.record("substeps", "1", f64::from(clock.substeps));
    let centre = ordered_sum(count, DVec3::ZERO, |i| positions[i].0 * areas[i]) / sum(&|i| areas[i]);
    observables.record("centre_x", "m", centre.x);
    observables.record("centre_y", "m", centre.y);
    observables.record("centre_z", "m", centre.z);
    for (film, (volume, reference_volume, reference_pressure, exponent)) in lamellae.films.iter().zip(&gases) {
        if film.encloses_gas() {
            let pressure = IdealGas::of(reference_volume, reference_pressure, exponent).pressure(volume.0);
            let name = |what: &str| format!("{what}_{}", film.region.0);
            observables.record(&name("volume"), "m^3", volume.0);
            observables.record(&name("excess_pressure"), "Pa", pressure - atmosphere.pressure);
        }
    }
}

/// Records what the material particles carry and show.
pub fn observe_liquid(
    material: MaterialColumns,
    shown: Query<&Thickness, With<LagrangianParticle>>,
    liquid: Res<Liquid>,
    mut observables: ResMut<Observables>,
) {
    let (_, _, _, velocities, _, volumes, amounts, _) = columns(&material);
    let thickness = columns(&shown);
    let count = volumes.len();
    let sum = |f: &(dyn Fn(usize) -> f64 + Sync)| ordered_sum(count, 0.0, f);
    let whole = sum(&|l| volumes[l].0);
    observables.record("liquid", "m^3", whole);
    observables.record("surfactant", "mol", sum(&|l| amounts[l].0));
    let energy = sum(&|l| 0.5 * liquid.density * volumes[l].0 * velocities[l].0.length_squared());
    observables.record("flow_kinetic_energy", "J", energy);
    observables.raise("max_speed", "m/s", ordered_max(count, 0.0, |l| velocities[l].0.length()));
    observables.record("mean_speed", "m/s", sum(&|l| volumes[l].0 * velocities[l].0.length()) / whole);
    let mean = sum(&|l| thickness[l].0) / count as f64;
    let deviation = (sum(&|l| (thickness[l].0 - mean).powi(2)) / count as f64).sqrt();
    observables.record("thickness_mean", "m", mean);
    observables.record("thickness_deviation", "m", deviation);
    observables.record("thickness_min", "m", -ordered_max(count, f64::NEG_INFINITY, |l| -thickness[l].0));
    observables.record("thickness_max", "m", ordered_max(count, 0.0, |l| thickness[l].0));
}
