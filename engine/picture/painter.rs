//! The front of the pictures: settings in, frames out.

use super::camera::Camera;
use super::colour_map::MapLook;
use super::error::PictureError;
use super::film::FilmPoints;
use super::film_network::FilmNetwork;
use super::interference::InterferenceTable;
use super::layers::SplatFilms;
use super::mesh_layers::MeshFilms;
use super::raster::Drawing;
use super::region_colours::{RegionsLook, colour_between};
use super::scale_bar::ScaleBar;
use super::settings::{Look, PictureSettings};
use super::shade::Shader;
use super::studio::Studio;
use super::triangles::FilmTriangles;
use glam::{DVec3, Vec2, Vec3};
use image::{Rgb, RgbImage};

/// Radius of a Plateau border at the camera's target, as a share of the picture's height.
const BORDER_RADIUS: f64 = 0.0032;

/// Paints films by one set of settings; tables are made once.
#[derive(Debug)]
pub struct Painter {
    settings: PictureSettings,
    /// The shader of the interference look; those of the other looks depend on the films.
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
            Look::Map { .. } | Look::Regions { .. } => None,
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
        self.paint_films(&Films::Points(films))
    }

    /// Paints films of triangles, with the lines where they meet.
    ///
    /// # Errors
    /// [`PictureError`] if the mesh is ragged or not finite, the camera has no direction, or there is neither a camera nor a
    /// triangle to frame. With a camera, no triangles give the empty stage.
    pub fn paint_triangles(&self, mesh: &FilmTriangles) -> Result<RgbImage, PictureError> {
        mesh.check()?;
        self.paint_films(&Films::Triangles(mesh, FilmNetwork::new(mesh)))
    }

    fn paint_films(&self, films: &Films) -> Result<RgbImage, PictureError> {
        match (&self.interference, &self.settings.look) {
            (Some(shader), _) => self.draw(films, shader, self.settings.width),
            (None, Look::Regions { opacity, relief }) => {
                let (opacity, relief) = (*opacity as f32, *relief as f32);
                let look = RegionsLook { colours: films.colours(), opacity, relief };
                self.draw(films, &Shader::Regions(look), self.settings.width)
            }
            (None, _) => self.draw_map(films),
        }
    }

    fn draw(&self, films: &Films, shader: &Shader, width: u32) -> Result<RgbImage, PictureError> {
        let size = (width, self.settings.height);
        let aspect = f64::from(size.0) / f64::from(size.1);
        let camera = self.settings.camera.map_or_else(|| films.framed(aspect), Ok)?;
        let samples = self.settings.samples as usize;
        let background = self.settings.background.backdrop();
        let drawing = Drawing { size, samples, camera: &camera, background, shader };
        match films {
            Films::Points(films) => drawing.draw(|view, grid| SplatFilms::new(films, view, grid)),
            Films::Triangles(mesh, network) => {
                let radius = self.settings.borders.then(|| BORDER_RADIUS * camera.height_at_target());
                drawing.draw(|view, grid| Ok(MeshFilms::new(mesh, network, radius, view, grid)))
            }
        }
    }

    fn draw_map(&self, films: &Films) -> Result<RgbImage, PictureError> {
        let Look::Map { colours, quantity, unit, unit_size, range, relief } = &self.settings.look else {
            unreachable!("invariant: a painter without interference shader has the look of a map");
        };
        let range = range.unwrap_or_else(|| films.value_range());
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

/// What one picture shows.
enum Films<'a> {
    Points(&'a [FilmPoints<'a>]),
    Triangles(&'a FilmTriangles<'a>, FilmNetwork),
}

impl Films<'_> {
    /// Smallest and largest value of all films.
    fn value_range(&self) -> (f64, f64) {
        match self {
            Self::Points(films) => films
                .iter()
                .map(FilmPoints::value_range)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), range| (low.min(range.0), high.max(range.1))),
            // Where all films have burst, the bar still has its ends.
            Self::Triangles(mesh, _) if mesh.triangles.is_empty() => (0.0, 1.0),
            Self::Triangles(mesh, _) => mesh.value_range(),
        }
    }

    /// A camera that sees all of it.
    fn framed(&self, aspect: f64) -> Result<Camera, PictureError> {
        match self {
            Self::Points([film]) => Camera::framing_points(film.positions, aspect),
            Self::Points(films) => {
                let all: Vec<DVec3> = films.iter().flat_map(|film| film.positions).copied().collect();
                Camera::framing_points(&all, aspect)
            }
            Self::Triangles(mesh, _) => Camera::framing_points(&mesh.places(), aspect),
        }
    }

    /// One colour per film, by its regions.
    fn colours(&self) -> Vec<Vec3> {
        match self {
            Self::Points(_) => vec![colour_between([0, 1])],
            Self::Triangles(mesh, network) => RegionsLook::colours_of(mesh, network),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Painter;
    use crate::picture::error::PictureError;
    use crate::picture::film::{FilmPoints, Part};
    use crate::picture::settings::PictureSettings;
    use crate::picture::test_meshes::{double_bubble, sphere};
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
    fn the_bytes_of_a_mesh_do_not_depend_on_the_number_of_threads() {
        let mesh = double_bubble(36);
        for look in ["(width: 150, height: 130)", "(width: 150, height: 130, look: Regions())"] {
            let [one, two, five] =
                [1, 2, 5].map(|threads| in_pool(threads, || painter(look).paint_triangles(&mesh.film()).unwrap()));
            assert!(one == two && one == five, "{look}");
        }
    }

    #[test]
    fn a_bubble_of_triangles_looks_like_one_of_points() {
        let (bubble, mut mesh) = (Bubble::new(40_000), sphere(5));
        mesh.values = mesh.positions.iter().map(|d| 1e-9 * (450.0 - 250.0 * d.y + 60.0 * (7.0 * d.x).sin())).collect();
        let camera = "camera: Some((position: (0, 0.8, 4), target: (0, 0, 0)))";
        for look in ["", "look: Map(quantity: \"thickness\", range: Some((1e-7, 8e-7))),"] {
            let painter = painter(&format!("(width: 160, height: 120, {look} {camera})"));
            let (points, triangles) =
                (painter.paint(&bubble.film()).unwrap(), painter.paint_triangles(&mesh.film()).unwrap());
            let difference: u64 = points.iter().zip(triangles.iter()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
            let mean = difference as f64 / points.len() as f64;
            assert!(mean < 1.5, "{mean} of 255 on average");
        }
    }

    #[test]
    fn the_films_of_a_double_bubble_have_a_colour_each_and_a_dark_border() {
        let camera = "camera: Some((position: (3, 1.5, 4), target: (0, 0, 0)))";
        let settings = format!("(width: 200, height: 150, look: Regions(opacity: 1.0, relief: 0.0), {camera})");
        let with = painter(&settings).paint_triangles(&double_bubble(48).film()).unwrap();
        let without = painter(&settings.replace("look", "borders: false, look"));
        let without = without.paint_triangles(&double_bubble(48).film()).unwrap();
        let dark = |picture: &RgbImage| picture.pixels().filter(|p| p.0.iter().all(|c| *c < 30)).count();
        assert!(dark(&with) > dark(&without) && with != without);
        let colours: std::collections::BTreeSet<[u8; 3]> =
            without.pixels().map(|p| p.0).filter(|p| p.iter().any(|c| *c > 120)).collect();
        let whole = |colour: &&[u8; 3]| without.pixels().filter(|p| p.0 == **colour).count() > 500;
        assert_eq!(colours.iter().filter(whole).count(), 2, "two outer films hide the wall");
    }

    #[test]
    fn a_mesh_whose_films_have_burst_leaves_the_empty_stage() {
        let mut mesh = sphere(1);
        mesh.triangles.clear();
        mesh.labels.clear();
        for look in ["", "look: Map(quantity: \"thickness\"),"] {
            let settings =
                format!("(width: 50, height: 40, {look} camera: Some((position: (0, 0, 4), target: (0, 0, 0))))");
            assert_eq!(painter(&settings).paint_triangles(&mesh.film()).unwrap().dimensions(), (50, 40));
        }
        assert!(matches!(painter("()").paint_triangles(&mesh.film()), Err(PictureError::NoPoints)));
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
