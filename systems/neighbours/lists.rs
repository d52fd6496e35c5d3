//! Compressed rows of neighbours: one contiguous list of rows per particle, built once per motion and shared.

use super::cells::CellList;
use froth_components::motion::Position;
use rayon::prelude::*;

/// Targets per parallel piece of work.
const CHUNK: usize = 1024;

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
            cells.for_each_near(place, |source| {
                if place.distance_squared(sources[source].0) < radius * radius && keep(target, source) {
                    found.push(source as u32);
                }
            });
        })
    }

    /// Lists filled by `find(target, neighbours)`, which appends.
    #[must_use]
    pub fn collect(targets: usize, find: impl Fn(usize, &mut Vec<u32>) + Sync) -> Self {
        let pieces: Vec<(Vec<u32>, Vec<u32>)> = (0..targets.div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let rows = chunk * CHUNK..((chunk + 1) * CHUNK).min(targets);
                let mut ends = Vec::with_capacity(rows.len());
                let mut found = Vec::with_capacity(rows.len() * 32);
                for target in rows {
                    find(target, &mut found);
                    ends.push(found.len() as u32);
                }
                (ends, found)
            })
            .collect();
        Self::join(targets, &pieces)
    }

    fn join(targets: usize, pieces: &[(Vec<u32>, Vec<u32>)]) -> Self {
        let mut offsets = Vec::with_capacity(targets + 1);
        offsets.push(0);
        let mut indices = Vec::with_capacity(pieces.iter().map(|(_, found)| found.len()).sum());
        for (ends, found) in pieces {
            let start = indices.len();
            offsets.extend(ends.iter().map(|&end| start + end as usize));
            indices.extend_from_slice(found);
        }
        Self { offsets, indices }
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

    /// Where target `row`'s neighbours stand in [`NeighbourLists::indices`] and in arrays of weights beside it.
    #[must_use]
    #[inline]
    pub fn range(&self, row: usize) -> std::ops::Range<usize> {
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
