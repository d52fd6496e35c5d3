//! A bubble at rest stays at rest, at 1 atm and with the mass of a real film.
//!
//! # Equation
//! Nothing moves: `V` constant as evolved by the film's flux and as measured from its carriers, speeds fall, and no
//! limit of the redistribution is ever reached.

use froth_systems::melp::normal_motion::SUBSTEP;
use std::f64::consts::PI;

use super::finding::Finding;
use super::scene_run::SceneRun;
use super::{Effort, LawError};

const RADIUS: f64 = 0.05;
const TENSION: f64 = 0.03;
const MASS: f64 = 1000.0 * 400e-9;

/// What is recorded in every step.
struct Sample {
    time: f64,
    evolved: f64,
    measured: f64,
    speed: f64,
    flow: f64,
    limited: f64,
}

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let (count, end): (u32, f64) = effort.choose((500, 1.0), (1000, 5.0));
    let scene = SceneRun::of("resting_bubble").with("Particles(1000)", &format!("Particles({count})"));
    let mut found = findings("with air", &rest(&scene, end, f64::INFINITY)?, end, 1e-3);
    // One substep of the normal motion on each geometry: with the bare mass several in a row are not stable.
    let (end, spacing) = (effort.choose(0.08, 5.0), (4.0 * PI / f64::from(count)).sqrt() * RADIUS);
    let step = SUBSTEP * spacing / (2.0 * TENSION / MASS).sqrt();
    let bare = scene.with("liquid_per_carrier: 8", "liquid_per_carrier: 8, air: None");
    // Sampling noise of 3e-4 in the concentration sets the liquid in motion at that part of the wave speed, 14 m/s; it
    // takes seconds to come to rest.
    found.extend(findings("bare film", &rest(&bare, end, step)?, end, effort.choose(5e-3, 1e-3)));
    Ok(found)
}

/// Records every step until `end`, s.
fn rest(scene: &SceneRun, end: f64, step: f64) -> Result<Vec<Sample>, LawError> {
    let mut simulation = scene.begin()?;
    let mut samples = Vec::new();
    while !simulation.has_reached(end) {
        let next = (simulation.time() + step).min(end);
        simulation.step_within(next)?;
        let get = |name: &str| simulation.observables().get(name).unwrap_or(f64::NAN);
        samples.push(Sample {
            time: simulation.time(),
            evolved: get("volume_1"),
            measured: get("measured_volume_1"),
            speed: get("max_normal_speed"),
            flow: get("mean_speed"),
            limited: get("carriers_limited"),
        });
    }
    Ok(samples)
}

/// `calm`: speed of the liquid allowed at the end, m/s.
fn findings(name: &str, samples: &[Sample], end: f64, calm: f64) -> Vec<Finding> {
    let exact = 4.0 / 3.0 * PI * RADIUS.powi(3);
    let first = samples.first().map_or(f64::NAN, |sample| sample.evolved);
    let largest = |f: &dyn Fn(&Sample) -> f64| {
        samples.iter().map(f).fold(0.0, |a: f64, b| if b > a || b.is_nan() { b } else { a })
    };
    let within = |from: f64, to: f64, f: &dyn Fn(&Sample) -> f64| {
        let chosen: Vec<f64> = samples.iter().filter(|s| s.time > from * end && s.time <= to * end).map(f).collect();
        chosen.iter().sum::<f64>() / chosen.len() as f64
    };
    let decay = |f: &dyn Fn(&Sample) -> f64| within(0.75, 1.0, f) / within(0.0, 0.25, f);
    let of = |what: &str| format!("{name}: {what}");
    vec![
        Finding::vanishing(
            of("volume as evolved, largest relative change"),
            largest(&|s| (s.evolved / first - 1.0).abs()),
            1e-6,
        ),
        Finding::vanishing(
            of("volume as measured, largest relative error"),
            largest(&|s| (s.measured / exact - 1.0).abs()),
            1e-3,
        ),
        Finding::vanishing(
            of("drift of the measured volume, second quarter to last"),
            within(0.75, 1.0, &|s| s.measured) / within(0.25, 0.5, &|s| s.measured) - 1.0,
            1e-5,
        ),
        Finding::vanishing(of("largest normal speed at the end, m/s"), within(0.75, 1.0, &|s| s.speed), 1e-3),
        Finding::vanishing(of("normal speed, last quarter over first"), decay(&|s| s.speed), 1.0),
        Finding::vanishing(of("mean speed of the liquid at the end, m/s"), within(0.75, 1.0, &|s| s.flow), calm),
        Finding::vanishing(of("carriers limited, in all steps"), largest(&|s| s.limited), 0.0),
    ]
}
