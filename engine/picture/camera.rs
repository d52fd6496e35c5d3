//! A perspective camera.
//!
//! ```text
//!            up                         x ->
//!             |   right             y  +-------------+
//!             |  /                  |  |   picture   |   pixel (0, 0) at the top left,
//!   position  | /                   v  |             |   its centre at (0.5, 0.5)
//!        <----+ - - - - target         +-------------+
//!       back
//! ```
//! A point at `(X, Y, Z)` along right, up and view is drawn at `x = w/2 + f X/Z`, `y = h/2 - f Y/Z`,
//! with `f = (h/2) / tan(field of view / 2)` in pixels.

use super::error::PictureError;
use glam::{DVec3, Vec3};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde::Deserialize;

/// Default vertical field of view, degrees.
pub const FIELD_OF_VIEW: f64 = 35.0;
/// How far above the horizon the default camera stands, degrees.
pub const ELEVATION: f64 = 12.0;
/// Halvings of the share of the picture that points fill: down to 1e-12.
const HALVINGS: u32 = 40;
/// Room around a framed sphere, relative to its radius.
const MARGIN: f64 = 1.12;

/// Where the picture is taken from.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Place of the eye, metres.
    pub position: DVec3,
    /// Point at the centre of the picture, metres.
    pub target: DVec3,
    /// Direction that is up in the picture; any length.
    #[serde(default = "default_up")]
    pub up: DVec3,
    /// Angle between the upper and the lower edge of the picture, degrees, 1 to 170.
    #[serde(default = "default_field_of_view")]
    pub field_of_view: f64,
}

fn default_up() -> DVec3 {
    DVec3::Y
}

fn default_field_of_view() -> f64 {
    FIELD_OF_VIEW
}

impl Camera {
    /// Unit vector to an eye that stands `elevation` degrees above the horizon, `azimuth` degrees from z towards x.
    #[must_use]
    pub fn towards_eye(elevation: f64, azimuth: f64) -> DVec3 {
        let ((rise, level), (aside, ahead)) = (elevation.to_radians().sin_cos(), azimuth.to_radians().sin_cos());
        DVec3::new(level * aside, rise, level * ahead)
    }

    /// Looks at a sphere from slightly above, so that it fills the picture.
    ///
    /// `centre` and `radius` in metres; `aspect` is width over height.
    #[must_use]
    pub fn framing(centre: DVec3, radius: f64, aspect: f64) -> Self {
        let half_height = 0.5 * FIELD_OF_VIEW.to_radians();
        let half_angle = (half_height.tan() * aspect.min(1.0)).atan();
        let distance = radius.max(f64::MIN_POSITIVE) * MARGIN / half_angle.sin();
        let position = centre + distance * Self::towards_eye(ELEVATION, 0.0);
        Self { position, target: centre, up: DVec3::Y, field_of_view: FIELD_OF_VIEW }
    }

    /// Looks against `back` at a set of points, metres, so that they fill the share `fill` of the picture, 0 to 1, in the
    /// direction that limits, and are centred in both. `aspect` is width over height.
    ///
    /// Equation: in camera axes an eye at `(x, y, z)` sees a point at `(X, Y, Z)` within the share if `|X - x| <= k (z - Z)`,
    /// `k = fill aspect tan(field of view / 2)`, and alike for `Y`. The least `z` for which such an `x` exists is
    /// `(max(X + k Z) + max(-X + k Z)) / 2k`, with `x = (max(X + k Z) - max(-X + k Z)) / 2`.
    ///
    /// # Errors
    /// [`PictureError::NoPoints`] for an empty set, [`PictureError::CameraWithoutDirection`] if `back` is zero or vertical.
    pub fn filling(points: &[DVec3], back: DVec3, fill: f64, aspect: f64) -> Result<Self, PictureError> {
        let first = *points.first().ok_or(PictureError::NoPoints)?;
        let unplaced = Self { position: first + back, target: first, up: DVec3::Y, field_of_view: FIELD_OF_VIEW };
        let axes = unplaced.view(aspect, 1.0)?;
        let half_height = fill * (0.5 * FIELD_OF_VIEW.to_radians()).tan();
        let placed: Vec<DVec3> = points.iter().map(|p| axes.turn(p - first)).collect();
        let highest = |of: &dyn Fn(&DVec3) -> f64| placed.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
        let fit = |axis: DVec3, k: f64| {
            let (over, under) = (highest(&|p| p.dot(axis) + k * p.z), highest(&|p| k * p.z - p.dot(axis)));
            (0.5 * (over - under), 0.5 * (over + under) / k)
        };
        let nearest = highest(&|p| p.z);
        let smallest = 1e-9 * first.length().max(1e-3);
        let (by_width, by_height) = (fit(DVec3::X, half_height * aspect).1, fit(DVec3::Y, half_height).1);
        let distance = by_width.max(by_height).max(nearest + smallest);
        // The axis that does not limit: the smaller share that needs the same distance. The distance falls with the share.
        let centred = |axis: DVec3, widest: f64| {
            let (_, share) = (0..HALVINGS).fold((0.0, widest), |(low, high), _| {
                let middle = 0.5 * (low + high);
                if fit(axis, middle).1 > distance { (middle, high) } else { (low, middle) }
            });
            fit(axis, share).0
        };
        let eye = DVec3::new(centred(DVec3::X, half_height * aspect), centred(DVec3::Y, half_height), distance);
        let position = first + eye.x * axes.right + eye.y * axes.up + eye.z * axes.back;
        Ok(Self { position, target: position - (eye.z - nearest) * axes.back, ..unplaced })
    }

    /// Frames a set of points, metres: their bounding box fits. For an animation, frame once and keep the camera.
    ///
    /// # Errors
    /// [`PictureError::NoPoints`] for an empty set.
    pub fn framing_points(points: &[DVec3], aspect: f64) -> Result<Self, PictureError> {
        let first = *points.first().ok_or(PictureError::NoPoints)?;
        let low = points.par_iter().copied().reduce(|| first, DVec3::min);
        let high = points.par_iter().copied().reduce(|| first, DVec3::max);
        let centre = 0.5 * (low + high);
        let radius = points.par_iter().map(|p| p.distance(centre)).reduce(|| 0.0, f64::max);
        let smallest = 1e-9 * centre.length().max(1e-3);
        Ok(Self::framing(centre, radius.max(smallest), aspect))
    }

    /// Height of what the picture shows at the distance of the target, metres.
    #[must_use]
    pub fn height_at_target(&self) -> f64 {
        2.0 * (0.5 * self.field_of_view.to_radians()).tan() * self.position.distance(self.target)
    }

    /// The camera's axes and scale for a picture of `width` by `height` pixels.
    ///
    /// # Errors
    /// [`PictureError`] if the camera has no direction or its angle is out of range.
    pub fn view(&self, width: f64, height: f64) -> Result<View, PictureError> {
        if !(1.0..=170.0).contains(&self.field_of_view) {
            let (name, allowed) = ("the camera's field of view", "1 to 170 degrees");
            return Err(PictureError::OutOfRange { name, value: self.field_of_view, allowed });
        }
        let missing = || PictureError::CameraWithoutDirection;
        let back = (self.position - self.target).try_normalize().ok_or_else(missing)?;
        let right = self.up.normalize_or_zero().cross(back);
        if !self.position.is_finite() || right.length_squared().partial_cmp(&1e-12).is_none_or(|o| o.is_le()) {
            return Err(missing());
        }
        let right = right.normalize();
        let focal = 0.5 * height / (0.5 * self.field_of_view.to_radians()).tan();
        Ok(View { position: self.position, right, up: back.cross(right), back, focal, width, height })
    }
}

/// A camera's axes, with the scale of one picture.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Place of the eye, metres.
    pub position: DVec3,
    /// Unit vector to the right of the picture.
    pub right: DVec3,
    /// Unit vector to the top of the picture.
    pub up: DVec3,
    /// Unit vector from the target to the eye.
    pub back: DVec3,
    /// Focal length, pixels.
    pub focal: f64,
    /// Width of the picture, pixels.
    pub width: f64,
    /// Height of the picture, pixels.
    pub height: f64,
}

impl View {
    /// A direction in camera axes: right, up, back.
    #[must_use]
    pub fn turn(&self, direction: DVec3) -> DVec3 {
        DVec3::new(direction.dot(self.right), direction.dot(self.up), direction.dot(self.back))
    }

    /// A point in camera axes, metres; points in view have a negative third part.
    #[must_use]
    pub fn place(&self, point: DVec3) -> DVec3 {
        self.turn(point - self.position)
    }

    /// Pixel coordinates of a point in camera axes.
    #[must_use]
    pub fn project(&self, placed: DVec3) -> (f64, f64) {
        let scale = self.focal / -placed.z;
        (0.5 * self.width + scale * placed.x, 0.5 * self.height - scale * placed.y)
    }

    /// Unit direction, in camera axes, from the eye through a pixel position.
    #[must_use]
    pub fn ray(&self, x: f32, y: f32) -> Vec3 {
        let focal = self.focal as f32;
        let (x, y) = (x - 0.5 * self.width as f32, y - 0.5 * self.height as f32);
        Vec3::new(x / focal, -y / focal, -1.0).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::Camera;
    use crate::picture::error::PictureError;
    use glam::DVec3;

    #[test]
    fn a_framed_sphere_touches_neither_edge_nor_leaves_half_the_picture_empty() {
        for (width, height) in [(640.0, 640.0), (320.0, 640.0), (1280.0, 640.0)] {
            let centre = DVec3::new(0.3, -2.0, 5.0);
            let view = Camera::framing(centre, 0.05, width / height).view(width, height).unwrap();
            for step in 0..360 {
                let (sin, cos) = f64::from(step).to_radians().sin_cos();
                let (x, y) = view.project(view.place(centre + 0.05 * (cos * view.right + sin * view.up)));
                assert!(x > 0.0 && x < width && y > 0.0 && y < height);
            }
            let (x, _) = view.project(view.place(centre + 0.05 * view.right));
            assert!(x - 0.5 * width > 0.35 * f64::min(width, height));
        }
    }

    #[test]
    fn a_ray_through_a_projected_point_meets_the_point() {
        let camera =
            Camera { position: DVec3::new(1.0, 2.0, 3.0), target: DVec3::ZERO, up: DVec3::Y, field_of_view: 50.0 };
        let view = camera.view(800.0, 600.0).unwrap();
        let placed = view.place(DVec3::new(0.2, -0.4, 0.3));
        let (x, y) = view.project(placed);
        assert!((view.ray(x as f32, y as f32).as_dvec3() - placed.normalize()).length() < 1e-5);
    }

    #[test]
    fn a_camera_without_direction_is_refused() {
        let camera = Camera { position: DVec3::Y, target: DVec3::ZERO, up: DVec3::Y, field_of_view: 35.0 };
        assert!(matches!(camera.view(10.0, 10.0), Err(PictureError::CameraWithoutDirection)));
    }
}
