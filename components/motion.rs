//! Where things are and how they move.

use glam::{DMat3, DVec3};

columns! {
    /// Place `x`, metres.
    pub struct Position(DVec3), "position", "m";
    /// Velocity `u` of the film's liquid, metres per second. On Eulerian particles the whole vector; on Lagrangian
    /// particles its tangential part (the normal part lives on the Eulerian particles, see [`NormalSpeed`]).
    pub struct Velocity(DVec3), "velocity", "m/s";
    /// Whether a wire holds a mesh vertex: 1 if so, else 0. Held vertices move only as their wire does; edges between them
    /// are drawn as wires.
    pub struct Pinned(u64), "pinned", "1";
    /// Unit normal `n` of the film, from the back to the front region; outward on a closed bubble.
    pub struct Normal(DVec3), "normal", "1";
    /// Speed `s = u.n` with which the film moves along its normal, metres per second.
    pub struct NormalSpeed(f64), "normal_speed", "m/s";
    /// Affine part `A` of the velocity around a Lagrangian particle, `u(x) = u + A (x - x_L)`, 1/s. Maps tangent
    /// vectors to tangent vectors (Jiang 2015; Deng 2022, Eqs 16 to 18).
    pub struct VelocityGradient(DMat3), "velocity_gradient", "1/s";
    /// Sum of the external forces per mass of liquid, m/s^2. Cleared, then written by the systems in the `Forces`
    /// stage: this is the plug-in point for new forces.
    pub struct ExternalAcceleration(DVec3), "external_acceleration", "m/s^2";
    /// Sum of the external forces per film area along the normal that do not act on the liquid's mass but on the
    /// film as a surface (support, drag on the normal motion, a sweep), Pa. Cleared, then written in the `Forces` stage.
    pub struct ExternalPressure(f64), "external_pressure", "Pa";
}
