//! Where the potentials of a sheet lie: one number per vertex and region that films around the vertex border.
//!
//! ```text
//! sides of vertex v:   regions[offsets[v] .. offsets[v + 1]], ascending; in the middle of a film two, on a Plateau border
//!                      three, where borders meet four
//! panel:               a face that is a film, with the sides of its two regions at its three corners
//!
//!            c                e_k is the edge opposite to corner k, from corner k + 1 to corner k + 2
//!           / \               Gamma_k = phi(front, k) - phi(back, k)
//!      e_b /   \ e_a
//!         / ^n  \  front      n: right-hand normal, from back to front
//!        a-------b   back
//!           e_c
//! ```
//!
//! Ghosts carry no sheet: the air on both sides of one is the same air, so that around the rim of an open film the potential
//! is continuous. Sides that ghosts join at a vertex are tied to one value ([`Layout::tie`]).

use froth_surface::{FaceRow, Region, Surface, VertexRow};
use smallvec::SmallVec;

/// A film as the sheet sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Panel {
    /// Its row in the mesh.
    pub row: FaceRow,
    /// Rows of its vertices, ascending; the right-hand normal points from back to front.
    pub corners: [u32; 3],
    /// Side of the region in the back at each corner.
    pub back: [u32; 3],
    /// Side of the region in front at each corner.
    pub front: [u32; 3],
}

/// Sides that have one potential.
type Tie = SmallVec<[u32; 4]>;

/// Where potentials lie; built once per change of the mesh.
#[derive(Clone, Debug, Default)]
pub struct Layout {
    offsets: Vec<u32>,
    regions: Vec<Region>,
    panels: Vec<Panel>,
    vertices: Vec<u32>,
    ties: Vec<Tie>,
    /// Per vertex: whether all its sides are one.
    is_rim: Vec<bool>,
}

impl Layout {
    /// The layout of a surface.
    #[must_use]
    pub fn new(surface: &Surface) -> Self {
        let mut layout = Self::default();
        layout.rebuild(surface);
        layout
    }

    /// Builds it anew, in the memory it has.
    pub fn rebuild(&mut self, surface: &Surface) {
        self.list_sides(surface);
        self.list_panels(surface);
        self.tie_sides(surface);
    }

    fn list_sides(&mut self, surface: &Surface) {
        self.offsets.clear();
        self.regions.clear();
        self.vertices.clear();
        for vertex in (0..surface.mesh.vertex_rows() as u32).map(VertexRow) {
            self.offsets.push(self.regions.len() as u32);
            self.regions.extend(film_regions(surface, vertex));
            self.vertices.resize(self.regions.len(), vertex.0);
        }
        self.offsets.push(self.regions.len() as u32);
    }

    fn list_panels(&mut self, surface: &Surface) {
        self.panels.clear();
        let films = surface.mesh.faces().filter(|(_, face)| is_sheet(face));
        let panels = films.map(|(row, face)| {
            let corners = face.vertices();
            let sides = |region| corners.map(|v| self.side(v, region).expect("invariant: films list their regions"));
            let [back, front] = face.labels().map(sides);
            Panel { row, corners: corners.map(|v| v.0), back, front }
        });
        let panels: Vec<Panel> = panels.collect();
        self.panels = panels;
    }

    fn tie_sides(&mut self, surface: &Surface) {
        self.ties.clear();
        self.is_rim.clear();
        self.is_rim.resize(surface.mesh.vertex_rows(), false);
        for vertex in (0..surface.mesh.vertex_rows() as u32).map(VertexRow) {
            let sides = self.sides_of(vertex.index());
            let groups = groups_of(surface, vertex, &self.regions[sides.clone()]);
            for group in groups.iter().filter(|group| group.len() > 1) {
                self.ties.push(group.iter().map(|place| sides.start as u32 + place).collect());
            }
            self.is_rim[vertex.index()] = groups.len() == 1;
        }
    }

    /// Sides in all.
    #[must_use]
    pub fn side_count(&self) -> usize {
        self.regions.len()
    }

    /// Rows of vertices, vacant ones counted.
    #[must_use]
    pub fn vertex_rows(&self) -> usize {
        self.is_rim.len()
    }

    /// Sides of a vertex, ascending by region.
    #[must_use]
    #[inline]
    pub fn sides_of(&self, vertex: usize) -> std::ops::Range<usize> {
        self.offsets[vertex] as usize..self.offsets[vertex + 1] as usize
    }

    /// The region of each side.
    #[must_use]
    pub fn regions(&self) -> &[Region] {
        &self.regions
    }

    /// The side of a region at a vertex.
    #[must_use]
    pub fn side(&self, vertex: VertexRow, region: Region) -> Option<u32> {
        let sides = self.sides_of(vertex.index());
        let place = self.regions[sides.clone()].binary_search(&region).ok()?;
        Some((sides.start + place) as u32)
    }

    /// Films, ascending by face row.
    #[must_use]
    pub fn panels(&self) -> &[Panel] {
        &self.panels
    }

    /// The vertex of a side.
    #[must_use]
    pub fn vertex_of(&self, side: u32) -> u32 {
        self.vertices[side as usize]
    }

    /// Sides of a vertex, those that are tied together; ascending by their first.
    #[must_use]
    pub fn groups_of(&self, vertex: usize) -> SmallVec<[SmallVec<[u32; 4]>; 4]> {
        let sides = self.sides_of(vertex).map(|side| side as u32);
        let tie_of = |side: u32| {
            let first = self.ties.partition_point(|tie| self.vertices[tie[0] as usize] < vertex as u32);
            let own = self.ties[first..].iter().take_while(|tie| self.vertices[tie[0] as usize] == vertex as u32);
            own.into_iter().find(|tie| tie.contains(&side)).cloned()
        };
        let group = |side: u32| match tie_of(side) {
            Some(tie) => (tie[0] == side).then_some(tie),
            None => Some(SmallVec::from_slice(&[side])),
        };
        sides.filter_map(group).collect()
    }

    /// The layout with some of its panels (rows ascending) and all of its sides.
    #[must_use]
    pub fn restricted(&self, rows: &[usize]) -> Self {
        let panels = rows.iter().map(|row| self.panels[*row]).collect();
        Self { panels, ..self.clone() }
    }

    /// Whether the potential is continuous around a vertex: the rim of an open film.
    #[must_use]
    pub fn is_rim(&self, vertex: usize) -> bool {
        self.is_rim[vertex]
    }

    /// Gives sides that ghosts join one value: their mean.
    pub fn tie(&self, values: &mut [f64]) {
        for tie in &self.ties {
            let mean = tie.iter().map(|side| values[*side as usize]).sum::<f64>() / tie.len() as f64;
            tie.iter().for_each(|side| values[*side as usize] = mean);
        }
    }
}

/// Whether a face is a film between two regions.
fn is_sheet(face: &froth_surface::Face) -> bool {
    let [back, front] = face.labels();
    !face.is_ghost() && back != front
}

/// Regions that films around a vertex border, ascending.
pub(crate) fn film_regions(surface: &Surface, vertex: VertexRow) -> SmallVec<[Region; 4]> {
    let mut regions: SmallVec<[Region; 4]> = SmallVec::new();
    for face in surface.mesh.faces_of(vertex).iter().map(|row| surface.mesh.face(*row)).filter(is_sheet) {
        for region in face.labels() {
            if let Err(place) = regions.binary_search(&region) {
                regions.insert(place, region);
            }
        }
    }
    regions
}

/// Places in `regions` by the ghosts of a vertex that join them: groups of one where there is none.
fn groups_of(surface: &Surface, vertex: VertexRow, regions: &[Region]) -> SmallVec<[Tie; 4]> {
    // Labels that only ghosts have take part: they may lead from one region to another.
    let mut labels: SmallVec<[Region; 8]> = SmallVec::from_slice(regions);
    let mut group: SmallVec<[usize; 8]> = (0..labels.len()).collect();
    let place = |labels: &mut SmallVec<[Region; 8]>, group: &mut SmallVec<[usize; 8]>, region: Region| {
        labels.iter().position(|label| *label == region).unwrap_or_else(|| {
            labels.push(region);
            group.push(labels.len() - 1);
            labels.len() - 1
        })
    };
    let ghosts = surface.mesh.faces_of(vertex).iter().map(|row| surface.mesh.face(*row)).filter(|face| face.is_ghost());
    for face in ghosts {
        let [a, b] = face.labels().map(|region| place(&mut labels, &mut group, region));
        let (kept, gone) = (group[a].min(group[b]), group[a].max(group[b]));
        group.iter_mut().filter(|group| **group == gone).for_each(|group| *group = kept);
    }
    let mut groups: SmallVec<[Tie; 4]> = SmallVec::new();
    let mut named: SmallVec<[usize; 8]> = SmallVec::new();
    for (place, name) in group.iter().enumerate().take(regions.len()) {
        match named.iter().position(|other| other == name) {
            Some(known) => groups[known].push(place as u32),
            None => {
                named.push(*name);
                groups.push(SmallVec::from_slice(&[place as u32]));
            }
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use froth_surface::shapes::{disc, double_bubble};
    use glam::DVec3;

    use super::*;

    #[test]
    fn a_double_bubble_has_three_sides_on_its_border_and_two_elsewhere() {
        let surface = Surface::from_triangles(&double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.8, 0.3));
        let layout = Layout::new(&surface);
        let counts: Vec<usize> = (0..layout.vertex_rows()).map(|v| layout.sides_of(v).len()).collect();
        assert!(counts.iter().all(|count| (2..=3).contains(count)));
        assert!(counts.contains(&3) && counts.contains(&2));
        assert_eq!(layout.panels().len(), surface.mesh.face_count());
        assert!((0..layout.vertex_rows()).all(|v| !layout.is_rim(v)));
        for panel in layout.panels() {
            let [back, front] = surface.mesh.face(panel.row).labels();
            assert!(panel.back.iter().all(|side| layout.regions()[*side as usize] == back));
            assert!(panel.front.iter().all(|side| layout.regions()[*side as usize] == front));
        }
    }

    #[test]
    fn around_the_rim_of_a_disc_the_potential_is_continuous() {
        let surface = Surface::from_triangles(&disc(DVec3::ZERO, 1.0, DVec3::Z, 0.3));
        let layout = Layout::new(&surface);
        let mut values: Vec<f64> = (0..layout.side_count()).map(|side| side as f64).collect();
        layout.tie(&mut values);
        for v in 0..layout.vertex_rows() {
            let sides = &values[layout.sides_of(v)];
            let is_open = sides.len() == 2;
            assert!(!is_open || surface.pinned.0[v] == (sides[0] == sides[1]), "{v}: {sides:?}");
            assert!(!is_open || surface.pinned.0[v] == layout.is_rim(v));
        }
    }
}
