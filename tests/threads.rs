//! The number of threads does not change a byte.

mod common;

use common::{SCENE, assert_same_results, draw};
use froth::Simulation;
use froth::run::{Run, RunFolder, RunSettings, Silent};
use rayon::ThreadPoolBuilder;

#[test]
fn any_number_of_threads_leaves_the_same_bytes() {
    let parent = tempfile::tempdir().unwrap();
    let folder = |threads: usize| parent.path().join(threads.to_string());
    for threads in [1, 2, 3] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let folder = RunFolder::create(&folder(threads)).unwrap();
            // More rows than a chunk of a reduction has, in both kinds.
            let simulation = Simulation::builder().resolution(2.0).build_from_text("small.ron", SCENE).unwrap();
            let settings = RunSettings { until: Some(0.04), ..RunSettings::default() };
            let mut run = Run::begin(simulation, folder, settings).unwrap();
            run.drive(&mut draw, &mut Silent).unwrap();
        });
    }
    assert_same_results(&folder(2), &folder(1));
    assert_same_results(&folder(3), &folder(1));
}
