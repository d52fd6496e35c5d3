//! The films of a cluster made of particles: which carriers make up each film, and the sphere that fits it.
//!
//! # Equation
//! A sphere or plane is `F(x) = kappa |x|^2/2 + b . x + c = 0` with `|b|^2 - 2 kappa c = 1`: `F` is the distance from it to first
//! order, `kappa` half its mean curvature `1/R`, 0 for a plane. Two of them cut each other everywhere at the angle whose cosine is
//! `b1 . b2 - kappa1 c2 - kappa2 c1`.
//!
//! # Discretisation
//! Carriers that share nothing are of the free film of their bubble; carriers that share all are of the wall to the bubble opposite,
//! whose carriers there are of the same film. Those within four spacings of another film are left out: borders are rounded.

use std::collections::{BTreeMap, BTreeSet};

use froth_components::identity::InRegion;
use froth_components::kind::EulerianParticle;
use froth_components::lamella::Lamellae;
use froth_components::motion::{Normal, Position};
use froth_systems::melp::contact::Contacts;
use froth_systems::neighbours::cells::CellList;
use glam::{DMat4, DVec3, DVec4};

use crate::simulation::Simulation;

/// Carriers nearer to another film than this do not count, in spacings.
const CLEAR: f64 = 4.0;
/// Carriers whose share is between this and one less it are of a border.
const SURE: f64 = 0.02;

/// Two regions, the smaller number first; 0 is the outside.
pub(super) type Pair = (u32, u32);

/// A sphere or plane fitted to a film; its normal points from the region of the larger number to that of the smaller, so out of
/// bubbles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sphere {
    /// `1/R`, 1/m: positive for a film that is round seen from the side its normal points to.
    pub(super) curvature: f64,
    slope: DVec3,
    constant: f64,
}

impl Sphere {
    /// Least squares through places, whose normals say how it is turned. `None` for too few.
    fn fit(places: &[DVec3], normals: &[DVec3]) -> Option<Self> {
        let mean = normals.iter().sum::<DVec3>().normalize_or_zero();
        let nearest = |a: &&DVec3, b: &&DVec3| a.dot(mean).total_cmp(&b.dot(mean));
        let n = *normals.iter().max_by(nearest)?;
        let origin = places[normals.iter().position(|m| *m == n)?];
        let (t1, t2) = n.any_orthonormal_pair();
        let (mut matrix, mut right) = (DMat4::ZERO, DVec4::ZERO);
        let size = places.iter().map(|x| x.distance(origin)).fold(0.0, f64::max);
        for x in places {
            let r = (*x - origin) / size;
            let row = DVec4::new(0.5 * r.length_squared(), r.dot(t1), r.dot(t2), 1.0);
            matrix += DMat4::from_cols(row * row.x, row * row.y, row * row.z, row * row.w);
            right -= row * r.dot(n);
        }
        let found = matrix.inverse() * right;
        let (curvature, slope, constant) = (found.x / size, n + t1 * found.y + t2 * found.z, found.w * size);
        let scale = (slope.length_squared() - 2.0 * curvature * constant).sqrt();
        let sphere = Self { curvature: curvature / scale, slope: slope / scale, constant: constant / scale };
        (places.len() > 4 && scale.is_finite()).then(|| sphere.seen_from(origin))
    }

    /// The same sphere given from the origin of coordinates instead of `origin`.
    fn seen_from(self, origin: DVec3) -> Self {
        let slope = self.slope - origin * self.curvature;
        let constant = self.constant - self.slope.dot(origin) + 0.5 * self.curvature * origin.length_squared();
        Self { slope, constant, ..self }
    }

    /// Distance of a place from it, m, to first order.
    pub(super) fn distance(&self, x: DVec3) -> f64 {
        0.5 * self.curvature * x.length_squared() + self.slope.dot(x) + self.constant
    }

    /// Its normal at a place on it.
    pub(super) fn normal(&self, x: DVec3) -> DVec3 {
        self.slope + x * self.curvature
    }

    /// Cosine of the angle between the normals of two, where they cut each other.
    fn cosine(&self, other: &Self) -> f64 {
        self.slope.dot(other.slope) - self.curvature * other.constant - other.curvature * self.constant
    }
}

/// The films of a cluster.
pub(super) struct FittedFilms {
    films: BTreeMap<Pair, Sphere>,
    /// Area of the films, a wall counted once, m^2.
    pub(super) area: f64,
}

impl FittedFilms {
    /// Of the bubbles as they stand.
    pub(super) fn of(simulation: &mut Simulation) -> Self {
        let positions = simulation.column::<EulerianParticle, Position>();
        let normals = simulation.column::<EulerianParticle, Normal>();
        let regions = simulation.column::<EulerianParticle, InRegion>();
        let areas = simulation.column::<EulerianParticle, froth_components::film::Area>();
        let (contacts, spacing) =
            (simulation.world().resource::<Contacts>(), simulation.world().resource::<Lamellae>().spacing);
        let film: Vec<Option<Pair>> = (0..positions.len()).map(|i| film_of(contacts, &regions, i)).collect();
        let clear = CLEAR * spacing;
        let cells = CellList::build(&positions, 0.5 * clear);
        let mut members: BTreeMap<Pair, (Vec<DVec3>, Vec<DVec3>)> = BTreeMap::new();
        for i in 0..positions.len() {
            let Some(own) = film[i] else { continue };
            let (x, mut is_clear) = (positions[i].0, true);
            cells.for_each_near(x, clear, |j| {
                is_clear &= film[j] == film[i] || positions[j].0.distance(x) > clear;
            });
            if is_clear {
                let outward = if regions[i].0.0 == own.1 { 1.0 } else { -1.0 };
                let (places, directions) = members.entry(own).or_default();
                places.push(x);
                directions.push(normals[i].0 * outward);
            }
        }
        let fitted = members.iter().filter_map(|(pair, (x, n))| Some((*pair, Sphere::fit(x, n)?)));
        let area = areas.iter().enumerate().map(|(i, a)| a.0 * contacts.interfaces(i)).sum();
        Self { films: fitted.collect(), area }
    }

    /// The film between two regions.
    pub(super) fn between(&self, a: u32, b: u32) -> Option<&Sphere> {
        self.films.get(&(a.min(b), a.max(b)))
    }

    /// Every angle between two films where three regions meet, in degrees: the region it is in, and the two others.
    pub(super) fn angles(&self) -> Vec<([u32; 3], f64)> {
        let regions: BTreeSet<u32> = self.films.keys().flat_map(|pair| [pair.0, pair.1]).collect();
        let mut angles = Vec::new();
        for &r in &regions {
            for &s in regions.iter().filter(|&&s| s != r) {
                for &t in regions.iter().filter(|&&t| t > s && t != r) {
                    if let (Some(a), Some(b), Some(_)) = (self.between(r, s), self.between(r, t), self.between(s, t)) {
                        // Normals out of `r`.
                        let turned = if (r > s) == (r > t) { 1.0 } else { -1.0 };
                        let cosine = turned * a.cosine(b);
                        angles.push(([r, s, t], 180.0 - cosine.clamp(-1.0, 1.0).acos().to_degrees()));
                    }
                }
            }
        }
        angles
    }

    /// The angles between the four borders at the point where four regions meet, in degrees, or nothing where a film is missing.
    pub(super) fn corner_angles(&self, regions: [u32; 4], near: DVec3) -> Vec<f64> {
        let mut x = near;
        let pairs = || (0..4).flat_map(|a| (a + 1..4).map(move |b| (a, b)));
        for _ in 0..20 {
            let (mut matrix, mut right) = (glam::DMat3::ZERO, DVec3::ZERO);
            for (a, b) in pairs() {
                let Some(film) = self.between(regions[a], regions[b]) else { return Vec::new() };
                let n = film.normal(x);
                matrix += froth_systems::operators::tangent::outer(1.0, n, n);
                right -= n * film.distance(x);
            }
            x += matrix.inverse() * right;
        }
        let out_of = |r: u32, s: u32| {
            let n = self.between(r, s).map_or(DVec3::ZERO, |film| film.normal(x));
            if r > s { n } else { -n }
        };
        // The border that region `k` has no part in runs away from it.
        let border = |k: usize| {
            let [r, s, t] = [1, 2, 3].map(|step| regions[(k + step) % 4]);
            let along = out_of(r, s).cross(out_of(r, t)).normalize();
            if along.dot(out_of(r, regions[k])) < 0.0 { along } else { -along }
        };
        pairs().map(|(a, b)| border(a).angle_between(border(b)).to_degrees()).collect()
    }
}

/// The film that a carrier is of; `None` at a border.
fn film_of(contacts: &Contacts, regions: &[InRegion], i: usize) -> Option<Pair> {
    let (own, share) = (regions[i].0.0, contacts.share(i));
    if share < SURE {
        return Some((0, own));
    }
    if share < 1.0 - SURE {
        return None;
    }
    let mut weights: BTreeMap<u32, f64> = BTreeMap::new();
    for k in contacts.lists.range(i) {
        *weights.entry(regions[contacts.lists.indices[k] as usize].0.0).or_default() += contacts.weights[k];
    }
    let other = weights.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?.0;
    Some((own.min(other), own.max(other)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a cap of the sphere of radius `radius` around `centre`, up to `widest` from `axis`.
    fn cap(centre: DVec3, radius: f64, axis: DVec3, widest: f64) -> (Vec<DVec3>, Vec<DVec3>) {
        let (t1, t2) = axis.any_orthonormal_pair();
        let angles = (1..200).map(f64::from).map(|k| (widest * (k / 200.0).sqrt(), 2.4 * k));
        let normals: Vec<DVec3> =
            angles.map(|(p, a)| axis * p.cos() + (t1 * a.cos() + t2 * a.sin()) * p.sin()).collect();
        (normals.iter().map(|n| centre + *n * radius).collect(), normals)
    }

    #[test]
    fn caps_small_and_large_and_planes_are_found() {
        for (radius, widest) in [(0.05, 0.3), (0.05, 2.5), (30.0, 1e-3)] {
            let (x, n) = cap(DVec3::new(0.1, 0.2, -0.1), radius, DVec3::Y, widest);
            let sphere = Sphere::fit(&x, &n).expect("enough points");
            assert!((sphere.curvature * radius - 1.0).abs() < 1e-6, "{radius}: {}", sphere.curvature);
            assert!(sphere.normal(x[7]).distance(n[7]) < 1e-6);
        }
    }

    #[test]
    fn spheres_of_a_double_bubble_meet_at_120_degrees() {
        let axis = DVec3::X;
        let left = Sphere::fit(&cap(DVec3::ZERO, 1.0, -axis, 1.5).0, &cap(DVec3::ZERO, 1.0, -axis, 1.5).1).unwrap();
        let right = Sphere::fit(&cap(axis, 1.0, axis, 1.5).0, &cap(axis, 1.0, axis, 1.5).1).unwrap();
        let wall = Sphere { curvature: 0.0, slope: -axis, constant: 0.5 };
        let films = FittedFilms { films: [((0, 1), left), ((0, 2), right), ((1, 2), wall)].into(), area: 0.0 };
        assert_eq!(films.angles().len(), 3);
        assert!(films.angles().iter().all(|(_, angle)| (angle - 120.0).abs() < 1e-6), "{:?}", films.angles());
    }
}
