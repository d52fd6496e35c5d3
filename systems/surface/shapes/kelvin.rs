//! Kelvin's foam: truncated octahedra on a body-centred cubic grid.
//!
//! Cell at the origin, in quarters of the grid constant: corners are the permutations of `(0, +-1, +-2)`, six squares at
//! `+-2` along the axes, eight hexagons around `(+-1, +-1, +-1)`. Two cells to a cube: `V = a^3 / 2`.
//! Source: Thomson (Lord Kelvin) 1887.

use std::collections::BTreeMap;

use glam::{DVec3, I64Vec3};

use super::wired::{WiredFilms, flat};
use crate::surface::LabelledTriangles;

/// A cluster of truncated octahedra in air; `size` is the distance of opposite squares (metres), films are flat.
///
/// `n^3` cells at the corners of a cubic grid, and the `(n - 1)^3` between them: 1, 9, 35, ... Regions from 1, along x first,
/// then y, then z; those of the corners first. The relaxed foam has slightly bent hexagons.
#[must_use]
pub fn kelvin_cells(centre: DVec3, size: f64, n: usize, edge: f64) -> LabelledTriangles {
    let cells = cell_centres(n);
    let mut builder = Builder { cells: &cells, rows: BTreeMap::new(), set: LabelledTriangles::default() };
    cells.iter().for_each(|(cell, region)| builder.add_cell(*cell, *region));
    let mut set = builder.set;
    let middle = DVec3::splat(2.0 * n.saturating_sub(1) as f64);
    set.positions.iter_mut().for_each(|x| *x = centre + 0.25 * size * (*x - middle));
    let films = WiredFilms::new(set);
    let frequency = films.frequency_for(edge);
    films.subdivide(frequency, flat).set
}

type Place = [i64; 3];

/// Centres of all cells in quarters of the grid constant, with their regions.
fn cell_centres(n: usize) -> BTreeMap<Place, u32> {
    let block = |count: usize, shift: i64| {
        let axis = move || (0..count as i64).map(move |k| 4 * k + shift);
        axis().flat_map(move |z| axis().flat_map(move |y| axis().map(move |x| [x, y, z])))
    };
    block(n, 0).chain(block(n.saturating_sub(1), 2)).zip(1..).collect()
}

struct Builder<'a> {
    cells: &'a BTreeMap<Place, u32>,
    rows: BTreeMap<Place, u32>,
    set: LabelledTriangles,
}

impl Builder<'_> {
    /// Adds the walls of a cell to cells of higher regions, and to the outside.
    fn add_cell(&mut self, cell: Place, region: u32) {
        let axes = (0..3).flat_map(|k| [-1, 1].map(|sign| I64Vec3::AXES[k] * sign));
        let diagonals = (0..8).map(|k| I64Vec3::new(2 * (k & 1) - 1, (k & 2) - 1, (k & 4) / 2 - 1));
        for (normal, far, near) in axes.map(|n| (n, 4, 2)).chain(diagonals.map(|n| (n, 2, 1))) {
            let neighbour = I64Vec3::from(cell) + far * normal;
            let other = self.cells.get(&neighbour.to_array()).copied().unwrap_or(0);
            if other == 0 || other > region {
                self.add_wall(I64Vec3::from(cell), normal, near, [region, other]);
            }
        }
    }

    /// Adds a square or a hexagon as a fan about its centre, `near` normals away from the centre of the cell.
    fn add_wall(&mut self, cell: I64Vec3, normal: I64Vec3, near: i64, labels: [u32; 2]) {
        let reach = near * normal.dot(normal);
        let mut corners: Vec<I64Vec3> = cell_corners().filter(|corner| corner.dot(normal) == reach).collect();
        let u = normal.as_dvec3().any_orthogonal_vector();
        let v = normal.as_dvec3().cross(u);
        let (u, v) = (u.normalize(), v.normalize());
        let angle = |corner: &I64Vec3| corner.as_dvec3().dot(v).atan2(corner.as_dvec3().dot(u));
        corners.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        let middle = self.row(cell + near * normal);
        let ring: Vec<u32> = corners.iter().map(|corner| self.row(cell + *corner)).collect();
        for k in 0..ring.len() {
            self.set.add_film([middle, ring[k], ring[(k + 1) % ring.len()]], labels);
        }
    }

    fn row(&mut self, place: I64Vec3) -> u32 {
        let set = &mut self.set;
        *self.rows.entry(place.to_array()).or_insert_with(|| set.add_vertex(place.as_dvec3(), false))
    }
}

/// Corners of the cell at the origin: permutations of `(0, +-1, +-2)`.
fn cell_corners() -> impl Iterator<Item = I64Vec3> {
    let all = (-2..=2).flat_map(|x| (-2..=2).flat_map(move |y| (-2..=2).map(move |z| I64Vec3::new(x, y, z))));
    all.filter(|corner| {
        let mut sizes = corner.abs().to_array();
        sizes.sort_unstable();
        sizes == [0, 1, 2]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::measure::{checked, smallest_angle};

    #[test]
    fn one_cell_is_a_truncated_octahedron() {
        let surface = checked(&kelvin_cells(DVec3::ONE, 2.0, 1, 0.3));
        let volume = surface.volumes()[1];
        assert!((volume - 4.0).abs() < 1e-12);
        let quotient = surface.film_area() / volume.powf(2.0 / 3.0);
        assert!((quotient - 5.314_740).abs() < 1e-6, "{quotient}");
    }

    #[test]
    fn nine_cells_meet_in_threes_at_edges_inside() {
        let set = kelvin_cells(DVec3::ZERO, 1.0, 2, 0.5);
        let surface = checked(&set);
        assert_eq!(surface.volumes().len(), 10);
        assert!(surface.volumes()[1..].iter().all(|volume| (volume - 0.5).abs() < 1e-13));
        assert!(smallest_angle(&set) > 44.9);
        assert!(surface.mesh.edges().iter().all(|[a, b]| surface.mesh.faces_of_edge(*a, *b).len() <= 3));
    }

    #[test]
    fn thirty_five_cells_fill_space_between_them() {
        let surface = checked(&kelvin_cells(DVec3::ZERO, 1.0, 3, 0.6));
        assert_eq!(surface.volumes().len(), 36);
        assert!((surface.volumes()[0] + 17.5).abs() < 1e-11);
    }
}
