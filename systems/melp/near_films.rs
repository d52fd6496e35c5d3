//! Which films are near each other: found by the boxes around them, never by all pairs.

use froth_components::lamella::Lamellae;
use froth_components::motion::Position;
use froth_surface::links::Links;
use glam::DVec3;
use rayon::prelude::*;

/// Boxes around the films that can touch, with a margin; empty ones around all others.
pub(super) struct Boxes {
    low: Vec<DVec3>,
    high: Vec<DVec3>,
    margin: f64,
}

impl Boxes {
    pub(super) fn around(positions: &[Position], lamellae: &Lamellae, margin: f64) -> Self {
        let bounds: Vec<(DVec3, DVec3)> = lamellae
            .films
            .par_iter()
            .map(|film| {
                let rows = if film.encloses_gas() { film.carriers.clone() } else { 0..0 };
                let places = positions[rows].iter().map(|x| x.0);
                let (low, high) = places.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
                (low - margin, high + margin)
            })
            .collect();
        let (low, high) = bounds.into_iter().unzip();
        Self { low, high, margin }
    }

    /// For each film the others whose boxes meet its own, ascending. Sweeps along x: never all pairs.
    pub(super) fn near(&self) -> Vec<Vec<u32>> {
        let mut order: Vec<usize> = (0..self.low.len()).filter(|&k| self.low[k].x.is_finite()).collect();
        order.sort_by(|&a, &b| self.low[a].x.total_cmp(&self.low[b].x).then(a.cmp(&b)));
        let mut near = vec![Vec::new(); self.low.len()];
        for (at, &a) in order.iter().enumerate() {
            for &b in order[at + 1..].iter().take_while(|&&b| self.low[b].x <= self.high[a].x) {
                if self.low[b].cmple(self.high[a]).all() && self.low[a].cmple(self.high[b]).all() {
                    near[a].push(b as u32);
                    near[b].push(a as u32);
                }
            }
        }
        near.iter_mut().for_each(|others| others.sort_unstable());
        near
    }

    /// Whether a place is in a film's box with twice the margin: within reach of its carriers.
    pub(super) fn holds(&self, film: usize, place: DVec3) -> bool {
        place.cmpge(self.low[film] - self.margin).all() && place.cmple(self.high[film] + self.margin).all()
    }
}

/// Films joined by nearness, least member first.
pub(super) fn clusters(near: &[Vec<u32>]) -> Vec<Vec<usize>> {
    let mut links = Links::new(near.len());
    for (film, others) in near.iter().enumerate() {
        others.iter().for_each(|&other| links.join(film, other as usize));
    }
    let mut clusters: Vec<Vec<usize>> = Vec::new();
    for (film, cluster) in links.numbered(|_| true).flatten().enumerate() {
        let cluster = cluster as usize;
        clusters.resize(clusters.len().max(cluster + 1), Vec::new());
        clusters[cluster].push(film);
    }
    clusters
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn films_joined_through_others_are_one_cluster() {
        let near = [vec![2], vec![], vec![0, 4], vec![], vec![2]];
        assert_eq!(clusters(&near), [vec![0, 2, 4], vec![1], vec![3]]);
    }
}
