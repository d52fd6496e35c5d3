//! An uneven disc evens out at the elasticity of a real film, in steps of CFL 0.99.
//!
//! # Equation
//! `Gamma/eta` is the same everywhere, so that uniform tension is uniform thickness: its deviation tends to 0.
//!
//! Shown is `V Gamma/S`, with the concentration that the Marangoni solve gives. The liquid per area as gathered from the
//! material particles is the same up to their sampling noise.

use froth_components::film::LiquidVolume;
use froth_components::kind::EulerianParticle;
use froth_systems::melp::state::Transfers;

use super::finding::Finding;
use super::sampled::root_mean_square;
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
    let amounts: Vec<f64> = simulation.column::<EulerianParticle, LiquidVolume>().iter().map(|v| v.0).collect();
    let duals = &simulation.world().resource::<Transfers>().dual_areas;
    let gathered: Vec<f64> = amounts.iter().zip(duals).map(|(v, a)| v / a).collect();
    let mean = gathered.iter().sum::<f64>() / gathered.len() as f64;
    let noise = root_mean_square(gathered.iter().map(|eta| eta / mean - 1.0));
    Ok(vec![
        Finding::vanishing("liquid per area as gathered, deviation over mean", noise, 5e-3),
        Finding::vanishing("thickness shown, deviation over mean, at the end", deviation, 5e-3),
        Finding::vanishing(
            "the same relative to that after the first step",
            deviation / first.unwrap_or(f64::NAN),
            0.1,
        ),
        Finding::vanishing("mean speed of the liquid, m/s", fastest, 0.01),
    ])
}
