//! Draws the frames of a run: which films, which quantity, from where; then all frames as one animated picture, and a few
//! of them as one contact sheet.
//!
//! Where the world has a mesh, its triangles are drawn. Else a film is drawn where its carriers are: it shows the values of
//! its material particles where it has some, so that swirls show at full detail, and those of its carriers where not.
//! The camera is fixed over the run, by the scene alone: a resumed run draws the same bytes.

mod mesh;
mod quantity;

use std::io::Cursor;
use std::path::Path;

use bevy_ecs::world::World;
use froth_components::authored::film_shape::FilmShape;
use froth_components::kind::{EulerianParticle, Kind, LagrangianParticle, MeshVertex};
use froth_components::lamella::Lamellae;
use froth_components::motion::{Normal, Position};
use froth_systems::neighbours::nearest::NearestPoint;
use froth_systems::rows::read_column;
use glam::DVec3;
use image::{ImageFormat, RgbImage};
use rayon::prelude::*;

pub use quantity::QuantityError;

use self::mesh::MeshFilms;
use self::quantity::Quantity;
use crate::picture::camera::ELEVATION;
use crate::picture::contact_sheet::evenly_chosen;
use crate::picture::{
    Animation, AnimationSettings, Camera, ContactSheet, FilmPoints, Painter, Part, PictureError, PictureSettings,
};
use crate::run::{FrameError, FrameSink, RunFolder};
use crate::scene::{Scene, SceneError};
use crate::simulation::Simulation;

/// File of the animated picture in a run folder.
const ANIMATION: &str = "animation.png";
/// File of the contact sheet in a run folder.
const CONTACT_SHEET: &str = "contact_sheet.png";
/// Share of the picture that closed films fill: they wobble.
const FILL: f64 = 0.783;
/// Share that films fill if all are held by a rim.
const FILL_OF_RIMS: f64 = 0.88;
/// Least cosine between the view and the normal of a flat film.
const FACING: f64 = 0.4;
/// Where the camera may stand, elevation and azimuth in degrees: the first from which no flat film is seen edge-on.
const STANDS: [(f64, f64); 4] = [(ELEVATION, 0.0), (40.0, 0.0), (ELEVATION, 50.0), (40.0, 50.0)];

/// Why a scene's frames cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureFramesError {
    /// The scene's picture settings cannot be read.
    #[error(transparent)]
    Scene(#[from] Box<SceneError>),
    /// The settings make no picture.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The quantity does not exist.
    #[error(transparent)]
    Quantity(#[from] QuantityError),
}

/// The picture settings of a scene; their faults point into the file.
pub(crate) fn settings(scene: &Scene) -> Result<PictureSettings, SceneError> {
    let Some(block) = scene.picture() else { return Ok(PictureSettings::default()) };
    let settings: PictureSettings = block.read()?;
    match settings.check_fields() {
        Ok(()) => Ok(settings),
        Err((field, PictureError::OutOfRange { name, value, allowed })) => {
            Err(block.out_of_range(field, format!("{name} is {value}"), format!("it must be {allowed}")))
        }
        Err((field, error)) => {
            let help = "leave the field out to have the films framed".to_owned();
            Err(block.out_of_range(field, error.to_string(), help))
        }
    }
}

fn in_scene(scene: &Scene, error: QuantityError) -> PictureFramesError {
    match scene.picture() {
        Some(block) => {
            let QuantityError { wanted, nearest, known } = &error;
            Box::new(block.no_choice("quantity", wanted, nearest.as_deref(), known)).into()
        }
        None => error.into(),
    }
}

/// Checks the pictures of a simulation that has no particles yet, and gives their settings.
///
/// # Errors
/// As [`PictureFrames::of`] gives them.
pub fn check(simulation: &Simulation) -> Result<PictureSettings, PictureFramesError> {
    let scene = simulation.scene();
    let settings = settings(scene).map_err(Box::new)?;
    Quantity::check(&settings.look, simulation.world(), scene.has_liquid()).map_err(|error| in_scene(scene, error))?;
    Ok(settings)
}

/// Draws every frame as `frames/000123.png`; at the end all of them as an animated PNG, and a few as a contact sheet.
pub struct PictureFrames {
    painter: Painter,
    quantity: Quantity,
    frames_per_second: f64,
}

impl PictureFrames {
    /// The frames of a simulation, as its scene's `picture` block says.
    ///
    /// # Errors
    /// When the settings cannot be read, make no picture, or name a quantity that no particle has.
    pub fn of(simulation: &mut Simulation) -> Result<Self, PictureFramesError> {
        let scene = simulation.scene();
        let mut settings = settings(scene).map_err(Box::new)?;
        let aspect = f64::from(settings.width) / f64::from(settings.height);
        settings.camera = settings.camera.or_else(|| framing(scene, aspect));
        let frames_per_second = scene.header.frames_per_second.si();
        let quantity = Quantity::of(&settings.look, simulation.world_mut());
        let quantity = quantity.map_err(|error| in_scene(simulation.scene(), error))?;
        Ok(Self { painter: Painter::new(settings)?, quantity, frames_per_second })
    }

    fn paint(&self, world: &mut World) -> Result<RgbImage, PictureError> {
        let values = self.quantity.values(world);
        if self.quantity.kind == MeshVertex::NAME {
            return self.painter.paint_triangles(&MeshFilms::of(world).film(&values));
        }
        let spacing = world.resource::<Lamellae>().spacing;
        let carriers = Rows::of::<EulerianParticle>(world);
        if self.quantity.kind != LagrangianParticle::NAME {
            return self.painter.paint(&carriers.film(&values, spacing, Part::Whole));
        }
        let liquid = Rows::of::<LagrangianParticle>(world);
        let detail_spacing = spacing * (carriers.positions.len() as f64 / values.len() as f64).sqrt();
        let detail = liquid.film(&values, detail_spacing, Part::Detail);
        detail.check()?;
        let nearest = NearestPoint::build(&liquid.positions).map_err(|_| PictureError::NoPoints)?;
        let ground: Vec<f64> = carriers.positions.par_iter().map(|x| values[nearest.nearest(*x).0]).collect();
        self.painter.paint_all(&[detail, carriers.film(&ground, spacing, Part::Ground)])
    }
}

/// Where the particles of one kind are.
struct Rows {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
}

impl Rows {
    fn of<K: Kind>(world: &mut World) -> Self {
        let positions = read_column::<K, Position>(world).iter().map(|p| p.0).collect();
        Self { positions, normals: read_column::<K, Normal>(world).iter().map(|n| n.0).collect() }
    }

    fn film<'a>(&'a self, values: &'a [f64], spacing: f64, part: Part) -> FilmPoints<'a> {
        FilmPoints { positions: &self.positions, normals: &self.normals, values, spacing, part }
    }
}

/// The default camera: the outline of all shapes of the scene, with room to wobble.
fn framing(scene: &Scene, aspect: f64) -> Option<Camera> {
    let shapes: Vec<FilmShape> = scene.entities().iter().filter_map(|entity| entity.shape()).collect();
    let outline: Vec<DVec3> = shapes.iter().flat_map(FilmShape::outline).collect();
    let fill = if shapes.iter().any(FilmShape::is_closed) { FILL } else { FILL_OF_RIMS };
    let normals: Vec<DVec3> = shapes.iter().flat_map(FilmShape::flat_normals).collect();
    Camera::filling(&outline, stand(&normals), fill, aspect).ok()
}

/// Unit vector to the first stand that sees every flat film well, or else to the one that sees the worst film best.
fn stand(normals: &[DVec3]) -> DVec3 {
    let stands = STANDS.map(|(elevation, azimuth)| Camera::towards_eye(elevation, azimuth));
    let facing = |eye: &DVec3| normals.iter().map(|normal| normal.dot(*eye).abs()).fold(1.0, f64::min);
    let good = stands.iter().find(|eye| facing(eye) >= FACING);
    let best = || stands.iter().max_by(|a, b| facing(a).total_cmp(&facing(b)));
    *good.or_else(best).expect("invariant: there are stands")
}

impl FrameSink for PictureFrames {
    fn frame(&mut self, world: &mut World, frame: u64, folder: &RunFolder) -> Result<(), FrameError> {
        write(folder, RunFolder::frame_file(frame), &self.paint(world)?)
    }

    fn finish(&mut self, folder: &RunFolder) -> Result<(), FrameError> {
        let rate = self.frames_per_second.round().clamp(1.0, f64::from(u16::MAX)) as u16;
        let settings = AnimationSettings { frames_per_second: rate, ..AnimationSettings::default() };
        let mut animation = Animation::new(Cursor::new(Vec::new()), settings)?;
        let path = |frame| folder.path().join(RunFolder::frame_file(frame));
        let count = (0..).take_while(|frame| path(*frame).exists()).count() as u64;
        let chosen = evenly_chosen(count);
        let mut sheet = ContactSheet::for_frames(chosen.len());
        for frame in 0..count {
            let picture = image::open(path(frame))?.to_rgb8();
            animation.push(&picture)?;
            if chosen.binary_search(&frame).is_ok() {
                sheet.push(&picture, time_label(frame, self.frames_per_second));
            }
        }
        folder.write(ANIMATION, animation.finish()?.get_ref())?;
        write(folder, CONTACT_SHEET, &sheet.picture())
    }
}

/// Writes a picture into the run folder.
fn write(folder: &RunFolder, file: impl AsRef<Path>, picture: &RgbImage) -> Result<(), FrameError> {
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, ImageFormat::Png)?;
    folder.write(file, bytes.get_ref())?;
    Ok(())
}

/// Time of a frame, with as many decimals as tell frames apart.
fn time_label(frame: u64, frames_per_second: f64) -> String {
    let decimals = frames_per_second.log10().ceil().clamp(0.0, 6.0) as usize;
    format!("{:.decimals$} s", frame as f64 / frames_per_second)
}

#[cfg(test)]
mod tests {
    use super::{FACING, framing, stand, time_label};
    use crate::scene::{AuthoredRegistry, Scene};
    use froth_components::authored::film_shape::FilmShape;
    use glam::DVec3;

    fn scene(shapes: &[&str]) -> Scene {
        let films: String = shapes.iter().map(|s| format!("[ {s}, Film(thickness: Uniform(\"400 nm\")) ],")).collect();
        let text = format!(
            "Scene(title: \"\", method: Melp(), resolution: Particles(1000), duration: 1, entities: [{films}])"
        );
        Scene::from_text("scene.ron", &text, &AuthoredRegistry::built_in()).unwrap()
    }

    /// Largest shares of the picture that the outline reaches to the left, right, bottom and top.
    fn reach(scene: &Scene, aspect: f64) -> [f64; 4] {
        let view = framing(scene, aspect).unwrap().view(aspect, 1.0).unwrap();
        let shapes: Vec<FilmShape> = scene.entities().iter().filter_map(|entity| entity.shape()).collect();
        shapes.iter().flat_map(FilmShape::outline).fold([f64::MIN; 4], |[left, right, bottom, top], point| {
            let placed = view.place(point);
            assert!(placed.z < 0.0, "{point} is behind the camera");
            let (x, y) = view.project(placed);
            let (x, y) = (2.0 * x / aspect - 1.0, 1.0 - 2.0 * y);
            [left.max(-x), right.max(x), bottom.max(-y), top.max(y)]
        })
    }

    #[test]
    fn the_outline_of_every_shape_lies_centred_inside_the_picture_and_fills_it() {
        let scenes: [&[&str]; 8] = [
            &["Sphere(radius: \"10 cm\")"],
            &["Ellipsoid(centre: (1, 2, 3), radii: (\"5 cm\", \"10 cm\", \"30 cm\"))"],
            &["HalfSphere(radius: \"5 cm\")"],
            &["Disc(radius: \"5 cm\")"],
            &["Disc(radius: \"5 cm\", normal: (0, 1, 0))"],
            &["Rectangle(width: \"16 cm\", height: \"9 cm\")"],
            &["Rectangle(width: \"6 cm\", height: \"9 cm\", normal: (1, 0, 0))"],
            &[
                "Sphere(centre: (\"-20 cm\", 0, 0), radius: \"5 cm\")",
                "Disc(centre: (\"20 cm\", 0, 0), radius: \"3 cm\")",
            ],
        ];
        for shapes in scenes {
            for aspect in [0.5, 1.0, 16.0 / 9.0] {
                let [left, right, bottom, top] = reach(&scene(shapes), aspect);
                let widest = left.max(right).max(bottom).max(top);
                assert!((0.6..0.95).contains(&widest), "{shapes:?} at {aspect}: {widest}");
                let centred = (left - right).abs() < 1e-6 && (bottom - top).abs() < 1e-6;
                assert!(centred, "{shapes:?} at {aspect}: {left} {right} {bottom} {top}");
            }
        }
    }

    #[test]
    fn a_bubble_is_framed_like_a_sphere() {
        use crate::picture::Camera;
        let found = framing(&scene(&["Sphere(radius: \"10 cm\")"]), 1.0).unwrap();
        // Room for the wobble on top of the room around any sphere, 1.12 each.
        let sphere = Camera::framing(DVec3::ZERO, 1.12 * 0.1, 1.0);
        assert!((found.position - sphere.position).length() < 0.005 * sphere.position.length());
    }

    #[test]
    fn labels_of_frames_tell_them_apart() {
        let labels = [(3, 10.0), (3, 24.0), (7, 1.0), (1, 1000.0)].map(|(frame, rate)| time_label(frame, rate));
        assert_eq!(labels, ["0.3 s", "0.12 s", "7 s", "0.001 s"]);
    }

    #[test]
    fn no_flat_film_is_seen_edge_on() {
        for normal in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.6, 0.8, 0.0), DVec3::new(0.0, 0.96, -0.28)] {
            assert!(stand(&[normal]).dot(normal).abs() >= FACING, "{normal}");
        }
        assert!(DVec3::AXES.iter().all(|axis| stand(&DVec3::AXES).dot(*axis).abs() >= FACING), "a cube");
        assert_eq!(stand(&[DVec3::Z]), stand(&[]));
    }
}
