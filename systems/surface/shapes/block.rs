//! Cubes: one, and a block of cubes that share their walls.

use glam::DVec3;

use super::wired::{WiredFilms, flat};
use crate::surface::LabelledTriangles;

/// A cube along the axes, region 1 (metres): exact, with right-angled triangles.
#[must_use]
pub fn cube(centre: DVec3, side: f64, edge: f64) -> LabelledTriangles {
    lattice(centre, [1; 3], side, edge)
}

/// A block of cubic cells that share their walls; `size` is the edge of a cell (metres).
///
/// Regions from 1, along x first, then y, then z. Edges inside the block have four faces and its inner vertices touch eight
/// regions: no foam is like that, and a solver has to resolve it. Counts of 5, 5, 5 give the foam of 125 bubbles.
#[must_use]
pub fn lattice(centre: DVec3, counts: [usize; 3], size: f64, edge: f64) -> LabelledTriangles {
    let corner = centre - 0.5 * size * DVec3::from(counts.map(|n| n as f64));
    let mut set = LabelledTriangles::default();
    for place in places(counts.map(|n| n + 1)) {
        set.add_vertex(corner + size * DVec3::from(place.map(|p| p as f64)), false);
    }
    for axis in 0..3 {
        let mut walls = counts;
        walls[axis] += 1;
        places(walls).for_each(|place| add_wall(&mut set, counts, place, axis));
    }
    let blocks = WiredFilms::new(set);
    let frequency = blocks.frequency_for(edge);
    without_unused(blocks.subdivide(frequency, flat).set)
}

/// The wall of a cell at its lower end along an axis.
fn add_wall(set: &mut LabelledTriangles, counts: [usize; 3], place: [usize; 3], axis: usize) {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let row = |du: usize, dv: usize| {
        let mut corner = place;
        corner[u] += du;
        corner[v] += dv;
        index(counts.map(|n| n + 1), corner)
    };
    let region = |inside: bool, at: [usize; 3]| if inside { index(counts, at) + 1 } else { 0 };
    let mut below = place;
    below[axis] = below[axis].wrapping_sub(1);
    let labels = [region(place[axis] > 0, below), region(place[axis] < counts[axis], place)];
    // The diagonal alternates from cell to cell, so that no direction is special.
    let corners = [row(0, 0), row(1, 0), row(1, 1), row(0, 1)];
    let turn = place.iter().sum::<usize>() % 2;
    let at = |k: usize| corners[(k + turn) % 4];
    set.add_film([at(0), at(1), at(2)], labels);
    set.add_film([at(0), at(2), at(3)], labels);
}

/// Places of a grid, the first index fastest.
fn places([nx, ny, nz]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
}

fn index(counts: [usize; 3], [i, j, k]: [usize; 3]) -> u32 {
    (i + counts[0] * (j + counts[1] * k)) as u32
}

/// An empty block has corners but no walls.
fn without_unused(set: LabelledTriangles) -> LabelledTriangles {
    if set.triangles.is_empty() { LabelledTriangles::default() } else { set }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::VertexRow;
    use crate::shapes::measure::{checked, edge_lengths, edges_with, smallest_angle};

    #[test]
    fn a_cube_is_exact() {
        for edge in [1.0, 0.3, 0.11] {
            let set = cube(DVec3::new(5.0, 0.0, 1.0), 2.0, 2.0 * edge);
            let surface = checked(&set);
            assert!((surface.volumes()[1] - 8.0).abs() < 1e-12);
            assert!((surface.film_area() - 24.0).abs() < 1e-12);
            assert!(smallest_angle(&set) > 44.999);
        }
        let mean = edge_lengths(&cube(DVec3::ZERO, 2.0, 0.1))[1];
        assert!((mean / 0.1 - 1.0).abs() < 0.1, "{mean}");
    }

    #[test]
    fn cells_of_a_lattice_share_walls_edges_and_corners() {
        let surface = checked(&lattice(DVec3::ZERO, [2, 2, 2], 1.0, 1.2));
        assert!(surface.volumes()[1..].iter().all(|volume| (volume - 1.0).abs() < 1e-14));
        assert!((surface.film_area() - 36.0).abs() < 1e-12, "three planes of walls in each direction");
        assert_eq!(edges_with(&surface, 4), 6, "the half axes from the middle");
        let middle = (0..).map(VertexRow).find(|v| surface.positions[*v] == DVec3::ZERO).expect("a middle");
        assert_eq!(surface.mesh.regions_of(middle).len(), 8);
    }

    #[test]
    fn the_foam_of_125_bubbles_has_the_edges_of_its_grid() {
        let surface = checked(&lattice(DVec3::ZERO, [5, 5, 5], 1.0, 1.2));
        assert_eq!(surface.volumes().len(), 126);
        assert_eq!(edges_with(&surface, 4), 3 * 4 * 4 * 5, "240 edges inside the block");
        assert_eq!(edges_with(&surface, 3), 6 * 4 * 5 * 2, "240 edges where a wall meets the outside");
    }
}
