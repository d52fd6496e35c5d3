//! The scene that an argument means: a file, or else a built-in scene of that name.

use std::path::Path;

use super::report::Failure;
use crate::picture::PictureSettings;
use crate::scene::{AuthoredRegistry, Scene, SceneError};
use crate::simulation::{Simulation, SimulationBuilder};
use crate::{frames, gallery};

/// Reads the scene that `argument` means.
pub(super) fn read(argument: &str, registry: &AuthoredRegistry) -> Result<Scene, Failure> {
    Ok(match built_in(argument) {
        Some(scene) => Scene::from_text(scene.name, scene.text, registry),
        None => Scene::from_path(argument, registry).map_err(|error| with_built_in_names(error, argument)),
    }?)
}

/// Builds the simulation that `argument` means.
pub(super) fn build(argument: &str, builder: SimulationBuilder) -> Result<Simulation, Failure> {
    // Read first, for the better error.
    let scene = read(argument, &AuthoredRegistry::built_in())?;
    Ok(builder.build_from_text(scene.source().name(), scene.source().text())?)
}

/// Checks the scene that `argument` means, with its pictures; gives the simulation without particles, and how pictures are drawn.
pub(super) fn check(argument: &str, builder: SimulationBuilder) -> Result<(Simulation, PictureSettings), Failure> {
    // Read first, for the better error.
    let scene = read(argument, &AuthoredRegistry::built_in())?;
    let simulation = builder.build_without_particles(scene.source().name(), scene.source().text())?;
    let pictures = frames::check(&simulation)?;
    Ok((simulation, pictures))
}

/// What run folders of the scene are called.
pub(super) fn stem(argument: &str) -> String {
    let stem = Path::new(argument).file_stem().map(|stem| stem.to_string_lossy().into_owned());
    stem.filter(|stem| !stem.is_empty()).unwrap_or_else(|| "run".to_owned())
}

/// A file of that name wins.
fn built_in(argument: &str) -> Option<&'static gallery::BuiltInScene> {
    gallery::built_in(argument).filter(|_| !Path::new(argument).exists())
}

/// A missing file may be a built-in name with a slip.
fn with_built_in_names(error: SceneError, argument: &str) -> SceneError {
    match error {
        SceneError::Missing { path, nearest } => {
            let nearest = gallery::nearest_name(argument).map(str::to_owned).or(nearest);
            SceneError::Missing { path, nearest }
        }
        other => other,
    }
}
