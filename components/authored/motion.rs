//! How a film moves at the start. Several of these on one entity add up.

use bevy_ecs::component::Component;
use serde::{Deserialize, Deserializer};

use super::perturbation::check_order;
use crate::quantity::{AngularSpeed, Direction, Ratio, Refusal, Speed, Vector, dimension, range};

/// The whole film moves: `u = velocity`, metres per second.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Drift(pub Vector<dimension::Speed>);

/// The liquid turns like a rigid body within the film: `u = P (rate * axis × (x - centre))`, `P` the projection on the tangent plane.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spin {
    /// Axis through the centre. Default: y.
    #[serde(default = "along_y")]
    pub axis: Direction,
    /// Angular speed, radians per second, counterclockwise seen from the tip of the axis.
    pub rate: AngularSpeed,
}

fn along_y() -> Direction {
    Direction::Y
}

/// The liquid swirls within the film: `u = n × ∇ψ`, divergence free, scaled to a root mean square speed.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Swirl {
    /// Stream function `ψ`. Default: noise.
    #[serde(default)]
    pub pattern: SwirlPattern,
    /// Root mean square speed over the film, metres per second.
    #[serde(deserialize_with = "range::not_negative")]
    pub speed: Speed,
}

/// Stream function of a [`Swirl`].
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub enum SwirlPattern {
    /// Perlin noise: many eddies.
    Noise(SwirlNoise),
    /// One spherical harmonic about the y axis.
    Harmonic(SwirlHarmonic),
}

impl Default for SwirlPattern {
    fn default() -> Self {
        Self::Noise(SwirlNoise::default())
    }
}

/// Eddies at random.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SwirlNoise {
    /// Noise cells per size of the shape. Default 3.
    #[serde(deserialize_with = "range::positive")]
    pub frequency: Ratio,
    /// Layers of noise, each of half the length and half the height. Default 1.
    #[serde(deserialize_with = "range::octaves")]
    pub octaves: u32,
    /// Seed of the noise. Default: made from the scene's seed and the entity's place in the file.
    pub seed: Option<u64>,
}

impl Default for SwirlNoise {
    fn default() -> Self {
        Self { frequency: Ratio::from_si(3.0), octaves: 1, seed: None }
    }
}

/// A regular pattern of eddies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SwirlHarmonic {
    /// Degree, 1 to 64; 1 with order 0 is a rigid rotation about y.
    pub degree: u32,
    /// Order, from `-degree` to `degree`. Default 0.
    pub order: i32,
}

impl<'de> Deserialize<'de> for SwirlHarmonic {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(rename = "Harmonic", deny_unknown_fields)]
        struct Fields {
            #[serde(deserialize_with = "range::harmonic_degree")]
            degree: u32,
            #[serde(default)]
            order: i32,
        }
        let Fields { degree, order } = Fields::deserialize(deserializer)?;
        check_order(degree, order).map_err(Refusal::into_serde)?;
        Ok(Self { degree, order })
    }
}
