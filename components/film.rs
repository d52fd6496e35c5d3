//! What a film is made of and how it is shaped.
//!
//! Conventions, drawn once:
//!
//! ```text
//!        front region (outside)         n   unit normal, from back to front; outward on a bubble
//!             ^ n                       kappa = div n, the SUM of principal curvatures: +2/R on a sphere
//!   __________|___________              film tension is 2 sigma (two interfaces)
//!     liquid, thickness eta             p_in - p_out = 2 sigma kappa = 4 sigma/R at rest
//!   ----------------------              Gamma: mol per m^2 of ONE interface
//!        back region (inside)           sigma = sigma0 - R T Gamma,  elasticity E = R T Gamma0
//! ```

use glam::DMat3;

columns! {
    /// Film area `a` that a particle stands for, m^2. Written in the `Geometry` stage.
    pub struct Area(f64), "area", "m^2";
    /// Film thickness `eta`, metres (soap films: 1e-8 to 1e-5). Written in the `Geometry` stage on
    /// Eulerian particles, in `Scatter` on Lagrangian ones.
    pub struct Thickness(f64), "thickness", "m";
    /// Surfactant concentration `Gamma` of one interface, mol/m^2. Written by the Marangoni solve; moves along
    /// with the redistribution.
    pub struct Surfactant(f64), "surfactant", "mol/m^2";
    /// Surface tension `sigma` of one interface, N/m. Written by the Marangoni solve.
    pub struct SurfaceTension(f64), "surface_tension", "N/m";
    /// Mean curvature `kappa = div n`: the sum of the principal curvatures, 1/m; `2/R` on a sphere.
    pub struct MeanCurvature(f64), "mean_curvature", "1/m";
    /// Shape operator `S = grad n` as a symmetric tangential matrix, 1/m; `I/R` on a sphere's tangent plane.
    pub struct ShapeOperator(DMat3), "shape_operator", "1/m";
    /// Liquid volume, m^3. Conserved on Lagrangian particles; gathered on Eulerian ones.
    pub struct LiquidVolume(f64), "liquid_volume", "m^3";
    /// Amount of surfactant on one interface, mol. Conserved on Lagrangian particles; gathered on Eulerian ones.
    pub struct SurfactantAmount(f64), "surfactant_amount", "mol";
    /// Excess temperature, as a fraction of the heat source's own: 0 is ambient, 1 fully warmed.
    pub struct Warmth(f64), "warmth", "1";
}
