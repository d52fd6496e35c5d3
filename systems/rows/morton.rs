//! Morton codes: one integer per point such that near codes are mostly near points.

use glam::DVec3;

/// Spreads the low 21 bits of `v` so that two zero bits follow each.
const fn spread(v: u64) -> u64 {
    let mut v = v & 0x1f_ffff;
    v = (v | v << 32) & 0x001f_0000_0000_ffff;
    v = (v | v << 16) & 0x001f_0000_ff00_00ff;
    v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
    v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
    (v | v << 2) & 0x1249_2492_4924_9249
}

/// Morton code of the cell of size `cell` that holds `point`, counted from `origin`; 21 bits an axis.
#[must_use]
pub fn morton_code(point: DVec3, origin: DVec3, cell: f64) -> u64 {
    let place = ((point - origin) / cell).clamp(DVec3::ZERO, DVec3::splat(f64::from(0x1f_ffff)));
    spread(place.x as u64) | spread(place.y as u64) << 1 | spread(place.z as u64) << 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_interleave_the_axes() {
        let code = |x, y, z| morton_code(DVec3::new(x, y, z), DVec3::ZERO, 1.0);
        assert_eq!([code(1.0, 0.0, 0.0), code(0.0, 1.0, 0.0), code(0.0, 0.0, 1.0)], [1, 2, 4]);
        assert_eq!(code(3.0, 3.0, 3.0), 63);
    }

    #[test]
    fn points_outside_the_box_are_clamped_into_it() {
        assert_eq!(morton_code(DVec3::splat(-5.0), DVec3::ZERO, 1.0), 0);
    }
}
