//! Broad phase: what lies near what, by uniform grids of boxes.
//!
//! ```text
//!   +-----+-----+-----+      Edges of a surface all have about the length L, so a grid of cells about 1.5 L is as good as a tree.
//!   |   +-|---+ |     |      Cells are hashed into a table of a fixed size; two cells in one bucket cost time, not truth.
//!   |   | |   | |     |      An element is listed in every cell that its box meets, and reported from one of them only:
//!   +---+-+---+-+-----+      the lowest cell that its box and the query have in common.
//!   |   +-|---+ |     |
//!   +-----+-----+-----+      Boxes of more than [`MOST_CELLS`] cells go to a list that every query looks at.
//! ```
//!
//! [`FaceGrid`] follows a mesh while it changes; [`BoxGrid`] is built once over anything. Answers of queries are ascending and
//! unique. All pairs at once ([`BoxGrid::pairs`]) are found bucket by bucket, without a query per box.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;
use smallvec::SmallVec;

use crate::rows::FaceRow;

/// Cells that one element may occupy before it is listed as oversized.
pub const MOST_CELLS: u64 = 64;

/// Width of the cells of a fitted grid in average widths of its boxes; dimensionless.
const FIT: f64 = 1.5;

/// Buckets in one piece of parallel work.
const PIECE: usize = 1024;

/// A box along the axes; the one of no points is empty and overlaps nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Least coordinates, metres.
    pub low: DVec3,
    /// Largest coordinates, metres.
    pub high: DVec3,
}

impl Aabb {
    /// The box of no points.
    pub const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    /// The least box with all points.
    #[must_use]
    pub fn of(points: &[DVec3]) -> Self {
        points.iter().fold(Self::EMPTY, |all, x| Self { low: all.low.min(*x), high: all.high.max(*x) })
    }

    /// Grown by `margin`, metres, to all sides.
    #[must_use]
    pub fn padded(self, margin: f64) -> Self {
        Self { low: self.low - DVec3::splat(margin), high: self.high + DVec3::splat(margin) }
    }

    /// The least box with both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Whether a point is in the box, its border included.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        point.cmpge(self.low).all() && point.cmple(self.high).all()
    }

    /// Whether they have a point in common; touching counts.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        self.low.x <= other.high.x
            && other.low.x <= self.high.x
            && self.low.y <= other.high.y
            && other.low.y <= self.high.y
            && self.low.z <= other.high.z
            && other.low.z <= self.high.z
    }
}

type Cell = [i32; 3];

/// Steps of a cell in which boxes are measured, as a power of two.
const FINE: u32 = 8;
/// Where space ends, in steps: what is beyond shares the last cell. Differences of two such numbers fit.
const END: f64 = (1 << 29) as f64;

/// A box in whole steps, rounded down: `[low, -high, 0, 0]`, or `[high, -low, 0, 0]` as a query.
///
/// Rounding keeps order, so that boxes which overlap still do.
type Steps = [i32; 8];

fn steps_of(bounds: &Aabb, per_length: f64) -> Steps {
    let scale = per_length * f64::from(1 << FINE);
    let [low, high] = [bounds.low, bounds.high].map(|x| x.to_array().map(|v| floor(v * scale)));
    [low[0], low[1], low[2], -high[0], -high[1], -high[2], 0, 0]
}

/// Largest whole number not above; a call of the library's `floor` would cost more than all the rest of a box.
fn floor(v: f64) -> i32 {
    let whole = v.clamp(-END, END) as i32;
    whole.wrapping_sub(i32::from(f64::from(whole) > v))
}

fn as_query(s: Steps) -> Steps {
    [-s[3], -s[4], -s[5], -s[0], -s[1], -s[2], 0, 0]
}

/// Whether the box of an entry may overlap that of a query. By signs and not by branches, which would be guessed wrong.
fn may_overlap(entry: &Steps, query: &Steps) -> bool {
    let mut signs = 0;
    for k in 0..8 {
        signs |= query[k].wrapping_sub(entry[k]);
    }
    signs >= 0
}

/// The cells that a box meets.
#[derive(Clone, Copy)]
struct CellRange {
    low: Cell,
    high: Cell,
}

impl CellRange {
    fn of(bounds: &Aabb, per_length: f64) -> Self {
        Self::of_steps(&steps_of(bounds, per_length))
    }

    fn of_steps(s: &Steps) -> Self {
        Self { low: lowest_cell(s), high: [-s[3] >> FINE, -s[4] >> FINE, -s[5] >> FINE] }
    }

    fn count(&self) -> u64 {
        let side = |k: usize| (i64::from(self.high[k]) - i64::from(self.low[k]) + 1).max(0) as u64;
        side(0).saturating_mul(side(1)).saturating_mul(side(2))
    }

    fn for_each(&self, mut visit: impl FnMut(Cell)) {
        for x in self.low[0]..=self.high[0] {
            for y in self.low[1]..=self.high[1] {
                for z in self.low[2]..=self.high[2] {
                    visit([x, y, z]);
                }
            }
        }
    }
}

fn lowest_cell(s: &Steps) -> Cell {
    [s[0] >> FINE, s[1] >> FINE, s[2] >> FINE]
}

/// Cells of a block along each axis, as a power of two.
const BLOCK: u32 = 2;

/// Bucket of a cell in a table of `mask + 1` buckets. Blocks of 4 x 4 x 4 cells are hashed as a whole, so that what is near in space
/// is near in memory.
fn bucket(cell: Cell, mask: usize) -> usize {
    let block = cell.map(|c| i64::from(c >> BLOCK));
    let mixed = block[0].wrapping_mul(0x9E37_79B9_7F4A_7C15_u64 as i64)
        ^ block[1].wrapping_mul(0xC2B2_AE3D_27D4_EB4F_u64 as i64)
        ^ block[2].wrapping_mul(0x1656_67B1_9E37_79F9_u64 as i64);
    let within = cell.map(|c| (c & ((1 << BLOCK) - 1)) as usize);
    let within = (within[0] << (2 * BLOCK)) | (within[1] << BLOCK) | within[2];
    ((((mixed as u64) >> 32) as usize) << (3 * BLOCK) | within) & mask
}

/// Whether `cell` is the lowest that ranges starting at `a` and `b` have in common.
fn is_first_common(cell: Cell, a: Cell, b: Cell) -> bool {
    (0..3).all(|k| cell[k] == a[k].max(b[k]))
}

fn sort_unique<T: Ord>(found: &mut Vec<T>) {
    found.sort_unstable();
    found.dedup();
}

/// Faces by their boxes, for a mesh that changes.
#[derive(Clone, Debug)]
pub struct FaceGrid {
    per_length: f64,
    buckets: Vec<SmallVec<[(FaceRow, Cell); 4]>>,
    oversized: Vec<FaceRow>,
}

impl FaceGrid {
    /// An empty grid with cells of `cell` metres (about 1.5 edge lengths), for about `expected` faces.
    #[must_use]
    pub fn new(cell: f64, expected: usize) -> Self {
        let buckets = vec![SmallVec::new(); expected.max(16).next_power_of_two()];
        Self { per_length: cell.recip(), buckets, oversized: Vec::new() }
    }

    /// Adds a face with its box.
    pub fn insert(&mut self, face: FaceRow, bounds: Aabb) {
        let range = CellRange::of(&bounds, self.per_length);
        if range.count() > MOST_CELLS {
            self.oversized.push(face);
            return;
        }
        let (mask, buckets) = (self.buckets.len() - 1, &mut self.buckets);
        range.for_each(|cell| buckets[bucket(cell, mask)].push((face, range.low)));
    }

    /// Removes a face; `bounds` must be the box that it was inserted with.
    pub fn remove(&mut self, face: FaceRow, bounds: Aabb) {
        let range = CellRange::of(&bounds, self.per_length);
        if range.count() > MOST_CELLS {
            self.oversized.retain(|other| *other != face);
            return;
        }
        let (mask, buckets) = (self.buckets.len() - 1, &mut self.buckets);
        range.for_each(|cell| {
            let list = &mut buckets[bucket(cell, mask)];
            let at = list.iter().position(|entry| *entry == (face, range.low));
            debug_assert!(at.is_some(), "invariant: {face} is removed with the box it was inserted with");
            if let Some(at) = at {
                list.swap_remove(at);
            }
        });
    }

    /// Replaces `found` by all faces that may meet the box, ascending and unique: every face whose box does is among them.
    pub fn query(&self, bounds: Aabb, found: &mut Vec<FaceRow>) {
        let range = CellRange::of(&bounds, self.per_length);
        found.clear();
        found.extend(&self.oversized);
        if range.count() > self.buckets.len() as u64 {
            found.extend(self.buckets.iter().flatten().map(|(face, _)| *face));
        } else {
            let mask = self.buckets.len() - 1;
            range.for_each(|cell| {
                let entries = self.buckets[bucket(cell, mask)].iter();
                found.extend(entries.filter(|(_, low)| is_first_common(cell, *low, range.low)).map(|(face, _)| *face));
            });
        }
        sort_unique(found);
    }
}

/// Boxes in a grid that is built once: lists of all buckets one behind the other, by a counting sort.
#[derive(Clone, Debug)]
pub struct BoxGrid {
    per_length: f64,
    boxes: Vec<Aabb>,
    starts: Vec<u32>,
    entries: Vec<u32>,
    /// Per entry.
    steps: Vec<Steps>,
    oversized: Vec<u32>,
}

impl BoxGrid {
    /// A grid over `boxes` with cells of `cell` metres; empty boxes are never found.
    #[must_use]
    pub fn build(boxes: Vec<Aabb>, cell: f64) -> Self {
        let mask = boxes.len().max(16).next_power_of_two() - 1;
        Self::build_into(boxes, cell.recip(), mask)
    }

    fn build_into(boxes: Vec<Aabb>, per_length: f64, mask: usize) -> Self {
        let all: Vec<Steps> = boxes.iter().map(|bounds| steps_of(bounds, per_length)).collect();
        let (mut starts, mut oversized) = (vec![0u32; mask + 2], Vec::new());
        // Buckets of all boxes one behind the other, and where those of each box end.
        let mut listed: Vec<u32> = Vec::with_capacity(6 * boxes.len());
        let mut ends: Vec<u32> = Vec::with_capacity(boxes.len());
        for (row, range) in (0..).zip(all.iter().map(CellRange::of_steps)) {
            let from = listed.len();
            if range.count() > MOST_CELLS {
                oversized.push(row);
            } else {
                range.for_each(|cell| {
                    let at = bucket(cell, mask) as u32;
                    // Two cells of one box may share a bucket; it is listed once.
                    if !listed[from..].contains(&at) {
                        listed.push(at);
                        starts[at as usize + 1] += 1;
                    }
                });
            }
            ends.push(listed.len() as u32);
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut entries = vec![0u32; listed.len()];
        let mut steps = vec![[0; 8]; listed.len()];
        let mut from = 0;
        for ((row, own), end) in (0..).zip(&all).zip(ends) {
            for at in &listed[from..end as usize] {
                let place = next[*at as usize] as usize;
                (entries[place], steps[place]) = (row, *own);
                next[*at as usize] += 1;
            }
            from = end as usize;
        }
        Self { per_length, boxes, starts, entries, steps, oversized }
    }

    /// A grid over `boxes` with cells that fit them: as wide as they are on average, so that each meets a few.
    #[must_use]
    pub fn fitted(boxes: Vec<Aabb>) -> Self {
        let width = |b: &Aabb| (b.high - b.low).max_element();
        let (mut sum, mut count) = (0.0, 0.0);
        for width in boxes.iter().map(width).filter(|width| width.is_finite()) {
            sum += width;
            count += 1.0;
        }
        let cell = FIT * sum / count;
        // All boxes are points, or there is none: any width is as good.
        Self::build(boxes, if cell > 0.0 { cell } else { 1.0 })
    }

    /// The boxes, in their order.
    #[must_use]
    pub fn boxes(&self) -> &[Aabb] {
        &self.boxes
    }

    /// Replaces `found` by the rows of all boxes that overlap the box, ascending and unique.
    pub fn query(&self, bounds: &Aabb, found: &mut Vec<u32>) {
        let own = steps_of(bounds, self.per_length);
        let (range, query) = (CellRange::of_steps(&own), as_query(own));
        let overlaps = |row: &u32| self.boxes[*row as usize].overlaps(bounds);
        found.clear();
        if range.count() > self.boxes.len() as u64 {
            found.extend((0..self.boxes.len() as u32).filter(overlaps));
            return;
        }
        found.extend(self.oversized.iter().copied().filter(overlaps));
        let mask = self.starts.len() - 2;
        range.for_each(|cell| {
            let at = bucket(cell, mask);
            let list = self.starts[at] as usize..self.starts[at + 1] as usize;
            for (row, entry) in self.entries[list.clone()].iter().zip(&self.steps[list]) {
                let is_near = may_overlap(entry, &query) && is_first_common(cell, lowest_cell(entry), range.low);
                if is_near && overlaps(row) {
                    found.push(*row);
                }
            }
        });
        found.sort_unstable();
    }

    /// What `visit` makes of every pair of boxes that overlap, the lower row first; in some order, the same on any number of threads.
    #[must_use]
    pub fn pairs<R: Send>(&self, visit: impl Fn(u32, u32) -> Option<R> + Sync) -> Vec<R> {
        self.in_pieces(self.entries.len(), |buckets, made| {
            let mut take = |a: u32, b: u32| made.extend(visit(a.min(b), a.max(b)));
            if buckets.start == 0 {
                for a in &self.oversized {
                    let is_own_turn = |b: &u32| *b > *a || (*b < *a && self.oversized.binary_search(b).is_err());
                    (0..self.boxes.len() as u32)
                        .filter(is_own_turn)
                        .for_each(|b| self.take_if_near(self, *a, b, &mut take));
                }
            }
            for at in buckets {
                let (rows, steps) = self.list(at);
                for (i, own) in steps.iter().enumerate() {
                    self.pairs_of_entry(self, at, (rows[i], own), (&rows[i + 1..], &steps[i + 1..]), &mut take);
                }
            }
        })
    }

    /// What `visit` makes of every box of `others` and every box here that overlap, in this order of rows; in some order,
    /// the same on any number of threads.
    #[must_use]
    pub fn pairs_with<R: Send>(&self, others: Vec<Aabb>, visit: impl Fn(u32, u32) -> Option<R> + Sync) -> Vec<R> {
        let others = Self::build_into(others, self.per_length, self.starts.len() - 2);
        self.in_pieces(self.entries.len() + others.entries.len(), |buckets, made| {
            let mut take = |a: u32, b: u32| made.extend(visit(a, b));
            if buckets.start == 0 {
                for a in &others.oversized {
                    (0..self.boxes.len() as u32).for_each(|b| others.take_if_near(self, *a, b, &mut take));
                }
                for b in &self.oversized {
                    let is_own_turn = |a: &u32| others.oversized.binary_search(a).is_err();
                    let rows = (0..others.boxes.len() as u32).filter(is_own_turn);
                    rows.for_each(|a| others.take_if_near(self, a, *b, &mut take));
                }
            }
            for at in buckets {
                let (rows, steps) = others.list(at);
                for entry in rows.iter().copied().zip(steps) {
                    others.pairs_of_entry(self, at, entry, self.list(at), &mut take);
                }
            }
        })
    }

    /// Lets `fill` append to a list for fixed ranges of buckets, on all threads if there is much work; the lists stay in order.
    fn in_pieces<R: Send>(&self, work: usize, fill: impl Fn(Range<usize>, &mut Vec<R>) + Sync) -> Vec<R> {
        let buckets = self.starts.len() - 1;
        let piece = |k: usize| {
            let mut made = Vec::new();
            fill(k * PIECE..buckets.min((k + 1) * PIECE), &mut made);
            made
        };
        let pieces = buckets.div_ceil(PIECE);
        if work < 8 * PIECE {
            return (0..pieces).flat_map(piece).collect();
        }
        let made: Vec<Vec<R>> = (0..pieces).into_par_iter().map(piece).collect();
        made.into_iter().flatten().collect()
    }

    /// Rows and boxes of a bucket.
    fn list(&self, at: usize) -> (&[u32], &[Steps]) {
        let list = self.starts[at] as usize..self.starts[at + 1] as usize;
        (&self.entries[list.clone()], &self.steps[list])
    }

    /// Takes the pairs of an entry of this grid with entries of another of which bucket `at` is the first in common.
    fn pairs_of_entry(
        &self,
        other: &Self,
        at: usize,
        (row, own): (u32, &Steps),
        (rows, steps): (&[u32], &[Steps]),
        take: &mut impl FnMut(u32, u32),
    ) {
        let (query, low, mask) = (as_query(*own), lowest_cell(own), self.starts.len() - 2);
        for (other_row, entry) in rows.iter().zip(steps) {
            if !may_overlap(entry, &query) {
                continue;
            }
            let entry_low = lowest_cell(entry);
            if bucket([0, 1, 2].map(|k: usize| low[k].max(entry_low[k])), mask) == at {
                self.take_if_near(other, row, *other_row, take);
            }
        }
    }

    fn take_if_near(&self, other: &Self, own_row: u32, other_row: u32, take: &mut impl FnMut(u32, u32)) {
        if self.boxes[own_row as usize].overlaps(&other.boxes[other_row as usize]) {
            take(own_row, other_row);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn bounds() -> impl Strategy<Value = Aabb> {
        let place = prop::array::uniform3(-5.0..5.0f64).prop_map(DVec3::from_array);
        let size = (prop_oneof![9 => Just(1.0), 1 => Just(30.0)], prop::array::uniform3(0.0..1.0f64));
        (place, size).prop_map(|(x, (k, size))| Aabb::of(&[x, x + DVec3::from_array(size) * k]))
    }

    #[test]
    fn boxes_that_touch_overlap_and_empty_ones_do_not() {
        let unit = Aabb::of(&[DVec3::ZERO, DVec3::ONE]);
        let next = Aabb::of(&[DVec3::X, DVec3::ONE + DVec3::X]);
        assert!(unit.overlaps(&next) && !unit.padded(-0.1).overlaps(&next));
        assert!(!Aabb::EMPTY.overlaps(&unit) && !unit.overlaps(&Aabb::EMPTY));
        assert_eq!(unit.union(next), Aabb::of(&[DVec3::ZERO, DVec3::new(2.0, 1.0, 1.0)]));
    }

    proptest! {
        #[test]
        fn a_box_grid_finds_what_a_search_through_all_finds(boxes in prop::collection::vec(bounds(), 0..80), query in bounds(), k in -20..21i32) {
            let scale = 2f64.powi(k);
            let scaled = |b: &Aabb| Aabb { low: b.low * scale, high: b.high * scale };
            let boxes: Vec<Aabb> = boxes.iter().map(scaled).collect();
            let grid = BoxGrid::build(boxes.clone(), scale);
            let mut found = Vec::new();
            for query in std::iter::once(&scaled(&query)).chain(&boxes) {
                grid.query(query, &mut found);
                let expected: Vec<u32> = (0..boxes.len() as u32).filter(|j| boxes[*j as usize].overlaps(query)).collect();
                prop_assert_eq!(&found, &expected);
            }
            let mut pairs = grid.pairs(|a, b| Some((a, b)));
            pairs.sort_unstable();
            let all = (0..boxes.len() as u32).flat_map(|a| (a + 1..boxes.len() as u32).map(move |b| (a, b)));
            let expected: Vec<_> = all.filter(|(a, b)| boxes[*a as usize].overlaps(&boxes[*b as usize])).collect();
            prop_assert_eq!(pairs, expected);
            let others: Vec<Aabb> = boxes.iter().rev().map(|b| Aabb { low: b.low + DVec3::X * scale, ..*b }).collect();
            let others: Vec<Aabb> = others.into_iter().filter(|b| b.low.x <= b.high.x).collect();
            let mut pairs = grid.pairs_with(others.clone(), |a, b| Some((a, b)));
            pairs.sort_unstable();
            let all = (0..others.len() as u32).flat_map(|a| (0..boxes.len() as u32).map(move |b| (a, b)));
            let expected: Vec<_> = all.filter(|(a, b)| others[*a as usize].overlaps(&boxes[*b as usize])).collect();
            prop_assert_eq!(pairs, expected);
        }

        #[test]
        fn a_face_grid_finds_all_faces_and_forgets_removed_ones(boxes in prop::collection::vec((bounds(), any::<bool>()), 0..80), query in bounds()) {
            let mut grid = FaceGrid::new(1.0, 4);
            let face = |i: usize| FaceRow(i as u32);
            for (i, (bounds, _)) in boxes.iter().enumerate() {
                grid.insert(face(i), *bounds);
            }
            for (i, (bounds, _)) in boxes.iter().enumerate().filter(|(_, (_, is_kept))| !is_kept) {
                grid.remove(face(i), *bounds);
            }
            let mut found = Vec::new();
            grid.query(query, &mut found);
            prop_assert!(found.is_sorted_by(|a, b| a < b));
            prop_assert!(found.iter().all(|face| boxes[face.index()].1));
            for (i, (bounds, is_kept)) in boxes.iter().enumerate() {
                prop_assert!(!is_kept || !bounds.overlaps(&query) || found.contains(&face(i)));
            }
            boxes.iter().enumerate().filter(|(_, (_, is_kept))| *is_kept).for_each(|(i, (bounds, _))| grid.remove(face(i), *bounds));
            prop_assert!(grid.oversized.is_empty() && grid.buckets.iter().all(SmallVec::is_empty));
        }
    }

    #[test]
    fn a_query_of_everything_and_boxes_far_away_are_cheap() {
        let far = |i: usize| DVec3::splat(1e12 * i as f64);
        let boxes: Vec<Aabb> = (0..100).map(|i| Aabb::of(&[far(i), far(i) + DVec3::ONE])).collect();
        let grid = BoxGrid::build(boxes, 1.0);
        let mut found = Vec::new();
        grid.query(&Aabb::of(&[DVec3::splat(-1e300), DVec3::splat(1e300)]), &mut found);
        assert_eq!(found.len(), 100);
        grid.query(&grid.boxes()[7], &mut found);
        assert_eq!(found, [7]);
    }
}
