//! A run folder holds whole files only, whatever happens: kill, full disk, damage.

mod common;

use std::fs;
use std::io::{BufRead, BufReader};
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use bevy_ecs::world::World;
use common::{
    StopAfter, assert_same_results, draw, exit_code, files, froth, output, results, scene_file, signal, simulation,
    stderr,
};
use froth::Simulation;
use froth::checkpoint::CheckpointError;
use froth::run::{FrameError, Manifest, NoFrames, Run, RunError, RunFolder, RunSettings, RunState, Silent};
use froth::simulation::BuildError;
use froth_systems::stage::Stage;
use tempfile::TempDir;

/// A run that stopped after a step, with a checkpoint after each of the last two.
fn stopped(parent: &TempDir, name: &str) -> PathBuf {
    let path = parent.path().join(name);
    let settings = RunSettings { autosave: std::time::Duration::ZERO, ..RunSettings::default() };
    let mut stop = StopAfter::step(4, &settings);
    let mut run = Run::begin(simulation(), RunFolder::create(&path).unwrap(), settings).unwrap();
    run.drive(&mut draw, &mut stop).unwrap();
    assert_eq!(checkpoints(&path).len(), 2);
    path
}

/// Oldest first.
fn checkpoints(folder: &Path) -> Vec<PathBuf> {
    files(&folder.join("checkpoints")).into_keys().map(|name| folder.join("checkpoints").join(name)).collect()
}

fn spoil(path: &Path, how: impl FnOnce(&mut Vec<u8>)) {
    let mut bytes = fs::read(path).unwrap();
    how(&mut bytes);
    fs::write(path, bytes).unwrap();
}

fn flip_a_bit(bytes: &mut [u8]) {
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
}

fn resume(folder: &Path) -> Result<Run, RunError> {
    Run::resume(folder, Simulation::builder, RunSettings::default())
}

fn checkpoint_error(result: Result<Run, RunError>) -> CheckpointError {
    match result.err() {
        Some(RunError::Build(BuildError::Checkpoint(error))) => error,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_killed_run_leaves_whole_files_and_can_be_resumed() {
    let parent = tempfile::tempdir().unwrap();
    scene_file(parent.path());
    let arguments = |out| ["run", "small.ron", "--json", "--autosave", "1e-9", "--out", out];
    assert_eq!(exit_code(&output(parent.path(), &arguments("whole"))), 0);

    let mut process = froth(parent.path(), &arguments("killed")).stdout(Stdio::piped()).spawn().unwrap();
    let lines = BufReader::new(process.stdout.take().unwrap()).lines().map(Result::unwrap);
    for line in lines {
        if line.contains(r#""frame":3"#) {
            signal(process.id(), "KILL");
        }
    }
    assert_eq!(process.wait().unwrap().code(), None);

    let folder = parent.path().join("killed");
    let table = fs::read_to_string(folder.join("observables.csv")).unwrap();
    let columns = table.lines().next().unwrap().split(',').count();
    assert!(table.ends_with('\n') && table.lines().all(|line| line.split(',').count() == columns));
    assert_eq!(Manifest::read(&folder).unwrap().state, RunState::Running);
    let newest = checkpoints(&folder).pop().unwrap();
    Simulation::builder().restore("small.ron", common::SCENE, newest).unwrap();

    assert_eq!(exit_code(&output(parent.path(), &["resume", "killed"])), 0);
    assert_same_results(&folder, &parent.path().join("whole"));
}

#[test]
fn a_frame_that_does_not_fit_on_the_disk_is_named_and_the_others_stay() {
    let parent = tempfile::tempdir().unwrap();
    let path = parent.path().join("full");
    let folder = RunFolder::create(&path).unwrap();
    // What is written under the temporary name of frame 3 goes to a device that is always full.
    symlink("/dev/full", path.join("frames/.000003.png.part")).unwrap();
    let error = Run::begin(simulation(), folder, RunSettings::default()).unwrap().drive(&mut draw, &mut Silent);
    let message = error.unwrap_err().to_string();
    assert!(message.starts_with("frame 3 (t = 0.030000 s) is lost: No space left on device"), "{message}");
    let frames: Vec<String> = files(&path.join("frames")).into_keys().collect();
    assert_eq!(frames, ["000000.png", "000001.png", "000002.png"]);
    assert!(matches!(Manifest::read(&path).unwrap().state, RunState::Failed(because) if because == message));
}

/// Runs the scene where no file may be longer than `blocks` of 512 bytes: writing fails as on a full disk.
fn run_on_small_disk(parent: &TempDir, blocks: u32) -> Output {
    scene_file(parent.path());
    let program = env!("CARGO_BIN_EXE_froth");
    let limited = format!("trap '' XFSZ; ulimit -f {blocks}; exec {program} run small.ron --out full --quiet");
    Command::new("sh").args(["-c", &limited]).current_dir(parent.path()).output().unwrap()
}

#[test]
fn a_picture_that_does_not_fit_ends_the_run_with_1() {
    let parent = tempfile::tempdir().unwrap();
    let output = run_on_small_disk(&parent, 6);
    assert_eq!(exit_code(&output), 1);
    let message = stderr(&output);
    assert!(message.starts_with("error: frame 0 (t = 0.000000 s) is lost: File too large"), "{message}");
    assert!(files(&parent.path().join("full/frames")).is_empty());
}

#[test]
fn a_checkpoint_that_does_not_fit_ends_the_run_with_1_and_leaves_no_part_of_it() {
    let parent = tempfile::tempdir().unwrap();
    let output = run_on_small_disk(&parent, 128);
    assert_eq!(exit_code(&output), 1);
    assert!(stderr(&output).contains("cannot be written: File too large"), "{}", stderr(&output));
    assert!(files(&parent.path().join("full/checkpoints")).is_empty());
    assert!(parent.path().join("full/observables.csv").metadata().unwrap().len() > 0);
}

#[test]
fn a_damaged_checkpoint_is_passed_over_for_the_one_before() {
    let parent = tempfile::tempdir().unwrap();
    let folder = stopped(&parent, "damaged");
    spoil(&checkpoints(&folder)[1], |bytes| flip_a_bit(bytes));
    let mut run = resume(&folder).unwrap();
    assert_eq!(run.simulation().clock().steps, 3);
    run.drive(&mut draw, &mut Silent).unwrap();
    let whole = parent.path().join("whole");
    let begun = Run::begin(simulation(), RunFolder::create(&whole).unwrap(), RunSettings::default());
    begun.unwrap().drive(&mut draw, &mut Silent).unwrap();
    assert_same_results(&folder, &whole);
}

#[test]
fn damaged_truncated_and_foreign_checkpoints_are_refused_by_name() {
    let parent = tempfile::tempdir().unwrap();
    let folder = stopped(&parent, "refused");
    for checkpoint in checkpoints(&folder) {
        spoil(&checkpoint, |bytes| flip_a_bit(bytes));
    }
    let error = checkpoint_error(resume(&folder));
    assert!(matches!(&error, CheckpointError::Damaged { path, .. } if *path == checkpoints(&folder)[1]), "{error}");
    for checkpoint in checkpoints(&folder) {
        spoil(&checkpoint, |bytes| bytes.truncate(bytes.len() - 100));
    }
    assert!(matches!(checkpoint_error(resume(&folder)), CheckpointError::Truncated { .. }));
    for checkpoint in checkpoints(&folder) {
        fs::write(checkpoint, common::SCENE).unwrap();
    }
    assert!(matches!(checkpoint_error(resume(&folder)), CheckpointError::NotACheckpoint { .. }));
}

#[test]
fn a_checkpoint_of_another_scene_or_with_other_overrides_is_refused() {
    let parent = tempfile::tempdir().unwrap();
    let newest = checkpoints(&stopped(&parent, "one")).pop().unwrap();
    let other_scene = common::SCENE.replace("5 cm", "6 cm");
    for (scene, seed) in [(other_scene.as_str(), None), (common::SCENE, Some(8))] {
        let builder = seed.into_iter().fold(Simulation::builder(), |builder, seed| builder.seed(seed));
        let error = builder.restore("small.ron", scene, &newest).err();
        assert!(matches!(error, Some(BuildError::Checkpoint(CheckpointError::OtherScene { .. }))), "{error:?}");
    }
}

#[test]
fn a_run_never_overwrites_another_one() {
    let parent = tempfile::tempdir().unwrap();
    let folder = stopped(&parent, "taken");
    let before = results(&folder);
    assert!(matches!(RunFolder::create(&folder), Err(RunError::Occupied { .. })));
    scene_file(parent.path());
    assert_eq!(exit_code(&output(parent.path(), &["run", "small.ron", "--out", "taken"])), 2);
    assert!(results(&folder) == before);
}

#[test]
fn two_processes_never_write_one_folder() {
    let parent = tempfile::tempdir().unwrap();
    let folder = stopped(&parent, "shared");
    let first = resume(&folder).unwrap();
    assert!(matches!(resume(&folder), Err(RunError::InUse { .. })));
    drop(first);
    resume(&folder).unwrap().drive(&mut NoFrames, &mut Silent).unwrap();
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let parent = tempfile::tempdir().unwrap();
    scene_file(parent.path());
    let output = output(parent.path(), &["run", "small.ron", "--out", "small.ron/run"]);
    assert_eq!(exit_code(&output), 1);
    assert!(stderr(&output).starts_with("error: the run folder `small.ron/run` cannot be made"), "{}", stderr(&output));
}

#[test]
fn a_folder_without_permission_to_write_is_named() {
    let parent = tempfile::tempdir().unwrap();
    scene_file(parent.path());
    let locked = parent.path().join("locked");
    fs::create_dir(&locked).unwrap();
    fs::set_permissions(&locked, fs::Permissions::from_mode(0o555)).unwrap();
    if fs::write(locked.join("probe"), b"").is_ok() {
        // Nothing is locked for root.
        return;
    }
    let output = output(parent.path(), &["run", "small.ron", "--out", "locked/run"]);
    assert_eq!(exit_code(&output), 1);
    let message = stderr(&output);
    assert!(message.starts_with("error: the run folder `locked/run` cannot be made: Permission denied"), "{message}");
}

#[test]
fn a_run_that_fails_early_has_a_checkpoint() {
    let parent = tempfile::tempdir().unwrap();
    let path = parent.path().join("early");
    let hour = std::time::Duration::from_secs(3600);
    let settings = RunSettings { autosave: hour, first_autosave: std::time::Duration::ZERO, ..RunSettings::default() };
    let mut broken = |world: &mut World, frame: u64, folder: &RunFolder| -> Result<(), FrameError> {
        if frame == 3 { Err("the pen broke".into()) } else { draw(world, frame, folder) }
    };
    let mut run = Run::begin(simulation(), RunFolder::create(&path).unwrap(), settings).unwrap();
    run.drive(&mut broken, &mut Silent).unwrap_err();
    // After the first step, and none after the others.
    assert_eq!(checkpoints(&path).len(), 1);
    drop(run);
    assert_eq!(resume(&path).unwrap().simulation().clock().steps, 1);
}

#[test]
fn wall_times_have_a_line_per_step_also_in_a_resumed_run() {
    let parent = tempfile::tempdir().unwrap();
    let folder = stopped(&parent, "timed");
    resume(&folder).unwrap().drive(&mut draw, &mut Silent).unwrap();
    let read = |file: &str| -> Vec<Vec<String>> {
        let text = fs::read_to_string(folder.join(file)).unwrap();
        text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
    };
    let (times, observables) = (read("timings.csv"), read("observables.csv"));
    let steps = |table: &[Vec<String>]| table.iter().map(|line| line[..2].to_vec()).collect::<Vec<_>>();
    assert_eq!(steps(&times), steps(&observables));
    assert_eq!(times[0][..4], ["step", "time [s]", "substeps [1]", "Clock [ms]"]);
    assert_eq!(times[0].len(), 3 + Stage::ALL.len());
    for line in &times[1..] {
        let numbers: Vec<f64> = line.iter().map(|number| number.parse().unwrap()).collect();
        assert!(numbers.len() == times[0].len() && numbers[3..].iter().sum::<f64>() > 0.0, "{line:?}");
    }
}
