//! Films that drain until the tension's gradient carries their weight.
//!
//! # Equation
//! `rho g eta = 2 d sigma/dz` with `Gamma/eta` the same everywhere gives `eta = C exp(-k z)`, `k = rho g eta0/(2 E)`,
//! `eta0` the mean thickness, `C` from the liquid: the mean of `eta` over the film is `eta0`.
//!
//! Shown is `V Gamma/S`, with the concentration that the Marangoni solve gives. The liquid per area as gathered from the
//! material particles is the same up to their sampling noise, which refinement does not remove.

use froth_components::film::{Area, LiquidVolume, Thickness};
use froth_components::kind::{EulerianParticle, LagrangianParticle};
use froth_components::motion::Position;
use froth_systems::melp::state::Transfers;

use super::finding::{Finding, Refinement};
use super::oscillation::least_squares;
use super::scene_run::SceneRun;
use super::{Effort, LawError};
use crate::simulation::Simulation;

const GRAVITY: f64 = 9.81;
const DENSITY: f64 = 1000.0;
const THICKNESS: f64 = 400e-9;
const ELASTICITY: f64 = 0.4e-3;
/// The sloshing decays at 20 per second with the drag below: 1e-5 of it is left, s.
const END: f64 = 0.6;
/// Nearly critical for the sloshing at 49 rad/s.
const DRAG: &str = "rate: \"40 1/s\"";

/// Deviations from the law of one film at rest.
struct Profile {
    shown: f64,
    carriers: f64,
    gathered: f64,
    decay: f64,
    liquid: f64,
}

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let counts: &[u32] = effort.choose(&[200, 400, 800], &[1250, 2500, 5000]);
    let film = SceneRun::of("drainage").with("rate: \"4 1/s\"", DRAG);
    let rectangle = "Rectangle(width: \"6 cm\", height: \"9 cm\")";
    let disc = film.clone().with(rectangle, "Disc(radius: \"4.5 cm\")");
    let hexagon = film.clone().with(rectangle, "Hexagon(radius: \"4.5 cm\")");
    let mut findings = Vec::new();
    for (name, scene) in [("rectangle", film), ("disc", disc), ("hexagon", hexagon)] {
        let at = |count: &u32| drained(&scene.clone().with("Particles(2500)", &format!("Particles({count})")));
        let profiles = counts.iter().map(at).collect::<Result<Vec<_>, LawError>>()?;
        findings.extend(film_findings(name, counts, &profiles));
    }
    Ok(findings)
}

fn film_findings(name: &str, counts: &[u32], profiles: &[Profile]) -> Vec<Finding> {
    let order = |error: fn(&Profile) -> f64| -> Refinement {
        counts.iter().zip(profiles).map(|(count, profile)| (1.0 / f64::from(*count).sqrt(), error(profile))).collect()
    };
    let Some(finest) = profiles.last() else { return Vec::new() };
    vec![
        Finding::vanishing(format!("{name}: thickness shown, relative L2"), finest.shown, 0.02)
            .converging(&order(|p| p.shown), 1.3),
        Finding::vanishing(format!("{name}: thickness of the carriers, relative L2"), finest.carriers, 0.02),
        Finding::vanishing(format!("{name}: liquid per area as gathered, relative L2"), finest.gathered, 0.02),
        Finding::relative(format!("{name}: decay of the thickness shown, 1/m"), exact_decay(), finest.decay, 0.01),
        Finding::vanishing(format!("{name}: liquid lost, relative"), finest.liquid, 1e-9),
    ]
}

fn exact_decay() -> f64 {
    DENSITY * GRAVITY * THICKNESS / (2.0 * ELASTICITY)
}

fn drained(scene: &SceneRun) -> Result<Profile, LawError> {
    let mut simulation = scene.begin()?;
    simulation.step()?;
    let before = simulation.observables().get("liquid");
    simulation.advance_to(END)?;
    let after = simulation.observables().get("liquid");
    let lost = before.zip(after).map_or(f64::NAN, |(before, after)| after / before - 1.0);
    Ok(Profile::of(&mut simulation, lost))
}

impl Profile {
    fn of(simulation: &mut Simulation, liquid: f64) -> Self {
        type E = EulerianParticle;
        type L = LagrangianParticle;
        let height = |places: Vec<Position>| places.iter().map(|x| x.0.y).collect::<Vec<f64>>();
        let thickness = |values: Vec<Thickness>| values.iter().map(|eta| eta.0).collect::<Vec<f64>>();
        let z = height(simulation.column::<E, Position>());
        let areas: Vec<f64> = simulation.column::<E, Area>().iter().map(|a| a.0).collect();
        let decay = exact_decay();
        let mean = z.iter().zip(&areas).map(|(z, a)| a * (-decay * z).exp()).sum::<f64>() / areas.iter().sum::<f64>();
        let exact = |z: f64| THICKNESS / mean * (-decay * z).exp();
        let error = |z: &[f64], eta: &[f64]| {
            let (wrong, whole) = z.iter().zip(eta).fold((0.0, 0.0), |(wrong, whole), (z, eta)| {
                (wrong + (eta - exact(*z)).powi(2), whole + exact(*z).powi(2))
            });
            (wrong / whole).sqrt()
        };
        let carriers = error(&z, &thickness(simulation.column::<E, Thickness>()));
        let liquid_volumes = simulation.column::<E, LiquidVolume>();
        let duals = &simulation.world().resource::<Transfers>().dual_areas;
        let gathered: Vec<f64> = liquid_volumes.iter().zip(duals).map(|(v, a)| v.0 / a).collect();
        let gathered = error(&z, &gathered);
        let (z, eta) = (height(simulation.column::<L, Position>()), thickness(simulation.column::<L, Thickness>()));
        let [_, slope] = least_squares(z.iter().zip(&eta).map(|(z, eta)| ([1.0, *z], eta.ln())));
        Self { shown: error(&z, &eta), carriers, gathered, decay: -slope, liquid }
    }
}
