//! How the lines of a foam look: channels of liquid, and wires.
//!
//! Equation: a channel is a round rod of liquid. It mirrors the share `F` (Fresnel) of the room; the rest is bent towards the
//! rod's axis on its way in and as much again on its way out, so that the ray leaves along `2 (d·t) t - d`, with `t` the ray
//! inside. A wire mirrors a fixed share of the room. Source: Snell's law and [`optics`](super::optics); the share of light
//! that passes a channel straight, and the wire's metal, are authored.
//! A thin rod turns its normal by a right angle within a few samples, and lights are bright and small: each sample takes the
//! mean over [`SLICES`] of its width, or highlights would break up into beads.
//! Limits: what a channel shows is the bare room, not the films behind it bent; real channels have concave sides.

use super::optics::{SOAP_SOLUTION_INDEX, surface_reflectance};
use super::shade::{Layer, Surface};
use super::studio::Studio;
use glam::Vec3;

/// Share of the light behind a channel that passes it straight.
const STRAIGHT: f32 = 0.5;
/// Share of the light that a channel bends and that reaches the eye: liquid channels scatter.
const BENT: f32 = 0.2;
/// Slices of a sample's width.
const SLICES: u8 = 8;
/// Reflectance of a wire, linear sRGB.
const METAL: Vec3 = Vec3::new(0.30, 0.29, 0.28);
/// Colours of channels and wires on a map, linear sRGB.
const INK: Vec3 = Vec3::splat(0.012);
const DULL_METAL: Vec3 = Vec3::splat(0.22);

/// A channel of liquid in the studio.
pub(super) fn channel(ray: Vec3, line: &Surface, studio: &Studio) -> Layer {
    mean(line, |normal| channel_slice(ray, normal, studio))
}

/// A wire in the studio.
pub(super) fn wire(ray: Vec3, line: &Surface, studio: &Studio) -> Layer {
    mean(line, |normal| {
        let mirrored = ray - 2.0 * ray.dot(normal) * normal;
        Layer { passes: Vec3::ZERO, adds: METAL * studio.radiance(mirrored) }
    })
}

/// Mean of a line's slices across a sample.
fn mean(line: &Surface, slice: impl Fn(Vec3) -> Layer) -> Layer {
    let Some(side) = line.spread.try_normalize() else { return slice(line.normal) };
    let (across, half_width) = (line.normal.dot(side), line.spread.length());
    let front = (line.normal - across * side).normalize_or(line.normal);
    let mut sum = Layer { passes: Vec3::ZERO, adds: Vec3::ZERO };
    for k in 0..SLICES {
        let off = (2.0 * f32::from(k) + 1.0) / f32::from(SLICES) - 1.0;
        let across = (across + off * half_width).clamp(-1.0, 1.0);
        let Layer { passes, adds } = slice(across * side + (1.0 - across * across).sqrt() * front);
        sum = Layer { passes: sum.passes + passes / f32::from(SLICES), adds: sum.adds + adds / f32::from(SLICES) };
    }
    sum
}

fn channel_slice(ray: Vec3, normal: Vec3, studio: &Studio) -> Layer {
    let cos = (-ray.dot(normal)).clamp(0.0, 1.0);
    let (s, p) = surface_reflectance(SOAP_SOLUTION_INDEX, f64::from(cos));
    let mirrored = 0.5 * (s + p) as f32;
    let inside = ray.refract(normal, 1.0 / SOAP_SOLUTION_INDEX as f32);
    let bent = 2.0 * ray.dot(inside) * inside - ray;
    let light = mirrored * studio.radiance(ray + 2.0 * cos * normal) + (1.0 - mirrored) * BENT * studio.radiance(bent);
    Layer { passes: Vec3::splat((1.0 - mirrored) * STRAIGHT), adds: light }
}

/// A channel on a colour map.
pub(super) fn ink() -> Layer {
    Layer { passes: Vec3::ZERO, adds: INK }
}

/// A wire on a colour map, seen at this cosine.
pub(super) fn dull_metal(cos: f32) -> Layer {
    Layer { passes: Vec3::ZERO, adds: DULL_METAL * (0.3 + 0.7 * cos.clamp(0.0, 1.0)) }
}

#[cfg(test)]
mod tests {
    use super::{channel, wire};
    use crate::picture::shade::Surface;
    use crate::picture::studio::Studio;
    use glam::Vec3;

    #[test]
    fn a_highlight_does_not_break_up_when_the_line_shifts_by_parts_of_a_sample() {
        let (studio, ray) = (Studio::new(), Vec3::NEG_Z);
        // A vertical wire two samples in radius: the light of all its samples, for shifts of a tenth of a sample.
        let light = |shift: f32| {
            let samples = (-2..2).map(|k| (k as f32 + 0.5 + shift) / 2.0).filter(|across| across.abs() < 1.0);
            let normal = |across: f32| Vec3::new(across, 0.0, (1.0 - across * across).sqrt());
            let surface = |across| Surface { normal: normal(across), spread: 0.25 * Vec3::X, ..Surface::default() };
            samples.map(|across| wire(ray, &surface(across), &studio).adds.y).sum::<f32>()
        };
        let lights: Vec<f32> = (0..5).map(|k| light(0.1 * k as f32 - 0.2)).collect();
        let (least, most) = lights.iter().fold((f32::MAX, 0.0_f32), |(l, m), x| (l.min(*x), m.max(*x)));
        assert!(most < 1.35 * least, "{lights:?}");
    }

    #[test]
    fn a_channel_takes_no_more_light_from_behind_than_it_gets() {
        for across in [-0.99_f32, -0.5, 0.0, 0.7] {
            let normal = Vec3::new(across, 0.0, (1.0 - across * across).sqrt());
            let layer = channel(Vec3::NEG_Z, &Surface { normal, ..Surface::default() }, &Studio::new());
            assert!(layer.passes.min_element() >= 0.0 && layer.passes.max_element() < 1.0);
            assert!(layer.adds.is_finite() && layer.adds.min_element() > 0.0);
        }
    }
}
