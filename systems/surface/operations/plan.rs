//! The plan of an operation: everything that it would change, worked out without touching the mesh.

use glam::DVec3;
use smallvec::SmallVec;

use crate::mesh::{Face, FaceList};
use crate::rows::{FaceRow, Region, VertexRow};
use crate::surface::Surface;
use crate::transfer::Blend;

/// A face that a plan adds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Added {
    /// The face.
    pub face: Face,
    /// The face that it takes the place of, if it is one face in another shape.
    pub origin: Option<FaceRow>,
}

/// A tetrahedron `(from, to, x, y)` that a moved vertex sweeps with one of its faces `(vertex, x, y)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// The vertex that moves.
    pub vertex: VertexRow,
    /// Where it goes, metres.
    pub to: DVec3,
    /// The other two vertices of the face.
    pub base: [VertexRow; 2],
}

/// What an operation would change.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// New vertices, place and whether they are pinned; they take the rows after the last.
    pub created: SmallVec<[(DVec3, bool); 1]>,
    /// Vertices that move.
    pub moved: SmallVec<[(VertexRow, DVec3); 2]>,
    /// Faces that go.
    pub removed: SmallVec<[FaceRow; 16]>,
    /// Faces that come.
    pub added: SmallVec<[Added; 16]>,
    /// Faces that stay, with a vertex that moves.
    pub reshaped: SmallVec<[FaceRow; 16]>,
    /// What moving vertices sweep.
    pub sweeps: SmallVec<[Sweep; 16]>,
    /// How data blends.
    pub blends: SmallVec<[Blend; 2]>,
    /// Films that close a gap: `(back, between, front)`.
    pub fused: SmallVec<[(Region, Region, Region); 2]>,
    /// Films of the same two regions that join in a window: `(outer, between)`.
    pub windows: SmallVec<[(Region, Region); 2]>,
    /// A region that is joined to another: `(gone, into)`.
    pub joined: Option<(Region, Region)>,
    /// Whether films meet or part by it, as a snap or a separation makes them.
    pub meets: bool,
}

impl Plan {
    /// Where a vertex is once the plan is carried out.
    #[must_use]
    pub fn at(&self, surface: &Surface, vertex: VertexRow) -> DVec3 {
        if let Some((_, place)) = self.moved.iter().find(|(moved, _)| *moved == vertex) {
            return *place;
        }
        match vertex.index().checked_sub(surface.positions.len()) {
            Some(new) => self.created[new].0,
            None => surface.positions[vertex],
        }
    }

    /// Corners of a face once the plan is carried out.
    #[must_use]
    pub fn corners(&self, surface: &Surface, face: &Face) -> [DVec3; 3] {
        face.vertices().map(|v| self.at(surface, v))
    }

    /// Faces of a vertex once the plan is carried out.
    #[must_use]
    pub fn star(&self, surface: &Surface, vertex: VertexRow) -> SmallVec<[Face; 16]> {
        let is_old = vertex.index() < surface.mesh.vertex_rows();
        let old: &[FaceRow] = if is_old { surface.mesh.faces_of(vertex) } else { &[] };
        let kept = old.iter().filter(|row| !self.removed.contains(row)).map(|row| surface.mesh.face(*row));
        let added = self.added.iter().map(|added| added.face).filter(|face| face.has(vertex));
        kept.chain(added).collect()
    }

    /// Whether an edge is a junction once the plan is carried out: whether it has any number of faces but two.
    #[must_use]
    pub fn is_junction(&self, surface: &Surface, a: VertexRow, b: VertexRow) -> bool {
        let is_old = a.max(b).index() < surface.mesh.vertex_rows();
        let old = if is_old { surface.mesh.faces_of_edge(a, b) } else { FaceList::new() };
        let kept = old.iter().filter(|row| !self.removed.contains(row)).count();
        kept + self.added.iter().filter(|added| added.face.has(a) && added.face.has(b)).count() != 2
    }

    /// Moves a vertex, and notes what its faces sweep.
    pub fn move_vertex(&mut self, surface: &Surface, vertex: VertexRow, to: DVec3) {
        self.moved.push((vertex, to));
        self.sweep(surface, vertex, surface.mesh.faces_of(vertex), to);
    }

    /// Notes what faces of a vertex sweep when it goes to a place.
    pub fn sweep(&mut self, surface: &Surface, vertex: VertexRow, faces: &[FaceRow], to: DVec3) {
        if surface.positions[vertex] == to {
            return;
        }
        let base = |face: &FaceRow| Sweep { vertex, to, base: surface.mesh.face(*face).around(vertex) };
        self.sweeps.extend(faces.iter().map(base));
    }

    /// Fills [`Plan::reshaped`] from what moves and what goes.
    pub fn note_reshaped(&mut self, surface: &Surface) {
        let faces = self.moved.iter().flat_map(|(v, _)| surface.mesh.faces_of(*v)).copied();
        let mut reshaped: SmallVec<[FaceRow; 16]> = faces.filter(|face| !self.removed.contains(face)).collect();
        reshaped.sort_unstable();
        reshaped.dedup();
        self.reshaped = reshaped;
    }

    /// Faces whose shape is new: those that come, and those that stay with a vertex that moves.
    pub fn shaped(&self, surface: &Surface) -> impl Iterator<Item = (Face, Option<FaceRow>)> {
        let reshaped = self.reshaped.iter().map(|row| (surface.mesh.face(*row), Some(*row)));
        self.added.iter().map(|added| (added.face, added.origin)).chain(reshaped)
    }

    /// Vertices whose faces change, ascending; new ones last.
    #[must_use]
    pub fn touched(&self, surface: &Surface) -> SmallVec<[VertexRow; 24]> {
        let old = self.removed.iter().chain(&self.reshaped).flat_map(|row| surface.mesh.face(*row).vertices());
        let new = self.added.iter().flat_map(|added| added.face.vertices());
        let mut touched: SmallVec<[VertexRow; 24]> = old.chain(new).collect();
        touched.sort_unstable();
        touched.dedup();
        touched
    }

    /// How much the Euler characteristic of the films, `vertices - edges + faces`, changes: down by one where two films open a window or
    /// meet in a point, up by one where a neck closes, not at all where the mesh alone is another.
    #[must_use]
    pub fn euler_change(&self, surface: &Surface) -> i64 {
        let mesh = &surface.mesh;
        let stays = |row: &FaceRow| !self.removed.contains(row);
        let touched = self.touched(surface);
        let is_old = |v: VertexRow| v.index() < mesh.vertex_rows();
        let vertices = touched.iter().map(|v| {
            let before = is_old(*v) && mesh.has_vertex(*v);
            i64::from(!self.star(surface, *v).is_empty()) - i64::from(before)
        });
        let gone = self.removed.iter().map(|row| mesh.face(*row));
        let mut edges: SmallVec<[[VertexRow; 2]; 48]> =
            gone.chain(self.added.iter().map(|added| added.face)).flat_map(|face| face.edges()).collect();
        edges.sort_unstable();
        edges.dedup();
        let edges = edges.iter().map(|[a, b]| {
            let old = if is_old(*b) { mesh.faces_of_edge(*a, *b) } else { FaceList::new() };
            let comes = self.added.iter().any(|added| added.face.has(*a) && added.face.has(*b));
            i64::from(comes || old.iter().any(stays)) - i64::from(!old.is_empty())
        });
        vertices.sum::<i64>() - edges.sum::<i64>() + self.added.len() as i64 - self.removed.len() as i64
    }

    /// How much the volume of each region changes, m^3: exact, since what goes and what comes bound the same cavity.
    #[must_use]
    pub fn volume_changes(&self, surface: &Surface) -> SmallVec<[(Region, f64); 4]> {
        let mut changes: SmallVec<[(Region, f64); 4]> = SmallVec::new();
        let touched = self.removed.first().or(self.reshaped.first());
        let Some(origin) = touched.map(|row| surface.corners(*row)[0]) else { return changes };
        let mut count = |face: &Face, corners: [DVec3; 3], sign: f64| {
            let [a, b, c] = corners.map(|x| x - origin);
            let part = sign * a.dot(b.cross(c)) / 6.0;
            let [back, front] = face.labels();
            for (region, part) in [(back, part), (front, -part)] {
                match changes.iter_mut().find(|(other, _)| *other == region) {
                    Some((_, sum)) => *sum += part,
                    None => changes.push((region, part)),
                }
            }
        };
        for row in self.removed.iter().chain(&self.reshaped) {
            count(&surface.mesh.face(*row), surface.corners(*row), -1.0);
        }
        for (face, _) in self.shaped(surface) {
            count(&face, self.corners(surface, &face), 1.0);
        }
        changes
    }
}

/// What a group of faces with the same three vertices becomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trimmed {
    /// They cancel: the same region is on both sides.
    Nothing,
    /// One film, with these labels.
    Film([Region; 2]),
    /// Geometry of unknown order, or a ghost over a film.
    Refused,
}

/// Trims coincident faces: their labels, all in the winding of the stored (ascending) order, add up.
///
/// Equation: `n = sum of (e_back - e_front)`; `0` deletes all, `e_P - e_Q` leaves one film with back `P` and front `Q`.
#[must_use]
pub fn trim(faces: &[Face]) -> Trimmed {
    let mut net: SmallVec<[(Region, i32); 4]> = SmallVec::new();
    for face in faces {
        add_labels(&mut net, face.labels(), 1);
    }
    match as_film(&net) {
        _ if faces.iter().any(|face| face.is_ghost() != faces[0].is_ghost()) => Trimmed::Refused,
        Ok(None) => Trimmed::Nothing,
        Ok(Some(labels)) => Trimmed::Film(labels),
        Err(()) => Trimmed::Refused,
    }
}

/// Adds `sign * (e_back - e_front)` to a balance.
pub(super) fn add_labels(balance: &mut SmallVec<[(Region, i32); 4]>, labels: [Region; 2], sign: i32) {
    for (region, part) in [(labels[0], sign), (labels[1], -sign)] {
        match balance.iter_mut().find(|(other, _)| *other == region) {
            Some((_, sum)) => *sum += part,
            None => balance.push((region, part)),
        }
    }
}

/// A balance as one film: nothing for 0, `[P, Q]` for `e_P - e_Q`, an error for anything else.
///
/// # Errors
/// When more than one film would be needed.
pub(super) fn as_film(balance: &[(Region, i32)]) -> Result<Option<[Region; 2]>, ()> {
    let mut rest: SmallVec<[(Region, i32); 4]> = balance.iter().copied().filter(|(_, part)| *part != 0).collect();
    rest.sort_unstable_by_key(|(_, part)| -part);
    match rest.as_slice() {
        [] => Ok(None),
        [(back, 1), (front, -1)] => Ok(Some([*back, *front])),
        _ => Err(()),
    }
}

/// Removes faces `gone` of a plan in which `from` becomes `to`, and trims what comes to lie on each other.
///
/// Returns false where the trimming is refused.
pub(super) fn replace_vertex(plan: &mut Plan, surface: &Surface, from: VertexRow, to: VertexRow) -> bool {
    let mesh = &surface.mesh;
    for row in mesh.faces_of(from) {
        let face = mesh.face(*row);
        plan.removed.push(*row);
        if face.has(to) {
            continue;
        }
        let new = face.with_replaced(from, to);
        let Some(there) = mesh.face_with(new.vertices()) else {
            plan.added.push(Added { face: new, origin: Some(*row) });
            continue;
        };
        let other = mesh.face(there);
        plan.removed.push(there);
        match trim(&[new, other]) {
            Trimmed::Refused => return false,
            Trimmed::Nothing => note_window(plan, other, surface.corners(there), surface.positions[from]),
            Trimmed::Film(labels) => {
                let film = Face::new(new.vertices(), labels).as_ghost(new.is_ghost());
                plan.added.push(Added { face: film, origin: Some(there) });
                note_fusion(plan, new, other);
            }
        }
    }
    true
}

/// The region between two faces that lie on each other, and those on the outer sides.
fn between(a: Face, b: Face) -> Option<(Region, Region, Region)> {
    let ([a_back, a_front], [b_back, b_front]) = (a.labels(), b.labels());
    if a_front == b_back {
        Some((a_back, a_front, b_front))
    } else if b_front == a_back {
        Some((b_back, b_front, a_front))
    } else {
        None
    }
}

fn note_fusion(plan: &mut Plan, a: Face, b: Face) {
    plan.fused.extend(between(a, b));
}

/// Notes a window: the region between is the one that `other` shows to the place that its twin's vertex came from; the one with
/// the lower label where that is in its plane but for rounding.
fn note_window(plan: &mut Plan, other: Face, [a, b, c]: [DVec3; 3], from: DVec3) {
    const FLAT: f64 = 1e-9;
    let [back, front] = other.labels();
    let normal = (b - a).cross(c - a);
    let (ahead, whole) = (normal.dot(from - a), normal.length().powf(1.5));
    plan.windows.push(match ahead {
        _ if ahead.abs() <= FLAT * whole => (back.max(front), back.min(front)),
        ahead if ahead > 0.0 => (back, front),
        _ => (front, back),
    });
}
