//! All-neighbours lists of a point set on a sphere: a k-d tree (kiddo) against cell lists.
//!
//! `cargo bench --bench neighbours`. Every method finds, for each point, all points within three spacings, and sums
//! their distances, on one thread. Times are the least of several calls and include building the structure.
#![allow(clippy::print_stdout, reason = "a benchmark prints its table")]

use std::hint::black_box;
use std::time::Instant;

use froth_components::motion::Position;
use froth_systems::neighbours::cells::CellList;
use froth_systems::rows::morton::morton_code;
use froth_systems::sampling::spread::sphere_cap;
use glam::DVec3;
use kiddo::{ImmutableKdTree, SquaredEuclidean};

/// Calls of which the fastest counts.
const CALLS: usize = 3;
/// Radius of a search, in spacings.
const REACH: f64 = 3.0;

fn main() {
    println!("{:>8} {:>10} {:>28} {:>10} {:>10}", "points", "order", "method", "ms", "ns/pair");
    for count in [1000, 16_000, 164_000] {
        let spiral: Vec<Position> = sphere_cap(count, -1.0).map(Position).collect();
        let spacing = (4.0 * std::f64::consts::PI / count as f64).sqrt();
        let mut sorted = spiral.clone();
        sorted.sort_by_key(|p| morton_code(p.0, DVec3::NEG_ONE, spacing));
        for (order, points) in [("spiral", &spiral), ("Morton", &sorted)] {
            let reach = REACH * spacing;
            report(count, order, "k-d tree", || by_tree(points, reach));
            report(count, order, "cells of the search's width", || by_cells(points, reach, REACH * spacing));
            report(count, order, "cells of two spacings", || by_cells(points, reach, 2.0 * spacing));
            report(count, order, "cells of one spacing", || by_cells(points, reach, spacing));
        }
    }
}

fn report(count: usize, order: &str, method: &str, mut call: impl FnMut() -> (usize, f64)) {
    let mut pairs = 0;
    let least = (0..CALLS).map(|_| {
        let began = Instant::now();
        pairs = black_box(call()).0;
        began.elapsed()
    });
    let seconds = least.min().expect("several calls").as_secs_f64();
    println!("{count:>8} {order:>10} {method:>28} {:>10.2} {:>10.1}", 1e3 * seconds, 1e9 * seconds / pairs as f64);
}

/// Number of pairs, and the sum of their squared distances.
fn by_tree(points: &[Position], reach: f64) -> (usize, f64) {
    let raw: Vec<[f64; 3]> = points.iter().map(|p| p.0.to_array()).collect();
    let tree = ImmutableKdTree::<f64, 3>::new_from_slice(&raw).expect("a tree of finite points");
    let near = |p: &[f64; 3]| tree.query(p).within::<SquaredEuclidean<f64>>(reach * reach).unsorted().execute();
    raw.iter().flat_map(near).fold((0, 0.0), |(pairs, sum), found| (pairs + 1, sum + found.distance))
}

fn by_cells(points: &[Position], reach: f64, width: f64) -> (usize, f64) {
    let cells = CellList::build(points, width);
    let (mut pairs, mut sum) = (0, 0.0);
    for point in points {
        cells.for_each_near(point.0, reach, |row| {
            let distance = point.0.distance_squared(points[row].0);
            if distance < reach * reach {
                pairs += 1;
                sum += distance;
            }
        });
    }
    (pairs, sum)
}
