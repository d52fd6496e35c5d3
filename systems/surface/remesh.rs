//! One pass over the mesh: join what is near, keep edges even, pull apart what meets without a film.

use serde::{Deserialize, Serialize};

use crate::bodies::{self, Division};
use crate::event::{Event, EventKind};
use crate::mesh::Remap;
use crate::operations::{Counts, Mark, Session};
use crate::policy::Policy;
use crate::rows::{PerVertex, Region};
use crate::surface::Surface;
use crate::transfer::Transfer;

/// What the tracker remembers between passes: part of the state of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tracker {
    /// Passes begun.
    step: u64,
    /// The next label that no region has had.
    next_region: Region,
    marks: PerVertex<Mark>,
}

/// What a pass did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Remeshed {
    /// Operations.
    pub counts: Counts,
    /// Changes of topology.
    pub events: Vec<Event>,
    /// Bodies of gas that came apart from their regions, with labels of their own.
    pub divisions: Vec<Division>,
    /// Bubbles too small for the mesh, and the regions that they joined: `(gone, into)`.
    pub joined: Vec<(Region, Region)>,
    /// Where rows went; `None` if none moved.
    pub remap: Option<Remap>,
}

impl Tracker {
    /// A pass: snap, split, collapse, flip, separate, dissolve specks, improve thin faces and refine narrow films, in this order; then rows are closed
    /// up.
    ///
    /// The surface must not intersect itself, and does not afterwards. `data` sees every operation and the new order of rows.
    pub fn remesh(&mut self, surface: &mut Surface, policy: &Policy, data: &mut dyn Transfer) -> Remeshed {
        let mut session = self.begin(surface, policy, data);
        session.snap_films();
        session.split_long_edges();
        if !policy.flips {
            session.split_wide_angles();
        }
        session.collapse_short_edges();
        if policy.flips {
            session.flip_edges();
        }
        let mut joined = Vec::new();
        if policy.separation {
            session.separate_films();
            joined = session.dissolve_specks();
        }
        session.improve_faces();
        let (counts, mut events) = (session.counts, session.events);
        let divisions = if events.is_empty() { Vec::new() } else { self.divide(surface, data, &mut events) };
        Remeshed { counts, events, divisions, joined, remap: self.close_up(surface, data) }
    }

    /// Opens a surface for single operations, in a step of its own.
    pub fn begin<'a>(
        &'a mut self,
        surface: &'a mut Surface,
        policy: &'a Policy,
        data: &'a mut dyn Transfer,
    ) -> Session<'a> {
        self.step += 1;
        self.note_regions(surface);
        Session::new(surface, policy, data, &mut self.marks, self.step)
    }

    /// Regions that are there now keep their numbers to themselves, also once they are gone; open ones that are gone are forgotten.
    fn note_regions(&mut self, surface: &mut Surface) {
        let regions = surface.mesh.regions();
        let largest = regions.last().copied().unwrap_or_default();
        self.next_region = self.next_region.max(Region(largest.0 + 1));
        surface.open.retain(|region| regions.binary_search(region).is_ok());
    }

    /// Gives bodies of gas that came apart labels of their own.
    pub fn divide(&mut self, surface: &mut Surface, data: &mut dyn Transfer, events: &mut Vec<Event>) -> Vec<Division> {
        self.note_regions(surface);
        let divisions = bodies::divide(surface, &mut self.next_region);
        if !divisions.is_empty() {
            data.divide(surface, &divisions);
        }
        events.extend(divisions.iter().map(|division| Event {
            kind: EventKind::Division,
            place: division.place,
            regions: [division.from, division.to].into_iter().collect(),
        }));
        divisions
    }

    /// Closes up rows after operations; `None` if there is nothing to close.
    pub fn close_up(&mut self, surface: &mut Surface, data: &mut dyn Transfer) -> Option<Remap> {
        (!surface.mesh.is_compact()).then(|| {
            let remap = surface.compact();
            self.marks = remap.carry(&self.marks);
            data.compact(&remap);
            remap
        })
    }
}
