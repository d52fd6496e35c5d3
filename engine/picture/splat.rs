//! Turns each film point into an ellipse on the picture.
//!
//! Equation: a disc of radius `ρ = 2 spacings` in the tangent plane is drawn, to first order in `ρ` over distance, as
//! `{ x : (x - x₀)ᵀ C⁻¹ (x - x₀) ≤ 1 }`, `C = ρ² J (1 - n nᵀ) Jᵀ + s² 1`, with `J` the derivative of the
//! projection and `s` a low-pass of about one sample. Its height `√(det C₀ / det C)` keeps the area under the kernel.
//! Source: Zwicker et al. 2001 (surface splatting), with a compact kernel `(1 - r²)²` in place of the Gaussian.
//! Limits: points nearer to the eye than 4 spacings are not drawn.
//! Gathered per sample in [`layers`](super::layers).

use super::camera::View;
use super::film::{FilmPoints, Part};
use glam::{DVec3, Vec2, Vec3};

/// Radius of the kernel, in spacings.
pub(super) const KERNEL_RADIUS: f64 = 2.0;
/// Radius of the low-pass, samples.
const LOW_PASS: f64 = 1.25;
/// Sum of weights of an evenly covered film: the kernel's integral over the area per point.
pub(super) const FULL_WEIGHT: f32 = (std::f64::consts::PI * KERNEL_RADIUS * KERNEL_RADIUS / 3.0) as f32;
/// Share of the full weight at which the film's edge is drawn: low enough that thin sampling tears no holes.
pub(super) const EDGE_WEIGHT: f32 = 0.28;
/// The same for a film's ground, whose points are even: at its edge half of the kernel lies on the film.
const GROUND_EDGE_WEIGHT: f32 = 0.5;
/// What the values of a ground weigh beside those of the detail on it.
const GROUND_VALUE: f32 = 0.01;
/// Smallest cosine in the estimate of how deep an ellipse reaches.
const SHALLOWEST: f64 = 0.03;

/// A film point as drawn, in samples and camera axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Splat {
    /// Centre of the ellipse, samples.
    pub centre: Vec2,
    /// Half width and half height of the ellipse's box, samples.
    pub reach: Vec2,
    /// `C⁻¹` as (xx, xy, yy), per sample squared.
    pub conic: Vec3,
    /// Weight at the centre, dimensionless, at most 1.
    pub height: f32,
    /// Part of the weight that says that there is film.
    pub cover: f32,
    /// Normal in camera axes, turned towards the eye.
    pub normal: Vec3,
    /// Whether the point's own normal points to the eye.
    pub faces_eye: bool,
    /// Distance along the view, metres.
    pub depth: f32,
    /// Other points of the same sheet seen through one sample lie within this depth, metres.
    pub depth_tolerance: f32,
    /// Value of the point.
    pub value: f32,
}

/// The ellipse of one point, or nothing if it lies outside the picture.
pub(super) fn splat_of_point(view: &View, film: &FilmPoints, row: usize) -> Option<Splat> {
    let placed = view.place(film.positions[row]);
    let depth = -placed.z;
    let disc = KERNEL_RADIUS * film.spacing;
    if depth < 2.0 * disc {
        return None;
    }
    let normal = view.turn(film.normals[row].normalize());
    let faces_eye = normal.dot(placed) < 0.0;
    let footprint = Footprint::new(view, placed, normal, disc);
    let (x, y) = view.project(placed);
    let reach = footprint.reach();
    let (shows, covers) = match film.part {
        Part::Whole => (1.0, 1.0),
        Part::Detail => (1.0, 0.0),
        Part::Ground => (GROUND_VALUE, EDGE_WEIGHT / GROUND_EDGE_WEIGHT / GROUND_VALUE),
    };
    let visible = x + reach.0 > 0.0 && x - reach.0 < view.width && y + reach.1 > 0.0 && y - reach.1 < view.height;
    visible.then(|| Splat {
        centre: Vec2::new(x as f32, y as f32),
        reach: Vec2::new(reach.0 as f32, reach.1 as f32),
        conic: footprint.conic(),
        height: shows * footprint.height() as f32,
        cover: covers,
        normal: if faces_eye { normal } else { -normal }.as_vec3(),
        faces_eye,
        depth: depth as f32,
        depth_tolerance: depth_tolerance(view, placed, normal, film.spacing) as f32,
        value: film.values[row] as f32,
    })
}

/// Spread of depth under one ellipse, twice over: the disc's own tilt and that of the low-pass.
fn depth_tolerance(view: &View, placed: DVec3, normal: DVec3, spacing: f64) -> f64 {
    let cos = normal.dot(placed.normalize()).abs().max(SHALLOWEST);
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let sample = -placed.z / view.focal;
    spacing + 2.0 * KERNEL_RADIUS * spacing * sin + 2.0 * LOW_PASS * sample * sin / cos
}

/// The symmetric matrix `C` and the determinant it has without low-pass.
struct Footprint {
    xx: f64,
    xy: f64,
    yy: f64,
    sharp_determinant: f64,
}

impl Footprint {
    fn new(view: &View, placed: DVec3, normal: DVec3, disc: f64) -> Self {
        let scale = view.focal / -placed.z;
        let along_x = scale * DVec3::new(1.0, 0.0, placed.x / -placed.z);
        let along_y = scale * DVec3::new(0.0, -1.0, -placed.y / -placed.z);
        let (tilt_x, tilt_y) = (along_x.dot(normal), along_y.dot(normal));
        let square = disc * disc;
        let xx = square * (along_x.length_squared() - tilt_x * tilt_x);
        let xy = square * (along_x.dot(along_y) - tilt_x * tilt_y);
        let yy = square * (along_y.length_squared() - tilt_y * tilt_y);
        let sharp_determinant = (xx * yy - xy * xy).max(0.0);
        let blur = LOW_PASS * LOW_PASS;
        Self { xx: xx + blur, xy, yy: yy + blur, sharp_determinant }
    }

    fn determinant(&self) -> f64 {
        self.xx * self.yy - self.xy * self.xy
    }

    fn conic(&self) -> Vec3 {
        (DVec3::new(self.yy, -self.xy, self.xx) / self.determinant()).as_vec3()
    }

    fn height(&self) -> f64 {
        (self.sharp_determinant / self.determinant()).sqrt()
    }

    fn reach(&self) -> (f64, f64) {
        (self.xx.sqrt(), self.yy.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::{KERNEL_RADIUS, LOW_PASS, splat_of_point};
    use crate::picture::camera::Camera;
    use crate::picture::film::{FilmPoints, Part};
    use glam::DVec3;

    fn camera() -> Camera {
        Camera { position: DVec3::new(0.0, 0.0, 1.0), target: DVec3::ZERO, up: DVec3::Y, field_of_view: 40.0 }
    }

    fn one_point(normal: DVec3) -> super::Splat {
        let view = camera().view(500.0, 500.0).unwrap();
        let film = FilmPoints {
            positions: &[DVec3::ZERO],
            normals: &[normal],
            values: &[1.0],
            spacing: 0.01,
            part: Part::Whole,
        };
        splat_of_point(&view, &film, 0).unwrap()
    }

    #[test]
    fn a_disc_seen_face_on_is_a_circle_of_its_size() {
        let splat = one_point(DVec3::Z);
        let focal = 250.0 / 20f64.to_radians().tan();
        let expected = ((KERNEL_RADIUS * 0.01 * focal).powi(2) + LOW_PASS * LOW_PASS).sqrt() as f32;
        assert!((splat.reach.x - expected).abs() < 1e-3 && (splat.reach.y - expected).abs() < 1e-3);
    }

    #[test]
    fn a_tilted_disc_is_foreshortened_by_its_cosine() {
        let (sin, cos) = 60f64.to_radians().sin_cos();
        let splat = one_point(DVec3::new(sin, 0.0, cos));
        let sharp = |reach: f32| (f64::from(reach).powi(2) - LOW_PASS * LOW_PASS).sqrt();
        assert!((sharp(splat.reach.x) / sharp(splat.reach.y) - 0.5).abs() < 1e-3);
    }

    #[test]
    fn a_disc_seen_edge_on_weighs_nothing() {
        assert!(one_point(DVec3::X).height < 1e-3);
    }

    #[test]
    fn a_normal_away_from_the_eye_is_turned_and_remembered() {
        let splat = one_point(-DVec3::Z);
        assert!(!splat.faces_eye && splat.normal.z > 0.99);
    }
}
