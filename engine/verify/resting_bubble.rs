//! A bubble at rest stays at rest, at 1 atm and with the mass of a real film.
//!
//! # Equation
//! Nothing moves: `V` constant as evolved by the film's flux and as measured from its carriers, speeds fall, and no
//! limit of the redistribution is ever reached.

use std::f64::consts::PI;

use super::finding::Finding;
use super::scene_run::SceneRun;
use super::{Effort, LawError};

const RADIUS: f64 = 0.05;

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
    let braked = Allowed { speed: 1e-3, growth: 1.0 };
    let mut found = findings("with air", &rest(&scene, end)?, end, braked);
    // Sampling noise of 3e-4 in the concentration sets the liquid in motion at that part of the wave speed, 14 m/s; it
    // takes seconds to come to rest.
    let bare = scene.clone().with("liquid_per_carrier: 8", "liquid_per_carrier: 8, air: None");
    let short = effort.choose(0.1, 5.0);
    let allowed = Allowed { speed: effort.choose(5e-3, 1e-3), ..braked };
    found.extend(findings("bare film", &rest(&bare, short)?, short, allowed));
    // Nothing brakes: the noise of the start stays, and must not grow.
    let free = scene.with("[ AirDrag(rate: \"1 1/s\", normal: \"2 1/s\") ],", "");
    found.extend(findings("with air, no drag", &rest(&free, end)?, end, Allowed { speed: 2e-3, growth: 1.5 }));
    Ok(found)
}

/// Records every step until `end`, s.
fn rest(scene: &SceneRun, end: f64) -> Result<Vec<Sample>, LawError> {
    let mut simulation = scene.begin()?;
    let mut samples = Vec::new();
    while !simulation.has_reached(end) {
        simulation.step_within(end)?;
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

/// What may be left of the motion.
#[derive(Clone, Copy)]
struct Allowed {
    /// Largest speed along the normal, and mean speed of the liquid, in the last quarter, m/s.
    speed: f64,
    /// Ratio of late to early normal speeds.
    growth: f64,
}

fn findings(name: &str, samples: &[Sample], end: f64, allowed: Allowed) -> Vec<Finding> {
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
        Finding::vanishing(of("largest normal speed at the end, m/s"), within(0.75, 1.0, &|s| s.speed), allowed.speed),
        Finding::vanishing(of("normal speed, last quarter over first"), decay(&|s| s.speed), allowed.growth),
        Finding::vanishing(
            of("mean speed of the liquid at the end, m/s"),
            within(0.75, 1.0, &|s| s.flow),
            allowed.speed,
        ),
        Finding::vanishing(of("carriers limited, in all steps"), largest(&|s| s.limited), 0.0),
    ]
}
