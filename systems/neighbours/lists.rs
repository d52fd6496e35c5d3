//! Compressed rows of neighbours: one contiguous list of rows per particle, built once per motion and shared.

use super::cells::CellList;
use froth_components::motion::Position;
use rayon::prelude::*;
use std::ops::Range;

/// Targets per parallel piece of work.
const CHUNK: usize = 1024;

/// What one chunk of targets found.
struct Piece<T, G> {
    /// Ends of the targets' neighbours in `indices`.
    ends: Vec<usize>,
    indices: Vec<u32>,
    values: Vec<T>,
    given: Vec<G>,
}

/// For every target row, the rows of its neighbours.
#[derive(Clone, Debug, Default)]
pub struct NeighbourLists {
    /// Where each target's neighbours begin in `indices`; one more than there are targets.
    pub offsets: Vec<usize>,
    /// Rows of the neighbours, target after target.
    pub indices: Vec<u32>,
}

impl NeighbourLists {
    /// Neighbours of every target among `sources` within `radius` metres that pass `keep(target, source)`.
    #[must_use]
    pub fn within(
        targets: &[Position],
        sources: &[Position],
        cells: &CellList,
        radius: f64,
        keep: impl Fn(usize, usize) -> bool + Sync,
    ) -> Self {
        Self::collect(targets.len(), |target, found| {
            let place = targets[target].0;
            cells.for_each_near(place, radius, |source| {
                if place.distance_squared(sources[source].0) < radius * radius && keep(target, source) {
                    found.push(source as u32);
                }
            });
        })
    }

    /// Lists filled by `find(target, neighbours)`, which appends.
    #[must_use]
    pub fn collect(targets: usize, find: impl Fn(usize, &mut Vec<u32>) + Sync) -> Self {
        Self::collect_beside(targets, |target, found, _: &mut Vec<()>| find(target, found)).0
    }

    /// Lists filled by `find(target, neighbours, values)`, which appends; the values, in order; and what `find` gave
    /// for each target.
    #[must_use]
    pub fn collect_beside<T: Copy + Send, G: Copy + Send>(
        targets: usize,
        find: impl Fn(usize, &mut Vec<u32>, &mut Vec<T>) -> G + Sync,
    ) -> (Self, Vec<T>, Vec<G>) {
        let pieces: Vec<Piece<T, G>> = (0..targets.div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let rows = chunk * CHUNK..((chunk + 1) * CHUNK).min(targets);
                let mut piece = Piece {
                    ends: Vec::with_capacity(rows.len()),
                    indices: Vec::with_capacity(rows.len() * 32),
                    values: Vec::with_capacity(rows.len() * 32),
                    given: Vec::with_capacity(rows.len()),
                };
                for target in rows {
                    piece.given.push(find(target, &mut piece.indices, &mut piece.values));
                    piece.ends.push(piece.indices.len());
                }
                piece
            })
            .collect();
        Self::join(targets, &pieces)
    }

    fn join<T: Copy, G: Copy>(targets: usize, pieces: &[Piece<T, G>]) -> (Self, Vec<T>, Vec<G>) {
        let mut offsets = Vec::with_capacity(targets + 1);
        offsets.push(0);
        let mut indices = Vec::with_capacity(pieces.iter().map(|piece| piece.indices.len()).sum());
        let mut values = Vec::with_capacity(pieces.iter().map(|piece| piece.values.len()).sum());
        let mut given = Vec::with_capacity(targets);
        for piece in pieces {
            let start = indices.len();
            offsets.extend(piece.ends.iter().map(|&end| start + end));
            indices.extend_from_slice(&piece.indices);
            values.extend_from_slice(&piece.values);
            given.extend_from_slice(&piece.given);
        }
        (Self { offsets, indices }, values, given)
    }

    /// Number of targets.
    #[must_use]
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Whether there are no targets.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Cuts `values`, which stand beside `indices`, into pieces of whole rows: the rows and their values.
    pub fn pieces_mut<'a, T>(&self, values: &'a mut [T]) -> Vec<(Range<usize>, &'a mut [T])> {
        let mut pieces = Vec::with_capacity(self.len().div_ceil(CHUNK));
        let mut rest = values;
        for start in (0..self.len()).step_by(CHUNK) {
            let rows = start..(start + CHUNK).min(self.len());
            let (piece, tail) = rest.split_at_mut(self.offsets[rows.end] - self.offsets[start]);
            pieces.push((rows, piece));
            rest = tail;
        }
        pieces
    }

    /// Where target `row`'s neighbours stand in [`NeighbourLists::indices`] and in arrays of weights beside it.
    #[must_use]
    #[inline]
    pub fn range(&self, row: usize) -> Range<usize> {
        self.offsets[row]..self.offsets[row + 1]
    }

    /// Rows of target `row`'s neighbours.
    #[must_use]
    #[inline]
    pub fn of(&self, row: usize) -> &[u32] {
        &self.indices[self.range(row)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn lists_agree_with_brute_force() {
        let points: Vec<Position> = (0..3000)
            .map(|i| f64::from(i) * 0.618)
            .map(|t| Position(DVec3::new(t.sin(), (1.7 * t).cos(), 0.3)))
            .collect();
        let lists = NeighbourLists::within(&points, &points, &CellList::build(&points, 0.1), 0.1, |i, j| i != j);
        for (i, p) in points.iter().enumerate().step_by(97) {
            let near = |j: &usize| *j != i && p.0.distance(points[*j].0) < 0.1;
            let mut found: Vec<usize> = lists.of(i).iter().map(|&j| j as usize).collect();
            found.sort_unstable();
            assert_eq!(found, (0..points.len()).filter(near).collect::<Vec<_>>());
        }
    }
}
