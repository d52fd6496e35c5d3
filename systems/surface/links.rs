//! What hangs together: a union-find, and the clusters of vertices that nothing holds.
//!
//! The root of a class is its least member, whatever the order in which its members were joined: numbers of classes are the same
//! every time.
//! Source: Tarjan and van Leeuwen 1984 (path halving).

use smallvec::SmallVec;

/// Classes of things, counted from 0, that are joined one pair after another.
#[derive(Clone, Debug, Default)]
pub struct Links {
    /// Up to 64 things take no memory of their own.
    parent: SmallVec<[u32; 64]>,
}

impl Links {
    /// So many things, each alone.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect() }
    }

    /// The least member of a thing's class.
    pub fn root(&mut self, of: usize) -> usize {
        let parent = self.parent.as_mut_slice();
        let mut at = of;
        while parent[at] as usize != at {
            parent[at] = parent[parent[at] as usize];
            at = parent[at] as usize;
        }
        at
    }

    /// Joins the classes of two things.
    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b) as u32;
    }

    /// For each thing the number of its class, in order of first appearance; `None` where `counts` refuses the class by its root.
    pub fn numbered(&mut self, counts: impl Fn(usize) -> bool) -> impl Iterator<Item = Option<u32>> {
        let mut numbers: SmallVec<[Option<u32>; 64]> = SmallVec::from_elem(None, self.parent.len());
        let mut count = 0;
        (0..self.parent.len()).map(move |thing| {
            let root = self.root(thing);
            counts(root).then(|| {
                *numbers[root].get_or_insert_with(|| {
                    count += 1;
                    count - 1
                })
            })
        })
    }
}

/// Clusters of vertices that films join.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FilmClusters {
    /// Per vertex, its cluster; `None` where there is no film, or a cluster that is held.
    pub of_vertex: Vec<Option<u32>>,
    /// Clusters in all.
    pub count: usize,
}

/// The clusters of `vertices` vertices that films with these corners join, but for those of which a vertex is held.
#[must_use]
pub fn free_clusters(
    vertices: usize,
    films: impl Iterator<Item = [u32; 3]> + Clone,
    is_held: impl Fn(usize) -> bool,
) -> FilmClusters {
    let mut links = Links::new(vertices);
    for [a, b, c] in films.clone().map(|corners| corners.map(|v| v as usize)) {
        links.join(a, b);
        links.join(a, c);
    }
    let mut is_free = vec![false; vertices];
    films.for_each(|corners| is_free[links.root(corners[0] as usize)] = true);
    (0..vertices).filter(|v| is_held(*v)).for_each(|v| is_free[links.root(v)] = false);
    let of_vertex: Vec<Option<u32>> = links.numbered(|root| is_free[root]).collect();
    let count = of_vertex.iter().flatten().max().map_or(0, |last| *last as usize + 1);
    FilmClusters { of_vertex, count }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::{any, prop, proptest};

    use super::*;

    #[test]
    fn clusters_are_numbered_by_their_first_vertex_and_held_ones_are_not() {
        let films = [[7, 8, 9], [1, 2, 3], [2, 3, 4], [10, 11, 12]];
        let clusters = free_clusters(13, films.into_iter(), |v| v == 12 || v == 0);
        let expected = |v| match v {
            1..=4 => Some(0),
            7..=9 => Some(1),
            _ => None,
        };
        assert_eq!(clusters.of_vertex, (0..13).map(expected).collect::<Vec<_>>());
        assert_eq!(clusters.count, 2);
    }

    proptest! {
        #[test]
        fn roots_are_least_members_in_whatever_order_things_are_joined(
            pairs in prop::collection::vec((0usize..80, 0usize..80), 0..60),
            is_turned in any::<bool>(),
        ) {
            let mut links = Links::new(80);
            let turned: Vec<_> = if is_turned { pairs.iter().rev().collect() } else { pairs.iter().collect() };
            turned.into_iter().for_each(|(a, b)| links.join(*a, *b));
            // Least labels by sweeps until nothing changes.
            let mut least: Vec<usize> = (0..80).collect();
            for _ in 0..80 {
                for (a, b) in &pairs {
                    let low = least[*a].min(least[*b]);
                    (least[*a], least[*b]) = (low, low);
                }
            }
            assert_eq!((0..80).map(|thing| links.root(thing)).collect::<Vec<_>>(), least);
            let classes = links.numbered(|_| true).flatten().max();
            let roots = (0..80).filter(|thing| least[*thing] == *thing).count();
            assert_eq!(classes.map(|last| last as usize + 1), Some(roots));
        }
    }
}
