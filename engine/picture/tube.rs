//! Turns each line of a mesh into a tube on the picture, and tells what it covers of a sample.
//!
//! ```text
//!      across = -1   0   +1            A tube ends in round caps, so that tubes on end make one bent tube.
//!             |  |   |   |             Its normal at `across = o` is `o side + √(1 - o²) front`.
//!             |  |   |   |
//!              \_|___|__/
//! ```
//! Tubes thinner than a sample are drawn one sample wide and as much fainter.

use super::camera::View;
use super::facet::{Fragment, meets_picture, projected};
use super::film_network::{Line, LineKind};
use super::subsamples::{STEPS, mask, middle};
use super::tiles::Flat;
use glam::{DVec3, Vec2, Vec3};

/// Least radius, samples.
const THINNEST: f32 = 0.5;

/// A line as drawn, in samples and camera axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tube {
    from: Vec2,
    along: Vec2,
    /// Radius at both ends, samples.
    radii: [f32; 2],
    /// One over the depth at both ends, 1/m.
    nearness: [f32; 2],
    /// Radius, metres.
    pub radius: f32,
    /// Unit vectors across the tube, in camera axes: to the right of `along` in the picture, and to the eye.
    side: Vec3,
    front: Vec3,
    pub kind: LineKind,
    /// Below 1 for tubes thinner than a sample.
    pub opacity: f32,
}

/// The tube of `radius` metres around a line; nothing if it lies outside the picture or reaches behind the eye.
pub(super) fn tube_of_line(view: &View, positions: &[DVec3], line: &Line, radius: f64) -> Option<Tube> {
    let placed = line.ends.map(|end| view.place(positions[end as usize]));
    let [from, to] = [projected(view, placed[0])?, projected(view, placed[1])?];
    let [from, to] = [from, to].map(|[x, y]| Vec2::new(x as f32, y as f32));
    let along = to - from;
    let drawn = placed.map(|placed| (radius * view.focal / -placed.z) as f32);
    let thinnest = drawn[0].min(drawn[1]);
    let sight = 0.5 * (placed[0] + placed[1]);
    let direction = (placed[1] - placed[0]).try_normalize()?;
    let side = direction.cross(sight).try_normalize()?;
    // Rows run downwards: the picture's right of `along` is (-y, x), in camera axes (-y, -x).
    let side = if side.x * f64::from(-along.y) - side.y * f64::from(along.x) < 0.0 { -side } else { side };
    let front = side.cross(direction);
    let front = if front.dot(sight) > 0.0 { -front } else { front };
    let tube = Tube {
        from,
        along,
        radii: drawn.map(|radius| radius.max(THINNEST)),
        nearness: placed.map(|placed| (-1.0 / placed.z) as f32),
        radius: radius as f32,
        side: side.as_vec3(),
        front: front.as_vec3(),
        kind: line.kind,
        opacity: (thinnest / THINNEST).min(1.0),
    };
    let (low, high) = tube.bounds();
    meets_picture(view, low, high).then_some(tube)
}

impl Flat for Tube {
    fn bounds(&self) -> (Vec2, Vec2) {
        let (to, radius) = (self.from + self.along, self.widest());
        (self.from.min(to) - radius, self.from.max(to) + radius)
    }
}

impl Tube {
    fn widest(&self) -> f32 {
        self.radii[0].max(self.radii[1])
    }

    /// How far along (0 to 1) the tube is nearest to a place, and the offset of the place from there.
    #[inline]
    fn nearest(&self, place: Vec2) -> (f32, Vec2) {
        let offset = place - self.from;
        let along = (offset.dot(self.along) / self.along.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
        (along, offset - along * self.along)
    }

    #[inline]
    fn radius_at(&self, along: f32) -> f32 {
        self.radii[0] + along * (self.radii[1] - self.radii[0])
    }

    /// What the tube shows in a sample of the picture.
    #[inline]
    pub(super) fn fragment(&self, column: usize, row: usize) -> Option<Fragment> {
        let centre = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
        if self.nearest(centre).1.length() > self.widest() + std::f32::consts::FRAC_1_SQRT_2 {
            return None;
        }
        let mask = mask(|[x, y]| {
            let (along, offset) = self.nearest(centre + Vec2::new(x as f32, y as f32) / STEPS as f32);
            offset.length() < self.radius_at(along)
        });
        if mask == 0 {
            return None;
        }
        let (along, offset) = self.nearest(centre + middle(mask));
        let right = Vec2::new(-self.along.y, self.along.x).normalize_or_zero();
        let across = (offset.dot(right) / self.radius_at(along)).clamp(-1.0, 1.0);
        let raised = (1.0 - across * across).sqrt();
        let nearness = self.nearness[0] + along * (self.nearness[1] - self.nearness[0]);
        let normal = across * self.side + raised * self.front;
        let depth = nearness.recip() - self.radius * raised;
        Some(Fragment { mask, value: 0.0, normal, spread: 0.5 / self.radius_at(along) * self.side, depth })
    }
}

#[cfg(test)]
mod tests {
    use super::{Tube, tube_of_line};
    use crate::picture::camera::{Camera, View};
    use crate::picture::film_network::{Line, LineKind};
    use glam::DVec3;

    fn view() -> View {
        let position = DVec3::new(0.0, 0.0, 4.0);
        Camera { position, target: DVec3::ZERO, up: DVec3::Y, field_of_view: 30.0 }.view(90.0, 90.0).unwrap()
    }

    fn tube(from: DVec3, to: DVec3, radius: f64) -> Tube {
        tube_of_line(&view(), &[from, to], &Line { ends: [0, 1], kind: LineKind::Wire }, radius).unwrap()
    }

    fn samples(tube: &Tube) -> impl Iterator<Item = super::Fragment> {
        (0..90 * 90).filter_map(|sample| tube.fragment(sample % 90, sample / 90))
    }

    #[test]
    fn a_tube_covers_its_length_times_its_width_and_two_half_discs() {
        for turn in 0..7 {
            let (sin, cos) = f64::from(turn).sin_cos();
            let tube = tube(DVec3::ZERO, 0.8 * DVec3::new(cos, sin, 0.0), 0.05);
            let scale = view().focal / 4.0;
            let expected = scale * scale * (0.8 * 0.1 + std::f64::consts::PI * 0.05 * 0.05);
            let covered: f64 = samples(&tube).map(|f| f64::from(f.mask.count_ones()) / 16.0).sum();
            assert!((covered / expected - 1.0).abs() < 0.02, "{covered} of {expected}");
        }
    }

    #[test]
    fn normals_face_the_eye_in_the_middle_and_outwards_at_the_sides() {
        let tube = tube(DVec3::new(0.0, -0.8, 0.0), DVec3::new(0.0, 0.8, 0.0), 0.1);
        for (column, expected) in [(45, 0.12), (48, 0.83), (41, -0.83)] {
            let fragment = tube.fragment(column, 45).unwrap();
            assert!((fragment.normal.x - expected).abs() < 0.02 && fragment.normal.z > 0.5, "{fragment:?}");
            assert!(fragment.normal.is_normalized() && (3.85..4.0).contains(&fragment.depth));
        }
    }

    #[test]
    fn a_tube_thinner_than_a_sample_is_fainter_instead_of_thinner() {
        let tube = tube(DVec3::ZERO, DVec3::X, 0.001);
        assert!((0.05..0.1).contains(&tube.opacity) && tube.radii == [0.5; 2]);
    }
}
