//! `manifest.json`: what ran, on what, and how it ended. Everything a resumption needs besides the scene and a checkpoint.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use super::error::RunError;
use super::folder::{MANIFEST, RunFolder};
use crate::checkpoint::ENGINE_VERSION;
use crate::simulation::{Overrides, Simulation};

/// What a run folder says about its run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of froth that began the run.
    pub froth_version: String,
    /// Title of the scene.
    pub title: String,
    /// Name of the scene file, for messages.
    pub scene: String,
    /// Hash of the scene's text and the overrides.
    pub scene_hash: String,
    /// Name of the method.
    pub method: String,
    /// Seed of everything random.
    pub seed: u64,
    /// What replaced values of the scene file.
    pub overrides: Overrides,
    /// Where the run ends, s of simulated time.
    pub until_s: f64,
    /// Pictures per second of simulated time.
    pub frames_per_second: f64,
    /// Threads.
    pub threads: usize,
    /// The machine.
    pub machine: Machine,
    /// Whether the run goes on, and why not.
    pub state: RunState,
    /// Seconds since 1970 when the run began.
    pub began_unix_s: u64,
    /// Simulated time, s.
    pub time_s: f64,
    /// Steps finished.
    pub steps: u64,
    /// Rows of each kind.
    pub rows: BTreeMap<String, usize>,
    /// Wall time of all sessions, s.
    pub wall_s: f64,
    /// Wall time per stage of the last session, s.
    pub stage_wall_s: BTreeMap<String, f64>,
}

/// Whether a run goes on, and why not.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "is", content = "because")]
pub enum RunState {
    /// A process is at it, or was killed.
    Running,
    /// It reached its end.
    Finished,
    /// It stopped at a checkpoint, on a signal.
    Stopped,
    /// It cannot go on; why.
    Failed(String),
}

/// The machine of a run, as far as numbers and times may depend on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Operating system.
    pub system: String,
    /// Instruction set.
    pub architecture: String,
    /// Processor, where the system tells.
    pub processor: Option<String>,
    /// Cores that the process may use.
    pub cores: usize,
}

impl Machine {
    /// This one.
    #[must_use]
    pub fn this() -> Self {
        let processor = fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
            let line = text.lines().find(|line| line.starts_with("model name"))?;
            Some(line.split_once(':')?.1.trim().to_owned())
        });
        Self {
            system: std::env::consts::OS.to_owned(),
            architecture: std::env::consts::ARCH.to_owned(),
            processor,
            cores: std::thread::available_parallelism().map_or(1, usize::from),
        }
    }
}

impl Manifest {
    /// Of a run that begins.
    pub(super) fn new(simulation: &Simulation, until: f64) -> Self {
        let scene = simulation.scene();
        Self {
            froth_version: ENGINE_VERSION.to_owned(),
            title: scene.header.title.clone(),
            scene: scene.source().name().to_owned(),
            scene_hash: format!("{:016x}", simulation.scene_hash()),
            method: simulation.method().name.to_owned(),
            seed: scene.header.seed,
            overrides: simulation.overrides().clone(),
            until_s: until,
            frames_per_second: scene.header.frames_per_second.si(),
            threads: rayon::current_num_threads(),
            machine: Machine::this(),
            state: RunState::Running,
            began_unix_s: SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs()),
            time_s: 0.0,
            steps: 0,
            rows: BTreeMap::new(),
            wall_s: 0.0,
            stage_wall_s: BTreeMap::new(),
        }
    }

    /// Reads the manifest of a run folder.
    ///
    /// # Errors
    /// When there is none, or it is damaged.
    pub fn read(path: &Path) -> Result<Self, RunError> {
        let text = fs::read(path.join(MANIFEST));
        let manifest = text.and_then(|text| serde_json::from_slice(&text).map_err(Into::into));
        manifest.map_err(|cause| RunError::NotARun { path: path.to_owned(), file: MANIFEST, cause })
    }

    /// Writes it, with what the simulation says now.
    pub(super) fn write(&mut self, simulation: &mut Simulation, folder: &RunFolder) -> Result<(), RunError> {
        let clock = *simulation.clock();
        (self.time_s, self.steps) = (clock.time, clock.steps);
        self.rows = simulation.rows().into_iter().map(|(kind, rows)| (kind.to_owned(), rows)).collect();
        let stages = simulation.stage_times().total();
        self.stage_wall_s = stages.map(|(stage, time)| (format!("{stage:?}"), time.as_secs_f64())).collect();
        let mut text = serde_json::to_vec_pretty(self).expect("invariant: plain data is JSON");
        text.push(b'\n');
        folder.write(MANIFEST, &text).map_err(|cause| RunError::File { path: folder.path().join(MANIFEST), cause })
    }
}
