//! `observables.csv`: one line per step, whole lines only.
//!
//! Every line is written by one call and no buffer holds any back, so a killed run leaves whole lines. No column holds a wall time
//! (those are in `timings.csv`): a resumed run leaves the same bytes as an uninterrupted one. A quantity that first appears in a later step becomes a new last
//! column; lines before it have no value there.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use froth_systems::observe::{Observable, Observables};

use crate::simulation::StepReport;
use crate::whole_file::write_whole;

/// Columns before the observables.
const FIRST: [&str; 2] = ["step", "time [s]"];

/// The table of a run, open at its end.
#[derive(Debug)]
pub(super) struct ObservablesTable {
    path: PathBuf,
    file: File,
    /// Length of the whole lines, bytes.
    length: u64,
    columns: usize,
}

impl ObservablesTable {
    /// An empty table; what was there is replaced.
    pub(super) fn create(path: &Path) -> io::Result<Self> {
        write_whole(path, |_| Ok(()))?;
        Self::open(path, 0)
    }

    /// The table up to a step; later lines, and a last line that is not whole, are cut off.
    pub(super) fn resume(path: &Path, step: u64) -> io::Result<Self> {
        let text = fs::read_to_string(path)?;
        let is_kept = |line: &str| line.ends_with('\n') && step_of(line).is_none_or(|of_line| of_line <= step);
        let kept: String = text.split_inclusive('\n').take_while(|line| is_kept(line)).collect();
        let columns = kept.lines().next().map_or(0, |header| header.split(',').count().saturating_sub(FIRST.len()));
        if kept.len() < text.len() {
            write_whole(path, |file| file.write_all(kept.as_bytes()))?;
        }
        Self::open(path, columns)
    }

    fn open(path: &Path, columns: usize) -> io::Result<Self> {
        let file = File::options().append(true).open(path)?;
        let length = file.metadata()?.len();
        Ok(Self { path: path.to_owned(), file, length, columns })
    }

    /// Adds the line of a step. When that fails, the file ends with the line before.
    pub(super) fn append(&mut self, report: &StepReport, observables: &Observables) -> io::Result<()> {
        let columns = observables.columns();
        if self.length == 0 || columns.len() != self.columns {
            self.rewrite_header(columns)?;
        }
        let line = line(report, columns);
        if let Err(error) = self.file.write_all(line.as_bytes()) {
            // What was written of the line is cut off; if even that fails, a resumption does it.
            let _ = self.file.set_len(self.length);
            return Err(error);
        }
        self.length += line.len() as u64;
        Ok(())
    }

    /// Replaces the header by one with more columns, and gives all lines an empty value in each of those.
    fn rewrite_header(&mut self, columns: &[Observable]) -> io::Result<()> {
        let text = fs::read_to_string(&self.path)?;
        let empty = ",".repeat(columns.len() - self.columns);
        let lines = text.lines().skip(1);
        let names = columns.iter().map(|column| field(&format!("{} [{}]", column.name, column.unit)));
        let header = FIRST.map(str::to_owned).into_iter().chain(names).collect::<Vec<_>>().join(",");
        write_whole(&self.path, |file| {
            writeln!(file, "{header}")?;
            lines.clone().try_for_each(|line| writeln!(file, "{line}{empty}"))
        })?;
        *self = Self::open(&self.path, columns.len())?;
        Ok(())
    }
}

/// Step of a line; `None` for the header.
pub(super) fn step_of(line: &str) -> Option<u64> {
    line.split(',').next()?.parse().ok()
}

/// The shortest digits that read back as the same numbers; empty where nothing was measured.
fn line(report: &StepReport, columns: &[Observable]) -> String {
    let mut line = format!("{},{:?}", report.step, report.time);
    for column in columns {
        line.push(',');
        line.extend(column.value.map(|value| format!("{value:?}")));
    }
    line.push('\n');
    line
}

/// A name as CSV wants it.
fn field(name: &str) -> String {
    // A comma would need quotes, which few readers of a first line undo.
    name.replace([',', '"', '\n', '\r'], "_")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(step: u64) -> StepReport {
        StepReport { step, time: 0.1 * step as f64, step_length: 0.1, limited_by: None, frame: None }
    }

    fn table_of(path: &Path, steps: std::ops::Range<u64>, table: Option<ObservablesTable>) {
        let mut table = table.unwrap_or_else(|| ObservablesTable::create(path).unwrap());
        let mut observables = Observables::default();
        for step in steps {
            observables.begin_step();
            observables.record("volume", "m^3", 0.1 + 0.2);
            if step >= 2 {
                observables.record("energy", "J", 1e-300);
            }
            table.append(&report(step), &observables).unwrap();
        }
    }

    #[test]
    fn a_quantity_that_comes_later_becomes_a_column() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("observables.csv");
        table_of(&path, 1..3, None);
        let wanted = "step,time [s],volume [m^3],energy [J]\n\
                      1,0.1,0.30000000000000004,\n\
                      2,0.2,0.30000000000000004,1e-300\n";
        assert_eq!(fs::read_to_string(path).unwrap(), wanted);
    }

    #[test]
    fn a_resumed_table_has_the_bytes_of_an_uninterrupted_one() {
        let folder = tempfile::tempdir().unwrap();
        let (whole, cut) = (folder.path().join("whole.csv"), folder.path().join("cut.csv"));
        table_of(&whole, 1..9, None);
        table_of(&cut, 1..7, None);
        let mut text = fs::read_to_string(&cut).unwrap();
        text.push_str("7,0.7000");
        fs::write(&cut, text).unwrap();
        let table = ObservablesTable::resume(&cut, 4).unwrap();
        table_of(&cut, 5..9, Some(table));
        assert_eq!(fs::read_to_string(cut).unwrap(), fs::read_to_string(whole).unwrap());
    }
}
