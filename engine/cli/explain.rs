//! `froth explain`: the assembled schedule of a scene, or the page of an error code.

use clap::Args;
use froth_systems::plan::ExplainedSystem;
use froth_systems::stage::{Part, Stage};

use super::report::Failure;
use super::{DONE, say, scene_choice};
use crate::errors::{PAGES, error_page};
use crate::scene::{AuthoredRegistry, Scene};
use crate::simulation::Simulation;

/// Carriers that are enough to see which systems run.
const ENOUGH: f64 = 2000.0;

#[derive(Debug, Args)]
pub(super) struct ExplainArguments {
    /// A scene file, the name of a built-in scene, or an error code such as F0020
    #[arg(value_name = "SCENE|CODE")]
    what: String,
}

pub(super) fn explain(arguments: &ExplainArguments) -> Result<u8, Failure> {
    let what = &arguments.what;
    if is_code(what) {
        say(error_page(what).ok_or_else(|| no_such_code(what))?);
        return Ok(DONE);
    }
    let scene = scene_choice::read(what, &AuthoredRegistry::built_in())?;
    let simulation = coarse(what, &scene)?;
    say(format!("{}: {}", scene.header.title, simulation.method().summary));
    say(schedule(&simulation.explain()));
    Ok(DONE)
}

/// The codes of the same tens, or of all where there are none.
fn no_such_code(what: &str) -> Failure {
    let group = what.get(..4).unwrap_or_default().to_uppercase();
    let codes = || PAGES.iter().map(|(code, _)| *code);
    let near: Vec<&str> = codes().filter(|code| code.starts_with(&group)).collect();
    let listed = if near.is_empty() { codes().collect() } else { near };
    Failure::NoSuchCode(what.to_owned(), listed.join(", "))
}

fn is_code(what: &str) -> bool {
    let digits = what.strip_prefix(['F', 'f']).unwrap_or_default();
    digits.len() == 4 && digits.bytes().all(|byte| byte.is_ascii_digit())
}

/// The scene with few particles, or as it is where a film would get too few. Which systems run does not depend on it.
fn coarse(argument: &str, scene: &Scene) -> Result<Simulation, Failure> {
    let factor = (ENOUGH / scene.estimate().carriers() as f64).sqrt();
    if factor < 1.0
        && let Ok(simulation) = scene_choice::build(argument, Simulation::builder().resolution(factor))
    {
        return Ok(simulation);
    }
    scene_choice::build(argument, Simulation::builder())
}

/// Per stage each system, whether it runs, and why.
fn schedule(systems: &[ExplainedSystem]) -> String {
    let width = systems.iter().map(|system| system.name.chars().count()).max().unwrap_or(0);
    let mut lines = Vec::new();
    for stage in Stage::ALL {
        let often = if stage.part() == Part::Substep { " (once per substep)" } else { "" };
        lines.push(format!("{stage:?}{often}"));
        let of_stage = systems.iter().filter(|system| system.stage == stage);
        let before = lines.len();
        lines.extend(of_stage.map(|system| line(system, width)));
        if lines.len() == before {
            lines.push("  nothing".to_owned());
        }
    }
    lines.join("\n")
}

fn line(system: &ExplainedSystem, width: usize) -> String {
    let verb = if system.runs() { "runs " } else { "rests" };
    let why = match (system.unmet.as_slice(), system.met.as_slice()) {
        ([], []) => "in every step".to_owned(),
        ([], met) => format!("there is: {}", met.join(", ")),
        (unmet, _) => format!("needs: {}", unmet.join(", ")),
    };
    format!("  {:width$}  {verb}  {why}", system.name)
}
