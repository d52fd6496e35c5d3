//! `froth check`: what a scene would build, without building it.

use clap::Args;
use froth_components::authored::field::{Gravity, Wind};
use froth_components::authored::method::{MelpSettings, MethodChoice};
use froth_components::authored::motion::{Drift, Spin, Swirl};
use froth_components::authored::wire::Moves;
use froth_components::quantity::Time;
use glam::DVec3;

use super::report::{Failure, show};
use super::{DONE, WRONG_USAGE, say, scene_choice};
use crate::frames;
use crate::method::method;
use crate::picture::PictureSettings;
use crate::scene::{AuthoredRegistry, Estimate, Rows, Scene, SceneHeader, available_memory};
use crate::simulation::{Frames, Simulation};

/// Each picture is written twice: as a frame, and in the animation.
const COPIES: f64 = 2.0;

#[derive(Debug, Args)]
pub(super) struct CheckArguments {
    /// Scene files, or names of built-in scenes
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<String>,
}

/// Checks every scene, also after one that is wrong.
pub(super) fn check(arguments: &CheckArguments) -> Result<u8, Failure> {
    let mut exit_code = DONE;
    for argument in &arguments.scenes {
        match checked(argument) {
            Ok(description) => say(description),
            Err(failure) => {
                show(&failure);
                exit_code = WRONG_USAGE;
            }
        }
    }
    Ok(exit_code)
}

/// What the scene that `argument` means would build. What no code runs is checked as far as it goes.
fn checked(argument: &str) -> Result<String, Failure> {
    let scene = scene_choice::read(argument, &AuthoredRegistry::built_in())?;
    if method(scene.header.method.name()).is_none() {
        scene.check(available_memory())?;
        return Ok(describe(&scene, &frames::settings(&scene)?));
    }
    let (simulation, pictures) = scene_choice::check(argument, Simulation::builder())?;
    Ok(describe(simulation.scene(), &pictures))
}

fn describe(scene: &Scene, pictures: &PictureSettings) -> String {
    let (header, estimate) = (&scene.header, scene.estimate());
    let (duration, rate) = (header.duration.si(), header.frames_per_second.si());
    let films = scene.films().count();
    let frames = Frames::per_second(rate).count_until(duration);
    [
        format!("{}: {}", scene.source().name(), header.title),
        format!("  method     {}", method_line(header)),
        format!("  entities   {} authored, {films} of them films", scene.entities().len()),
        carriers(&estimate),
        format!(
            "  memory     about {:.1} MB, and {:.1} MB to draw a picture",
            1e-6 * estimate.bytes as f64,
            1e-6 * pictures.memory() as f64
        ),
        format!("  time       {} s, {frames} frames at {rate} per second", (1e9 * duration).round() / 1e9),
        format!(
            "  pictures   {} x {} pixels; at most {:.0} MB on disk, with the animation",
            pictures.width,
            pictures.height,
            1e-6 * COPIES * frames as f64 * bytes_of_picture(pictures)
        ),
        format!("  steps      {}", steps(scene, &estimate)),
    ]
    .join("\n")
}

/// The method, and whether any code runs it.
fn method_line(header: &SceneHeader) -> String {
    let name = header.method.name();
    let note = if method(name).is_some() { "" } else { "; no part of this version runs it" };
    format!("{}{note}", name.on_command_line())
}

/// What the films are made of.
fn carriers(estimate: &Estimate) -> String {
    let (rows, spacing) = (estimate.rows, 1e3 * estimate.spacing);
    match rows {
        Rows::Particles { .. } => format!("  particles  {rows}; {spacing:.3} mm apart"),
        Rows::Mesh { .. } => format!("  mesh       {rows}; edges of {spacing:.3} mm"),
    }
}

/// Length of a PNG that could not be compressed, bytes.
fn bytes_of_picture(pictures: &PictureSettings) -> f64 {
    3.0 * f64::from(pictures.width) * f64::from(pictures.height)
}

/// What is known of the steps: a frame ends one, and a speed that the films may well reach asks for more.
fn steps(scene: &Scene, estimate: &Estimate) -> String {
    let (duration, longest) = (scene.header.duration.si(), longest_step(&scene.header));
    let least = (duration / longest).ceil();
    let known = format!("{least:.0} or more, none longer than {:.3} ms", 1e3 * longest);
    let known = match scene.header.method {
        MethodChoice::Melp(MelpSettings { substeps, .. }) if substeps > 1 && scene.has_liquid() => {
            format!("{known}, each of up to {substeps} substeps")
        }
        _ => known,
    };
    let speed = likely_speed(scene);
    let crossing = scene.header.method.cfl().si() * estimate.spacing / speed;
    if crossing >= longest {
        return known;
    }
    format!("{known}; about {:.0} if films flow at {speed:.2} m/s", duration / crossing)
}

/// The longest of equal steps, as many as a frame needs under the limits that scene and method give, s.
fn longest_step(header: &SceneHeader) -> f64 {
    let frame = 1.0 / header.frames_per_second.si();
    let limit =
        [header.maximum_step, header.method.longest_step()].into_iter().flatten().map(Time::si).fold(frame, f64::min);
    frame / (frame / limit).ceil()
}

/// The speed of a fall, m/s; of overdamped films, which do not fall freely, that at which tension moves a bubble's own curvature,
/// `mobility * 4 σ / R`.
fn creep_or(fall: f64, scene: &Scene) -> f64 {
    let Some(creep) = scene.header.method.creep() else { return fall };
    let smallest = scene.films().map(|(_, shape)| shape.size()).fold(f64::INFINITY, f64::min);
    creep.mobility.si() * 4.0 * scene.header.liquid.surface_tension.si() / smallest
}

/// A speed that films may reach, m/s: that of the start, of the wind, and of a fall through their own size, `sqrt(2 g R)`.
fn likely_speed(scene: &Scene) -> f64 {
    let components = || scene.entities().iter();
    let start = scene.films().map(|(film, shape)| {
        let drift = film.get::<Drift>().map_or(0.0, |drift| drift.0.si().length());
        let spin = film.get::<Spin>().map_or(0.0, |spin| spin.rate.si().abs() * shape.size());
        drift + spin + film.get::<Swirl>().map_or(0.0, |swirl| swirl.speed.si())
    });
    let wires = components().filter_map(|entity| entity.get::<Moves>());
    let pulled = wires.flat_map(|moves| moves.velocity.frames()).map(|frame| frame.value.si().length());
    let wind = components().filter_map(|entity| entity.get::<Wind>()).map(|wind| wind.velocity.at(0.0).si().length());
    let pull = components().filter_map(|entity| entity.get::<Gravity>()).map(|field| field.0.at(0.0).si());
    let size = scene.films().map(|(_, shape)| shape.size()).fold(0.0, f64::max);
    let fall = (2.0 * pull.sum::<DVec3>().length() * size).sqrt();
    start.chain(wind).chain(pulled).chain([creep_or(fall, scene)]).fold(0.0, f64::max)
}
