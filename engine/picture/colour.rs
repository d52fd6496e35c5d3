//! From a reflectance spectrum to a colour on a screen.
//!
//! Equation: `(X, Y, Z) = Σ R(λ) S(λ) (x̄, ȳ, z̄)(λ) / Σ S(λ) ȳ(λ)` with the CIE 1931 2-degree observer and
//! illuminant D65, both every 5 nm from 380 to 780 nm (`assets/`); then linear sRGB by the matrix of IEC 61966-2-1.
//! The weights are scaled so that a perfect mirror is exactly (1, 1, 1).
//! Source: CIE 015:2018, §7.1. Limits: colours outside sRGB have negative channels; [`into_gamut`] brings them back.

use glam::{DMat3, DVec3, Vec3};
use std::sync::LazyLock;

const OBSERVER: &str = include_str!("../../assets/cie_1931_2_degree.csv");
const DAYLIGHT: &str = include_str!("../../assets/illuminant_d65.csv");

/// XYZ to linear sRGB, row by row (IEC 61966-2-1).
const XYZ_TO_SRGB: [[f64; 3]; 3] =
    [[3.2406255, -1.5372080, -0.4986286], [-0.9689307, 1.8757561, 0.0415175], [0.0557101, -0.2040211, 1.0569959]];

/// Weights of the linear sRGB channels in relative luminance, dimensionless.
pub const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// One wavelength, and what light reflected there adds to each linear sRGB channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectralWeight {
    /// Wavelength in air, metres.
    pub wavelength: f64,
    /// Linear sRGB of unit reflectance in this 5 nm band under D65, dimensionless.
    pub rgb: DVec3,
}

static WEIGHTS: LazyLock<Vec<SpectralWeight>> = LazyLock::new(weights_from_assets);

/// The bands of the visible spectrum, from 380 to 780 nm.
#[must_use]
pub fn spectral_weights() -> &'static [SpectralWeight] {
    &WEIGHTS
}

/// Linear sRGB of a surface of spectral reflectance `reflectance(wavelength in metres)` under D65.
///
/// A perfect mirror gives (1, 1, 1). Channels are negative for colours that sRGB cannot show.
pub fn reflectance_to_linear_srgb(reflectance: impl Fn(f64) -> f64) -> DVec3 {
    spectral_weights().iter().map(|band| band.rgb * reflectance(band.wavelength)).sum()
}

/// Mixes a colour with the grey of its own luminance until no channel is negative.
///
/// Luminance and hue angle towards grey are kept; only saturation is lost.
#[must_use]
pub fn into_gamut(rgb: Vec3) -> Vec3 {
    let lowest = rgb.min_element();
    if lowest >= 0.0 {
        return rgb;
    }
    let grey = rgb.dot(LUMINANCE).max(0.0);
    let keep = grey / (grey - lowest);
    (Vec3::splat(grey) + keep * (rgb - grey)).max(Vec3::ZERO)
}

/// The sRGB transfer function: a linear channel to a coded one, both 0 to 1.
#[must_use]
pub fn encode_srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Inverse of [`encode_srgb`].
#[must_use]
pub fn decode_srgb(coded: f32) -> f32 {
    if coded <= 0.040_45 { coded / 12.92 } else { ((coded + 0.055) / 1.055).powf(2.4) }
}

/// Linear sRGB, clipped to 0 to 1, as the three bytes of a pixel.
#[must_use]
pub fn to_bytes(linear: Vec3) -> [u8; 3] {
    linear.to_array().map(|channel| (encode_srgb(channel.clamp(0.0, 1.0)) * 255.0 + 0.5) as u8)
}

/// The rows of a comma-separated table of numbers below one header line.
pub(super) fn table_rows<const COLUMNS: usize>(text: &str) -> Vec<[f64; COLUMNS]> {
    text.lines().skip(1).map(row_of_numbers).collect()
}

fn row_of_numbers<const COLUMNS: usize>(line: &str) -> [f64; COLUMNS] {
    let mut cells = line.split(',').map(str::parse::<f64>);
    std::array::from_fn(|_| {
        cells.next().and_then(Result::ok).expect("invariant: the asset tables hold one number per column")
    })
}

fn weights_from_assets() -> Vec<SpectralWeight> {
    let observer = table_rows::<4>(OBSERVER);
    let daylight = table_rows::<2>(DAYLIGHT);
    let matrix = DMat3::from_cols_array_2d(&XYZ_TO_SRGB).transpose();
    let raw: Vec<_> = observer
        .iter()
        .zip(&daylight)
        .map(|(&[wavelength, x, y, z], &[_, power])| (wavelength, matrix * (power * DVec3::new(x, y, z))))
        .collect();
    let mirror: DVec3 = raw.iter().map(|&(_, rgb)| rgb).sum();
    raw.into_iter()
        .map(|(nanometres, rgb)| SpectralWeight { wavelength: nanometres * 1e-9, rgb: rgb / mirror })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{
        DAYLIGHT, LUMINANCE, OBSERVER, decode_srgb, encode_srgb, into_gamut, reflectance_to_linear_srgb, table_rows,
        to_bytes,
    };
    use glam::{DVec3, Vec3};

    #[test]
    fn both_tables_name_the_same_wavelengths() {
        let observer = table_rows::<4>(OBSERVER);
        let daylight = table_rows::<2>(DAYLIGHT);
        assert_eq!(observer.len(), 81);
        assert!(observer.iter().zip(&daylight).all(|(a, b)| a[0] == b[0]));
    }

    #[test]
    fn daylight_has_the_published_white_point() {
        // CIE 15: D65, 2-degree observer, x = 0.31272, y = 0.32903.
        let sum = table_rows::<4>(OBSERVER)
            .iter()
            .zip(table_rows::<2>(DAYLIGHT))
            .fold(DVec3::ZERO, |sum, (o, d)| sum + d[1] * DVec3::new(o[1], o[2], o[3]));
        let total = sum.element_sum();
        assert!((sum.x / total - 0.31272).abs() < 1e-4 && (sum.y / total - 0.32903).abs() < 1e-4);
    }

    #[test]
    fn a_perfect_mirror_is_white() {
        assert!((reflectance_to_linear_srgb(|_| 1.0) - DVec3::ONE).abs().max_element() < 1e-12);
    }

    #[test]
    fn a_narrow_green_line_lies_outside_srgb_and_is_brought_back() {
        let line = reflectance_to_linear_srgb(|w| if (w - 520e-9).abs() < 6e-9 { 1.0 } else { 0.0 }).as_vec3();
        assert!(line.x < 0.0);
        let shown = into_gamut(line);
        assert!(shown.min_element() >= 0.0);
        assert!((shown.dot(LUMINANCE) - line.dot(LUMINANCE)).abs() < 1e-4);
    }

    #[test]
    fn the_transfer_function_is_undone_by_its_inverse() {
        for step in 0..=100 {
            let linear = step as f32 / 100.0;
            assert!((decode_srgb(encode_srgb(linear)) - linear).abs() < 1e-5);
        }
        assert_eq!(to_bytes(Vec3::new(0.0, 0.2140, 1.0)), [0, 127, 255]);
    }
}
