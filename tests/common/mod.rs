//! What the tests of runs share: one small scene, runs of it, and all bytes that a run leaves.

#![allow(dead_code, reason = "each test file uses its own part")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use bevy_ecs::world::World;
use froth::Simulation;
use froth::run::{FrameError, Progress, Reporter, RunFolder, RunSettings};
use froth_components::column::{Column, Plain};
use froth_components::kind::{EulerianParticle, MeshVertex};
use froth_components::motion::Position;
use froth_systems::rows::read_column;

/// A bubble that wobbles and whose liquid flows: every stage has something to do, and nothing takes long.
pub(crate) const SCENE: &str = r#"Scene(
    title: "A small bubble",
    method: Melp(cfl: 0.5, liquid_per_carrier: 4),
    resolution: Particles(600),
    duration: "0.12 s",
    frames_per_second: 100,
    seed: 7,
    picture: (width: 96, height: 96),
    entities: [
        [
            Sphere(radius: "5 cm"),
            Bumps(amplitude: 0.02),
            Film(thickness: Noise(mean: "400 nm", relative: 0.1, frequency: 2), surfactant: WithThickness),
        ],
        [ Gravity((0.0, -1.0, 0.0)) ],
        [ Hover() ],
    ],
)
"#;
/// Pinned rims, several films, warm liquid, a seeded swirl, and FLIP, which remembers the velocities of the step before.
pub(crate) const OPEN_FILMS: &str = r#"Scene(
    title: "Three films",
    method: Melp(cfl: 0.5, liquid_per_carrier: 4, flip: 0.5, xsph: 0.1, gas: Adiabatic(1.4)),
    resolution: Particles(900),
    duration: "0.06 s",
    frames_per_second: 100,
    entities: [
        [ Disc(radius: "4 cm"), Film(thickness: Noise(mean: "400 nm"), warmth: 0.2), Swirl(speed: "5 cm/s") ],
        [ Rectangle(centre: (0.2, 0.0, 0.0), width: "8 cm", height: "8 cm"), Film(thickness: Uniform("300 nm")) ],
        [ Sphere(centre: (-0.2, 0.0, 0.0), radius: "3 cm"), Film(thickness: Uniform("300 nm")), Drift((0.1, 0.0, 0.0)) ],
        [ HeatSource(position: (0.0, -0.03, 0.0), radius: "2 cm") ],
    ],
)
"#;

/// Three bubbles that meet, the third on a wall of the others, with liquid that flows.
pub(crate) const MEETING: &str = r#"Scene(
    title: "Bubbles that meet",
    method: Melp(cfl: 0.5, liquid_per_carrier: 4),
    resolution: Particles(900),
    duration: "0.1 s",
    frames_per_second: 100,
    picture: (width: 96, height: 96),
    entities: [
        [ Sphere(centre: (-0.05, 0.0, 0.0), radius: "5 cm"), Film(thickness: Noise(mean: "400 nm")), Drift((0.1, 0.0, 0.0)) ],
        [ Sphere(centre: (0.051, 0.0, 0.0), radius: "5 cm"), Film(thickness: Uniform("300 nm")), Drift((-0.1, 0.0, 0.0)) ],
        [ Sphere(centre: (0.0, 0.087, 0.0), radius: "5 cm"), Film(thickness: Uniform("500 nm")) ],
        [ AirDrag(rate: "1 1/s", normal: "10 1/s") ],
    ],
)
"#;

/// A small foam as a mesh: volumes, T1 processes, bursts, and a wire that moves.
pub(crate) const FOAM: &str = r#"Scene(
    title: "A small foam",
    method: GeometricFlow(),
    resolution: Spacing("1.2 cm"),
    duration: "0.12 s",
    frames_per_second: 100,
    picture: (width: 96, height: 96),
    entities: [
        [ Packing(count: 5, radius: "3 cm", seed: Some(2)), Film(thickness: Noise(mean: "400 nm", relative: 0.2)) ],
        [ Catenoid(centre: (0.25, 0.0, 0.0), radius: "3 cm", gap: "3 cm"), Film(thickness: Uniform("300 nm")) ],
        [ Wire(path: Ring(centre: (0.25, "1.5 cm", 0.0), axis: (0, 1, 0), radius: "3 cm")), Moves(velocity: (0, 0.05, 0)) ],
        [ Burst(every: "0.05 s", first: "0.03 s") ],
    ],
)
"#;

/// A small cluster in air with T1 processes, wires and bursts, and `summation` of its pairs: what every stage of vortex sheets has to do.
pub(crate) fn sheets(summation: &str) -> String {
    format!(
        r#"Scene(
    title: "Films in air",
    method: VortexSheet(summation: {summation}, diffusivity: "2 cm^2/s"),
    resolution: Spacing("1.2 cm"),
    duration: "0.05 s",
    frames_per_second: 100,
    picture: (width: 96, height: 96),
    entities: [
        [ Lattice(cell: "3 cm", counts: (2, 2, 1)), Film(thickness: Noise(mean: "400 nm", relative: 0.2)) ],
        [ Catenoid(centre: (0.25, 0.0, 0.0), radius: "3 cm", gap: "3 cm"), Film(thickness: Uniform("300 nm")) ],
        [ Wire(path: Ring(centre: (0.25, "1.5 cm", 0.0), axis: (0, 1, 0), radius: "3 cm")), Moves(velocity: (0, 0.05, 0)) ],
        [ Gravity((0.0, -1.0, 0.0)) ],
        [ Burst(every: "0.02 s", first: "0.01 s") ],
    ],
)
"#
    )
}

/// Number of the last frame of [`SCENE`].
pub(crate) const LAST_FRAME: u64 = 12;

/// The scene as a simulation.
pub(crate) fn simulation() -> Simulation {
    Simulation::builder().build_from_text("small.ron", SCENE).unwrap()
}

/// The scene as a file.
pub(crate) fn scene_file(folder: &Path) -> PathBuf {
    let path = folder.join("small.ron");
    fs::write(&path, SCENE).unwrap();
    path
}

/// A frame that holds the carriers' places: as sensitive as a picture, and quicker.
pub(crate) fn draw(world: &mut World, frame: u64, folder: &RunFolder) -> Result<(), FrameError> {
    let mut bytes = Vec::new();
    let carriers = read_column::<EulerianParticle, Position>(world);
    for position in carriers.into_iter().chain(read_column::<MeshVertex, Position>(world)) {
        position.value().write_le(&mut bytes);
    }
    Ok(folder.write(RunFolder::frame_file(frame), &bytes)?)
}

/// Raises the stop flag after a step.
pub(crate) struct StopAfter {
    step: u64,
    stop: Arc<AtomicBool>,
}

impl StopAfter {
    pub(crate) fn step(step: u64, settings: &RunSettings) -> Self {
        Self { step, stop: Arc::clone(&settings.stop) }
    }
}

impl Reporter for StopAfter {
    fn step(&mut self, progress: &Progress) {
        if progress.step == self.step {
            self.stop.store(true, Ordering::Relaxed);
        }
    }
}

/// All bytes of a run that its contract speaks of: the newest checkpoint, the frames, the table, and whatever else is made of them;
/// not manifest, timings and log, which hold wall times.
pub(crate) fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let newest = files(&folder.join("checkpoints")).pop_last().expect("a checkpoint");
    let mut results = files(folder);
    assert!(results.contains_key("observables.csv"));
    results.retain(|name, _| !["manifest.json", "timings.csv", "run.log"].contains(&name.as_str()));
    results.extend(files(&folder.join("frames")));
    results.extend([newest]);
    results
}

/// Names and bytes of the files of a folder.
pub(crate) fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap()).filter(|entry| entry.path().is_file());
    entries.map(|entry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap())).collect()
}

/// Asserts that two runs left the same bytes, naming the first file that differs.
pub(crate) fn assert_same_results(run: &Path, wanted: &Path) {
    let (run, wanted) = (results(run), results(wanted));
    assert_eq!(run.keys().collect::<Vec<_>>(), wanted.keys().collect::<Vec<_>>());
    for (name, bytes) in &wanted {
        assert!(run[name] == *bytes, "{name} differs");
    }
}

/// The program, in a folder.
pub(crate) fn froth(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_froth"));
    command.current_dir(folder).args(arguments);
    command
}

/// Runs the program to its end.
pub(crate) fn output(folder: &Path, arguments: &[&str]) -> Output {
    froth(folder, arguments).output().unwrap()
}

pub(crate) fn exit_code(output: &Output) -> i32 {
    output.status.code().expect("an exit code")
}

pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Sends a signal, such as `INT`.
pub(crate) fn signal(process: u32, name: &str) {
    assert!(Command::new("kill").args([&format!("-{name}"), &process.to_string()]).status().unwrap().success());
}
