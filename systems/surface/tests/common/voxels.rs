//! Boxes of cubes with labels: foams with every kind of edge and vertex that can be thought of.

use froth_surface::LabelledTriangles;
use glam::DVec3;

/// The films between differently labelled cells of a grid (x fastest) with cells of `size` metres; cells beyond it are outside.
pub(crate) fn voxels(counts: [usize; 3], size: f64, labels: &[u32]) -> LabelledTriangles {
    let label = |cell: [usize; 3]| {
        // Cells are counted from 1: those at 0 and beyond the last are outside.
        let is_inside = (0..3).all(|k| (1..=counts[k]).contains(&cell[k]));
        if is_inside { labels[cell[0] - 1 + counts[0] * (cell[1] - 1 + counts[1] * (cell[2] - 1))] } else { 0 }
    };
    let mut set = LabelledTriangles::default();
    let corners = counts.map(|n| n as u32 + 2);
    let row = |p: [u32; 3]| p[0] + corners[0] * (p[1] + corners[1] * p[2]);
    for z in 0..corners[2] {
        for y in 0..corners[1] {
            for x in 0..corners[0] {
                set.add_vertex(size * DVec3::new(f64::from(x), f64::from(y), f64::from(z)), false);
            }
        }
    }
    for z in 1..corners[2] {
        for y in 1..corners[1] {
            for x in 1..corners[0] {
                for axis in 0..3 {
                    let cell = [x, y, z];
                    let mut before = cell;
                    before[axis] -= 1;
                    let labels = [before, cell].map(|cell| label(cell.map(|c| c as usize)));
                    if labels[0] != labels[1] {
                        let moved = |u: u32, v: u32| {
                            let mut corner = cell;
                            corner[(axis + 1) % 3] += u;
                            corner[(axis + 2) % 3] += v;
                            row(corner)
                        };
                        let [a, b, c, d] = [moved(0, 0), moved(1, 0), moved(1, 1), moved(0, 1)];
                        set.add_film([a, b, c], labels);
                        set.add_film([a, c, d], labels);
                    }
                }
            }
        }
    }
    without_unused(&set)
}

fn without_unused(set: &LabelledTriangles) -> LabelledTriangles {
    let mut rows = vec![None; set.positions.len()];
    let mut kept = LabelledTriangles { open: set.open.clone(), ..LabelledTriangles::default() };
    for (triangle, labels) in set.triangles.iter().zip(&set.labels) {
        let place = triangle.map(|v| {
            *rows[v as usize].get_or_insert_with(|| kept.add_vertex(set.positions[v as usize], set.pinned[v as usize]))
        });
        kept.add_film(place, *labels);
    }
    kept
}
