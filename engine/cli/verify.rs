//! `froth verify`: the laws, each with expected, measured, error, tolerance and observed order.

use std::time::Instant;

use clap::Args;

use super::report::Failure;
use super::{DONE, FAILED, say};
use crate::verify::finding::Finding;
use crate::verify::{Effort, LAWS, Law, law, nearest_law};

#[derive(Debug, Args)]
pub(super) struct VerifyArguments {
    /// Laws to measure; all of them by default
    #[arg(value_name = "LAW")]
    laws: Vec<String>,
    /// The sizes that the published bars are for; takes an hour
    #[arg(long)]
    full: bool,
    /// List the laws, what each says and where it comes from
    #[arg(long)]
    list: bool,
}

/// Measures every law asked for, also after one that fails.
pub(super) fn verify(arguments: &VerifyArguments) -> Result<u8, Failure> {
    let laws = chosen(&arguments.laws)?;
    if arguments.list {
        laws.iter().for_each(|law| say(format!("{:20} {}\n{:20} [{}]", law.name, law.summary, "", law.source)));
        return Ok(DONE);
    }
    let effort = if arguments.full { Effort::Full } else { Effort::Quick };
    say(HEADING);
    let failed = laws.iter().filter(|law| !print(law, effort)).count();
    if failed == 0 {
        say(format!("all {} laws hold", laws.len()));
        return Ok(DONE);
    }
    say(format!("{failed} of {} laws fail", laws.len()));
    Ok(FAILED)
}

fn chosen(names: &[String]) -> Result<Vec<&'static Law>, Failure> {
    if names.is_empty() {
        return Ok(LAWS.iter().collect());
    }
    let find = |name: &String| law(name).ok_or_else(|| Failure::NoSuchLaw(name.clone(), nearest_law(name)));
    names.iter().map(find).collect()
}

const HEADING: &str = "\
law / quantity                                                           expected      measured     error  tolerance  order (least)";

/// Measures and prints one law; returns whether it holds.
fn print(law: &Law, effort: Effort) -> bool {
    say(format!("{}: {}", law.name, law.summary));
    let start = Instant::now();
    match (law.measure)(effort) {
        Ok(findings) => {
            findings.iter().for_each(|finding| say(row(finding)));
            say(format!("  ({:.1} s)", start.elapsed().as_secs_f64()));
            findings.iter().all(Finding::passes)
        }
        Err(error) => {
            say(format!("  FAIL  {error}"));
            false
        }
    }
}

fn row(finding: &Finding) -> String {
    let Finding { what, expected, measured, error, tolerance, order } = finding;
    let order = order.map_or(String::new(), |order| format!("{:.2} ({})", order.observed, order.least));
    let verdict = if finding.passes() { "ok" } else { "FAIL" };
    format!(
        "  {what:66} {:>12}  {:>12}  {error:8.2e}  {tolerance:9.1e}  {order:>11}  {verdict}",
        number(*expected),
        number(*measured)
    )
}

/// Six digits.
fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        0.01..1e5 => format!("{value:.*}", (5 - value.abs().log10().floor() as i32).max(0) as usize),
        _ => format!("{value:.5e}"),
    }
}
