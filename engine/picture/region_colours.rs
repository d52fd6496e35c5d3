//! One colour per pair of regions: which film is which.
//!
//! Hues follow the plastic-number sequence over the two region numbers, so that the films of neighbouring numbers differ, and
//! a film keeps its colour over a run. Source: Roberts 2018 (the R₂ sequence).

use super::film_network::FilmNetwork;
use super::triangles::FilmTriangles;
use glam::Vec3;
use std::f32::consts::TAU;

/// Fractions of the plastic number and its square, the steps of the R₂ sequence.
const STEPS: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053];

/// Least cosine between a film and the view: beyond, it hides no more.
const SHALLOWEST: f32 = 0.02;

/// Films in one colour each.
#[derive(Clone, Debug)]
pub(super) struct RegionsLook {
    /// Linear sRGB per film.
    pub colours: Vec<Vec3>,
    /// Share of the light behind a film seen face-on that it hides, 0 to 1.
    pub opacity: f32,
    /// Darkening of surfaces seen at an angle, 0 to 1.
    pub relief: f32,
}

impl RegionsLook {
    /// Colours of all films of a mesh.
    pub(super) fn colours_of(mesh: &FilmTriangles, network: &FilmNetwork) -> Vec<Vec3> {
        let mut colours = Vec::new();
        for (film, labels) in network.films.iter().zip(mesh.labels) {
            // Films are numbered in the order of their first triangles.
            if *film as usize == colours.len() {
                colours.push(colour_between(*labels));
            }
        }
        colours
    }

    /// Share of the light behind a film that it hides at this cosine to the view.
    ///
    /// Equation: `1 - (1 - opacity)^(1/cos)`, as light has `1/cos` as far to go in a tinted film (Beer). So round films have
    /// outlines, and what is inside is seen through their middles.
    pub(super) fn hides(&self, cos: f32) -> f32 {
        1.0 - (1.0 - self.opacity).powf(1.0 / cos.clamp(SHALLOWEST, 1.0))
    }

    /// Linear sRGB of a film at this cosine to the view.
    pub(super) fn colour(&self, film: u32, cos: f32) -> Vec3 {
        let colour = self.colours.get(film as usize).copied().unwrap_or(Vec3::splat(0.5));
        colour * (1.0 - self.relief * (1.0 - cos.clamp(0.0, 1.0)))
    }
}

/// Linear sRGB of the film between two regions, on whichever sides.
pub(super) fn colour_between([one, other]: [u32; 2]) -> Vec3 {
    let (low, high) = (one.min(other), one.max(other));
    let hue = (f64::from(low) * STEPS[1] + f64::from(high) * STEPS[0]).fract() as f32;
    Vec3::new(0.0, 1.0 / 3.0, 2.0 / 3.0).map(|shift| 0.42 + 0.36 * (TAU * (hue - shift)).cos())
}

#[cfg(test)]
mod tests {
    use super::colour_between;

    #[test]
    fn films_between_low_regions_differ_in_colour_and_sides_do_not_matter() {
        let pairs: Vec<[u32; 2]> = (1..7).flat_map(|high| (0..high).map(move |low| [high, low])).collect();
        for (row, pair) in pairs.iter().enumerate() {
            assert_eq!(colour_between(*pair), colour_between([pair[1], pair[0]]));
            for other in &pairs[..row] {
                assert!(colour_between(*pair).distance(colour_between(*other)) > 0.02, "{pair:?} and {other:?}");
            }
        }
    }
}
