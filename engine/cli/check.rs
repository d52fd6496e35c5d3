//! `froth check`: what a scene would build, without building it.

use clap::Args;
use froth_components::authored::field::{Gravity, Wind};
use froth_components::authored::method::MethodChoice;
use froth_components::authored::motion::{Drift, Spin, Swirl};
use glam::DVec3;

use super::report::{Failure, show};
use super::{DONE, WRONG_USAGE, say, scene_choice};
use crate::picture::PictureSettings;
use crate::scene::{Estimate, Scene};
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
        match scene_choice::check(argument, Simulation::builder()) {
            Ok((simulation, pictures)) => say(describe(simulation.scene(), &pictures)),
            Err(failure) => {
                show(&failure);
                exit_code = WRONG_USAGE;
            }
        }
    }
    Ok(exit_code)
}

fn describe(scene: &Scene, pictures: &PictureSettings) -> String {
    let (header, estimate) = (&scene.header, scene.estimate());
    let (duration, rate) = (header.duration.si(), header.frames_per_second.si());
    let films = scene.films().count();
    let frames = Frames::per_second(rate).count_until(duration);
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

/// Length of a PNG that could not be compressed, bytes.
fn bytes_of_picture(pictures: &PictureSettings) -> f64 {
    3.0 * f64::from(pictures.width) * f64::from(pictures.height)
}

/// What is known of the steps: a frame ends one, and a speed that the films may well reach asks for more.
fn steps(scene: &Scene, estimate: &Estimate) -> String {
    let header = &scene.header;
    let (duration, frame) = (header.duration.si(), 1.0 / header.frames_per_second.si());
    let limit = header.maximum_step.map_or(frame, |step| step.si().min(frame));
    // As many equal steps as a frame needs.
    let longest = frame / (frame / limit).ceil();
    let least = (duration / longest).ceil();
    let known = format!("{least:.0} or more, none longer than {:.3} ms", 1e3 * longest);
    let MethodChoice::Melp(settings) = header.method else { return known };
    let known = match settings.substeps {
        substeps if substeps > 1 && scene.has_liquid() => format!("{known}, each of up to {substeps} substeps"),
        _ => known,
    };
    let speed = likely_speed(scene);
    let crossing = settings.cfl.si() * estimate.spacing / speed;
    if crossing >= longest {
        return known;
    }
    format!("{known}; about {:.0} if films flow at {speed:.2} m/s", duration / crossing)
}

/// A speed that films may reach, m/s: that of the start, of the wind, and of a fall through their own size, `sqrt(2 g R)`.
fn likely_speed(scene: &Scene) -> f64 {
    let components = || scene.entities().iter();
    let start = scene.films().map(|(film, shape)| {
        let drift = film.get::<Drift>().map_or(0.0, |drift| drift.0.si().length());
        let spin = film.get::<Spin>().map_or(0.0, |spin| spin.rate.si().abs() * shape.size());
        drift + spin + film.get::<Swirl>().map_or(0.0, |swirl| swirl.speed.si())
    });
    let wind = components().filter_map(|entity| entity.get::<Wind>()).map(|wind| wind.velocity.at(0.0).si().length());
    let pull = components().filter_map(|entity| entity.get::<Gravity>()).map(|field| field.0.at(0.0).si());
    let size = scene.films().map(|(_, shape)| shape.size()).fold(0.0, f64::max);
    let fall = (2.0 * pull.sum::<DVec3>().length() * size).sqrt();
    start.chain(wind).chain([fall]).fold(0.0, f64::max)
}
