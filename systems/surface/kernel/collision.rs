//! When moving points and edges come near triangles and edges.
//!
//! # Equation
//! Points move along `x_i + t u_i`, `0 <= t <= 1`. Wanted is a time up to which the distance of a point and a triangle, or of two
//! edges, stays at least `gap`.
//!
//! # Discretisation
//! Conservative advancement: between two convex sets at distance `d` lies a slab of width `d`, normal to the line between
//! their closest points. Along that normal every corner moves linearly, so the time at which the slab is down to `gap` is a least
//! quotient over pairs of corners; up to there nothing can touch. Go there, take the closest points anew, repeat.
//! The gap is the wanted one or half of the first distance, whichever is less: pairs that are near already may still part.
//! Pairs nearer than [`REST`] of the wanted gap may part or slide, but not approach: halving for ever would end in rounding.
//!
//! # Source
//! Li, Kaufman and Jiang 2021 (additive conservative advancement), with a longer step:
//! DEVIATION: they divide by a bound on the relative speed in any direction; the speed along the normal is never more, is
//! exact for motion along a plane, and lets parting pairs go at once. `a_step_is_never_shorter_than_by_the_speed_bound` shows it.
//!
//! # Limits
//! Distances are rounded: coordinates must resolve the gap. Answers are early, never late: by up to [`SLACK`] of the gap, or
//! more after [`ROUNDS`] steps of a spinning motion.

use glam::DVec3;

use crate::kernel::closest::{point_triangle, segment_segment};

/// Part of the gap within which the gap counts as reached; dimensionless.
pub const SLACK: f64 = 0.1;
/// Advances before the time reached is the answer.
pub const ROUNDS: usize = 64;
/// Part of the wanted gap below which a pair may not approach further; dimensionless.
pub const REST: f64 = 1e-3;
/// Part of the distance that a resting pair may lose: enough to tell parting from approaching.
const GIVE: f64 = 1e-4;

/// Time at which the point `x[0]` comes near the triangle `x[1..4]`; `None` if it does not within the unit of time.
///
/// `x`: places, metres; `shift`: motion of each in the unit of time, metres; `gap`: wanted least distance, metres.
#[must_use]
pub fn point_triangle_impact(x: [DVec3; 4], shift: [DVec3; 4], gap: f64) -> Option<f64> {
    impact::<1>(x, shift, gap, |[p, a, b, c]| point_triangle(p, [a, b, c]).offset)
}

/// Time at which the edge `x[0..2]` comes near the edge `x[2..4]`; `None` if it does not within the unit of time.
///
/// Units as in [`point_triangle_impact`].
#[must_use]
pub fn edge_edge_impact(x: [DVec3; 4], shift: [DVec3; 4], gap: f64) -> Option<f64> {
    impact::<2>(x, shift, gap, |[a, b, c, d]| segment_segment([a, b], [c, d]).offset)
}

/// Impact of the hull of the first `SPLIT` points and that of the others; `offset` leads from the second to the first.
fn impact<const SPLIT: usize>(
    x: [DVec3; 4],
    shift: [DVec3; 4],
    wanted: f64,
    offset: impl Fn([DVec3; 4]) -> DVec3,
) -> Option<f64> {
    // Relative to one of them: common motion and distance from the origin cost no digits.
    let (x, shift) = (x.map(|y| y - x[0]), shift.map(|u| u - shift[0]));
    if stays_clear::<SPLIT>(&x, &shift, wanted) || shift == [DVec3::ZERO; 4] {
        return None;
    }
    let mut normal = offset(x);
    let first = normal.length();
    if !(first > 0.0) {
        return Some(0.0);
    }
    let gap = if first > REST * wanted { wanted.min(0.5 * first) } else { first * (1.0 - GIVE) };
    let near = gap + SLACK * gap.min(first - gap);
    let (mut time, mut distance) = (0.0, first);
    for _ in 0..ROUNDS {
        let places: [DVec3; 4] = std::array::from_fn(|i| x[i] + shift[i] * time);
        let step = time_to_gap::<SPLIT>(&places, &shift, normal / distance, gap);
        time += step;
        if time >= 1.0 {
            return None;
        }
        if step == 0.0 {
            break;
        }
        normal = offset(std::array::from_fn(|i| x[i] + shift[i] * time));
        distance = normal.length();
        if !(distance > near) {
            return Some(time);
        }
    }
    Some(time)
}

/// Whether a slab normal to the line of centres, wider than the gap, parts them first and last, and so at every time between.
fn stays_clear<const SPLIT: usize>(x: &[DVec3; 4], shift: &[DVec3; 4], gap: f64) -> bool {
    let centre = |part: &[DVec3]| part.iter().sum::<DVec3>() / part.len() as f64;
    let normal = centre(&x[..SPLIT]) - centre(&x[SPLIT..]);
    let (from, by) = (x.map(|y| y.dot(normal)), shift.map(|u| u.dot(normal)));
    let width = |t: f64| {
        let along = |i: usize| from[i] + by[i] * t;
        let least = (0..SPLIT).map(along).fold(f64::INFINITY, f64::min);
        least - (SPLIT..4).map(along).fold(f64::NEG_INFINITY, f64::max)
    };
    let least = width(0.0).min(width(1.0));
    least > 0.0 && least * least > gap * gap * normal.length_squared()
}

/// Time until the slab normal to the unit vector `normal` is down to `gap`; 0 where rounding leaves no slab.
fn time_to_gap<const SPLIT: usize>(x: &[DVec3; 4], shift: &[DVec3; 4], normal: DVec3, gap: f64) -> f64 {
    let (from, by) = (x.map(|y| y.dot(normal)), shift.map(|u| u.dot(normal)));
    let mut time = f64::INFINITY;
    for i in 0..SPLIT {
        for j in SPLIT..4 {
            let (width, closing) = (from[i] - from[j], by[j] - by[i]);
            if !(width > 0.0) {
                return 0.0;
            }
            if closing > 0.0 {
                time = time.min(((width - gap) / closing).max(0.0));
            }
        }
    }
    time
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const GAP: f64 = 1e-3;

    type Impact = fn([DVec3; 4], [DVec3; 4], f64) -> Option<f64>;

    fn distance(is_edges: bool, [a, b, c, d]: [DVec3; 4]) -> f64 {
        if is_edges {
            segment_segment([a, b], [c, d]).distance_squared.sqrt()
        } else {
            point_triangle(a, [b, c, d]).distance_squared.sqrt()
        }
    }

    fn impact_of(is_edges: bool) -> Impact {
        if is_edges { edge_edge_impact } else { point_triangle_impact }
    }

    fn place(x: [DVec3; 4], u: [DVec3; 4], t: f64) -> [DVec3; 4] {
        std::array::from_fn(|i| x[i] + u[i] * t)
    }

    fn point() -> impl Strategy<Value = DVec3> {
        let coordinate = prop_oneof![(-2i32..3).prop_map(|v| 0.5 * f64::from(v)), -1.0..1.0f64];
        [coordinate.clone(), coordinate.clone(), coordinate].prop_map(DVec3::from_array)
    }

    fn points() -> impl Strategy<Value = [DVec3; 4]> {
        prop::array::uniform4(point())
    }

    /// Least distance over dense samples up to `until`.
    fn sampled(is_edges: bool, x: [DVec3; 4], u: [DVec3; 4], until: f64) -> f64 {
        let distances = (0..=400).map(|k| distance(is_edges, place(x, u, until * f64::from(k) / 400.0)));
        distances.fold(f64::INFINITY, f64::min)
    }

    /// Times at which the four points are coplanar, by bisection between samples.
    fn coplanar_times(x: [DVec3; 4], u: [DVec3; 4]) -> Vec<f64> {
        let volume = |t: f64| {
            let [a, b, c, d] = place(x, u, t);
            (b - a).cross(c - a).dot(d - a)
        };
        let mut times = Vec::new();
        for k in 0..500 {
            let (mut low, mut high) = (f64::from(k) / 500.0, f64::from(k + 1) / 500.0);
            if volume(low) * volume(high) > 0.0 {
                continue;
            }
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if volume(low) * volume(middle) <= 0.0 { high = middle } else { low = middle }
            }
            times.push(low);
        }
        times
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1500))]

        #[test]
        fn up_to_the_impact_the_gap_is_kept(is_edges: bool, x in points(), u in points(), k in prop_oneof![Just(1e-6), Just(1.0), Just(1e6)]) {
            let (x, u) = (x.map(|y| y * k), u.map(|y| y * k));
            let time = impact_of(is_edges)(x, u, GAP * k);
            let first = distance(is_edges, x);
            let gap = if first > REST * GAP * k { (GAP * k).min(0.5 * first) } else { first * (1.0 - 2.0 * GIVE) };
            prop_assert!(sampled(is_edges, x, u, time.unwrap_or(1.0)) >= gap - 1e-12 * k);
        }

        #[test]
        fn no_root_of_the_coplanarity_cubic_with_contact_comes_before_the_impact(is_edges: bool, x in points(), u in points()) {
            let time = impact_of(is_edges)(x, u, GAP);
            if let Some(contact) = coplanar_times(x, u).into_iter().find(|t| distance(is_edges, place(x, u, *t)) < 1e-9) {
                prop_assert!(time.is_some_and(|time| time <= contact + 1e-12));
            }
        }

        #[test]
        fn impacts_are_near_contacts_where_edges_do_not_spin_by(is_edges: bool, x in points(), u in points()) {
            let u = u.map(|u| u * 0.25);
            if let Some(time) = impact_of(is_edges)(x, u, GAP) {
                prop_assert!(distance(is_edges, place(x, u, time)) <= 10.0 * GAP);
            }
        }

        #[test]
        fn the_answer_does_not_depend_on_order(x in points(), u in points()) {
            let agree = |first: Option<f64>, second: Option<f64>| match (first, second) {
                // Early by the slack, in ways that depend on rounding.
                (Some(s), Some(t)) => (s - t).abs() < 1e-6 || {
                    let d = |t: f64| distance(true, place(x, u, t)).min(distance(false, place(x, u, t)));
                    d(s) <= 1.2 * GAP && d(t) <= 1.2 * GAP
                },
                (None, None) => true,
                (Some(t), None) | (None, Some(t)) => t > 0.9,
            };
            let swap = |[a, b, c, d]: [DVec3; 4]| [c, d, a, b];
            let turn = |[a, b, c, d]: [DVec3; 4]| [a, c, d, b];
            let flip = |[a, b, c, d]: [DVec3; 4]| [b, a, c, d];
            prop_assume!(distance(true, x) > 0.01 && distance(false, x) > 0.01);
            prop_assert!(agree(edge_edge_impact(x, u, GAP), edge_edge_impact(swap(x), swap(u), GAP)));
            prop_assert!(agree(edge_edge_impact(x, u, GAP), edge_edge_impact(flip(x), flip(u), GAP)));
            prop_assert!(agree(point_triangle_impact(x, u, GAP), point_triangle_impact(turn(x), turn(u), GAP)));
        }

        #[test]
        fn a_step_is_never_shorter_than_by_the_speed_bound(x in points(), u in points()) {
            let d = distance(false, x);
            prop_assume!(d > 2.0 * GAP);
            let speed = u.iter().flat_map(|v| u.map(|w| v.distance(w))).fold(0.0, f64::max);
            let normal = point_triangle(x[0], [x[1], x[2], x[3]]).offset / d;
            prop_assert!(time_to_gap::<1>(&x, &u, normal, GAP) >= (d - GAP) / speed - 1e-9);
        }

        #[test]
        fn common_motion_is_no_motion(is_edges: bool, x in points(), u in point()) {
            prop_assert_eq!(impact_of(is_edges)(x, [u; 4], GAP), None);
        }
    }

    const BELOW: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    fn falling(from: f64, to: f64) -> Option<f64> {
        let [a, b, c] = BELOW;
        let shift = [DVec3::Z * (to - from), DVec3::ZERO, DVec3::ZERO, DVec3::ZERO];
        point_triangle_impact([DVec3::new(0.2, 0.2, from), a, b, c], shift, GAP)
    }

    #[test]
    fn a_falling_point_stops_at_the_gap() {
        let time = falling(1.0, -1.0).unwrap();
        assert!((time - 0.5 * (1.0 - GAP)).abs() < 1e-12);
        assert_eq!(falling(1.0, 2.0 * GAP), None);
    }

    #[test]
    fn grazing_at_the_last_moment_is_seen_and_missing_is_not() {
        assert!(falling(1.0, 0.0).is_some_and(|t| t <= 1.0 - GAP));
        assert!(falling(1.0, 0.5 * GAP).is_some());
        assert_eq!(falling(1.0, 1.0001 * GAP), None);
    }

    #[test]
    fn what_touches_at_first_hits_at_once() {
        assert_eq!(falling(0.0, -1.0), Some(0.0));
        assert_eq!(falling(0.0, 0.0), None);
        let crossed = [-DVec3::X, DVec3::X, -DVec3::Y, DVec3::Y];
        assert_eq!(edge_edge_impact(crossed, [DVec3::Z, DVec3::Z, DVec3::ZERO, DVec3::ZERO], GAP), Some(0.0));
    }

    #[test]
    fn near_pairs_may_part_and_slide_but_not_close_in() {
        for from in [1e-2 * GAP, 1e-4 * GAP, 1e-8 * GAP] {
            assert_eq!(falling(from, 1.0), None);
            let time = falling(from, -1.0).unwrap();
            assert!(from - time * (1.0 + from) >= 0.49 * from);
        }
        for from in [1e-2 * GAP, 1e-4 * GAP] {
            let [a, b, c] = BELOW;
            let slide = [DVec3::new(0.3, -0.1, 0.0), DVec3::ZERO, DVec3::ZERO, DVec3::ZERO];
            assert_eq!(point_triangle_impact([DVec3::new(0.2, 0.2, from), a, b, c], slide, GAP), None);
        }
    }

    #[test]
    fn coplanar_motion_hits_the_rim() {
        let [a, b, c] = BELOW;
        let still = DVec3::ZERO;
        let time =
            point_triangle_impact([DVec3::new(-1.0, 0.3, 0.0), a, b, c], [DVec3::X * 2.0, still, still, still], GAP);
        assert!((time.unwrap() - 0.5 * (1.0 - GAP)).abs() < 1e-9);
    }

    #[test]
    fn parallel_edges_hit_and_collinear_edges_hit() {
        let still = DVec3::ZERO;
        let parallel = [DVec3::ZERO, DVec3::X, DVec3::new(0.5, 1.0, 0.0), DVec3::new(1.5, 1.0, 0.0)];
        let fall = [still, still, -2.0 * DVec3::Y, -2.0 * DVec3::Y];
        assert!((edge_edge_impact(parallel, fall, GAP).unwrap() - 0.5 * (1.0 - GAP)).abs() < 1e-9);
        let collinear = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0, DVec3::X * 3.0];
        let push = [still, still, -2.0 * DVec3::X, -2.0 * DVec3::X];
        assert!((edge_edge_impact(collinear, push, GAP).unwrap() - 0.5 * (1.0 - GAP)).abs() < 1e-9);
    }
}
