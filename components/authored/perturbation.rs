//! Small deviations of a film from its shape at the start.
//!
//! Amplitudes are relative to [`Shape::size`](super::shape::Shape::size): the radius of a sphere.

use bevy_ecs::component::Component;
use glam::DVec3;
use serde::{Deserialize, Deserializer};

use crate::quantity::{Ratio, Refusal, RefusalKind, Vector, dimension, range};

/// Bumps all over: `x += amplitude * size * noise(frequency * (x - centre) / size) * n`, Perlin noise of about -1 to 1.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Bumps {
    /// Height of the bumps relative to the size, 0 to 0.9. Default 0.06.
    #[serde(deserialize_with = "range::relative_deviation")]
    pub amplitude: Ratio,
    /// Cells of the noise lattice per size (per radius of a sphere). Default 5.
    #[serde(deserialize_with = "range::positive")]
    pub frequency: Ratio,
    /// Layers of noise, each of half the length and half the height. Default 2.
    #[serde(deserialize_with = "range::octaves")]
    pub octaves: u32,
    /// Seed of the noise. Default: made from the scene's seed and the entity's place in the file.
    pub seed: Option<u64>,
}

impl Default for Bumps {
    fn default() -> Self {
        Self { amplitude: Ratio::from_si(0.06), frequency: Ratio::from_si(5.0), octaves: 2, seed: None }
    }
}

/// Stretches films about the centre of their shape along x, y and z: `x -> centre + stretch * (x - centre)`. Bubbles have the volumes of
/// the stretched shape; factors whose product is 1 leave them as they are.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct Stretch(DVec3);

impl Stretch {
    /// Factors along x, y and z, dimensionless.
    #[must_use]
    pub const fn si(self) -> DVec3 {
        self.0
    }
}

impl<'de> Deserialize<'de> for Stretch {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let factors = Vector::<dimension::Ratio>::deserialize(deserializer)?.si();
        if factors.to_array().iter().all(|factor| (0.1..=10.0).contains(factor)) {
            return Ok(Self(factors));
        }
        let wrong = factors.to_array().into_iter().find(|factor| !(0.1..=10.0).contains(factor)).unwrap_or_default();
        let help = "write three factors from 0.1 to 10, e.g. (1.3, 0.9, 0.85)";
        Err(Refusal::new(RefusalKind::OutOfRange, format!("films cannot be stretched by {wrong}"), help).into_serde())
    }
}

/// One spherical harmonic: `x += amplitude * size * Y(degree, order) * n`.
///
/// Real harmonics about the y axis, scaled to a largest value of 1. Order 0 is symmetric about y; negative orders are the sines.
/// For shapes that are round: [`Sphere`](super::shape::Sphere), [`Ellipsoid`](super::shape::Ellipsoid), [`HalfSphere`](super::shape::HalfSphere).
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct HarmonicMode {
    /// Degree, 1 to 64; 2 is the lowest that changes the shape of a sphere and does not merely move it.
    pub degree: u32,
    /// Order, from `-degree` to `degree`. Default 0.
    pub order: i32,
    /// Largest displacement relative to the size, 0 to 0.9.
    pub amplitude: Ratio,
}

impl<'de> Deserialize<'de> for HarmonicMode {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(rename = "HarmonicMode", deny_unknown_fields)]
        struct Fields {
            #[serde(deserialize_with = "range::harmonic_degree")]
            degree: u32,
            #[serde(default)]
            order: i32,
            #[serde(deserialize_with = "range::relative_deviation")]
            amplitude: Ratio,
        }
        let Fields { degree, order, amplitude } = Fields::deserialize(deserializer)?;
        check_order(degree, order).map_err(Refusal::into_serde)?;
        Ok(Self { degree, order, amplitude })
    }
}

/// A spherical harmonic has orders from `-degree` to `degree`.
pub(super) fn check_order(degree: u32, order: i32) -> Result<(), Refusal> {
    if order.unsigned_abs() <= degree {
        return Ok(());
    }
    let message = format!("a harmonic of degree {degree} has no order {order}");
    Err(Refusal::new(RefusalKind::Contradiction, message, format!("write an order from -{degree} to {degree}")))
}
