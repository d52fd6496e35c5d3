//! How fast a scene steps at a given size: wall time per stage, processor time, memory.
//!
//! | question | file |
//! |---|---|
//! | what is measured | this one |
//! | where processor time and memory are read | [`process`] |
//! | how it is shown | [`table`] |
//!
//! The published numbers come from `froth bench`, which prints these tables.

pub mod process;
pub mod table;

use std::time::{Duration, Instant};

use froth_systems::stage::Stage;

use crate::scene::{AuthoredRegistry, available_memory};
use crate::simulation::{BuildError, Overrides, Simulation, StepError};

/// What a measurement does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BenchSettings {
    /// Steps before the measurement begins.
    pub warm_up: u64,
    /// Steps measured.
    pub steps: u64,
}

/// Why a measurement failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BenchError {
    /// The scene cannot be simulated at that size.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A step failed.
    #[error(transparent)]
    Step(#[from] StepError),
}

/// What was measured at one size; all but `start` and `peak_bytes` is the mean of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Rows of every kind that has any.
    pub rows: Vec<(&'static str, usize)>,
    /// Threads that shared the work.
    pub threads: usize,
    /// Steps measured.
    pub steps: u64,
    /// Wall time of making the particles.
    pub start: Duration,
    /// Wall time of each stage.
    pub stages: Vec<(Stage, Duration)>,
    /// Wall time.
    pub wall: Duration,
    /// Time on processors, user and system, all threads together; `None` where the system does not tell.
    pub processor: Option<Duration>,
    /// Largest memory of the process so far, of this measurement where the system allows; `None` where it does not tell.
    pub peak_bytes: Option<u64>,
    /// Simulated time, s.
    pub simulated: f64,
    /// Substeps and iterations of every solver, by name of the observable.
    pub counts: Vec<(String, f64)>,
}

/// Measures the scene called `name` with `carriers` Eulerian particles.
///
/// # Errors
/// When the scene is wrong, too large for this machine, or a step fails.
pub fn measure(name: &str, text: &str, carriers: u64, settings: BenchSettings) -> Result<Measurement, BenchError> {
    process::reset_peak();
    let began = Instant::now();
    let mut simulation = sized(name, text, carriers)?;
    let start = began.elapsed();
    for _ in 0..settings.warm_up {
        simulation.step()?;
    }
    let before: Vec<Duration> = simulation.stage_times().total().map(|(_, time)| time).collect();
    let (began, processor, from) = (Instant::now(), process::processor_time(), simulation.time());
    let mut counts: Vec<(String, f64)> = Vec::new();
    for _ in 0..settings.steps {
        simulation.step()?;
        add_counts(&simulation, &mut counts);
    }
    let per_step = |time: Duration| time.div_f64(settings.steps.max(1) as f64);
    let wall = per_step(began.elapsed());
    let spent = process::processor_time().zip(processor).map(|(after, before)| per_step(after - before));
    let stages = simulation.stage_times().total().zip(&before);
    counts.iter_mut().for_each(|(_, sum)| *sum /= settings.steps.max(1) as f64);
    Ok(Measurement {
        stages: stages.map(|((stage, after), before)| (stage, per_step(after - *before))).collect(),
        rows: simulation.rows().into_iter().filter(|(_, count)| *count > 0).collect(),
        threads: rayon::current_num_threads(),
        steps: settings.steps,
        start,
        wall,
        processor: spent,
        peak_bytes: process::peak_bytes(),
        simulated: (simulation.time() - from) / settings.steps.max(1) as f64,
        counts,
    })
}

/// The scene, its resolution scaled to `carriers` Eulerian particles.
fn sized(name: &str, text: &str, carriers: u64) -> Result<Simulation, BuildError> {
    let scene = crate::scene::Scene::from_text(name, text, &AuthoredRegistry::built_in())?;
    let authored = scene.check(available_memory())?.carriers().max(1);
    let factor = (carriers as f64 / authored as f64).sqrt();
    let overrides = Overrides { resolution: Some(factor), ..Overrides::default() };
    Simulation::builder().overrides(overrides).build_from_text(name, text)
}

fn add_counts(simulation: &Simulation, sums: &mut Vec<(String, f64)>) {
    let counts = |name: &str| name == "substeps" || name.ends_with("_iterations");
    for column in simulation.observables().columns().iter().filter(|column| counts(&column.name)) {
        let value = column.value.unwrap_or(0.0);
        match sums.iter_mut().find(|(name, _)| *name == column.name) {
            Some((_, sum)) => *sum += value,
            None => sums.push((column.name.clone(), value)),
        }
    }
}
