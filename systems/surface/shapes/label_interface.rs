//! Films between labelled points of space: marching tetrahedra for any number of labels.
//!
//! The lattice is body-centred: corners and middles of cubic cells; a tetrahedron lies between the middles of two cells and an
//! edge of the face they share, all of one shape. A film crosses every lattice edge with two labels once (point E), has one
//! point F in every triangle with three labels, and one point T in a tetrahedron with four:
//!
//! ```text
//!   labels of a tetrahedron     films
//!   a | b b b                   E E E
//!   a a | b b                   E E E E
//!   a a | b | c                 b-c: E F F    a-b: E F F E    a-c: E E F F
//!   a | b | c | d               six times E F T F
//! ```
//!
//! What crosses a triangle depends on its labels alone, so films of neighbours fit: every label is closed and balanced by
//! construction, whatever the labels are. Source: the labelled cases of Nielson and Franke 1997.

use std::collections::BTreeMap;

use glam::{DVec3, I64Vec3};

use crate::surface::LabelledTriangles;

/// Films cross a lattice edge no nearer to its ends than this part of it: no slivers around lattice points.
const MARGIN: f64 = 0.2;

/// Labels at the points of a body-centred lattice; those at its border are 0.
#[derive(Clone, Debug, PartialEq)]
pub struct LabelGrid {
    corner: DVec3,
    cell: f64,
    counts: [usize; 3],
    /// Per half step along x, y, z, x fastest; points that are no lattice points have label 0.
    labels: Vec<u32>,
}

/// The interface of labelled space inside a box, from `corner` over `counts` cells of size `cell` (metres).
///
/// `label` is forced to 0 in the cells along the border. `separation(x, a, b)` says how far a point of label `a` is from where
/// it would be `b`, in any unit: it places the crossings. [`midway`] puts them in the middle.
#[must_use]
pub fn interface(
    label: impl Fn(DVec3) -> u32,
    separation: impl Fn(DVec3, u32, u32) -> f64,
    corner: DVec3,
    counts: [usize; 3],
    cell: f64,
) -> LabelledTriangles {
    LabelGrid::sample(label, corner, counts, cell).interface(separation)
}

/// No knowledge of how far labels are: films cross in the middle of lattice edges.
#[must_use]
pub const fn midway(_: DVec3, _: u32, _: u32) -> f64 {
    1.0
}

impl LabelGrid {
    /// Takes the labels of space at the lattice points.
    #[must_use]
    pub fn sample(label: impl Fn(DVec3) -> u32, corner: DVec3, counts: [usize; 3], cell: f64) -> Self {
        let size = counts.map(|n| 2 * n + 1);
        let mut grid = Self { corner, cell, counts, labels: vec![0; size.iter().product()] };
        for node in grid.nodes().filter(|node| grid.is_inside(*node)).collect::<Vec<_>>() {
            let row = grid.row(node);
            grid.labels[row] = label(grid.place(node));
        }
        grid
    }

    /// Gives every point of label 0 that is cut off from the border the label `inner` has there.
    pub fn fill_pockets(&mut self, inner: impl Fn(DVec3) -> u32) {
        let mut is_outside = vec![false; self.labels.len()];
        let start = I64Vec3::ZERO;
        is_outside[self.row(start)] = true;
        let mut front = vec![start];
        while let Some(node) = front.pop() {
            for step in lattice_steps() {
                let next = node + step;
                if self.has(next) && self.label(next) == 0 && !is_outside[self.row(next)] {
                    is_outside[self.row(next)] = true;
                    front.push(next);
                }
            }
        }
        for node in self.nodes().collect::<Vec<_>>() {
            let row = self.row(node);
            if self.labels[row] == 0 && !is_outside[row] {
                self.labels[row] = inner(self.place(node));
            }
        }
    }

    /// Films between the labels; see [`interface`].
    #[must_use]
    pub fn interface(&self, separation: impl Fn(DVec3, u32, u32) -> f64) -> LabelledTriangles {
        let mut films = Films { grid: self, separation, rows: BTreeMap::new(), set: LabelledTriangles::default() };
        for middle in self.nodes().filter(|node| node.x % 2 == 1) {
            for axis in 0..3 {
                let other = middle + 2 * I64Vec3::AXES[axis];
                if self.has(other) {
                    square(middle, axis).for_each(|[p, q]| films.add_tetrahedron([middle, other, p, q]));
                }
            }
        }
        films.set
    }

    /// Lattice points, x fastest: coordinates in half steps, all even or all odd.
    fn nodes(&self) -> impl Iterator<Item = I64Vec3> + use<> {
        let [nx, ny, nz] = self.counts.map(|n| 2 * n as i64 + 1);
        let points = (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| I64Vec3::new(x, y, z))));
        points.filter(|node| (node.x - node.y) % 2 == 0 && (node.y - node.z) % 2 == 0)
    }

    fn has(&self, node: I64Vec3) -> bool {
        node.min_element() >= 0 && (0..3).all(|k| node[k] <= 2 * self.counts[k] as i64)
    }

    /// Whether a point is no part of the cells along the border.
    fn is_inside(&self, node: I64Vec3) -> bool {
        (0..3).all(|k| node[k] > 2 && node[k] < 2 * self.counts[k] as i64 - 2)
    }

    fn row(&self, node: I64Vec3) -> usize {
        let [nx, ny, _] = self.counts.map(|n| 2 * n + 1);
        node.x as usize + nx * (node.y as usize + ny * node.z as usize)
    }

    fn label(&self, node: I64Vec3) -> u32 {
        self.labels[self.row(node)]
    }

    fn place(&self, node: I64Vec3) -> DVec3 {
        self.corner + 0.5 * self.cell * node.as_dvec3()
    }
}

/// Steps to the fourteen neighbours in the lattice.
fn lattice_steps() -> impl Iterator<Item = I64Vec3> {
    let along = (0..3).flat_map(|k| [2, -2].map(|s| s * I64Vec3::AXES[k]));
    along.chain((0..8).map(|k| I64Vec3::new(2 * (k & 1) - 1, (k & 2) - 1, (k & 4) / 2 - 1)))
}

/// Edges of the face of a cell that lies along an axis from its middle.
fn square(middle: I64Vec3, axis: usize) -> impl Iterator<Item = [I64Vec3; 2]> {
    let centre = middle + I64Vec3::AXES[axis];
    let (u, v) = (I64Vec3::AXES[(axis + 1) % 3], I64Vec3::AXES[(axis + 2) % 3]);
    let corners = [-u - v, u - v, u + v, v - u].map(|way| centre + way);
    (0..4).map(move |k| [corners[k], corners[(k + 1) % 4]])
}

/// Even permutations of the corners of a tetrahedron.
const EVEN: [[usize; 4]; 12] = [
    [0, 1, 2, 3],
    [0, 2, 3, 1],
    [0, 3, 1, 2],
    [1, 0, 3, 2],
    [1, 3, 2, 0],
    [1, 2, 0, 3],
    [2, 3, 0, 1],
    [2, 0, 1, 3],
    [2, 1, 3, 0],
    [3, 2, 1, 0],
    [3, 1, 0, 2],
    [3, 0, 2, 1],
];

/// No lattice point, where a key has fewer than four.
const NONE: usize = usize::MAX;

struct Films<'a, S> {
    grid: &'a LabelGrid,
    separation: S,
    rows: BTreeMap<[usize; 4], u32>,
    set: LabelledTriangles,
}

impl<S: Fn(DVec3, u32, u32) -> f64> Films<'_, S> {
    fn add_tetrahedron(&mut self, nodes: [I64Vec3; 4]) {
        let labels = nodes.map(|node| self.grid.label(node));
        if labels.iter().all(|label| *label == labels[0]) {
            return;
        }
        let [a, b, c, d] = nodes.map(I64Vec3::as_dvec3);
        let right =
            if (b - a).cross(c - a).dot(d - a) > 0.0 { nodes } else { [nodes[1], nodes[0], nodes[2], nodes[3]] };
        for permutation in EVEN {
            if self.add_case(permutation.map(|k| right[k])) {
                return;
            }
        }
    }

    /// Adds the films of a tetrahedron with its corners in the order of one of the cases; false where the order is another.
    fn add_case(&mut self, [i, j, k, l]: [I64Vec3; 4]) -> bool {
        let [a, b, c, d] = [i, j, k, l].map(|node| self.grid.label(node));
        let case = (a == b, b == c, c == d);
        match case {
            (false, true, true) => self.add_polygon(&[&[i, j], &[i, k], &[i, l]], [a, b]),
            (true, false, true) => self.add_polygon(&[&[i, k], &[j, k], &[j, l], &[i, l]], [c, a]),
            (true, false, false) if a != d => {
                self.add_polygon(&[&[k, l], &[i, k, l], &[j, k, l]], [c, d]);
                self.add_polygon(&[&[i, k], &[i, k, l], &[j, k, l], &[j, k]], [a, c]);
                self.add_polygon(&[&[i, l], &[j, l], &[j, k, l], &[i, k, l]], [a, d]);
            }
            (false, false, false) if a != c && a != d && b != d => {
                for [i, j, k, l] in EVEN
                    .map(|p| p.map(|n| [i, j, k, l][n]))
                    .into_iter()
                    .filter(|[i, j, ..]| i.to_array() < j.to_array())
                {
                    let labels = [self.grid.label(i), self.grid.label(j)];
                    self.add_polygon(&[&[i, j], &[i, j, k], &[i, j, k, l], &[i, j, l]], labels);
                }
            }
            _ => return false,
        }
        true
    }

    /// Adds a triangle, or a quadrangle cut along the diagonal from its first point.
    fn add_polygon(&mut self, points: &[&[I64Vec3]], labels: [u32; 2]) {
        let rows: Vec<u32> = points.iter().map(|nodes| self.point(nodes)).collect();
        for k in 1..rows.len() - 1 {
            self.set.add_film([rows[0], rows[k], rows[k + 1]], labels);
        }
    }

    /// Row of the point between lattice points: E of two, F of three, T of four.
    fn point(&mut self, nodes: &[I64Vec3]) -> u32 {
        let mut key = [NONE; 4];
        for (slot, node) in key.iter_mut().zip(nodes) {
            *slot = self.grid.row(*node);
        }
        key.sort_unstable();
        if let Some(row) = self.rows.get(&key) {
            return *row;
        }
        let mut nodes = nodes.to_vec();
        nodes.sort_by_key(|node| self.grid.row(*node));
        let place = self.place_between(&nodes);
        let row = self.set.add_vertex(place, false);
        self.rows.insert(key, row);
        row
    }

    /// A crossing, or the average of all crossings of the edges of a triangle or a tetrahedron.
    fn place_between(&self, nodes: &[I64Vec3]) -> DVec3 {
        let pairs = nodes.iter().enumerate().flat_map(|(k, a)| nodes[k + 1..].iter().map(move |b| (*a, *b)));
        let places: Vec<DVec3> = pairs.map(|(a, b)| self.crossing(a, b)).collect();
        places.iter().sum::<DVec3>() / places.len() as f64
    }

    fn crossing(&self, a: I64Vec3, b: I64Vec3) -> DVec3 {
        let ([x, y], [first, second]) = ([a, b].map(|n| self.grid.place(n)), [a, b].map(|n| self.grid.label(n)));
        let [before, after] =
            [(self.separation)(x, first, second), (self.separation)(y, second, first)].map(|far| far.max(0.0));
        let part = before / (before + after);
        let part = if part.is_finite() { part.clamp(MARGIN, 1.0 - MARGIN) } else { 0.5 };
        x.lerp(y, part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::measure::{checked, smallest_angle};
    use crate::shapes::random::Random;
    use proptest::prelude::{ProptestConfig, prop_assert, proptest};

    fn sphere(x: DVec3) -> f64 {
        1.0 - x.length()
    }

    #[test]
    fn one_label_gives_the_surface_of_its_body() {
        let errors = [0.3, 0.15].map(|cell| {
            let n = (3.2 / cell) as usize;
            let corner = DVec3::splat(-0.5 * cell * n as f64);
            let far = |x: DVec3, a: u32, _: u32| if a == 1 { sphere(x) } else { -sphere(x) };
            let set = interface(|x| u32::from(sphere(x) > 0.0), far, corner, [n; 3], cell);
            checked(&set).volumes()[1] / (4.0 * std::f64::consts::PI / 3.0) - 1.0
        });
        assert!(
            errors.iter().all(|error| error.abs() < 0.015),
            "crossings keep a margin from lattice points: {errors:?}"
        );
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn films_of_random_labels_hold(seed in 0u64..1_000_000, labels in 2u64..9, n in 3usize..6) {
            let random = |x: DVec3| {
                let place = (x * 2.0).round().as_i64vec3();
                let mut random = Random::new(seed ^ (place.x + 100 * (place.y + 100 * place.z)) as u64);
                (random.next() % labels) as u32
            };
            let mut set = interface(random, midway, DVec3::ZERO, [n; 3], 1.0);
            let mut used: Vec<u32> = set.labels.iter().flatten().copied().collect();
            used.sort_unstable();
            used.dedup();
            set.labels.iter_mut().flatten().for_each(|label| *label = used.binary_search(label).unwrap() as u32);
            if !set.triangles.is_empty() {
                checked(&set);
                prop_assert!(smallest_angle(&set) > 5.0);
            }
        }
    }

    #[test]
    fn pockets_of_the_outside_are_filled_and_bays_are_not() {
        let shell =
            |x: DVec3| u32::from((0.5..1.0).contains(&x.length()) && !(x.z > 0.0 && x.truncate().length() < 0.3));
        let hollow = |x: DVec3| u32::from((0.5..1.0).contains(&x.length()));
        for (label, volume) in [(&shell as &dyn Fn(DVec3) -> u32, 3.5), (&hollow, 4.1888)] {
            let mut grid = LabelGrid::sample(label, DVec3::splat(-1.5), [15; 3], 0.2);
            grid.fill_pockets(|_| 1);
            let found = checked(&grid.interface(midway)).volumes()[1];
            assert!((found / volume - 1.0).abs() < 0.06, "{found} {volume}");
        }
    }
}
