//! Authored initial fields, evaluated at given places.

use super::harmonic::Harmonic;
use super::surface::LayeredNoise;
use crate::operators::tangent::tangential;
use froth_components::authored::film::{Film, SurfactantField, ThicknessField};
use froth_components::authored::motion::{Spin, Swirl, SwirlPattern};
use glam::DVec3;
use std::f64::consts::TAU;

/// Thinnest film a field may give, relative to its mean.
const THINNEST: f64 = 0.1;

/// The film a field is evaluated on.
#[derive(Clone, Copy)]
pub struct Extent<'a> {
    /// Places, m.
    pub places: &'a [DVec3],
    /// Centre of the shape, m.
    pub centre: DVec3,
    /// Size that noise frequencies refer to, m.
    pub size: f64,
    /// Seed of noise that the scene does not seed itself.
    pub seed: u32,
}

impl Extent<'_> {
    /// `x . direction` from 0 at the film's lowest point to 1 at its highest.
    fn height(&self, direction: DVec3) -> Vec<f64> {
        let along: Vec<f64> = self.places.iter().map(|p| p.dot(direction)).collect();
        let low = along.iter().copied().fold(f64::INFINITY, f64::min);
        let high = along.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        along.iter().map(|h| (h - low) / (high - low).max(f64::MIN_POSITIVE)).collect()
    }

    /// Noise of mean 0 and standard deviation 1 over the places.
    fn noise(&self, frequency: f64, octaves: u32, seed: Option<u64>) -> Vec<f64> {
        let noise = LayeredNoise::new(seed.map_or(self.seed, |s| s as u32), frequency, octaves);
        let raw: Vec<f64> = self.places.iter().map(|p| noise.at((*p - self.centre) / self.size)).collect();
        let count = raw.len() as f64;
        let mean = raw.iter().sum::<f64>() / count;
        let deviation = (raw.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt();
        raw.iter().map(|v| (v - mean) / deviation.max(f64::MIN_POSITIVE)).collect()
    }

    /// Thickness at every place, m.
    #[must_use]
    pub fn thickness(&self, field: &ThicknessField) -> Vec<f64> {
        let thinnest = THINNEST * field.mean();
        self.raw_thickness(field).into_iter().map(|eta| eta.max(thinnest)).collect()
    }

    fn raw_thickness(&self, field: &ThicknessField) -> Vec<f64> {
        match field {
            ThicknessField::Uniform(eta) => vec![eta.si(); self.places.len()],
            ThicknessField::Noise(n) => {
                let noise = self.noise(n.frequency.si(), n.octaves, n.seed);
                noise.iter().map(|v| n.mean.si() * (1.0 + n.relative.si() * v)).collect()
            }
            ThicknessField::Wave(wave) => {
                let phase = |h: &f64| (TAU * wave.wavelengths.si() * h + wave.phase.si()).sin();
                let height = self.height(wave.direction.unit());
                height.iter().map(|h| wave.mean.si() * (1.0 + wave.relative.si() * phase(h))).collect()
            }
            ThicknessField::Gradient(g) => {
                let linear =
                    self.height(g.direction.unit()).into_iter().map(|h| g.from.si() * (1.0 - h) + g.to.si() * h);
                match g.noise {
                    None => linear.collect(),
                    Some(n) => {
                        let noise = self.noise(n.frequency.si(), n.octaves, n.seed);
                        linear.zip(noise).map(|(eta, v)| eta * (1.0 + n.relative.si() * v)).collect()
                    }
                }
            }
        }
    }

    /// Concentration at every place, as a multiple of the one at rest, given the thickness there.
    #[must_use]
    pub fn concentration(&self, film: &Film, thickness: &[f64]) -> Vec<f64> {
        match film.surfactant {
            SurfactantField::Uniform => vec![1.0; thickness.len()],
            SurfactantField::WithThickness => {
                let mean = thickness.iter().sum::<f64>() / thickness.len() as f64;
                thickness.iter().map(|eta| eta / mean).collect()
            }
        }
    }

    /// Tangential velocity at every place by a rigid rotation and a swirl, m/s.
    #[must_use]
    pub fn flow(&self, normals: &[DVec3], spin: Option<&Spin>, swirl: Option<&Swirl>) -> Vec<DVec3> {
        let mut flow = vec![DVec3::ZERO; self.places.len()];
        if let Some(spin) = spin {
            let turn = spin.axis.unit() * spin.rate.si();
            for ((u, place), n) in flow.iter_mut().zip(self.places).zip(normals) {
                *u += tangential(turn.cross(*place - self.centre), *n);
            }
        }
        if let Some(swirl) = swirl {
            flow.iter_mut().zip(self.swirl(normals, swirl)).for_each(|(u, v)| *u += v);
        }
        flow
    }

    /// `n x grad psi`, scaled to the authored root mean square speed.
    fn swirl(&self, normals: &[DVec3], swirl: &Swirl) -> Vec<DVec3> {
        let stream: Box<dyn Fn(DVec3) -> f64> = match swirl.pattern {
            SwirlPattern::Noise(n) => {
                let noise = LayeredNoise::new(n.seed.map_or(self.seed, |s| s as u32), n.frequency.si(), n.octaves);
                Box::new(move |place| noise.at(place))
            }
            SwirlPattern::Harmonic(h) => {
                let harmonic = Harmonic::new(h.degree, h.order);
                Box::new(move |place| harmonic.at(place))
            }
        };
        let slope = |place: DVec3| {
            const STEP: f64 = 1e-4;
            let along = |axis: DVec3| (stream(place + axis * STEP) - stream(place - axis * STEP)) / (2.0 * STEP);
            DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
        };
        let raw: Vec<DVec3> =
            self.places.iter().zip(normals).map(|(p, n)| n.cross(slope((*p - self.centre) / self.size))).collect();
        let mean_square = raw.iter().map(|u| u.length_squared()).sum::<f64>() / raw.len() as f64;
        raw.iter().map(|u| *u * (swirl.speed.si() / mean_square.sqrt().max(f64::MIN_POSITIVE))).collect()
    }
}
