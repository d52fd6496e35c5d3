//! Colour maps: a value between two ends as a colour of even steps in lightness.
//!
//! Tables are in `assets/` with their origin. Rows are interpolated straight in sRGB, as they were designed.
//! The bar that explains a map is drawn by [`scale_bar`](super::scale_bar).

use super::colour::{decode_srgb, table_rows};
use glam::{DVec3, Vec3};
use serde::Deserialize;
use std::sync::LazyLock;

/// Which colours a map runs through.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum ColourMap {
    /// Sequential, dark blue over green to yellow: safe for colour-blind readers and in grey print.
    #[default]
    Viridis,
    /// Sequential, black over red to pale yellow.
    Inferno,
    /// Diverging, blue over pale grey to red: for quantities with a meaningful middle, such as curvature.
    Tide,
}

static VIRIDIS: LazyLock<Vec<[f64; 3]>> =
    LazyLock::new(|| table_rows(include_str!("../../assets/colour_map_viridis.csv")));
static INFERNO: LazyLock<Vec<[f64; 3]>> =
    LazyLock::new(|| table_rows(include_str!("../../assets/colour_map_inferno.csv")));
static TIDE: LazyLock<Vec<[f64; 3]>> = LazyLock::new(|| table_rows(include_str!("../../assets/colour_map_tide.csv")));

impl ColourMap {
    /// Linear sRGB at a place from 0 (low end) to 1 (high end); outside, the colour of the end.
    #[must_use]
    pub fn linear(self, place: f64) -> Vec3 {
        let rows: &[[f64; 3]] = match self {
            Self::Viridis => &VIRIDIS,
            Self::Inferno => &INFERNO,
            Self::Tide => &TIDE,
        };
        let position = place.clamp(0.0, 1.0) * (rows.len() - 1) as f64;
        let cell = (position as usize).min(rows.len() - 2);
        let (low, high) = (DVec3::from_array(rows[cell]), DVec3::from_array(rows[cell + 1]));
        let coded = low.lerp(high, position - cell as f64).as_vec3();
        Vec3::from_array(coded.to_array().map(decode_srgb))
    }
}

/// A colour map stretched over a range of values.
#[derive(Clone, Debug)]
pub(super) struct MapLook {
    pub colours: ColourMap,
    /// Values at the two ends, in the unit of the values.
    pub range: (f64, f64),
    /// Darkening of surfaces seen at an angle, 0 to 1.
    pub relief: f32,
}

impl MapLook {
    /// Linear sRGB of a value on a surface at this cosine to the view.
    pub(super) fn colour(&self, value: f64, cos: f32) -> Vec3 {
        let (low, high) = self.range;
        let place = if high > low { (value - low) / (high - low) } else { 0.5 };
        self.colours.linear(place) * (1.0 - self.relief * (1.0 - cos.clamp(0.0, 1.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::{ColourMap, MapLook};
    use crate::picture::colour::LUMINANCE;

    fn lightness(map: ColourMap, place: f64) -> f32 {
        map.linear(place).dot(LUMINANCE).cbrt()
    }

    #[test]
    fn sequential_maps_grow_lighter_from_end_to_end() {
        for map in [ColourMap::Viridis, ColourMap::Inferno] {
            for step in 0..100 {
                let (here, next) = (f64::from(step) / 100.0, f64::from(step + 1) / 100.0);
                assert!(lightness(map, next) > lightness(map, here), "{map:?} at {here}");
            }
        }
    }

    #[test]
    fn the_diverging_map_is_lightest_in_the_middle_and_even_on_both_sides() {
        for step in 0..50 {
            let off = f64::from(step) / 100.0;
            let (low, high) = (lightness(ColourMap::Tide, 0.5 - off), lightness(ColourMap::Tide, 0.5 + off));
            assert!(low <= lightness(ColourMap::Tide, 0.5) && (low - high).abs() < 0.06);
        }
    }

    #[test]
    fn a_range_of_no_width_takes_the_middle() {
        let look = MapLook { colours: ColourMap::Tide, range: (2.0, 2.0), relief: 0.0 };
        assert_eq!(look.colour(2.0, 1.0), ColourMap::Tide.linear(0.5));
    }
}
