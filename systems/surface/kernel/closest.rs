//! Closest points of points, segments and triangles.
//!
//! A squared distance to a convex set of parameters is a convex quadratic: its least value is inside, where the gradient
//! vanishes, or on the border, which is the same problem one dimension lower. Every function here looks inside first and
//! then at the border; where the inside is ill-conditioned (slivers, nearly parallel segments) it looks at both.
//! Input of length or area zero is no special case.

use glam::DVec3;

/// Relative determinant below which the inside of a triangle or of a pair of segments is not trusted alone.
const SLIVER: f64 = 1e-8;

/// The point of a segment closest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointSegment {
    /// Place on the segment: 0 at its first end, 1 at its second; dimensionless.
    pub parameter: f64,
    /// From the point of the segment to the point, metres.
    pub offset: DVec3,
    /// Squared distance, m^2.
    pub distance_squared: f64,
}

/// The point of a triangle closest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointTriangle {
    /// Weights of the corners: not negative, sum 1; dimensionless.
    pub barycentric: [f64; 3],
    /// From the point of the triangle to the point, metres.
    pub offset: DVec3,
    /// Squared distance, m^2.
    pub distance_squared: f64,
}

/// The closest points of two segments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentSegment {
    /// Place on the first segment, 0 to 1; dimensionless.
    pub s: f64,
    /// Place on the second segment, 0 to 1; dimensionless.
    pub t: f64,
    /// From the point of the second segment to the point of the first, metres.
    pub offset: DVec3,
    /// Squared distance, m^2.
    pub distance_squared: f64,
}

impl PointTriangle {
    fn new(barycentric: [f64; 3], [a, b, c]: [DVec3; 3]) -> Self {
        let offset = -(a * barycentric[0] + b * barycentric[1] + c * barycentric[2]);
        Self { barycentric, offset, distance_squared: offset.length_squared() }
    }
}

/// The point of the segment `a b` closest to `p`.
#[must_use]
pub fn point_segment(p: DVec3, a: DVec3, b: DVec3) -> PointSegment {
    let along = b - a;
    let length_squared = along.length_squared();
    let parameter = if length_squared > 0.0 { ((p - a).dot(along) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    // From the nearer end, so that the far end of a long segment costs no digits.
    let offset = if parameter <= 0.5 { p - a - along * parameter } else { p - b + along * (1.0 - parameter) };
    PointSegment { parameter, offset, distance_squared: offset.length_squared() }
}

/// The point of the triangle `a b c` closest to `p`.
#[must_use]
pub fn point_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> PointTriangle {
    let corners = [a - p, b - p, c - p];
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let square = normal.length_squared();
    let weights = [
        normal.dot(corners[1].cross(corners[2])),
        normal.dot(corners[2].cross(corners[0])),
        normal.dot(corners[0].cross(corners[1])),
    ];
    if !(square > 0.0) || weights.iter().any(|w| *w < 0.0) {
        return nearest_side(corners);
    }
    let sum = weights[0] + weights[1] + weights[2];
    let barycentric = weights.map(|w| w / sum);
    if square > SLIVER * ab.length_squared() * ac.length_squared() {
        // Along the normal: a difference of near places would have lost its direction.
        let offset = normal * (-normal.dot(corners[0]) / square);
        return PointTriangle { barycentric, offset, distance_squared: offset.length_squared() };
    }
    let inside = PointTriangle::new(barycentric, corners);
    let side = nearest_side(corners);
    // Written so that an overflow inside loses.
    if inside.distance_squared < side.distance_squared { inside } else { side }
}

/// The point of the sides of a triangle closest to the origin.
fn nearest_side(corners: [DVec3; 3]) -> PointTriangle {
    let side = |i: usize| {
        let j = (i + 1) % 3;
        let found = point_segment(DVec3::ZERO, corners[i], corners[j]);
        let mut barycentric = [0.0; 3];
        barycentric[i] = 1.0 - found.parameter;
        barycentric[j] = found.parameter;
        PointTriangle { barycentric, offset: found.offset, distance_squared: found.distance_squared }
    };
    let nearer = |x: PointTriangle, y: PointTriangle| if y.distance_squared < x.distance_squared { y } else { x };
    nearer(nearer(side(0), side(1)), side(2))
}

/// The closest points of the segments `a b` and `c d`; some pair of them where they are parallel.
#[must_use]
pub fn segment_segment([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> SegmentSegment {
    let (u, v, w) = (b - a, d - c, a - c);
    let (uu, uv, vv) = (u.length_squared(), u.dot(v), v.length_squared());
    let (uw, vw) = (u.dot(w), v.dot(w));
    let determinant = uu * vv - uv * uv;
    let (s, t) = (uv * vw - vv * uw, uu * vw - uv * uw);
    let is_inside = determinant > 0.0 && s > 0.0 && s < determinant && t > 0.0 && t < determinant;
    if !is_inside {
        return nearest_end([a, b], [c, d]);
    }
    let (s, t) = (s / determinant, t / determinant);
    let inside = |offset: DVec3| SegmentSegment { s, t, offset, distance_squared: offset.length_squared() };
    if determinant > SLIVER * uu * vv {
        // Along the common normal: a difference of near places would have lost its direction.
        let normal = u.cross(v);
        return inside(normal * (normal.dot(w) / normal.length_squared()));
    }
    let inside = inside(w + u * s - v * t);
    let end = nearest_end([a, b], [c, d]);
    if inside.distance_squared < end.distance_squared { inside } else { end }
}

/// The closest points of two segments of which one at least is an end.
fn nearest_end([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> SegmentSegment {
    let on_first = |t: f64, found: PointSegment| SegmentSegment {
        s: found.parameter,
        t,
        offset: -found.offset,
        distance_squared: found.distance_squared,
    };
    let on_second = |s: f64, found: PointSegment| SegmentSegment {
        s,
        t: found.parameter,
        offset: found.offset,
        distance_squared: found.distance_squared,
    };
    let ends = [
        on_second(0.0, point_segment(a, c, d)),
        on_second(1.0, point_segment(b, c, d)),
        on_first(0.0, point_segment(c, a, b)),
        on_first(1.0, point_segment(d, a, b)),
    ];
    let nearer = |x: SegmentSegment, y: SegmentSegment| if y.distance_squared < x.distance_squared { y } else { x };
    nearer(nearer(ends[0], ends[1]), nearer(ends[2], ends[3]))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn point() -> impl Strategy<Value = DVec3> {
        // Few values, so that degenerate, parallel and touching input is common.
        let coordinate = prop_oneof![(-2i32..3).prop_map(f64::from), -2.0..2.0f64];
        [coordinate.clone(), coordinate.clone(), coordinate].prop_map(DVec3::from_array)
    }

    fn scale() -> impl Strategy<Value = f64> {
        prop_oneof![Just(1e-6), Just(1.0), Just(1e6)]
    }

    proptest! {
        #[test]
        fn no_point_of_a_grid_on_the_triangle_is_nearer(p in point(), t in [point(), point(), point()], scale in scale()) {
            let (p, [a, b, c]) = (p * scale, t.map(|x| x * scale));
            let found = point_triangle(p, [a, b, c]);
            let [i, j, k] = found.barycentric;
            prop_assert!(i >= 0.0 && j >= 0.0 && k >= 0.0 && (i + j + k - 1.0).abs() < 1e-12);
            let place = a * i + b * j + c * k;
            prop_assert!((p - place - found.offset).length() < 1e-12 * scale);
            for m in 0..=20 {
                for n in 0..=20 - m {
                    let x = (a * f64::from(m) + b * f64::from(n) + c * f64::from(20 - m - n)) / 20.0;
                    prop_assert!(found.distance_squared.sqrt() <= x.distance(p) + 1e-12 * scale);
                }
            }
        }

        #[test]
        fn no_pair_of_points_of_two_segments_is_nearer(e in [point(), point()], f in [point(), point()], scale in scale()) {
            let ([a, b], [c, d]) = (e.map(|x| x * scale), f.map(|x| x * scale));
            let found = segment_segment([a, b], [c, d]);
            prop_assert!((0.0..=1.0).contains(&found.s) && (0.0..=1.0).contains(&found.t));
            prop_assert!((a.lerp(b, found.s) - c.lerp(d, found.t) - found.offset).length() < 1e-12 * scale);
            for m in 0..=20 {
                let nearest = point_segment(a.lerp(b, f64::from(m) / 20.0), c, d);
                prop_assert!(found.distance_squared.sqrt() <= nearest.distance_squared.sqrt() + 1e-12 * scale);
            }
        }

        #[test]
        fn order_of_corners_and_ends_does_not_matter(x in [point(), point(), point(), point()]) {
            let [p, a, b, c] = x;
            let d = |t: [DVec3; 3]| point_triangle(p, t).distance_squared.sqrt();
            prop_assert!((d([a, b, c]) - d([c, a, b])).abs() < 1e-12 && (d([a, b, c]) - d([b, a, c])).abs() < 1e-12);
            let d = |e: [DVec3; 2], f: [DVec3; 2]| segment_segment(e, f).distance_squared.sqrt();
            prop_assert!((d([p, a], [b, c]) - d([c, b], [p, a])).abs() < 1e-12);
        }

        #[test]
        fn needles_and_nearly_parallel_segments_keep_their_digits(p in point(), a in point(), b in point(), e in -18.0..-3.0f64) {
            let c = b + DVec3::new(1.0, -0.5, 0.25) * 10f64.powf(e);
            let line = point_segment(p, a, b).distance_squared.sqrt();
            let needle = point_triangle(p, [a, b, c]).distance_squared.sqrt();
            prop_assert!((line - needle).abs() <= 2.0 * b.distance(c) + 1e-12);
            let shift = DVec3::new(0.0, 0.0, 1.0);
            let [f, g] = [a + shift, c + shift];
            let nearest = point_segment(a, f, g).distance_squared.min(point_segment(b, f, g).distance_squared);
            prop_assert!(segment_segment([a, b], [f, g]).distance_squared <= nearest * (1.0 + 1e-12));
        }
    }

    #[test]
    fn closed_forms_hold() {
        let t = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let above = point_triangle(DVec3::new(0.25, 0.25, 2.0), t);
        assert_eq!(above.offset, DVec3::new(0.0, 0.0, 2.0));
        assert_eq!(above.barycentric, [0.5, 0.25, 0.25]);
        assert_eq!(point_triangle(DVec3::new(2.0, 2.0, 0.0), t).barycentric, [0.0, 0.5, 0.5]);
        let cross = segment_segment([-DVec3::X, DVec3::X], [DVec3::new(0.0, -1.0, 3.0), DVec3::new(0.0, 1.0, 3.0)]);
        assert_eq!((cross.s, cross.t, cross.distance_squared), (0.5, 0.5, 9.0));
    }
}
