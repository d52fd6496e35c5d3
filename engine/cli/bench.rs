//! `froth bench`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;

use super::report::Failure;
use super::{DONE, say, scene_choice};
use crate::bench::{self, BenchSettings, table};
use crate::gallery::GALLERY;
use crate::scene::AuthoredRegistry;

#[derive(Debug, Args)]
pub(super) struct BenchArguments {
    /// A scene file, or the name of a built-in scene
    #[arg(default_value = GALLERY[0].name)]
    scene: String,
    /// Numbers of Eulerian particles, one measurement each
    #[arg(long, value_delimiter = ',', value_name = "NUMBERS", default_value = "1000,16000",
          value_parser = clap::value_parser!(u64).range(10..))]
    sizes: Vec<u64>,
    /// Steps to measure
    #[arg(long, value_name = "STEPS", default_value = "10", value_parser = clap::value_parser!(u64).range(1..))]
    steps: u64,
    /// Steps before the measurement begins
    #[arg(long, value_name = "STEPS", default_value = "2")]
    warm_up: u64,
    /// Threads; all cores by default
    #[arg(long)]
    threads: Option<NonZeroUsize>,
    /// Write the numbers here as well
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

/// Measures every size in the order given.
pub(super) fn bench(arguments: &BenchArguments) -> Result<u8, Failure> {
    super::run::start_threads(arguments.threads)?;
    let scene = scene_choice::read(&arguments.scene, &AuthoredRegistry::built_in())?;
    let (name, text) = (scene.source().name(), scene.source().text());
    let settings = BenchSettings { warm_up: arguments.warm_up, steps: arguments.steps };
    let mut lines = table::CSV_HEADER.to_owned();
    for carriers in &arguments.sizes {
        let measured = bench::measure(name, text, *carriers, settings)?;
        say(table::describe(name, &measured));
        lines.push_str(&table::csv(name, &measured));
    }
    if let Some(path) = &arguments.csv {
        std::fs::write(path, lines).map_err(|error| Failure::Csv(path.clone(), error))?;
    }
    Ok(DONE)
}
