//! L2E: carriers collect liquid, surfactant, warmth and momentum from the material particles around them.
//!
//! # Equation
//! `V_E = sum_L w V_L`, likewise surfactant; `u_E = sum_L w V_L R (u_L + A_L r) / V_E`, `r = x_E - x_L`.
//!
//! # Discretisation
//! Every carrier loops over the material particles near it, so each output has one writer and the bits do not depend
//! on the number of threads. `R` is the minimal rotation from the material particle's tangent plane to the carrier's.
//!
//! # Source
//! Deng 2022, Algorithm 1, Eqs 6 and 7. DEVIATION: Eq. 7 lacks the mass of the particle; vectors are rotated, not
//! projected; the normal velocity lives on the carriers and is not gathered.

use super::state::{FilmStencil, TangentialFlow, Transfers};
use crate::observe::{Fault, Faults};
use crate::rows::{columns, columns_mut};
use crate::stage::Stage;
use bevy_ecs::query::With;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::identity::StableId;
use froth_components::kind::{EulerianParticle, LagrangianParticle};
use froth_components::lamella::Lamellae;
use froth_components::motion::NormalSpeed;
use super::links::{Carriers, Link};
use crate::neighbours::cells::CellList;
use crate::operators::stencil::SAME_SHEET;
use crate::operators::tangent::{MinimalRotation, tangential};
use froth_components::film::{LiquidVolume, SurfactantAmount, Warmth};
use froth_components::identity::InRegion;
use froth_components::motion::{Normal, Position, Velocity, VelocityGradient};
use glam::DVec3;
use rayon::prelude::*;

/// The material particles as a source of transfers.
#[derive(Clone, Copy)]
pub struct Material<'a> {
    /// Places.
    pub positions: &'a [Position],
    /// Unit normals.
    pub normals: &'a [Normal],
    /// Regions.
    pub regions: &'a [InRegion],
    /// Tangential velocities.
    pub velocities: &'a [Velocity],
    /// Affine parts of the velocities.
    pub gradients: &'a [VelocityGradient],
    /// Liquid volumes.
    pub volumes: &'a [LiquidVolume],
    /// Surfactant amounts.
    pub surfactants: &'a [SurfactantAmount],
    /// Warmth.
    pub warmth: &'a [Warmth],
    /// Weights toward the carriers.
    pub links: &'a [Link],
    /// Cells as wide as the transfer kernel's support.
    pub cells: &'a CellList,
}

/// What a carrier collected.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gathered {
    /// Liquid, m^3.
    pub volume: f64,
    /// Surfactant on one interface, mol.
    pub surfactant: f64,
    /// Liquid times warmth, m^3.
    pub warm_volume: f64,
    /// Liquid times tangential velocity, m^4/s.
    pub momentum: DVec3,
}

/// Gathers to every carrier.
pub fn gather_all(carriers: Carriers, material: Material, gathered: &mut Vec<Gathered>) {
    gathered.resize(carriers.positions.len(), Gathered::default());
    let kernel = carriers.kernel();
    let reach = kernel.support * kernel.support;
    gathered.par_iter_mut().enumerate().with_min_len(64).for_each(|(i, slot)| {
        let (place, normal, region) = (carriers.positions[i].0, carriers.normals[i].0, carriers.regions[i]);
        let mut sum = Gathered::default();
        material.cells.for_each_near(place, |l| {
            let r = place - material.positions[l].0;
            let distance = r.length_squared();
            if distance < reach && material.regions[l] == region && material.normals[l].0.dot(normal) > SAME_SHEET {
                let weight = material.links[l].weight(kernel.value(distance), r);
                sum.add(weight, material, l, r, normal);
            }
        });
        sum.momentum = tangential(sum.momentum, normal);
        *slot = sum;
    });
}

impl Gathered {
    #[inline]
    fn add(&mut self, weight: f64, material: Material, l: usize, r: DVec3, normal: DVec3) {
        let own = material.normals[l].0;
        let volume = weight * material.volumes[l].0;
        let velocity = material.velocities[l].0 + material.gradients[l].0 * tangential(r, own);
        self.volume += volume;
        self.surfactant += weight * material.surfactants[l].0;
        self.warm_volume += volume * material.warmth[l].0;
        self.momentum += MinimalRotation::between(own, normal).apply(velocity) * volume;
    }
}

/// Gathers one extensive scalar per material particle.
pub fn gather_scalar(carriers: Carriers, material: Material, value: impl Fn(usize) -> f64 + Sync) -> Vec<f64> {
    let kernel = carriers.kernel();
    let reach = kernel.support * kernel.support;
    let sum_at = |i: usize| {
        let (place, normal, region) = (carriers.positions[i].0, carriers.normals[i].0, carriers.regions[i]);
        let mut sum = 0.0;
        material.cells.for_each_near(place, |l| {
            let r = place - material.positions[l].0;
            let distance = r.length_squared();
            if distance < reach && material.regions[l] == region && material.normals[l].0.dot(normal) > SAME_SHEET {
                sum += material.links[l].weight(kernel.value(distance), r) * value(l);
            }
        });
        sum
    };
    (0..carriers.positions.len()).into_par_iter().with_min_len(64).map(sum_at).collect()
}

/// Columns of the material particles that transfers read.
pub type MaterialColumns<'w, 's> = Query<
    'w,
    's,
    (
        &'static Position,
        &'static Normal,
        &'static InRegion,
        &'static Velocity,
        &'static VelocityGradient,
        &'static LiquidVolume,
        &'static SurfactantAmount,
        &'static Warmth,
    ),
    With<LagrangianParticle>,
>;

/// Gathers liquid, surfactant, warmth and tangential velocity from the material particles.
pub fn gather_liquid(
    mut carriers: Query<
        (
            &Position,
            &Normal,
            &InRegion,
            &StableId,
            &NormalSpeed,
            &mut LiquidVolume,
            &mut SurfactantAmount,
            &mut Warmth,
            &mut Velocity,
        ),
        (With<EulerianParticle>, bevy_ecs::query::Without<LagrangianParticle>),
    >,
    material: MaterialColumns,
    lamellae: Res<Lamellae>,
    stencil: Res<FilmStencil>,
    mut transfers: ResMut<Transfers>,
    mut flow: ResMut<TangentialFlow>,
    mut faults: ResMut<Faults>,
) {
    let (positions, normals, regions, ids, speeds, mut volumes, mut surfactants, mut warmth, mut velocities) =
        columns_mut(&mut carriers);
    let carriers = Carriers { positions, normals, regions, stencil: &stencil.0, spacing: lamellae.spacing };
    let Transfers { links, cells, gathered, .. } = &mut *transfers;
    gather_all(carriers, Material::of(&material, links, cells), gathered);
    if let Some(row) = gathered.iter().position(|g| !(g.volume > 0.0)) {
        let detail = "has no liquid left: the film is thinner here than the material particles can show; \
                      use more of them per carrier, or a finer resolution";
        let fault = Fault::new(Stage::Gather, "liquid_volume", detail);
        faults.report(fault.on_particle("eulerian", row, Some(ids[row].0)));
        return;
    }
    flow.gathered.clear();
    flow.gathered.extend(gathered.iter().map(|g| g.momentum / g.volume));
    for (i, g) in gathered.iter().enumerate() {
        volumes.bypass_change_detection()[i].0 = g.volume;
        surfactants.bypass_change_detection()[i].0 = g.surfactant;
        warmth.bypass_change_detection()[i].0 = g.warm_volume / g.volume;
        velocities.bypass_change_detection()[i].0 = flow.gathered[i] + normals[i].0 * speeds[i].0;
    }
}

impl<'a> Material<'a> {
    /// The material particles of a query.
    #[must_use]
    pub fn of(query: &'a MaterialColumns, links: &'a [Link], cells: &'a CellList) -> Self {
        let (positions, normals, regions, velocities, gradients, volumes, surfactants, warmth) = columns(query);
        Self { positions, normals, regions, velocities, gradients, volumes, surfactants, warmth, links, cells }
    }
}
