//! The colour of a soap film by thickness and angle, tabulated.
//!
//! The film reflectance depends on the thickness only through `u = d cos θₜ`, and on the angle besides that only
//! through the smooth surface reflectance. The table therefore runs over `u` (fine, even steps) and
//! `√cos θ` (coarse, even steps): see [`optics`](super::optics) for the equation, [`colour`](super::colour) for the sum.
//! Limits: beyond [`MAX_OPTICAL_DEPTH`] the colour of that depth is used, a pale grey. Within 2.5 degrees of grazing
//! the table blurs the steep rise to full reflection.

use super::colour::spectral_weights;
use super::optics::{airy, cos_refracted, half_phase_sine_squared, surface_reflectance};
use glam::{DVec3, Vec3};
use rayon::iter::{IndexedParallelIterator, ParallelIterator};
use rayon::slice::ParallelSliceMut;

/// Largest `d cos θₜ` in the table, metres.
pub const MAX_OPTICAL_DEPTH: f64 = 5e-6;

/// Step of `d cos θₜ`, metres: small against the shortest fringe, 140 nm, and its sharp zeros near grazing.
const DEPTH_STEP: f64 = 1.25e-9;
const DEPTHS: usize = (MAX_OPTICAL_DEPTH / DEPTH_STEP) as usize + 2;
const ANGLES: usize = 72;

/// Linear sRGB reflectance of a free film under D65, by thickness and cosine of incidence.
#[derive(Clone, Debug)]
pub struct InterferenceTable {
    index: f64,
    /// `ANGLES` entries per depth.
    colours: Vec<Vec3>,
}

impl InterferenceTable {
    /// Tabulates a film of refractive index `index`, dimensionless and at least 1.
    #[must_use]
    pub fn new(index: f64) -> Self {
        let surfaces: Vec<_> = (0..ANGLES).map(|angle| surface_reflectance(index, cos_of_column(angle))).collect();
        let mut colours = vec![Vec3::ZERO; DEPTHS * ANGLES];
        colours
            .par_chunks_mut(ANGLES)
            .enumerate()
            .for_each(|(row, out)| fill_depth(out, index, row as f64 * DEPTH_STEP, &surfaces));
        Self { index, colours }
    }

    /// Linear sRGB reflectance; a perfect mirror is (1, 1, 1). Channels may be slightly negative (outside sRGB).
    ///
    /// `thickness` in metres, `cos_incidence` 0 to 1; values outside are clamped.
    #[must_use]
    pub fn reflectance(&self, thickness: f64, cos_incidence: f64) -> Vec3 {
        let cos_incidence = cos_incidence.clamp(0.0, 1.0);
        let depth = (thickness * cos_refracted(self.index, cos_incidence)).clamp(0.0, MAX_OPTICAL_DEPTH);
        let (row, across) = split(depth / DEPTH_STEP, DEPTHS);
        let (column, along) = split(cos_incidence.sqrt() * (ANGLES - 1) as f64, ANGLES);
        let at = row * ANGLES + column;
        let near = self.colours[at].lerp(self.colours[at + 1], along);
        let far = self.colours[at + ANGLES].lerp(self.colours[at + ANGLES + 1], along);
        near.lerp(far, across)
    }
}

/// Cell and fraction of a position in a table axis of `len` entries.
fn split(position: f64, len: usize) -> (usize, f32) {
    let cell = (position as usize).min(len - 2);
    (cell, (position - cell as f64) as f32)
}

fn cos_of_column(column: usize) -> f64 {
    let root = column as f64 / (ANGLES - 1) as f64;
    root * root
}

fn fill_depth(out: &mut [Vec3], index: f64, depth: f64, surfaces: &[(f64, f64)]) {
    let phases: Vec<(f64, DVec3)> = spectral_weights()
        .iter()
        .map(|band| (half_phase_sine_squared(index, depth, band.wavelength), band.rgb))
        .collect();
    for (colour, &(s, p)) in out.iter_mut().zip(surfaces) {
        let sum: DVec3 = phases.iter().map(|&(phase, rgb)| rgb * (0.5 * (airy(s, phase) + airy(p, phase)))).sum();
        *colour = sum.as_vec3();
    }
}

#[cfg(test)]
mod tests {
    use super::InterferenceTable;
    use crate::picture::colour::{LUMINANCE, into_gamut, reflectance_to_linear_srgb};
    use crate::picture::optics::{SOAP_SOLUTION_INDEX, unpolarised_reflectance};
    use glam::{DVec3, Vec3};
    use std::sync::LazyLock;

    static TABLE: LazyLock<InterferenceTable> = LazyLock::new(|| InterferenceTable::new(SOAP_SOLUTION_INDEX));

    fn direct(thickness: f64, cos: f64) -> DVec3 {
        reflectance_to_linear_srgb(|w| unpolarised_reflectance(SOAP_SOLUTION_INDEX, thickness, w, cos))
    }

    /// Colour of a film seen face on, scaled to a greatest channel of 1.
    fn face_on(nanometres: f64) -> Vec3 {
        let colour = into_gamut(TABLE.reflectance(nanometres * 1e-9, 1.0));
        colour / colour.max_element()
    }

    /// Largest error of the table over films to 4.9 µm, for cosines from `lowest` to 1.
    fn worst_error(lowest: f64) -> f64 {
        let mut worst = 0.0_f64;
        for step in 0..4000 {
            let thickness = 4.9e-6 * (f64::from(step) * 0.618_033_988_75).fract();
            let cos = lowest + (1.0 - lowest) * (f64::from(step) * 0.754_877_666_2).fract();
            let error = TABLE.reflectance(thickness, cos).as_dvec3() - direct(thickness, cos);
            worst = worst.max(error.abs().max_element());
        }
        worst
    }

    #[test]
    fn the_table_agrees_with_the_sum_over_wavelengths() {
        assert!(worst_error(0.15) < 1e-3);
        // Nearer to grazing the resonances sharpen: up to 87 degrees.
        assert!(worst_error(0.05) < 6e-3);
    }

    #[test]
    fn a_film_below_thirty_nanometres_is_black_beside_a_silvery_one() {
        let silver = TABLE.reflectance(105e-9, 1.0).dot(LUMINANCE);
        assert!(silver > 0.07);
        assert!(TABLE.reflectance(10e-9, 1.0).dot(LUMINANCE) < 0.08 * silver);
        assert!(TABLE.reflectance(25e-9, 1.0).dot(LUMINANCE) < 0.4 * silver);
    }

    #[test]
    fn colours_come_in_newtons_order() {
        let silver = face_on(105.0);
        assert!(silver.min_element() > 0.75, "silvery white, {silver}");
        let yellow = face_on(145.0);
        assert!(yellow.x > yellow.y && yellow.y > 1.5 * yellow.z, "yellow to brown, {yellow}");
        let purple = face_on(200.0);
        assert!(purple.z > 2.0 * purple.y && purple.x > purple.y, "purple, {purple}");
        let blue = face_on(230.0);
        assert!(blue.z > 2.0 * blue.x && blue.z > blue.y, "blue, {blue}");
        let yellow = face_on(330.0);
        assert!(yellow.x > 2.0 * yellow.z && yellow.y > 2.0 * yellow.z, "second yellow, {yellow}");
        let green = face_on(500.0);
        assert!(green.y > green.x && green.y > green.z, "third green, {green}");
        let magenta = face_on(600.0);
        assert!(magenta.x > 1.3 * magenta.y && magenta.z > 1.1 * magenta.y, "third magenta, {magenta}");
    }

    #[test]
    fn high_orders_pale() {
        let saturation = |nanometres: f64| 1.0 - face_on(nanometres).min_element();
        let near: f64 = (0..40).map(|i| f64::from(saturation(400.0 + 5.0 * f64::from(i)))).fold(0.0, f64::max);
        let far: f64 = (0..40).map(|i| f64::from(saturation(4000.0 + 5.0 * f64::from(i)))).fold(0.0, f64::max);
        assert!(far < 0.2 && near > 0.6, "saturation {near} then {far}");
    }

    #[test]
    fn bands_of_five_nanometres_resolve_thick_films() {
        // The same sum over 1 nm, weights interpolated, differs little up to 3 µm.
        let bands = crate::picture::colour::spectral_weights();
        for thickness in [0.5e-6, 1.3e-6, 2.2e-6, 3.0e-6] {
            let reflectance = |w: f64| unpolarised_reflectance(SOAP_SOLUTION_INDEX, thickness, w, 1.0);
            let fine: DVec3 = bands
                .windows(2)
                .flat_map(|pair| (0..5).map(move |step| (pair, f64::from(step) / 5.0)))
                .map(|(pair, t)| {
                    let wavelength = pair[0].wavelength * (1.0 - t) + pair[1].wavelength * t;
                    pair[0].rgb.lerp(pair[1].rgb, t) * reflectance(wavelength) / 5.0
                })
                .sum();
            assert!((fine - direct(thickness, 1.0)).abs().max_element() < 1e-3);
        }
    }
}
