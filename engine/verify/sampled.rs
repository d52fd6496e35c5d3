//! A shape sampled with carriers and their stencil, without a world around it.

use froth_components::authored::film::{Film, SurfactantField, ThicknessField};
use froth_components::authored::shape::Shape;
use froth_components::identity::{InRegion, RegionId};
use froth_components::motion::Position;
use froth_components::quantity::{Length, Ratio};
use froth_systems::melp::discretise::{AuthoredFilm, DiscreteFilm, Sampling};
use froth_systems::operators::conjugate_gradient::NotConverged;
use froth_systems::operators::stencil::{Points, Stencil};
use froth_systems::sampling::random::{self, Use};
use froth_systems::sampling::surface::Perturbation;
use glam::DVec3;

/// Carriers of one film.
pub(super) struct Sampled {
    pub(super) film: DiscreteFilm,
    pub(super) stencil: Stencil,
    pub(super) spacing: f64,
    pub(super) regions: Vec<InRegion>,
    wall_regions: Vec<InRegion>,
}

impl Sampled {
    /// About `count` carriers on a shape.
    pub(super) fn new(shape: Shape, count: usize) -> Result<Self, NotConverged> {
        Self::with_liquid(shape, count, 0)
    }

    /// The same, with material particles per carrier.
    pub(super) fn with_liquid(shape: Shape, count: usize, liquid_per_carrier: usize) -> Result<Self, NotConverged> {
        let spacing = (shape.area() / count as f64).sqrt();
        let sampling = Sampling { spacing, liquid_per_carrier, reference_surfactant: 1.0 };
        let thickness = ThicknessField::Uniform(Length::from_si(400e-9));
        let film = Film { thickness, surfactant: SurfactantField::Uniform, warmth: Ratio::from_si(0.0) };
        let perturbation = Perturbation::default();
        let authored = AuthoredFilm { shape, film, perturbation, seed: 0, drift: None, spin: None, swirl: None };
        let region = RegionId(1);
        let film = DiscreteFilm::sample(&authored, region, sampling)?;
        let regions = vec![InRegion(region); film.positions.len()];
        let wall_regions = vec![InRegion(region); film.wall.len()];
        let mut sampled = Self { film, stencil: Stencil::default(), spacing, regions, wall_regions };
        sampled.rebuild();
        Ok(sampled)
    }

    /// Builds the stencil where the carriers stand.
    pub(super) fn rebuild(&mut self) {
        let points = Points {
            positions: &self.film.positions,
            normals: &self.film.normals,
            regions: &self.regions,
            wall: &self.film.wall,
            wall_regions: &self.wall_regions,
            spacing: self.spacing,
        };
        self.stencil.rebuild(points);
    }

    /// Displaces every carrier within its tangent plane by up to `share` spacings along each axis, at random.
    pub(super) fn jitter(&mut self, share: f64) {
        for (i, (place, normal)) in self.film.positions.iter_mut().zip(&self.film.normals).enumerate() {
            let shift = DVec3::from_array([1, 2, 3].map(|axis| share * self.spacing * symmetric(axis, i as u64)));
            place.0 += shift - normal.0 * normal.0.dot(shift);
        }
        self.rebuild();
    }

    pub(super) fn count(&self) -> usize {
        self.film.positions.len()
    }

    pub(super) fn positions(&self) -> &[Position] {
        &self.film.positions
    }

    /// Whether no wall is within reach of a carrier's stencil.
    pub(super) fn is_inner(&self, i: usize) -> bool {
        self.stencil.wall_lists.of(i).is_empty()
    }

    /// `a_i (lap x)_i`: the curvature force on a carrier, per film tension.
    pub(super) fn pull(&self, i: usize) -> DVec3 {
        self.stencil.weighted_offsets(self.positions(), i).map(|(_, w, d)| d * w).sum()
    }
}

/// A random number from -1 to 1.
pub(super) fn symmetric(axis: u64, i: u64) -> f64 {
    2.0 * (random::bits(axis, i, 0, Use::NoiseSeed) >> 11) as f64 / (1_u64 << 53) as f64 - 1.0
}

/// Root mean square of a quantity over some rows.
pub(super) fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v * v, count + 1.0));
    (sum / count).sqrt()
}

/// Largest size of some numbers; NaN wins.
pub(super) fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
}
