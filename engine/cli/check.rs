//! `froth check`: what a scene would build, without building it.

use clap::Args;
use froth_components::authored::method::MethodChoice;
use froth_components::authored::motion::Drift;

use super::report::{Failure, show};
use super::{DONE, WRONG_USAGE, say, scene_choice};
use crate::scene::{AuthoredRegistry, Estimate, Scene, available_memory};

/// Acceleration assumed for the first step, m/s^2: twice gravity, as the method does.
const ACCELERATION: f64 = 20.0;

#[derive(Debug, Args)]
pub(super) struct CheckArguments {
    /// Scene files, or names of built-in scenes
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<String>,
}

/// Checks every scene, also after one that is wrong.
pub(super) fn check(arguments: &CheckArguments) -> Result<u8, Failure> {
    let registry = AuthoredRegistry::built_in();
    let mut exit_code = DONE;
    for argument in &arguments.scenes {
        let checked =
            scene_choice::read(argument, &registry).and_then(|scene| Ok((scene.check(available_memory())?, scene)));
        match checked {
            Ok((estimate, scene)) => say(describe(&scene, &estimate)),
            Err(failure) => {
                show(&failure);
                exit_code = WRONG_USAGE;
            }
        }
    }
    Ok(exit_code)
}

fn describe(scene: &Scene, estimate: &Estimate) -> String {
    let header = &scene.header;
    let (duration, rate) = (header.duration.si(), header.frames_per_second.si());
    let step = first_step(scene, estimate);
    let films = scene.films().count();
    [
        format!("{}: {}", scene.source().name(), header.title),
        format!("  method     {}", header.method.name().on_command_line()),
        format!("  entities   {} authored, {films} of them films", scene.entities().len()),
        format!(
            "  particles  {} eulerian, {} lagrangian, {} boundary; {:.3} mm apart",
            estimate.eulerian,
            estimate.lagrangian,
            estimate.boundary,
            1e3 * estimate.spacing
        ),
        format!("  memory     about {:.1} MB", 1e-6 * estimate.bytes as f64),
        format!("  time       {duration} s, {:.0} frames at {rate} per second", (duration * rate).floor() + 1.0),
        format!(
            "  steps      about {:.0}, the first of {:.3} ms; more where films are fast",
            duration / step,
            1e3 * step
        ),
    ]
    .join("\n")
}

/// Length of the first step, s: CFL with the drift of the fastest film, the next frame, and the scene's own limit.
fn first_step(scene: &Scene, estimate: &Estimate) -> f64 {
    let drifts = scene.entities().iter().filter_map(|entity| entity.get::<Drift>());
    let speed = drifts.map(|drift| drift.0.si().length()).fold(0.0, f64::max);
    let distance = match scene.header.method {
        MethodChoice::Melp(settings) => settings.cfl.si() * estimate.spacing,
        _ => estimate.spacing,
    };
    let crossing = 2.0 * distance / (speed + (speed * speed + 2.0 * ACCELERATION * distance).sqrt());
    let frame = 1.0 / scene.header.frames_per_second.si();
    let longest = scene.header.maximum_step.map_or(f64::INFINITY, |step| step.si());
    // As many equal steps as a frame needs.
    frame / (frame / crossing.min(longest)).ceil().max(1.0)
}
