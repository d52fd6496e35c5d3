//! `froth run` and `froth resume`.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use clap::builder::PossibleValuesParser;
use froth_components::quantity::Time;

use super::progress::{self, Output};
use super::report::Failure;
use super::{DONE, STOPPED, say, scene_choice, signals};
use crate::frames::PictureFrames;
use crate::gallery::GALLERY;
use crate::method::METHODS;
use crate::run::{Manifest, Run, RunEnd, RunFolder, RunSettings, RunState};
use crate::scene::MOST_FRAMES;
use crate::simulation::{Overrides, Simulation};

/// Folder of run folders that nobody named.
const RUNS: &str = "runs";

#[derive(Debug, Args)]
pub(super) struct RunArguments {
    /// A scene file, or the name of a built-in scene
    scene: String,
    /// Run this method instead of the scene's
    #[arg(long, value_parser = PossibleValuesParser::new(METHODS.iter().map(|method| method.name)))]
    method: Option<String>,
    /// Factor on the resolution: 2 halves the spacing, which makes four times the particles
    #[arg(long, value_name = "FACTOR", value_parser = positive, allow_negative_numbers = true)]
    resolution: Option<f64>,
    /// End at this simulated time, such as `0.5` (seconds) or `"20 ms"`
    #[arg(long, value_name = "TIME", value_parser = seconds, allow_negative_numbers = true)]
    until: Option<f64>,
    /// Replace the scene's seed
    #[arg(long, allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Write the run here instead of runs/<scene>-<n>; the folder must be empty or absent
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    process: ProcessArguments,
}

#[derive(Debug, Args)]
pub(super) struct ResumeArguments {
    /// The run folder
    folder: PathBuf,
    #[command(flatten)]
    process: ProcessArguments,
}

/// What belongs to the process, not to the run: none of it changes a byte of the results.
#[derive(Debug, Default, Args)]
struct ProcessArguments {
    /// Threads; all cores by default
    #[arg(long)]
    threads: Option<NonZeroUsize>,
    /// Minutes of wall time between checkpoints; the first is made after half a minute at most
    #[arg(long, value_name = "MINUTES", default_value = "5", value_parser = positive, allow_negative_numbers = true)]
    autosave: f64,
    /// Print nothing but errors
    #[arg(long, conflicts_with = "json")]
    quiet: bool,
    /// Print one JSON object per frame to standard output
    #[arg(long)]
    json: bool,
}

impl RunArguments {
    /// What `froth` alone runs.
    pub(super) fn default_scene() -> Self {
        let process = ProcessArguments { autosave: 5.0, ..ProcessArguments::default() };
        let scene = GALLERY[0].name.to_owned();
        Self { scene, method: None, resolution: None, until: None, seed: None, out: None, process }
    }
}

pub(super) fn run(arguments: &RunArguments) -> Result<u8, Failure> {
    let settings = arguments.process.begin(arguments.until)?;
    let overrides =
        Overrides { method: arguments.method.clone(), resolution: arguments.resolution, seed: arguments.seed };
    let builder = || Simulation::builder().overrides(overrides.clone());
    // Before the particles and the folder: a picture that cannot be drawn takes no time and leaves nothing behind.
    let (checked, _) = scene_choice::check(&arguments.scene, builder())?;
    check_frames(arguments.until, checked.scene().header.frames_per_second.si())?;
    let mut simulation = scene_choice::build(&arguments.scene, builder())?;
    let frames = PictureFrames::of(&mut simulation)?;
    let folder = match &arguments.out {
        Some(path) => RunFolder::create(path),
        None => RunFolder::create_numbered(Path::new(RUNS), &scene_choice::stem(&arguments.scene)),
    }?;
    drive(Run::begin(simulation, folder, settings)?, frames, arguments.process.output())
}

/// `--until` makes no more frames than a scene may.
fn check_frames(until: Option<f64>, frames_per_second: f64) -> Result<(), Failure> {
    let frames = until.unwrap_or(0.0) * frames_per_second;
    if frames <= MOST_FRAMES as f64 { Ok(()) } else { Err(Failure::TooManyFrames { frames }) }
}

pub(super) fn resume(arguments: &ResumeArguments) -> Result<u8, Failure> {
    let output = arguments.process.output();
    if Manifest::read(&arguments.folder)?.state == RunState::Finished {
        if output == Output::People {
            say(format!("the run in {} is finished", arguments.folder.display()));
        }
        return Ok(DONE);
    }
    let settings = arguments.process.begin(None)?;
    let mut run = Run::resume(&arguments.folder, Simulation::builder, settings)?;
    let frames = PictureFrames::of(run.simulation_mut())?;
    drive(run, frames, output)
}

fn drive(mut run: Run, mut frames: PictureFrames, output: Output) -> Result<u8, Failure> {
    let end = run.drive(&mut frames, progress::reporter(output).as_mut())?;
    let folder = run.folder().path().display();
    let (line, exit_code) = match end {
        RunEnd::Finished { .. } => (format!("finished: {folder}"), DONE),
        RunEnd::Stopped { .. } => (format!("stopped: {folder}; go on with `froth resume {folder}`"), STOPPED),
    };
    if output == Output::People {
        say(line);
    }
    Ok(exit_code)
}

impl ProcessArguments {
    /// Starts the threads and catches signals.
    fn begin(&self, until: Option<f64>) -> Result<RunSettings, Failure> {
        start_threads(self.threads)?;
        let stop = signals::stop_flag().map_err(Failure::Signals)?;
        let autosave = Duration::try_from_secs_f64(60.0 * self.autosave).unwrap_or(Duration::MAX);
        Ok(RunSettings { until, autosave, stop, ..RunSettings::default() })
    }

    fn output(&self) -> Output {
        match (self.quiet, self.json) {
            (true, _) => Output::Nobody,
            (_, true) => Output::Machines,
            _ => Output::People,
        }
    }
}

/// Makes `threads` threads share the work of this process; all cores by default.
pub(super) fn start_threads(threads: Option<NonZeroUsize>) -> Result<(), Failure> {
    let Some(threads) = threads.map(NonZeroUsize::get) else { return Ok(()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    pool.map_err(|error| Failure::Threads(threads, error))
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "a positive number is wanted, e.g. 0.5".to_owned())
}

/// A positive time: a plain number of seconds, or a number with a unit.
fn seconds(text: &str) -> Result<f64, String> {
    let time = text.parse().or_else(|_| Time::parse(text).map(Time::si));
    time.ok()
        .filter(|time: &f64| time.is_finite() && *time > 0.0)
        .ok_or_else(|| "a positive time is wanted, e.g. 0.5 or \"20 ms\"".to_owned())
}
