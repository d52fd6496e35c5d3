//! Vortex sheets as a user meets them: integrators, other methods on the same scene, faults of meshes, and notes.

mod common;

use common::{draw, sheets};
use froth::Simulation;
use froth::method::{geometric_flow, vortex_sheet};
use froth::run::{Reporter, Run, RunFolder, RunSettings};
use froth::simulation::BuildError;
use froth_components::kind::MeshVertex;
use froth_components::motion::Position;
use glam::DVec3;

const RADIUS: f64 = 0.05;

fn bubble(settings: &str) -> String {
    format!(
        r#"Scene(title: "t", method: VortexSheet({settings}), resolution: Vertices(162), duration: "1 s", entities: [
            [ Name("bubble"), Sphere(radius: "5 cm"), HarmonicMode(degree: 2, amplitude: 0.05), Film(thickness: Uniform("400 nm")) ],
        ])"#
    )
}

/// Places after 30 ms, a fifth of a period, and evaluations per substep of the last step.
fn swung(integrator: &str) -> (Vec<DVec3>, f64) {
    let settings = format!("integrator: {integrator}, courant: 0.1, summation: Direct");
    let mut simulation = Simulation::from_scene_text(&bubble(&settings)).unwrap();
    simulation.advance_to(0.03).unwrap();
    let observed = |name: &str| simulation.observables().get(name).unwrap();
    let evaluations = observed("evaluations") / observed("substeps");
    (simulation.column::<MeshVertex, Position>().iter().map(|x| x.0).collect(), evaluations)
}

fn farthest(some: &[DVec3], others: &[DVec3]) -> f64 {
    some.iter().zip(others).map(|(x, y)| x.distance(*y)).fold(0.0, f64::max)
}

#[test]
fn integrators_of_many_evaluations_agree_with_the_leapfrog() {
    let start: Vec<DVec3> = {
        let mut simulation = Simulation::from_scene_text(&bubble("")).unwrap();
        simulation.column::<MeshVertex, Position>().iter().map(|x| x.0).collect()
    };
    let (leapfrog, once) = swung("Leapfrog");
    assert_eq!(once, 1.0);
    let way = farthest(&leapfrog, &start);
    assert!(way > 0.02 * RADIUS, "the bubble has swung by {way} m");
    for (integrator, least, tolerance) in
        [("RungeKutta4", 4.0, 2e-3), ("ImplicitMidpoint", 3.0, 2e-3), ("SymplecticEuler", 1.0, 0.1)]
    {
        let (places, evaluations) = swung(integrator);
        assert!(evaluations >= least, "{integrator}: {evaluations} evaluations");
        let off = farthest(&places, &leapfrog) / way;
        assert!(off < tolerance, "{integrator}: off by {off:.2e} of the way");
    }
}

#[test]
fn a_scene_of_sheets_runs_by_geometric_flow_and_back() {
    let flow =
        sheets("Direct").replacen("VortexSheet(summation: Direct, diffusivity: \"2 cm^2/s\")", "GeometricFlow()", 1);
    assert_ne!(flow, sheets("Direct"));
    for (scene, method) in [(sheets("Direct"), geometric_flow::METHOD), (flow, vortex_sheet::METHOD)] {
        let mut simulation = Simulation::builder().method(method).build_from_text("scene.ron", &scene).unwrap();
        for _ in 0..5 {
            simulation.step().unwrap();
        }
        assert!(simulation.time() > 0.0 && simulation.observables().get("volume_error").unwrap() < 1e-6);
    }
}

#[test]
fn a_velocity_at_the_start_is_refused_where_sheets_replace_another_method() {
    let scene = bubble("").replace("VortexSheet()", "GeometricFlow(motion: Inertial())");
    let drifting = scene.replace("Name(\"bubble\")", "Name(\"bubble\"), Drift((0.1, 0, 0))");
    Simulation::from_scene_text(&drifting).unwrap();
    let built = Simulation::builder().method(vortex_sheet::METHOD).build_from_text("scene.ron", &drifting);
    let Err(BuildError::Scene(error)) = built.map(|_| ()) else { panic!("no error of the scene") };
    assert_eq!(error.stable_code(), "F0043");
    assert!(error.to_string().contains("Drift"), "{error}");
}

/// The code of what is wrong with a scene of sheets around other entities.
fn code_of(entities: &str) -> String {
    let scene = format!(
        r#"Scene(title: "t", method: VortexSheet(), resolution: Spacing("1 cm"), duration: "1 s", entities: [{entities}])"#
    );
    match Simulation::builder().build_from_text("tests/meshes/scene.ron", &scene).map(|_| ()) {
        Err(BuildError::Scene(error)) => error.stable_code(),
        Err(other) => panic!("no error of the scene: {other}"),
        Ok(()) => panic!("the scene passes"),
    }
}

#[test]
fn a_wire_outside_any_film_is_refused() {
    let bubble = r#"[ Sphere(radius: "5 cm"), Film(thickness: Uniform("400 nm")) ]"#;
    let wire = r#"[ Wire(path: Ring(centre: (0.5, 0, 0), axis: (1, 0, 0), radius: "3 cm")) ]"#;
    assert_eq!(code_of(&format!("{bubble}, {wire}")), "F0067");
}

#[test]
fn a_region_without_volume_is_refused() {
    assert_eq!(code_of(r#"[ MeshFile(path: "no_volume.obj"), Film(thickness: Uniform("400 nm")) ]"#), "F0063");
}

#[derive(Default)]
struct Notes(Vec<String>);

impl Reporter for Notes {
    fn note(&mut self, text: &str) {
        self.0.push(text.to_owned());
    }
}

#[test]
fn steps_far_above_the_capillary_limit_are_divided_with_a_note() {
    let scene = bubble("").replace("duration: \"1 s\"", "duration: \"40 ms\", maximum_step: \"10 ms\"");
    let folder = tempfile::tempdir().unwrap();
    let simulation = Simulation::from_scene_text(&scene).unwrap();
    let run_folder = RunFolder::create(&folder.path().join("run")).unwrap();
    let (mut run, mut notes) = (Run::begin(simulation, run_folder, RunSettings::default()).unwrap(), Notes::default());
    run.drive(&mut draw, &mut notes).unwrap();
    assert!(run.simulation().observables().get("substeps").unwrap() >= 2.0);
    assert_eq!(notes.0.len(), 1, "{:?}", notes.0);
    assert!(notes.0[0].contains("substeps"), "{:?}", notes.0);
}
