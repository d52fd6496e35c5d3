//! The command line. It alone prints, and it alone decides exit codes; everything else is the library.
//!
//! | command | file |
//! |---|---|
//! | `run`, `resume` | `run`, watched by `progress`, told to stop by `signals` |
//! | `bench` | `bench` |
//! | `check` | `check` |
//! | `explain` | `explain` |
//! | `verify` | `verify` |
//! | `scenes` | `scenes` |
//!
//! Errors are shown by `report`. Progress goes to standard error, results to standard output.

#![expect(clippy::print_stderr, reason = "a command line prints")]

mod bench;
mod check;
mod explain;
mod progress;
mod report;
mod run;
mod scene_choice;
mod scenes;
mod signals;
mod verify;

use std::ffi::OsString;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue};
use clap::{CommandFactory, Parser, Subcommand};
use froth_components::quantity::nearest;

use self::report::{Failure, show};
use crate::gallery;

/// The work is done.
const DONE: u8 = 0;
/// A run or a check failed.
const FAILED: u8 = 1;
/// Wrong usage, or a wrong scene.
const WRONG_USAGE: u8 = 2;
/// A run stopped at a checkpoint, on a signal.
const STOPPED: u8 = 75;

/// Simulates soap films, bubbles and foams.
///
/// Without a command, runs the built-in default scene.
#[derive(Debug, Parser)]
#[command(
    name = "froth",
    version,
    about,
    after_help = "Exit codes: 0 done, 1 a run or check failed, 2 wrong usage or scene, 75 stopped at a checkpoint on a signal."
)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a scene and write a run folder
    Run(run::RunArguments),
    /// Continue a run from its newest checkpoint
    Resume(run::ResumeArguments),
    /// Validate scenes; print what would be built: entities, memory, steps
    Check(check::CheckArguments),
    /// Print the schedule of a scene and why each system runs or rests; or the page of an error code such as F0020
    Explain(explain::ExplainArguments),
    /// Measure physical laws: expected, measured, error, tolerance, observed order
    Verify(verify::VerifyArguments),
    /// Measure time per stage and step, and memory, at several sizes of a scene
    Bench(bench::BenchArguments),
    /// List the built-in scenes
    Scenes,
}

/// Runs the command line, with the program's name as the first argument, and gives its exit code.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version are no errors to clap's printer either; it chooses the stream.
            let _ = error.print();
            if let Some(hint) = hint(&error) {
                eprintln!("\n{hint}");
            }
            return ExitCode::from(if error.use_stderr() { WRONG_USAGE } else { DONE });
        }
    };
    let done = match arguments.command {
        None => run::run(&run::RunArguments::default_scene()),
        Some(Command::Run(arguments)) => run::run(&arguments),
        Some(Command::Resume(arguments)) => run::resume(&arguments),
        Some(Command::Check(arguments)) => check::check(&arguments),
        Some(Command::Explain(arguments)) => explain::explain(&arguments),
        Some(Command::Verify(arguments)) => verify::verify(&arguments),
        Some(Command::Bench(arguments)) => bench::bench(&arguments),
        Some(Command::Scenes) => Ok(scenes::list()),
    };
    ExitCode::from(done.unwrap_or_else(|failure: Failure| {
        show(&failure);
        failure.exit_code()
    }))
}

/// What may have been meant by a command that does not exist: another command, or a scene without `run`.
fn hint(error: &clap::Error) -> Option<String> {
    let Some(ContextValue::String(found)) = error.get(ContextKind::InvalidSubcommand) else { return None };
    let commands: Vec<String> = Arguments::command().get_subcommands().map(|one| one.get_name().to_owned()).collect();
    let is_scene = gallery::built_in(found).is_some() || Path::new(found).is_file();
    let near = nearest(found, commands.iter().map(String::as_str)).map(str::to_owned);
    let near = if is_scene { Some(format!("run {found}")) } else { near };
    let near = near.or_else(|| gallery::nearest_name(found).map(|name| format!("run {name}")));
    Some(match near {
        Some(near) => format!("did you mean `froth {near}`?"),
        None => format!("commands: {}", commands.join(", ")),
    })
}

/// Prints a line to standard output. A reader that went away (`froth scenes | head -1`) is no error.
fn say(line: impl AsRef<str>) {
    let _ = writeln!(io::stdout(), "{}", line.as_ref());
}
