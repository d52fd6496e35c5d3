//! What acts on every film of a scene. Each is one component of an entity of its own, written like `[ Gravity((0.0, -9.81, 0.0)) ]`.

use bevy_ecs::component::Component;
use serde::Deserialize;

use super::shape::Place;
use crate::quantity::{Direction, Keyframed, Length, Pressure, Rate, Ratio, Speed, Time, Vector, dimension, range};

/// Gravity `g`, metres per second squared, the same everywhere; may be keyframed.
#[derive(Component, Clone, Debug, PartialEq, Deserialize)]
pub struct Gravity(pub Keyframed<Vector<dimension::Acceleration>>);

/// Wind drags the film along: `du/dt = drag * (velocity - u)`.
///
/// Under vortex sheets the air itself has this velocity, besides what the films' circulation makes of it; films have no mass, so they go
/// with it at once, and `drag` does nothing.
#[derive(Component, Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wind {
    /// Velocity of the air, metres per second; may be keyframed.
    pub velocity: Keyframed<Vector<dimension::Speed>>,
    /// Rate at which the film takes up the velocity of the air, per second. Default 5.
    #[serde(default = "usual_drag", deserialize_with = "range::not_negative")]
    pub drag: Rate,
}

fn usual_drag() -> Rate {
    Rate::from_si(5.0)
}

/// A warm place, above which the film rises: gravity acts as `g (1 - expansion * T)`.
///
/// The warmth `T` of the film, 0 to 1, follows `dT/dt = w (1 - T) / warming - (1 - w) T / cooling`, `w = exp(-|x - position|² / radius²)`.
/// Without gravity it does nothing.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeatSource {
    /// Centre of the warm place, metres.
    pub position: Place,
    /// Its radius, metres.
    #[serde(deserialize_with = "range::positive")]
    pub radius: Length,
    /// Time the film takes to warm up inside, seconds. Default 0.1 s.
    #[serde(default = "usual_warming", deserialize_with = "range::positive")]
    pub warming: Time,
    /// Time it takes to cool down outside, seconds. Default 0.6 s.
    #[serde(default = "usual_cooling", deserialize_with = "range::positive")]
    pub cooling: Time,
    /// Part of its weight that the film loses at `T = 1` (β, plain number). Above 1 it rises. Default 0.3.
    #[serde(default = "usual_expansion")]
    pub expansion: Ratio,
}

fn usual_warming() -> Time {
    Time::from_si(0.1)
}

fn usual_cooling() -> Time {
    Time::from_si(0.6)
}

fn usual_expansion() -> Ratio {
    Ratio::from_si(0.3)
}

/// A pulse of air pressure that travels over the film: `p(t) exp(-(s/width)²)`, `s = x · direction - start - speed * t`.
///
/// It pushes along the film's normal, as air does, whatever the film's thickness. At rest a long film of width `L` bows by
/// about `p L² / (16 σ)` under an even pressure: at 25 mN/m and 9 cm, 2 cm per pascal.
#[derive(Component, Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sweep {
    /// Pressure `p` at the middle of the pulse, pascals; positive pushes along the film's normal; may be keyframed.
    pub pressure: Keyframed<Pressure>,
    /// Where the pulse travels. Default: x.
    #[serde(default = "along_x")]
    pub direction: Direction,
    /// Half width of the pulse along `direction`, metres.
    #[serde(deserialize_with = "range::positive")]
    pub width: Length,
    /// How fast it travels, metres per second.
    pub speed: Speed,
    /// Where it is at the start, `x · direction` in metres. Default 0.
    #[serde(default)]
    pub start: Length,
}

fn along_x() -> Direction {
    Direction::X
}

/// Holds bubbles up: a hydrostatic pressure difference carries the weight of each film, so that it deforms and drains but does not fall.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hover {}

/// Still air brakes the film: `du/dt = -rate * u` for the liquid along the film, `ds/dt = -normal * s` for the film's own
/// motion along its normal (shape oscillations; in air a bubble of 10 cm loses them at a few per second).
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AirDrag {
    /// Rate for the flow along the film, per second.
    #[serde(deserialize_with = "range::not_negative")]
    pub rate: Rate,
    /// Rate for the motion along the normal, per second. Default 0.
    #[serde(default, deserialize_with = "range::not_negative")]
    pub normal: Rate,
}
