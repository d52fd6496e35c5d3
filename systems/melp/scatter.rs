//! E2L: material particles take velocity, its gradient and the concentration from the carriers around them.
//!
//! # Equation
//! `u_L = sum_E w R u_E`, `B = sum w (R u_E) r^T`, `D = sum w r r^T`, `A_L = B D^-1`, `r = (x_E - x_L)_t`; with FLIP
//! share `f`: `u_L = (1 - f) sum w R u_E + f (u_L + sum w R (u_E - u_E_gathered))`.
//! Shown thickness: `eta_L = V_L Gamma / S_L`, a material law without an evolution equation.
//!
//! # Source
//! Deng 2022, Algorithm 4, Eqs 16 to 18 (APIC: Jiang 2015).

use super::settings::Melp;
use super::state::{FilmStencil, TangentialFlow, Transfers};
use crate::rows::{columns, columns_mut};
use bevy_ecs::query::{With, Without};
use bevy_ecs::system::{Query, Res};
use froth_components::film::{LiquidVolume, Surfactant, SurfactantAmount, Thickness};
use froth_components::kind::{EulerianParticle, LagrangianParticle};
use froth_components::lamella::Lamellae;
use froth_components::material::Liquid;
use super::links::{Carriers, Link};
use crate::neighbours::kernel::Kernel;
use crate::operators::tangent::{MinimalRotation, outer, tangential, tangential_inverse};
use froth_components::identity::InRegion;
use froth_components::motion::{Normal, Position, Velocity, VelocityGradient};
use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// What is scattered, per carrier.
#[derive(Clone, Copy)]
pub struct CarrierFlow<'a> {
    /// Tangential velocity after the solve, m/s.
    pub velocity: &'a [DVec3],
    /// Its change since it was gathered, m/s.
    pub change: &'a [DVec3],
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

/// Where the material particles are.
#[derive(Clone, Copy)]
pub struct Targets<'a> {
    /// Places.
    pub positions: &'a [Position],
    /// Unit normals.
    pub normals: &'a [Normal],
    /// Regions.
    pub regions: &'a [InRegion],
    /// Weights toward the carriers.
    pub links: &'a [Link],
}

/// Scatters to every material particle; `concentration` receives the interpolated one.
pub fn scatter_all(
    carriers: Carriers,
    flow: CarrierFlow,
    targets: Targets,
    blend: Blend,
    velocities: &mut [Velocity],
    gradients: &mut [VelocityGradient],
    concentration: &mut [f64],
) {
    let kernel = carriers.kernel();
    let outputs = velocities.par_iter_mut().zip(gradients).zip(concentration);
    outputs.enumerate().with_min_len(256).for_each(|(l, ((velocity, gradient), gamma))| {
        let taken = Taken::at(carriers, flow, targets, &kernel, l);
        let flip = velocity.0 + taken.change;
        velocity.0 = tangential(taken.velocity.lerp(flip, blend.flip), targets.normals[l].0);
        gradient.0 = if blend.affine && !targets.links[l].is_one_sided { taken.gradient } else { DMat3::ZERO };
        *gamma = taken.concentration;
    });
}

/// What one material particle takes.
#[derive(Default)]
struct Taken {
    velocity: DVec3,
    change: DVec3,
    gradient: DMat3,
    concentration: f64,
}

impl Taken {
    fn at(carriers: Carriers, flow: CarrierFlow, targets: Targets, kernel: &Kernel, l: usize) -> Self {
        let (place, normal, link) = (targets.positions[l].0, targets.normals[l].0, targets.links[l]);
        let mut taken = Self::default();
        let (mut affine, mut inertia) = (DMat3::ZERO, DMat3::ZERO);
        carriers.for_each_near(kernel, place, normal, targets.regions[l], |e, r, value| {
            let weight = link.weight(value, r);
            let rotation = MinimalRotation::between(carriers.normals[e].0, normal);
            let velocity = rotation.apply(flow.velocity[e]);
            let r = tangential(r, normal);
            taken.velocity += velocity * weight;
            taken.change += rotation.apply(flow.change[e]) * weight;
            taken.concentration += weight * flow.concentration[e];
            affine += outer(weight, velocity, r);
            inertia += outer(weight, r, r);
        });
        taken.gradient = affine * tangential_inverse(inertia, normal);
        taken
    }
}

/// One scalar of the carriers, interpolated at every material particle.
pub fn interpolate(carriers: Carriers, targets: Targets, value: impl Fn(usize) -> f64 + Sync) -> Vec<f64> {
    let kernel = carriers.kernel();
    let at = |l: usize| {
        let (place, normal, link) = (targets.positions[l].0, targets.normals[l].0, targets.links[l]);
        let mut sum = 0.0;
        carriers.for_each_near(&kernel, place, normal, targets.regions[l], |e, r, w| {
            sum += link.weight(w, r) * value(e);
        });
        sum
    };
    (0..targets.positions.len()).into_par_iter().with_min_len(256).map(at).collect()
}

/// Scatters the flow to the material particles and sets the thickness they show.
pub fn scatter_flow(
    carriers: Query<(&Position, &Normal, &InRegion, &Surfactant, &Thickness), With<EulerianParticle>>,
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
    stencil: Res<FilmStencil>,
    transfers: Res<Transfers>,
    flow: Res<TangentialFlow>,
    liquid: Res<Liquid>,
    melp: Res<Melp>,
) {
    let (positions, normals, regions, surfactant, eulerian_thickness) = columns(&carriers);
    let carriers = Carriers { positions, normals, regions, stencil: &stencil.0, spacing: lamellae.spacing };
    let (positions, normals, regions, volumes, amounts, mut velocities, mut gradients, mut thickness) =
        columns_mut(&mut material);
    let targets = Targets { positions, normals, regions, links: &transfers.links };
    let change: Vec<DVec3> = flow.solved.iter().zip(&flow.gathered).map(|(new, old)| *new - *old).collect();
    let elastic = liquid.elasticity > 0.0;
    // What is shown follows the concentration; without surfactant there is only the carriers' thickness.
    let shown: Vec<f64> = if elastic {
        surfactant.iter().map(|gamma| gamma.0).collect()
    } else {
        eulerian_thickness.iter().map(|eta| eta.0).collect()
    };
    let carrier_flow = CarrierFlow { velocity: &flow.solved, change: &change, concentration: &shown };
    let blend = Blend { affine: melp.affine, flip: melp.flip };
    let mut taken = vec![0.0; positions.len()];
    let velocities = velocities.bypass_change_detection();
    scatter_all(carriers, carrier_flow, targets, blend, velocities, gradients.bypass_change_detection(), &mut taken);
    for (l, eta) in thickness.bypass_change_detection().iter_mut().enumerate() {
        eta.0 = if elastic { volumes[l].0 * taken[l] / amounts[l].0 } else { taken[l] };
    }
}
