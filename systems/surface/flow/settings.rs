//! Knobs of the geometric flow.

use super::conjugate_gradient::StopRule;

/// What resists the motion of films.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// Their mass: films swing.
    Inertial,
    /// Friction: velocity = `mobility` x force per film area.
    Overdamped {
        /// Velocity per force per area, m/s per Pa.
        mobility: f64,
    },
}

/// How a step is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Symplectic Euler (inertial) or forward Euler (overdamped) in as many substeps as stability asks for.
    Explicit,
    /// One step with tension taken at its end, the stiffness frozen at its start. Stable for every length of step.
    ///
    /// Inertial motion loses what backward Euler loses: a mode of stiffness `k` per mass (1/s^2) is damped at the rate
    /// `k Δt / 2` where `sqrt(k) Δt` is small, and within a step or two where it is large. `k` is that of the frozen
    /// stiffness: `β (l (l + 1) + 2) / R²` for the shape mode `l` of a bubble, whose frequency is
    /// `ω² = β (l - 1)(l + 2) / R²`. Choose it for films whose fast ripples do not matter.
    Implicit,
}

/// What becomes of the tension force along the film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tangential {
    /// Kept: the exact gradient. Momentum is conserved, and rest is a true minimum of the discrete area.
    Keep,
    /// The part of the tension force that changes no volume to first order is removed: along films, and along borders;
    /// nothing where borders meet. Vertices do not drift along films. Free clusters get the net force and torque back as
    /// a rigid acceleration ([`rigid`](super::rigid)): momentum is conserved here too.
    Remove,
}

/// Knobs of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// What resists.
    pub motion: Motion,
    /// How a step is taken.
    pub scheme: Scheme,
    /// What becomes of the tension force along the film.
    pub tangential: Tangential,
    /// Velocities lose the factor `exp(-rate Δt)` per step, 1/s.
    pub damping_rate: f64,
    /// Explicit substeps as a fraction of the stable step, dimensionless.
    pub explicit_safety: f64,
    /// More explicit substeps than this in one step are an error.
    pub max_substeps: u32,
    /// Largest relative error of a volume, dimensionless.
    pub volume_tolerance: f64,
    /// Most iterations of the volume projection.
    pub max_projection_iterations: u32,
    /// Implicit scheme: solves per step, each with the pressures that the one before asked for. At 1 pressures lag by a
    /// step; rest is exact for every number.
    pub pressure_sweeps: u32,
    /// Implicit scheme: when the linear solve stops.
    pub solve: StopRule,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            motion: Motion::Inertial,
            scheme: Scheme::Explicit,
            tangential: Tangential::Keep,
            damping_rate: 0.0,
            explicit_safety: 0.8,
            max_substeps: 1000,
            volume_tolerance: 1e-13,
            max_projection_iterations: 30,
            pressure_sweeps: 2,
            solve: StopRule { tolerance: 1e-8, max_iterations: 2000 },
        }
    }
}
