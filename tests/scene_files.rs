//! A scene file becomes entities and settings, and nothing in a file makes the loader panic.

use bevy_ecs::component::Component;
use bevy_ecs::world::World;
use froth::scene::{AuthoredRegistry, Rows, Scene};
use froth_components::authored::burst::{Burst, BurstOrder};
use froth_components::authored::field::{Gravity, Hover};
use froth_components::authored::film::{Film, SurfactantField, ThicknessField};
use froth_components::authored::film_shape::FilmShape;
use froth_components::authored::liquid::{Atmosphere, Liquid};
use froth_components::authored::mesh_shape::{MeshFile, MeshShape};
use froth_components::authored::method::{
    AirInertia, Contact, FilmMotion, Gas, GeometricFlowSettings, Mass, MelpSettings, MethodChoice, Overdamped, Remesh,
    TensionScheme, VolumeRule,
};
use froth_components::authored::perturbation::Bumps;
use froth_components::authored::shape::Sphere;
use froth_components::authored::wire::{Wire, WirePath};
use froth_components::authored::{Name, PlaceInScene};
use froth_components::quantity::{MassPerArea, Mobility, Ratio};
use glam::DVec3;
use proptest::prelude::*;

const MEMORY: u64 = 8 << 30;

const GIANT_BUBBLE: &str = r#"Scene(title: "A giant bubble", method: Melp(cfl: 0.99), resolution: Particles(4000), duration: "2 s", frames_per_second: 50,
 entities: [ [ Name("bubble"), Sphere(radius: "10 cm"), Bumps(amplitude: 0.06), Film(thickness: Noise(mean: "425 nm", relative: 0.15, frequency: 5)) ], [ Gravity((0.0,-9.81,0.0)) ], [ Hover() ] ])"#;

/// Every built-in component and every setting, each field given.
const EVERYTHING: &str = r#"
// What a scene can say.
Scene(
    title: "Everything",
    method: Melp(cfl: 0.5, liquid_per_carrier: 12, air: Fixed("50 g/m^2"), gas: Adiabatic(1.4), transfer: Plain, flip: "95 %", xsph: 0.1),
    resolution: Spacing("5 mm"),
    duration: "1 min",
    frames_per_second: "25 Hz",
    seed: 7,
    liquid: (density: "1 g/cm^3", surface_tension: "25 mN/m", elasticity: "40 mN/m", viscosity: "1 mm^2/s", temperature: "25 degC"),
    atmosphere: Atmosphere(pressure: "1 atm", density: 1.2),
    maximum_step: "5 ms",
    picture: Picture(width: 640, light: (1, 2, 3)),
    entities: [
        [ Name("a"), Sphere(centre: (0.0, "5 cm", 0), radius: 0.1), Film(thickness: Uniform("500 nm")), Drift((0.1, 0, "-1 cm/s")) ],
        [ Ellipsoid(radii: ("10 cm", "10 cm", "20 cm")), Bumps(), Film(thickness: Gradient(from: "1 um", to: "300 nm", direction: (0, 2, 0), noise: (relative: 0.1))) ],
        [ HalfSphere(radius: "8 cm", up: (0, 1, 0)), HarmonicMode(degree: 3, order: -3, amplitude: 0.05), Film(thickness: Wave(mean: "400 nm", wavelengths: 3, phase: "90 deg"), surfactant: WithThickness, warmth: 0.5) ],
        [ Disc(radius: "8 cm"), Film(thickness: Noise(mean: "400 nm", octaves: 3, seed: 5)), Spin(rate: "1 rpm"), Swirl(speed: "5 cm/s") ],
        [ Rectangle(width: "20 cm", height: "10 cm"), Film(thickness: Uniform("400 nm")), Swirl(pattern: Harmonic(degree: 2), speed: 0.05) ],
        [ Hexagon(radius: "5 cm"), Film(thickness: Uniform("400 nm")) ],
        [ Gravity([(t: 0, v: (0, 0, 0)), (t: "1 s", v: (0.0, "-9.81 m/s^2", 0.0))]) ],
        [ Wind(velocity: (1, 0, 0), drag: "2 1/s") ],
        [ HeatSource(position: (0, "-10 cm", 0), radius: "5 cm", warming: "100 ms", cooling: 0.6, expansion: 0.3) ],
        [ Sweep(pressure: [(t: 0, v: 0), (t: 1, v: "1 Pa")], width: "2 cm", speed: "0.1 m/s", start: "-10 cm") ],
        [ AirDrag(rate: 0.5) ], [ Hover ],
    ],
)
"#;

/// The same for what takes a mesh.
const EVERYTHING_ON_MESH: &str = r#"
Scene(
    title: "Everything on a mesh",
    method: GeometricFlow(
        motion: Inertial(mass: PerArea("1 g/m^2"), air: Fixed("2 g/m^2"), damping: "3 1/s"),
        tension: Explicit, cfl: 0.1, time_step: "1 ms", volume: Free,
        remesh: Remesh(enabled: true, flips: false, smoothing: false, topology: false, contact: Bounce, snap: 0.2, shortest: 0.4, longest: 1.2),
    ),
    resolution: Spacing("1 mm"),
    duration: "1 s",
    entities: [
        [ Name("cube"), Cube(centre: (0, "1 m", 0), side: "2 cm"), Film(thickness: Uniform("500 nm")), Bumps(), Drift((0.1, 0, 0)) ],
        [ DoubleBubble(axis: (0, 1, 0), radii: ("2 cm", "1 cm")), Film(thickness: Uniform("500 nm")), Name("pair"), Volumes(of: ["30 ml", "5 ml"], within: "0.1 s"), Tension("20 mN/m") ],
        [ TripleBubble(axis: (0, 1, 0), radius: "1 cm"), Stretch((1.25, 1, 0.8)), Film(thickness: Uniform("500 nm")) ],
        [ QuadrupleBubble(radius: "1 cm"), Film(thickness: Uniform("500 nm")) ],
        [ KelvinCells(size: "1 cm", count: 3), Film(thickness: Uniform("500 nm")) ],
        [ Lattice(cell: "1 cm", counts: (5, 5, 5)), Film(thickness: Uniform("500 nm")) ],
        [ SphereLattice(radius: "1 cm", gap: "1 mm", counts: (2, 2, 2)), Film(thickness: Uniform("500 nm")) ],
        [ Packing(count: 30, radius: "1 cm", spread: 0.3, seed: 5), Film(thickness: Uniform("500 nm")) ],
        [ Catenoid(axis: (0, 1, 0), radius: "3 cm", gap: "2 cm"), Film(thickness: Uniform("500 nm")) ],
        [ WireFrame(kind: Tetrahedron, edge: "5 cm"), Film(thickness: Uniform("500 nm")), Moves(velocity: (0, 0.1, 0)) ],
        [ MeshFile(path: "tetrahedron.obj", scale: 0.01, centre: (1, 2, 3)), Film(thickness: Uniform("500 nm")) ],
        [ Wire(path: Ring(centre: (0, "1 cm", 0), axis: (0, 1, 0), radius: "3 cm"), holds: "pair", feeds: "500 nm"), Moves(velocity: [(t: 0, v: (0, 0, 0)), (t: 1, v: (0, 0.01, 0))]) ],
        [ Wire(path: Line(points: [(0, 0, 0), (0, 0, 1), (0, 1, 1)], closed: true)) ],
        [ Burst(every: "0.1 s", first: 0.5, order: Sequence([3, 1, 2])) ],
        [ Burst(every: 1, order: Random(seed: 7)) ], [ Burst(every: 1, order: Smallest) ], [ Burst(every: 1, order: Largest) ],
    ],
)
"#;

fn read(text: &str) -> Scene {
    Scene::from_text("tests/meshes/scene.ron", text, &AuthoredRegistry::built_in())
        .unwrap_or_else(|fault| panic!("{fault} at {:?}", fault.place()))
}

#[test]
fn a_giant_bubble_becomes_components() {
    let scene = read(GIANT_BUBBLE);
    let estimate = scene.check(MEMORY).unwrap();
    assert_eq!(estimate.rows, Rows::Particles { eulerian: 4000, lagrangian: 64_000, boundary: 0 });

    let mut world = World::new();
    let entities = scene.spawn_into(&mut world);
    let bubble = world.entity(entities[0]);
    assert_eq!(bubble.get::<Name>().unwrap().0, "bubble");
    assert_eq!(bubble.get::<Sphere>().unwrap().radius.si(), 0.1);
    assert_eq!(bubble.get::<Bumps>(), Some(&Bumps::default()));
    let film = bubble.get::<Film>().unwrap();
    let ThicknessField::Noise(noise) = film.thickness else { panic!("{film:?}") };
    assert!((noise.mean.si() - 425e-9).abs() < 1e-20);
    assert_eq!((noise.octaves, noise.seed, film.surfactant), (2, None, SurfactantField::Uniform));
    assert_eq!(world.entity(entities[1]).get::<Gravity>().unwrap().0.at(1.0).si(), DVec3::new(0.0, -9.81, 0.0));
    assert!(world.entity(entities[2]).contains::<Hover>());
    assert_eq!(world.entity(entities[2]).get::<PlaceInScene>(), Some(&PlaceInScene(2)));
}

#[test]
fn everything_a_scene_can_say_is_read() {
    let scene = read(EVERYTHING);
    scene.check(MEMORY).unwrap();
    let header = &scene.header;
    let MethodChoice::Melp(melp) = header.method else { panic!("{:?}", header.method) };
    assert_eq!(melp.air, AirInertia::Fixed(MassPerArea::from_si(0.05)));
    assert_eq!(melp.gas, Gas::Adiabatic(Ratio::from_si(1.4)));
    assert_eq!((header.seed, header.duration.si(), header.maximum_step.map(|step| step.si())), (7, 60.0, Some(0.005)));
    assert_eq!(header.liquid.temperature.si(), 298.15);
    let on_mesh = read(EVERYTHING_ON_MESH);
    on_mesh.check(MEMORY).unwrap();
    let entities = scene.entities().iter().chain(on_mesh.entities());
    let named: Vec<&str> = entities.flat_map(|entity| entity.component_names()).collect();
    for component in AuthoredRegistry::built_in().iter() {
        assert!(named.contains(&component.name), "{} is not in the scene", component.name);
        assert!(!component.summary.is_empty());
    }
}

#[test]
fn what_is_left_out_has_its_documented_default() {
    let scene = read(r#"Scene(title: "", method: Melp, resolution: Particles(1e3), duration: 1, entities: [])"#);
    assert_eq!(scene.header.method, MethodChoice::Melp(MelpSettings::default()));
    assert_eq!((scene.header.liquid, scene.header.atmosphere), (Liquid::default(), Atmosphere::default()));
    assert_eq!((scene.header.frames_per_second.si(), scene.header.seed, scene.header.maximum_step), (50.0, 0, None));
    assert!(scene.picture().is_none());
}

#[test]
fn geometric_flow_has_its_documented_defaults() {
    let text = r#"Scene(title: "", method: GeometricFlow, resolution: Vertices(1e3), duration: 1, entities: [])"#;
    let MethodChoice::GeometricFlow(flow) = read(text).header.method else { panic!("not geometric flow") };
    assert_eq!(flow, GeometricFlowSettings::default());
    assert_eq!(flow.motion, FilmMotion::Overdamped(Overdamped { mobility: Mobility::from_si(0.1) }));
    assert_eq!((flow.tension, flow.volume), (TensionScheme::Implicit, VolumeRule::Constrained));
    assert_eq!((flow.cfl.si(), flow.time_step, flow.remesh), (0.25, None, Remesh::default()));
}

#[test]
fn everything_of_a_mesh_is_read() {
    let scene = read(EVERYTHING_ON_MESH);
    let MethodChoice::GeometricFlow(flow) = scene.header.method else { panic!("{:?}", scene.header.method) };
    let FilmMotion::Inertial(inertia) = flow.motion else { panic!("{:?}", flow.motion) };
    assert_eq!(inertia.mass, Mass::PerArea(MassPerArea::from_si(1e-3)));
    assert_eq!((inertia.air, inertia.damping.si()), (AirInertia::Fixed(MassPerArea::from_si(2e-3)), 3.0));
    assert_eq!((flow.tension, flow.volume), (TensionScheme::Explicit, VolumeRule::Free));
    assert_eq!(flow.time_step.map(|step| step.si()), Some(1e-3));
    assert_eq!((flow.remesh.contact, flow.remesh.flips), (Contact::Bounce, false));
    let mut world = World::new();
    let entities = scene.spawn_into(&mut world);
    let shapes = entities.iter().filter_map(|entity| FilmShape::of(&world.entity(*entity)));
    assert_eq!(shapes.count(), MeshShape::NAMES.len());
    let wires: Vec<&Wire> = world.query::<&Wire>().iter(&world).collect();
    let is_ring = |wire: &Wire| matches!(&wire.path, WirePath::Ring(ring) if ring.radius.si() == 0.03);
    assert!(wires.len() == 2 && wires.iter().any(|wire| is_ring(wire) && wire.holds.as_deref() == Some("pair")));
    let mesh = world.query::<&MeshFile>().single(&world).unwrap();
    assert_eq!(mesh.bytes(), include_bytes!("meshes/tetrahedron.obj"));
    let shape = FilmShape::Mesh(MeshShape::MeshFile(mesh.clone()));
    assert!((shape.area() / (1.5 + 0.75_f64.sqrt()) - 1e-4).abs() < 1e-12);
    assert!((shape.centre() - DVec3::new(1.005, 2.005, 3.005)).length() < 1e-12);
    let bursts: Vec<&Burst> = world.query::<&Burst>().iter(&world).collect();
    assert!(matches!(&bursts[0].order, BurstOrder::Sequence(regions) if regions.get() == [3, 1, 2]));
}

#[test]
fn the_estimate_of_a_mesh_counts_the_vertices_of_equilateral_triangles() {
    let lattice = |resolution: &str| {
        read(&format!(
            r#"Scene(title: "", method: GeometricFlow(), resolution: {resolution}, duration: 1, entities: [
            [ Lattice(cell: "1 cm", counts: (5, 5, 5)), Film(thickness: Uniform("400 nm")) ] ])"#
        ))
    };
    // 3 x 6 x 5 x 5 walls of 1 cm^2, and a vertex per sqrt(3)/2 of an edge squared.
    let vertices = (450.0 / (0.75_f64.sqrt() * 0.25)).round() as u64;
    let fine = lattice("Spacing(\"5 mm\")");
    let estimate = fine.check(MEMORY).unwrap();
    assert_eq!(estimate.rows, Rows::Mesh { vertices, faces: 2 * vertices });
    assert_eq!(estimate.bytes, vertices * froth::scene::BYTES_PER_VERTEX);
    let same = lattice(&format!("Vertices({vertices})")).check(MEMORY).unwrap();
    assert!((same.spacing / 0.005 - 1.0).abs() < 1e-3 && same.carriers() == vertices);
    assert_eq!(fine.check(estimate.bytes - 1).unwrap_err().stable_code(), "F0051");
    assert_eq!(lattice("Spacing(\"6 mm\")").check(MEMORY).unwrap_err().stable_code(), "F0050");
}

#[test]
fn a_mesh_file_brings_its_vertices_along() {
    let scene = read(
        r#"Scene(title: "", method: GeometricFlow(), resolution: Spacing("1 cm"), duration: 1, entities: [
        [ MeshFile(path: "tetrahedron.obj", scale: 1e-4), Film(thickness: Uniform("400 nm")) ] ])"#,
    );
    assert_eq!(scene.estimate().rows, Rows::Mesh { vertices: 4, faces: 8 });
}

#[test]
fn no_air_is_a_choice_and_not_a_missing_value() {
    let scene = read(&GIANT_BUBBLE.replace("cfl: 0.99", "air: None"));
    let MethodChoice::Melp(melp) = scene.header.method else { panic!("{:?}", scene.header.method) };
    assert_eq!(melp.air, AirInertia::None);
}

#[test]
fn the_picture_is_read_by_whoever_draws_it_and_faults_point_into_the_scene() {
    #[derive(serde::Deserialize, Debug)]
    #[serde(deny_unknown_fields)]
    struct Picture {
        width: u32,
        light: (f64, f64, f64),
    }
    let picture: Picture = read(EVERYTHING).picture().unwrap().read().unwrap();
    assert_eq!((picture.width, picture.light), (640, (1.0, 2.0, 3.0)));

    let scene = read(&EVERYTHING.replace("width: 640", "widht: 640"));
    let fault = scene.picture().unwrap().read::<Picture>().unwrap_err();
    assert_eq!(fault.stable_code(), "F0021");
    let place = fault.place().unwrap();
    let line = EVERYTHING.lines().position(|line| line.contains("width: 640")).unwrap() + 1;
    assert_eq!((place.line, place.column), (line, 22));
}

#[test]
fn a_component_of_ones_own_is_read_like_the_built_in_ones() {
    #[derive(Component, Clone, PartialEq, Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Fan {
        strength: f64,
    }
    let mut registry = AuthoredRegistry::built_in();
    registry.register::<Fan>("Fan", "blows");
    let scene =
        Scene::from_text("scene.ron", &GIANT_BUBBLE.replace("Hover()", "Fan(strength: 2.5)"), &registry).unwrap();
    scene.check(MEMORY).unwrap();
    let mut world = World::new();
    let entities = scene.spawn_into(&mut world);
    assert_eq!(world.entity(entities[2]).get::<Fan>(), Some(&Fan { strength: 2.5 }));
}

#[test]
fn the_estimate_follows_from_areas_and_rims() {
    let scene = read(
        r#"Scene(title: "", method: Melp(liquid_per_carrier: 10), resolution: Spacing("1 cm"), duration: 1, entities: [
        [ Rectangle(width: "1 m", height: "50 cm"), Film(thickness: Uniform("400 nm")) ] ])"#,
    );
    let estimate = scene.estimate();
    assert_eq!(estimate.rows, Rows::Particles { eulerian: 5000, lagrangian: 50_000, boundary: 1500 });
    let bytes = 6500 * froth::scene::BYTES_PER_EULERIAN + 50_000 * froth::scene::BYTES_PER_LAGRANGIAN;
    assert_eq!(estimate.bytes, bytes);
    assert!(scene.check(bytes).is_ok());
    assert_eq!(scene.check(bytes - 1).unwrap_err().stable_code(), "F0051");
}

#[test]
fn a_byte_order_mark_and_carriage_returns_do_not_matter() {
    let scene = read(&format!("\u{feff}{}", EVERYTHING.replace('\n', "\r\n")));
    scene.check(MEMORY).unwrap();
}

/// Reads, checks, and shows the fault: all of it must go through for any bytes.
fn go_through(bytes: &[u8]) {
    let scene = Scene::from_bytes("tests/meshes/any.ron", bytes, &AuthoredRegistry::built_in());
    if let Err(fault) = scene.and_then(|scene| scene.check(MEMORY)) {
        assert!(!fault.stable_code().is_empty());
        let shown = format!("{:?}", miette::Report::new(fault));
        assert!(shown.len() < 100_000, "{} bytes of message", shown.len());
    }
}

/// Files of full length, each made to be slow or large in another way. Quadratic work anywhere would be noticed: minutes, not seconds.
#[test]
fn a_hostile_file_of_full_length_is_answered() {
    let entities = GIANT_BUBBLE.find("[ [").unwrap() + 1;
    for filling in [
        "(",
        "[",
        "[],",
        "[0],",
        "[0,0,0,0,0,0,0,0],",
        "\"",
        "/*",
        "/**/",
        "// x\n",
        "a",
        "A(b:",
        "a:",
        "r#",
        "'",
        "\n",
        "é",
        "1",
    ] {
        let repeats = (froth::scene::LONGEST_FILE as usize - GIANT_BUBBLE.len()) / filling.len();
        let mut text = GIANT_BUBBLE.to_owned();
        text.insert_str(entities, &filling.repeat(repeats));
        go_through(text.as_bytes());
    }
}

/// Pieces that a mutation writes into a scene: brackets, quotes, comments, names, extreme numbers.
const PIECES: [&str; 32] = [
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    ",",
    ":",
    "\"",
    "'",
    "/*",
    "*/",
    "//",
    "\\",
    "r#\"",
    "b\"",
    "-",
    "1e999",
    "NaN",
    "inf",
    "0x",
    "..",
    "None",
    "Some(",
    "#![enable(unwrap_newtypes)]",
    "Sphere(",
    "Gravity((0,0,0))",
    "18446744073709551616",
    "1e-320",
    "\u{2028}",
    "é",
    "\r\n",
];

proptest! {
    // A failure here is kept as a test of its own, by hand.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        go_through(&bytes);
    }

    #[test]
    fn no_text_panics(text in "[\\PC\n]{0,200}") {
        go_through(text.as_bytes());
    }

    #[test]
    fn no_mutated_scene_panics(
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..6_usize, prop::sample::select(&PIECES[..])), 1..6),
        text in prop::sample::select(&[GIANT_BUBBLE, EVERYTHING, EVERYTHING_ON_MESH][..]),
    ) {
        let mut bytes = text.as_bytes().to_vec();
        for (place, removed, piece) in edits {
            let start = place.index(bytes.len());
            let end = (start + removed).min(bytes.len());
            bytes.splice(start..end, piece.bytes());
        }
        go_through(&bytes);
    }

    #[test]
    fn no_cut_scene_panics(length in 0..EVERYTHING.len()) {
        go_through(&EVERYTHING.as_bytes()[..length]);
    }
}

#[test]
fn the_scenes_of_the_readme_can_be_simulated() {
    let readme = include_str!("../README.md");
    let scenes: Vec<&str> = readme.split("```ron\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert!(!scenes.is_empty());
    for text in scenes {
        read(text).check(MEMORY).unwrap();
    }
}
