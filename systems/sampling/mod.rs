//! From authored shapes to particles.
//!
//! * [`spread`]: even, quasi-random point sets on spheres, discs and rectangles.
//! * [`surface`]: an authored shape with its perturbation as places and normals, carriers, liquid, and wall layers.
//! * [`field`]: authored initial fields: thickness, concentration, flow.
//! * [`random`]: counter-based random numbers; [`harmonic`]: real spherical harmonics.

pub mod field;
pub mod harmonic;
pub mod random;
pub mod spread;
pub mod surface;
