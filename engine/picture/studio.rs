//! The room that the film mirrors: a dark stage between soft lights.
//!
//! ```text
//!                 backdrop (dark)          seen from above; the lights turn with the camera,
//!            rim \               / rim     so that every shot is lit alike
//!   window  |          film         |  window
//!             \                   /
//!                    camera
//! ```
//! Luminances are in units of the display white at exposure 1; a thin film mirrors a few hundredths of them.
//! Source: none; authored. Every soft edge is a cubic step, so that highlights have no jagged border.
//! Limits: lights lie infinitely far away; the film casts no light on itself.

use super::colour::decode_srgb;
use glam::{Vec2, Vec3};
use serde::Deserialize;

/// What is seen behind the film. Colours are sRGB, each channel 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Background {
    /// Colour at the middle of the picture.
    pub centre: Vec3,
    /// Colour at the corners.
    pub edge: Vec3,
}

impl Default for Background {
    /// Charcoal, a little lighter behind the film.
    fn default() -> Self {
        Self { centre: Vec3::new(0.105, 0.112, 0.13), edge: Vec3::new(0.035, 0.037, 0.045) }
    }
}

impl Background {
    pub(super) fn backdrop(&self) -> Backdrop {
        let linear = |colour: Vec3| Vec3::from_array(colour.to_array().map(decode_srgb));
        Backdrop { centre: linear(self.centre), edge: linear(self.edge) }
    }
}

/// A background in linear sRGB.
#[derive(Clone, Copy, Debug)]
pub(super) struct Backdrop {
    centre: Vec3,
    edge: Vec3,
}

impl Backdrop {
    /// Linear sRGB at a place in the picture, from (-1, -1) to (1, 1).
    pub(super) fn at(&self, place: Vec2) -> Vec3 {
        self.centre.lerp(self.edge, soft_step(0.0, 1.35, place.length()))
    }
}

/// A flat light far away, with soft edges.
#[derive(Clone, Copy, Debug)]
struct Softbox {
    middle: Vec3,
    right: Vec3,
    up: Vec3,
    /// Tangent of half the angle it fills, across and up.
    half_size: Vec2,
    /// Width of the soft border, in the units of `half_size`.
    softness: f32,
    /// Half width of the bars between the panes of a window; 0 for none.
    bar: f32,
    radiance: Vec3,
}

impl Softbox {
    fn facing(middle: Vec3, half_size: Vec2, radiance: Vec3) -> Self {
        let middle = middle.normalize();
        let right = Vec3::Y.cross(middle).normalize();
        Self { middle, right, up: middle.cross(right), half_size, softness: 0.06, bar: 0.0, radiance }
    }

    fn radiance_from(&self, direction: Vec3) -> Vec3 {
        let ahead = direction.dot(self.middle);
        if ahead <= 0.05 {
            return Vec3::ZERO;
        }
        let place = Vec2::new(direction.dot(self.right), direction.dot(self.up)) / ahead;
        let inside = self.half_size - place.abs();
        let share = soft_step(0.0, self.softness, inside.x) * soft_step(0.0, self.softness, inside.y);
        if share <= 0.0 {
            return Vec3::ZERO;
        }
        // A window is brightest towards the sky.
        let height = 0.5 + 0.5 * place.y / self.half_size.y;
        self.radiance * (share * self.panes(place) * (0.72 + 0.28 * height))
    }

    fn panes(&self, place: Vec2) -> f32 {
        if self.bar == 0.0 {
            return 1.0;
        }
        let clear = |distance: f32| soft_step(self.bar, 1.9 * self.bar, distance);
        clear(place.x.abs()) * clear((place.y - 0.1 * self.half_size.y).abs())
    }
}

/// The lights around the film, in camera axes: right, up, back.
#[derive(Clone, Debug)]
pub(super) struct Studio {
    lights: Vec<Softbox>,
}

impl Studio {
    /// Two windows on the camera's side, two strips behind the film for its rim.
    pub(super) fn new() -> Self {
        let window = |middle, half_size, radiance| Softbox {
            bar: 0.028,
            softness: 0.035,
            ..Softbox::facing(middle, half_size, radiance)
        };
        let strip =
            |middle| Softbox { softness: 0.35, ..Softbox::facing(middle, Vec2::new(0.45, 1.4), Vec3::splat(1.3)) };
        let lights = vec![
            window(Vec3::new(-0.75, 0.62, 0.62), Vec2::new(0.33, 0.46), 20.0 * Vec3::new(0.97, 1.0, 1.04)),
            window(Vec3::new(0.95, 0.35, 0.45), Vec2::new(0.20, 0.42), 8.0 * Vec3::new(1.05, 1.0, 0.94)),
            strip(Vec3::new(-0.95, 0.2, -0.7)),
            strip(Vec3::new(0.95, 0.2, -0.7)),
        ];
        Self { lights }
    }

    /// Linear sRGB radiance that arrives from a unit direction.
    pub(super) fn radiance(&self, direction: Vec3) -> Vec3 {
        self.lights.iter().fold(walls(direction), |sum, light| sum + light.radiance_from(direction))
    }
}

/// The white tent around the stage: bright above, dim below and towards the backdrop, a large soft light behind the camera.
///
/// The tent dims towards the back because film seen at an angle mirrors more of it: the middle and the rim of a bubble
/// then fit one exposure.
fn walls(direction: Vec3) -> Vec3 {
    let ceiling = soft_step(-0.9, 0.9, direction.y);
    let front = soft_step(-0.9, 0.7, direction.z);
    let glow = soft_step(0.72, 1.0, direction.dot(GLOW));
    let backdrop = soft_step(0.93, 0.995, -direction.z);
    let tent = (0.6 + 1.9 * ceiling) * (0.5 + 0.75 * front) + 6.5 * glow;
    Vec3::new(0.99, 1.0, 1.02) * (tent * (1.0 - backdrop) + 0.22 * backdrop)
}

/// Middle of the light behind the camera, a little below it: a flat film that faces a slightly raised camera mirrors this
/// light and nothing else.
const GLOW: Vec3 = Vec3::new(0.0, -0.287, 0.958);

/// Cubic step from 0 at `from` to 1 at `to`.
fn soft_step(from: f32, to: f32, at: f32) -> f32 {
    let t = ((at - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::{Background, Studio};
    use glam::{Vec2, Vec3};

    #[test]
    fn light_comes_from_everywhere_but_least_from_the_backdrop() {
        let studio = Studio::new();
        let backdrop = studio.radiance(Vec3::NEG_Z).max_element();
        for step in 0..500 {
            let height = 1.0 - 2.0 * (step as f32 + 0.5) / 500.0;
            let (sin, cos) = (2.399_963 * step as f32).sin_cos();
            let direction = Vec3::new(cos, 0.0, sin) * (1.0 - height * height).sqrt() + height * Vec3::Y;
            let light = studio.radiance(direction);
            assert!(light.is_finite() && light.min_element() > 0.0 && light.max_element() >= 0.9 * backdrop);
        }
    }

    #[test]
    fn the_background_darkens_towards_the_corners() {
        let background = Background::default().backdrop();
        assert!(background.at(Vec2::ZERO).y > background.at(Vec2::ONE).y);
    }
}
