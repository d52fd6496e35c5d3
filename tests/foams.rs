//! Geometric flow as a user meets it: columns of one's own, events, liquid, wires, and faults.

use bevy_ecs::system::{Query, ResMut};
use bevy_ecs::world::World;
use bevy_ecs::{query::With, resource::Resource};
use froth::Simulation;
use froth::simulation::BuildError;
use froth_components::columns;
use froth_components::film::{LiquidVolume, Thickness};
use froth_components::kind::MeshVertex;
use froth_components::motion::{ExternalAcceleration, Pinned, Position};
use froth_surface::corners::LeastAngles;
use froth_surface::invariants::check_all;
use froth_systems::plan::Requires;
use froth_systems::stage::Stage;
use froth_systems::tracker::events::TopologyEvent;
use froth_systems::tracker::films;

columns! {
    /// A linear field that is carried along.
    pub struct Dye(f64), "dye", "1";
}

#[derive(Resource, Default)]
struct Seen(Vec<String>);

fn simulation(entities: &str, method: &str) -> Simulation {
    let text = format!(
        r#"Scene(title: "t", method: {method}, resolution: Spacing("8 mm"), duration: "1 s", entities: [{entities}])"#
    );
    Simulation::builder().column::<MeshVertex, Dye>().build_from_text("foam.ron", &text).unwrap()
}

const LATTICE: &str = r#"[ Lattice(cell: "3 cm", counts: (2, 2, 2)), Film(thickness: Noise(mean: "400 nm")) ]"#;

#[test]
fn liquid_keeps_its_sum_and_a_column_of_ones_own_is_carried_along() {
    let mut foam = simulation(LATTICE, "GeometricFlow()");
    let liquid = |foam: &mut Simulation| foam.column::<MeshVertex, LiquidVolume>().iter().map(|v| v.0).sum::<f64>();
    let before = liquid(&mut foam);
    let dye: Vec<Dye> = foam.column::<MeshVertex, Position>().iter().map(|x| Dye(x.0.x)).collect();
    foam.set_column::<MeshVertex, Dye>(&dye);
    for _ in 0..12 {
        foam.step().unwrap();
    }
    assert_ne!(foam.column::<MeshVertex, Dye>().len(), dye.len(), "the mesh should have changed");
    assert!((liquid(&mut foam) / before - 1.0).abs() < 1e-12);
    let (low, high) = (dye.iter().map(|d| d.0).fold(1.0, f64::min), dye.iter().map(|d| d.0).fold(-1.0, f64::max));
    let carried = foam.column::<MeshVertex, Dye>();
    let off = carried.iter().map(|d| (low - d.0).max(d.0 - high)).fold(f64::NEG_INFINITY, f64::max);
    assert!(off < 1e-12, "means lie between what they are of, but for rounding: {off:e}");
    assert!(foam.column::<MeshVertex, Thickness>().iter().all(|eta| eta.0 > 0.0));
}

#[test]
fn changes_of_topology_are_entities_that_a_system_reads() {
    let mut foam = simulation(LATTICE, "GeometricFlow()");
    foam.world_mut().init_resource::<Seen>();
    let read = |events: Query<&TopologyEvent>, mut seen: ResMut<Seen>| {
        seen.0.extend(events.iter().map(|event| format!("{} {:?}", event.kind.name(), event.regions)));
    };
    foam.add_system(Stage::Observe, "read events", read, Requires::nothing());
    foam.step().unwrap();
    let seen = &foam.world().resource::<Seen>().0;
    assert!(seen.iter().any(|event| event.starts_with("t1")), "{seen:?}");
}

#[test]
fn the_films_of_a_foam_hold_all_invariants_after_every_step() {
    let mut foam = simulation(LATTICE, "GeometricFlow()");
    for step in 0..10 {
        foam.step().unwrap();
        let surface = films::take(foam.world_mut());
        check_all(&surface).unwrap_or_else(|violation| panic!("step {step}: {violation}"));
        films::put_back(foam.world_mut(), surface);
    }
}

#[test]
fn a_force_of_ones_own_moves_a_bubble_that_has_mass() {
    let bubble = r#"[ Sphere(radius: "3 cm"), Film(thickness: Uniform("400 nm")) ]"#;
    let mut bubble = simulation(bubble, r#"GeometricFlow(motion: Inertial())"#);
    let push = |mut films: Query<&mut ExternalAcceleration, With<MeshVertex>>| {
        films.iter_mut().for_each(|mut acceleration| acceleration.0.x += 2.0);
    };
    bubble.add_force("push", push);
    bubble.advance_to(0.1).unwrap();
    let places = bubble.column::<MeshVertex, Position>();
    let centre = places.iter().map(|x| x.0.x).sum::<f64>() / places.len() as f64;
    // x = a t^2 / 2; symplectic and backward Euler are off by a dt t / 2.
    assert!((centre - 0.01).abs() < 0.002, "{centre}");
}

#[test]
fn a_wire_carries_the_rim_that_lies_on_it() {
    let scene = r#"
        [ Catenoid(radius: "3 cm", gap: "3 cm"), Film(thickness: Uniform("300 nm")) ],
        [ Wire(path: Ring(centre: (0, "1.5 cm", 0), axis: (0, 1, 0), radius: "3 cm")), Moves(velocity: (0, 0.05, 0)) ],
    "#;
    let mut film = simulation(scene, "GeometricFlow()");
    film.advance_to(0.04).unwrap();
    let places = film.column::<MeshVertex, Position>();
    let pins = film.column::<MeshVertex, Pinned>();
    let held = |pin: u64| places.iter().zip(&pins).filter(move |(_, p)| p.0 == pin).map(|(x, _)| x.0.y);
    let on_rim = |y: f64| (y - 0.017).abs() < 1e-12;
    // The rim and the tip of the lid behind it, a ring's radius beyond.
    let on_tip = |y: f64| (y - 0.047).abs() < 1e-12;
    assert!(held(2).filter(|y| on_rim(*y)).count() > 10 && held(2).all(|y| on_rim(y) || on_tip(y)));
    assert!(held(1).any(|y| (y + 0.015).abs() < 1e-12));
}

#[test]
fn a_bubble_that_no_step_can_keep_is_a_fault_with_its_region() {
    let mut bubble = simulation(r#"[ Sphere(radius: "3 cm"), Film(thickness: Uniform("400 nm")) ]"#, "GeometricFlow()");
    let targets = &mut bubble.world_mut().resource_mut::<froth_systems::bubbles::gas::BubbleGas>().targets;
    targets.values_mut().for_each(|volume| *volume *= 1e-9);
    let error = bubble.step().unwrap_err().to_string();
    assert!(error.contains("geometric flow") && error.contains("region 1"), "{error}");
}

#[test]
fn a_bubble_of_free_volume_shrinks_as_its_tension_likes() {
    let bubble = r#"[ Sphere(radius: "3 cm"), Film(thickness: Uniform("400 nm")) ]"#;
    let mut bubble = simulation(bubble, r#"GeometricFlow(volume: Free, time_step: "0.5 ms")"#);
    bubble.advance_to(0.02).unwrap();
    let places = bubble.column::<MeshVertex, Position>();
    let radius = places.iter().map(|x| x.0.length()).sum::<f64>() / places.len() as f64;
    // u = M 4 sigma/R: R^2 = R0^2 - 8 sigma M t, with the default mobility 0.1 m/(s Pa) and 30 mN/m.
    let expected = (0.03_f64.powi(2) - 8.0 * 0.03 * 0.1 * 0.02).sqrt();
    assert!((radius / expected - 1.0).abs() < 0.02, "{radius} {expected}");
}

columns! {
    /// A number that is a name.
    pub struct Batch(u64), "batch", "1";
}

#[test]
fn whole_numbers_are_handed_on_where_films_are_held() {
    let text = r#"Scene(title: "t", method: GeometricFlow(remesh: (longest: 1.01, shortest: 0.5)), resolution: Spacing("6 mm"),
        duration: "1 s", entities: [[ Catenoid(radius: "3 cm", gap: "3 cm"), Film(thickness: Uniform("300 nm")) ]])"#;
    let mut film = Simulation::builder().column::<MeshVertex, Batch>().build_from_text("film.ron", text).unwrap();
    let before = film.column::<MeshVertex, Batch>().len();
    film.set_column::<MeshVertex, Batch>(&vec![Batch(7); before]);
    for _ in 0..3 {
        film.step().unwrap();
    }
    let after = film.column::<MeshVertex, Batch>();
    assert!(after.len() > before && after.iter().all(|batch| batch.0 == 7), "{before} {}", after.len());
    let held = film.column::<MeshVertex, Pinned>();
    let surface = films::take(film.world_mut());
    assert!(held.iter().zip(surface.pinned.iter()).all(|(pin, held)| (pin.0 > 0) == *held));
}

#[test]
fn the_cell_in_the_middle_of_kelvins_foam_bends_its_walls_below_their_flat_area() {
    let scene = froth::gallery::built_in("kelvin").unwrap();
    let mut foam = Simulation::builder().build_from_text("kelvin.ron", scene.text).unwrap();
    let mut quotients = Vec::new();
    while foam.time() < 0.004 {
        foam.step().unwrap();
        let observed = |name| foam.observables().get(name).unwrap();
        quotients.push(observed("area_14") / observed("volume_14").powf(2.0 / 3.0));
    }
    let least = quotients.iter().copied().fold(f64::INFINITY, f64::min);
    // 3 (1 + 2 sqrt 3) / 4^(2/3) with flat walls; the first step is short and lets it fall by less than a thousandth.
    let flat = 3.0 * (1.0 + 2.0 * 3.0_f64.sqrt()) / 4.0_f64.powf(2.0 / 3.0);
    assert!((quotients[0] / flat - 1.0).abs() < 1e-3, "{quotients:?}");
    // Below Kelvin's foam without end, 5.306, as neighbours give way; then the skin squeezes it.
    assert!((5.298..5.304).contains(&least), "{quotients:?}");
    assert!(*quotients.last().unwrap() > least + 0.002, "{quotients:?}");
}

/// Least angles of a run, degrees: those of films' own corners and of others, seen after every motion and after every remeshing.
#[derive(Resource)]
struct Least(LeastAngles);

fn look_at_angles(world: &mut World) {
    let surface = films::take(world);
    let least = surface.mesh.faces().filter(|(_, face)| !face.is_ghost());
    let least = least.fold(world.resource::<Least>().0, |least, (row, _)| least.with_face_of(&surface, row));
    films::put_back(world, surface);
    world.insert_resource(Least(least));
}

#[test]
fn a_step_ends_early_where_faces_would_go_flat_and_the_next_goes_on() {
    let bubbles =
        r#"[ SphereLattice(radius: "5.3 cm", gap: "2.1 mm", counts: (2, 1, 1)), Film(thickness: Uniform("400 nm")) ]"#;
    let mut foam = simulation(bubbles, "GeometricFlow(remesh: (snap: 0.49))");
    (0..5).for_each(|_| _ = foam.step().unwrap());
    foam.world_mut().insert_resource(Least(LeastAngles::NONE));
    foam.add_system(Stage::Deform, "look at angles after motion", look_at_angles, Requires::nothing());
    foam.add_system(Stage::Topology, "look at angles after remeshing", look_at_angles, Requires::nothing());
    let (mut cut, mut steps, mut time) = (0, 0, foam.time());
    while foam.time() < 0.5 {
        let report = foam.step().unwrap();
        assert_eq!((report.time, report.step_length), (foam.time(), foam.observables().get("step_length").unwrap()));
        assert!(report.time > time && (report.time - time - report.step_length).abs() < 1e-12);
        (cut, steps, time) = (cut + usize::from(report.limited_by == Some("shapes of faces")), steps + 1, report.time);
    }
    let least = foam.world().resource::<Least>().0;
    let degrees = [least.own, least.rest].map(f64::to_degrees);
    assert!(cut > 0 && degrees[1] > 20.0, "{cut} of {steps}: {degrees:?}");
}

#[test]
fn a_bubble_that_is_not_there_cannot_burst() {
    let scene = |regions: &str| {
        let burst = format!(r#"{LATTICE}, [ Burst(every: "1 ms", order: Sequence({regions})) ]"#);
        format!(
            r#"Scene(title: "t", method: GeometricFlow(), resolution: Spacing("8 mm"), duration: "1 s", entities: [{burst}])"#
        )
    };
    assert!(Simulation::from_scene_text(&scene("[8, 1]")).is_ok());
    let Err(BuildError::Scene(error)) = Simulation::from_scene_text(&scene("[8, 9]")).map(|_| ()) else {
        panic!("no error of the scene")
    };
    assert_eq!(error.stable_code(), "F0069");
    assert!(error.to_string().contains("region 9 is to burst; the bubbles are 1 to 8"), "{error}");
}

#[test]
fn a_bubble_is_rounder_where_new_vertices_go_to_the_smooth_film() {
    let off_round = |placement: &str| {
        let bubble = r#"[ Sphere(radius: "3 cm"), Film(thickness: Uniform("400 nm")), Volumes(of: ["500 ml"], within: "0.1 s") ]"#;
        let mut bubble =
            simulation(bubble, &format!("GeometricFlow(remesh: (smoothing: false, placement: {placement}))"));
        let (before, mut farthest) = (bubble.column::<MeshVertex, Position>().len(), 0.0_f64);
        while bubble.time() < 0.1 {
            bubble.step().unwrap();
            let distances: Vec<f64> = bubble.column::<MeshVertex, Position>().iter().map(|x| x.0.length()).collect();
            let mean = distances.iter().sum::<f64>() / distances.len() as f64;
            farthest = distances.iter().map(|r| (r / mean - 1.0).abs()).fold(farthest, f64::max);
        }
        assert!(bubble.column::<MeshVertex, Position>().len() > before, "edges should have been split");
        farthest
    };
    let (flat, round) = (off_round("Midpoint"), off_round("Butterfly"));
    assert!(round < 0.8 * flat, "{round:e} {flat:e}");
}
