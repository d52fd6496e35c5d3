//! A resumed run leaves the same bytes as one that was never interrupted: checkpoint, table, frames.

mod common;

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

use bevy_ecs::query::With;
use bevy_ecs::system::Query;
use bevy_ecs::world::World;
use common::{LAST_FRAME, StopAfter, assert_same_results, draw, exit_code, froth, output, scene_file, signal};
use froth::Simulation;
use froth::run::{FrameError, Run, RunEnd, RunFolder, RunSettings, Silent};
use froth::simulation::SimulationBuilder;
use froth_components::columns;
use froth_components::kind::EulerianParticle;
use froth_components::motion::ExternalAcceleration;
use tempfile::TempDir;

columns! {
    /// Pushes since the start, m/s^2: state that only a test has.
    pub struct Grudge(f64), "grudge", "m/s^2";
}

/// A force with a memory of its own.
fn bear_a_grudge(mut films: Query<(&mut Grudge, &mut ExternalAcceleration), With<EulerianParticle>>) {
    for (mut grudge, mut acceleration) in &mut films {
        grudge.0 = 0.9 * grudge.0 + 0.01;
        acceleration.0.x += grudge.0;
    }
}

fn builder() -> SimulationBuilder {
    Simulation::builder().column::<EulerianParticle, Grudge>()
}

fn begin(folder: &Path, settings: RunSettings) -> Run {
    begin_scene(common::SCENE, folder, settings)
}

fn begin_scene(scene: &str, folder: &Path, settings: RunSettings) -> Run {
    let simulation = builder().build_from_text("small.ron", scene).unwrap();
    let mut run = Run::begin(simulation, RunFolder::create(folder).unwrap(), settings).unwrap();
    run.simulation_mut().add_force("bear a grudge", bear_a_grudge);
    run
}

fn resume(folder: &Path, settings: RunSettings) -> Run {
    let mut run = Run::resume(folder, builder, settings).unwrap();
    run.simulation_mut().add_force("bear a grudge", bear_a_grudge);
    run
}

/// The run that is never interrupted.
fn whole(parent: &TempDir) -> PathBuf {
    let folder = parent.path().join("whole");
    let end = begin(&folder, RunSettings::default()).drive(&mut draw, &mut Silent).unwrap();
    assert!(matches!(end, RunEnd::Finished { .. }));
    folder
}

#[test]
fn a_run_that_stops_at_any_step_goes_on_bit_for_bit() {
    let parent = tempfile::tempdir().unwrap();
    let whole = whole(&parent);
    for step in [1, 2, 8, 11] {
        let folder = parent.path().join(format!("stopped-{step}"));
        let settings = RunSettings::default();
        let mut stop = StopAfter::step(step, &settings);
        let end = begin(&folder, settings).drive(&mut draw, &mut stop).unwrap();
        assert!(matches!(end, RunEnd::Stopped { .. }), "{step}");
        resume(&folder, RunSettings::default()).drive(&mut draw, &mut Silent).unwrap();
        assert_same_results(&folder, &whole);
    }
}

#[test]
fn a_foam_that_stops_goes_on_bit_for_bit() {
    assert_foam_goes_on(common::FOAM);
}

#[test]
fn films_in_air_that_stop_go_on_bit_for_bit() {
    assert_foam_goes_on(&common::sheets("Auto(1e-3)"));
    let several = common::sheets("Direct").replace("VortexSheet(", "VortexSheet(integrator: RungeKutta4, ");
    assert_foam_goes_on(&several);
}

/// A run of films on a mesh that stops at one of its first steps leaves the same bytes.
fn assert_foam_goes_on(scene: &str) {
    let parent = tempfile::tempdir().unwrap();
    let foam = |name: &str, settings: RunSettings| {
        let simulation = Simulation::builder().build_from_text("foam.ron", scene).unwrap();
        Run::begin(simulation, RunFolder::create(&parent.path().join(name)).unwrap(), settings).unwrap()
    };
    foam("whole", RunSettings::default()).drive(&mut draw, &mut Silent).unwrap();
    let whole = parent.path().join("whole");
    for step in [1, 4, 9] {
        let (name, settings) = (format!("stopped-{step}"), RunSettings::default());
        let mut stop = StopAfter::step(step, &settings);
        let end = foam(&name, settings).drive(&mut draw, &mut stop).unwrap();
        assert!(matches!(end, RunEnd::Stopped { .. }), "{step}");
        let folder = parent.path().join(name);
        let mut run = Run::resume(&folder, Simulation::builder, RunSettings::default()).unwrap();
        run.drive(&mut draw, &mut Silent).unwrap();
        assert_same_results(&folder, &whole);
    }
}

#[test]
fn a_run_that_stops_at_every_step_goes_on_bit_for_bit() {
    let parent = tempfile::tempdir().unwrap();
    let whole = whole(&parent);
    let folder = parent.path().join("stuttering");
    let settings = RunSettings::default();
    let mut stop = StopAfter::step(1, &settings);
    let mut end = begin(&folder, settings).drive(&mut draw, &mut stop).unwrap();
    for step in 2.. {
        if matches!(end, RunEnd::Finished { .. }) {
            break;
        }
        let settings = RunSettings::default();
        let mut stop = StopAfter::step(step, &settings);
        end = resume(&folder, settings).drive(&mut draw, &mut stop).unwrap();
    }
    assert_same_results(&folder, &whole);
}

#[test]
fn open_films_several_films_and_warm_liquid_go_on_bit_for_bit() {
    assert_goes_on(common::OPEN_FILMS);
}

#[test]
fn bubbles_of_particles_that_meet_go_on_bit_for_bit() {
    assert_goes_on(common::MEETING);
}

/// Stops a run after its third step, resumes it, and holds it against one that was not stopped.
fn assert_goes_on(scene: &str) {
    let parent = tempfile::tempdir().unwrap();
    let [whole, stopped] = ["whole", "stopped"].map(|name| parent.path().join(name));
    begin_scene(scene, &whole, RunSettings::default()).drive(&mut draw, &mut Silent).unwrap();
    let settings = RunSettings::default();
    let mut stop = StopAfter::step(3, &settings);
    let end = begin_scene(scene, &stopped, settings).drive(&mut draw, &mut stop).unwrap();
    assert!(matches!(end, RunEnd::Stopped { .. }));
    resume(&stopped, RunSettings::default()).drive(&mut draw, &mut Silent).unwrap();
    assert_same_results(&stopped, &whole);
}

#[test]
fn what_was_written_after_the_checkpoint_is_written_again() {
    let parent = tempfile::tempdir().unwrap();
    let whole = whole(&parent);
    let folder = parent.path().join("broken");
    let settings = RunSettings { autosave: Duration::ZERO, ..RunSettings::default() };
    let mut late = |world: &mut World, frame: u64, folder: &RunFolder| -> Result<(), FrameError> {
        if frame == LAST_FRAME - 2 { Err("the pen broke".into()) } else { draw(world, frame, folder) }
    };
    let error = begin(&folder, settings).drive(&mut late, &mut Silent).unwrap_err();
    assert!(error.to_string().starts_with("frame 10 (t = 0.100000 s) is lost: the pen broke"), "{error}");
    // Go on from the one before the newest: more has to be written again.
    std::fs::remove_file(newest_checkpoint(&folder)).unwrap();
    resume(&folder, RunSettings::default()).drive(&mut draw, &mut Silent).unwrap();
    assert_same_results(&folder, &whole);
}

fn newest_checkpoint(folder: &Path) -> PathBuf {
    let checkpoints = folder.join("checkpoints");
    let (name, _) = common::files(&checkpoints).pop_last().unwrap();
    checkpoints.join(name)
}

#[test]
fn a_run_without_a_checkpoint_begins_anew() {
    let parent = tempfile::tempdir().unwrap();
    let whole = whole(&parent);
    let folder = parent.path().join("early");
    let mut broken = |_: &mut World, _: u64, _: &RunFolder| -> Result<(), FrameError> { Err("no ink".into()) };
    begin(&folder, RunSettings::default()).drive(&mut broken, &mut Silent).unwrap_err();
    resume(&folder, RunSettings::default()).drive(&mut draw, &mut Silent).unwrap();
    assert_same_results(&folder, &whole);
}

#[test]
fn a_program_that_is_interrupted_goes_on_bit_for_bit() {
    let parent = tempfile::tempdir().unwrap();
    scene_file(parent.path());
    let arguments = |out| ["run", "small.ron", "--resolution", "1.5", "--json", "--out", out];
    assert_eq!(exit_code(&output(parent.path(), &arguments("whole"))), 0);

    let mut process = froth(parent.path(), &arguments("stopped")).stdout(Stdio::piped()).spawn().unwrap();
    let lines = BufReader::new(process.stdout.take().unwrap()).lines().map(Result::unwrap);
    for line in lines {
        if line.contains(r#""frame":2"#) {
            signal(process.id(), "INT");
        }
    }
    assert_eq!(process.wait().unwrap().code(), Some(75));

    // Other threads, other output: neither is part of the results.
    assert_eq!(exit_code(&output(parent.path(), &["resume", "stopped", "--threads", "1", "--quiet"])), 0);
    assert_same_results(&parent.path().join("stopped"), &parent.path().join("whole"));
    assert_eq!(exit_code(&output(parent.path(), &["resume", "stopped"])), 0);
}
