//! What happened to the topology of films, where, and between which regions.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

use crate::rows::Region;

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum EventKind {
    /// Regions that met lost their contact in an edge or a point, and others came to share a film or an edge (T1).
    ///
    /// Those that lost theirs come first. Pulled apart: the two that met in a point, then those that now meet where these did, ascending.
    /// An edge that gave way to a film: those that met along the edge, in cyclic order, then the two that the film separates.
    T1,
    /// A film came apart in a point: a neck closed. Where its faces came to lie on each other: the region on their outer sides first.
    Pinch,
    /// Two regions that were apart came to share a film.
    Coalescence,
    /// Two films of the same two regions joined, and opened a window: one that grows is the same one.
    Window,
    /// A region vanished with its last film (T2).
    Vanished,
    /// A region came apart into two.
    Division,
    /// A film burst, and two regions became one.
    Burst,
}

impl EventKind {
    /// Name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::T1 => "t1",
            Self::Pinch => "pinch",
            Self::Coalescence => "coalescence",
            Self::Window => "window",
            Self::Vanished => "vanished",
            Self::Division => "division",
            Self::Burst => "burst",
        }
    }
}

/// One change of topology.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// What happened.
    pub kind: EventKind,
    /// Where, metres.
    pub place: DVec3,
    /// Between which regions: those that were named first in [`EventKind`] come first.
    pub regions: SmallVec<[Region; 4]>,
}
