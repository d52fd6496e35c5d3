//! The front of the pictures: settings in, frames out.

use super::camera::Camera;
use super::colour_map::MapLook;
use super::error::PictureError;
use super::film::FilmPoints;
use super::interference::InterferenceTable;
use super::raster::Drawing;
use super::scale_bar::ScaleBar;
use super::settings::{Look, PictureSettings};
use super::shade::Shader;
use super::studio::Studio;
use glam::Vec2;
use image::{Rgb, RgbImage};

/// Paints films by one set of settings; tables are made once.
#[derive(Debug)]
pub struct Painter {
    settings: PictureSettings,
    /// The shader of the interference look; a colour map's depends on the film.
    interference: Option<Shader>,
}

impl Painter {
    /// Checks the settings and makes the tables they need.
    ///
    /// # Errors
    /// [`PictureError::OutOfRange`] that names the setting at fault.
    pub fn new(settings: PictureSettings) -> Result<Self, PictureError> {
        settings.check()?;
        let interference = match settings.look {
            Look::Interference { refractive_index } => Some(Shader::Film {
                table: Box::new(InterferenceTable::new(refractive_index)),
                studio: Studio::new(),
                exposure: settings.exposure as f32,
            }),
            Look::Map { .. } => None,
        };
        Ok(Self { settings, interference })
    }

    /// The settings this painter was made with.
    #[must_use]
    pub fn settings(&self) -> &PictureSettings {
        &self.settings
    }

    /// Paints one film.
    ///
    /// # Errors
    /// [`PictureError`] if the film is empty, ragged or not finite, or the camera has no direction.
    pub fn paint(&self, film: &FilmPoints) -> Result<RgbImage, PictureError> {
        self.paint_all(std::slice::from_ref(film))
    }

    /// Paints several films, each with its own spacing, into one picture.
    ///
    /// # Errors
    /// As [`paint`](Self::paint); also if there are no films.
    pub fn paint_all(&self, films: &[FilmPoints]) -> Result<RgbImage, PictureError> {
        if films.is_empty() {
            return Err(PictureError::NoPoints);
        }
        films.iter().try_for_each(FilmPoints::check)?;
        match &self.interference {
            Some(shader) => self.draw(films, shader, self.settings.width),
            None => self.draw_map(films),
        }
    }

    fn draw(&self, films: &[FilmPoints], shader: &Shader, width: u32) -> Result<RgbImage, PictureError> {
        let size = (width, self.settings.height);
        let aspect = f64::from(size.0) / f64::from(size.1);
        let framed = || match films {
            [film] => Camera::framing_points(film.positions, aspect),
            _ => Camera::framing_points(
                &films.iter().flat_map(|film| film.positions).copied().collect::<Vec<_>>(),
                aspect,
            ),
        };
        let camera = self.settings.camera.map_or_else(framed, Ok)?;
        let samples = self.settings.samples as usize;
        let background = self.settings.background.backdrop();
        Drawing { size, samples, camera: &camera, background, shader }.draw(films)
    }

    fn draw_map(&self, films: &[FilmPoints]) -> Result<RgbImage, PictureError> {
        let Look::Map { colours, quantity, unit, unit_size, range, relief } = &self.settings.look else {
            unreachable!("invariant: a painter without interference shader has the look of a map");
        };
        let range = range.unwrap_or_else(|| extremes(films));
        let look = MapLook { colours: *colours, range, relief: *relief as f32 };
        let shown = (range.0 / unit_size, range.1 / unit_size);
        let bar = ScaleBar { colours: *colours, quantity: quantity.clone(), unit: unit.clone(), range: shown };
        let PictureSettings { width, height, .. } = self.settings;
        let bar_width = bar.width_for(width, height);
        let drawn = self.draw(films, &Shader::Map(look), width - bar_width)?;
        let mut picture = RgbImage::from_pixel(width, height, self.margin_colour());
        image::imageops::replace(&mut picture, &drawn, 0, 0);
        if bar_width > 0 {
            bar.draw(&mut picture, bar_width);
        }
        Ok(picture)
    }

    fn margin_colour(&self) -> Rgb<u8> {
        Rgb(super::colour::to_bytes(self.settings.background.backdrop().at(Vec2::ONE)))
    }
}

/// Smallest and largest value of all films.
fn extremes(films: &[FilmPoints]) -> (f64, f64) {
    films
        .iter()
        .map(FilmPoints::value_range)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), range| (low.min(range.0), high.max(range.1)))
}

#[cfg(test)]
mod tests {
    use super::Painter;
    use crate::picture::error::PictureError;
    use crate::picture::film::{FilmPoints, Part};
    use crate::picture::settings::PictureSettings;
    use glam::DVec3;
    use image::RgbImage;

    struct Bubble {
        directions: Vec<DVec3>,
        values: Vec<f64>,
    }

    impl Bubble {
        fn new(points: usize) -> Self {
            let directions: Vec<DVec3> = (0..points)
                .map(|i| {
                    let height = 1.0 - (2 * i + 1) as f64 / points as f64;
                    let (sin, cos) = (2.399_963_229_7 * i as f64).sin_cos();
                    DVec3::new(cos, 0.0, sin) * (1.0 - height * height).sqrt() + height * DVec3::Y
                })
                .collect();
            let values = directions.iter().map(|d| 1e-9 * (450.0 - 250.0 * d.y + 60.0 * (7.0 * d.x).sin())).collect();
            Self { directions, values }
        }

        fn film(&self) -> FilmPoints<'_> {
            let spacing = (4.0 * std::f64::consts::PI / self.values.len() as f64).sqrt();
            FilmPoints {
                positions: &self.directions,
                normals: &self.directions,
                values: &self.values,
                spacing,
                part: Part::Whole,
            }
        }
    }

    fn painter(settings: &str) -> Painter {
        Painter::new(ron::from_str::<PictureSettings>(settings).unwrap()).unwrap()
    }

    fn in_pool(threads: usize, work: impl FnOnce() -> RgbImage + Send) -> RgbImage {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
    }

    #[test]
    fn the_bytes_do_not_depend_on_the_number_of_threads() {
        let bubble = Bubble::new(40_000);
        for look in ["(width: 150, height: 130)", "(width: 150, height: 130, look: Map(quantity: \"thickness\"))"] {
            let [one, two, five] =
                [1, 2, 5].map(|threads| in_pool(threads, || painter(look).paint(&bubble.film()).unwrap()));
            assert!(one == two && one == five, "{look}");
        }
    }

    #[test]
    fn every_number_of_samples_gives_nearly_the_same_picture() {
        let bubble = Bubble::new(20_000);
        let paint =
            |samples| painter(&format!("(width: 101, height: 67, samples: {samples})")).paint(&bubble.film()).unwrap();
        let reference = paint(4);
        for samples in 1..4 {
            let difference: u64 =
                paint(samples).iter().zip(reference.iter()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
            let mean = difference as f64 / reference.len() as f64;
            assert!(mean < 2.5, "{samples} samples differ by {mean} of 255 on average");
        }
    }

    #[test]
    fn a_bubble_is_colourful_and_brighter_than_its_background() {
        let picture = painter("(width: 200, height: 200)").paint(&Bubble::new(16_000).film()).unwrap();
        let light = |x, y| picture.get_pixel(x, y).0.map(u32::from).iter().sum::<u32>();
        let rim = (100..200).map(|x| light(x, 100)).max().unwrap();
        assert!(rim > 5 * light(1, 1));
        let colourful = picture.pixels().filter(|p| {
            let [low, high] = [p.0.iter().min(), p.0.iter().max()].map(|channel| u32::from(*channel.unwrap()));
            high > 40 && 2 * high > 3 * low
        });
        assert!(colourful.count() > 4_000);
    }

    #[test]
    fn a_map_shows_its_ends_on_the_bar() {
        let bubble = Bubble::new(5_000);
        let settings = "(width: 400, height: 400, look: Map(quantity: \"thickness\", unit: \"nm\", unit_size: 1e-9))";
        let picture = painter(settings).paint(&bubble.film()).unwrap();
        assert_eq!(picture.dimensions(), (400, 400));
        let dark_blue = picture.pixels().filter(|p| p.0[2] / 2 > p.0[1] && p.0[2] > 70).count();
        let yellow = picture.pixels().filter(|p| p.0[0] > 200 && p.0[1] > 200 && p.0[2] < 80).count();
        assert!(dark_blue > 50 && yellow > 20, "{dark_blue} and {yellow}");
    }

    #[test]
    fn nothing_to_draw_is_an_error() {
        let empty = FilmPoints { positions: &[], normals: &[], values: &[], spacing: 1.0, part: Part::Whole };
        assert!(matches!(painter("()").paint(&empty), Err(PictureError::NoPoints)));
        assert!(matches!(painter("()").paint_all(&[]), Err(PictureError::NoPoints)));
    }

    #[test]
    fn a_spacing_far_too_large_is_refused_before_it_takes_hours() {
        let bubble = Bubble::new(40_000);
        let film = FilmPoints { spacing: 0.4, ..bubble.film() };
        assert!(matches!(painter("()").paint(&film), Err(PictureError::OutOfRange { value: 0.4, .. })));
    }

    #[test]
    fn one_lone_point_and_a_point_at_the_eye_are_drawn_without_harm() {
        let film = FilmPoints {
            positions: &[DVec3::ZERO],
            normals: &[DVec3::Z],
            values: &[3e-7],
            spacing: 0.01,
            part: Part::Whole,
        };
        for settings in [
            "(width: 9, height: 7)",
            "(width: 9, height: 7, camera: Some((position: (0, 0, 1e-9), target: (0, 0, 0))))",
        ] {
            assert_eq!(painter(settings).paint(&film).unwrap().dimensions(), (9, 7));
        }
    }
}
