//! Laws of redistribution.

use super::*;
use crate::operators::quadratic::refit_all;
use crate::operators::stencil::{FIT_SUPPORT, Points};
use crate::sampling::random::{self, Use};
use crate::sampling::spread::sphere_cap;
use froth_components::identity::InRegion;

struct Sphere {
    positions: Vec<Position>,
    normals: Vec<Normal>,
    shapes: Vec<ShapeOperator>,
    regions: Vec<InRegion>,
    spacing: f64,
}

impl Sphere {
    /// A unit sphere whose carriers are displaced along it by up to `noise` spacings.
    fn noisy(count: usize, noise: f64) -> Self {
        let spacing = (4.0 * std::f64::consts::PI / count as f64).sqrt();
        let shift = |i: usize, axis: u64| {
            let bits = random::bits(axis, i as u64, 0, Use::NoiseSeed);
            (2.0 * (bits >> 11) as f64 / (1_u64 << 53) as f64 - 1.0) * noise * spacing
        };
        let displaced = |(i, n): (usize, DVec3)| (n + DVec3::new(shift(i, 1), shift(i, 2), shift(i, 3))).normalize();
        let normals: Vec<Normal> = sphere_cap(count, -1.0).enumerate().map(displaced).map(Normal).collect();
        Self {
            positions: normals.iter().map(|n| Position(n.0)).collect(),
            shapes: vec![ShapeOperator::default(); count],
            regions: vec![InRegion::default(); count],
            normals,
            spacing,
        }
    }

    /// One redistribution pass; returns the unevenness before it.
    fn pass(&mut self) -> f64 {
        let points = Points {
            positions: &self.positions,
            normals: &self.normals,
            regions: &self.regions,
            wall: &[],
            wall_regions: &[],
            spacing: self.spacing,
        };
        let stencil = Stencil::build(points);
        let support = FIT_SUPPORT * self.spacing;
        refit_all(&self.positions, &stencil.lists, support, &mut self.normals, &mut self.shapes);
        let films = [0..self.positions.len()];
        let spread = Spread {
            stencil: &stencil,
            positions: &self.positions,
            wall: &[],
            normals: &self.normals,
            films: &films,
            spacing: self.spacing,
        };
        let excess = spread.excess();
        let stop = StopRule { tolerance: 1e-3, max_iterations: 1000 };
        let moves = spread.moves(&excess, stop, &mut Workspace::default()).expect("converges");
        lift(&stencil, self.spacing, &mut self.positions, &self.normals, &self.shapes, &moves.displacement);
        unevenness(&excess)
    }

    fn mean_radius(&self) -> f64 {
        self.positions.iter().map(|p| p.0.length()).sum::<f64>() / self.positions.len() as f64
    }
}

#[test]
fn noise_is_spread_out_and_the_sphere_keeps_its_radius() {
    for (count, allowed) in [(500, 1e-4), (2000, 2e-5)] {
        let mut sphere = Sphere::noisy(count, 0.3);
        let first = sphere.pass();
        let last = (0..20).map(|_| sphere.pass()).last().unwrap();
        assert!(last < 0.2 * first, "{count}: {first} -> {last}");
        assert!((sphere.mean_radius() - 1.0).abs() < allowed, "{count}: {}", sphere.mean_radius() - 1.0);
    }
}
