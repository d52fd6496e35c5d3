//! Weights between the particle sets: a partition of unity, corrected so that linear fields pass exactly.
//!
//! # Equation
//! `w(E, L) = W(|r|) (s + b . r)`, `r = x_E - x_L`, with `s`, `b` such that `sum_E w = 1` and `sum_E w r_t = 0`.
//!
//! # Source
//! Deng 2022, Eq. 6, whose weights (`b = 0`) do not conserve momentum in the affine transfer.
//!
//! # Limits
//! DEVIATION: next to a rim, where the correction would make a weight negative, there is none, and velocity gradients are
//! dropped (`is_one_sided`): only constants pass exactly there. Extrapolated linear fields, passed to and fro, grow by a tenth per
//! step.

use super::settings::TRANSFER_SUPPORT;
use super::state::FilmStencil;
use super::tiles::{Hit, Rows};
use crate::neighbours::cells::CellList;
use crate::neighbours::kernel::Kernel;
use crate::operators::stencil::Points;
use crate::operators::tangent::{plane_inverse, plane_outer};
use crate::rows::columns;
use bevy_ecs::query::With;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::identity::InRegion;
use froth_components::kind::{BoundaryParticle, EulerianParticle};
use froth_components::lamella::Lamellae;
use froth_components::motion::{Normal, Position};
use glam::{DMat2, DVec2};

/// The carriers as a target of transfers.
#[derive(Clone, Copy)]
pub struct Carriers<'a> {
    /// Places.
    pub positions: &'a [Position],
    /// Unit normals.
    pub normals: &'a [Normal],
    /// Regions.
    pub regions: &'a [InRegion],
    /// Their cells, which find them by place.
    pub cells: &'a CellList,
    /// Spacing, m.
    pub spacing: f64,
}

impl Carriers<'_> {
    /// The transfer kernel.
    #[must_use]
    pub fn kernel(&self) -> Kernel {
        Kernel::new(TRANSFER_SUPPORT * self.spacing)
    }

    /// The carriers as rows that look for carriers.
    #[must_use]
    pub fn rows(&self) -> Rows<'_> {
        Rows { positions: self.positions, normals: self.normals, regions: self.regions }
    }
}

/// The correction of one material particle's weights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Link {
    /// `s`: constant part, m^2. Zero if no carrier is in reach.
    pub constant: f64,
    /// `b`: linear part, m, in the coordinates of the particle's [`Site`](super::tiles::Site).
    pub linear: DVec2,
    /// Whether all carriers lie to one side, beyond a rim: a linear field could only be extrapolated.
    pub is_one_sided: bool,
}

impl Link {
    /// The link of a particle to the carriers in its reach.
    #[must_use]
    pub fn to(hits: &[Hit]) -> Self {
        let (mut sum, mut first, mut second) = (0.0, DVec2::ZERO, DMat2::ZERO);
        for Hit { kernel, along, .. } in hits {
            sum += kernel;
            first += along * kernel;
            second += plane_outer(*kernel, *along);
        }
        if sum <= 0.0 {
            return Self::default();
        }
        let mean = first / sum;
        let slope = -(plane_inverse(second - plane_outer(sum, mean)) * first);
        let lowest = hits.iter().map(|hit| 1.0 + slope.dot(hit.along - mean)).fold(f64::INFINITY, f64::min);
        if lowest < 0.0 {
            return Self { constant: 1.0 / sum, linear: DVec2::ZERO, is_one_sided: true };
        }
        Self { constant: (1.0 - slope.dot(mean)) / sum, linear: slope / sum, is_one_sided: false }
    }

    /// The weight of a carrier in reach.
    #[must_use]
    #[inline]
    pub fn weight(&self, hit: &Hit) -> f64 {
        hit.kernel * (self.constant + self.linear.dot(hit.along))
    }
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
    stencil.build_for(Points { positions, normals, regions, wall, wall_regions, spacing });
}
