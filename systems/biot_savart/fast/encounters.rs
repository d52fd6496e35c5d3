//! Who acts on whom, and how: a walk over two trees at once that finds every pair of points exactly once, either in two cells far
//! enough apart for their expansions or in two leaves.
//!
//! Two cells are far when the sum of their radii is less than the opening angle times the distance of their centres
//! (Dehnen 2002, §2.2). The test does not tell target from source, so what is approximated stays symmetric.

use super::tree::{Cell, Tree};

/// For every target, its sources in a fixed order.
#[derive(Debug, Default)]
pub(super) struct SourceLists {
    starts: Vec<u32>,
    sources: Vec<u32>,
}

impl SourceLists {
    /// Sorts pairs of (target, source) by target; the order of a target's sources is kept.
    pub(super) fn new(targets: usize, pairs: &[(u32, u32)]) -> Self {
        let mut starts = vec![0; targets + 1];
        for (target, _) in pairs {
            starts[*target as usize + 1] += 1;
        }
        for i in 0..targets {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut sources = vec![0; pairs.len()];
        for (target, source) in pairs {
            let at = &mut next[*target as usize];
            sources[*at as usize] = *source;
            *at += 1;
        }
        Self { starts, sources }
    }

    /// Sources of a target.
    pub(super) fn of(&self, target: usize) -> &[u32] {
        &self.sources[self.starts[target] as usize..self.starts[target + 1] as usize]
    }
}

/// Pairs of (target, source).
#[derive(Debug, Default)]
pub(super) struct Encounters {
    /// Cells that are far apart.
    pub(super) far: Vec<(u32, u32)>,
    /// Leaves that are not.
    pub(super) near: Vec<(u32, u32)>,
}

impl Encounters {
    /// Within one tree. Each far pair stands in both directions; each near pair once, lower leaf first, and no leaf meets itself.
    pub(super) fn within(tree: &Tree, opening: f64) -> Self {
        let mut walk = Walk { targets: tree, sources: tree, opening, found: Self::default() };
        if !tree.cells.is_empty() {
            walk.meet_self(0);
        }
        let Self { mut far, near } = walk.found;
        let back: Vec<_> = far.iter().map(|(a, b)| (*b, *a)).collect();
        far.extend(back);
        Self { far, near }
    }

    /// From the cells of one tree to those of another.
    pub(super) fn between(targets: &Tree, sources: &Tree, opening: f64) -> Self {
        let mut walk = Walk { targets, sources, opening, found: Self::default() };
        if !targets.cells.is_empty() && !sources.cells.is_empty() {
            walk.meet(0, 0);
        }
        walk.found
    }
}

struct Walk<'a> {
    targets: &'a Tree,
    sources: &'a Tree,
    opening: f64,
    found: Encounters,
}

impl Walk<'_> {
    fn meet_self(&mut self, cell: usize) {
        if self.targets.cells[cell].leaf().is_none() {
            let [left, right] = self.targets.children(cell);
            self.meet_self(left);
            self.meet(left, right);
            self.meet_self(right);
        }
    }

    fn meet(&mut self, target: usize, source: usize) {
        let (a, b) = (&self.targets.cells[target], &self.sources.cells[source]);
        if are_far(a, b, self.opening) {
            return self.found.far.push((target as u32, source as u32));
        }
        match (a.leaf(), b.leaf()) {
            (Some(a), Some(b)) => self.found.near.push((a as u32, b as u32)),
            (None, Some(_)) => self.open_target(target, source),
            (Some(_), None) => self.open_source(target, source),
            (None, None) if a.radius >= b.radius => self.open_target(target, source),
            (None, None) => self.open_source(target, source),
        }
    }

    fn open_target(&mut self, target: usize, source: usize) {
        for child in self.targets.children(target) {
            self.meet(child, source);
        }
    }

    fn open_source(&mut self, target: usize, source: usize) {
        for child in self.sources.children(source) {
            self.meet(target, child);
        }
    }
}

fn are_far(a: &Cell, b: &Cell, opening: f64) -> bool {
    (a.radius + b.radius).powi(2) < opening * opening * a.centre.distance_squared(b.centre)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use proptest::prelude::*;

    /// How often each pair of points is found, one way.
    fn counts(targets: &Tree, sources: &Tree, found: &Encounters) -> Vec<u32> {
        let mut counts = vec![0; targets.points.len() * sources.points.len()];
        let mut count = |a: Vec<usize>, b: &[usize]| {
            a.iter().for_each(|i| b.iter().for_each(|j| counts[i * sources.points.len() + j] += 1));
        };
        for (a, b) in &found.far {
            count(points_under(targets, *a as usize), &points_under(sources, *b as usize));
        }
        for (a, b) in &found.near {
            let b: Vec<usize> = sources.points_of(*b as usize).collect();
            count(targets.points_of(*a as usize).collect(), &b);
        }
        counts
    }

    fn points_under(tree: &Tree, cell: usize) -> Vec<usize> {
        match tree.cells[cell].leaf() {
            Some(leaf) => tree.points_of(leaf).collect(),
            None => tree.children(cell).into_iter().flat_map(|child| points_under(tree, child)).collect(),
        }
    }

    fn points() -> impl Strategy<Value = Vec<DVec3>> {
        prop::collection::vec(prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from), 1..400)
    }

    proptest! {
        #[test]
        fn every_pair_meets_once(points in points(), opening in 0.1..1.0f64) {
            let tree = Tree::new(points.into_iter());
            let found = Encounters::within(&tree, opening);
            let (n, counts) = (tree.points.len(), counts(&tree, &tree, &found));
            for i in 0..n {
                for j in 0..n {
                    // A leaf's own pairs are not listed, near ones are listed one way, far ones both ways.
                    let own = i / super::super::tree::LEAF == j / super::super::tree::LEAF;
                    let (there, back) = (counts[i * n + j], counts[j * n + i]);
                    prop_assert_eq!(there.max(back), u32::from(!own));
                }
            }
        }

        #[test]
        fn every_target_meets_every_source_once(targets in points(), sources in points(), opening in 0.1..1.0f64) {
            let (targets, sources) = (Tree::new(targets.into_iter()), Tree::new(sources.into_iter()));
            let found = Encounters::between(&targets, &sources, opening);
            prop_assert!(counts(&targets, &sources, &found).iter().all(|count| *count == 1));
        }
    }

    #[test]
    fn lists_keep_the_order_of_pairs() {
        let lists = SourceLists::new(3, &[(2, 5), (0, 1), (2, 4)]);
        assert_eq!((lists.of(0), lists.of(1), lists.of(2)), (&[1][..], &[][..], &[5, 4][..]));
    }
}
