//! An uneven disc evens out at the elasticity of a real film, in steps of CFL 0.99.
//!
//! # Equation
//! `Gamma/eta` is the same everywhere, so that uniform tension is uniform thickness: its deviation tends to 0.

use super::finding::Finding;
use super::scene_run::SceneRun;
use super::{Effort, LawError};

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let (count, end) = effort.choose((600, 0.5), (2000, 1.0));
    let scene = SceneRun::of("equilibrium_disc").with("Particles(2000)", &format!("Particles({count})"));
    let mut simulation = scene.begin()?;
    let mut first = None;
    let mut deviation = f64::NAN;
    let mut fastest = f64::NAN;
    while !simulation.has_reached(end) {
        simulation.step_within(end)?;
        let get = |name: &str| simulation.observables().get(name).unwrap_or(f64::NAN);
        deviation = get("thickness_deviation") / get("thickness_mean");
        fastest = get("mean_speed");
        first = first.or(Some(deviation));
    }
    Ok(vec![
        Finding::vanishing("thickness shown, deviation over mean, at the end", deviation, 5e-3),
        Finding::vanishing(
            "the same relative to that after the first step",
            deviation / first.unwrap_or(f64::NAN),
            0.1,
        ),
        Finding::vanishing("mean speed of the liquid, m/s", fastest, 0.01),
    ])
}
