//! E2L: material particles take velocity, its gradient and the concentration from the carriers around them.
//!
//! # Equation
//! `u_L = sum_E w R u_E`, `B = sum w (R u_E) r^T`, `D = sum w r r^T`, `A_L = B D^-1`, `r = (x_E - x_L)_t`; with FLIP
//! share `f`: `u_L = (1 - f) sum w R u_E + f (u_L + sum w R (u_E - u_E_gathered))`.
//! Shown thickness: `eta_L = V_L Gamma / S_L`, a material law without an evolution equation.
//!
//! # Source
//! Deng 2022, Algorithm 4, Eqs 16 to 18 (APIC: Jiang 2015).

use super::links::{Carriers, Link};
use super::settings::Melp;
use super::state::{TangentialFlow, Transfers};
use super::tiles::{PIECE, Rows, Site, Tile};
use crate::operators::tangent::{nearly_rotated, outer, plane_inverse, plane_outer, tangential};
use crate::rows::{columns, columns_mut};
use bevy_ecs::query::{With, Without};
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::clock::Clock;
use froth_components::film::{LiquidVolume, Surfactant, SurfactantAmount, Thickness};
use froth_components::identity::InRegion;
use froth_components::kind::{EulerianParticle, LagrangianParticle};
use froth_components::lamella::Lamellae;
use froth_components::material::Liquid;
use froth_components::motion::{Normal, Position, Velocity, VelocityGradient};
use glam::{DMat2, DMat3, DVec2, DVec3};
use rayon::prelude::*;

/// What is scattered, per carrier.
#[derive(Clone, Copy)]
pub struct CarrierFlow<'a> {
    /// Tangential velocity after the solve, m/s.
    pub velocity: &'a [DVec3],
    /// Its change since it was gathered, m/s.
    pub change: &'a [DVec3],
    /// Mean velocity over the step less that at its end, m/s; empty where they are the same.
    pub drift: &'a [DVec3],
    /// Concentration, mol/m^2.
    pub concentration: &'a [f64],
}

/// How velocities are blended.
#[derive(Clone, Copy, Debug)]
pub struct Blend {
    /// Whether velocity gradients are kept (APIC).
    pub affine: bool,
    /// FLIP share, 0 to 1.
    pub flip: f64,
}

/// What every material particle receives.
pub struct Received<'a> {
    /// Tangential velocities.
    pub velocities: &'a mut [Velocity],
    /// Velocity gradients.
    pub gradients: &'a mut [VelocityGradient],
    /// Interpolated concentration, mol/m^2.
    pub concentration: &'a mut [f64],
    /// Velocities to move by, m/s.
    pub drift: &'a mut [DVec3],
}

/// Scatters to every material particle.
pub fn scatter_all(
    carriers: Carriers,
    flow: CarrierFlow,
    rows: Rows,
    links: &[Link],
    blend: Blend,
    received: Received,
) {
    let kernel = carriers.kernel();
    let Received { velocities, gradients, concentration, drift } = received;
    let flows = velocities.par_chunks_mut(PIECE).zip(gradients.par_chunks_mut(PIECE)).zip(drift.par_chunks_mut(PIECE));
    let pieces = flows.zip(concentration.par_chunks_mut(PIECE)).zip(links.par_chunks(PIECE)).enumerate();
    pieces.for_each_init(Tile::default, |tile, (piece, ((((velocities, gradients), drift), concentration), links))| {
        let rows = rows.piece(piece);
        tile.for_each(carriers, rows, |tile, range| {
            for l in range {
                let site = Site::new(rows.positions[l].0, rows.normals[l].0);
                tile.find_hits(&kernel, &site);
                let taken = Taken::at(tile, &site, links[l], flow, blend);
                let flip = velocities[l].0 + taken.change;
                velocities[l].0 = tangential(taken.velocity.lerp(flip, blend.flip), site.normal);
                gradients[l].0 = taken.gradient;
                drift[l] = velocities[l].0 + tangential(taken.drift, site.normal);
                concentration[l] = taken.concentration;
            }
        });
    });
}

/// What one material particle takes; the vectors may have a part along its normal.
struct Taken {
    velocity: DVec3,
    change: DVec3,
    drift: DVec3,
    gradient: DMat3,
    concentration: f64,
}

impl Taken {
    #[inline]
    fn at(tile: &Tile, site: &Site, link: Link, flow: CarrierFlow, blend: Blend) -> Self {
        let (mut velocity, mut change, mut drift, mut concentration) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, 0.0);
        let (mut affine, mut inertia) = ([DVec3::ZERO; 2], DMat2::ZERO);
        for hit in tile.hits() {
            let (e, normal) = tile.carrier(hit.slot);
            let weight = link.weight(hit);
            let there = nearly_rotated(flow.velocity[e], normal, site.normal) * weight;
            velocity += there;
            concentration += weight * flow.concentration[e];
            if blend.flip > 0.0 {
                change += nearly_rotated(flow.change[e], normal, site.normal) * weight;
            }
            if let Some(apart) = flow.drift.get(e) {
                drift += nearly_rotated(*apart, normal, site.normal) * weight;
            }
            affine[0] += there * hit.along.x;
            affine[1] += there * hit.along.y;
            inertia += plane_outer(weight, hit.along);
        }
        let gradient = if blend.affine && !link.is_one_sided { gradient(affine, inertia, site) } else { DMat3::ZERO };
        Self { velocity, change, drift, gradient, concentration }
    }
}

/// `B D^-1`, given `B` by its columns along the tangents and `D` in their coordinates.
fn gradient(affine: [DVec3; 2], inertia: DMat2, site: &Site) -> DMat3 {
    let inverse = plane_inverse(inertia);
    let along = |column: DVec2| tangential(affine[0] * column.x + affine[1] * column.y, site.normal);
    outer(1.0, along(inverse.x_axis), site.tangents[0]) + outer(1.0, along(inverse.y_axis), site.tangents[1])
}

/// One scalar of the carriers, interpolated at every linked row.
#[must_use]
pub fn interpolate(carriers: Carriers, rows: Rows, links: &[Link], value: impl Fn(usize) -> f64 + Sync) -> Vec<f64> {
    let kernel = carriers.kernel();
    let mut values = vec![0.0; links.len()];
    let pieces = values.par_chunks_mut(PIECE).zip(links.par_chunks(PIECE)).enumerate();
    pieces.for_each_init(Tile::default, |tile, (piece, (values, links))| {
        let rows = rows.piece(piece);
        tile.for_each(carriers, rows, |tile, range| {
            for l in range {
                tile.find_hits(&kernel, &Site::new(rows.positions[l].0, rows.normals[l].0));
                let terms = tile.hits().iter().map(|hit| links[l].weight(hit) * value(tile.carrier(hit.slot).0));
                values[l] = terms.sum();
            }
        });
    });
    values
}

/// Scatters the flow to the material particles and sets the thickness they show.
pub fn scatter_flow(
    carriers: Query<(&InRegion, &Surfactant, &Thickness), With<EulerianParticle>>,
    mut material: Query<
        (
            &Position,
            &Normal,
            &InRegion,
            &LiquidVolume,
            &SurfactantAmount,
            &mut Velocity,
            &mut VelocityGradient,
            &mut Thickness,
        ),
        (With<LagrangianParticle>, Without<EulerianParticle>),
    >,
    lamellae: Res<Lamellae>,
    clock: Res<Clock>,
    mut transfers: ResMut<Transfers>,
    flow: Res<TangentialFlow>,
    liquid: Res<Liquid>,
    melp: Res<Melp>,
) {
    let (regions, surfactant, eulerian_thickness) = columns(&carriers);
    let Transfers { links, positions, normals, cells, drift, .. } = &mut *transfers;
    let carriers = Carriers { positions, normals, regions, cells, spacing: lamellae.spacing };
    let (positions, normals, regions, volumes, amounts, mut velocities, mut gradients, mut thickness) =
        columns_mut(&mut material);
    let rows = Rows { positions, normals, regions };
    let change: Vec<DVec3> = flow.last.iter().zip(&flow.gathered).map(|(new, old)| *new - *old).collect();
    let mean = |path: &DVec3| *path / clock.step_length;
    let apart: Vec<DVec3> = flow.path.iter().zip(&flow.last).map(|(path, last)| mean(path) - *last).collect();
    let elastic = liquid.elasticity > 0.0;
    // What is shown follows the concentration; without surfactant there is only the carriers' thickness.
    let shown: Vec<f64> = if elastic {
        surfactant.iter().map(|gamma| gamma.0).collect()
    } else {
        eulerian_thickness.iter().map(|eta| eta.0).collect()
    };
    let apart = if clock.substeps > 1 { &apart[..] } else { &[] };
    let carrier_flow = CarrierFlow { velocity: &flow.last, change: &change, drift: apart, concentration: &shown };
    let blend = Blend { affine: melp.affine, flip: melp.flip };
    let mut taken = vec![0.0; volumes.len()];
    drift.resize(volumes.len(), DVec3::ZERO);
    let received = Received {
        velocities: velocities.bypass_change_detection(),
        gradients: gradients.bypass_change_detection(),
        concentration: &mut taken,
        drift,
    };
    scatter_all(carriers, carrier_flow, rows, links, blend, received);
    thickness.bypass_change_detection().par_iter_mut().enumerate().with_min_len(4096).for_each(|(l, eta)| {
        eta.0 = if elastic { volumes[l].0 * taken[l] / amounts[l].0 } else { taken[l] };
    });
}
