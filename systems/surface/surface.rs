//! A mesh in space: connectivity, positions, which vertices are held, which regions are open.

use glam::DVec3;

use crate::mesh::{Face, Remap, SurfaceMesh};
use crate::rows::{FaceRow, PerVertex, Region, VertexRow};

/// Triangles with labels as generators and files give them, before anything is checked.
///
/// Rows are `u32`; `labels[f] = [back, front]`, and the right-hand normal of `triangles[f]` points from back to front.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LabelledTriangles {
    /// Place of each vertex, metres.
    pub positions: Vec<DVec3>,
    /// Per vertex: whether it is held in place (by a wire).
    pub pinned: Vec<bool>,
    /// Vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Per triangle: back and front region.
    pub labels: Vec<[u32; 2]>,
    /// Per triangle: whether it only closes a region.
    pub ghosts: Vec<bool>,
    /// Regions without a volume of their own: pockets of outside air that ghosts close.
    pub open: Vec<u32>,
}

impl LabelledTriangles {
    /// Adds a vertex, and gives its row.
    pub fn add_vertex(&mut self, position: DVec3, pinned: bool) -> u32 {
        self.positions.push(position);
        self.pinned.push(pinned);
        self.positions.len() as u32 - 1
    }

    /// Adds a film.
    pub fn add_film(&mut self, vertices: [u32; 3], labels: [u32; 2]) {
        self.add_face(vertices, labels, false);
    }

    /// Adds a triangle, which may be a ghost.
    pub fn add_face(&mut self, vertices: [u32; 3], labels: [u32; 2], ghost: bool) {
        self.triangles.push(vertices);
        self.labels.push(labels);
        self.ghosts.push(ghost);
    }

    /// Appends another set; its regions except 0 are renumbered to follow those that are here already.
    pub fn append(&mut self, other: &Self) {
        let first_vertex = self.positions.len() as u32;
        let first_region = self.region_count() - 1;
        let region = |label: u32| if label == 0 { 0 } else { label + first_region };
        self.positions.extend(&other.positions);
        self.pinned.extend(&other.pinned);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first_vertex)));
        self.labels.extend(other.labels.iter().map(|l| l.map(region)));
        self.ghosts.extend(&other.ghosts);
        self.open.extend(other.open.iter().map(|label| region(*label)));
    }

    /// Largest label plus one.
    #[must_use]
    pub fn region_count(&self) -> u32 {
        self.labels.iter().flatten().max().map_or(1, |label| label + 1)
    }
}

/// Films in space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Connectivity and labels.
    pub mesh: SurfaceMesh,
    /// Place of each vertex, metres.
    pub positions: PerVertex<DVec3>,
    /// Whether each vertex is held in place (by a wire).
    pub pinned: PerVertex<bool>,
    /// Regions without a volume of their own, ascending; region 0 is always open and not listed.
    pub open: Vec<Region>,
}

impl Surface {
    /// The surface of a set of triangles, as it is: see [`crate::invariants`] for what must hold.
    #[must_use]
    pub fn from_triangles(triangles: &LabelledTriangles) -> Self {
        let ghosts = triangles.ghosts.iter().copied().chain(std::iter::repeat(false));
        let faces = triangles.triangles.iter().zip(&triangles.labels).zip(ghosts);
        let faces = faces.map(|((v, l), ghost)| Face::new(v.map(VertexRow), l.map(Region)).as_ghost(ghost));
        let mut open: Vec<Region> = triangles.open.iter().copied().map(Region).collect();
        open.sort_unstable();
        open.dedup();
        Self {
            mesh: SurfaceMesh::new(triangles.positions.len(), faces),
            positions: PerVertex(triangles.positions.clone()),
            pinned: PerVertex(triangles.pinned.clone()),
            open,
        }
    }

    /// Corners of a face, in the order of its vertices.
    #[must_use]
    #[inline]
    pub fn corners(&self, face: FaceRow) -> [DVec3; 3] {
        self.mesh.face(face).vertices().map(|v| self.positions[v])
    }

    /// Twice the area of a face along its normal, from back to front, m^2.
    #[must_use]
    #[inline]
    pub fn double_area_normal(&self, face: FaceRow) -> DVec3 {
        let [a, b, c] = self.corners(face);
        (b - a).cross(c - a)
    }

    /// Area of a face, m^2.
    #[must_use]
    #[inline]
    pub fn area(&self, face: FaceRow) -> f64 {
        0.5 * self.double_area_normal(face).length()
    }

    /// Area of all films, ghosts not counted, m^2.
    #[must_use]
    pub fn film_area(&self) -> f64 {
        self.mesh.faces().filter(|(_, face)| !face.is_ghost()).map(|(row, _)| self.area(row)).sum()
    }

    /// Whether a region has no volume of its own.
    #[must_use]
    #[inline]
    pub fn is_open(&self, region: Region) -> bool {
        region == Region::OUTSIDE || self.open.binary_search(&region).is_ok()
    }

    /// Signed volume of every label up to the largest, m^3. They add up to 0: that of the outside is negative.
    #[must_use]
    pub fn volumes(&self) -> Vec<f64> {
        let count = self.mesh.regions().last().map_or(1, |last| last.index() + 1);
        let mut volumes = vec![0.0; count];
        // From a point nearby: far from the origin the sum would lose digits.
        let origin = self.mesh.vertices().next().map_or(DVec3::ZERO, |v| self.positions[v]);
        for (row, face) in self.mesh.faces() {
            let [a, b, c] = self.corners(row).map(|x| x - origin);
            let part = a.dot(b.cross(c)) / 6.0;
            let [back, front] = face.labels();
            volumes[back.index()] += part;
            volumes[front.index()] -= part;
        }
        volumes
    }

    /// Closes the gaps that deleted rows leave.
    pub fn compact(&mut self) -> Remap {
        let remap = self.mesh.compact();
        self.positions = remap.carry(&self.positions);
        self.pinned = remap.carry(&self.pinned);
        remap
    }
}
