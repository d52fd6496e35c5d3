//! Whether triangles cross, exactly; touching is not crossing.
//!
//! ```text
//!    no vertex shared            one vertex shared          two vertices shared
//!
//!      edge of one through         edge opposite to it        coplanar, and both on the same
//!      the inside of the other     through the other          side of the common edge
//! ```
//!
//! All decisions are signs of [`orient3d`]. A segment crosses a triangle if it passes from one side of the plane strictly to the
//! other through the inside strictly; whatever goes through a corner, along a side or lies in the plane touches.

use glam::DVec3;

use crate::grid::Aabb;
use crate::kernel::orientation::{Side, orient2d_without, orient3d};
use crate::rows::VertexRow;

/// Whether the segment `p q` passes through the inside of the triangle `a b c`.
#[must_use]
pub fn segment_crosses_triangle(p: DVec3, q: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let (from, to) = (orient3d(a, b, c, p), orient3d(a, b, c, q));
    if from == Side::On || to != from.flipped() {
        return false;
    }
    let turn = orient3d(p, q, a, b);
    turn != Side::On && turn == orient3d(p, q, b, c) && turn == orient3d(p, q, c, a)
}

/// Whether the segment `p q` goes from one side of the triangle's plane strictly to the other through the triangle, its sides and
/// corners counted in.
#[must_use]
pub fn segment_pierces_triangle(p: DVec3, q: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let (from, to) = (orient3d(a, b, c, p), orient3d(a, b, c, q));
    if from == Side::On || to != from.flipped() {
        return false;
    }
    let turns = [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
    !(turns.contains(&Side::Front) && turns.contains(&Side::Back))
}

/// Whether two triangles with vertices `a`, `b` at `xa`, `xb` cross. The same three vertices twice do not: that is a flap.
#[must_use]
pub fn triangles_cross(a: [VertexRow; 3], xa: [DVec3; 3], b: [VertexRow; 3], xb: [DVec3; 3]) -> bool {
    if !Aabb::of(&xa).overlaps(&Aabb::of(&xb)) {
        return false;
    }
    let (mut common, mut count) = ([(0, 0); 3], 0);
    for (i, v) in a.iter().enumerate() {
        if let Some(j) = b.iter().position(|w| w == v) {
            common[count] = (i, j);
            count += 1;
        }
    }
    match count {
        0 => any_side_crosses(xa, xb) || any_side_crosses(xb, xa),
        1 => {
            let (i, j) = common[0];
            opposite_side_crosses(xa, i, xb) || opposite_side_crosses(xb, j, xa)
        }
        2 => {
            let ((i, k), (j, l)) = (common[0], common[1]);
            is_folded_flat(xa[i], xa[j], xa[3 - i - j], xb[3 - k - l])
        }
        _ => false,
    }
}

fn any_side_crosses(x: [DVec3; 3], through: [DVec3; 3]) -> bool {
    // Sides first: triangles all on one side of the plane are the common case.
    let sides = x.map(|p| orient3d(through[0], through[1], through[2], p));
    if !(sides.contains(&Side::Front) && sides.contains(&Side::Back)) {
        return false;
    }
    (0..3).any(|i| opposite_side_crosses(x, i, through))
}

fn opposite_side_crosses(x: [DVec3; 3], corner: usize, through: [DVec3; 3]) -> bool {
    segment_crosses_triangle(x[(corner + 1) % 3], x[(corner + 2) % 3], through)
}

/// Whether `c` and `d` lie on the same side of the line `a b`, exactly in one plane with it.
fn is_folded_flat(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> bool {
    let is_same_side = |axis: usize| {
        let side = orient2d_without(axis, a, b, c);
        side != Side::On && side == orient2d_without(axis, a, b, d)
    };
    orient3d(a, b, c, d) == Side::On && (0..3).any(is_same_side)
}

/// Whether `p` lies strictly inside the tetrahedron; its corners may be given in any order, and a flat one contains nothing.
#[must_use]
pub fn point_in_tetrahedron(p: DVec3, [a, b, c, d]: [DVec3; 4]) -> bool {
    let side = orient3d(a, b, c, d);
    side != Side::On
        && orient3d(a, b, c, p) == side
        && orient3d(a, b, p, d) == side
        && orient3d(a, p, c, d) == side
        && orient3d(p, b, c, d) == side
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const FLAT: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    fn rows(v: [u32; 3]) -> [VertexRow; 3] {
        v.map(VertexRow)
    }

    fn at(x: f64, y: f64, z: f64) -> DVec3 {
        DVec3::new(x, y, z)
    }

    #[test]
    fn sides_and_corners_can_be_pierced() {
        let upright = |x: f64, y: f64| segment_pierces_triangle(at(x, y, -1.0), at(x, y, 1.0), FLAT);
        assert!(upright(0.2, 0.2) && upright(0.5, 0.0) && upright(0.0, 0.0) && upright(0.5, 0.5));
        assert!(!upright(0.6, 0.6) && !upright(-1e-300, 0.5));
        assert!(!segment_pierces_triangle(at(0.2, 0.2, 0.0), at(0.2, 0.2, 1.0), FLAT), "it starts in the plane");
    }

    #[test]
    fn through_the_inside_crosses_and_through_the_rim_touches() {
        let upright = |x: f64, y: f64| segment_crosses_triangle(at(x, y, -1.0), at(x, y, 1.0), FLAT);
        assert!(upright(0.2, 0.2) && upright(1e-300, 1e-300));
        assert!(!upright(0.5, 0.0) && !upright(0.0, 0.0) && !upright(0.5, 0.5) && !upright(0.6, 0.6));
        let standing = |z: f64| segment_crosses_triangle(at(0.2, 0.2, z), at(0.2, 0.2, 1.0), FLAT);
        assert!(standing(-f64::MIN_POSITIVE) && !standing(0.0) && !standing(0.5));
    }

    #[test]
    fn triangles_without_a_common_vertex_cross_where_an_edge_pierces() {
        let other = |z: f64| [at(0.2, 0.2, z), at(0.3, 0.2, z + 1.0), at(0.2, 0.3, z + 1.0)];
        let cross = |z: f64| triangles_cross(rows([0, 1, 2]), FLAT, rows([3, 4, 5]), other(z));
        assert!(cross(-0.5) && !cross(0.0) && !cross(0.1) && !cross(-1.0));
    }

    #[test]
    fn triangles_with_a_common_vertex_cross_by_the_opposite_edge() {
        let other = |y: f64| [at(0.0, 0.0, 0.0), at(0.5, y, -1.0), at(0.5, y, 1.0)];
        let cross = |y: f64| triangles_cross(rows([0, 1, 2]), FLAT, rows([0, 4, 5]), other(y));
        assert!(cross(0.2) && !cross(-0.2) && !cross(0.5));
    }

    #[test]
    fn triangles_with_a_common_edge_cross_only_when_folded_flat() {
        let cross = |d: DVec3| triangles_cross(rows([0, 1, 2]), FLAT, rows([1, 0, 3]), [FLAT[1], FLAT[0], d]);
        assert!(cross(at(0.3, 0.7, 0.0)));
        assert!(!cross(at(0.3, 0.7, 1e-300)) && !cross(at(0.3, -0.7, 0.0)) && !cross(at(3.0, 0.0, 0.0)));
        assert!(!triangles_cross(rows([0, 1, 2]), FLAT, rows([2, 0, 1]), [FLAT[2], FLAT[0], FLAT[1]]));
    }

    #[test]
    fn a_flat_tetrahedron_contains_nothing() {
        assert!(!point_in_tetrahedron(at(0.2, 0.2, 0.0), [DVec3::ZERO, DVec3::X, DVec3::Y, at(0.3, 0.3, 0.0)]));
        assert!(!point_in_tetrahedron(DVec3::ZERO, [DVec3::ZERO; 4]));
    }

    fn point() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-1.0..1.0f64).prop_map(DVec3::from_array)
    }

    proptest! {
        #[test]
        fn a_point_is_in_a_tetrahedron_if_its_weights_are_positive(x in prop::array::uniform4(point()), w in prop::array::uniform4(-0.2..1.0f64)) {
            let sum: f64 = w.iter().sum();
            prop_assume!(sum > 0.1 && w.iter().all(|w| w.abs() > 1e-6));
            let volume = (x[1] - x[0]).cross(x[2] - x[0]).dot(x[3] - x[0]);
            prop_assume!(volume.abs() > 1e-3);
            let p = (0..4).map(|i| x[i] * (w[i] / sum)).sum();
            let is_inside = w.iter().all(|w| *w > 0.0);
            prop_assert_eq!(point_in_tetrahedron(p, x), is_inside);
            prop_assert_eq!(point_in_tetrahedron(p, [x[1], x[0], x[2], x[3]]), is_inside);
            prop_assert_eq!(point_in_tetrahedron(x[0], x), false);
        }

        #[test]
        fn crossing_agrees_with_the_solution_of_the_linear_system(t in prop::array::uniform3(point()), p in point(), q in point(), k in -20..21i32) {
            // p + s (q - p) = a + v (b - a) + w (c - a), by Cramer's rule.
            let (e, f, g, h) = (q - p, t[0] - t[1], t[0] - t[2], t[0] - p);
            let det = e.dot(f.cross(g));
            let [s, v, w] = [h.dot(f.cross(g)), e.dot(h.cross(g)), e.dot(f.cross(h))].map(|n| n / det);
            let margin = [s, 1.0 - s, v, w, 1.0 - v - w];
            prop_assume!(det.abs() > 1e-6 && margin.iter().all(|m| m.abs() > 1e-6));
            let scale = 2f64.powi(k);
            let [a, b, c] = t.map(|x| x * scale);
            for t in [[a, b, c], [b, c, a], [b, a, c]] {
                prop_assert_eq!(segment_crosses_triangle(p * scale, q * scale, t), margin.iter().all(|m| *m > 0.0));
            }
        }

        #[test]
        fn crossing_does_not_depend_on_order(x in prop::array::uniform6(point()), shared in 0..2usize) {
            let xa = [x[0], x[1], x[2]];
            let xb = if shared == 1 { [x[0], x[3], x[4]] } else { [x[3], x[4], x[5]] };
            let (a, b) = (rows([0, 1, 2]), if shared == 1 { rows([0, 3, 4]) } else { rows([3, 4, 5]) });
            let turn = |[x, y, z]: [DVec3; 3]| [y, z, x];
            let turn_rows = |[x, y, z]: [VertexRow; 3]| [y, z, x];
            let cross = triangles_cross(a, xa, b, xb);
            prop_assert_eq!(cross, triangles_cross(b, xb, a, xa));
            prop_assert_eq!(cross, triangles_cross(turn_rows(a), turn(xa), b, xb));
        }
    }
}
