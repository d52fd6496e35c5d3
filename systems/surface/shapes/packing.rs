//! A random foam: spheres packed into a cluster, and what each of them owns of space.
//!
//! Power distance of a point to sphere `i`: `|x - c_i|^2 - r_i^2`. A point belongs to the sphere with the smallest, and to the
//! outside where none is negative; walls between bubbles are flat then, and angles are near those of a foam at rest. Pockets
//! of the outside between bubbles go to the nearest bubble.

use glam::DVec3;

use super::fairing::{fair, freely};
use super::flips::turn_edges;
use super::label_interface::LabelGrid;
use super::random::Random;
use crate::surface::LabelledTriangles;

/// Distance of neighbours, in sums of radii.
const REACH: f64 = 0.86;
/// How much larger than packed the spheres are that share space.
const INFLATION: f64 = 1.08;
/// Rounds of packing, and how much of its distance to the middle a sphere loses in each.
const ROUNDS: usize = 400;
const PULL: f64 = 0.01;
/// Average edge of the films, in cells of the lattice.
const EDGE: f64 = 0.405;

/// A sphere of a packing.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ball {
    centre: DVec3,
    radius: f64,
}

/// A foam of `count` bubbles about `centre`, the same for the same seed; lengths in metres.
///
/// Radii of the packed spheres are even between `(1 - polydispersity)` and `(1 + polydispersity)` of `radius`, dimensionless
/// and below 0.6. Edges are a quarter of the smallest radius at most, so that no bubble is lost between lattice points.
#[must_use]
pub fn packing(
    centre: DVec3,
    count: usize,
    radius: f64,
    polydispersity: f64,
    seed: u64,
    edge: f64,
) -> LabelledTriangles {
    let spread = polydispersity.clamp(0.0, 0.6);
    let mut set = raw(count, spread, seed, edge / radius);
    for _ in 0..3 {
        // In this order: an edge is turned only where its films are even.
        fair(&mut set, 2, freely);
        turn_edges(&mut set);
    }
    set.positions.iter_mut().for_each(|x| *x = centre + radius * *x);
    set
}

/// The foam as the lattice gives it; `edge` in units of the radius.
fn raw(count: usize, spread: f64, seed: u64, edge: f64) -> LabelledTriangles {
    // In units of the radius about the origin: the same foam at every scale and place.
    let balls = packed(count, spread, &mut Random::new(seed));
    let reach = balls.iter().map(|ball| ball.centre.abs().max_element() + ball.radius).fold(0.0, f64::max);
    let cell = edge.min(0.25 * (1.0 - spread)) / EDGE;
    let cells = (2.0 * reach / cell).ceil() as usize + 5;
    let corner = DVec3::splat(-0.5 * cell * cells as f64);
    let mut grid = LabelGrid::sample(|x| owner(&balls, x, 0.0), corner, [cells; 3], cell);
    grid.fill_pockets(|x| owner(&balls, x, f64::INFINITY));
    let power = |x: DVec3, label: u32| label.checked_sub(1).map_or(0.0, |k| power_distance(&balls[k as usize], x));
    grid.interface(|x, own, other| power(x, other) - power(x, own))
}

/// Label of the ball that owns a point; 0 where no power distance is below `limit`.
fn owner(balls: &[Ball], x: DVec3, limit: f64) -> u32 {
    let mut best = (limit, 0);
    for (ball, label) in balls.iter().zip(1..) {
        let distance = power_distance(ball, x);
        if distance < best.0 {
            best = (distance, label);
        }
    }
    best.1
}

fn power_distance(ball: &Ball, x: DVec3) -> f64 {
    x.distance_squared(ball.centre) - ball.radius * ball.radius
}

/// Balls of average radius 1 that overlap a little, about the origin.
fn packed(count: usize, spread: f64, random: &mut Random) -> Vec<Ball> {
    let room = 1.2 * (count as f64).cbrt();
    let mut balls: Vec<Ball> = (0..count)
        .map(|_| {
            let radius = spread.mul_add(random.next_signed(), 1.0);
            Ball { centre: room * point_in_ball(random), radius }
        })
        .collect();
    for round in 0..ROUNDS {
        // The last rounds push only, so that no two balls overlap more than they should.
        let pull = if round < ROUNDS * 3 / 4 { PULL } else { 0.0 };
        balls.iter_mut().for_each(|ball| ball.centre *= 1.0 - pull);
        push_apart(&mut balls);
    }
    let middle = balls.iter().map(|ball| ball.centre).sum::<DVec3>() / count.max(1) as f64;
    for ball in &mut balls {
        ball.centre -= middle;
        ball.radius *= INFLATION;
    }
    balls
}

fn point_in_ball(random: &mut Random) -> DVec3 {
    loop {
        let x = DVec3::new(random.next_signed(), random.next_signed(), random.next_signed());
        if x.length_squared() <= 1.0 {
            return x;
        }
    }
}

/// Moves every pair that is too near apart, each by half of what is missing.
fn push_apart(balls: &mut [Ball]) {
    for i in 0..balls.len() {
        for j in i + 1..balls.len() {
            let wanted = REACH * (balls[i].radius + balls[j].radius);
            let way = balls[j].centre - balls[i].centre;
            let distance = way.length();
            if distance < wanted {
                let push = 0.5 * (wanted - distance) * way.normalize_or(DVec3::X);
                balls[i].centre -= push;
                balls[j].centre += push;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::measure::{checked, crossings, edge_lengths, smallest_angle};

    #[test]
    fn every_seed_gives_a_foam_of_all_its_bubbles() {
        for seed in 0..6 {
            let set = packing(DVec3::new(1.0, 2.0, 3.0), 12, 0.5, 0.3, seed, 0.1);
            let surface = checked(&set);
            assert_eq!(surface.volumes().len(), 13);
            assert!(smallest_angle(&set) > 10.0, "{}", smallest_angle(&set));
            let ball = 4.0 * std::f64::consts::PI / 3.0 * 0.125;
            assert!(
                surface.volumes()[1..].iter().all(|v| (0.15..2.5).contains(&(v / ball))),
                "{:?}",
                surface.volumes()
            );
        }
    }

    #[test]
    fn films_of_a_packing_do_not_cross() {
        for (seed, spread) in [(7, 0.0), (8, 0.5), (6, 0.0)] {
            let set = packing(DVec3::ZERO, 5, 1.0, spread, seed, 0.25);
            assert_eq!(crossings(&set), 0);
        }
    }

    #[test]
    fn edges_are_about_as_long_as_asked() {
        let mean = edge_lengths(&packing(DVec3::ZERO, 5, 1.0, 0.2, 1, 0.1))[1];
        assert!((mean / 0.1 - 1.0).abs() < 0.15, "{mean}");
    }

    #[test]
    fn a_packing_is_the_same_at_every_scale() {
        let small = packing(DVec3::ZERO, 5, 2f64.powi(-20), 0.2, 3, 2f64.powi(-22));
        let large = packing(DVec3::ZERO, 5, 2f64.powi(20), 0.2, 3, 2f64.powi(18));
        assert_eq!(small.triangles, large.triangles);
        assert!(small.positions.iter().zip(&large.positions).all(|(x, y)| *x * 2f64.powi(40) == *y));
    }
}
