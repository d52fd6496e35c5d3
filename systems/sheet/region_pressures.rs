//! One pressure per region out of those that the films show at every vertex.
//!
//! # Equation
//! A vertex knows differences of pressures alone: those of its sides have mean zero, whatever the regions' are. Pressures `P` of
//! regions are those that fit the jumps best,
//! `sum_v A_v sum_(i, j at v) ((P_i - P_j) - (p_iv - p_jv))^2 = min`, with `P = 0` outside. At rest they fit exactly.
//!
//! # Discretisation
//! Sums over vertices give one jump and one weight per pair of regions that share a film: a graph of regions, whose equations
//! Gauss-Seidel sweeps solve, from the outside inwards and back.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use froth_surface::Region;

use crate::geometry::Geometry;
use crate::layout::Layout;

/// Change of a sweep over the largest pressure at which the sweeps end.
const TOLERANCE: f64 = 1e-13;
/// Sweeps after which the rest is left: a foam of a thousand bubbles takes some hundred.
const MOST_SWEEPS: usize = 2000;

/// Sums over the films between two gauges: `sum A` and `sum A (p_i - p_j)`.
type Jump = [f64; 2];

/// Pressure of each region above the outside, Pa; `pressures` per side, `gauge_of` per label: 0 for the outside and what is open to it.
pub(crate) fn measure(
    layout: &Layout,
    geometry: &Geometry,
    pressures: &[f64],
    gauge_of: &[u32],
) -> BTreeMap<Region, f64> {
    let gauge = |region: Region| gauge_of[region.index()];
    let mut jumps: BTreeMap<u32, BTreeMap<u32, Jump>> = BTreeMap::new();
    for v in 0..layout.vertex_rows() {
        for i in layout.sides_of(v) {
            for j in layout.sides_of(v).filter(|j| *j != i) {
                let [a, b] = [i, j].map(|side| gauge(layout.regions()[side]));
                let jump = jumps.entry(a).or_default().entry(b).or_default();
                jump[0] += geometry.areas[v];
                jump[1] += geometry.areas[v] * (pressures[i] - pressures[j]);
            }
        }
    }
    let fitted = fit(&jumps);
    let regions: BTreeSet<Region> = layout.regions().iter().copied().collect();
    regions.into_iter().map(|region| (region, fitted.get(&gauge(region)).copied().unwrap_or(0.0))).collect()
}

/// Pressures per gauge; that of gauge 0 is 0.
fn fit(jumps: &BTreeMap<u32, BTreeMap<u32, Jump>>) -> BTreeMap<u32, f64> {
    let order = inwards(jumps);
    let mut fitted: BTreeMap<u32, f64> = BTreeMap::new();
    fitted.insert(0, 0.0);
    let best = |fitted: &BTreeMap<u32, f64>, of: u32| {
        let known =
            jumps[&of].iter().filter_map(|(other, [area, jump])| Some((*area, area * fitted.get(other)? + jump)));
        let (weight, sum) = known.fold((0.0, 0.0), |(weight, sum), (area, part)| (weight + area, sum + part));
        if weight > 0.0 { sum / weight } else { 0.0 }
    };
    for _ in 0..MOST_SWEEPS {
        let (mut change, mut largest) = (0.0f64, 0.0f64);
        for of in order.iter().chain(order.iter().rev()) {
            let value = best(&fitted, *of);
            change = change.max((value - fitted.insert(*of, value).unwrap_or(0.0)).abs());
            largest = largest.max(value.abs());
        }
        if !(change > TOLERANCE * largest) {
            break;
        }
    }
    fitted
}

/// Gauges but the outside's, those near the outside first.
fn inwards(jumps: &BTreeMap<u32, BTreeMap<u32, Jump>>) -> Vec<u32> {
    let (mut queue, mut seen, mut order) = (VecDeque::from([0]), BTreeSet::from([0]), Vec::new());
    while let Some(gauge) = queue.pop_front() {
        for other in jumps.get(&gauge).into_iter().flat_map(BTreeMap::keys) {
            if seen.insert(*other) {
                order.push(*other);
                queue.push_back(*other);
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use froth_surface::Surface;
    use froth_surface::shapes::kelvin_cells;
    use glam::DVec3;

    use super::*;

    #[test]
    fn pressures_that_films_show_without_their_mean_are_found() {
        let surface = Surface::from_triangles(&kelvin_cells(DVec3::ZERO, 1.0, 2, 0.3));
        let layout = Layout::new(&surface);
        let mut geometry = Geometry::default();
        geometry.measure(&layout, &surface.positions);
        let given = |region: Region| if region == Region::OUTSIDE { 0.0 } else { 3.0 + f64::from(region.0 % 7) };
        let mut pressures: Vec<f64> = layout.regions().iter().map(|region| given(*region)).collect();
        crate::potentials::centre(&layout, &mut pressures);
        let labels = surface.mesh.regions().last().unwrap().0 + 1;
        let gauges: Vec<u32> = (0..labels).collect();
        let found = measure(&layout, &geometry, &pressures, &gauges);
        assert_eq!(found.keys().copied().collect::<Vec<_>>(), surface.mesh.regions());
        for (region, pressure) in found {
            assert!((pressure - given(region)).abs() < 1e-11, "{region:?}: {pressure}");
        }
    }
}
