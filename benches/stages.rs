//! Time of each part of a MELP step, and of a whole step, on the giant bubble.
//!
//! `cargo bench --bench stages -- 16000` measures at 16 000 Eulerian particles; `RAYON_NUM_THREADS=1` on one thread.
//! Each time is the least of several calls. `froth bench` measures the stages within a running simulation.
#![allow(clippy::print_stdout, reason = "a benchmark prints its table")]

use std::hint::black_box;
use std::time::Instant;

use froth::Simulation;
use froth::gallery;
use froth_components::film::{LiquidVolume, ShapeOperator, Surfactant, SurfactantAmount, Warmth};
use froth_components::identity::InRegion;
use froth_components::kind::{EulerianParticle as E, LagrangianParticle as L};
use froth_components::lamella::Lamellae;
use froth_components::motion::{Normal, Position, Velocity, VelocityGradient};
use froth_systems::melp::carriers::refit;
use froth_systems::melp::frames::FilmFrames;
use froth_systems::melp::gather::{Material, gather_all};
use froth_systems::melp::links::Carriers;
use froth_systems::melp::material::{MovingMaterial, advance_all};
use froth_systems::melp::measure::dual_areas;
use froth_systems::melp::redistribution::{Spread, lift};
use froth_systems::melp::scatter::{Blend, CarrierFlow, Received, scatter_all};
use froth_systems::melp::tiles::Rows;
use froth_systems::operators::conjugate_gradient::{StopRule, Workspace};
use froth_systems::operators::stencil::{Points, Stencil};
use glam::DVec3;

/// Calls of which the fastest counts.
const CALLS: usize = 5;
/// Eulerian particles where nobody says otherwise.
const CARRIERS: f64 = 4000.0;

fn main() {
    let carriers = std::env::args().find_map(|argument| argument.parse().ok()).unwrap_or(CARRIERS);
    let scene = &gallery::GALLERY[0];
    let mut simulation = Simulation::builder()
        .resolution((carriers / 4000.0_f64).sqrt())
        .build_from_text(scene.name, scene.text)
        .expect("the built-in scene can be simulated");
    for _ in 0..2 {
        simulation.step().expect("the first steps succeed");
    }
    println!("{}: {:?}, {} threads", scene.name, simulation.rows(), rayon::current_num_threads());
    rayon::scope(|_| measure_parts(&mut simulation));
    time("a whole step", || simulation.step().expect("a step succeeds"));
}

/// Prints the least time of a call.
fn time<T>(what: &str, mut call: impl FnMut() -> T) {
    let least = (0..CALLS).map(|_| {
        let began = Instant::now();
        black_box(call());
        began.elapsed()
    });
    println!("  {what:<42} {:>10.3} ms", 1e3 * least.min().expect("several calls").as_secs_f64());
}

fn measure_parts(simulation: &mut Simulation) {
    let spacing = simulation.world().resource::<Lamellae>().spacing;
    let (mut positions, mut normals) = (simulation.column::<E, Position>(), simulation.column::<E, Normal>());
    let (regions, mut shapes) = (simulation.column::<E, InRegion>(), simulation.column::<E, ShapeOperator>());
    let points =
        Points { positions: &positions, normals: &normals, regions: &regions, wall: &[], wall_regions: &[], spacing };
    let mut stencil = Stencil::build(points);
    time("build the stencil", || stencil.rebuild(points));
    let carriers =
        Carriers { positions: &positions, normals: &normals, regions: &regions, cells: &stencil.cells, spacing };
    time("measure dual areas", || dual_areas(carriers, &stencil.areas));
    measure_transfers(simulation, carriers, &shapes);
    let films = [0..positions.len()];
    let spread =
        Spread { stencil: &stencil, positions: &positions, wall: &[], normals: &normals, films: &films, spacing };
    let excess = spread.excess();
    let stop = StopRule { tolerance: 1e-3, max_iterations: 4000 };
    let mut work = Workspace::default();
    time("solve the redistribution", || spread.moves(&excess, stop, &mut work).expect("converges"));
    let moves = spread.moves(&excess, stop, &mut work).expect("converges").displacement;
    let before = normals.clone();
    time("lift the carriers along quartics", || {
        lift(&stencil, spacing, &mut positions, &before, &shapes, &moves);
    });
    time("refit the frames by quadratics", || refit(&stencil, spacing, &positions, &mut normals, &mut shapes));
}

fn measure_transfers(simulation: &mut Simulation, carriers: Carriers, shapes: &[ShapeOperator]) {
    let (mut positions, mut normals) = (simulation.column::<L, Position>(), simulation.column::<L, Normal>());
    let regions = simulation.column::<L, InRegion>();
    let (mut velocities, mut gradients) =
        (simulation.column::<L, Velocity>(), simulation.column::<L, VelocityGradient>());
    let (volumes, amounts) = (simulation.column::<L, LiquidVolume>(), simulation.column::<L, SurfactantAmount>());
    let warmth = simulation.column::<L, Warmth>();
    let rows = Rows { positions: &positions, normals: &normals, regions: &regions };
    let material = Material {
        rows,
        velocities: &velocities,
        gradients: &gradients,
        volumes: &volumes,
        surfactants: &amounts,
        warmth: &warmth,
    };
    let mut links = Vec::new();
    time("link and gather (L2E)", || gather_all(carriers, material, &mut links));
    let velocity: Vec<_> =
        gather_all(carriers, material, &mut links).iter().map(|gathered| gathered.momentum / gathered.volume).collect();
    let concentration: Vec<f64> = simulation.column::<E, Surfactant>().iter().map(|gamma| gamma.0).collect();
    let flow = CarrierFlow { velocity: &velocity, change: &velocity, drift: &[], concentration: &concentration };
    let blend = Blend { affine: true, flip: 0.0 };
    let (mut taken, mut drift) = (vec![0.0; positions.len()], vec![DVec3::ZERO; positions.len()]);
    time("scatter (E2L)", || {
        let received = Received {
            velocities: &mut velocities,
            gradients: &mut gradients,
            concentration: &mut taken,
            drift: &mut drift,
        };
        scatter_all(carriers, flow, rows, &links, blend, received);
    });
    time("advance and project the liquid", || {
        let material = MovingMaterial {
            positions: &mut positions,
            normals: &mut normals,
            drift: &drift,
            velocities: &mut velocities,
            gradients: &mut gradients,
            regions: &regions,
        };
        advance_all(material, carriers, shapes, 1e-6, &FilmFrames::default(), |_| None)
    });
}
