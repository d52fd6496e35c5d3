//! A balanced binary tree of points: which points are near each other.
//!
//! A cell's box is cut across its longest side so that all leaves but the last hold exactly [`LEAF`] points: leaf `i` holds the
//! points `i LEAF ..` of the tree's order, in full blocks. Cells stand parent first: the left child follows its parent, and a
//! cell over `m` leaves has `2m - 1` cells in all. Equal coordinates are told apart by the points' rows, so the tree depends on
//! nothing but its input.

use std::ops::Range;

use glam::DVec3;

use crate::blocks::LANES;

/// Points in a leaf.
pub(super) const LEAF: usize = 4 * LANES;

/// Points below which a tree is not built in parallel.
const PARALLEL: usize = 1 << 13;

/// Points that are near each other.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cell {
    /// Middle of the points' box.
    pub(super) centre: DVec3,
    /// Largest distance of a point from the middle.
    pub(super) radius: f64,
    /// First of its leaves.
    first_leaf: u32,
    /// Number of its leaves; 1 for a leaf.
    leaves: u32,
}

/// Points in the tree's order, and cells over them.
#[derive(Debug, Default)]
pub(super) struct Tree {
    /// Points, near ones together.
    pub(super) points: Vec<DVec3>,
    /// Row of each point in the caller's list.
    pub(super) rows: Vec<u32>,
    /// Cells, parent first.
    pub(super) cells: Vec<Cell>,
}

impl Cell {
    /// The leaf that this cell is, if it is one.
    pub(super) fn leaf(&self) -> Option<usize> {
        (self.leaves == 1).then_some(self.first_leaf as usize)
    }
}

impl Tree {
    pub(super) fn new(points: impl Iterator<Item = DVec3>) -> Self {
        let mut rows: Vec<(DVec3, u32)> = points.zip(0..).collect();
        let leaves = rows.len().div_ceil(LEAF);
        let mut cells = vec![Cell::default(); (2 * leaves).saturating_sub(1)];
        if leaves > 0 {
            divide(&mut rows, &mut cells, 0);
        }
        let (points, rows) = rows.into_iter().unzip();
        Self { points, rows, cells }
    }

    /// How many times the radius of small leaves goes into that of the whole: the tenth part of leaves are smaller. At least 1.
    pub(super) fn resolution(&self) -> f64 {
        let mut radii: Vec<f64> =
            self.cells.iter().filter(|cell| cell.leaf().is_some()).map(|leaf| leaf.radius).collect();
        let tenth = radii.len() / 10;
        let Some(whole) = self.cells.first().map(|root| root.radius) else { return 1.0 };
        let (_, small, _) = radii.select_nth_unstable_by(tenth, f64::total_cmp);
        (whole / *small).max(1.0)
    }

    /// Number of leaves.
    pub(super) fn leaf_count(&self) -> usize {
        self.points.len().div_ceil(LEAF)
    }

    /// Points of a leaf.
    pub(super) fn points_of(&self, leaf: usize) -> Range<usize> {
        leaf * LEAF..((leaf + 1) * LEAF).min(self.points.len())
    }

    /// Children of a cell that is no leaf.
    pub(super) fn children(&self, cell: usize) -> [usize; 2] {
        let left = self.cells[cell].leaves.div_ceil(2) as usize;
        [cell + 1, cell + 2 * left]
    }
}

/// Fills the cells over some points and puts the points in order.
fn divide(points: &mut [(DVec3, u32)], cells: &mut [Cell], first_leaf: u32) {
    let leaves = cells.len().div_ceil(2);
    let (low, high) = bounds(points);
    let centre = 0.5 * (low + high);
    let radius = points.iter().map(|(x, _)| x.distance_squared(centre)).fold(0.0, f64::max).sqrt();
    let (cell, children) = cells.split_first_mut().expect("invariant: a cell for every part");
    *cell = Cell { centre, radius, first_leaf, leaves: leaves as u32 };
    if leaves == 1 {
        return;
    }
    let left_leaves = leaves.div_ceil(2);
    let size = (high - low).to_array();
    let axis = (0..3).fold(0, |longest, axis| if size[axis] > size[longest] { axis } else { longest });
    let cut = left_leaves * LEAF;
    points.select_nth_unstable_by(cut, |(x, i), (y, j)| x[axis].total_cmp(&y[axis]).then(i.cmp(j)));
    let parallel = points.len() > PARALLEL;
    let (left, right) = points.split_at_mut(cut);
    let (left_cells, right_cells) = children.split_at_mut(2 * left_leaves - 1);
    let mut divide_left = || divide(left, left_cells, first_leaf);
    let mut divide_right = || divide(right, right_cells, first_leaf + left_leaves as u32);
    if parallel {
        rayon::join(divide_left, divide_right);
    } else {
        divide_left();
        divide_right();
    }
}

fn bounds(points: &[(DVec3, u32)]) -> (DVec3, DVec3) {
    let first = points[0].0;
    points.iter().fold((first, first), |(low, high), (x, _)| (low.min(*x), high.max(*x)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn cells_hold_their_points_and_leaves_are_full(
            points in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 1..500),
        ) {
            let points: Vec<DVec3> = points.into_iter().map(DVec3::from).collect();
            let tree = Tree::new(points.iter().copied());
            let mut rows = tree.rows.clone();
            rows.sort_unstable();
            prop_assert_eq!(rows, (0..points.len() as u32).collect::<Vec<_>>());
            let mut leaves = vec![];
            let mut open = vec![0];
            while let Some(cell) = open.pop() {
                let Cell { centre, radius, first_leaf, leaves: count } = tree.cells[cell];
                for leaf in first_leaf..first_leaf + count {
                    for i in tree.points_of(leaf as usize) {
                        prop_assert!(tree.points[i].distance(centre) <= radius * (1.0 + 1e-12));
                        prop_assert_eq!(tree.points[i], points[tree.rows[i] as usize]);
                    }
                }
                match tree.cells[cell].leaf() {
                    Some(leaf) => leaves.push(leaf),
                    None => open.extend(tree.children(cell).into_iter().rev()),
                }
            }
            prop_assert_eq!(leaves, (0..tree.leaf_count()).collect::<Vec<_>>());
        }
    }

    #[test]
    fn no_points_have_no_cells() {
        assert!(Tree::new(std::iter::empty()).cells.is_empty());
    }
}
