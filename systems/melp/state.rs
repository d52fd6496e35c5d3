//! What the stages of one step hand to each other. All of it is derived from columns and rebuilt in every step, so a
//! checkpoint holds none of it.

use super::links::Link;
use crate::neighbours::cells::CellList;
use crate::operators::conjugate_gradient::Workspace;
use crate::operators::stencil::{Points, Stencil};
use crate::operators::tangent::{MinimalRotation, tangential};
use bevy_ecs::resource::Resource;
use froth_components::motion::{Normal, Position};
use glam::DVec3;

/// The stencil of the carriers at their present places, and the places and normals it was last built for as a whole.
#[derive(Resource, Default)]
pub struct FilmStencil(pub Stencil, Vec<(Position, Normal)>);

impl FilmStencil {
    /// Builds the stencil of these carriers, unless it is the one that stands.
    pub fn build_for(&mut self, points: Points) {
        let Points { positions, normals, .. } = points;
        let stand = self.1.len() == positions.len()
            && self.1.iter().zip(positions).zip(normals).all(|(((x, n), y), m)| x == y && n == m);
        if !stand {
            self.0.rebuild(points);
            self.1.clear();
            self.1.extend(positions.iter().copied().zip(normals.iter().copied()));
        }
    }

    /// Builds the stencil of carriers whose normals are still those of where they came from.
    pub fn build_in_passing(&mut self, points: Points) {
        self.0.rebuild(points);
        self.1.clear();
    }
}

/// How the particle sets are linked, and what was gathered. Places and planes are those of the step's start.
#[derive(Resource, Default)]
pub struct Transfers {
    /// Correction of each material particle's weights.
    pub links: Vec<Link>,
    /// Where the carriers stood.
    pub positions: Vec<Position>,
    /// Their normals.
    pub normals: Vec<Normal>,
    /// Their cells.
    pub cells: CellList,
    /// Areas that agree with the transfer, m^2, per carrier.
    pub dual_areas: Vec<f64>,
    /// Concentration before the present substep, `Gamma*`, mol/m^2, per carrier: gathered from the material, then as solved.
    pub concentration: Vec<f64>,
    /// Velocity that each material particle moves by, m/s; its own velocity is the flow's at the end of the step.
    pub drift: Vec<DVec3>,
}

/// Tangential flow on the carriers, relative to their films' [frames](super::frames).
#[derive(Resource, Default)]
pub struct TangentialFlow {
    /// As gathered, m/s, in the planes of the step's start.
    pub gathered: Vec<DVec3>,
    /// Before the present substep, m/s.
    pub present: Vec<DVec3>,
    /// After forces and the Marangoni solve of the present substep, m/s.
    pub solved: Vec<DVec3>,
    /// After the last substep so far, m/s, in the planes of the step's start.
    pub last: Vec<DVec3>,
    /// Displacement over the substeps so far, m, in the planes of the step's start.
    pub path: Vec<DVec3>,
}

impl TangentialFlow {
    /// Begins a step with the velocities gathered.
    pub fn begin(&mut self, gathered: impl Iterator<Item = DVec3>) {
        self.gathered.clear();
        self.gathered.extend(gathered);
        self.gathered.clone_into(&mut self.present);
        self.path.clear();
        self.path.resize(self.gathered.len(), DVec3::ZERO);
    }

    /// Velocity of carrier `i` at rest before the present substep, tangential and normal, m/s; `frame` is its film's,
    /// `speed` along the unit normal `n` that at rest.
    #[must_use]
    pub fn whole_velocity(&self, i: usize, frame: DVec3, n: DVec3, speed: f64) -> DVec3 {
        self.present.get(i).copied().unwrap_or_default() + tangential(frame, n) + n * speed
    }

    /// Ends a substep of `length` seconds, solved in the planes of `now` and followed back to those of `start`.
    pub fn follow(&mut self, start: &[Normal], now: &[Normal], length: f64) {
        let back = |(u, (a, b)): (&DVec3, (&Normal, &Normal))| {
            if a == b { *u } else { MinimalRotation::between(a.0, b.0).apply(*u) }
        };
        self.last.clear();
        self.last.extend(self.solved.iter().zip(now.iter().zip(start)).map(back));
        self.path.iter_mut().zip(&self.last).for_each(|(path, u)| *path += *u * length);
    }

    /// Turns what was solved in the planes of `before` into those of `after`, for the next substep.
    pub fn turn(&mut self, before: &[Normal], after: &[Normal]) {
        let turned =
            |(u, (a, b)): (&DVec3, (&Normal, &Normal))| tangential(MinimalRotation::between(a.0, b.0).apply(*u), b.0);
        self.present.clear();
        self.present.extend(self.solved.iter().zip(before.iter().zip(after)).map(turned));
    }
}

/// Work spaces of the linear solvers.
#[derive(Resource, Default)]
pub struct Solvers {
    /// Of the normal motion.
    pub normal_motion: Workspace,
    /// Of the Marangoni solve.
    pub marangoni: Workspace,
    /// Of the redistribution.
    pub redistribution: Workspace,
}
