//! Sectors: the pieces of gas that meet at a vertex, and which of them share no film there.
//!
//! A small sphere around a vertex is cut by the vertex's faces into sectors. They are found by joining face sides that look at each
//! other around every edge of the vertex:
//!
//! ```text
//!   looking along an edge v -> w          each face has an AFTER side (counter-clockwise) and a BEFORE side;
//!                                         the after side of a face looks at the before side of the next.
//!        \  after                         A face that contains v -> w has its front after, its back before;
//!  before \                               one that contains w -> v the other way round.
//!          o------
//! ```
//!
//! Discretisation: nodes of the link graph are edges `(v, w)`, arcs are faces. With `E` arcs, `N` nodes and `C` components the sides
//! fall into `E - N + 2C` classes if every component is planar, and each class has one region. For `C = 1` the classes are the sectors.
//! Two sectors without a face between them are to be separated; for `C > 1` the components are.
//! Source: the sector formulation of T1 and pinching; see [`Session::separate`](crate::operations::Session::separate).
//! Limits: where films are tangled so that sides that look at each other disagree in region, [`Sectors::is_tangled`] says so.

use std::f64::consts::TAU;

use glam::DVec3;
use smallvec::SmallVec;

use crate::links::Links;
use crate::mesh::{Face, SurfaceMesh};
use crate::rows::{Region, VertexRow};

/// The sectors of a vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct Sectors {
    /// Class of each face side: `2 f` is the back of the `f`-th face, `2 f + 1` its front.
    class_of: SmallVec<[u16; 32]>,
    /// Region of each class.
    regions: SmallVec<[Region; 8]>,
    /// Component of the link graph that each face belongs to.
    component_of: SmallVec<[u16; 16]>,
    components: usize,
    tangled: bool,
    /// Least angle between neighbouring faces of an edge with more than two, radians.
    narrowest: f64,
}

/// A way to pull a vertex apart: which of its faces go with the first of the two vertices that it becomes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Candidate {
    /// Per face of the star: whether it goes.
    pub goes: SmallVec<[bool; 16]>,
    /// The two regions that meet at the vertex alone; the same region twice for a component.
    pub regions: [Region; 2],
    /// Whether a whole component of the link goes: films that touch in a point without sharing an edge.
    pub is_component: bool,
}

/// The most faces around a vertex that sectors are found for; more is a tangle.
const MOST_FACES: usize = 16_383;

impl Sectors {
    /// The sectors of `vertex` with these faces. `at` gives positions.
    #[must_use]
    pub fn of(vertex: VertexRow, faces: &[Face], at: &impl Fn(VertexRow) -> DVec3) -> Self {
        if faces.len() > MOST_FACES {
            return Self::tangle(faces.len());
        }
        let mut sides = Links::new(2 * faces.len());
        let mut link = Links::new(faces.len());
        let (mut tangled, mut narrowest) = (false, f64::INFINITY);
        let mut nodes = 0;
        for (neighbour, around) in edges(vertex, faces) {
            nodes += 1;
            around.iter().for_each(|face| link.join(around[0], *face));
            let facing = facing(vertex, neighbour, &around, faces, at);
            facing.pairs.into_iter().for_each(|(after, before)| sides.join(after, before));
            tangled |= !facing.agree;
            narrowest = narrowest.min(facing.narrowest);
        }
        let (class_of, classes) = numbered(sides);
        let (component_of, components) = numbered(link);
        let mut regions: SmallVec<[Region; 8]> = SmallVec::from_elem(Region(u32::MAX), classes);
        for (side, class) in class_of.iter().enumerate() {
            let region = faces[side / 2].labels()[side % 2];
            let of_class = &mut regions[usize::from(*class)];
            tangled |= of_class.0 != u32::MAX && *of_class != region;
            *of_class = region;
        }
        tangled |= classes + nodes != faces.len() + 2 * components;
        Self { class_of, regions, component_of, components, tangled, narrowest }
    }

    fn tangle(faces: usize) -> Self {
        let nothing = SmallVec::from_elem(0, faces);
        Self {
            class_of: SmallVec::new(),
            regions: SmallVec::new(),
            component_of: nothing,
            components: 1,
            tangled: true,
            narrowest: 0.0,
        }
    }

    /// Whether sides that look at each other disagree in region, or a component is not planar.
    #[must_use]
    pub fn is_tangled(&self) -> bool {
        self.tangled
    }

    /// Least angle between neighbouring faces of an edge with more than two, radians; infinite where there is no such edge.
    ///
    /// Below some `1e-12` rounding decides which comes first.
    #[must_use]
    pub fn narrowest(&self) -> f64 {
        self.narrowest
    }

    /// Components of the link: 1 unless films touch in the vertex alone.
    #[must_use]
    pub fn components(&self) -> usize {
        self.components
    }

    /// Number of sectors; that of side classes where the link has several components.
    #[must_use]
    pub fn count(&self) -> usize {
        self.regions.len()
    }

    /// Sectors behind and in front of a face, by its place in the star.
    #[must_use]
    pub fn sides(&self, face: usize) -> [u16; 2] {
        [self.class_of[2 * face], self.class_of[2 * face + 1]]
    }

    /// Region of a sector.
    #[must_use]
    pub fn region(&self, sector: u16) -> Region {
        self.regions[usize::from(sector)]
    }

    /// Ways to separate what meets at the vertex without a film between: none at a regular vertex, none at a tangled one.
    #[must_use]
    pub fn candidates(&self) -> Vec<Candidate> {
        match self.components {
            _ if self.tangled => Vec::new(),
            0 | 1 => self.sector_pairs(),
            _ => (0..self.components).map(|component| self.component(component)).collect(),
        }
    }

    /// Whether there is nothing to separate.
    #[must_use]
    pub fn is_regular(&self) -> bool {
        !self.tangled && self.components <= 1 && self.first_apart().is_none()
    }

    fn component(&self, component: usize) -> Candidate {
        let goes: SmallVec<[bool; 16]> = self.component_of.iter().map(|c| usize::from(*c) == component).collect();
        let face = goes.iter().position(|goes| *goes).expect("invariant: a component has faces");
        let side = |side: usize| self.regions[usize::from(self.class_of[2 * face + side])];
        Candidate { goes, regions: [side(0), side(1)], is_component: true }
    }

    fn are_adjacent(&self, a: usize, b: usize) -> bool {
        self.class_of.chunks_exact(2).any(|sides| {
            let (back, front) = (usize::from(sides[0]), usize::from(sides[1]));
            (back, front) == (a, b) || (back, front) == (b, a)
        })
    }

    fn first_apart(&self) -> Option<(usize, usize)> {
        let classes = self.regions.len();
        (0..classes).flat_map(|a| (0..a).map(move |b| (a, b))).find(|(a, b)| !self.are_adjacent(*a, *b))
    }

    fn sector_pairs(&self) -> Vec<Candidate> {
        let classes = self.regions.len();
        let pairs = (0..classes).flat_map(|a| (0..classes).map(move |b| (a, b)));
        let apart = pairs.filter(|(a, b)| a != b && !self.are_adjacent(*a, *b));
        apart.map(|(a, b)| self.with_sector(a, b)).collect()
    }

    /// The candidate in which the faces of sector `a` go.
    fn with_sector(&self, a: usize, b: usize) -> Candidate {
        let goes = self.class_of.chunks_exact(2).map(|sides| sides.iter().any(|class| usize::from(*class) == a));
        Candidate { goes: goes.collect(), regions: [self.regions[a], self.regions[b]], is_component: false }
    }
}

/// The edges of a vertex: each neighbour, ascending, with the places of its faces in `faces`.
fn edges(vertex: VertexRow, faces: &[Face]) -> Vec<(VertexRow, SmallVec<[usize; 4]>)> {
    let mut ends: SmallVec<[(VertexRow, usize); 32]> =
        faces.iter().enumerate().flat_map(|(place, face)| face.around(vertex).map(|w| (w, place))).collect();
    ends.sort_unstable();
    let mut edges: Vec<(VertexRow, SmallVec<[usize; 4]>)> = Vec::new();
    for (neighbour, place) in ends {
        match edges.last_mut() {
            Some((last, around)) if *last == neighbour => around.push(place),
            _ => edges.push((neighbour, SmallVec::from_slice(&[place]))),
        }
    }
    edges
}

/// What faces around an edge show to each other.
struct Facing {
    /// Sides (`2 place + side`) that look at each other.
    pairs: SmallVec<[(usize, usize); 4]>,
    /// Whether all of them agree in region.
    agree: bool,
    /// Least angle between neighbours, radians; infinite for two faces.
    narrowest: f64,
}

/// The sides that look at each other around an edge.
fn facing(
    vertex: VertexRow,
    neighbour: VertexRow,
    around: &[usize],
    faces: &[Face],
    at: &impl Fn(VertexRow) -> DVec3,
) -> Facing {
    let (ordered, narrowest) = in_angular_order(vertex, neighbour, around, faces, at);
    let after = |place: usize| 2 * place + usize::from(faces[place].direction(vertex, neighbour) > 0);
    let before = |place: usize| after(place) ^ 1;
    let region = |side: usize| faces[side / 2].labels()[side % 2];
    let next = |i: usize| ordered[(i + 1) % ordered.len()];
    let in_order = |i: usize| (after(ordered[i]), before(next(i)));
    if (0..ordered.len()).all(|i| region(in_order(i).0) == region(in_order(i).1)) {
        return Facing { pairs: (0..ordered.len()).map(in_order).collect(), agree: true, narrowest };
    }
    // Tangled films: each after side takes the next free before side of its region.
    let mut is_free: SmallVec<[bool; 8]> = SmallVec::from_elem(true, ordered.len());
    let mut pairs = SmallVec::new();
    for i in 0..ordered.len() {
        let candidates = (1..=ordered.len()).map(|k| (i + k) % ordered.len());
        let mut fitting =
            candidates.filter(|j| is_free[*j] && region(before(ordered[*j])) == region(after(ordered[i])));
        if let Some(j) = fitting.next() {
            is_free[j] = false;
            pairs.push((after(ordered[i]), before(ordered[j])));
        }
    }
    Facing { pairs, agree: false, narrowest }
}

/// Sides that look at each other around an edge of a mesh, as pairs of `2 face + side` (side 0 the back, 1 the front).
pub(crate) fn facing_sides(
    mesh: &SurfaceMesh,
    [a, b]: [VertexRow; 2],
    at: &impl Fn(VertexRow) -> DVec3,
) -> SmallVec<[(usize, usize); 4]> {
    let rows = mesh.faces_of_edge(a, b);
    let faces: SmallVec<[Face; 4]> = rows.iter().map(|row| mesh.face(*row)).collect();
    let places: SmallVec<[usize; 4]> = (0..faces.len()).collect();
    let side = |side: usize| 2 * rows[side / 2].index() + side % 2;
    let facing = facing(a, b, &places, &faces, at);
    facing.pairs.into_iter().map(|(after, before)| (side(after), side(before))).collect()
}

/// Faces of an edge, counter-clockwise as seen along it from `vertex`, and the least angle between neighbours if they are more than two.
fn in_angular_order(
    vertex: VertexRow,
    neighbour: VertexRow,
    around: &[usize],
    faces: &[Face],
    at: &impl Fn(VertexRow) -> DVec3,
) -> (SmallVec<[usize; 4]>, f64) {
    if around.len() <= 2 {
        return (SmallVec::from_slice(around), f64::INFINITY);
    }
    let (origin, axis) = (at(vertex), (at(neighbour) - at(vertex)).normalize_or_zero());
    let radial = |place: usize| {
        let towards = at(faces[place].opposite(vertex, neighbour)) - origin;
        (towards - axis * towards.dot(axis)).normalize_or_zero()
    };
    let first = radial(around[0]);
    let second = axis.cross(first);
    let angle = |place: usize| {
        let r = radial(place);
        let angle = r.dot(second).atan2(r.dot(first));
        if angle < 0.0 { angle + TAU } else { angle }
    };
    let rest = around[1..].iter().map(|place| (angle(*place), *place));
    let mut ordered: SmallVec<[(f64, usize); 4]> = std::iter::once((0.0, around[0])).chain(rest).collect();
    ordered[1..].sort_by(|a, b| a.0.total_cmp(&b.0));
    let last = TAU - ordered[ordered.len() - 1].0;
    let narrowest = ordered.windows(2).map(|pair| pair[1].0 - pair[0].0).fold(last, f64::min);
    (ordered.into_iter().map(|(_, place)| place).collect(), narrowest)
}

/// Class of each thing, numbered in order of first appearance, and how many there are.
fn numbered<A: smallvec::Array<Item = u16>>(mut links: Links) -> (SmallVec<A>, usize) {
    let classes: SmallVec<A> = links.numbered(|_| true).flatten().map(|class| class as u16).collect();
    let count = classes.iter().max().map_or(0, |last| usize::from(*last) + 1);
    (classes, count)
}
