//! A film: how thick it is at the start, and how the surfactant lies on it.
//!
//! Lengths of patterns are relative to the shape: frequencies count noise cells per [`Shape::size`](super::shape::Shape::size).

use bevy_ecs::component::Component;
use serde::Deserialize;

use crate::quantity::{Direction, Length, Ratio, range};

/// Makes the shape of the same entity a soap film.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Film {
    /// Thickness `η` at the start, metres.
    pub thickness: ThicknessField,
    /// Surfactant `Γ` at the start. Default [`SurfactantField::Uniform`].
    #[serde(default)]
    pub surfactant: SurfactantField,
    /// Warmth `T` at the start: 0 is the surroundings, 1 the inside of a [`HeatSource`](super::field::HeatSource). Default 0.
    #[serde(default, deserialize_with = "range::fraction")]
    pub warmth: Ratio,
}

/// Thickness over the film. Values below a tenth of the mean are raised to it.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub enum ThicknessField {
    /// The same everywhere, metres.
    Uniform(#[serde(deserialize_with = "range::film_thickness")] Length),
    /// Changes along a direction.
    Gradient(ThicknessGradient),
    /// Varies at random.
    Noise(ThicknessNoise),
    /// Varies as a plane wave.
    Wave(ThicknessWave),
}

impl ThicknessField {
    /// Mean thickness over the film, metres (of a gradient: half way).
    #[must_use]
    pub fn mean(&self) -> f64 {
        match self {
            Self::Uniform(thickness) => thickness.si(),
            Self::Gradient(gradient) => 0.5 * (gradient.from.si() + gradient.to.si()),
            Self::Noise(noise) => noise.mean.si(),
            Self::Wave(wave) => wave.mean.si(),
        }
    }
}

/// `η` linear in `x · direction`, from the film's lowest point along it to its highest.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThicknessGradient {
    /// Thickness at the lowest point, metres.
    #[serde(deserialize_with = "range::film_thickness")]
    pub from: Length,
    /// Thickness at the highest point, metres.
    #[serde(deserialize_with = "range::film_thickness")]
    pub to: Length,
    /// Direction of the change. Default: y.
    #[serde(default = "along_y")]
    pub direction: Direction,
    /// Noise on top, relative to the gradient's own thickness at each point. Default: none.
    #[serde(default)]
    pub noise: Option<RelativeNoise>,
}

/// `η = mean * (1 + relative * noise)`, with noise of mean 0 and standard deviation 1 over the film.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThicknessNoise {
    /// Mean thickness, metres.
    #[serde(deserialize_with = "range::film_thickness")]
    pub mean: Length,
    /// Standard deviation relative to the mean, 0 to 0.9. Default 0.15.
    #[serde(default = "usual_deviation", deserialize_with = "range::relative_deviation")]
    pub relative: Ratio,
    /// Noise cells per size. Default 5.
    #[serde(default = "usual_frequency", deserialize_with = "range::positive")]
    pub frequency: Ratio,
    /// Layers of noise, each of half the length and half the height. Default 2.
    #[serde(default = "usual_octaves", deserialize_with = "range::octaves")]
    pub octaves: u32,
    /// Seed of the noise. Default: made from the scene's seed and the entity's place in the file.
    #[serde(default)]
    pub seed: Option<u64>,
}

/// A factor `1 + relative * noise`, with noise of mean 0 and standard deviation 1 over the film.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RelativeNoise {
    /// Standard deviation of the factor, 0 to 0.9. Default 0.15.
    #[serde(default = "usual_deviation", deserialize_with = "range::relative_deviation")]
    pub relative: Ratio,
    /// Noise cells per size. Default 5.
    #[serde(default = "usual_frequency", deserialize_with = "range::positive")]
    pub frequency: Ratio,
    /// Layers of noise, each of half the length and half the height. Default 2.
    #[serde(default = "usual_octaves", deserialize_with = "range::octaves")]
    pub octaves: u32,
    /// Seed of the noise. Default: made from the scene's seed and the entity's place in the file.
    #[serde(default)]
    pub seed: Option<u64>,
}

/// `η = mean * (1 + relative * sin(2π wavelengths s + phase))`, `s` from 0 at the film's lowest point along `direction` to 1 at its highest.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThicknessWave {
    /// Mean thickness, metres.
    #[serde(deserialize_with = "range::film_thickness")]
    pub mean: Length,
    /// Amplitude relative to the mean, 0 to 0.9. Default 0.15.
    #[serde(default = "usual_deviation", deserialize_with = "range::relative_deviation")]
    pub relative: Ratio,
    /// Wavelengths over the film's extent along `direction`. Default 1.
    #[serde(default = "one", deserialize_with = "range::positive")]
    pub wavelengths: Ratio,
    /// Direction of the wave. Default: y.
    #[serde(default = "along_y")]
    pub direction: Direction,
    /// Phase at the lowest point. Default 0.
    #[serde(default)]
    pub phase: crate::quantity::Angle,
}

/// Surfactant over the film, as a multiple of the concentration at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum SurfactantField {
    /// `Γ = Γ0` everywhere: the tension is uniform whatever the thickness.
    #[default]
    Uniform,
    /// `Γ = Γ0 η / mean η`: thick places carry more surfactant and pull less.
    WithThickness,
}

fn along_y() -> Direction {
    Direction::Y
}

fn usual_deviation() -> Ratio {
    Ratio::from_si(0.15)
}

fn usual_frequency() -> Ratio {
    Ratio::from_si(5.0)
}

fn usual_octaves() -> u32 {
    2
}

fn one() -> Ratio {
    Ratio::from_si(1.0)
}
