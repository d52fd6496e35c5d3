//! The command line: exit codes, who gets which output, what each command says.

mod common;

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;

use common::{LAST_FRAME, exit_code, froth, output, scene_file, signal, stderr, stdout};
use froth::errors::error_page;
use froth::gallery::GALLERY;
use froth::method::METHODS;
use froth::run::{Manifest, RunState};
use froth::verify::LAWS;
use froth_systems::stage::Stage;
use serde_json::Value;

/// A folder with the small scene.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    scene_file(folder.path());
    folder
}

fn manifest(folder: &Path) -> Manifest {
    Manifest::read(folder).unwrap()
}

#[test]
fn a_run_says_where_it_writes_and_numbers_its_folder() {
    let folder = folder();
    for number in [1, 2] {
        let output = output(folder.path(), &["run", "small.ron", "--until", "20 ms"]);
        assert_eq!(exit_code(&output), 0);
        assert_eq!(stdout(&output), format!("finished: runs/small-{number}\n"));
        assert!(stderr(&output).contains("frame 2 of 2: t = 0.0200 of 0.02 s"), "{}", stderr(&output));
    }
    let run = folder.path().join("runs/small-1");
    assert_eq!(fs::read_to_string(run.join("scene.ron")).unwrap(), common::SCENE);
    assert_eq!(manifest(&run).state, RunState::Finished);
    assert_eq!(manifest(&run).until_s, 0.02);
}

#[test]
fn a_quiet_run_says_nothing() {
    let folder = folder();
    let output = output(folder.path(), &["run", "small.ron", "--until", "0.02", "--quiet"]);
    assert_eq!((exit_code(&output), stdout(&output), stderr(&output)), (0, String::new(), String::new()));
}

#[test]
fn a_machine_gets_one_object_per_frame() {
    let folder = folder();
    let output = output(folder.path(), &["run", "small.ron", "--json"]);
    assert_eq!((exit_code(&output), stderr(&output)), (0, String::new()));
    let objects: Vec<Value> = stdout(&output).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let frames: Vec<u64> = objects.iter().filter_map(|object| object["frame"].as_u64()).collect();
    assert_eq!(frames, (0..=LAST_FRAME).collect::<Vec<_>>());
    assert_eq!(objects[0]["event"], "begin");
    let end = objects.last().unwrap();
    assert_eq!((&end["event"], &end["state"]), (&"end".into(), &"finished".into()));
    assert!(end["max_speed_m_s"].as_f64().unwrap() > 0.0 && end["particles"].as_u64().unwrap() > 600);
}

#[test]
fn overrides_are_remembered_and_change_the_run() {
    let folder = folder();
    let arguments = ["run", "small.ron", "--until", "0.01", "--seed", "3", "--resolution", "1.5", "--method", "melp"];
    let output = output(folder.path(), &[&arguments[..], &["--threads", "1", "--out", "fine"]].concat());
    assert_eq!(exit_code(&output), 0, "{}", stderr(&output));
    let manifest = manifest(&folder.path().join("fine"));
    assert_eq!((manifest.seed, manifest.threads, manifest.overrides.resolution), (3, 1, Some(1.5)));
    assert_eq!(manifest.rows["eulerian"], 1350);
}

#[test]
fn wrong_usage_and_wrong_scenes_end_with_2() {
    let folder = folder();
    fs::write(folder.path().join("broken.ron"), common::SCENE.replace("radius", "radus")).unwrap();
    let wrong: [&[&str]; 9] = [
        &["run"],
        &["run", "small.ron", "--until", "-1"],
        &["run", "small.ron", "--method", "magic"],
        &["run", "small.ron", "--quiet", "--json"],
        &["run", "small.ron", "--resolution", "1e9"],
        &["run", "broken.ron"],
        &["check", "small.ron", "broken.ron"],
        &["resume", "."],
        &["explain", "F9999"],
    ];
    for arguments in wrong {
        let output = output(folder.path(), arguments);
        assert_eq!(exit_code(&output), 2, "{arguments:?}: {}", stderr(&output));
        assert!(!stderr(&output).is_empty());
    }
    assert!(!folder.path().join("runs").exists());
}

#[test]
fn an_error_in_a_scene_has_a_place_and_a_code() {
    let folder = folder();
    fs::write(folder.path().join("broken.ron"), common::SCENE.replace("radius", "radus")).unwrap();
    let message = stderr(&output(folder.path(), &["check", "broken.ron"]));
    assert!(message.starts_with("broken.ron:11:20: error[F00"), "{message}");
    // Without a terminal the piece of the scene is shown too, without colours.
    assert!(message.contains("[broken.ron:11:20]") && message.contains("Sphere(radus: \"5 cm\")"), "{message}");
    assert!(message.contains("\n  help: ") && message.contains('┬') && !message.contains('\x1b'), "{message}");
}

#[test]
fn a_picture_that_cannot_be_drawn_is_found_before_the_run() {
    let folder = folder();
    let faults = [
        ("(look: Map(quantity: \"thicknes\"))", "8:35: error[F0022]", "did you mean `thickness`?"),
        ("(width: 100000)", "8:22: error[F0034]", "1 to 16384 pixels"),
        ("(width: 16384, height: 16384)", "8:14: error[F0034]", "at most 134217728"),
        ("(camera: (position: (0, 0, 0), target: (0, 0, 0)))", "8:23: error[F0034]", "the camera has no direction"),
        ("(view: 1)", "8:15: error[F0021]: `picture` has no field `view`", "fields: width, height"),
        ("(look: Map(quantity: 5))", "8:35: error[F0030]: `picture.look.quantity`", "a text in quotes"),
    ];
    for (picture, place, advice) in faults {
        fs::write(folder.path().join("drawn.ron"), common::SCENE.replace("(width: 96, height: 96)", picture)).unwrap();
        for command in ["check", "run"] {
            let output = output(folder.path(), &[command, "drawn.ron"]);
            let message = stderr(&output);
            assert_eq!(exit_code(&output), 2, "{command} {picture}: {message}");
            assert!(message.starts_with(&format!("drawn.ron:{place}")) && message.contains(advice), "{message}");
        }
    }
    assert!(!folder.path().join("runs").exists());
}

#[test]
fn a_quantity_of_liquid_is_none_without_liquid() {
    let folder = folder();
    let map = common::SCENE.replace("(width: 96, height: 96)", "(look: Map(quantity: \"velocity gradient\"))");
    fs::write(folder.path().join("wet.ron"), &map).unwrap();
    fs::write(folder.path().join("dry.ron"), map.replace("liquid_per_carrier: 4", "liquid_per_carrier: 0")).unwrap();
    assert_eq!(exit_code(&output(folder.path(), &["check", "wet.ron"])), 0);
    let dry = output(folder.path(), &["check", "dry.ron"]);
    assert!(exit_code(&dry) == 2 && stderr(&dry).contains("error[F0022]"), "{}", stderr(&dry));
}

#[test]
fn numbers_on_the_command_line_are_refused_in_words() {
    let folder = folder();
    let message = |arguments: &[&str]| stderr(&output(folder.path(), arguments));
    let until = message(&["run", "small.ron", "--until", "-1"]);
    assert!(until.contains("a positive time is wanted"), "{until}");
    let long = message(&["run", "small.ron", "--until", "1e9"]);
    assert!(long.contains("`--until` would make about 1.0e11 frames"), "{long}");
    let resolution = message(&["run", "small.ron", "--resolution", "-2"]);
    assert!(resolution.contains("a positive number is wanted"), "{resolution}");
    for (factor, code) in [("100000", "F0051"), ("0.1", "F0050")] {
        let message = message(&["run", "small.ron", "--resolution", factor]);
        assert!(message.contains(code) && message.contains(&format!("`--resolution {factor}` makes")), "{message}");
    }
}

#[test]
fn a_slip_in_a_command_or_a_code_is_mended() {
    let folder = folder();
    let said = |arguments: &[&str], wanted: &str| {
        let output = output(folder.path(), arguments);
        assert_eq!(exit_code(&output), 2);
        assert!(stderr(&output).contains(wanted), "{}", stderr(&output));
    };
    said(&["rnu", "small.ron"], "did you mean `froth run`?");
    said(&["small.ron"], "did you mean `froth run small.ron`?");
    said(&["giant_buble"], "did you mean `froth run giant_bubble`?");
    said(&["frobnicate"], "commands: run, resume, check");
    said(&["explain", "F0049"], "there are: F0040, F0041");
    said(&["explain", "F9999"], "F0001, F0002");
}

#[test]
fn a_slip_in_the_name_of_a_built_in_scene_is_mended() {
    let folder = folder();
    let message = stderr(&output(folder.path(), &["run", "giant_buble"]));
    assert!(message.contains("did you mean `giant_bubble`?"), "{message}");
}

#[test]
fn check_says_what_would_be_built() {
    let folder = folder();
    let output = output(folder.path(), &["check", "small.ron", GALLERY[0].name]);
    assert_eq!(exit_code(&output), 0);
    let text = stdout(&output);
    assert!(text.contains("600 eulerian, 2400 lagrangian, 0 boundary"), "{text}");
    assert!(text.contains("13 frames at 100 per second") && text.contains("memory"), "{text}");
    assert!(text.contains("12 or more, none longer than 10.000 ms, each of up to 8 substeps"), "{text}");
    assert!(text.contains("96 x 96 pixels; at most 1 MB on disk"), "{text}");
    assert!(text.contains("if films flow at 1.40 m/s"), "{text}");
}

#[test]
fn check_says_how_large_a_mesh_would_be() {
    let folder = folder();
    let scene = r#"Scene(title: "A foam", method: GeometricFlow(time_step: "1 ms"), resolution: Spacing("5 mm"), duration: 1,
        entities: [ [ Lattice(cell: "1 cm", counts: (5, 5, 5)), Film(thickness: Uniform("400 nm")) ] ])"#;
    fs::write(folder.path().join("foam.ron"), scene).unwrap();
    let output = output(folder.path(), &["check", "foam.ron"]);
    assert_eq!(exit_code(&output), 0, "{}", stderr(&output));
    let text = stdout(&output);
    assert!(text.contains("  mesh       2078 vertices, 4156 faces; edges of 5.000 mm"), "{text}");
    assert!(text.contains("  method     geometric-flow"), "{text}");
    assert!(text.contains("1000 or more, none longer than 1.000 ms"), "{text}");
}

#[test]
fn explain_says_what_runs_and_why() {
    let folder = folder();
    let text = stdout(&output(folder.path(), &["explain", "small.ron"]));
    let line =
        |name: &str| text.lines().find(|line| line.trim_start().starts_with(name)).unwrap_or_default().to_owned();
    assert!(
        line("link the particle sets and gather liquid (L2E)").ends_with("runs   there is: lagrangian particles"),
        "{text}"
    );
    assert!(line("wind").ends_with("rests  needs: a wind"), "{text}");
    assert!(line("choose the step length").ends_with("runs   in every step"), "{text}");
    let stages = text.lines().filter(|line| !line.starts_with(' ')).count();
    assert_eq!(stages, 1 + Stage::ALL.len());
}

#[test]
fn explain_prints_the_page_of_an_error_code() {
    let folder = folder();
    let output = output(folder.path(), &["explain", "f0020"]);
    assert_eq!((exit_code(&output), stdout(&output).trim_end()), (0, error_page("F0020").unwrap().trim_end()));
}

#[test]
fn scenes_lists_every_built_in_scene() {
    let folder = folder();
    let text = stdout(&output(folder.path(), &["scenes"]));
    assert_eq!(text.lines().count(), GALLERY.len());
    assert!(GALLERY.iter().all(|scene| text.contains(scene.name) && text.contains(scene.summary)));
}

#[test]
fn verify_prints_a_row_per_finding_and_knows_its_laws() {
    let folder = folder();
    let found = output(folder.path(), &["verify", "operators"]);
    assert_eq!(exit_code(&found), 0, "{}", stdout(&found));
    assert!(stdout(&found).ends_with("all 1 laws hold\n") && stdout(&found).contains("  ok\n"), "{}", stdout(&found));
    let list = stdout(&output(folder.path(), &["verify", "--list"]));
    assert!(LAWS.iter().all(|law| list.contains(law.name) && list.contains(law.summary) && list.contains(law.source)));
    let slip = output(folder.path(), &["verify", "operator"]);
    assert_eq!(exit_code(&slip), 2);
    assert!(stderr(&slip).contains("did you mean `operators`?"), "{}", stderr(&slip));
}

#[test]
fn help_names_the_methods_and_is_no_error() {
    let folder = folder();
    let output = output(folder.path(), &["run", "--help"]);
    assert_eq!(exit_code(&output), 0);
    assert!(METHODS.iter().all(|method| stdout(&output).contains(method.name)));
}

#[test]
fn without_arguments_the_default_scene_runs_until_a_signal_stops_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut process = froth(folder.path(), &[]).stdout(Stdio::null()).spawn().unwrap();
    let run = folder.path().join(format!("runs/{}-1", GALLERY[0].name));
    while !run.join("manifest.json").exists() {
        sleep(Duration::from_millis(20));
        assert!(process.try_wait().unwrap().is_none(), "the run ended early");
    }
    signal(process.id(), "TERM");
    assert_eq!(process.wait().unwrap().code(), Some(75));
    assert_eq!(manifest(&run).state, RunState::Stopped);
}

#[test]
fn a_second_signal_kills() {
    let folder = folder();
    // Many particles, so that the first step is still going on.
    let arguments = ["run", "small.ron", "--resolution", "4", "--json"];
    let mut process = froth(folder.path(), &arguments).stdout(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(process.stdout.take().unwrap()).lines().map(Result::unwrap);
    lines.find(|line| line.contains(r#""frame":0"#)).unwrap();
    signal(process.id(), "INT");
    sleep(Duration::from_millis(10));
    signal(process.id(), "INT");
    assert_eq!(process.wait().unwrap().code(), Some(128 + 2));
}

#[test]
fn bench_prints_a_table_per_size_and_writes_its_numbers() {
    let folder = folder();
    let arguments =
        ["bench", "small.ron", "--sizes", "300,600", "--steps", "2", "--warm-up", "0", "--csv", "bench.csv"];
    let output = output(folder.path(), &arguments);
    assert_eq!(exit_code(&output), 0, "{}", stderr(&output));
    assert_eq!(stdout(&output).matches("  whole step").count(), 2, "{}", stdout(&output));
    let csv = fs::read_to_string(folder.path().join("bench.csv")).unwrap();
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert!(lines.iter().all(|fields| fields.len() == 8), "{csv}");
    assert!(lines.iter().any(|fields| fields[1] == "300" && fields[5] == "Gather"), "{csv}");
}
