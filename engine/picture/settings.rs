//! What a picture shows, and how: everything an author may choose, with defaults that look good.

use super::camera::Camera;
use super::colour_map::ColourMap;
use super::error::PictureError;
use super::optics::SOAP_SOLUTION_INDEX;
use super::studio::Background;
use serde::Deserialize;

/// Largest edge of a picture, pixels.
const LARGEST_EDGE: u32 = 16_384;
/// Most samples of a picture: 4K at 4 samples per pixel edge.
const MOST_SAMPLES: f64 = 134_217_728.0;
/// Memory of one pixel while its picture is drawn and coded, bytes: tiles, picture, PNG, animation.
const BYTES_PER_PIXEL: u64 = 12;

/// Choices for a picture.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PictureSettings {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Point of view; without one the first film is framed from slightly above.
    pub camera: Option<Camera>,
    /// What is seen behind the film.
    pub background: Background,
    /// Factor on all light that the film mirrors, dimensionless. Doubling it is one stop.
    pub exposure: f64,
    /// Samples along each edge of a pixel, 1 to 4. Edges are smooth with 1; more smooth very steep interference bands.
    pub samples: u32,
    /// Soap film, or a colour map of any quantity.
    pub look: Look,
    /// Whether films of triangles are drawn with their Plateau borders, free rims and wires.
    pub borders: bool,
}

impl Default for PictureSettings {
    fn default() -> Self {
        Self {
            width: 640,
            height: 640,
            camera: None,
            background: Background::default(),
            exposure: 1.0,
            samples: 1,
            look: Look::default(),
            borders: true,
        }
    }
}

/// How the film's values are shown.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Look {
    /// A soap film in a studio; values are thickness, metres.
    Interference {
        /// Refractive index of the liquid, dimensionless, 1 to 4.
        #[serde(default = "soap_solution_index")]
        refractive_index: f64,
    },
    /// An opaque colour map with a scale bar.
    Map {
        /// Which colours.
        #[serde(default)]
        colours: ColourMap,
        /// Name of the quantity, for the scale bar.
        quantity: String,
        /// Unit shown on the scale bar.
        #[serde(default)]
        unit: String,
        /// Size of one shown unit, in the unit of the values: 1e-9 shows metres as nm.
        #[serde(default = "one")]
        unit_size: f64,
        /// Values at the ends of the map, in the unit of the values; without them, the extremes of the film.
        #[serde(default)]
        range: Option<(f64, f64)>,
        /// How much surfaces seen at an angle are darkened to show the shape, 0 (flat colours) to 1.
        #[serde(default = "gentle_relief")]
        relief: f64,
    },
    /// Each film of triangles in one colour, by the two regions that it divides. Films of points all have one colour.
    Regions {
        /// Share of what is behind a film that it hides where it is seen face-on, 0 to 1; more where it is seen at an angle.
        #[serde(default = "light_tint")]
        opacity: f64,
        /// How much surfaces seen at an angle are darkened to show the shape, 0 (flat colours) to 1.
        #[serde(default = "gentle_relief")]
        relief: f64,
    },
}

impl Default for Look {
    fn default() -> Self {
        Self::Interference { refractive_index: SOAP_SOLUTION_INDEX }
    }
}

fn soap_solution_index() -> f64 {
    SOAP_SOLUTION_INDEX
}

fn one() -> f64 {
    1.0
}

fn light_tint() -> f64 {
    0.3
}

fn gentle_relief() -> f64 {
    0.25
}

impl PictureSettings {
    /// Refuses sizes, factors and cameras that make no picture.
    ///
    /// # Errors
    /// [`PictureError::OutOfRange`] that names the setting, or [`PictureError::CameraWithoutDirection`].
    pub fn check(&self) -> Result<(), PictureError> {
        self.check_fields().map_err(|(_, error)| error)
    }

    /// The same; the error comes with the field at fault, empty where it is several.
    pub(crate) fn check_fields(&self) -> Result<(), FieldError> {
        let edge = 1.0..=f64::from(LARGEST_EDGE);
        let (width, height, samples) = (f64::from(self.width), f64::from(self.height), f64::from(self.samples));
        within("width", "the picture's width", width, &edge, "1 to 16384 pixels")?;
        within("height", "the picture's height", height, &edge, "1 to 16384 pixels")?;
        within("samples", "the number of samples", samples, &(1.0..=4.0), "1 to 4 per pixel edge")?;
        let (all, allowed) = (width * height * samples * samples, "at most 134217728, as 3840 x 2160 x 4^2 are");
        within("", "width x height x samples^2", all, &(1.0..=MOST_SAMPLES), allowed)?;
        within("exposure", "the exposure", self.exposure, &(1e-6..=1e6), "a factor from 1e-6 to 1e6")?;
        self.check_camera()?;
        self.check_look()
    }

    fn check_camera(&self) -> Result<(), FieldError> {
        let view = self.camera.map(|camera| camera.view(f64::from(self.width), f64::from(self.height)));
        match view {
            Some(Err(error @ PictureError::OutOfRange { .. })) => Err(("field_of_view", error)),
            Some(Err(error)) => Err(("camera", error)),
            _ => Ok(()),
        }
    }

    fn check_look(&self) -> Result<(), FieldError> {
        match &self.look {
            Look::Interference { refractive_index } => {
                within("refractive_index", "the refractive index", *refractive_index, &(1.0..=4.0), "1 to 4")
            }
            Look::Regions { opacity, relief } => {
                within("opacity", "the opacity", *opacity, &(0.0..=1.0), "0 to 1")?;
                within("relief", "the relief", *relief, &(0.0..=1.0), "0 to 1")
            }
            Look::Map { unit_size, range, relief, .. } => {
                let positive = f64::MIN_POSITIVE..=f64::MAX;
                within("unit_size", "the size of the unit", *unit_size, &positive, "positive")?;
                within("relief", "the relief", *relief, &(0.0..=1.0), "0 to 1")?;
                range.map_or(Ok(()), |(low, high)| {
                    within("range", "the span of the map's range", high - low, &positive, "positive and finite")
                })
            }
        }
    }

    /// Memory that drawing takes, bytes.
    #[must_use]
    pub fn memory(&self) -> u64 {
        BYTES_PER_PIXEL * u64::from(self.width) * u64::from(self.height)
    }
}

/// The field at fault, and what is wrong with it.
pub(crate) type FieldError = (&'static str, PictureError);

fn within(
    field: &'static str,
    name: &'static str,
    value: f64,
    range: &std::ops::RangeInclusive<f64>,
    allowed: &'static str,
) -> Result<(), FieldError> {
    if range.contains(&value) { Ok(()) } else { Err((field, PictureError::OutOfRange { name, value, allowed })) }
}

#[cfg(test)]
mod tests {
    use super::{Look, PictureSettings};

    #[test]
    fn an_empty_block_means_the_defaults() {
        assert_eq!(ron::from_str::<PictureSettings>("()").unwrap(), PictureSettings::default());
    }

    #[test]
    fn a_misspelt_setting_is_refused() {
        assert!(ron::from_str::<PictureSettings>("(widht: 3)").is_err());
    }

    #[test]
    fn a_map_needs_only_a_quantity() {
        let settings: PictureSettings = ron::from_str("(look: Map(quantity: \"thickness\"))").unwrap();
        assert!(matches!(settings.look, Look::Map { unit_size: 1.0, range: None, .. }));
        assert!(settings.check().is_ok());
    }

    #[test]
    fn numbers_that_make_no_picture_are_refused() {
        for settings in [
            "(width: 0)",
            "(samples: 9)",
            "(width: 16384, height: 16384)",
            "(exposure: -1.0)",
            "(look: Interference(refractive_index: 0.5))",
            "(camera: Some((position: (0, 0, 0), target: (0, 0, 0))))",
        ] {
            assert!(ron::from_str::<PictureSettings>(settings).unwrap().check().is_err(), "{settings}");
        }
    }
}
