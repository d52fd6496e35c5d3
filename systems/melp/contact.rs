//! Where films of different bubbles touch: gaps, shared tension, and what keeps films apart.
//!
//! # Equation
//! Every closed film is a sheet of its own. A free sheet has the tension `2 sigma` of its two interfaces; where it lies on another
//! bubble's sheet the two are one film, and each keeps the one interface that faces its own gas. One energy says so:
//!
//! `E = sum_i a_i [ (2 - chi(g_i)) sigma_i + phi(g_i) ]`, `phi = k g^2/2` for `g < 0`,
//!
//! with the gap of carrier `i` to the sheets of all other bubbles, positive outside of them,
//!
//! `g_i = sum_j W_ij n_j . (x_i - x_j) / S_i`, `W = (1 - (r/h)^2)^3`, `S_i = sum_j W_ij`, `h = 2.5 dx`,
//!
//! `chi = 1` for `g <= 0`, `(1 - (g/delta)^2)^2` for `0 < g < delta`, 0 beyond; `delta = 1.6 dx`, `k = 4 sigma/dx^2`.
//!
//! `p_i = a_i dE/dg_i` pushes carrier `i` by `-p_i m_i`, `m_i = sum_j W_ij n_j / S_i`, and each `j` by `+p_i W_ij n_j / S_i`: action is
//! reaction. No junction is looked for and no film of the atmosphere: away from borders every film, free or shared, has `2 sigma` in
//! the end, all by the same operator, so they meet at 120 degrees.
//!
//! # Discretisation
//! The change of the weights with the gap is left out of the forces; so is all that is not along a carrier's own normal (the film's
//! plane is free to slide through its carriers). What this takes from the momentum of a cluster is given back to it as a whole.
//! The full gradient was tried: it makes the rounding of borders a line tension of `-0.9 dx 2 sigma`, and double bubbles of 1000 carriers
//! each meet at 126 degrees, of 4000 at 122; a line energy that cancels it is not steady under refinement.
//!
//! # Source
//! Replaces Deng 2022, sections 5.2 to 5.4. DEVIATION: the paper divides forces by coupling scores, which neither has an energy nor
//! keeps momentum, and finds junctions by thresholds.
//!
//! # Limits
//! Borders are rounded over two spacings: the area of the films near them is short by `1.07 dx` per length of border. Films on a
//! flat rim enclose no gas and have no outside: they touch nothing.

use super::frames::FilmFrames;
use super::near_films::{Boxes, clusters};
use super::state::FilmStencil;
use crate::clock::StepLimits;
use crate::neighbours::lists::NeighbourLists;
use crate::observe::{Fault, Faults, Observables};
use crate::operators::stencil::Stencil;
use crate::rows::columns;
use crate::stage::Stage;
use bevy_ecs::query::With;
use bevy_ecs::resource::Resource;
use bevy_ecs::system::{Query, Res, ResMut};
use froth_components::identity::InRegion;
use froth_components::kind::EulerianParticle;
use froth_components::lamella::{Lamella, Lamellae};
use froth_components::motion::{Normal, NormalSpeed, Position};
use glam::DVec3;

/// Reach of the gap's weights, in spacings.
const REACH: f64 = 2.5;
/// Gap at which two sheets begin to be one film, in spacings; more than 0.67 of [`REACH`] leaves too few carriers to measure it by.
///
/// Both together decide what angle the frozen weights leave at borders, at any resolution: outer films of an equal double bubble meet at
/// 117.9 degrees for 3 and 1.4, 118.8 for 2.5 and 1.4, 119.3 for these.
const BINDING: f64 = 1.6;
/// Stiffness of films pressed into each other, in `sigma/dx^2`: a bubble's own pressure presses them in by `dx^2/R`.
const STIFFNESS: f64 = 4.0;

/// Contacts of the carriers at their present places. Derived from columns and rebuilt in every substep, so no checkpoint holds it.
#[derive(Resource, Clone, Debug, Default)]
pub struct Contacts {
    /// Carriers of other bubbles in reach of each carrier; symmetric.
    pub lists: NeighbourLists,
    /// `W_ij` beside `lists.indices`; symmetric.
    pub weights: Vec<f64>,
    /// `1/S_i`, 0 where nothing is in reach.
    pub inverse_sums: Vec<f64>,
    /// `g_i`, m; infinite where nothing is in reach.
    pub gaps: Vec<f64>,
    /// `m_i . n_i`: how far the carrier's own motion along its normal opens its gap.
    pub own: Vec<f64>,
    /// `m_i`.
    pub directions: Vec<DVec3>,
    /// Films that are near each other's, as places in [`Lamellae::films`]: every film is in one of these.
    pub clusters: Vec<Vec<usize>>,
    /// Spacing, m.
    spacing: f64,
}

/// A carrier's gap and its weighted mean of the normals opposite.
#[derive(Clone, Copy)]
struct Gap {
    gap: f64,
    inverse_sum: f64,
    direction: DVec3,
}

impl Gap {
    const NONE: Self = Self { gap: f64::INFINITY, inverse_sum: 0.0, direction: DVec3::ZERO };
}

/// The law of two sheets at a gap, per area of one of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Binding {
    /// Part `chi` of the second interface that the other sheet stands in for, 0 to 1.
    pub share: f64,
    /// `dE/dg`, Pa: positive where the sheets draw each other on.
    pub pull: f64,
    /// Where positive, `d2E/dg2`, Pa/m; else 0.
    pub stiffness: f64,
}

impl Binding {
    /// Of a sheet with surface tension `sigma` (N/m, one interface) at `gap` from another, on films of a given spacing.
    #[must_use]
    pub fn at(gap: f64, sigma: f64, spacing: f64) -> Self {
        let delta = BINDING * spacing;
        let y = gap / delta;
        if y >= 1.0 {
            return Self { share: 0.0, pull: 0.0, stiffness: 0.0 };
        }
        if y <= 0.0 {
            let stiffness = STIFFNESS * sigma / (spacing * spacing);
            return Self { share: 1.0, pull: stiffness * gap, stiffness };
        }
        let rest = 1.0 - y * y;
        let stiffness = sigma * (4.0 - 12.0 * y * y) / (delta * delta);
        Self { share: rest * rest, pull: 4.0 * sigma * y * rest / delta, stiffness: stiffness.max(0.0) }
    }
}

impl Contacts {
    /// Looks for contacts between films that enclose gas. `stencil` holds the carriers' cells.
    pub fn find(&mut self, positions: &[Position], normals: &[Normal], stencil: &Stencil, lamellae: &Lamellae) {
        let reach = REACH * lamellae.spacing;
        self.spacing = lamellae.spacing;
        let boxes = Boxes::around(positions, lamellae, 0.5 * reach);
        let near = boxes.near();
        self.clusters = clusters(&near);
        let mut film_of = vec![0_u32; positions.len()];
        for (k, film) in lamellae.films.iter().enumerate() {
            film_of[film.carriers.clone()].fill(k as u32);
        }
        let found = NeighbourLists::collect_beside(positions.len(), |i, found, weights: &mut Vec<f64>| {
            let place = positions[i].0;
            let others = &near[film_of[i] as usize];
            if !others.iter().any(|&other| boxes.holds(other as usize, place)) {
                return Gap::NONE;
            }
            let (mut sum, mut gap, mut direction) = (0.0, 0.0, DVec3::ZERO);
            stencil.cells.for_each_near(place, reach, |j| {
                let offset = place - positions[j].0;
                let q = offset.length_squared() / (reach * reach);
                if q >= 1.0 || others.binary_search(&film_of[j]).is_err() {
                    return;
                }
                let (weight, n) = ((1.0 - q).powi(3), normals[j].0);
                found.push(j as u32);
                weights.push(weight);
                sum += weight;
                gap += weight * n.dot(offset);
                direction += n * weight;
            });
            if sum > 0.0 {
                Gap { gap: gap / sum, inverse_sum: 1.0 / sum, direction: direction / sum }
            } else {
                Gap::NONE
            }
        });
        let gaps;
        (self.lists, self.weights, gaps) = found;
        self.gaps = gaps.iter().map(|found| found.gap).collect();
        self.inverse_sums = gaps.iter().map(|found| found.inverse_sum).collect();
        self.directions = gaps.iter().map(|found| found.direction).collect();
        self.own = gaps.iter().zip(normals).map(|(found, n)| found.direction.dot(n.0)).collect();
    }

    /// Forgets all contacts: every film is alone.
    pub fn clear(&mut self, films: usize) {
        *self = Self { clusters: (0..films).map(|film| vec![film]).collect(), ..Self::default() };
    }

    /// Whether no carrier is near another bubble's.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.lists.indices.is_empty()
    }

    /// The law at carrier `i`, whose surface tension is `sigma`, N/m.
    #[must_use]
    pub fn binding(&self, i: usize, sigma: f64) -> Binding {
        Binding::at(self.gaps.get(i).copied().unwrap_or(f64::INFINITY), sigma, self.spacing)
    }

    /// `k`: stiffness of a sheet with surface tension `sigma` (N/m) pressed into another, Pa/m.
    #[must_use]
    pub fn stiffness(&self, sigma: f64) -> f64 {
        STIFFNESS * sigma / (self.spacing * self.spacing)
    }

    /// Part `chi` of its second interface that carrier `i` leaves to another bubble's sheet, 0 to 1.
    #[must_use]
    pub fn share(&self, i: usize) -> f64 {
        self.binding(i, 1.0).share
    }

    /// Part of the two interfaces of a film that carrier `i` has, `1 - chi/2`: half of them where another bubble's sheet is the other half.
    #[must_use]
    pub fn interfaces(&self, i: usize) -> f64 {
        1.0 - 0.5 * self.share(i)
    }

    /// `(J s)_i`: rate at which gap `i` opens when carriers move along their normals at `speeds`, m/s.
    #[must_use]
    #[inline]
    pub fn opening(&self, i: usize, speeds: &[f64]) -> f64 {
        let opposite: f64 = self.weighted(i).map(|(j, w)| w * speeds[j]).sum();
        self.own[i] * speeds[i] - self.inverse_sums[i] * opposite
    }

    /// The same for carriers that all move as `velocity` says.
    #[must_use]
    pub fn opening_of(&self, i: usize, normals: &[Normal], velocity: impl Fn(usize) -> DVec3) -> f64 {
        let opposite: f64 = self.weighted(i).map(|(j, w)| w * velocity(j).dot(normals[j].0)).sum();
        self.directions[i].dot(velocity(i)) - self.inverse_sums[i] * opposite
    }

    /// `(J^T p)_i`: what gap pressures `p` (N) do along the normal of carrier `i`.
    #[must_use]
    #[inline]
    pub fn pressed(&self, i: usize, p: &[f64]) -> f64 {
        let opposite: f64 = self.weighted(i).map(|(j, w)| w * self.inverse_sums[j] * p[j]).sum();
        self.own[i] * p[i] - opposite
    }

    /// `(J^T Y J)_ii`.
    #[must_use]
    pub fn yielding_on(&self, i: usize, yielding: &[f64]) -> f64 {
        let opposite: f64 = self.weighted(i).map(|(j, w)| (w * self.inverse_sums[j]).powi(2) * yielding[j]).sum();
        self.own[i].powi(2) * yielding[i] + opposite
    }

    /// `(j, W_ij)` over the carriers opposite `i`.
    #[inline]
    fn weighted(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.lists.range(i);
        self.lists.indices[range.clone()].iter().map(|&j| j as usize).zip(self.weights[range].iter().copied())
    }

    /// How deep sheets reach into other bubbles, at most, m.
    #[must_use]
    pub fn deepest(&self) -> f64 {
        self.gaps.iter().fold(0.0, |deepest: f64, gap| deepest.max(-gap))
    }
}

/// Depth beyond which sheets have passed through each other, in spacings.
const TOO_DEEP: f64 = 1.5;
/// Farthest that two sheets near each other may approach in a substep, in spacings.
const LONGEST_APPROACH: f64 = 0.2;

/// Looks for contacts between the films where they stand.
pub fn find_contacts(
    carriers: Query<(&Position, &Normal), With<EulerianParticle>>,
    stencil: Res<FilmStencil>,
    lamellae: Res<Lamellae>,
    mut contacts: ResMut<Contacts>,
    mut observables: ResMut<Observables>,
    mut faults: ResMut<Faults>,
) {
    if lamellae.films.len() < 2 {
        contacts.clear(lamellae.films.len());
        return;
    }
    let (positions, normals) = columns(&carriers);
    contacts.find(positions, normals, &stencil.0, &lamellae);
    let depth = contacts.deepest() / lamellae.spacing;
    observables.raise("contact_depth", "1", depth);
    if depth > TOO_DEEP {
        let row = (0..positions.len()).min_by(|a, b| contacts.gaps[*a].total_cmp(&contacts.gaps[*b])).unwrap_or(0);
        let detail = format!(
            "reach {depth:.1} spacings into each other: bubbles that start inside each other, or met too fast for their particles; \
             move them apart, or use more particles"
        );
        faults.report(Fault::new(Stage::Geometry, "films", detail).on_particle("eulerian", row, None));
    }
}

/// Substeps of a step while films are near each other: as walls spread, carriers must be spread after them, which happens once in a step.
/// With 2, bubbles of 500 carriers are lost as they rebound; with 8, carriers of bubbles of 1500 lose all their liquid.
const MOST_SUBSTEPS: u32 = 1;

/// Substep of films near each other, in that of films alone: carriers at borders and the pull of closing gaps are stiffer. Two bubbles of 500
/// carriers each rebound and are lost with 1, and hold with 0.5.
const SUBSTEP_PART: f64 = 0.4;

/// Proposes substeps in which no sheet near another approaches it by more than a fifth of a spacing.
pub fn limit_step_by_approach(
    carriers: Query<(&Position, &Normal, &NormalSpeed), With<EulerianParticle>>,
    lamellae: Res<Lamellae>,
    frames: Res<FilmFrames>,
    mut limits: ResMut<StepLimits>,
) {
    let (positions, normals, speeds) = columns(&carriers);
    let near = Boxes::around(positions, &lamellae, 0.5 * REACH * lamellae.spacing).near();
    let mut fastest = 0.0_f64;
    for cluster in clusters(&near).iter().filter(|cluster| cluster.len() > 1) {
        let films = || cluster.iter().map(|&film| &lamellae.films[film]);
        let frame_of = |film: &Lamella| frames.of(InRegion(film.region));
        let mean = films().map(frame_of).sum::<DVec3>() / cluster.len() as f64;
        for film in films() {
            let rows = film.carriers.clone();
            fastest = rows.map(|i| (speeds[i].0 - mean.dot(normals[i].0)).abs()).fold(fastest, f64::max);
        }
    }
    if near.iter().any(|others| !others.is_empty()) {
        limits.shorten_substeps("films in contact", SUBSTEP_PART, MOST_SUBSTEPS);
    }
    if fastest > 0.0 {
        let substep = LONGEST_APPROACH * lamellae.spacing / (2.0 * fastest);
        limits.propose_for_substeps("approach of films", substep, MOST_SUBSTEPS);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operators::stencil::Points;
    use crate::sampling::spread::sphere_cap;
    use froth_components::identity::RegionId;

    #[test]
    fn pull_and_stiffness_are_the_slopes_of_the_energy() {
        let (sigma, spacing, h) = (0.03, 2e-3, 1e-9);
        let energy = |g: f64| {
            let inside = g.min(0.0);
            (2.0 - Binding::at(g, sigma, spacing).share) * sigma + 0.5 * STIFFNESS * sigma * (inside / spacing).powi(2)
        };
        for gap in [-2e-3, -3e-4, 3e-4, 1e-3, 2e-3, 2.7e-3, 4e-3] {
            let law = Binding::at(gap, sigma, spacing);
            let slope = (energy(gap + h) - energy(gap - h)) / (2.0 * h);
            assert!((law.pull - slope).abs() < 1e-4 * sigma / spacing, "{gap}: {} {slope}", law.pull);
            let pull = |g: f64| Binding::at(g, sigma, spacing).pull;
            let bend = (pull(gap + h) - pull(gap - h)) / (2.0 * h);
            assert!((law.stiffness - bend.max(0.0)).abs() < 1e-4 * sigma / (spacing * spacing), "{gap}");
        }
    }

    /// Two spheres of radius 1 whose centres are `apart`, and the contacts between them.
    fn pair(apart: f64) -> (Contacts, Vec<Normal>) {
        let count = 800;
        let normals: Vec<Normal> = (0..2).flat_map(|_| sphere_cap(count, -1.0).map(Normal)).collect();
        let centre = |i: usize| DVec3::X * if i < count { 0.0 } else { apart };
        let positions: Vec<Position> = normals.iter().enumerate().map(|(i, n)| Position(n.0 + centre(i))).collect();
        let regions: Vec<InRegion> = (0..2 * count).map(|i| InRegion(RegionId(1 + (i / count) as u32))).collect();
        let spacing = (4.0 * std::f64::consts::PI / count as f64).sqrt();
        let (x, n, r) = (&positions[..], &normals[..], &regions[..]);
        let stencil =
            Stencil::build(Points { positions: x, normals: n, regions: r, wall: &[], wall_regions: &[], spacing });
        let film = |k: usize| Lamella {
            region: RegionId(1 + k as u32),
            carriers: k * count..(k + 1) * count,
            material: 0..0,
            rim: None,
            size: 1.0,
            centre: centre(k * count),
            air_mass: 0.0,
        };
        let lamellae = Lamellae { films: vec![film(0), film(1)], spacing };
        let mut contacts = Contacts::default();
        contacts.find(x, n, &stencil, &lamellae);
        (contacts, normals)
    }

    #[test]
    fn the_gap_between_spheres_is_their_distance() {
        for apart in [1.97, 2.0, 2.06] {
            let (contacts, normals) = pair(apart);
            let facing = (0..800).max_by(|a, b| normals[*a].0.x.total_cmp(&normals[*b].0.x)).expect("carriers");
            // The tangent planes of a sphere lie outside it: the mean over the reach takes off a part of its sagitta.
            let sagitta = apart - 2.0 - contacts.gaps[facing];
            assert!((0.0..0.06).contains(&sagitta), "{apart}: {}", contacts.gaps[facing]);
            assert_eq!(contacts.clusters, [vec![0, 1]]);
        }
        let (contacts, _) = pair(2.7);
        assert!(contacts.is_empty() && contacts.clusters == [vec![0], vec![1]]);
    }

    #[test]
    fn action_is_reaction() {
        let (contacts, normals) = pair(1.96);
        let wave = |i: usize, pitch: f64| (pitch * i as f64).sin();
        let (speeds, pressures): (Vec<f64>, Vec<f64>) = (0..1600).map(|i| (wave(i, 0.7), wave(i, 1.9))).unzip();
        // The power of gap pressures is what they do to the carriers: `p . J s = s . J^T p`.
        let power: f64 = (0..1600).map(|i| pressures[i] * contacts.opening(i, &speeds)).sum();
        let done: f64 = (0..1600).map(|i| speeds[i] * contacts.pressed(i, &pressures)).sum();
        assert!(power.abs() > 0.1 && (power - done).abs() < 1e-12 * power.abs(), "{power} {done}");
        // Bubbles that move as one open no gap.
        let still = (0..1600).map(|i| contacts.opening_of(i, &normals, |_| DVec3::Y).abs()).fold(0.0, f64::max);
        assert!(still < 1e-12, "{still:e}");
    }
}
