//! What passes between the particle sets is neither made nor lost.
//!
//! # Equation
//! Gather: `V_E = sum_L w V_L`, `p_E = sum_L w V_L (u_L + A_L r)`. Scatter: `u_L = sum_E w u_E`, `A_L = B D^-1`. With
//! `sum_E w = 1` and `sum_E w r = 0`, on a plane both keep `sum V u` and
//! `sum V (x x u + sum_E w r x A r)`: the spin that the affine part stands for counts (Jiang 2015).
//!
//! # Limits
//! Near rims the weights are exact for constants only, to stay positive: liquid and surfactant are kept there, momentum
//! is not. On a sphere tangent planes differ, and a round trip loses a little.

use froth_components::authored::shape::{Place, Rectangle, Shape};
use froth_components::film::{LiquidVolume, SurfactantAmount, Warmth};
use froth_components::identity::InRegion;
use froth_components::motion::{Normal, Position, Velocity, VelocityGradient};
use froth_components::quantity::{Direction, Length};
use froth_systems::melp::gather::{Gathered, Material, gather_all, gather_scalar};
use froth_systems::melp::links::{Carriers, Link};
use froth_systems::melp::scatter::{Blend, CarrierFlow, Received, scatter_all};
use froth_systems::melp::tiles::{Rows, Site, Tile};
use froth_systems::operators::tangent::tangential;
use froth_systems::sampling::harmonic::Harmonic;
use glam::{DMat3, DVec3};

use super::finding::{Finding, Refinement};
use super::operators::sphere;
use super::sampled::{Sampled, symmetric};
use super::{Effort, LawError};

/// Round trips over which losses on a sphere are averaged.
const TRIPS: u32 = 10;
/// Material particles per carrier.
const LIQUID: usize = 8;

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let mut findings = on_a_plane()?;
    findings.extend(on_spheres(effort)?);
    Ok(findings)
}

/// Carriers, material particles, and the links between them.
struct Pair {
    carriers: Sampled,
    positions: Vec<Position>,
    normals: Vec<Normal>,
    regions: Vec<InRegion>,
    velocities: Vec<Velocity>,
    gradients: Vec<VelocityGradient>,
    volumes: Vec<LiquidVolume>,
    amounts: Vec<SurfactantAmount>,
    warmth: Vec<Warmth>,
    links: Vec<Link>,
}

/// Liquid, surfactant, momentum and angular momentum (per density).
#[derive(Clone, Copy, Default)]
struct Totals {
    liquid: f64,
    surfactant: f64,
    momentum: DVec3,
    angular: DVec3,
    energy: f64,
}

impl Pair {
    /// Links material particles at the given places, with their normals, to carriers.
    fn new(carriers: Sampled, places: Vec<(DVec3, DVec3)>) -> Self {
        let count = places.len();
        let share = |l: usize, use_: u64| 1.0 + 0.5 * symmetric(use_, l as u64);
        let mut pair = Self {
            positions: places.iter().map(|p| Position(p.0)).collect(),
            normals: places.iter().map(|p| Normal(p.1)).collect(),
            regions: vec![carriers.regions[0]; count],
            velocities: vec![Velocity::default(); count],
            gradients: vec![VelocityGradient::default(); count],
            volumes: (0..count).map(|l| LiquidVolume(1e-12 * share(l, 11))).collect(),
            amounts: (0..count).map(|l| SurfactantAmount(1e-10 * share(l, 12))).collect(),
            warmth: vec![Warmth::default(); count],
            links: Vec::new(),
            carriers,
        };
        let mut links = Vec::new();
        let _areas = gather_scalar(pair.carriers_of(), pair.rows(), &mut links, |_| 1.0);
        pair.links = links;
        pair
    }

    fn carriers_of(&self) -> Carriers<'_> {
        Carriers {
            positions: self.carriers.positions(),
            normals: &self.carriers.film.normals,
            regions: &self.carriers.regions,
            cells: &self.carriers.stencil.cells,
            spacing: self.carriers.spacing,
        }
    }

    fn rows(&self) -> Rows<'_> {
        Rows { positions: &self.positions, normals: &self.normals, regions: &self.regions }
    }

    fn gather(&self) -> Vec<Gathered> {
        let material = Material {
            rows: self.rows(),
            velocities: &self.velocities,
            gradients: &self.gradients,
            volumes: &self.volumes,
            surfactants: &self.amounts,
            warmth: &self.warmth,
        };
        gather_all(self.carriers_of(), material, &mut Vec::new())
    }

    fn scatter(&mut self, gathered: &[Gathered]) {
        let flow = |g: &Gathered| if g.volume > 0.0 { g.momentum / g.volume } else { DVec3::ZERO };
        let velocity: Vec<DVec3> = gathered.iter().map(flow).collect();
        let still = vec![DVec3::ZERO; velocity.len()];
        let concentration = vec![0.0; velocity.len()];
        let flow = CarrierFlow { velocity: &velocity, change: &still, drift: &[], concentration: &concentration };
        let (mut velocities, mut gradients) = (self.velocities.clone(), self.gradients.clone());
        let (mut shown, mut drift) = (vec![0.0; self.positions.len()], vec![DVec3::ZERO; self.positions.len()]);
        let blend = Blend { affine: true, flip: 0.0 };
        let received = Received {
            velocities: &mut velocities,
            gradients: &mut gradients,
            concentration: &mut shown,
            drift: &mut drift,
        };
        scatter_all(self.carriers_of(), flow, self.rows(), &self.links, blend, received);
        (self.velocities, self.gradients) = (velocities, gradients);
    }

    fn material_totals(&self) -> Totals {
        let carriers = self.carriers_of();
        let kernel = carriers.kernel();
        let mut tile = Tile::default();
        let mut totals = Totals::default();
        for (l, volume) in self.volumes.iter().enumerate() {
            let (x, n, u, a) = (self.positions[l].0, self.normals[l].0, self.velocities[l].0, self.gradients[l].0);
            let mut spin = DVec3::ZERO;
            tile.for_each(carriers, self.rows().part(l..l + 1), |tile, _| {
                tile.find_hits(&kernel, &Site::new(x, n));
                for hit in tile.hits() {
                    let r = self.carriers.positions()[tile.carrier(hit.slot).0].0 - x;
                    spin += r.cross(a * tangential(r, n)) * self.links[l].weight(hit);
                }
            });
            totals.liquid += volume.0;
            totals.surfactant += self.amounts[l].0;
            totals.momentum += u * volume.0;
            totals.angular += (x.cross(u) + spin) * volume.0;
            totals.energy += 0.5 * u.length_squared() * volume.0;
        }
        totals
    }

    fn carrier_totals(&self, gathered: &[Gathered]) -> Totals {
        let mut totals = Totals::default();
        for (g, x) in gathered.iter().zip(self.carriers.positions()) {
            totals.liquid += g.volume;
            totals.surfactant += g.surfactant;
            totals.momentum += g.momentum;
            totals.angular += x.0.cross(g.momentum);
        }
        totals
    }
}

const SIDE: f64 = 0.1;

/// Random motion on a flat film whose material keeps away from the rim.
fn on_a_plane() -> Result<Vec<Finding>, LawError> {
    let shape = Shape::Rectangle(Rectangle {
        centre: Place::ZERO,
        width: Length::from_si(SIDE),
        height: Length::from_si(SIDE),
        normal: Direction::Z,
        up: Direction::Y,
    });
    let mut carriers = Sampled::new(shape, 600)?;
    carriers.jitter(0.2);
    let margin = 0.5 * SIDE - 3.0 * carriers.spacing;
    let place = |l: u64, reach: f64| DVec3::new(reach * symmetric(21, l), reach * symmetric(22, l), 0.0);
    let scattered = |reach: f64| (0..4000).map(|l| (place(l, reach), DVec3::Z)).collect::<Vec<_>>();
    let whole = Pair::new(Sampled::new(shape, 600)?, scattered(0.5 * SIDE));
    let (all, gathered) = (whole.material_totals(), whole.gather());
    let kept = whole.carrier_totals(&gathered);

    let mut pair = Pair::new(carriers, scattered(margin));
    for l in 0..pair.velocities.len() {
        let random = |use_: u64| symmetric(use_, l as u64);
        pair.velocities[l].0 = DVec3::new(random(31) + 0.3, random(32), 0.0);
        let columns = [DVec3::new(random(33), random(34) + 0.5, 0.0), DVec3::new(random(35), random(36), 0.0)];
        pair.gradients[l].0 = DMat3::from_cols(columns[0], columns[1], DVec3::ZERO) * 50.0;
    }
    let before = pair.material_totals();
    let gathered = pair.gather();
    let between = pair.carrier_totals(&gathered);
    pair.scatter(&gathered);
    let after = pair.material_totals();
    let momentum = |a: Totals, b: Totals| (b.momentum - a.momentum).length() / a.momentum.length();
    let angular = |a: Totals, b: Totals| (b.angular - a.angular).length() / a.angular.length();
    Ok(vec![
        Finding::vanishing("plane: liquid lost in gathering, rims too", kept.liquid / all.liquid - 1.0, 1e-13),
        Finding::vanishing(
            "plane: surfactant lost in gathering, rims too",
            kept.surfactant / all.surfactant - 1.0,
            1e-13,
        ),
        Finding::vanishing("plane: linear momentum lost in gathering", momentum(before, between), 1e-12),
        Finding::vanishing("plane: linear momentum lost in scattering", momentum(between, after), 1e-12),
        Finding::vanishing("plane: angular momentum lost in gathering", angular(before, between), 1e-12),
        Finding::vanishing("plane: angular momentum lost in scattering", angular(between, after), 1e-12),
    ])
}

/// Rigid rotation and eddies on ever finer spheres: losses per round trip.
fn on_spheres(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let counts: &[usize] = effort.choose(&[500, 1000, 2000], &[1000, 2000, 4000]);
    let turn = |x: DVec3| DVec3::new(0.3, 1.0, -0.2).cross(x);
    let eddies = |degree: u32| {
        let harmonic = Harmonic::new(degree, 1);
        move |x: DVec3| x.cross(slope(&harmonic, x))
    };
    let (two, four) = (eddies(2), eddies(4));
    let flows: [(&str, &dyn Fn(DVec3) -> DVec3, f64); 3] =
        [("rigid rotation", &turn, 1e-4), ("eddies of degree 2", &two, 1e-3), ("eddies of degree 4", &four, 1e-2)];
    let mut losses: Vec<[Loss; 3]> = Vec::new();
    for count in counts {
        let mut pair = spherical_pair(*count)?;
        losses.push(flows.map(|(_, flow, _)| round_trips(&mut pair, flow)));
    }
    let refinement = |k: usize, f: fn(&Loss) -> f64| -> Refinement {
        counts.iter().zip(&losses).map(|(count, row)| (1.0 / (*count as f64).sqrt(), f(&row[k]))).collect()
    };
    let Some(finest) = losses.last() else { return Ok(Vec::new()) };
    let mut findings: Vec<Finding> = flows
        .iter()
        .enumerate()
        .map(|(k, (name, _, tolerance))| {
            let what = format!("sphere: energy of {name} lost per round trip");
            Finding::vanishing(what, finest[k].energy, *tolerance).converging(&refinement(k, |loss| loss.energy), 1.7)
        })
        .collect();
    let what = "sphere: angular momentum of rigid rotation lost per round trip";
    findings
        .push(Finding::vanishing(what, finest[0].angular, 1e-4).converging(&refinement(0, |loss| loss.angular), 1.7));
    Ok(findings)
}

/// Losses per round trip, relative.
struct Loss {
    energy: f64,
    angular: f64,
}

fn round_trips(pair: &mut Pair, flow: &dyn Fn(DVec3) -> DVec3) -> Loss {
    pair.set_flow(flow);
    // The first trip makes the velocity gradients, which the analytic flow comes without.
    let gathered = pair.gather();
    pair.scatter(&gathered);
    let before = pair.material_totals();
    for _ in 0..TRIPS {
        let gathered = pair.gather();
        pair.scatter(&gathered);
    }
    let after = pair.material_totals();
    let per_trip = |ratio: f64| -ratio.ln() / f64::from(TRIPS);
    Loss {
        energy: per_trip(after.energy / before.energy),
        angular: per_trip(after.angular.length() / before.angular.length()),
    }
}

impl Pair {
    /// Sets a flow, with no velocity gradients.
    fn set_flow(&mut self, flow: &dyn Fn(DVec3) -> DVec3) {
        let velocity = |(x, n): (&Position, &Normal)| Velocity(tangential(flow(x.0), n.0));
        self.velocities = self.positions.iter().zip(&self.normals).map(velocity).collect();
        self.gradients.fill(VelocityGradient::default());
    }
}

fn spherical_pair(count: usize) -> Result<Pair, LawError> {
    let carriers = Sampled::with_liquid(sphere(), count, LIQUID)?;
    let film = &carriers.film;
    let places = film.liquid_positions.iter().zip(&film.liquid_normals).map(|(x, n)| (x.0, n.0)).collect();
    let volumes = film.volumes.clone();
    let mut pair = Pair::new(carriers, places);
    pair.volumes = volumes;
    Ok(pair)
}

/// Gradient in space, by differences.
fn slope(harmonic: &Harmonic, x: DVec3) -> DVec3 {
    let step = 1e-5 * x.length();
    let along = |axis: DVec3| (harmonic.at(x + axis * step) - harmonic.at(x - axis * step)) / (2.0 * step);
    DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
}
