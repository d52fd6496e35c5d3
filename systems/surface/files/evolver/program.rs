//! Runs the Surface Evolver on a datafile, and reads back what it found.
//!
//! The program talks to a person: its answers stand among prompts, echoes and progress. What is read back is what [`REPORT`]
//! makes it print, lines that begin with a tag of ours.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::{env, fs, io, process};

use thiserror::Error;

use crate::rows::Region;

/// Names of the program: Debian's, in double precision without pictures, and the author's.
const PROGRAMS: [&str; 2] = ["evolver-nox-d", "evolver"];

/// Prints area and bodies. A body's `original` is its number in the datafile.
const REPORT: &str = r#"
printf "\nFILM area %.17g\n", total_energy;
foreach body bb do printf "\nFILM body %d volume %.17g pressure %.17g\n", bb.original, bb.volume, bb.pressure;
"#;

/// One body of a minimum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// The number it has in the datafile.
    pub region: Region,
    /// Its volume, in the cube of the datafile's unit of length.
    pub volume: f64,
    /// Its pressure above the outside at film tension 1: `dA/dV`, in one over the datafile's unit of length.
    pub pressure: f64,
}

/// What the program found.
#[derive(Clone, Debug, PartialEq)]
pub struct Minimum {
    /// Area of all films, in the square of the datafile's unit of length.
    pub area: f64,
    /// The bodies, in the order of the datafile.
    pub bodies: Vec<Body>,
}

impl Minimum {
    /// The body of a region.
    #[must_use]
    pub fn body(&self, region: Region) -> Option<&Body> {
        self.bodies.iter().find(|body| body.region == region)
    }
}

/// Why there is no minimum.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum EvolverError {
    /// A file could not be written, or the program not be run.
    #[error("the Surface Evolver could not be run with {}", path.display())]
    Io {
        /// The file or folder at fault.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The program ran, but no area and bodies of finite numbers came out: it does not take the datafile or the commands.
    #[error("the Surface Evolver reported no minimum; it ended with:\n{ending}")]
    NoReport {
        /// The last lines that it printed.
        ending: String,
    },
}

/// Runs `commands` on a datafile, and gives the area, volumes and pressures it ends with; `None` where the program is not
/// installed.
///
/// Commands are in the program's own language: `r` refines, `g 20` descends twenty steps, `V` moves vertices to the middle
/// of their neighbours, `u` flips edges, `M 2` turns to quadratic elements, `hessian` takes a Newton step. Procedures of
/// the datafile can be called. Whether the result is a minimum to so many digits depends on them.
///
/// # Errors
/// When files cannot be written, or the program ends without finite numbers.
pub fn minimise(datafile: &str, commands: &str) -> Result<Option<Minimum>, EvolverError> {
    let scratch = Scratch::create()?;
    let data = scratch.write("surface.fe", datafile)?;
    // Twice: out of the surface, and out of the program.
    let script = scratch.write("commands.cmd", &format!("{commands}\n{REPORT}\nq\nq\n"))?;
    for program in PROGRAMS {
        let arguments = [OsStr::new("-f"), script.as_os_str(), data.as_os_str()];
        match run(program, &arguments, &scratch.0) {
            Ok(output) => return read_output(&output).map(Some),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(source) => return Err(EvolverError::Io { path: program.into(), source }),
        }
    }
    Ok(None)
}

fn run(program: &str, arguments: &[&OsStr], home: &Path) -> io::Result<Output> {
    let mut command = Command::new(program);
    command.args(arguments).stdin(Stdio::null());
    // Points in numbers, and no history of commands in the person's own folder.
    command.env("LC_ALL", "C").env("HOME", home);
    command.output()
}

fn read_output(output: &Output) -> Result<Minimum, EvolverError> {
    let printed = String::from_utf8_lossy(&output.stdout);
    read_report(&printed).ok_or_else(|| EvolverError::NoReport {
        ending: last_lines(&(printed.into_owned() + &String::from_utf8_lossy(&output.stderr)), 20),
    })
}

/// The last report in what was printed, if its numbers are finite.
fn read_report(printed: &str) -> Option<Minimum> {
    let mut found = None;
    for line in printed.lines() {
        match line.split_whitespace().collect::<Vec<_>>()[..] {
            ["FILM", "area", area] => found = Some(Minimum { area: area.parse().ok()?, bodies: Vec::new() }),
            ["FILM", "body", number, "volume", volume, "pressure", pressure] => {
                found.as_mut()?.bodies.push(read_body(number, volume, pressure)?);
            }
            _ => {}
        }
    }
    found.filter(|minimum| minimum.area.is_finite())
}

fn read_body(number: &str, volume: &str, pressure: &str) -> Option<Body> {
    let finite = |text: &str| text.parse().ok().filter(|number: &f64| number.is_finite());
    Some(Body { region: Region(number.parse().ok()?), volume: finite(volume)?, pressure: finite(pressure)? })
}

fn last_lines(text: &str, count: usize) -> String {
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    lines[lines.len().saturating_sub(count)..].join("\n")
}

/// A folder of this run alone, removed with its files at the end.
struct Scratch(PathBuf);

impl Scratch {
    fn create() -> Result<Self, EvolverError> {
        static RUNS: AtomicU32 = AtomicU32::new(0);
        let run = RUNS.fetch_add(1, Ordering::Relaxed);
        let path = env::temp_dir().join(format!("froth-evolver-{}-{run}", process::id()));
        fs::create_dir(&path).map_err(|source| EvolverError::Io { path: path.clone(), source })?;
        Ok(Self(path))
    }

    fn write(&self, name: &str, text: &str) -> Result<PathBuf, EvolverError> {
        let path = self.0.join(name);
        match fs::write(&path, text) {
            Ok(()) => Ok(path),
            Err(source) => Err(EvolverError::Io { path, source }),
        }
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // What is left of it is in the system's folder for such files, and harms nobody.
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_report_is_read_from_among_prompts_and_progress() {
        let printed = "Enter command: report := { printf \"FILM area %.15g\\n\", total_energy;\n\
            FILM area 3.5\nFILM body 1 volume 1 pressure 2\n  1. area:  3.1 energy:  3.1  scale: 0.1\n\
            Enter command: \nFILM area 3.25\nFILM body 4 volume 1e-05 pressure -2.5\nEnter command: q\n";
        let body = Body { region: Region(4), volume: 1e-5, pressure: -2.5 };
        assert_eq!(read_report(printed), Some(Minimum { area: 3.25, bodies: vec![body] }));
    }

    #[test]
    fn numbers_that_are_not_finite_are_no_minimum() {
        assert_eq!(read_report("FILM area nan\n"), None);
        assert_eq!(read_report("FILM area 1\nFILM body 1 volume inf pressure 1\n"), None);
        assert_eq!(read_report("FILM body 1 volume 1 pressure 1\n"), None);
    }

    #[test]
    fn what_is_no_datafile_is_an_error_that_quotes_the_program() {
        match minimise("vertices\n1 here there\n", "g 5") {
            Ok(None) => {}
            Err(EvolverError::NoReport { ending }) => assert!(ending.contains("here"), "{ending}"),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_run_leaves_no_files_behind() {
        let scratch = Scratch::create().unwrap();
        let file = scratch.write("a.fe", "text").unwrap();
        drop(scratch);
        assert!(!file.exists() && !file.parent().unwrap().exists());
    }
}
