//! The numbers that decide which operations are wanted and which are refused: all of them multiples of the target edge length.

use serde::{Deserialize, Serialize};

/// What happens where two films come near each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Contact {
    /// They join: two bubbles in air come to share a wall.
    #[default]
    Merge,
    /// They stop each other; motion never brings them into contact.
    Bounce,
}

/// Where the vertices go that splits make.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Placement {
    /// In the middles of their edges: neither shape nor volumes change.
    #[default]
    Midpoint,
    /// Where the smooth film has the middle (modified butterfly), if nothing is in the way. Volumes change by what lies between: it is
    /// for methods that give bubbles their volumes back.
    Butterfly,
}

/// Thresholds of the tracker. Lengths are multiples of [`Policy::edge`], angles radians.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Policy {
    /// Target edge length `L`, metres.
    pub edge: f64,
    /// Edges shorter than this many `L` are collapsed. Default 0.5.
    pub shortest: f64,
    /// Edges longer than this many `L` are split. Default 1.5.
    pub longest: f64,
    /// Films nearer than this many `L` are joined, under [`Contact::Merge`]. Default 0.1.
    pub snap: f64,
    /// What happens where films come near each other.
    pub contact: Contact,
    /// Whether edges are flipped towards the Delaunay triangulation. Not for data that lives on vertices and jumps.
    pub flips: bool,
    /// By how much the angles opposite to an edge must add up to more than half a turn for a flip, radians. Every flip smooths what vertices
    /// carry a little, and pairs of faces that are Delaunay to a few degrees need none.
    pub flip_excess: f64,
    /// Whether films that meet in a point or a line alone are pulled apart (T1, pinching).
    pub separation: bool,
    /// Where the vertices of splits of long edges go.
    pub placement: Placement,
}

impl Policy {
    /// Collapses below this many `L` may leave a vertex to be separated.
    pub const UNGATED_COLLAPSE: f64 = 0.2;
    /// A collapse that ends a face between two junction curves lower than this many `L` may leave a vertex to be separated,
    /// and change volumes by twice as much as others.
    pub const NARROW_FILM: f64 = 0.1;
    /// Edges from a vertex inside a film that are shorter than this many `L` are collapsed whatever becomes of angles.
    pub const SHORTEST_IN_FILM: f64 = 0.1;
    /// The two vertices that a separation makes are twice this many `L` apart; smaller ones are tried where films are in the way.
    pub const SEPARATIONS: [f64; 3] = [0.2, 0.15, 0.11];
    /// A separation of sectors may enlarge the films around it by this part of their area: a symmetric vertex gains only by the
    /// separations that follow.
    pub const SEPARATION_ALLOWANCE: f64 = 0.05;
    /// A separation at a vertex that films were joined at must shrink them by this part of their area.
    pub const SEPARATION_GAIN: f64 = 1e-3;
    /// Steps for which an edge between two vertices of separations is not collapsed.
    pub const REST_AFTER_SEPARATION: u64 = 3;
    /// Steps for which a vertex that films were joined at is not separated.
    pub const REST_AFTER_SNAP: u64 = 1;
    /// No operation makes faces smaller than this many `L^2`, unless they were.
    pub const LEAST_AREA: f64 = 0.02;
    /// No operation makes angles smaller than this, unless they were: 3 degrees.
    pub const LEAST_ANGLE: f64 = 3.0 / 180.0 * std::f64::consts::PI;
    /// No operation makes angles larger than this, unless they were: 177 degrees.
    pub const LARGEST_ANGLE: f64 = std::f64::consts::PI - Self::LEAST_ANGLE;
    /// No operation brings two faces of a junction nearer to each other than this, unless they were, radians: rounding must not
    /// decide the order of films around an edge.
    pub const LEAST_WEDGE: f64 = 1e-6;
    /// A face with an angle above this is split opposite to it: 160 degrees.
    pub const SPLIT_ANGLE: f64 = 160.0 / 180.0 * std::f64::consts::PI;
    /// Faces with an angle below this are improved where that is possible: 25 degrees.
    pub const GOOD_ANGLE: f64 = 25.0 / 180.0 * std::f64::consts::PI;
    /// Faces with an angle below this are too thin to wait for: 21 degrees.
    pub const NARROW_ANGLE: f64 = 21.0 / 180.0 * std::f64::consts::PI;
    /// Junction curves of one edge, opposite to an angle that is too narrow, are collapsed below this many `L`, as others below
    /// [`Self::UNGATED_COLLAPSE`]: still well below what separations open.
    pub const SQUEEZED_STRUT: f64 = 0.25;
    /// Edges up to this many `L` are collapsed where that improves a face with a small angle.
    pub const COLLAPSE_FOR_SHAPE: f64 = 0.7;
    /// No vertex goes farther than this many `L` for the sake of angles.
    pub const LARGEST_MOVE: f64 = 0.45;
    /// No collapse or flip changes the volume of a region by more than this many `L^3`.
    pub const LARGEST_VOLUME_CHANGE: f64 = 0.01;
    /// No vertex of a split goes farther from the middle of its edge than this part of the edge's length: a film bent that much is not
    /// resolved.
    pub const LARGEST_BULGE: f64 = 0.25;
    /// Two faces that bend by more than this are not flipped: 30 degrees.
    pub const LARGEST_FLIP_BEND: f64 = std::f64::consts::FRAC_PI_6;

    /// The usual thresholds for an edge length, metres.
    #[must_use]
    pub fn new(edge: f64) -> Self {
        Self {
            edge,
            shortest: 0.5,
            longest: 1.5,
            snap: 0.1,
            contact: Contact::Merge,
            flips: false,
            flip_excess: 1e-6,
            separation: true,
            placement: Placement::Midpoint,
        }
    }

    /// Volume of the smallest bubble that the mesh can hold, m^3: a regular tetrahedron of edges `L`.
    #[must_use]
    pub fn least_volume(&self) -> f64 {
        self.edge.powi(3) / (6.0 * std::f64::consts::SQRT_2)
    }
}
