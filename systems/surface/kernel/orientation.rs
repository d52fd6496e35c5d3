//! On which side of a plane a point lies, exactly.
//!
//! ```text
//!        front:  d sees a, b, c turn counter-clockwise        side(a, b, c, d) = sign of (b - a) x (c - a) . (d - a)
//!          ^
//!          | n          c
//!          |         . '  \                 Same words as the labels of a face: the right-hand normal n of (a, b, c)
//!          a - - - - - - - b                points from the back to the front.
//!
//!        back:   d sees a, b, c turn clockwise
//! ```
//!
//! The sign is that of the real numbers that the coordinates stand for (Shewchuk 1997); the crate `robust` filters the clear
//! cases in rounded arithmetic itself, so no filter stands before it here.

use glam::DVec3;
use robust::{Coord, Coord3D};

/// Side of an oriented plane, or of an oriented line in a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Against the normal.
    Back,
    /// In the plane: the four points are coplanar.
    On,
    /// Along the normal.
    Front,
}

impl Side {
    /// The other side; `On` stays.
    #[must_use]
    pub const fn flipped(self) -> Self {
        match self {
            Self::Back => Self::Front,
            Self::On => Self::On,
            Self::Front => Self::Back,
        }
    }

    fn of(value: f64) -> Self {
        if value > 0.0 {
            Self::Front
        } else if value < 0.0 {
            Self::Back
        } else {
            Self::On
        }
    }
}

/// Side of the plane `a b c` on which `d` lies, exactly.
#[must_use]
pub fn orient3d(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> Side {
    let place = |x: DVec3| Coord3D { x: x.x, y: x.y, z: x.z };
    // There, positive means below: a, b, c turn clockwise as seen from d.
    Side::of(robust::orient3d(place(a), place(b), place(c), place(d))).flipped()
}

/// Side of the line `a b` on which `c` lies in the plane without coordinate `axis`, exactly: left is `Front`.
#[must_use]
pub(crate) fn orient2d_without(axis: usize, a: DVec3, b: DVec3, c: DVec3) -> Side {
    let place = |x: DVec3| Coord { x: x[(axis + 1) % 3], y: x[(axis + 2) % 3] };
    Side::of(robust::orient2d(place(a), place(b), place(c)))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn the_side_of_the_right_hand_normal_is_the_front() {
        let side = |z: f64| orient3d(DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.3, 0.3, z));
        assert_eq!([side(1.0), side(0.0), side(-1.0)], [Side::Front, Side::On, Side::Back]);
        assert_eq!(orient2d_without(2, DVec3::ZERO, DVec3::X, DVec3::Y), Side::Front);
    }

    proptest! {
        #[test]
        fn whole_numbers_agree_with_exact_integer_arithmetic(x in prop::array::uniform12(-3_000_000i64..3_000_000), plane in 0..3) {
            let mut p: Vec<[i64; 3]> = x.chunks(3).map(|c| [c[0], c[1], c[2]]).collect();
            if plane == 0 {
                p[3] = [0, 1, 2].map(|k| p[0][k] + p[1][k] - p[2][k]);
            }
            let d = |i: usize| [0, 1, 2].map(|k| i128::from(p[i][k] - p[0][k]));
            let ([b, c, e], cross) = ([d(1), d(2), d(3)], |u: [i128; 3], v: [i128; 3], k: usize| {
                u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]
            });
            let exact: i128 = (0..3).map(|k| cross(b, c, k) * e[k]).sum();
            let expected = [Side::Back, Side::On, Side::Front][(exact.signum() + 1) as usize];
            for scale in [1.0, 2f64.powi(-40), 2f64.powi(20)] {
                let [a, b, c, d] = [0, 1, 2, 3].map(|i| DVec3::from_array(p[i].map(|v| v as f64)) * scale);
                prop_assert_eq!(orient3d(a, b, c, d), expected);
                prop_assert_eq!(orient3d(b, a, c, d), expected.flipped());
                prop_assert_eq!(orient3d(b, c, a, d), expected);
                prop_assert_eq!(orient3d(a, b, d, c), expected.flipped());
            }
        }
    }

    #[test]
    fn a_last_digit_decides() {
        let (a, b, c) = (DVec3::new(0.1, 0.1, 0.1), DVec3::new(0.7, 0.2, 0.1), DVec3::new(0.3, 0.9, 0.1));
        let above = DVec3::new(0.3, 0.3, 0.1f64.next_up());
        assert_eq!(orient3d(a, b, c, above), Side::Front);
        assert_eq!(orient3d(a, b, c, DVec3::new(0.3, 0.3, 0.1)), Side::On);
    }
}
