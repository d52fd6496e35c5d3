//! The light that reaches the eye through all sheets of film at one sample.
//!
//! Equation: from the farthest sheet to the nearest, `L ← (1 - R) L + R E(reflected direction)`, with the
//! reflectance `R` of thickness and angle as a colour ([`interference`](super::interference)) and the room `E`
//! ([`studio`](super::studio)). The bright rim needs no term of its own: `R → 1` at grazing incidence.
//! Limits: light mirrored by one sheet does not visit another; refraction in so thin a film is neglected.

use super::colour::{LUMINANCE, into_gamut};
use super::colour_map::MapLook;
use super::interference::InterferenceTable;
use super::layers::Surface;
use super::studio::Studio;
use glam::Vec3;

/// How a sheet of film turns into light.
#[derive(Debug)]
pub(super) enum Shader {
    /// Thin-film interference in a studio; values are thickness, metres.
    Film {
        /// Reflectance of the film.
        table: Box<InterferenceTable>,
        /// What the film mirrors.
        studio: Studio,
        /// Factor on all mirrored light, dimensionless.
        exposure: f32,
    },
    /// Opaque colours of a map.
    Map(MapLook),
}

impl Shader {
    /// Linear sRGB shown for one sample: `ray` is the unit direction of view, sheets are farthest first.
    pub(super) fn shade(&self, background: Vec3, ray: Vec3, sheets: &[Surface]) -> Vec3 {
        match self {
            Self::Film { table, studio, exposure } => {
                let light = sheets.iter().fold(background, |behind, sheet| {
                    let cos = -ray.dot(sheet.normal);
                    let share = sheet.coverage * table.reflectance(f64::from(sheet.value), f64::from(cos));
                    let mirrored = ray + 2.0 * cos * sheet.normal;
                    behind * (1.0 - share) + *exposure * share * studio.radiance(mirrored)
                });
                develop(light)
            }
            Self::Map(look) => sheets.iter().fold(background, |behind, sheet| {
                let cos = -ray.dot(sheet.normal);
                behind.lerp(look.colour(f64::from(sheet.value), cos), sheet.coverage)
            }),
        }
    }
}

/// Brings light into the range of a screen: straight up to [`KNEE`], then a smooth shoulder that never quite clips.
///
/// As on film, bright light spills into all layers: saturation falls with luminance, by at most [`SPILL`],
/// and highlights run to white.
fn develop(light: Vec3) -> Vec3 {
    let light = into_gamut(light);
    let grey = light.dot(LUMINANCE);
    let spilt = light.lerp(Vec3::splat(grey), SPILL * grey / (grey + 0.5));
    Vec3::from_array(spilt.to_array().map(shoulder))
}

/// Linear level above which highlights are compressed.
const KNEE: f32 = 0.5;
/// Share of grey mixed into the brightest light.
const SPILL: f32 = 0.45;

fn shoulder(level: f32) -> f32 {
    let over = (level - KNEE) / (1.0 - KNEE);
    if over <= 0.0 { level } else { KNEE + (1.0 - KNEE) * (1.0 - (-over).exp()) }
}

#[cfg(test)]
mod tests {
    use super::{Shader, develop};
    use crate::picture::interference::InterferenceTable;
    use crate::picture::layers::Surface;
    use crate::picture::studio::Studio;
    use glam::Vec3;

    fn film() -> Shader {
        Shader::Film { table: Box::new(InterferenceTable::new(1.33)), studio: Studio::new(), exposure: 1.0 }
    }

    #[test]
    fn a_black_film_shows_what_is_behind_it() {
        let behind = Vec3::new(0.1, 0.2, 0.3);
        let sheet = Surface { value: 0.0, normal: Vec3::Z, depth: 1.0, coverage: 1.0 };
        let unveiled = film().shade(behind, Vec3::NEG_Z, &[]);
        assert!((film().shade(behind, Vec3::NEG_Z, &[sheet]) - unveiled).abs().max_element() < 1e-6);
    }

    #[test]
    fn a_film_seen_at_grazing_hides_what_is_behind_it() {
        let sheet = Surface { value: 3e-7, normal: Vec3::X, depth: 1.0, coverage: 1.0 };
        let ray = Vec3::new(-1e-3, 0.0, -1.0).normalize();
        let (dark, bright) = (Vec3::ZERO, Vec3::ONE);
        let difference = film().shade(bright, ray, &[sheet]) - film().shade(dark, ray, &[sheet]);
        assert!(difference.abs().max_element() < 0.05);
    }

    #[test]
    fn developing_keeps_order_and_range() {
        let mut last = 0.0;
        for step in 1..1000 {
            let shown = develop(Vec3::splat(0.01 * step as f32)).x;
            assert!(shown >= last && shown <= 1.0);
            last = shown;
        }
    }
}
