//! What a whole step costs: remeshing, flow and motion, in microseconds of processor time per vertex and step, by phase.
//!
//! ```text
//! cargo run --release -p froth_surface --example step_cost                     # all scenes
//! cargo run --release -p froth_surface --example step_cost -- foam --repeat 5  # scenes whose name contains a word
//! ```
//!
//! Time is that of the one thread that works, so other programs on the machine disturb it little; of several runs of a scene the
//! cheapest is shown. Scenes are the double bubble at growing resolution (with a step of `0.2 L²`, so that every size does the same
//! work per vertex), a foam of 125 cells after its first T1 avalanche, and a lattice of bubbles that coalesces.

#![allow(clippy::print_stdout, reason = "the table is what the program is for")]

use std::time::Duration;

use froth_surface::flow::{Flow, FlowState, Forcing, Motion, Scheme, Settings, StepInfo, Tangential};
use froth_surface::motion::{MotionSettings, advance};
use froth_surface::shapes::{double_bubble, lattice, sphere_lattice};
use froth_surface::smoothing::tangential_displacements;
use froth_surface::transfer::{Columns, Transfer};
use froth_surface::{LabelledTriangles, Policy, Surface, Tracker};
use glam::DVec3;
use rustix::time::{ClockId, clock_gettime};

/// Phases of a step, in their order.
const PHASES: [&str; 13] = [
    "begin", "snap", "split", "collapse", "flip", "separate", "improve", "close", "adopt", "rebuild", "propose",
    "smooth", "motion",
];

/// A scene: films, target edge length `L` (m), step (s), snapping distance over `L`, steps before and during measurement.
struct Scene {
    name: String,
    triangles: LabelledTriangles,
    edge: f64,
    dt: f64,
    snap: f64,
    warm_up: usize,
    steps: usize,
}

fn scenes() -> Vec<Scene> {
    let scene = |name: String, triangles, edge, dt, warm_up, steps| Scene {
        name,
        triangles,
        edge,
        dt,
        snap: 0.1,
        warm_up,
        steps,
    };
    let double = |fine: f64, steps| {
        let edge = 1.0 / fine;
        let triangles = double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.8, edge);
        scene(format!("double R/L={fine}"), triangles, edge, 0.2 * edge * edge, 5, steps)
    };
    let mut scenes: Vec<Scene> =
        [(10.0, 100), (20.0, 50), (40.0, 10), (80.0, 4), (110.0, 2)].map(|(r, n)| double(r, n)).into();
    scenes.push(scene("foam 5x5x5".into(), lattice(DVec3::ZERO, [5; 3], 1.4, 0.5), 0.5, 0.01, 20, 40));
    scenes.push(scene("fine foam 5x5x5".into(), lattice(DVec3::ZERO, [5; 3], 1.4, 0.25), 0.25, 0.0025, 20, 20));
    let coalescing = scene("coalescing 2x2x2".into(), sphere_lattice([2; 3], 1.0, 0.04, 0.1), 0.1, 0.002, 0, 100);
    scenes.push(Scene { snap: 0.5, ..coalescing });
    scenes
}

/// Time that this thread has spent on a processor.
fn thread_time() -> Duration {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(now.tv_sec as u64, now.tv_nsec as u32)
}

/// Processor time by phase.
#[derive(Clone, Default)]
struct Clock {
    last: Duration,
    spent: [Duration; PHASES.len()],
}

impl Clock {
    fn start(&mut self) {
        self.last = thread_time();
    }

    /// Ends a phase; the next begins.
    fn lap(&mut self, phase: &str) {
        let (now, at) = (thread_time(), PHASES.iter().position(|name| *name == phase).expect("a phase of the list"));
        self.spent[at] += now - self.last;
        self.last = now;
    }

    fn total(&self) -> Duration {
        self.spent.iter().sum()
    }
}

/// Films on their way, and what they cost.
struct Run {
    surface: Surface,
    tracker: Tracker,
    policy: Policy,
    flow: Flow,
    state: FlowState,
    dt: f64,
    clock: Clock,
    info: StepInfo,
    operations: u64,
    vertex_steps: usize,
}

impl Run {
    fn new(scene: &Scene) -> Self {
        let surface = Surface::from_triangles(&scene.triangles);
        let policy = Policy { flips: true, snap: scene.snap, ..Policy::new(scene.edge) };
        let state = FlowState::at_rest(&surface);
        Self {
            surface,
            tracker: Tracker::default(),
            policy,
            flow: Flow::default(),
            state,
            dt: scene.dt,
            clock: Clock::default(),
            info: StepInfo::default(),
            operations: 0,
            vertex_steps: 0,
        }
    }

    fn step(&mut self) {
        self.clock.start();
        self.remesh();
        self.move_films();
        self.vertex_steps += self.surface.positions.len();
    }

    /// What [`Tracker::remesh`] does, and what a method does with its data, phase by phase.
    fn remesh(&mut self) {
        let clock = &mut self.clock;
        let mut columns = Columns::new(3, self.state.velocities.iter().flat_map(|u| u.to_array()).collect());
        let data: &mut dyn Transfer = &mut columns;
        let mut session = self.tracker.begin(&mut self.surface, &self.policy, data);
        clock.lap("begin");
        session.snap_films();
        clock.lap("snap");
        session.split_long_edges();
        clock.lap("split");
        session.collapse_short_edges();
        clock.lap("collapse");
        session.flip_edges();
        clock.lap("flip");
        session.separate_films();
        clock.lap("separate");
        session.improve_faces();
        clock.lap("improve");
        let (counts, mut events) = (session.counts, session.events);
        self.operations += counts.splits + counts.collapses + counts.flips + counts.separations + counts.snaps;
        if !events.is_empty() {
            self.tracker.divide(&mut self.surface, data, &mut events);
        }
        self.tracker.close_up(&mut self.surface, data);
        self.state.velocities.0 = columns.values().chunks_exact(3).map(DVec3::from_slice).collect();
        clock.lap("close");
        self.state.adopt_regions(&self.surface);
        clock.lap("adopt");
    }

    fn move_films(&mut self) {
        let clock = &mut self.clock;
        self.flow.rebuild(&self.surface);
        clock.lap("rebuild");
        let settings = Settings {
            motion: Motion::Overdamped { mobility: 1.0 },
            scheme: Scheme::Implicit,
            tangential: Tangential::Keep,
            ..Settings::default()
        };
        let proposal = self.flow.propose(&self.surface, &self.state, &Forcing::uniform(1.0, 1.0), &settings, self.dt);
        self.info = proposal.expect("the scenes are solvable");
        clock.lap("propose");
        let smoothing = tangential_displacements(&self.surface, 0.2, 0.1 * self.policy.edge);
        let proposed = self.flow.proposal().positions.iter().zip(smoothing.iter()).map(|(x, d)| *x + *d);
        let proposed: Vec<DVec3> = proposed.collect();
        clock.lap("smooth");
        let _ = advance(&mut self.surface, &proposed, &MotionSettings::new(self.policy.edge));
        self.flow.finish(&self.surface.positions, self.dt, &mut self.state);
        clock.lap("motion");
    }
}

fn measure(scene: &Scene) -> Run {
    let mut run = Run::new(scene);
    (0..scene.warm_up).for_each(|_| run.step());
    run.clock = Clock::default();
    (run.vertex_steps, run.operations) = (0, 0);
    (0..scene.steps).for_each(|_| run.step());
    run
}

fn print_row(scene: &Scene, run: &Run) {
    let each = |time: Duration| 1e6 * time.as_secs_f64() / run.vertex_steps as f64;
    print!("| {} | {} | **{:.2}** |", scene.name, run.surface.positions.len(), each(run.clock.total()));
    run.clock.spent.iter().for_each(|time| print!(" {:.2} |", each(*time)));
    let operations = 1e3 * run.operations as f64 / run.vertex_steps as f64;
    println!(" {operations:.2} | {} | {} |", run.info.solve_iterations, run.info.projection_iterations);
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let repeat = words.iter().position(|word| word == "--repeat");
    let repeats = repeat.and_then(|at| words.get(at + 1)?.parse().ok()).unwrap_or(3);
    let wanted = words.first().filter(|word| !word.starts_with("--")).map_or("", String::as_str);
    println!("| scene | vertices | total | {} | operations / 1000 | solve | projection |", PHASES.join(" | "));
    println!("|---|---|---|{}---|---|---|", "---|".repeat(PHASES.len()));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().expect("one thread");
    pool.install(|| {
        for scene in scenes().iter().filter(|scene| scene.name.contains(wanted)) {
            let runs = (0..repeats).map(|_| measure(scene));
            let best = runs.min_by(|a, b| a.clock.total().cmp(&b.clock.total())).expect("at least one run");
            print_row(scene, &best);
        }
    });
}
