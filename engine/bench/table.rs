//! A measurement as a table for people, and as lines of CSV.

use std::time::Duration;

use super::Measurement;

/// The table of one size, without a final line break.
#[must_use]
pub fn describe(scene: &str, measured: &Measurement) -> String {
    let rows: Vec<String> = measured.rows.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
    let mut lines =
        vec![format!("{scene}: {}; {} threads, mean of {} steps", rows.join(", "), measured.threads, measured.steps)];
    for (stage, time) in measured.stages.iter().filter(|(_, time)| *time >= Duration::from_micros(1)) {
        let share = 100.0 * time.as_secs_f64() / measured.wall.as_secs_f64();
        lines.push(format!("  {:<12} {:>10.2} ms {share:>5.1} %", format!("{stage:?}"), milliseconds(*time)));
    }
    lines.push(format!("  {:<12} {:>10.2} ms", "whole step", milliseconds(measured.wall)));
    if let Some(processor) = measured.processor {
        lines.push(format!("  {:<12} {:>10.2} ms", "processors", milliseconds(processor)));
    }
    if let Some(bytes) = measured.peak_bytes {
        lines.push(format!("  {:<12} {:>10.1} MB", "peak memory", 1e-6 * bytes as f64));
    }
    lines.push(format!("  {:<12} {:>10.2} ms", "simulated", 1e3 * measured.simulated));
    lines.push(format!("  {:<12} {:>10.2} s", "start", measured.start.as_secs_f64()));
    lines.extend(measured.counts.iter().map(|(name, mean)| format!("  {name} {mean:.1}")));
    lines.join("\n")
}

/// The lines of one size, under [`CSV_HEADER`].
#[must_use]
pub fn csv(scene: &str, measured: &Measurement) -> String {
    let count = |kind: &str| measured.rows.iter().find(|(name, _)| *name == kind).map_or(0, |(_, count)| *count);
    let head = format!("{scene},{},{},{},{}", count("eulerian"), count("lagrangian"), measured.threads, measured.steps);
    let stages = measured.stages.iter().map(|(stage, time)| (format!("{stage:?}"), milliseconds(*time), "ms"));
    let optional = [
        measured.processor.map(|time| ("processors".to_owned(), milliseconds(time), "ms")),
        measured.peak_bytes.map(|bytes| ("peak memory".to_owned(), 1e-6 * bytes as f64, "MB")),
    ];
    let whole = [
        ("whole step".to_owned(), milliseconds(measured.wall), "ms"),
        ("simulated".to_owned(), 1e3 * measured.simulated, "ms"),
        ("start".to_owned(), measured.start.as_secs_f64(), "s"),
    ];
    let counts = measured.counts.iter().map(|(name, mean)| (name.clone(), *mean, "1"));
    let quantities = stages.chain(whole).chain(optional.into_iter().flatten()).chain(counts);
    quantities.map(|(name, value, unit)| format!("{head},{name},{value:.6},{unit}\n")).collect()
}

/// First line of the CSV.
pub const CSV_HEADER: &str = "scene,eulerian,lagrangian,threads,steps,quantity,value,unit\n";

fn milliseconds(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}
