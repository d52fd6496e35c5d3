//! Vortex sheets as a user meets them: integrators, other methods on the same scene, faults of meshes, and notes.

mod common;

use common::{draw, sheets};
use froth::Simulation;
use froth::method::{geometric_flow, vortex_sheet};
use froth::run::{Reporter, Run, RunFolder, RunSettings};
use froth::simulation::BuildError;
use froth_components::film::{Area, LiquidVolume};
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

/// Where vertices are after 10 ms of a scene of sheets.
fn places(method: &str, entities: &str) -> Vec<DVec3> {
    let scene = format!(
        r#"Scene(title: "t", method: VortexSheet({method}), resolution: Spacing("1 cm"), duration: "1 s", entities: [{entities}])"#
    );
    let mut simulation = Simulation::from_scene_text(&scene).unwrap();
    simulation.advance_to(0.01).unwrap();
    simulation.column::<MeshVertex, Position>().iter().map(|x| x.0).collect()
}

#[test]
fn a_bubble_goes_with_the_wind_and_rings_as_in_still_air() {
    let bubble =
        r#"[ Sphere(radius: "4 cm"), HarmonicMode(degree: 2, amplitude: 0.1), Film(thickness: Uniform("400 nm")) ]"#;
    let still = places("summation: Direct, cfl: 0.5", bubble);
    let blown = places("summation: Direct, cfl: 0.5", &format!("{bubble}, [ Wind(velocity: (0.1, 0, 0)) ]"));
    let back: Vec<DVec3> = blown.iter().map(|x| *x - 0.001 * DVec3::X).collect();
    assert!(farthest(&still, &blown) > 9e-4, "the wind has moved the bubble");
    assert!(farthest(&still, &back) < 1e-10, "{:e}", farthest(&still, &back));
}

#[test]
fn a_ring_that_moves_through_still_air_is_a_ring_at_rest_in_a_wind() {
    let film = r#"[ Disc(radius: "3 cm", normal: (1, 0, 0)), Film(thickness: Uniform("1 um")) ]"#;
    let ring = |velocity: &str| {
        let wire = r#"Wire(path: Ring(centre: (0, 0, 0), axis: (1, 0, 0), radius: "3 cm"))"#;
        format!("{film}, [ {wire}, Moves(velocity: {velocity}) ]")
    };
    let settings = "summation: Direct, cfl: 0.5, remesh: Remesh(enabled: false)";
    let moving = places(settings, &ring("(0.5, 0, 0)"));
    let resting = places(settings, &format!("{}, [ Wind(velocity: (-0.5, 0, 0)) ]", ring("(0, 0, 0)")));
    let back: Vec<DVec3> = resting.iter().map(|x| *x + 0.005 * DVec3::X).collect();
    let bulge = moving.iter().map(|x| 0.005 - x.x).fold(0.0, f64::max);
    assert!(bulge > 2e-3, "the film lags behind the ring by {bulge} m");
    assert!(farthest(&moving, &back) < 0.02 * bulge, "{:e}", farthest(&moving, &back));
}

#[test]
fn a_bubble_that_is_blown_up_pushes_another_away() {
    let flow = 60e-6 - 4.0 / 3.0 * std::f64::consts::PI * 0.02f64.powi(3);
    let blown =
        r#"[ Sphere(radius: "2 cm"), Film(thickness: Uniform("400 nm")), Volumes(of: ["60 ml"], within: "0.05 s") ]"#;
    let other = r#"[ Sphere(radius: "1 cm", centre: ("8 cm", 0, 0)), Film(thickness: Uniform("400 nm")) ]"#;
    let scene = format!(
        r#"Scene(title: "t", method: VortexSheet(), resolution: Spacing("4 mm"), duration: "1 s", entities: [{blown}, {other}])"#
    );
    let mut simulation = Simulation::from_scene_text(&scene).unwrap();
    simulation.advance_to(0.01).unwrap();
    let centre = |simulation: &mut Simulation, is_of: fn(&DVec3) -> bool| {
        let places: Vec<DVec3> =
            simulation.column::<MeshVertex, Position>().iter().map(|x| x.0).filter(is_of).collect();
        places.iter().sum::<DVec3>() / places.len() as f64
    };
    let near = centre(&mut simulation, |x| x.x < 0.05);
    let far = centre(&mut simulation, |x| x.x > 0.05);
    // A small bubble is air among air: d' = Q/(4 pi d^2), and the air that it displaces moves on average as its middle does.
    let distance = (0.08f64.powi(3) + 3.0 * flow / 0.05 * 0.01 / (4.0 * std::f64::consts::PI)).cbrt();
    let (way, expected) = (far.x - 0.08, distance - 0.08);
    assert!((way / expected - 1.0).abs() < 0.02, "{way:e} m for {expected:e}");
    assert!(
        near.length() < 0.02 * expected && DVec3::new(0.0, far.y, far.z).length() < 0.02 * expected,
        "{near} {far}"
    );
    assert!(simulation.observables().get("volume_error").unwrap() < 1e-12);
}

#[test]
fn a_wire_feeds_the_film_that_is_drawn_out_of_it() {
    let scene = |feeds: &str| {
        format!(
            r#"Scene(title: "t", method: VortexSheet(diffusivity: "1 cm^2/s"), resolution: Spacing("1 cm"), duration: "1 s", entities: [
                [ Disc(radius: "3 cm", normal: (1, 0, 0)), Film(thickness: Uniform("1 um")) ],
                [ Wire(path: Ring(centre: (0, 0, 0), axis: (1, 0, 0), radius: "3 cm"){feeds}), Moves(velocity: (3, 0, 0)) ],
            ])"#
        )
    };
    let drawn = |feeds: &str| {
        let mut simulation = Simulation::from_scene_text(&scene(feeds)).unwrap();
        let liquid = |simulation: &Simulation, name: &str| simulation.observables().get(name).unwrap_or(0.0);
        simulation.step().unwrap();
        let start = liquid(&simulation, "liquid") - liquid(&simulation, "liquid_fed");
        simulation.advance_to(0.03).unwrap();
        let kept =
            liquid(&simulation, "liquid") + liquid(&simulation, "liquid_lost") - liquid(&simulation, "liquid_fed");
        assert!((kept / start - 1.0).abs() < 1e-12, "all liquid is accounted for: {kept} {start}");
        let (liquid, areas) =
            (simulation.column::<MeshVertex, LiquidVolume>(), simulation.column::<MeshVertex, Area>());
        liquid.iter().zip(&areas).map(|(volume, area)| volume.0 / area.0).fold(f64::INFINITY, f64::min)
    };
    let (dry, fed) = (drawn(""), drawn(r#", feeds: "1 um""#));
    assert!(dry < 0.2e-6 && fed > 0.4e-6, "{dry:e} {fed:e}");
}

#[test]
fn the_inertia_of_the_air_pinches_a_bubble_off_behind_a_ring() {
    let scene = r#"Scene(title: "t", method: VortexSheet(diffusivity: "1 cm^2/s"), resolution: Spacing("8 mm"), duration: "1 s", entities: [
        [ Disc(radius: "3 cm", normal: (1, 0, 0)), Film(thickness: Uniform("2 um")) ],
        [ Wire(path: Ring(centre: (0, 0, 0), axis: (1, 0, 0), radius: "3 cm")), Moves(velocity: (3, 0, 0)) ],
    ])"#;
    let mut simulation = Simulation::from_scene_text(scene).unwrap();
    while simulation.observables().get("bubbles").is_none_or(|bubbles| bubbles == 0.0) {
        simulation.step().unwrap();
        assert!(simulation.time() < 0.25, "no bubble yet");
    }
    assert!(simulation.time() > 0.1, "too soon: {} s", simulation.time());
}

#[test]
fn films_that_meet_and_part_give_the_air_no_energy() {
    let scene = sheets("Direct").replacen("diffusivity: \"2 cm^2/s\"", "", 1);
    let scene: String = scene.lines().filter(|line| !line.contains("Wire") && !line.contains("Catenoid")).collect();
    let scene = scene.replace("[ Gravity((0.0, -1.0, 0.0)) ],", "");
    let mut simulation = Simulation::from_scene_text(&scene).unwrap();
    let (mut last, mut first, mut lost) = (f64::INFINITY, None, 0.0);
    while simulation.time() < 0.05 {
        simulation.step().unwrap();
        let observed = |name: &str| simulation.observables().get(name).unwrap();
        // The mesh is coarse, and T1s make film; what contacts once gave the air was many times as much.
        let swing = 0.03 * *first.get_or_insert(observed("energy"));
        assert!(observed("energy") < last + swing, "{last:e} to {:e} at {}", observed("energy"), simulation.time());
        last = last.min(observed("energy"));
        lost += observed("contact_loss");
    }
    assert!(lost > 0.0, "films have met or parted");
}

#[test]
fn a_burst_at_the_time_of_a_frame_takes_no_step_of_its_own() {
    let scene = r#"Scene(title: "t", method: VortexSheet(), resolution: Spacing("1.2 cm"), duration: "1 s", frames_per_second: 50, entities: [
        [ Lattice(cell: "3 cm", counts: (2, 2, 1)), Film(thickness: Uniform("400 nm")) ],
        [ Burst(every: "0.1 s") ],
    ])"#;
    let mut simulation = Simulation::from_scene_text(scene).unwrap();
    let mut shortest = f64::INFINITY;
    while simulation.time() < 0.31 {
        simulation.step().unwrap();
        shortest = shortest.min(simulation.observables().get("step_length").unwrap());
    }
    assert!(shortest > 1e-6, "{shortest:e}");
}

#[test]
fn bubbles_of_other_soap_have_the_pressure_and_the_pace_of_their_own_tension() {
    let bubble = |x: &str, tension: &str| {
        format!(
            r#"[ Sphere(centre: ({x}, 0, 0), radius: "3 cm"), HarmonicMode(degree: 2, amplitude: 0.02), Tension("{tension}"), Film(thickness: Uniform("400 nm")) ]"#
        )
    };
    for (method, within) in [("VortexSheet(damping: 60)", 0.02), ("GeometricFlow()", 1e-3)] {
        let scene = format!(
            r#"Scene(title: "t", method: {method}, resolution: Spacing("8 mm"), duration: "2 s", entities: [{}, {}])"#,
            bubble("-0.2", "15 mN/m"),
            bubble("0.2", "45 mN/m")
        );
        let mut simulation = Simulation::from_scene_text(&scene).unwrap();
        simulation.advance_to(0.3).unwrap();
        let observed = |name: &str| simulation.observables().get(name).unwrap();
        let [low, high] = ["excess_pressure_1", "excess_pressure_2"].map(observed);
        assert!((low / (4.0 * 0.015 / 0.03) - 1.0).abs() < 0.02, "{method}: {low} Pa");
        assert!((high / low - 3.0).abs() < 3.0 * within, "{method}: {}", high / low);
        let energy = 2.0 * (0.015 * observed("area_1") + 0.045 * observed("area_2"));
        assert!((observed("surface_energy") / energy - 1.0).abs() < 1e-9, "{method}");
    }
}

#[test]
fn two_soaps_that_share_a_wall_have_pressures_of_their_own() {
    // Equal volumes: the bubble of greater tension has the greater pressure, and bulges into the other.
    let scene = r#"Scene(title: "t", method: GeometricFlow(remesh: (snap: 0.45)), resolution: Spacing("5 mm"), duration: "2 s", entities: [
        [ Sphere(centre: (-0.0301, 0, 0), radius: "3 cm"), Tension("25 mN/m"), Film(thickness: Uniform("400 nm")) ],
        [ Sphere(centre: (0.0301, 0, 0), radius: "3 cm"), Tension("35 mN/m"), Film(thickness: Uniform("400 nm")) ],
    ])"#;
    let mut simulation = Simulation::from_scene_text(scene).unwrap();
    simulation.advance_to(0.6).unwrap();
    let observed = |name: &str| simulation.observables().get(name).unwrap();
    let [low, high] = ["excess_pressure_1", "excess_pressure_2"].map(observed);
    assert!(high > 1.2 * low, "{low} {high} Pa");
    let shared = observed("area_1") + observed("area_2") - observed("area");
    assert!(shared > 1e-4, "they have a wall in common: {shared} m^2");
}
