//! Impulse of free clusters: what leaves the range of the volume gradients is given back.
//!
//! # Equation
//! `P = rho sum_iv phi_iv N_iv` over all sides of a cluster. A uniform velocity `c` less in its bubbles, `phi -= c.x` there,
//! changes it by `-rho (sum_iv N_iv x_v^T) c` over the sides of bubbles: three equations for `c`.
//!
//! # Limits
//! Clusters that hang on a wire exchange impulse with it and are left alone; so are films without a bubble.
//!
//! # Source
//! Saffman 1992, §3.2, for the impulse; the correction is this scheme's own.

use froth_surface::links::{FilmClusters, free_clusters};
use froth_surface::{Region, Surface};
use glam::{DMat3, DVec3};

use crate::geometry::Geometry;
use crate::layout::Layout;
use crate::symmetric::outer;

/// Clusters of films that nothing holds.
#[derive(Clone, Debug, Default)]
pub struct Clusters(FilmClusters);

impl Clusters {
    /// Finds the clusters of a surface.
    #[must_use]
    pub fn new(layout: &Layout, surface: &Surface) -> Self {
        let is_held = |v: usize| surface.pinned.0[v] || has_open_side(layout, surface, v);
        Self(free_clusters(layout.vertex_rows(), layout.panels().iter().map(|panel| panel.corners), is_held))
    }

    /// Free clusters.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.count
    }

    /// Whether no cluster is free.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.count == 0
    }

    /// Whether a vertex belongs to a free cluster.
    #[must_use]
    pub fn is_free(&self, vertex: usize) -> bool {
        self.0.of_vertex[vertex].is_some()
    }

    /// What each free cluster is known by when the mesh has changed: its bubble of the least label, or the outside where it has none.
    #[must_use]
    pub fn names(&self, layout: &Layout) -> Vec<Region> {
        let mut names = vec![Region::OUTSIDE; self.0.count];
        self.for_each_side(layout, |cluster, _, side| {
            let region = layout.regions()[side];
            if is_of_bubble(layout, side) && (names[cluster] == Region::OUTSIDE || region < names[cluster]) {
                names[cluster] = region;
            }
        });
        names
    }

    /// Impulse per density of each free cluster, m^4/s.
    #[must_use]
    pub fn impulses(&self, layout: &Layout, geometry: &Geometry, potentials: &[f64]) -> Vec<DVec3> {
        let mut impulses = vec![DVec3::ZERO; self.0.count];
        self.for_each_side(layout, |cluster, _, side| {
            impulses[cluster] += geometry.gradients[side] * potentials[side];
        });
        impulses
    }

    /// Sums of forces per vertex over each free cluster.
    #[must_use]
    pub fn sums(&self, forces: &[DVec3]) -> Vec<DVec3> {
        let mut sums = vec![DVec3::ZERO; self.0.count];
        for (force, cluster) in forces.iter().zip(&self.0.of_vertex) {
            if let Some(cluster) = cluster {
                sums[*cluster as usize] += *force;
            }
        }
        sums
    }

    /// Which free clusters have any of the vertices that are marked; none where `marks` is empty.
    #[must_use]
    pub fn with_any(&self, marks: &[bool]) -> Vec<bool> {
        let mut found = vec![false; self.0.count];
        for (mark, cluster) in marks.iter().zip(&self.0.of_vertex) {
            if let (true, Some(cluster)) = (mark, cluster) {
                found[*cluster as usize] = true;
            }
        }
        found
    }

    /// Gives each free cluster its impulse per density (m^4/s) back, and those that are `together` the sum of theirs; the largest uniform
    /// velocity that this took, m/s.
    pub fn correct(
        &self,
        layout: &Layout,
        geometry: &Geometry,
        positions: &[DVec3],
        wanted: &[DVec3],
        together: &[bool],
        potentials: &mut [f64],
    ) -> f64 {
        let first = together.iter().position(|together| *together).unwrap_or_default();
        let group = |cluster: usize| if together[cluster] { first } else { cluster };
        let mut matrices = vec![DMat3::ZERO; self.0.count];
        let mut lacks = vec![DVec3::ZERO; self.0.count];
        wanted.iter().enumerate().for_each(|(cluster, wanted)| lacks[group(cluster)] -= *wanted);
        // Places from one of the group's own: far from the origin sums would lose digits.
        let mut origins = vec![None; self.0.count];
        self.for_each_side(layout, |cluster, v, side| {
            let group = group(cluster);
            let origin = *origins[group].get_or_insert(positions[v]);
            let n = geometry.gradients[side];
            lacks[group] += n * potentials[side];
            if is_of_bubble(layout, side) {
                matrices[group] += outer(n, positions[v] - origin);
            }
        });
        let solve = |(matrix, lack): (&DMat3, &DVec3)| {
            let c = matrix.inverse() * *lack;
            if c.is_finite() { c } else { DVec3::ZERO }
        };
        let gains: Vec<DVec3> = matrices.iter().zip(&lacks).map(solve).collect();
        self.for_each_side(layout, |cluster, v, side| {
            let group = group(cluster);
            let origin = origins[group].unwrap_or_default();
            if is_of_bubble(layout, side) {
                potentials[side] -= gains[group].dot(positions[v] - origin);
            }
        });
        gains.iter().map(|c| c.length()).fold(0.0, f64::max)
    }

    /// Calls `visit(cluster, vertex, side)` for the sides of free clusters.
    fn for_each_side(&self, layout: &Layout, mut visit: impl FnMut(usize, usize, usize)) {
        for (v, cluster) in self.0.of_vertex.iter().enumerate() {
            let Some(cluster) = cluster else { continue };
            layout.sides_of(v).for_each(|side| visit(*cluster as usize, v, side));
        }
    }
}

fn is_of_bubble(layout: &Layout, side: usize) -> bool {
    layout.regions()[side] != Region::OUTSIDE
}

fn has_open_side(layout: &Layout, surface: &Surface, vertex: usize) -> bool {
    let regions = layout.sides_of(vertex).map(|side| layout.regions()[side]);
    regions.into_iter().any(|region| region != Region::OUTSIDE && surface.is_open(region))
}
