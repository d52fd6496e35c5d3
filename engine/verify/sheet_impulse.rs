//! A free cluster in air has the impulse that external forces gave it.
//!
//! # Equation
//! `P = rho sum_iv phi_iv N_iv`; `dP/dt` is the weight of its liquid, nothing without gravity.

use froth_components::film::LiquidVolume;
use froth_components::kind::MeshVertex;
use glam::DVec3;

use super::finding::Finding;
use super::mesh_run::{MeshRun, unbroken};
use super::scene_run::SceneRun;
use super::sheet_run::{DENSITY, TENSION};
use super::{Effort, LawError};

/// Density of the liquid, kg/m^3.
const LIQUID: f64 = 1000.0;
const GRAVITY: DVec3 = DVec3::new(0.3, -9.81, 0.0);

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let (edge, end) = effort.choose(("9 mm", 0.1), ("4.5 mm", 0.5));
    let scene = SceneRun::of("triple_bubble_oscillation")
        .with("Spacing(\"4.5 mm\")", &format!("Spacing(\"{edge}\")"))
        .with("VortexSheet(diffusivity: \"2 cm^2/s\")", "VortexSheet()")
        // Without symmetry.
        .with("(1.1, 1.1, 0.826)", "(1.2, 0.95, 0.877)");
    let heavy = scene.clone().with("entities: [", &format!("entities: [ [ Gravity({GRAVITY}) ],"));
    let mut findings = Vec::new();
    for (what, scene, gravity) in [("alone", scene, DVec3::ZERO), ("under gravity", heavy, GRAVITY)] {
        let mut run = MeshRun::begin(&scene)?;
        let mut worst = 0.0_f64;
        let unit = scale(&mut run);
        let mass = LIQUID * run.simulation.column::<MeshVertex, LiquidVolume>().iter().map(|v| v.0).sum::<f64>();
        while !run.simulation.has_reached(end) {
            run.step_within(end)?;
            let impulse = DVec3::from_array(["impulse_x", "impulse_y", "impulse_z"].map(|name| run.observed(name)));
            worst = worst.max((impulse - mass * gravity * run.simulation.time()).length() / unit);
        }
        let what = format!("{what}: error of the impulse over {} operations, in rho V c", run.operations);
        findings.push(Finding::vanishing(what, worst, 1e-9));
        findings.push(unbroken([run.violation()]));
    }
    Ok(findings)
}

/// Impulse of the air in the bubbles at the speed of their capillary waves, `rho V sqrt(2 sigma/(rho R))`, kg m/s.
fn scale(run: &mut MeshRun) -> f64 {
    let volume: f64 = run.volumes::<3>().iter().sum();
    DENSITY * volume * (2.0 * TENSION / (DENSITY * volume.cbrt())).sqrt()
}
