//! Weights between the particle sets: a partition of unity, corrected so that linear fields pass exactly.
//!
//! # Equation
//! `w(E, L) = W(|r|) (s + b . r)`, `r = x_E - x_L`, with `s`, `b` such that `sum_E w = 1` and `sum_E w r_t = 0`.
//!
//! # Source
//! Deng 2022, Eq. 6, whose weights (`b = 0`) do not conserve momentum in the affine transfer.
//!
//! # Limits
//! Next to a rim, where the correction would make a weight negative, there is none, and velocity gradients are dropped
//! (`is_one_sided`): only constants pass exactly there. Extrapolated linear fields, passed to and fro, grow by a tenth per
//! step.

use super::state::{FilmStencil, Transfers};
use crate::rows::columns;
use bevy_ecs::query::With;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::kind::{BoundaryParticle, EulerianParticle, LagrangianParticle};
use froth_components::lamella::Lamellae;
use super::settings::TRANSFER_SUPPORT;
use crate::neighbours::kernel::Kernel;
use crate::operators::stencil::{Points, SAME_SHEET, Stencil};
use crate::operators::tangent::{outer, tangential, tangential_inverse};
use froth_components::identity::InRegion;
use froth_components::motion::{Normal, Position};
use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// The carriers as a target of transfers.
#[derive(Clone, Copy)]
pub struct Carriers<'a> {
    /// Places.
    pub positions: &'a [Position],
    /// Unit normals.
    pub normals: &'a [Normal],
    /// Regions.
    pub regions: &'a [InRegion],
    /// Their stencil, whose cells find them by place.
    pub stencil: &'a Stencil,
    /// Spacing, m.
    pub spacing: f64,
}

impl Carriers<'_> {
    /// The transfer kernel.
    #[must_use]
    pub fn kernel(&self) -> Kernel {
        Kernel::new(TRANSFER_SUPPORT * self.spacing)
    }

    /// Calls `visit(row, offset to the carrier, kernel value)` for every carrier of the same sheet in reach.
    #[inline]
    pub fn for_each_near(
        &self,
        kernel: &Kernel,
        place: DVec3,
        normal: DVec3,
        region: InRegion,
        mut visit: impl FnMut(usize, DVec3, f64),
    ) {
        let reach = kernel.support * kernel.support;
        self.stencil.cells.for_each_near(place, |row| {
            let r = self.positions[row].0 - place;
            let distance = r.length_squared();
            if distance < reach && self.regions[row] == region && self.normals[row].0.dot(normal) > SAME_SHEET {
                visit(row, r, kernel.value(distance));
            }
        });
    }
}

/// The correction of one material particle's weights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Link {
    /// `s`: constant part, m^2. Zero if no carrier is in reach.
    pub constant: f64,
    /// `b`: linear part, m.
    pub linear: DVec3,
    /// Whether all carriers lie to one side, beyond a rim: a linear field could only be extrapolated.
    pub is_one_sided: bool,
}

impl Link {
    /// The weight of a carrier at `offset`, given the kernel's value there.
    #[must_use]
    #[inline]
    pub fn weight(&self, kernel_value: f64, offset: DVec3) -> f64 {
        kernel_value * (self.constant + self.linear.dot(offset))
    }
}

/// The links of all material particles.
pub fn link_all(
    carriers: Carriers,
    positions: &[Position],
    normals: &[Normal],
    regions: &[InRegion],
    links: &mut Vec<Link>,
) {
    let kernel = carriers.kernel();
    links.resize(positions.len(), Link::default());
    links.par_iter_mut().enumerate().with_min_len(256).for_each(|(i, link)| {
        *link = link_one(carriers, &kernel, positions[i].0, normals[i].0, regions[i]);
    });
}

/// The link of one particle.
#[must_use]
pub fn link_one(carriers: Carriers, kernel: &Kernel, place: DVec3, normal: DVec3, region: InRegion) -> Link {
    let (mut sum, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
    let mut nearby = [(DVec3::ZERO, 0.0); 64];
    let mut count = 0;
    carriers.for_each_near(kernel, place, normal, region, |_, r, w| {
        let r = tangential(r, normal);
        sum += w;
        first += r * w;
        second += outer(w, r, r);
        if count < nearby.len() {
            nearby[count] = (r, w);
            count += 1;
        }
    });
    if sum <= 0.0 {
        return Link::default();
    }
    let mean = first / sum;
    let spread = second - outer(sum, mean, mean);
    let slope = -(tangential_inverse(spread, normal) * first);
    let lowest = nearby[..count].iter().map(|(r, _)| 1.0 + slope.dot(*r - mean)).fold(f64::INFINITY, f64::min);
    if lowest < 0.0 {
        return Link { constant: 1.0 / sum, linear: DVec3::ZERO, is_one_sided: true };
    }
    Link { constant: (1.0 - slope.dot(mean)) / sum, linear: slope / sum, is_one_sided: false }
}

/// Builds the stencil of the carriers where they stand.
pub fn build_stencil(
    carriers: Query<(&Position, &Normal, &InRegion), With<EulerianParticle>>,
    walls: Query<(&Position, &InRegion), With<BoundaryParticle>>,
    lamellae: Res<Lamellae>,
    mut stencil: ResMut<FilmStencil>,
) {
    let (positions, normals, regions) = columns(&carriers);
    let (wall, wall_regions) = if walls.is_empty() { (&[][..], &[][..]) } else { columns(&walls) };
    let spacing = lamellae.spacing;
    stencil.0.rebuild(Points { positions, normals, regions, wall, wall_regions, spacing });
}

/// Links the material particles to the carriers around them.
pub fn link_material(
    carriers: Query<(&Position, &Normal, &InRegion), With<EulerianParticle>>,
    material: Query<(&Position, &Normal, &InRegion), With<LagrangianParticle>>,
    lamellae: Res<Lamellae>,
    stencil: Res<FilmStencil>,
    mut transfers: ResMut<Transfers>,
) {
    let (positions, normals, regions) = columns(&carriers);
    let carriers = Carriers { positions, normals, regions, stencil: &stencil.0, spacing: lamellae.spacing };
    let (positions, normals, regions) = columns(&material);
    let Transfers { links, cells, .. } = &mut *transfers;
    cells.rebuild(positions, TRANSFER_SUPPORT * lamellae.spacing);
    link_all(carriers, positions, normals, regions, links);
}
