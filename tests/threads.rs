//! The number of threads does not change a byte.

mod common;

use common::{FOAM, MEETING, OPEN_FILMS, SCENE, assert_same_results, draw, results, sheets};
use froth::Simulation;
use froth::run::{Run, RunFolder, RunSettings, Silent};
use rayon::ThreadPoolBuilder;
use tempfile::TempDir;

#[test]
fn any_number_of_threads_leaves_the_same_bytes() {
    // More rows than a chunk of a reduction has, in both kinds.
    assert_independent_of_threads(SCENE, 2.0);
}

#[test]
fn open_films_several_films_and_warm_liquid_do_not_depend_on_threads_either() {
    assert_independent_of_threads(OPEN_FILMS, 1.5);
}

#[test]
fn bubbles_of_particles_that_meet_do_not_depend_on_threads_either() {
    assert_independent_of_threads(MEETING, 1.0);
}

#[test]
fn a_foam_that_changes_its_topology_does_not_depend_on_threads_either() {
    assert_independent_of_threads(FOAM, 1.0);
}

#[test]
fn films_in_air_do_not_depend_on_threads_either_however_pairs_are_summed() {
    for summation in ["Direct", "Fast(1e-3)"] {
        let parent = assert_independent_of_threads(&sheets(summation), 1.0);
        let events = String::from_utf8(results(&parent.path().join("1"))["events.csv"].clone()).unwrap();
        assert!(events.contains(",t1,") && events.contains(",burst,"), "{events}");
    }
}

#[test]
fn air_that_gas_pushes_away_does_not_depend_on_threads_either() {
    let blown = r#"[ Sphere(centre: (-0.1, 0, 0), radius: "2 cm"), Film(thickness: Uniform("400 nm")), Volumes(of: ["50 ml"], within: "0.035 s") ],"#;
    assert_independent_of_threads(&sheets("Direct").replacen("[ Gravity", &format!("{blown} [ Gravity"), 1), 1.0);
}

fn assert_independent_of_threads(scene: &str, resolution: f64) -> TempDir {
    let parent = tempfile::tempdir().unwrap();
    let folder = |threads: usize| parent.path().join(threads.to_string());
    for threads in [1, 2, 3] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let folder = RunFolder::create(&folder(threads)).unwrap();
            let simulation = Simulation::builder().resolution(resolution).build_from_text("small.ron", scene).unwrap();
            let settings = RunSettings { until: Some(0.04), ..RunSettings::default() };
            let mut run = Run::begin(simulation, folder, settings).unwrap();
            run.drive(&mut draw, &mut Silent).unwrap();
        });
    }
    assert_same_results(&folder(2), &folder(1));
    assert_same_results(&folder(3), &folder(1));
    parent
}
