//! Connectivity with region labels: triangles between gas regions, any number of them on an edge.
//!
//! ```text
//!            c                    The right-hand normal of (a, b, c) points from the BACK region into the FRONT region:
//!           / \                   labels = [back, front]. A bubble 1 in the outside 0 has labels [1, 0] with its normals
//!          / ^ \  front           pointing outwards.
//!         /  |n \                 Swapping two vertices together with the labels is the same face. To make that true by
//!        a-------b   back         construction, every face is stored with its vertices in ascending order.
//! ```
//!
//! Nothing but faces is stored, and per vertex the faces around it: edges are pairs of vertices that share a face. Rows of
//! deleted faces and vertices stay vacant until [`SurfaceMesh::compact`], so that row numbers live as long as a pass of
//! operations; lists of faces are always in ascending order, which makes every traversal deterministic.

use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

use crate::rows::{FaceRow, PerVertex, Region, VertexRow};

/// A few faces: those of an edge or of a vertex.
pub type FaceList = SmallVec<[FaceRow; 8]>;
/// A few vertices: the neighbours of a vertex.
pub type VertexList = SmallVec<[VertexRow; 12]>;

/// A triangle between two regions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Face {
    vertices: [VertexRow; 3],
    labels: [Region; 2],
    ghost: bool,
}

impl Face {
    /// A film between `labels = [back, front]`; the right-hand normal of `vertices` points from back to front.
    #[must_use]
    pub fn new(vertices: [VertexRow; 3], labels: [Region; 2]) -> Self {
        let (mut v, mut l) = (vertices, labels);
        for (i, j) in [(0, 1), (1, 2), (0, 1)] {
            if v[j] < v[i] {
                v.swap(i, j);
                l.swap(0, 1);
            }
        }
        Self { vertices: v, labels: l, ghost: false }
    }

    /// The same face as a ghost: it closes a region but is no film; dynamics and pictures pass it over.
    #[must_use]
    pub fn as_ghost(self, ghost: bool) -> Self {
        Self { ghost, ..self }
    }

    /// Its vertices, ascending.
    #[must_use]
    #[inline]
    pub const fn vertices(&self) -> [VertexRow; 3] {
        self.vertices
    }

    /// Its labels: `[back, front]`.
    #[must_use]
    #[inline]
    pub const fn labels(&self) -> [Region; 2] {
        self.labels
    }

    /// Whether it only closes a region.
    #[must_use]
    #[inline]
    pub const fn is_ghost(&self) -> bool {
        self.ghost
    }

    /// Whether it has the vertex.
    #[must_use]
    #[inline]
    pub fn has(&self, vertex: VertexRow) -> bool {
        self.vertices.contains(&vertex)
    }

    /// Whether it borders the region.
    #[must_use]
    pub fn borders(&self, region: Region) -> bool {
        self.labels.contains(&region)
    }

    /// The vertex that is neither `a` nor `b`.
    #[must_use]
    #[inline]
    pub fn opposite(&self, a: VertexRow, b: VertexRow) -> VertexRow {
        let others = self.vertices.iter().find(|v| **v != a && **v != b);
        *others.expect("invariant: a face has three vertices")
    }

    /// The other two vertices, in the order that makes `(vertex, second, third)` the face's own winding.
    #[must_use]
    #[inline]
    pub fn around(&self, vertex: VertexRow) -> [VertexRow; 2] {
        let [a, b, c] = self.vertices;
        match vertex {
            v if v == a => [b, c],
            v if v == b => [c, a],
            _ => [a, b],
        }
    }

    /// Its edges, each with the lower row first.
    #[must_use]
    pub fn edges(&self) -> [[VertexRow; 2]; 3] {
        let [a, b, c] = self.vertices;
        [[a, b], [b, c], [a, c]]
    }

    /// `+1` if the face contains the directed edge `a -> b`, `-1` if it contains `b -> a`.
    #[must_use]
    #[inline]
    pub fn direction(&self, a: VertexRow, b: VertexRow) -> i32 {
        if self.around(a)[0] == b { 1 } else { -1 }
    }

    /// The face with `from` replaced by `to`; its labels stay on their sides.
    #[must_use]
    pub fn with_replaced(&self, from: VertexRow, to: VertexRow) -> Self {
        let vertices = self.vertices.map(|v| if v == from { to } else { v });
        Self::new(vertices, self.labels).as_ghost(self.ghost)
    }

    /// The face with every label passed through `relabel`.
    #[must_use]
    pub fn with_labels(&self, relabel: impl Fn(Region) -> Region) -> Self {
        Self { labels: self.labels.map(relabel), ..*self }
    }

    /// Whether the same vertex occurs twice.
    #[must_use]
    pub fn is_degenerate(&self) -> bool {
        self.vertices[0] == self.vertices[1] || self.vertices[1] == self.vertices[2]
    }
}

/// Triangles with labels, and the faces around every vertex.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bevy_ecs", derive(bevy_ecs::resource::Resource))]
pub struct SurfaceMesh {
    faces: Vec<Option<Face>>,
    around: PerVertex<FaceList>,
    live_faces: usize,
}

/// Where rows went in a compaction: `None` for what was deleted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Remap {
    /// New row of each old vertex.
    pub vertices: Vec<Option<VertexRow>>,
    /// New row of each old face.
    pub faces: Vec<Option<FaceRow>>,
}

impl Remap {
    /// Drops the values of vertices that go from a list with one per row.
    pub fn close_up<T>(&self, values: &mut Vec<T>) {
        let mut rows = self.vertices.iter();
        values.retain(|_| rows.next().is_some_and(Option::is_some));
    }

    /// Values of the vertices that stay, in their new rows.
    #[must_use]
    pub fn carry<T: Copy>(&self, values: &PerVertex<T>) -> PerVertex<T> {
        let kept = self.vertices.iter().zip(values.iter()).filter(|(row, _)| row.is_some());
        PerVertex(kept.map(|(_, value)| *value).collect())
    }
}

impl SurfaceMesh {
    /// A mesh of `vertices` vertices and these faces.
    #[must_use]
    pub fn new(vertices: usize, faces: impl IntoIterator<Item = Face>) -> Self {
        let mut mesh = Self::default();
        mesh.around.resize_with(vertices, FaceList::new);
        for face in faces {
            mesh.add_face(face);
        }
        mesh
    }

    /// Rows of vertices, vacant ones counted.
    #[must_use]
    pub fn vertex_rows(&self) -> usize {
        self.around.len()
    }

    /// Rows of faces, vacant ones counted.
    #[must_use]
    pub fn face_rows(&self) -> usize {
        self.faces.len()
    }

    /// Faces that exist.
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.live_faces
    }

    /// The face of a row, if it exists.
    #[must_use]
    #[inline]
    pub fn get(&self, row: FaceRow) -> Option<&Face> {
        self.faces.get(row.index())?.as_ref()
    }

    /// The face of a row.
    ///
    /// # Panics
    /// When it was deleted.
    #[must_use]
    #[inline]
    pub fn face(&self, row: FaceRow) -> Face {
        self.faces[row.index()].expect("invariant: rows of deleted faces are not kept")
    }

    /// Whether a vertex has faces.
    #[must_use]
    #[inline]
    pub fn has_vertex(&self, vertex: VertexRow) -> bool {
        self.around.get(vertex.index()).is_some_and(|faces| !faces.is_empty())
    }

    /// All faces, ascending.
    pub fn faces(&self) -> impl Iterator<Item = (FaceRow, &Face)> {
        self.faces.iter().enumerate().filter_map(|(row, face)| Some((FaceRow(row as u32), face.as_ref()?)))
    }

    /// All vertices that have faces, ascending.
    pub fn vertices(&self) -> impl Iterator<Item = VertexRow> + '_ {
        (0..self.around.len() as u32).map(VertexRow).filter(|v| self.has_vertex(*v))
    }

    /// Faces around a vertex, ascending.
    #[must_use]
    #[inline]
    pub fn faces_of(&self, vertex: VertexRow) -> &[FaceRow] {
        &self.around[vertex]
    }

    /// Faces of an edge, ascending; none where the vertices share no face.
    #[must_use]
    pub fn faces_of_edge(&self, a: VertexRow, b: VertexRow) -> FaceList {
        let (few, other) = if self.around[a].len() <= self.around[b].len() { (a, b) } else { (b, a) };
        self.around[few].iter().copied().filter(|face| self.face(*face).has(other)).collect()
    }

    /// Whether two vertices share a face.
    #[must_use]
    pub fn has_edge(&self, a: VertexRow, b: VertexRow) -> bool {
        self.around[a].iter().any(|face| self.face(*face).has(b))
    }

    /// The face with exactly these vertices.
    #[must_use]
    pub fn face_with(&self, vertices: [VertexRow; 3]) -> Option<FaceRow> {
        let wanted = Face::new(vertices, [Region(0), Region(1)]).vertices;
        self.around[wanted[0]].iter().copied().find(|face| self.face(*face).vertices == wanted)
    }

    /// Vertices that share a face with a vertex, ascending.
    #[must_use]
    pub fn neighbours(&self, vertex: VertexRow) -> VertexList {
        let mut found = VertexList::new();
        for face in &self.around[vertex] {
            found.extend(self.face(*face).around(vertex));
        }
        found.sort_unstable();
        found.dedup();
        found
    }

    /// All edges `(a, b)` with `a < b`, ascending.
    #[must_use]
    pub fn edges(&self) -> Vec<[VertexRow; 2]> {
        let mut edges = Vec::with_capacity(self.live_faces * 3 / 2);
        for a in self.vertices() {
            let from = edges.len();
            for face in &self.around[a] {
                for b in self.face(*face).vertices {
                    if b > a && !edges[from..].contains(&[a, b]) {
                        edges.push([a, b]);
                    }
                }
            }
            edges[from..].sort_unstable();
        }
        edges
    }

    /// Labels that occur, ascending.
    #[must_use]
    pub fn regions(&self) -> Vec<Region> {
        let mut seen: Vec<bool> = Vec::new();
        for (_, face) in self.faces() {
            for label in face.labels {
                if seen.len() <= label.index() {
                    seen.resize(label.index() + 1, false);
                }
                seen[label.index()] = true;
            }
        }
        (0..).zip(seen).filter(|(_, is_seen)| *is_seen).map(|(label, _)| Region(label)).collect()
    }

    /// Regions that a vertex touches, ascending.
    #[must_use]
    pub fn regions_of(&self, vertex: VertexRow) -> SmallVec<[Region; 4]> {
        let mut regions: SmallVec<[Region; 4]> = SmallVec::new();
        for face in &self.around[vertex] {
            for label in self.face(*face).labels {
                if !regions.contains(&label) {
                    regions.push(label);
                }
            }
        }
        regions.sort_unstable();
        regions
    }

    /// A new vertex without faces.
    pub fn add_vertex(&mut self) -> VertexRow {
        self.around.push(FaceList::new());
        VertexRow(self.around.len() as u32 - 1)
    }

    /// Adds a face in a new row.
    pub fn add_face(&mut self, face: Face) -> FaceRow {
        let row = FaceRow(self.faces.len() as u32);
        self.faces.push(Some(face));
        self.live_faces += 1;
        for vertex in face.vertices {
            self.around[vertex].push(row);
        }
        row
    }

    /// Deletes a face.
    ///
    /// # Panics
    /// When it was deleted before.
    pub fn remove_face(&mut self, row: FaceRow) -> Face {
        let face = self.faces[row.index()].take().expect("invariant: a face is deleted once");
        self.live_faces -= 1;
        for vertex in face.vertices {
            self.around[vertex].retain(|other| *other != row);
        }
        face
    }

    /// Passes every label through `relabel`.
    pub fn relabel(&mut self, row: FaceRow, relabel: impl Fn(Region) -> Region) {
        let face = self.faces[row.index()].as_mut().expect("invariant: rows of deleted faces are not kept");
        *face = face.with_labels(relabel);
    }

    /// Puts other regions on the two sides of a face: `[back, front]` in its stored winding.
    pub fn set_labels(&mut self, row: FaceRow, labels: [Region; 2]) {
        let face = self.faces[row.index()].as_mut().expect("invariant: rows of deleted faces are not kept");
        face.labels = labels;
    }

    /// Closes the gaps that deleted faces and vertices without faces leave; the order stays.
    pub fn compact(&mut self) -> Remap {
        let mut next = 0;
        let vertices: Vec<Option<VertexRow>> =
            self.around.iter().map(|faces| take_row(!faces.is_empty(), &mut next).map(VertexRow)).collect();
        next = 0;
        let faces: Vec<Option<FaceRow>> =
            self.faces.iter().map(|face| take_row(face.is_some(), &mut next).map(FaceRow)).collect();
        let place = |v: VertexRow| vertices[v.index()].expect("invariant: vertices of a face are kept");
        self.faces.retain(Option::is_some);
        for face in self.faces.iter_mut().flatten() {
            face.vertices = face.vertices.map(place);
        }
        self.around.retain(|list| !list.is_empty());
        for row in self.around.iter_mut().flatten() {
            *row = faces[row.index()].expect("invariant: faces around a vertex exist");
        }
        Remap { vertices, faces }
    }

    /// Whether every row is in use.
    #[must_use]
    pub fn is_compact(&self) -> bool {
        self.live_faces == self.faces.len() && self.around.iter().all(|faces| !faces.is_empty())
    }
}

fn take_row(is_kept: bool, next: &mut u32) -> Option<u32> {
    is_kept.then(|| {
        *next += 1;
        *next - 1
    })
}

/// Written as the number of vertices and the list of faces; the rest follows from them.
impl Serialize for SurfaceMesh {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        (self.around.len(), &self.faces).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for SurfaceMesh {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (vertices, faces) = <(usize, Vec<Option<Face>>)>::deserialize(deserializer)?;
        let in_range = |face: &Face| face.vertices.iter().all(|v| v.index() < vertices) && !face.is_degenerate();
        if let Some(row) = faces.iter().position(|face| face.as_ref().is_some_and(|face| !in_range(face))) {
            return Err(serde::de::Error::custom(format!("face {row} has no three vertices among {vertices}")));
        }
        let mut mesh = Self::default();
        mesh.around.resize_with(vertices, FaceList::new);
        for face in faces {
            match face {
                Some(face) => {
                    mesh.add_face(face);
                }
                None => mesh.faces.push(None),
            }
        }
        Ok(mesh)
    }
}
