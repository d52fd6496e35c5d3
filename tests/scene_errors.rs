//! Each fault of a scene file has its own message, which says what is wrong, where, and what to write instead.
//!
//! The messages are snapshots, as a terminal of 100 columns shows them. Codes and pages are held to each other in `scene_error_pages`.

use std::fs;

use froth::Simulation;
use froth::errors::error_page;
use froth::method::{Method, melp};
use froth::scene::{AuthoredRegistry, MeshFault, MeshFaultKind, Scene, SceneError};
use froth::simulation::BuildError;
use froth_components::authored::PlaceInScene;
use froth_components::authored::method::MethodName;
use miette::{GraphicalReportHandler, GraphicalTheme};

/// Enough for every scene here, and the same on every machine, bytes.
const MEMORY: u64 = 8 << 30;

const SCENE: &str = r#"Scene(
    title: "A giant bubble",
    method: Melp(cfl: 0.99),
    resolution: Particles(4000),
    duration: "2 s",
    frames_per_second: 50,
    entities: [
        [
            Name("bubble"),
            Sphere(radius: "10 cm"),
            Bumps(amplitude: 0.06),
            Film(thickness: Noise(mean: "425 nm", relative: 0.15, frequency: 5)),
        ],
        [ Gravity((0.0, -9.81, 0.0)) ],
        [ Hover() ],
    ],
)
"#;

const FOAM: &str = r#"Scene(
    title: "Bubbles",
    method: GeometricFlow(cfl: 0.25),
    resolution: Spacing("2 mm"),
    duration: "2 s",
    entities: [
        [ Name("pair"), DoubleBubble(radii: ("2 cm", "3 cm")), Film(thickness: Uniform("400 nm")) ],
        [ Wire(path: Ring(axis: (1, 0, 0), radius: "1 cm"), holds: "pair"), Moves(velocity: (0.01, 0, 0)) ],
        [ Burst(every: "1 s", order: Sequence([2, 1])) ],
    ],
)
"#;

/// The foam with one piece replaced.
fn foam(piece: &str, by: &str) -> String {
    assert_eq!(FOAM.matches(piece).count(), 1, "`{piece}` must be in the scene once");
    FOAM.replace(piece, by)
}

/// The foam as vortex sheets with a setting.
fn sheet(setting: &str) -> String {
    foam("GeometricFlow(cfl: 0.25)", &format!("VortexSheet({setting})"))
}

/// The scene with one piece replaced.
fn broken(piece: &str, by: &str) -> String {
    assert_eq!(SCENE.matches(piece).count(), 1, "`{piece}` must be in the scene once");
    SCENE.replace(piece, by)
}

fn fault_of_bytes(bytes: &[u8]) -> SceneError {
    let scene = Scene::from_bytes("scene.ron", bytes, &AuthoredRegistry::built_in());
    scene.and_then(|scene| scene.check(MEMORY)).expect_err("the scene is broken")
}

/// The message as a terminal shows it. Every code has a page.
fn shown(error: &SceneError) -> String {
    let code = error.stable_code();
    assert!(error_page(&code).is_some(), "no page for {code}");
    let mut message = String::new();
    let handler = GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor()).with_width(100);
    handler.render_report(&mut message, error).unwrap();
    message
}

macro_rules! faults {
    ($($name:ident: $text:expr;)*) => {$(
        #[test]
        fn $name() {
            insta::assert_snapshot!(stringify!($name), shown(&fault_of_bytes($text.as_ref())));
        }
    )*};
}

faults! {
    an_empty_file: "\n// nothing\n";
    a_binary_file: b"\x7fELF\x02\x01\x01\x00";
    text_that_is_no_utf8: b"Scene(title: \"caf\xe9\")";
    a_file_that_is_no_ron: "film { radius = 5 }";
    a_missing_comma: broken("duration: \"2 s\",", "duration: \"2 s\"");
    a_bracket_that_is_never_closed: SCENE.trim_end().trim_end_matches(')');
    a_text_that_is_never_closed: broken("\"A giant bubble\"", "\"A giant bubble");
    nesting_to_ten_thousand_levels: broken("(0.0, -9.81, 0.0)", &format!("{}0{}", "(".repeat(10_000), ")".repeat(10_000)));
    nesting_of_lists_to_ten_thousand_levels: "[".repeat(10_000);

    an_unknown_component: broken("Sphere(", "Spere(");
    an_unknown_field: broken("radius:", "radios:");
    an_unknown_field_of_the_header: broken("duration:", "durration:");
    an_unknown_field_of_a_setting: broken("cfl:", "clf:");
    an_unknown_field_deep_inside: broken("relative:", "relativ:");
    an_unknown_field_without_a_name_before_it: broken("duration", "liquid: (densitty: 1000), duration");
    an_unknown_choice: broken("Noise(mean: \"425 nm\", relative: 0.15, frequency: 5)", "Unifrom(\"425 nm\")");
    an_unknown_method: broken("Melp(", "Mlep(");
    a_method_to_come: broken("Melp(cfl: 0.99)", "VortexParticle()");
    a_missing_field: broken("radius: \"10 cm\"", "centre: (0, 0, 0)");
    a_missing_field_of_the_header: broken("resolution: Particles(4000),", "");
    a_field_given_twice: broken("amplitude: 0.06", "amplitude: 0.06, amplitude: 0.07");
    a_component_given_twice: broken("Bumps(amplitude: 0.06)", "Sphere(radius: \"5 cm\")");

    a_wrong_type: broken("\"10 cm\"", "true");
    a_name_for_a_number: broken("\"10 cm\"", "large");
    a_number_for_a_title: broken("\"A giant bubble\"", "5");
    a_vector_of_two: broken("(0.0, -9.81, 0.0)", "(0.0, -9.81)");
    a_number_for_a_vector: broken("Gravity((0.0, -9.81, 0.0))", "Gravity(9.81)");
    a_component_that_is_a_number: broken("Hover()", "5");
    a_method_that_is_a_text: broken("Melp(cfl: 0.99)", "\"melp\"");
    text_without_a_number: broken("\"10 cm\"", "\"wide\"");
    a_fraction_of_a_particle: broken("4000", "4000.5");
    a_negative_seed: broken("duration", "seed: -1, duration");
    an_unknown_unit: broken("425 nm", "425 nmm");
    a_wrong_dimension: broken("10 cm", "5 kg");
    a_missing_unit: broken("10 cm", "10");
    a_negative_radius: broken("\"10 cm\"", "-0.05");
    a_zero_radius: broken("\"10 cm\"", "0");
    a_negative_half_axis: broken("Sphere(radius: \"10 cm\")", "Ellipsoid(radii: (\"5 cm\", \"-5 cm\", \"5 cm\"))");
    no_thickness: broken("\"425 nm\"", "0.0");
    a_thickness_in_metres: broken("\"425 nm\"", "425");
    not_a_number: broken("\"10 cm\"", "NaN");
    an_infinite_radius: broken("\"10 cm\"", "inf");
    an_overflowing_radius: broken("10 cm", "1e400 cm");
    an_infinite_part_of_a_vector: broken("-9.81", "-1e999");
    no_direction: broken("Gravity((0.0, -9.81, 0.0))", "Sweep(pressure: 1, width: 1, speed: 1, direction: (0, 0, 0))");
    keyframes_out_of_order: broken("(0.0, -9.81, 0.0)", "[(t: 1, v: (0, 0, 0)), (t: \"0.5 s\", v: (0, -9.81, 0))]");
    an_order_above_the_degree: broken("Bumps(amplitude: 0.06)", "HarmonicMode(degree: 2, order: 3, amplitude: 0.1)");
    no_particles: broken("4000", "0");

    no_film: "Scene(title: \"\", method: Melp(), resolution: Particles(100), duration: 1, entities: [[ Hover() ]])";
    a_film_without_a_shape: broken("Sphere(radius: \"10 cm\"),", "").replace("Bumps(amplitude: 0.06),", "");
    a_shape_without_a_film: broken("[ Hover() ]", "[ Disc(radius: 1) ]");
    bumps_without_a_shape: broken("[ Hover() ]", "[ Bumps() ]");
    a_harmonic_on_a_rectangle: broken("Sphere(radius: \"10 cm\")", "Rectangle(width: 1, height: 1)").replace("Bumps(", "HarmonicMode(degree: 2, ");
    a_film_of_two_shapes: broken("Bumps(amplitude: 0.06)", "Disc(radius: \"5 cm\")");
    a_swirl_without_liquid: broken("cfl: 0.99", "liquid_per_carrier: 0").replace("Bumps(amplitude: 0.06)", "Swirl(speed: 0.05)");
    heat_without_liquid: broken("cfl: 0.99", "liquid_per_carrier: 0").replace("Hover()", "HeatSource(position: (0, 0, 0), radius: 1)");
    a_duration_of_thirty_years: broken("2 s", "1e9 s").replace("frames_per_second: 50,", "");
    a_trillion_frames: broken("frames_per_second: 50", "frames_per_second: 1e12");
    an_ellipsoid_as_thin_as_a_wafer: broken("Sphere(radius: \"10 cm\")", "Ellipsoid(radii: (\"5 cm\", \"5 cm\", \"1 mm\"))");
    a_number_for_named_fields: broken("Hover()", "Spin(5)");
    a_vector_for_named_fields: broken("Hover()", "Spin((0.0, 5.0, 0.0))");
    a_number_for_a_thickness_field: broken("Noise(mean: \"425 nm\", relative: 0.15, frequency: 5)", "425");
    a_resolution_too_coarse: broken("Particles(4000)", "Spacing(\"5 cm\")");
    a_trillion_particles: broken("4000", "1000000000000");
    a_trillion_particles_as_a_float: broken("4000", "1e12");

    a_step_of_a_whole_edge: foam("cfl: 0.25", "cfl: 1.0");
    an_unknown_motion: foam("cfl: 0.25", "motion: Overdamp()");
    a_mobility_of_a_viscosity: foam("cfl: 0.25", "motion: Overdamped(mobility: \"1 mm^2/s\")");
    a_massless_film: foam("cfl: 0.25", "motion: Inertial(mass: PerArea(0))");
    a_time_step_of_nothing: foam("cfl: 0.25", "time_step: \"0 s\"");
    edges_that_split_into_edges_too_short: foam("cfl: 0.25", "remesh: Remesh(shortest: 0.9)");
    films_that_touch_across_an_edge: foam("cfl: 0.25", "remesh: Remesh(snap: 0.5)");
    one_radius_for_two: foam("(\"2 cm\", \"3 cm\")", "(\"2 cm\")");
    a_negative_radius_of_two: foam("\"3 cm\"", "\"-3 cm\"");
    a_lattice_of_half_a_cell: foam("DoubleBubble(radii: (\"2 cm\", \"3 cm\"))", "Lattice(cell: 0.01, counts: (5, 5, 0.5))");
    a_packing_of_a_million: foam("DoubleBubble(radii: (\"2 cm\", \"3 cm\"))", "Packing(count: 1e6, radius: 0.01)");
    an_unknown_frame: foam("DoubleBubble(radii: (\"2 cm\", \"3 cm\"))", "WireFrame(kind: Icosahedron, edge: 0.01)");
    a_wire_of_one_point: foam("Ring(axis: (1, 0, 0), radius: \"1 cm\")", "Line(points: [(0, 0, 0)])");
    a_wire_that_holds_nothing: foam("holds: \"pair\"", "holds: \"pear\"");
    a_move_of_nothing_that_is_held: foam("Name(\"pair\")", "Moves(velocity: (1, 0, 0)), Name(\"pair\")");
    a_burst_of_the_outside: foam("[2, 1]", "[2, 0]");
    a_burst_at_once_and_always: foam("every: \"1 s\"", "every: 0");
    a_drift_without_inertia: foam("Name(\"pair\")", "Name(\"pair\"), Drift((1, 0, 0))");
    a_swirl_on_a_mesh: foam("Name(\"pair\")", "Name(\"pair\"), Swirl(speed: 1)");
    a_mesh_shape_of_particles: foam("GeometricFlow(cfl: 0.25)", "Melp()");
    a_foam_too_coarse: foam("Spacing(\"2 mm\")", "Vertices(20)");
    a_foam_too_fine: foam("Spacing(\"2 mm\")", "Spacing(\"2 um\")");
    a_mesh_file_above: foam("DoubleBubble(radii: (\"2 cm\", \"3 cm\"))", "MeshFile(path: \"../foam.ply\")");
    a_mesh_file_at_the_root: foam("DoubleBubble(radii: (\"2 cm\", \"3 cm\"))", "MeshFile(path: \"/etc/passwd\")");
    a_mesh_file_that_is_a_folder: foam("DoubleBubble(radii: (\"2 cm\", \"3 cm\"))", "MeshFile(path: \"tests\")");
    a_mesh_file_with_a_slip: foam("DoubleBubble(radii: (\"2 cm\", \"3 cm\"))", "MeshFile(path: \"tests/meshes/tetrahedrn.obj\")");
    a_mesh_file_of_another_kind: foam("DoubleBubble(radii: (\"2 cm\", \"3 cm\"))", "MeshFile(path: \"Cargo.toml\")");
    a_mesh_file_with_a_bad_row: foam("DoubleBubble(radii: (\"2 cm\", \"3 cm\"))", "MeshFile(path: \"tests/meshes/no_mesh.obj\")");

    an_unknown_integrator: sheet("integrator: Verlet");
    a_smoothing_of_nothing: sheet("smoothing: 0");
    a_negative_diffusivity: sheet("diffusivity: \"-1 cm^2/s\"");
    a_sum_without_a_bound: sheet("summation: Fast(0)");
    a_step_of_no_capillary_time: sheet("courant: 0");
    a_film_without_tension: sheet("courant: 0.4").replace("duration", "liquid: (surface_tension: 0), duration");
    a_film_of_negative_tension: sheet("courant: 0.4").replace("duration", "liquid: (surface_tension: -0.03), duration");
    a_sheet_in_a_vacuum: sheet("courant: 0.4").replace("duration", "atmosphere: (density: 0), duration");
    a_drift_of_a_sheet: sheet("courant: 0.4").replace("Name(\"pair\")", "Name(\"pair\"), Drift((1, 0, 0))");

    a_spacing_of_an_atom: broken("Particles(4000)", "Spacing(\"0.1 nm\")");
}

#[test]
fn a_missing_file() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("bubble.ron"), SCENE).unwrap();
    let path = folder.path().join("buble.ron");
    let error = Scene::from_path(&path, &AuthoredRegistry::built_in()).unwrap_err();
    let message = shown(&error).replace(folder.path().to_str().unwrap(), "FOLDER");
    insta::assert_snapshot!("a_missing_file", message);
}

#[test]
fn a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let error = Scene::from_path(folder.path(), &AuthoredRegistry::built_in()).unwrap_err();
    insta::assert_snapshot!("a_folder", shown(&error).replace(folder.path().to_str().unwrap(), "FOLDER"));
}

#[test]
fn a_file_longer_than_any_scene() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.ron");
    fs::File::create(&path).unwrap().set_len(froth::scene::LONGEST_FILE + 5).unwrap();
    let error = Scene::from_path(&path, &AuthoredRegistry::built_in()).unwrap_err();
    insta::assert_snapshot!(
        "a_file_longer_than_any_scene",
        shown(&error).replace(folder.path().to_str().unwrap(), "FOLDER")
    );
}

#[cfg(unix)]
#[test]
fn a_device_is_refused_and_not_read() {
    let error = Scene::from_path("/dev/zero", &AuthoredRegistry::built_in()).unwrap_err();
    insta::assert_snapshot!("a_device", shown(&error));
}

#[test]
fn a_field_that_another_method_cannot_honour() {
    let scene = Scene::from_text("scene.ron", SCENE, &AuthoredRegistry::built_in()).unwrap();
    scene.check_honoured(MethodName::Melp).unwrap();
    let error = scene.check_honoured(MethodName::GeometricFlow).unwrap_err();
    insta::assert_snapshot!("a_field_that_another_method_cannot_honour", shown(&error));
}

#[cfg(unix)]
#[test]
fn a_mesh_file_that_links_out_of_the_folder() {
    let (folder, elsewhere) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let mesh = elsewhere.path().join("foam.obj");
    fs::copy("tests/meshes/tetrahedron.obj", &mesh).unwrap();
    let path = folder.path().join("scene.ron");
    fs::write(&path, foam("DoubleBubble(radii: (\"2 cm\", \"3 cm\"))", "MeshFile(path: \"foam.obj\")")).unwrap();
    std::os::unix::fs::symlink(&mesh, folder.path().join("foam.obj")).unwrap();
    let error = Scene::from_path(&path, &AuthoredRegistry::built_in()).unwrap_err();
    assert_eq!(error.stable_code(), "F0060");
    fs::remove_file(folder.path().join("foam.obj")).unwrap();
    fs::copy(&mesh, folder.path().join("foam.obj")).unwrap();
    Scene::from_path(&path, &AuthoredRegistry::built_in()).unwrap().check(MEMORY).unwrap();
}

#[test]
fn a_fault_of_a_mesh_points_at_its_shape_wire_or_burst() {
    let scene = Scene::from_text("scene.ron", FOAM, &AuthoredRegistry::built_in()).unwrap();
    let kinds = [
        (MeshFaultKind::NotAMesh, 0, "F0062"),
        (MeshFaultKind::Labels, 0, "F0063"),
        (MeshFaultKind::Faces, 0, "F0064"),
        (MeshFaultKind::Crossing, 0, "F0065"),
        (MeshFaultKind::WirePierces, 1, "F0066"),
        (MeshFaultKind::WireFar, 1, "F0067"),
        (MeshFaultKind::Burst, 2, "F0069"),
    ];
    for (kind, entity, code) in kinds {
        let fault = MeshFault { entity: PlaceInScene(entity), kind, message: "vertex 3 is odd".to_owned() };
        let error = scene.explain(&fault);
        assert_eq!((error.stable_code().as_str(), error.place().unwrap().line), (code, 7 + entity as usize));
        insta::assert_snapshot!(format!("a_fault_of_a_mesh_{code}"), shown(&error));
    }
}

#[test]
fn what_a_method_finds_wrong_with_a_mesh_is_an_error_of_the_scene() {
    fn refuse(_: &mut bevy_ecs::world::World) -> Result<(), froth::method::DiscretiseError> {
        let message = "the edge of vertices 1 and 2 has one face".to_owned();
        Err(Box::new(MeshFault { entity: PlaceInScene(0), kind: MeshFaultKind::Labels, message }))
    }
    let method = Method { discretise: refuse, ..melp::METHOD };
    let built = Simulation::builder().method(method).build_from_text("scene.ron", SCENE);
    let Err(BuildError::Scene(error)) = built.map(|_| ()) else { panic!("no error of the scene") };
    assert_eq!((error.stable_code().as_str(), error.place().unwrap().line), ("F0063", 10));
}

#[test]
fn a_value_that_a_users_component_refuses() {
    #[derive(bevy_ecs::component::Component, Clone, serde::Deserialize)]
    #[serde(try_from = "Blades")]
    struct Fan;

    #[derive(serde::Deserialize)]
    #[serde(rename = "Fan", deny_unknown_fields)]
    struct Blades {
        blades: u32,
    }

    impl TryFrom<Blades> for Fan {
        type Error = &'static str;

        fn try_from(fan: Blades) -> Result<Self, Self::Error> {
            if fan.blades > 1 { Ok(Self) } else { Err("one blade does not blow") }
        }
    }

    let mut registry = AuthoredRegistry::built_in();
    registry.register::<Fan>("Fan", "blows");
    Scene::from_text("scene.ron", &broken("Hover()", "Fan(blades: 3)"), &registry).unwrap();
    let error = Scene::from_text("scene.ron", &broken("Hover()", "Fan(blades: 1)"), &registry).unwrap_err();
    insta::assert_snapshot!("a_value_that_a_users_component_refuses", shown(&error));
}

#[test]
fn the_place_is_known_without_the_picture_of_it() {
    let place = fault_of_bytes(broken("10 cm", "5 kg").as_bytes()).place().unwrap();
    assert_eq!((place.file.as_str(), place.line, place.column), ("scene.ron", 10, 28));
}
