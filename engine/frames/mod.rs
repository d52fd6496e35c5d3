//! Draws the frames of a run: which particles, which quantity, from where; then all frames as one animated picture.
//!
//! A film is drawn where its carriers are. It shows the values of its material particles where it has some, so that
//! swirls show at full detail, and those of its carriers where not. The camera is fixed over the run, by the scene alone: a resumed run draws the same bytes.

mod quantity;

use std::io::Cursor;

use bevy_ecs::world::World;
use froth_components::kind::{EulerianParticle, Kind, LagrangianParticle};
use froth_components::lamella::Lamellae;
use froth_components::motion::{Normal, Position};
use froth_systems::neighbours::nearest::NearestPoint;
use froth_systems::rows::read_column;
use glam::DVec3;
use image::{ImageFormat, RgbImage};
use rayon::prelude::*;

pub use quantity::QuantityError;

use self::quantity::Quantity;
use crate::picture::{Animation, AnimationSettings, Camera, FilmPoints, Painter, Part, PictureError, PictureSettings};
use crate::run::{FrameError, FrameSink, RunFolder};
use crate::scene::{Scene, SceneError};
use crate::simulation::Simulation;

/// File of the animated picture in a run folder.
const ANIMATION: &str = "animation.png";
/// Space left around the shapes, relative to their size: films wobble.
const MARGIN: f64 = 1.12;

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

/// Draws every frame as `frames/000123.png`, and at the end all of them as an animated PNG.
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
        let mut settings: PictureSettings = match scene.picture() {
            Some(block) => block.read().map_err(Box::new)?,
            None => PictureSettings::default(),
        };
        let aspect = f64::from(settings.width) / f64::from(settings.height);
        settings.camera = settings.camera.or_else(|| framing(scene, aspect));
        let frames_per_second = scene.header.frames_per_second.si();
        let quantity = Quantity::of(&settings.look, simulation.world_mut())?;
        Ok(Self { painter: Painter::new(settings)?, quantity, frames_per_second })
    }

    fn paint(&self, world: &mut World) -> Result<RgbImage, PictureError> {
        let spacing = world.resource::<Lamellae>().spacing;
        let values = self.quantity.values(world);
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

/// The default camera: all shapes of the scene, with room to wobble.
fn framing(scene: &Scene, aspect: f64) -> Option<Camera> {
    let shapes: Vec<_> = scene.entities().iter().filter_map(|entity| entity.shape()).collect();
    let corners = shapes.iter().flat_map(|shape| {
        let reach = DVec3::splat(shape.size());
        [shape.centre() - reach, shape.centre() + reach]
    });
    let (low, high) = corners.fold(None, |found: Option<(DVec3, DVec3)>, p| {
        Some(found.map_or((p, p), |(low, high)| (low.min(p), high.max(p))))
    })?;
    let centre = 0.5 * (low + high);
    let radius = shapes.iter().map(|shape| shape.centre().distance(centre) + shape.size()).fold(0.0, f64::max);
    Some(Camera::framing(centre, MARGIN * radius, aspect))
}

impl FrameSink for PictureFrames {
    fn frame(&mut self, world: &mut World, frame: u64, folder: &RunFolder) -> Result<(), FrameError> {
        let picture = self.paint(world)?;
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, ImageFormat::Png)?;
        folder.write(RunFolder::frame_file(frame), bytes.get_ref())?;
        Ok(())
    }

    fn finish(&mut self, folder: &RunFolder) -> Result<(), FrameError> {
        let rate = self.frames_per_second.round().clamp(1.0, f64::from(u16::MAX)) as u16;
        let settings = AnimationSettings { frames_per_second: rate, ..AnimationSettings::default() };
        let mut animation = Animation::new(Cursor::new(Vec::new()), settings)?;
        for frame in 0.. {
            let path = folder.path().join(RunFolder::frame_file(frame));
            if !path.exists() {
                break;
            }
            animation.push(&image::open(path)?.to_rgb8())?;
        }
        folder.write(ANIMATION, animation.finish()?.get_ref())?;
        Ok(())
    }
}
