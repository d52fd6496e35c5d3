//! Turns authored films into particles.
//!
//! Carriers are spread over the shape, perturbed, then redistributed until they are even. Material particles are laid
//! on the carriers' film; the area each stands for is iterated until gathering it gives back the carriers' dual areas,
//! so that a uniform film starts uniform to the last per mille of sampling noise.

use super::carriers::refit;
use super::frames::FilmFrames;
use super::gather::gather_scalar;
use super::links::Carriers;
use super::material::{MovingMaterial, advance_all};
use super::measure::{dual_areas, enclosed_volume};
use super::redistribution::{EVEN_ENOUGH, Spread, lift, unevenness};
use super::scatter::interpolate;
use super::tiles::Rows;
use crate::operators::conjugate_gradient::{NotConverged, StopRule, Workspace};
use crate::operators::stencil::{Points, Stencil};
use crate::operators::tangent::tangential;
use crate::rows::morton::morton_code;
use crate::sampling::field::Extent;
use crate::sampling::surface::{FilmPoint, Perturbation, Surface};
use froth_components::authored::film::Film;
use froth_components::authored::motion::{Drift, Spin, Swirl};
use froth_components::authored::shape::Shape;
use froth_components::film::{LiquidVolume, ShapeOperator, SurfactantAmount};
use froth_components::identity::{InRegion, RegionId};
use froth_components::lamella::Rim;
use froth_components::motion::{Normal, Position, Velocity, VelocityGradient};
use glam::DVec3;
use rayon::prelude::*;

/// Most redistribution passes before the start.
const SPREADING_PASSES: usize = 60;
/// Iterations of the material particles' areas.
const AREA_ITERATIONS: usize = 20;

/// An authored film with everything its entity says.
#[derive(Clone, Copy)]
pub struct AuthoredFilm {
    /// Its shape.
    pub shape: Shape,
    /// Its film.
    pub film: Film,
    /// Displacement of the shape.
    pub perturbation: Perturbation,
    /// Seed of noise that the scene does not seed itself.
    pub seed: u32,
    /// Initial motion.
    pub drift: Option<Drift>,
    /// Initial rotation of the liquid.
    pub spin: Option<Spin>,
    /// Initial swirl of the liquid.
    pub swirl: Option<Swirl>,
}

/// One film as columns, ready to be spawned.
#[derive(Default)]
pub struct DiscreteFilm {
    /// Carriers: places.
    pub positions: Vec<Position>,
    /// Carriers: normals.
    pub normals: Vec<Normal>,
    /// Carriers: shape operators.
    pub shapes: Vec<ShapeOperator>,
    /// Carriers: normal speeds, m/s.
    pub speeds: Vec<f64>,
    /// Carriers: concentration, mol/m^2.
    pub concentration: Vec<f64>,
    /// Carriers: thickness, m. A film without material particles keeps it.
    pub carrier_thickness: Vec<f64>,
    /// Boundary particles.
    pub wall: Vec<Position>,
    /// Material: places.
    pub liquid_positions: Vec<Position>,
    /// Material: normals.
    pub liquid_normals: Vec<Normal>,
    /// Material: velocities.
    pub liquid_velocities: Vec<Velocity>,
    /// Material: liquid volumes.
    pub volumes: Vec<LiquidVolume>,
    /// Material: surfactant amounts.
    pub amounts: Vec<SurfactantAmount>,
    /// Material: thickness, m.
    pub thickness: Vec<f64>,
    /// Rim.
    pub rim: Option<Rim>,
    /// Size, m.
    pub size: f64,
    /// Centre of the shape, m.
    pub centre: DVec3,
    /// Enclosed volume of a closed film, m^3.
    pub volume: f64,
    /// Mean of `2 kappa` over the film per N/m of interface tension, 1/m: its excess pressure at rest.
    pub twice_curvature: f64,
}

/// What a film is sampled with.
#[derive(Clone, Copy, Debug)]
pub struct Sampling {
    /// Spacing of the carriers, m.
    pub spacing: f64,
    /// Material particles per carrier; 0 for a film that carries no flow.
    pub liquid_per_carrier: usize,
    /// Concentration at rest, mol/m^2.
    pub reference_surfactant: f64,
}

impl DiscreteFilm {
    /// Samples one film as region `region`.
    ///
    /// # Errors
    /// [`NotConverged`] if the carriers could not be spread evenly.
    pub fn sample(authored: &AuthoredFilm, region: RegionId, sampling: Sampling) -> Result<Self, NotConverged> {
        let surface = Surface::new(authored.shape, authored.perturbation);
        let count = (authored.shape.area() / sampling.spacing.powi(2)).round() as usize;
        let region = InRegion(region);
        let mut film = Self {
            rim: surface.rim(),
            size: authored.shape.size(),
            centre: authored.shape.centre(),
            ..Self::default()
        };
        film.wall = surface.wall(sampling.spacing).into_iter().map(Position).collect();
        film.place_carriers(&in_morton_order(surface.points(count, true), sampling.spacing), region, sampling.spacing)?;
        let stencil = film.stencil(region, sampling.spacing);
        film.measure(&stencil);
        film.set_carrier_fields(authored, sampling);
        if sampling.liquid_per_carrier == 0 {
            return Ok(film);
        }
        let liquid = in_morton_order(surface.points(count * sampling.liquid_per_carrier, false), sampling.spacing);
        film.place_liquid(&liquid, authored, region, sampling, &stencil);
        Ok(film)
    }

    fn points<'a>(&'a self, regions: &'a [InRegion], wall_regions: &'a [InRegion], spacing: f64) -> Points<'a> {
        Points { positions: &self.positions, normals: &self.normals, regions, wall: &self.wall, wall_regions, spacing }
    }

    fn stencil(&self, region: InRegion, spacing: f64) -> Stencil {
        let regions = vec![region; self.positions.len()];
        let wall_regions = vec![region; self.wall.len()];
        Stencil::build(self.points(&regions, &wall_regions, spacing))
    }

    fn place_carriers(&mut self, points: &[FilmPoint], region: InRegion, spacing: f64) -> Result<(), NotConverged> {
        self.positions = points.iter().map(|p| Position(p.position)).collect();
        self.normals = points.iter().map(|p| Normal(p.normal)).collect();
        self.shapes = vec![ShapeOperator::default(); points.len()];
        let stop = StopRule { tolerance: 1e-3, max_iterations: 20_000 };
        let mut work = Workspace::default();
        for _ in 0..SPREADING_PASSES {
            let stencil = self.stencil(region, spacing);
            refit(&stencil, spacing, &self.positions, &mut self.normals, &mut self.shapes);
            let films = [0..self.positions.len()];
            let spread = Spread {
                stencil: &stencil,
                positions: &self.positions,
                wall: &self.wall,
                normals: &self.normals,
                films: &films,
                spacing,
            };
            let excess = spread.excess();
            if unevenness(&excess) < 0.5 * EVEN_ENOUGH {
                break;
            }
            let moves = spread.moves(&excess, stop, &mut work)?;
            lift(&stencil, spacing, &mut self.positions, &self.normals, &self.shapes, &moves.displacement);
        }
        let stencil = self.stencil(region, spacing);
        refit(&stencil, spacing, &self.positions, &mut self.normals, &mut self.shapes);
        Ok(())
    }

    fn measure(&mut self, stencil: &Stencil) {
        // Rows next to a rim see the film on one side only.
        let inner = || (0..stencil.len()).filter(|i| stencil.wall_lists.of(*i).is_empty());
        let area: f64 = inner().map(|i| stencil.areas[i]).sum();
        let pull = |i: usize| stencil.weighted_offsets(&self.positions, i).map(|(_, w, d)| d * w).sum::<DVec3>();
        let curvature: f64 = inner().map(|i| -pull(i).dot(self.normals[i].0)).sum();
        self.twice_curvature = 2.0 * curvature / area;
        self.volume = enclosed_volume(&self.positions, &self.normals, &stencil.areas, 0..stencil.len(), self.centre);
    }

    fn set_carrier_fields(&mut self, authored: &AuthoredFilm, sampling: Sampling) {
        let places: Vec<DVec3> = self.positions.iter().map(|p| p.0).collect();
        let extent = Extent { places: &places, centre: authored.shape.centre(), size: self.size, seed: authored.seed };
        self.carrier_thickness = extent.thickness(&authored.film.thickness);
        self.concentration = extent.concentration(&authored.film, &self.carrier_thickness);
        self.concentration.iter_mut().for_each(|gamma| *gamma *= sampling.reference_surfactant);
        let drift = authored.drift.map_or(DVec3::ZERO, |drift| drift.0.si());
        self.speeds = self.normals.iter().map(|n| n.0.dot(drift)).collect();
    }

    fn place_liquid(
        &mut self,
        points: &[FilmPoint],
        authored: &AuthoredFilm,
        region: InRegion,
        sampling: Sampling,
        stencil: &Stencil,
    ) {
        let regions = vec![region; self.positions.len()];
        let carriers = Carriers {
            positions: &self.positions,
            normals: &self.normals,
            regions: &regions,
            cells: &stencil.cells,
            spacing: sampling.spacing,
        };
        let duals = dual_areas(carriers, &stencil.areas);
        let liquid_regions = vec![region; points.len()];
        let mut positions: Vec<Position> = points.iter().map(|p| Position(p.position)).collect();
        let mut normals: Vec<Normal> = points.iter().map(|p| Normal(p.normal)).collect();
        let mut still = vec![Velocity::default(); points.len()];
        let mut gradients = vec![VelocityGradient::default(); points.len()];
        let moving = MovingMaterial {
            positions: &mut positions,
            normals: &mut normals,
            drift: &vec![DVec3::ZERO; points.len()],
            velocities: &mut still,
            gradients: &mut gradients,
            regions: &liquid_regions,
        };
        let rim = self.rim;
        advance_all(moving, carriers, &self.shapes, 0.0, &FilmFrames::default(), |_| rim);
        let rows = Rows { positions: &positions, normals: &normals, regions: &liquid_regions };
        let areas = fair_areas(carriers, &duals, rows);
        let places: Vec<DVec3> = positions.iter().map(|p| p.0).collect();
        let extent = Extent { places: &places, centre: authored.shape.centre(), size: self.size, seed: authored.seed };
        self.thickness = extent.thickness(&authored.film.thickness);
        let concentration = extent.concentration(&authored.film, &self.thickness);
        let gamma = |l: usize| sampling.reference_surfactant * concentration[l];
        self.volumes = self.thickness.iter().zip(&areas).map(|(eta, a)| LiquidVolume(eta * a)).collect();
        self.amounts = areas.iter().enumerate().map(|(l, a)| SurfactantAmount(a * gamma(l))).collect();
        let gathered = gather_scalar(carriers, rows, &mut Vec::new(), |l| areas[l] * gamma(l));
        self.concentration = gathered.iter().zip(&duals).map(|(s, a)| s / a).collect();
        self.liquid_velocities = initial_flow(&extent, &normals, authored);
        self.liquid_positions = positions;
        self.liquid_normals = normals;
    }
}

/// The points as rows are kept: near ones mostly near each other.
fn in_morton_order(points: Vec<FilmPoint>, spacing: f64) -> Vec<FilmPoint> {
    let origin = points.iter().fold(DVec3::INFINITY, |low, p| low.min(p.position));
    let code = |i: &usize| (morton_code(points[*i].position, origin, spacing), *i);
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.par_sort_by_cached_key(code);
    order.into_iter().map(|i| points[i]).collect()
}

/// Areas of the material particles which, gathered, give the carriers' dual areas.
fn fair_areas(carriers: Carriers, duals: &[f64], rows: Rows) -> Vec<f64> {
    let whole: f64 = duals.iter().sum();
    let mut areas = vec![whole / rows.positions.len() as f64; rows.positions.len()];
    let mut links = Vec::new();
    for _ in 0..AREA_ITERATIONS {
        let gathered = gather_scalar(carriers, rows, &mut links, |l| areas[l]);
        let ratio = interpolate(carriers, rows, &links, |e| duals[e] / gathered[e]);
        areas.iter_mut().zip(&ratio).for_each(|(a, r)| *a *= r);
    }
    areas
}

fn initial_flow(extent: &Extent, normals: &[Normal], authored: &AuthoredFilm) -> Vec<Velocity> {
    let drift = authored.drift.map_or(DVec3::ZERO, |drift| drift.0.si());
    let plain: Vec<DVec3> = normals.iter().map(|n| n.0).collect();
    let flow = extent.flow(&plain, authored.spin.as_ref(), authored.swirl.as_ref());
    flow.into_iter().zip(&plain).map(|(u, n)| Velocity(tangential(u + drift, *n))).collect()
}
