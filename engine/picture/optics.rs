//! How much light a free soap film reflects.
//!
//! Equation (Airy, one film between two equal media): with the reflectance `R₁` of one surface,
//! `R = 4 R₁ sin²(δ/2) / ((1 - R₁)² + 4 R₁ sin²(δ/2))`, `δ = 4π n d cos θₜ / λ`,
//! for each polarisation, all multiple beams included. Source: Born and Wolf 1999, §7.6.1; Fresnel: §1.5.2.
//! Limits: no absorption, one refractive index for all wavelengths, flat parallel faces.
//! Summed over wavelengths in [`colour`](super::colour), tabulated in [`interference`](super::interference).

use std::f64::consts::PI;

/// Refractive index of soap solution, dimensionless.
pub const SOAP_SOLUTION_INDEX: f64 = 1.33;

/// Reflectances `(s, p)` of one air-film surface, dimensionless, 0 to 1.
///
/// `cos_incidence` is the cosine of the angle between ray and normal in air, 0 to 1.
#[must_use]
pub fn surface_reflectance(index: f64, cos_incidence: f64) -> (f64, f64) {
    let cos_inside = cos_refracted(index, cos_incidence);
    let s = (cos_incidence - index * cos_inside) / (cos_incidence + index * cos_inside);
    let p = (index * cos_incidence - cos_inside) / (index * cos_incidence + cos_inside);
    (s * s, p * p)
}

/// Cosine of the angle of refraction inside the film, by Snell's law.
#[must_use]
pub fn cos_refracted(index: f64, cos_incidence: f64) -> f64 {
    let sin_squared = (1.0 - cos_incidence * cos_incidence).max(0.0) / (index * index);
    (1.0 - sin_squared).max(0.0).sqrt()
}

/// `sin²(δ/2)` of the phase between two successive beams.
///
/// `optical_depth` is `d cos θₜ`, metres; `wavelength` in air, metres.
#[must_use]
pub fn half_phase_sine_squared(index: f64, optical_depth: f64, wavelength: f64) -> f64 {
    let sine = (2.0 * PI * index * optical_depth / wavelength).sin();
    sine * sine
}

/// Reflectance of a film from that of one surface and `sin²(δ/2)`, dimensionless, 0 to 1.
#[must_use]
pub fn airy(surface: f64, half_phase_sine_squared: f64) -> f64 {
    let reflected = 4.0 * surface * half_phase_sine_squared;
    let rest = (1.0 - surface) * (1.0 - surface);
    if reflected + rest > 0.0 { reflected / (reflected + rest) } else { 1.0 }
}

/// Reflectances `(s, p)` of a free film in air, dimensionless, 0 to 1.
///
/// `thickness` and `wavelength` (in air) in metres, `cos_incidence` 0 (grazing) to 1 (normal).
#[must_use]
pub fn film_reflectance(index: f64, thickness: f64, wavelength: f64, cos_incidence: f64) -> (f64, f64) {
    let (s, p) = surface_reflectance(index, cos_incidence);
    let depth = thickness * cos_refracted(index, cos_incidence);
    let phase = half_phase_sine_squared(index, depth, wavelength);
    (airy(s, phase), airy(p, phase))
}

/// Reflectance of a free film for unpolarised light: the mean of both polarisations.
#[must_use]
pub fn unpolarised_reflectance(index: f64, thickness: f64, wavelength: f64, cos_incidence: f64) -> f64 {
    let (s, p) = film_reflectance(index, thickness, wavelength, cos_incidence);
    0.5 * (s + p)
}

#[cfg(test)]
mod tests {
    use super::{SOAP_SOLUTION_INDEX, film_reflectance, surface_reflectance, unpolarised_reflectance};
    use proptest::prelude::{ProptestConfig, prop_assert, proptest};

    const N: f64 = SOAP_SOLUTION_INDEX;
    const GREEN: f64 = 550e-9;

    #[test]
    fn a_quarter_wave_film_reflects_most() {
        let expected = ((N * N - 1.0) / (N * N + 1.0)).powi(2);
        let quarter = GREEN / (4.0 * N);
        assert!((unpolarised_reflectance(N, quarter, GREEN, 1.0) - expected).abs() < 1e-12);
        for off in [0.8, 0.9, 1.1, 1.2] {
            assert!(unpolarised_reflectance(N, off * quarter, GREEN, 1.0) < expected);
        }
    }

    #[test]
    fn a_half_wave_film_reflects_nothing() {
        assert!(unpolarised_reflectance(N, GREEN / (2.0 * N), GREEN, 1.0) < 1e-25);
    }

    #[test]
    fn a_film_much_thinner_than_light_is_black() {
        // R = R_max (2π n d/λ)² at leading order: below one part in a thousand at 3 nm.
        assert!(unpolarised_reflectance(N, 3e-9, GREEN, 1.0) < 1e-3);
        assert!(unpolarised_reflectance(N, 0.0, GREEN, 1.0) == 0.0);
    }

    #[test]
    fn grazing_light_is_reflected_whole() {
        let (s, p) = film_reflectance(N, 100e-9, GREEN, 0.0);
        assert!(s == 1.0 && p == 1.0);
        assert!(unpolarised_reflectance(N, 100e-9, GREEN, 1e-4) > 0.999);
    }

    #[test]
    fn p_polarised_light_passes_at_brewsters_angle() {
        let cos_brewster = 1.0 / (1.0 + N * N).sqrt();
        assert!(surface_reflectance(N, cos_brewster).1 < 1e-25);
        assert!(film_reflectance(N, 150e-9, GREEN, cos_brewster).1 < 1e-25);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]
        #[test]
        fn no_film_reflects_more_than_it_gets(
            thickness in 0.0..1e-5_f64, wavelength in 380e-9..780e-9_f64, cos in 0.0..=1.0_f64, index in 1.0..2.5_f64,
        ) {
            let (s, p) = film_reflectance(index, thickness, wavelength, cos);
            prop_assert!((0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&p));
            prop_assert!(s >= p - 1e-12);
        }
    }
}
