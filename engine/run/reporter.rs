//! What a run tells whoever watches: the library prints nothing itself.

use std::time::{Duration, Instant};

use froth_systems::observe::Observables;

use super::RunEnd;
use super::folder::RunFolder;
use crate::simulation::{Simulation, StepReport};

/// Watches a run.
pub trait Reporter {
    /// The run begins or goes on.
    fn begin(&mut self, progress: &Progress, folder: &RunFolder) {
        let _ = (progress, folder);
    }
    /// A step is finished.
    fn step(&mut self, progress: &Progress) {
        let _ = progress;
    }
    /// A frame is written.
    fn frame(&mut self, progress: &Progress, frame: u64) {
        let _ = (progress, frame);
    }
    /// Something happened that does not stop the run.
    fn note(&mut self, text: &str) {
        let _ = text;
    }
    /// The run ends without a failure.
    fn end(&mut self, progress: &Progress, end: &RunEnd) {
        let _ = (progress, end);
    }
}

/// Watches in silence.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Reporter for Silent {}

/// How far a run is.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Simulated time, s.
    pub time: f64,
    /// Where the run ends, s.
    pub until: f64,
    /// Steps finished.
    pub step: u64,
    /// Length of the last step, s.
    pub step_length: f64,
    /// What asked for the shortest step.
    pub limited_by: Option<&'static str>,
    /// Frames up to the end, the one at 0 included.
    pub frames: u64,
    /// Particles of all kinds.
    pub particles: usize,
    /// Largest speed in the last step, m/s, where the method measures it.
    pub max_speed: Option<f64>,
    /// Wall time of this session.
    pub wall: Duration,
    /// Wall time that is probably left.
    pub left: Option<Duration>,
}

/// Keeps [`Progress`] up to date.
#[derive(Debug)]
pub(super) struct Progression {
    pub(super) progress: Progress,
    began: Instant,
    from: f64,
}

impl Progression {
    pub(super) fn new(simulation: &mut Simulation, until: f64) -> Self {
        let clock = *simulation.clock();
        let progress = Progress {
            time: clock.time,
            until,
            step: clock.steps,
            step_length: clock.step_length,
            limited_by: None,
            frames: simulation.frames().count_until(until),
            particles: 0,
            max_speed: None,
            wall: Duration::ZERO,
            left: None,
        };
        let mut progression = Self { progress, began: Instant::now(), from: clock.time };
        progression.count(simulation);
        progression
    }

    pub(super) fn step(&mut self, report: &StepReport, observables: &Observables) {
        let progress = &mut self.progress;
        (progress.time, progress.step) = (report.time, report.step);
        (progress.step_length, progress.limited_by) = (report.step_length, report.limited_by);
        progress.max_speed = observables.get("max_speed");
        progress.wall = self.began.elapsed();
        let (done, left) = (progress.time - self.from, progress.until - progress.time);
        progress.left = Duration::try_from_secs_f64(progress.wall.as_secs_f64() * left.max(0.0) / done).ok();
    }

    /// Counts the particles; once a frame is often enough.
    pub(super) fn count(&mut self, simulation: &mut Simulation) {
        self.progress.particles = simulation.rows().iter().map(|(_, rows)| rows).sum();
    }
}
