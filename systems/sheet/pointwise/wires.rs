//! Wires: the change of circulation on a wire that makes the air there go with it.
//!
//! # Equation
//! `(B^T B + lambda^2) x = B^T du`, with `B` the velocity of the air at held vertices along a direction per unknown, and `du` what the wires'
//! velocity has beyond the air's. Unknowns are those of [`Wires`](crate::wires): one on a film, two on a Plateau border. The direction is
//! that of the volume gradient of the unknown's region; along the wire, and in the plane of a film, vertices are just put where
//! the wire is.
//!
//! # Discretisation
//! No matrix is laid out: conjugate gradients on the normal equations (CGLS), both of whose products are Biot-Savart sums. `B x` is that
//! of the panels around the wire at the held vertices; `B^T y` that of the held vertices, with strengths `y n`, at the panels, because
//! `n.(G x d) = G.(d x n)` and strengths and fluxes are each other's transpose. `lambda` is 0.025 over the mean edge around the wires.
//!
//! # Source
//! Da 2015, eqs 13 and 14, on Plateau borders too. Paige and Saunders 1982, §7.1, for the iteration.

use froth_biot_savart::PairSum;
use glam::DVec3;

use crate::SheetError;
use crate::discretisation::Films;
use crate::flow;
use crate::geometry::{corners, edges};
use crate::wires::WireSolve;

/// `lambda` times the mean edge, dimensionless (Da 2015, §4.6).
const WEIGHT_ON_CHANGE: f64 = 0.025;
/// When the solve ends: residual of the normal equations over their right-hand side.
const TOLERANCE: f64 = 1e-10;
/// Iterations after which something else is wrong: singular values span at most two decades above `lambda`.
const MOST_ITERATIONS: u32 = 1000;

/// The wires' matrix as a pair of products.
#[derive(Debug)]
pub(super) struct Grip<'a> {
    films: Films<'a>,
    /// Per unknown: its vertex, and the direction in which the air is held there.
    vertices: Vec<u32>,
    places: Vec<DVec3>,
    directions: Vec<DVec3>,
    /// Centres of the panels around wires, metres.
    centres: Vec<DVec3>,
    /// `lambda^2`, 1/m^2.
    weight: f64,
    /// Potentials per side: zero but for the unknowns.
    potentials: Vec<f64>,
    strengths: Vec<DVec3>,
    panels: &'a mut PairSum,
    points: &'a mut PairSum,
}

impl<'a> Grip<'a> {
    pub(super) fn new(films: Films<'a>, [panels, points]: &'a mut [PairSum; 2]) -> Self {
        let Films { layout, geometry, wires, positions, .. } = films;
        let unknowns = wires.unknowns();
        let vertices: Vec<u32> = unknowns.iter().map(|unknown| layout.vertex_of(unknown[0])).collect();
        let gradient = |side: &u32| geometry.gradients[*side as usize];
        let directions = unknowns.iter().map(|unknown| unknown.iter().map(gradient).sum::<DVec3>().normalize_or_zero());
        let places: Vec<DVec3> = vertices.iter().map(|v| positions[*v as usize]).collect();
        let centres: Vec<DVec3> = wires.panel_rows().iter().map(|row| geometry.centres[*row]).collect();
        panels.place(&centres);
        points.place(&places);
        let lengths = wires.around().panels().iter().flat_map(|panel| edges(corners(panel, positions)));
        let mean = lengths.map(DVec3::length).sum::<f64>() / (3 * centres.len()) as f64;
        let weight = (WEIGHT_ON_CHANGE / mean).powi(2);
        Self {
            films,
            directions: directions.collect(),
            vertices,
            places,
            centres,
            weight,
            potentials: vec![0.0; layout.side_count()],
            strengths: Vec::new(),
            panels,
            points,
        }
    }

    /// Where the air is held: the vertex of each unknown, metres.
    pub(super) fn places(&self) -> &[DVec3] {
        &self.places
    }

    /// What the wires' velocity has beyond the air's (m/s at [`Self::places`]), along the directions.
    pub(super) fn lack(&self, air: &[DVec3], wire_velocities: &[DVec3]) -> Vec<f64> {
        let lack = |((v, n), u): ((&u32, &DVec3), &DVec3)| n.dot(wire_velocities[*v as usize] - *u);
        self.vertices.iter().zip(&self.directions).zip(air).map(lack).collect()
    }

    /// `B x`, m/s, of changes of the unknowns, m^2/s.
    fn times(&mut self, x: &[f64]) -> Result<Vec<f64>, SheetError> {
        let Films { wires, positions, .. } = self.films;
        for (unknown, value) in wires.unknowns().iter().zip(x) {
            unknown.iter().for_each(|side| self.potentials[*side as usize] = *value);
        }
        flow::strengths(wires.around(), positions, &self.potentials, &mut self.strengths);
        let mut air = Vec::new();
        self.panels.velocities_at(&self.strengths, &self.places, &mut air)?;
        Ok(self.directions.iter().zip(air).map(|(n, u)| n.dot(u)).collect())
    }

    /// `B^T y`.
    fn transposed_times(&mut self, y: &[f64]) -> Result<Vec<f64>, SheetError> {
        let Films { wires, positions, .. } = self.films;
        let strengths: Vec<DVec3> = self.directions.iter().zip(y).map(|(n, y)| *n * *y).collect();
        let (mut swirls, mut sides) = (Vec::new(), Vec::new());
        self.points.velocities_at(&strengths, &self.centres, &mut swirls)?;
        flow::fluxes(wires.around(), positions, &swirls, &mut sides);
        Ok(wires.gathered(&sides))
    }

    // DEVIATION: Da 2015 leaves wires on Plateau borders out, where circulations outnumber normals; potentials per region do not.
    // Test: wires_take_the_air_along_on_plateau_borders_too.
    /// The changes of the unknowns (m^2/s) that make up for what is lacking (m/s).
    ///
    /// # Errors
    /// [`SheetError::WireNotSolved`], faults of the pair sum.
    pub(super) fn solve(&mut self, lack: Vec<f64>) -> Result<(Vec<f64>, WireSolve), SheetError> {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut x = vec![0.0; lack.len()];
        let mut rest = lack;
        let mut residual = self.transposed_times(&rest)?;
        let mut direction = residual.clone();
        let whole = dot(&residual, &residual);
        let mut rho = whole;
        let mut info = WireSolve::default();
        while rho > TOLERANCE * TOLERANCE * whole {
            if info.iterations == MOST_ITERATIONS || !rho.is_finite() {
                return Err(SheetError::WireNotSolved { iterations: info.iterations, residual: (rho / whole).sqrt() });
            }
            let image = self.times(&direction)?;
            let alpha = rho / (dot(&image, &image) + self.weight * dot(&direction, &direction));
            x.iter_mut().zip(&direction).for_each(|(x, d)| *x += alpha * d);
            rest.iter_mut().zip(&image).for_each(|(r, i)| *r -= alpha * i);
            residual = self.transposed_times(&rest)?;
            residual.iter_mut().zip(&x).for_each(|(r, x)| *r -= self.weight * x);
            let next = dot(&residual, &residual);
            direction.iter_mut().zip(&residual).for_each(|(d, r)| *d = r + next / rho * *d);
            rho = next;
            info.iterations += 1;
        }
        info.residual = if whole > 0.0 { (rho / whole).sqrt() } else { 0.0 };
        Ok((x, info))
    }
}
