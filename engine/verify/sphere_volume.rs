//! A bubble on a mesh that is split, collapsed and flipped all the time keeps its volume.
//!
//! # Equation
//! `dV/dt = 0`; the bumpy bubble becomes the sphere of its volume, `A = (36 pi V^2)^(1/3)`, `dp = 4 sigma/R`.

use std::f64::consts::PI;

use super::finding::Finding;
use super::mesh_run::{MeshRun, unbroken};
use super::scene_run::SceneRun;
use super::{Effort, LawError};

const TENSION: f64 = 0.03;
const STEPS: u64 = 1000;
/// Long enough for the slowest mode, which decays within 0.1 s, to be gone, s.
const END: f64 = 1.0;

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let edge = effort.choose("7 mm", "4 mm");
    let step = format!("duration: \"0.5 s\", maximum_step: {}", END / STEPS as f64);
    let scene = SceneRun::of("sphere").with("Spacing(\"5 mm\")", &format!("Spacing(\"{edge}\")"));
    let mut run = MeshRun::begin(&scene.with("duration: \"0.5 s\"", &step))?;
    let [start] = run.volumes();
    let mut worst = 0.0_f64;
    while run.steps < STEPS {
        run.step_within(f64::INFINITY)?;
        let [volume] = run.volumes();
        worst = worst.max((volume / start - 1.0).abs());
    }
    let radius = (3.0 * start / (4.0 * PI)).cbrt();
    let tolerance = effort.choose(0.01, 1e-3);
    Ok(vec![
        Finding::vanishing(
            format!("volume over {} steps, {} operations, relative", run.steps, run.operations),
            worst,
            1e-6,
        ),
        Finding::relative("area of the sphere, m^2", 4.0 * PI * radius * radius, run.area(), tolerance),
        Finding::relative("excess pressure, Pa", 4.0 * TENSION / radius, run.observed("excess_pressure_1"), tolerance),
        unbroken([run.violation()]),
    ])
}
