//! How far a run is: a bar on a terminal, lines elsewhere, JSON for machines.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};

use super::say;
use crate::run::{Progress, Reporter, RunEnd, RunFolder, Silent};

/// Wall time between lines where there is no terminal.
const BETWEEN_LINES: Duration = Duration::from_secs(2);
/// Positions of the bar.
const POSITIONS: u64 = 10_000;

/// Who reads the output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Output {
    /// A bar or lines, and the folder at the end.
    People,
    /// JSON on standard output.
    Machines,
    /// Nothing.
    Nobody,
}

/// The reporter for an output.
pub(super) fn reporter(output: Output) -> Box<dyn Reporter> {
    match output {
        Output::People if io::stderr().is_terminal() => Box::new(Bar::new()),
        Output::People => Box::new(Lines { last: None }),
        Output::Machines => Box::new(Json),
        Output::Nobody => Box::new(Silent),
    }
}

/// `t = 0.1240 of 2 s, step 31 of 4.000 ms, 68000 particles, 0.31 m/s`.
fn describe(progress: &Progress) -> String {
    let speed = progress.max_speed.map(|speed| format!(", {speed:.3} m/s")).unwrap_or_default();
    format!(
        "t = {:.4} of {} s, step {} of {:.3} ms, {} particles{speed}",
        progress.time,
        progress.until,
        progress.step,
        1e3 * progress.step_length,
        progress.particles
    )
}

fn time_left(progress: &Progress) -> String {
    progress.left.map(|left| format!("{} left", HumanDuration(left))).unwrap_or_default()
}

/// A bar on a terminal.
struct Bar(ProgressBar);

impl Bar {
    fn new() -> Self {
        let bar = ProgressBar::with_draw_target(Some(POSITIONS), ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template("{bar:30.cyan/blue} {percent:>3}% {prefix}\n{msg}");
        bar.set_style(style.expect("invariant: the template is well formed"));
        Self(bar)
    }

    fn show(&self, progress: &Progress) {
        self.0.set_position((POSITIONS as f64 * progress.time / progress.until) as u64);
        self.0.set_prefix(time_left(progress));
        self.0.set_message(describe(progress));
    }
}

impl Reporter for Bar {
    fn begin(&mut self, progress: &Progress, folder: &RunFolder) {
        self.0.println(format!("writing {}", folder.path().display()));
        self.show(progress);
    }

    fn step(&mut self, progress: &Progress) {
        self.show(progress);
    }

    fn note(&mut self, text: &str) {
        self.0.println(format!("warning: {text}"));
    }

    fn end(&mut self, _: &Progress, _: &RunEnd) {
        // `finish` would fill the bar of a run that was stopped.
        self.0.abandon();
    }
}

/// A line now and then.
struct Lines {
    last: Option<Instant>,
}

impl Reporter for Lines {
    fn begin(&mut self, _: &Progress, folder: &RunFolder) {
        eprintln!("writing {}", folder.path().display());
    }

    fn frame(&mut self, progress: &Progress, frame: u64) {
        let is_last = frame + 1 == progress.frames;
        if is_last || self.last.is_none_or(|last| last.elapsed() >= BETWEEN_LINES) {
            let left = Some(time_left(progress)).filter(|left| !left.is_empty() && !is_last);
            let left = left.map(|left| format!(", {left}")).unwrap_or_default();
            eprintln!("frame {frame} of {}: {}{left}", progress.frames - 1, describe(progress));
            self.last = Some(Instant::now());
        }
    }

    fn note(&mut self, text: &str) {
        eprintln!("warning: {text}");
    }
}

/// One JSON object per line: `"event"` is `begin`, `frame`, `note` or `end`.
struct Json;

impl Json {
    fn print(event: &str, mut object: Value) {
        object["event"] = event.into();
        say(object.to_string());
    }

    fn numbers(progress: &Progress) -> Value {
        json!({
            "time_s": progress.time,
            "until_s": progress.until,
            "step": progress.step,
            "step_length_s": progress.step_length,
            "limited_by": progress.limited_by,
            "particles": progress.particles,
            "max_speed_m_s": progress.max_speed,
            "wall_s": progress.wall.as_secs_f64(),
            "left_s": progress.left.map(|left| left.as_secs_f64()),
        })
    }
}

impl Reporter for Json {
    fn begin(&mut self, progress: &Progress, folder: &RunFolder) {
        let mut object = Self::numbers(progress);
        object["folder"] = folder.path().display().to_string().into();
        object["frames"] = progress.frames.into();
        Self::print("begin", object);
    }

    fn frame(&mut self, progress: &Progress, frame: u64) {
        let mut object = Self::numbers(progress);
        object["frame"] = frame.into();
        Self::print("frame", object);
    }

    fn note(&mut self, text: &str) {
        Self::print("note", json!({ "text": text }));
    }

    fn end(&mut self, progress: &Progress, end: &RunEnd) {
        let (state, checkpoint) = match end {
            RunEnd::Finished { checkpoint } => ("finished", checkpoint),
            RunEnd::Stopped { checkpoint } => ("stopped", checkpoint),
        };
        let mut object = Self::numbers(progress);
        object["state"] = state.into();
        object["checkpoint"] = checkpoint.display().to_string().into();
        Self::print("end", object);
    }
}
