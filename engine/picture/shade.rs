//! The light that reaches the eye through all sheets of film at one sample.
//!
//! Equation: from the farthest sheet to the nearest, `L ← (1 - R) L + R E(reflected direction)`, with the
//! reflectance `R` of thickness and angle as a colour ([`interference`](super::interference)) and the room `E`
//! ([`studio`](super::studio)). The bright rim needs no term of its own: `R → 1` at grazing incidence.
//! Every sheet is thus a [`Layer`] `L ← p L + a`, in every look; borders and wires ([`rod`](super::rod)) are, too.
//! Limits: light mirrored by one sheet does not visit another; refraction in so thin a film is neglected.

use super::colour::{LUMINANCE, into_gamut};
use super::colour_map::MapLook;
use super::interference::InterferenceTable;
use super::raster::Sight;
use super::region_colours::RegionsLook;
use super::rod;
use super::studio::Studio;
use glam::Vec3;

/// Light passed on below which nothing behind is seen: a quarter of a step of 8 bits.
const HIDDEN: f32 = 1e-3;

/// What a sheet is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Matter {
    /// A film, with its number.
    Film(u32),
    /// A channel of liquid where films meet.
    Border,
    /// A wire that holds films.
    Wire,
}

impl Default for Matter {
    fn default() -> Self {
        Self::Film(0)
    }
}

impl Matter {
    /// Whether it is a line and no film.
    pub(super) fn is_line(self) -> bool {
        !matches!(self, Self::Film(_))
    }
}

/// A sheet of film at a sample, ready to be shaded.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Surface {
    /// Value of the film.
    pub value: f32,
    /// Unit normal in camera axes, towards the eye.
    pub normal: Vec3,
    /// How much the normal of a line changes from the middle of the sample to its edge; zero for films.
    pub spread: Vec3,
    /// Distance along the view, metres.
    pub depth: f32,
    /// Share of the sample that the film covers, 0 to 1.
    pub coverage: f32,
    /// What it is made of.
    pub matter: Matter,
}

/// What a sheet does to the light behind it: `L ← passes L + adds`, linear sRGB.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layer {
    pub passes: Vec3,
    pub adds: Vec3,
}

impl Layer {
    /// The light through layers, nearest first. Layers that nothing is seen of are not asked for.
    pub(super) fn composite<'a>(layers: impl Iterator<Item = &'a Self>, background: Vec3) -> Vec3 {
        let (mut light, mut passes) = (Vec3::ZERO, Vec3::ONE);
        for layer in layers {
            light += passes * layer.adds;
            passes *= layer.passes;
            if passes.max_element() < HIDDEN {
                return light;
            }
        }
        light + passes * background
    }

    /// The layer where only a share of a sample is covered.
    fn covering(self, share: f32) -> Self {
        Self { passes: Vec3::ONE - share * (Vec3::ONE - self.passes), adds: share * self.adds }
    }

    fn opaque(colour: Vec3) -> Self {
        Self { passes: Vec3::ZERO, adds: colour }
    }
}

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
    /// One colour per film.
    Regions(RegionsLook),
}

impl Shader {
    /// Linear sRGB shown for one sample; sheets are farthest first.
    pub(super) fn shade(&self, sight: &Sight, sheets: &[Surface]) -> Vec3 {
        let light = sheets.iter().fold(sight.background, |behind, sheet| {
            let layer = self.layer(sight.ray, sheet);
            behind * layer.passes + layer.adds
        });
        self.develop(light)
    }

    /// What a sheet does to the light behind it, seen along the unit direction `ray`.
    pub(super) fn layer(&self, ray: Vec3, sheet: &Surface) -> Layer {
        let cos = -ray.dot(sheet.normal);
        match self {
            Self::Film { table, studio, exposure } => {
                let lit = |layer: Layer| Layer { adds: *exposure * layer.adds, ..layer }.covering(sheet.coverage);
                match sheet.matter {
                    Matter::Film(_) => {
                        let share = sheet.coverage * table.reflectance(f64::from(sheet.value), f64::from(cos));
                        let mirrored = ray + 2.0 * cos * sheet.normal;
                        Layer { passes: 1.0 - share, adds: *exposure * share * studio.radiance(mirrored) }
                    }
                    Matter::Border => lit(rod::channel(ray, sheet, studio)),
                    Matter::Wire => lit(rod::wire(ray, sheet, studio)),
                }
            }
            Self::Map(look) => drawn(sheet, cos, |_| Layer::opaque(look.colour(f64::from(sheet.value), cos))),
            Self::Regions(look) => {
                drawn(sheet, cos, |film| Layer::opaque(look.colour(film, cos)).covering(look.hides(cos)))
            }
        }
    }

    /// Brings composited light into the range of a screen.
    pub(super) fn develop(&self, light: Vec3) -> Vec3 {
        match self {
            Self::Film { .. } => develop(light),
            Self::Map(_) | Self::Regions(_) => light,
        }
    }
}

/// A sheet without a studio: lines in plain colours, films as `film(number)` says.
fn drawn(sheet: &Surface, cos: f32, film: impl Fn(u32) -> Layer) -> Layer {
    let layer = match sheet.matter {
        Matter::Film(number) => film(number),
        Matter::Border => rod::ink(),
        Matter::Wire => rod::dull_metal(cos),
    };
    layer.covering(sheet.coverage)
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
    use super::{Layer, Matter, Shader, Surface, develop};
    use crate::picture::interference::InterferenceTable;
    use crate::picture::raster::Sight;
    use crate::picture::studio::Studio;
    use glam::Vec3;

    fn film() -> Shader {
        Shader::Film { table: Box::new(InterferenceTable::new(1.33)), studio: Studio::new(), exposure: 1.0 }
    }

    fn sheet(value: f32, normal: Vec3) -> Surface {
        Surface { value, normal, depth: 1.0, coverage: 1.0, ..Surface::default() }
    }

    fn shaded(background: Vec3, ray: Vec3, sheets: &[Surface]) -> Vec3 {
        film().shade(&Sight { background, ray }, sheets)
    }

    #[test]
    fn a_black_film_shows_what_is_behind_it() {
        let behind = Vec3::new(0.1, 0.2, 0.3);
        let unveiled = shaded(behind, Vec3::NEG_Z, &[]);
        assert!((shaded(behind, Vec3::NEG_Z, &[sheet(0.0, Vec3::Z)]) - unveiled).abs().max_element() < 1e-6);
    }

    #[test]
    fn a_film_seen_at_grazing_hides_what_is_behind_it() {
        let sheet = sheet(3e-7, Vec3::X);
        let ray = Vec3::new(-1e-3, 0.0, -1.0).normalize();
        let (dark, bright) = (Vec3::ZERO, Vec3::ONE);
        let difference = shaded(bright, ray, &[sheet]) - shaded(dark, ray, &[sheet]);
        assert!(difference.abs().max_element() < 0.05);
    }

    #[test]
    fn compositing_from_the_front_gives_what_compositing_from_the_back_gives() {
        let ray = Vec3::new(0.1, -0.2, -1.0).normalize();
        let border = Surface { matter: Matter::Border, coverage: 0.7, ..sheet(0.0, Vec3::new(0.3, 0.0, 0.95)) };
        let sheets = [sheet(3e-7, Vec3::Z), border, sheet(2e-7, Vec3::new(0.6, 0.0, 0.8))];
        let film = film();
        let layers = sheets.map(|sheet| film.layer(ray, &sheet));
        let from_front = film.develop(Layer::composite(layers.iter().rev(), Vec3::splat(0.2)));
        assert!((from_front - shaded(Vec3::splat(0.2), ray, &sheets)).abs().max_element() < 1e-5);
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
