//! Films in contact give up energy: inelastic collisions.
//!
//! # Equation
//! Kinetic energy per density is `K = phi . F / 2`, with the fluxes `F` linear in the potentials. Descent in `phi` at the vertices in contact,
//! which takes the motion through the films there away, stops where `K` is what it may be; if it may be nothing, where those films rest.
//! Along `d` it is the smaller root of `K - tau (d . F) + tau^2 (d . F_d) / 2 = most`, and where there is none, the vertex of the
//! parabola, and again, along conjugate directions preconditioned by `1 / A`.
//! It is rest against the air far away. What drifts as a whole gets its drift back with its [impulse](crate::impulse).
//!
//! # Source
//! This scheme's own. Where films merge, the circulations that meet differ; what no film carries any more would stay behind in the air as a
//! free vortex sheet, which films cannot represent. Where films touch and do not merge, they cannot go where the air drives them.
//!
//! # Limits
//! At most [`MOST_DESCENTS`] sums over pairs: what is left then is left.

use crate::SheetError;

/// Descents after which energy that is left is left.
pub const MOST_DESCENTS: u32 = 12;
/// Square of the fluxes that are left, over that of the first, at which films count as at rest.
const ENOUGH: f64 = 1e-6;

/// Kinetic energy per density, m^5/s^2, of potentials (m^2/s) with their fluxes (m^3/s), both per side.
#[must_use]
pub fn energy(potentials: &[f64], fluxes: &[f64]) -> f64 {
    0.5 * dot(potentials, fluxes)
}

/// Takes energy per density down to `most` (m^5/s^2); `scales` per side are `1 / A`, or 0 where nothing may change. Gives what was lost.
///
/// # Errors
/// Those of `fluxes`.
pub fn calm(
    scales: &[f64],
    most: f64,
    fluxes: &mut impl FnMut(&mut [f64]) -> Result<Vec<f64>, SheetError>,
    potentials: &mut [f64],
) -> Result<f64, SheetError> {
    let mut flux = fluxes(potentials)?;
    let before = energy(potentials, &flux);
    let mut now = before;
    let mut way = vec![0.0; flux.len()];
    let (mut first, mut last) = (None, f64::INFINITY);
    for _ in 0..MOST_DESCENTS {
        let size: f64 = flux.iter().zip(scales).map(|(f, scale)| f * f * scale).sum();
        if !(now > most && size > ENOUGH * *first.get_or_insert(size)) {
            break;
        }
        for ((way, f), scale) in way.iter_mut().zip(&flux).zip(scales) {
            *way = f * scale + size / last * *way;
        }
        last = size;
        let mut way_tied = way.clone();
        let answer = fluxes(&mut way_tied)?;
        let (slope, curvature) = (dot(&way_tied, &flux), dot(&way_tied, &answer));
        if !(slope > 0.0 && curvature > 0.0) {
            break;
        }
        let under_root = slope * slope - 2.0 * curvature * (now - most);
        let tau = (slope - under_root.max(0.0).sqrt()) / curvature;
        potentials.iter_mut().zip(&way_tied).for_each(|(phi, way)| *phi -= tau * way);
        flux.iter_mut().zip(&answer).for_each(|(f, answer)| *f -= tau * answer);
        now += tau * (0.5 * tau * curvature - slope);
        if under_root >= 0.0 {
            break;
        }
    }
    Ok(before - now)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `F = (2 phi_0 - phi_1, 2 phi_1 - phi_0 - phi_2, ...)`: symmetric and positive definite.
    fn fluxes(phi: &mut [f64]) -> Result<Vec<f64>, SheetError> {
        let at = |i: usize| phi.get(i).copied().unwrap_or(0.0);
        Ok((0..phi.len()).map(|i| 2.0 * at(i) - at(i + 1) - at(i.wrapping_sub(1))).collect())
    }

    fn energy_of(phi: &mut [f64]) -> f64 {
        let flux = fluxes(phi).unwrap();
        energy(phi, &flux)
    }

    #[test]
    fn a_spike_is_taken_down_to_the_energy_before_it_and_what_lies_elsewhere_stays() {
        let smooth: Vec<f64> = (1..20).map(|i| (f64::from(i) * 0.15).sin()).collect();
        let most = energy_of(&mut smooth.clone());
        let mut phi = smooth.clone();
        phi[9] += 0.4;
        let spiked = energy_of(&mut phi);
        let scales: Vec<f64> = (0..phi.len()).map(|i| if (8..=10).contains(&i) { 1.0 } else { 0.0 }).collect();
        let lost = calm(&scales, most, &mut fluxes, &mut phi).unwrap();
        let left = energy_of(&mut phi);
        assert!((left / most - 1.0).abs() < 1e-12 && (spiked - lost - left).abs() < 1e-12, "{spiked} {left} {most}");
        assert!((0..phi.len()).filter(|i| !(8..=10).contains(i)).all(|i| phi[i] == smooth[i]));
    }

    #[test]
    fn no_energy_too_much_is_no_change_and_none_that_can_go_is_left() {
        let mut phi = vec![1.0, 2.0, 1.0];
        let before = energy_of(&mut phi);
        assert_eq!(calm(&[1.0; 3], before, &mut fluxes, &mut phi).unwrap(), 0.0);
        assert_eq!(calm(&[0.0; 3], 0.0, &mut fluxes, &mut phi).unwrap(), 0.0);
        assert_eq!(phi, [1.0, 2.0, 1.0]);
    }
}
