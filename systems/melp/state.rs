//! What the stages of one step hand to each other. All of it is derived from columns and rebuilt in every step, so a
//! checkpoint holds none of it.

use super::links::Link;
use crate::operators::conjugate_gradient::Workspace;
use crate::operators::stencil::Stencil;
use bevy_ecs::resource::Resource;
use glam::DVec3;

/// The stencil of the carriers at their present places.
#[derive(Resource, Default)]
pub struct FilmStencil(pub Stencil);

/// How the particle sets are linked, and what was gathered.
#[derive(Resource, Default)]
pub struct Transfers {
    /// Correction of each material particle's weights.
    pub links: Vec<Link>,
    /// Areas that agree with the transfer, m^2, per carrier.
    pub dual_areas: Vec<f64>,
    /// Concentration gathered from the material, `Gamma*`, mol/m^2, per carrier.
    pub concentration: Vec<f64>,
}

/// Tangential flow on the carriers, m/s.
#[derive(Resource, Default)]
pub struct TangentialFlow {
    /// As gathered.
    pub gathered: Vec<DVec3>,
    /// After forces and the Marangoni solve.
    pub solved: Vec<DVec3>,
}

/// Work spaces of the linear solvers.
#[derive(Resource, Default)]
pub struct Solvers {
    /// Of the Marangoni solve.
    pub marangoni: Workspace,
    /// Of the redistribution.
    pub redistribution: Workspace,
}
