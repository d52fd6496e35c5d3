//! L2E: carriers collect liquid, surfactant, warmth and momentum from the material particles around them.
//!
//! # Equation
//! `V_E = sum_L w V_L`, likewise surfactant; `u_E = sum_L w V_L R (u_L + A_L r) / V_E`, `r = x_E - x_L`.
//!
//! # Discretisation
//! Material particles push to the carriers around their [tile](super::tiles); the sums of the tiles are added in order.
//! `R` is the minimal rotation from the material particle's tangent plane to the carrier's.
//!
//! # Source
//! Deng 2022, Algorithm 1, Eqs 6 and 7. DEVIATION: Eq. 7 lacks the mass of the particle; vectors are rotated, not
//! projected; the normal velocity lives on the carriers and is not gathered.

use super::frames::FilmFrames;
use super::links::{Carriers, Link};
use super::state::{FilmStencil, TangentialFlow, Transfers};
use super::tiles::{Hit, PIECE, Rows, Site, Tile};
use crate::observe::{Fault, Faults};
use crate::operators::tangent::{nearly_rotated, tangential};
use crate::rows::{columns, columns_mut};
use crate::stage::Stage;
use bevy_ecs::query::With;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::film::{LiquidVolume, SurfactantAmount, Warmth};
use froth_components::identity::InRegion;
use froth_components::identity::StableId;
use froth_components::kind::{EulerianParticle, LagrangianParticle};
use froth_components::lamella::Lamellae;
use froth_components::motion::NormalSpeed;
use froth_components::motion::{Normal, Position, Velocity, VelocityGradient};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::ops::AddAssign;

/// The material particles as a source of transfers.
#[derive(Clone, Copy)]
pub struct Material<'a> {
    /// Where they are.
    pub rows: Rows<'a>,
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

impl AddAssign for Gathered {
    fn add_assign(&mut self, other: Self) {
        self.volume += other.volume;
        self.surfactant += other.surfactant;
        self.warm_volume += other.warm_volume;
        self.momentum += other.momentum;
    }
}

/// What one material particle gives.
struct Given {
    normal: DVec3,
    velocity: DVec3,
    /// Change of the velocity along the two tangents, 1/s.
    slopes: [DVec3; 2],
    volume: f64,
    surfactant: f64,
    warm_volume: f64,
}

impl Given {
    fn by(material: Material, l: usize, site: &Site) -> Self {
        let volume = material.volumes[l].0;
        Self {
            normal: site.normal,
            velocity: material.velocities[l].0,
            slopes: site.tangents.map(|t| material.gradients[l].0 * t),
            volume,
            surfactant: material.surfactants[l].0,
            warm_volume: volume * material.warmth[l].0,
        }
    }

    /// To a carrier of unit normal `normal`; the momentum may have a part along it.
    #[inline]
    fn to(&self, weight: f64, along: DVec2, normal: DVec3) -> Gathered {
        let velocity = self.velocity + self.slopes[0] * along.x + self.slopes[1] * along.y;
        Gathered {
            volume: weight * self.volume,
            surfactant: weight * self.surfactant,
            warm_volume: weight * self.warm_volume,
            momentum: nearly_rotated(velocity, self.normal, normal) * (weight * self.volume),
        }
    }
}

/// Links the material particles to the carriers, and gathers to every carrier.
#[must_use]
pub fn gather_all(carriers: Carriers, material: Material, links: &mut Vec<Link>) -> Vec<Gathered> {
    let given = |l: usize, site: &Site| Given::by(material, l, site);
    let to = |given: &Given, weight: f64, hit: &Hit, normal: DVec3| given.to(weight, hit.along, normal);
    let mut gathered = collect(carriers, material.rows, links, given, to);
    gathered.iter_mut().zip(carriers.normals).for_each(|(g, n)| g.momentum = tangential(g.momentum, n.0));
    gathered
}

/// Links rows to the carriers, and gathers one extensive scalar per row.
#[must_use]
pub fn gather_scalar(
    carriers: Carriers,
    rows: Rows,
    links: &mut Vec<Link>,
    value: impl Fn(usize) -> f64 + Sync,
) -> Vec<f64> {
    collect(carriers, rows, links, |l, _| value(l), |value, weight, _, _| weight * value)
}

/// Sums, for every carrier, `to(from(row), weight, hit, carrier's normal)` over the rows in reach; stores their links.
fn collect<T, G>(
    carriers: Carriers,
    rows: Rows,
    links: &mut Vec<Link>,
    from: impl Fn(usize, &Site) -> G + Sync,
    to: impl Fn(&G, f64, &Hit, DVec3) -> T + Sync,
) -> Vec<T>
where
    T: AddAssign + Copy + Default + Send,
{
    let kernel = carriers.kernel();
    links.resize(rows.positions.len(), Link::default());
    let piece = |tile: &mut Tile, (piece, links): (usize, &mut [Link])| {
        let rows = rows.piece(piece);
        let (mut sums, mut found) = (Vec::new(), Vec::new());
        tile.for_each(carriers, rows, |tile, range| {
            sums.clear();
            sums.resize(tile.carriers().len(), T::default());
            for l in range {
                let site = Site::new(rows.positions[l].0, rows.normals[l].0);
                tile.find_hits(&kernel, &site);
                let link = Link::to(tile.hits());
                links[l] = link;
                let given = from(piece * PIECE + l, &site);
                for hit in tile.hits() {
                    sums[hit.slot as usize] += to(&given, link.weight(hit), hit, tile.carrier(hit.slot).1);
                }
            }
            found.extend(tile.carriers().iter().copied().zip(sums.iter().copied()));
        });
        found
    };
    let parts: Vec<Vec<(u32, T)>> = links.par_chunks_mut(PIECE).enumerate().map_init(Tile::default, piece).collect();
    let mut whole = vec![T::default(); carriers.positions.len()];
    parts.into_iter().flatten().for_each(|(carrier, part)| whole[carrier as usize] += part);
    whole
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
    frames: Res<FilmFrames>,
    mut flow: ResMut<TangentialFlow>,
    mut faults: ResMut<Faults>,
) {
    let (positions, normals, regions, ids, speeds, mut volumes, mut surfactants, mut warmth, mut velocities) =
        columns_mut(&mut carriers);
    let carriers = Carriers { positions, normals, regions, cells: &stencil.0.cells, spacing: lamellae.spacing };
    let gathered = gather_all(carriers, Material::of(&material), &mut transfers.links);
    if let Some(row) = gathered.iter().position(|g| !(g.volume > 0.0)) {
        let detail = "has no liquid left: the film is thinner here than the material particles can show; \
                      use more of them per carrier, or a finer resolution";
        let fault = Fault::new(Stage::Gather, "liquid_volume", detail);
        faults.report(fault.on_particle("eulerian", row, Some(ids[row].0)));
        return;
    }
    positions.clone_into(&mut transfers.positions);
    normals.clone_into(&mut transfers.normals);
    transfers.cells.clone_from(&stencil.0.cells);
    flow.begin(gathered.iter().map(|g| g.momentum / g.volume));
    for (i, g) in gathered.iter().enumerate() {
        volumes.bypass_change_detection()[i].0 = g.volume;
        surfactants.bypass_change_detection()[i].0 = g.surfactant;
        warmth.bypass_change_detection()[i].0 = g.warm_volume / g.volume;
        velocities.bypass_change_detection()[i].0 =
            flow.whole_velocity(i, frames.of(regions[i]), normals[i].0, speeds[i].0);
    }
}

impl<'a> Material<'a> {
    /// The material particles of a query.
    #[must_use]
    pub fn of(query: &'a MaterialColumns) -> Self {
        let (positions, normals, regions, velocities, gradients, volumes, surfactants, warmth) = columns(query);
        let rows = Rows { positions, normals, regions };
        Self { rows, velocities, gradients, volumes, surfactants, warmth }
    }
}
