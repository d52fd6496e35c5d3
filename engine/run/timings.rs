//! `timings.csv`: wall time of each stage in each step, milliseconds.
//!
//! A table like `observables.csv`, but not part of the results: a resumed run goes on with it, and every run has other numbers.

use std::io;
use std::path::Path;

use froth_systems::observe::Observables;

use super::folder::TIMINGS;
use super::table::ObservablesTable;
use crate::simulation::{Simulation, StepReport};

/// The observable that says how often the stages of a substep ran.
const SUBSTEPS: &str = "substeps";

/// The table of a run, open at its end.
#[derive(Debug)]
pub(super) struct TimingsTable {
    table: ObservablesTable,
    times: Observables,
}

impl TimingsTable {
    /// The table in a run folder up to a step; an empty one where there is none.
    pub(super) fn open(folder: &Path, step: u64) -> io::Result<Self> {
        let path = folder.join(TIMINGS);
        let is_begun = step > 0 && path.exists();
        let table = if is_begun { ObservablesTable::resume(&path, step) } else { ObservablesTable::create(&path) };
        Ok(Self { table: table?, times: Observables::default() })
    }

    /// Adds the line of the step that `simulation` finished last.
    pub(super) fn append(&mut self, report: &StepReport, simulation: &Simulation) -> io::Result<()> {
        self.times.begin_step();
        if let Some(substeps) = simulation.observables().get(SUBSTEPS) {
            self.times.record(SUBSTEPS, "1", substeps);
        }
        for (stage, time) in simulation.stage_times().last() {
            // To the microsecond; more digits are noise.
            self.times.record(&format!("{stage:?}"), "ms", 1e-3 * (1e6 * time.as_secs_f64()).round());
        }
        self.table.append(report, &self.times)
    }
}
