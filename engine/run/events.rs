//! `events.csv`: one line per change of topology, for methods whose films have one.
//!
//! Part of the results: a resumed run cuts lines after its checkpoint and leaves the same bytes as an uninterrupted one.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

use froth_systems::tracker::events::{StepEvents, TopologyEvent};

use super::folder::EVENTS;
use super::table::step_of;
use crate::simulation::Simulation;
use crate::whole_file::write_whole;

const HEADER: &str = "step,time [s],kind,x [m],y [m],z [m],regions\n";

/// The table of a run, open at its end; none for a method without changes of topology.
#[derive(Debug)]
pub(super) struct EventsTable(Option<File>);

impl EventsTable {
    /// The table in a run folder up to a step.
    pub(super) fn open(folder: &Path, simulation: &Simulation, step: u64) -> io::Result<Self> {
        if !simulation.world().contains_resource::<StepEvents>() {
            return Ok(Self(None));
        }
        let path = folder.join(EVENTS);
        let text = if step > 0 && path.exists() { fs::read_to_string(&path)? } else { String::new() };
        let is_kept = |line: &&str| line.ends_with('\n') && step_of(line).is_some_and(|of_line| of_line <= step);
        let kept: String = text.split_inclusive('\n').skip(1).take_while(is_kept).collect();
        write_whole(&path, |file| write!(file, "{HEADER}{kept}"))?;
        Ok(Self(Some(File::options().append(true).open(path)?)))
    }

    /// Adds the events of the step that `simulation` finished last, by one write.
    pub(super) fn append(&mut self, simulation: &Simulation) -> io::Result<()> {
        let (Some(file), Some(events)) = (&mut self.0, simulation.world().get_resource::<StepEvents>()) else {
            return Ok(());
        };
        let lines: String = events.0.iter().map(line).collect();
        if lines.is_empty() { Ok(()) } else { file.write_all(lines.as_bytes()) }
    }
}

fn line(event: &TopologyEvent) -> String {
    let TopologyEvent { kind, step, time, place, regions } = event;
    let regions: Vec<String> = regions.iter().map(|region| region.0.to_string()).collect();
    let (x, y, z) = (place.x, place.y, place.z);
    format!("{step},{time:?},{},{x:?},{y:?},{z:?},{}\n", kind.name(), regions.join(" "))
}
