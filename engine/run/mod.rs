//! The run loop: steps, frames, observables and checkpoints into a [`RunFolder`].
//!
//! ```no_run
//! use froth::Simulation;
//! use froth::run::{NoFrames, Run, RunFolder, RunSettings, Silent};
//!
//! let simulation = Simulation::from_scene("scenes/giant_bubble.ron")?;
//! let folder = RunFolder::create_numbered("runs".as_ref(), "giant_bubble")?;
//! let mut run = Run::begin(simulation, folder, RunSettings::default())?;
//! run.drive(&mut NoFrames, &mut Silent)?;
//! # Ok::<(), froth::run::RunError>(())
//! ```
//!
//! After each step: its line of `observables.csv`, then its frame, then a checkpoint if one is due. So a checkpoint implies
//! everything before it, and a resumption cuts the table there and draws later frames again, byte for byte.

mod error;
mod events;
mod folder;
mod frame_sink;
mod manifest;
mod reporter;
mod table;
mod timings;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

pub use error::{FrameError, RunError};
pub use folder::RunFolder;
pub use frame_sink::{FrameSink, NoFrames};
pub use manifest::{Machine, Manifest, RunState};
pub use reporter::{Progress, Reporter, Silent};

use self::events::EventsTable;
use self::folder::{EVENTS, MESHES, OBSERVABLES, SCENE, TIMINGS};
use self::reporter::Progression;
use self::table::ObservablesTable;
use self::timings::TimingsTable;
use crate::checkpoint::{self, CheckpointError};
use crate::simulation::{BuildError, Simulation, SimulationBuilder, StepReport};

/// How a run goes, besides what the scene says.
#[derive(Clone, Debug)]
pub struct RunSettings {
    /// Where the run ends, s of simulated time; the scene's duration by default. A resumed run ends where it was to end.
    pub until: Option<f64>,
    /// Wall time between checkpoints.
    pub autosave: Duration,
    /// Wall time before the first checkpoint, where that is shorter: a run that fails early has one.
    pub first_autosave: Duration,
    /// Set from outside (by a signal, say): the run finishes its step, writes a checkpoint and stops.
    pub stop: Arc<AtomicBool>,
}

impl Default for RunSettings {
    fn default() -> Self {
        let (autosave, first_autosave) = (Duration::from_secs(300), Duration::from_secs(30));
        Self { until: None, autosave, first_autosave, stop: Arc::default() }
    }
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RunEnd {
    /// It reached its end.
    Finished {
        /// The last checkpoint.
        checkpoint: PathBuf,
    },
    /// It was told to stop.
    Stopped {
        /// From here it can be resumed.
        checkpoint: PathBuf,
    },
}

/// A simulation that writes a run folder.
pub struct Run {
    simulation: Simulation,
    folder: RunFolder,
    table: ObservablesTable,
    timings: TimingsTable,
    events: EventsTable,
    manifest: Manifest,
    settings: RunSettings,
    until: f64,
    is_resumed: bool,
    has_noted_substeps: bool,
    wall_before: f64,
    last_save: Instant,
    /// Wall time from the last checkpoint, or from the start, to the next.
    save_after: Duration,
}

impl Run {
    /// Begins a run: writes copies of the scene and its mesh files, and the manifest.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn begin(simulation: Simulation, folder: RunFolder, settings: RunSettings) -> Result<Self, RunError> {
        let until = settings.until.unwrap_or(simulation.scene().header.duration.si());
        let scene = simulation.scene().source().text();
        folder.write(SCENE, scene.as_bytes()).map_err(|cause| file_error(&folder, SCENE, cause))?;
        for mesh in simulation.scene().mesh_files() {
            let file = Path::new(MESHES).join(&mesh.path);
            folder.write(file, mesh.bytes()).map_err(|cause| file_error(&folder, MESHES, cause))?;
        }
        let manifest = Manifest::new(&simulation, until);
        Self::new(simulation, folder, settings, manifest)
    }

    /// Takes up a run from its newest checkpoint that is whole, or from its start if there is none. `builder` brings the components,
    /// columns and method that were plugged in; forces are added to [`Run::simulation_mut`] before the run is driven.
    ///
    /// # Errors
    /// When there is no run in the folder, another process is at it, or all its checkpoints are damaged.
    pub fn resume(
        path: &Path,
        builder: impl Fn() -> SimulationBuilder,
        settings: RunSettings,
    ) -> Result<Self, RunError> {
        let manifest = Manifest::read(path)?;
        let scene = fs::read_to_string(path.join(SCENE)).map_err(|cause| RunError::NotARun {
            path: path.to_owned(),
            file: SCENE,
            cause,
        })?;
        let folder = RunFolder::open(path)?;
        let builder = || builder().overrides(manifest.overrides.clone()).mesh_folder(path.join(MESHES));
        let simulation = newest_state(&folder, &builder, &manifest.scene, &scene)?;
        Self::new(simulation, folder, settings, manifest)
    }

    fn new(
        simulation: Simulation,
        folder: RunFolder,
        settings: RunSettings,
        manifest: Manifest,
    ) -> Result<Self, RunError> {
        let steps = simulation.clock().steps;
        let path = folder.path().join(OBSERVABLES);
        let is_resumed = steps > 0;
        let table = if is_resumed { ObservablesTable::resume(&path, steps) } else { ObservablesTable::create(&path) };
        let table = table.map_err(|cause| RunError::File { path, cause })?;
        let timings = TimingsTable::open(folder.path(), steps);
        let timings = timings.map_err(|cause| file_error(&folder, TIMINGS, cause))?;
        let events = EventsTable::open(folder.path(), &simulation, steps);
        let events = events.map_err(|cause| file_error(&folder, EVENTS, cause))?;
        let mut run = Self {
            until: manifest.until_s,
            wall_before: manifest.wall_s,
            last_save: Instant::now(),
            save_after: settings.first_autosave.min(settings.autosave),
            simulation,
            folder,
            table,
            timings,
            events,
            manifest,
            settings,
            is_resumed,
            has_noted_substeps: false,
        };
        run.manifest.threads = rayon::current_num_threads();
        run.write_manifest(RunState::Running)?;
        Ok(run)
    }

    /// The simulation.
    #[must_use]
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// The simulation, to plug in forces before the run is driven.
    pub fn simulation_mut(&mut self) -> &mut Simulation {
        &mut self.simulation
    }

    /// The run folder.
    #[must_use]
    pub fn folder(&self) -> &RunFolder {
        &self.folder
    }

    /// Steps until the end, or until told to stop.
    ///
    /// # Errors
    /// When a step, a frame or a file fails. The manifest says so, and everything written before stays.
    pub fn drive(&mut self, frames: &mut dyn FrameSink, reporter: &mut dyn Reporter) -> Result<RunEnd, RunError> {
        let end = self.drive_to_end(frames, reporter);
        let state = match &end {
            Ok(RunEnd::Finished { .. }) => RunState::Finished,
            Ok(RunEnd::Stopped { .. }) => RunState::Stopped,
            Err(error) => RunState::Failed(error.to_string()),
        };
        self.folder.log(&format!("{state:?}"));
        let written = self.write_manifest(state);
        let end = end?;
        written.map(|()| end)
    }

    fn drive_to_end(&mut self, frames: &mut dyn FrameSink, reporter: &mut dyn Reporter) -> Result<RunEnd, RunError> {
        let mut progression = Progression::new(&mut self.simulation, self.until);
        let verb = if self.is_resumed { "resumed" } else { "begun" };
        self.folder.log(&format!("{verb} at step {}, t = {} s", self.simulation.clock().steps, self.simulation.time()));
        reporter.begin(&progression.progress, &self.folder);
        if !self.is_resumed {
            self.write_frame(0, frames)?;
            reporter.frame(&progression.progress, 0);
        }
        while !self.simulation.has_reached(self.until) {
            if self.settings.stop.load(Ordering::Relaxed) {
                let checkpoint = self.save()?;
                let end = RunEnd::Stopped { checkpoint };
                reporter.end(&progression.progress, &end);
                return Ok(end);
            }
            let report = self.step()?;
            progression.step(&report, self.simulation.observables());
            self.note_substeps(&report, reporter);
            reporter.step(&progression.progress);
            if let Some(frame) = report.frame {
                self.write_frame(frame, frames)?;
                progression.count(&mut self.simulation);
                reporter.frame(&progression.progress, frame);
            }
            self.autosave(reporter);
        }
        let checkpoint = self.save()?;
        frames.finish(&self.folder).map_err(|cause| RunError::Finish { cause })?;
        let end = RunEnd::Finished { checkpoint };
        reporter.end(&progression.progress, &end);
        Ok(end)
    }

    /// One step and its line of each table.
    fn step(&mut self) -> Result<StepReport, RunError> {
        let report = self.simulation.step_within(self.until).map_err(|cause| {
            let checkpoint = self.folder.checkpoints().into_iter().next();
            RunError::Step { cause, checkpoint }
        })?;
        let appended = self.table.append(&report, self.simulation.observables());
        appended.map_err(|cause| file_error(&self.folder, OBSERVABLES, cause))?;
        let timed = self.timings.append(&report, &self.simulation);
        timed.map_err(|cause| file_error(&self.folder, TIMINGS, cause))?;
        let noted = self.events.append(&self.simulation);
        noted.map_err(|cause| file_error(&self.folder, EVENTS, cause))?;
        Ok(report)
    }

    /// Says, once a session, that steps as long as the scene allows are too long for the film's own motion, and what is done about it.
    fn note_substeps(&mut self, report: &StepReport, reporter: &mut dyn Reporter) {
        let substeps = self.simulation.clock().substeps;
        if self.has_noted_substeps || report.limited_by != Some("maximum_step") || substeps < 2 {
            return;
        }
        self.has_noted_substeps = true;
        let length = report.step_length;
        let note = format!(
            "`maximum_step` is longer than the films' own motion allows: a step of {length:.3e} s is made of {substeps} substeps"
        );
        self.folder.log(&note);
        reporter.note(&note);
    }

    fn write_frame(&mut self, frame: u64, frames: &mut dyn FrameSink) -> Result<(), RunError> {
        let time = self.simulation.time();
        let drawn = frames.frame(self.simulation.world_mut(), frame, &self.folder);
        drawn.map_err(|cause| RunError::Frame { frame, time, cause })
    }

    /// A checkpoint if one is due. One that cannot be written does not stop the run: it may be finished before it is missed.
    fn autosave(&mut self, reporter: &mut dyn Reporter) {
        if self.last_save.elapsed() < self.save_after {
            return;
        }
        if let Err(error) = self.save() {
            self.folder.log(&error.to_string());
            reporter.note(&error.to_string());
        }
        self.last_save = Instant::now();
        self.save_after = self.settings.autosave;
    }

    fn save(&mut self) -> Result<PathBuf, CheckpointError> {
        let clock = *self.simulation.clock();
        let path = self.folder.checkpoint_path(clock.steps, clock.time);
        checkpoint::save(&mut self.simulation, &path)?;
        self.folder.log(&format!("checkpoint {}", path.display()));
        self.folder.prune_checkpoints();
        Ok(path)
    }

    fn write_manifest(&mut self, state: RunState) -> Result<(), RunError> {
        self.manifest.state = state;
        self.manifest.wall_s = self.wall_before + self.folder.age().as_secs_f64();
        self.manifest.write(&mut self.simulation, &self.folder)
    }
}

/// The simulation at the newest checkpoint that is whole. Damage is passed over, towards older checkpoints; any other fault is not.
fn newest_state(
    folder: &RunFolder,
    builder: &dyn Fn() -> SimulationBuilder,
    name: &str,
    scene: &str,
) -> Result<Simulation, BuildError> {
    let mut damage = None;
    for checkpoint in folder.checkpoints() {
        match builder().restore(name, scene, &checkpoint) {
            Err(BuildError::Checkpoint(error)) if error.is_damage() => {
                folder.log(&error.to_string());
                damage.get_or_insert(error);
            }
            other => return other,
        }
    }
    match damage {
        Some(error) => Err(error.into()),
        None => builder().build_from_text(name, scene),
    }
}

fn file_error(folder: &RunFolder, file: &str, cause: std::io::Error) -> RunError {
    RunError::File { path: folder.path().join(file), cause }
}
