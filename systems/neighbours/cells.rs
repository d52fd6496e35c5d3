//! A cell list: points sorted into the cells of a uniform grid, so that all points near a place are in a few cells.

use froth_components::motion::Position;
use glam::DVec3;

/// Most cells a list may have per point, and at least; larger boxes get larger cells, which costs time, not memory.
const CELLS_PER_POINT: usize = 8;
const CELLS_AT_LEAST: usize = 1 << 21;

/// Points of one set sorted by grid cell. Rebuilt whenever the points move.
#[derive(Clone, Debug, Default)]
pub struct CellList {
    origin: DVec3,
    inverse_size: f64,
    counts: [usize; 3],
    /// First entry of each cell in `members`, one more than there are cells.
    starts: Vec<u32>,
    /// Rows of the points, cell after cell, ascending within a cell.
    members: Vec<u32>,
}

impl CellList {
    /// Sorts `points` into cells at least `size` metres wide.
    #[must_use]
    pub fn build(points: &[Position], size: f64) -> Self {
        let mut list = Self::default();
        list.rebuild(points, size);
        list
    }

    /// As [`CellList::build`], reusing memory.
    pub fn rebuild(&mut self, points: &[Position], size: f64) {
        let (low, high) = bounds(points);
        let size = widened(size, high - low, points.len());
        self.origin = low;
        self.inverse_size = 1.0 / size;
        self.counts = ((high - low) / size).to_array().map(|extent| extent as usize + 1);
        let cells: Vec<u32> = points.iter().map(|p| self.index(self.place(p.0)) as u32).collect();
        self.starts.clear();
        self.starts.resize(self.counts.iter().product::<usize>() + 1, 0);
        cells.iter().for_each(|&c| self.starts[c as usize + 1] += 1);
        for i in 1..self.starts.len() {
            self.starts[i] += self.starts[i - 1];
        }
        let mut next = self.starts.clone();
        self.members.resize(points.len(), 0);
        for (row, &cell) in cells.iter().enumerate() {
            self.members[next[cell as usize] as usize] = row as u32;
            next[cell as usize] += 1;
        }
    }

    /// Grid place of a point; outside the box it is the nearest border cell or one beyond it.
    fn place(&self, point: DVec3) -> [isize; 3] {
        let place = (point - self.origin) * self.inverse_size;
        std::array::from_fn(|axis| (place[axis].floor() as isize).clamp(-2, self.counts[axis] as isize + 1))
    }

    fn index(&self, place: [isize; 3]) -> usize {
        (place[2] as usize * self.counts[1] + place[1] as usize) * self.counts[0] + place[0] as usize
    }

    /// Calls `visit` with every row in the cells that the ball around `point` touches: all rows within `radius`, and more.
    /// The order is fixed by the grid.
    #[inline]
    pub fn for_each_near(&self, point: DVec3, radius: f64, mut visit: impl FnMut(usize)) {
        if self.members.is_empty() {
            return;
        }
        let centre = (point - self.origin) * self.inverse_size;
        let reach = radius * self.inverse_size * (1.0 + 1e-12);
        let span = |axis: usize, reach: f64| {
            // The cast rounds down what is not negative.
            let cell = |place: f64| (place + 1.0).clamp(0.0, (self.counts[axis] + 1) as f64) as isize - 1;
            cell(centre[axis] - reach).max(0)..=cell(centre[axis] + reach).min(self.counts[axis] as isize - 1)
        };
        // Distance from the centre to a cell along an axis.
        let gap =
            |axis: usize, cell: isize| (cell as f64 - centre[axis]).max(centre[axis] - (cell + 1) as f64).max(0.0);
        for z in span(2, reach) {
            let left = reach * reach - gap(2, z).powi(2);
            for y in span(1, reach) {
                let left = left - gap(1, y).powi(2);
                let across = span(0, left.max(0.0).sqrt());
                if left < 0.0 || across.is_empty() {
                    continue;
                }
                let start = self.starts[self.index([*across.start(), y, z])] as usize;
                let end = self.starts[self.index([*across.end(), y, z]) + 1] as usize;
                self.members[start..end].iter().for_each(|&row| visit(row as usize));
            }
        }
    }

    /// Calls `visit` with every row in the cells that the box from `low` to `high` touches: all rows in the box, and more.
    /// The order is fixed by the grid.
    #[inline]
    pub fn for_each_in_box(&self, low: DVec3, high: DVec3, mut visit: impl FnMut(usize)) {
        if self.members.is_empty() {
            return;
        }
        let (first, last) = (self.place(low), self.place(high));
        let span = |axis: usize| first[axis].max(0)..=last[axis].min(self.counts[axis] as isize - 1);
        let across = span(0);
        if across.is_empty() {
            return;
        }
        for z in span(2) {
            for y in span(1) {
                let start = self.starts[self.index([*across.start(), y, z])] as usize;
                let end = self.starts[self.index([*across.end(), y, z]) + 1] as usize;
                self.members[start..end].iter().for_each(|&row| visit(row as usize));
            }
        }
    }

    /// Rows in grid order: an order in which near points are mostly near.
    #[must_use]
    pub fn members(&self) -> &[u32] {
        &self.members
    }
}

/// Smallest box around the points.
fn bounds(points: &[Position]) -> (DVec3, DVec3) {
    let Some(first) = points.first() else { return (DVec3::ZERO, DVec3::ZERO) };
    points.iter().fold((first.0, first.0), |(low, high), p| (low.min(p.0), high.max(p.0)))
}

/// Cell size, doubled until the grid over `extent` is affordable for `count` points.
fn widened(size: f64, extent: DVec3, count: usize) -> f64 {
    let affordable = (CELLS_PER_POINT * count).max(CELLS_AT_LEAST) as f64;
    let mut size = size;
    while (extent / size + DVec3::ONE).to_array().iter().product::<f64>() > affordable {
        size *= 2.0;
    }
    size
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_neighbour_is_missed(
            raw in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 1..60),
            query in prop::array::uniform3(-1.5..1.5f64),
            size in 0.05..0.8f64,
            radius in 0.02..1.0f64,
        ) {
            let points: Vec<Position> = raw.iter().map(|&p| Position(DVec3::from_array(p))).collect();
            let query = DVec3::from_array(query);
            let list = CellList::build(&points, size);
            let (mut near, mut boxed) = (vec![0; points.len()], vec![0; points.len()]);
            list.for_each_near(query, radius, |row| near[row] += 1);
            list.for_each_in_box(query - radius, query + radius, |row| boxed[row] += 1);
            for (row, point) in points.iter().enumerate() {
                prop_assert!(near[row] <= 1 && boxed[row] <= 1);
                prop_assert!(near[row] == 1 || point.0.distance(query) > radius);
                prop_assert!(boxed[row] == 1 || point.0.distance(query) > radius);
            }
        }
    }

    #[test]
    fn one_far_point_does_not_exhaust_memory() {
        let points = [DVec3::ZERO, DVec3::splat(1e6)].map(Position);
        let list = CellList::build(&points, 1e-6);
        assert!(list.starts.len() <= CELLS_AT_LEAST + 1);
    }
}
