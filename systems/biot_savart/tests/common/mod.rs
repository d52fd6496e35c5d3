//! Sheets to sum over: films with a jump of potential at their vertices, as the vortex sheet method makes them.

#![allow(dead_code, reason = "each test uses a part")]

use froth_biot_savart::{PairSum, SheetKernel, Summation};
use froth_surface::LabelledTriangles;
use froth_surface::shapes::{cube, disc, double_bubble, icosphere, lattice};
use glam::DVec3;

/// Films, and the strength of each face.
pub(crate) struct Sheet {
    /// What it is.
    pub(crate) name: &'static str,
    /// Target edge length, metres.
    pub(crate) edge: f64,
    /// The films.
    pub(crate) films: LabelledTriangles,
    /// Centroids, metres.
    pub(crate) centres: Vec<DVec3>,
    /// Area-integrated strengths, m³/s.
    pub(crate) strengths: Vec<DVec3>,
}

impl Sheet {
    /// From the jump of potential (m²/s) as a function of place.
    pub(crate) fn new(name: &'static str, edge: f64, films: LabelledTriangles, jump: impl Fn(DVec3) -> f64) -> Self {
        let corners: Vec<[DVec3; 3]> = (0..films.triangles.len()).map(|face| corners(&films, face)).collect();
        let centres = corners.iter().map(|x| (x[0] + x[1] + x[2]) / 3.0).collect();
        let strength = |x: &[DVec3; 3]| (0..3).map(|k| -0.5 * jump(x[k]) * opposite_edge(x, k)).sum();
        let strengths = corners.iter().map(strength).collect();
        Self { name, edge, films, centres, strengths }
    }

    /// The kernel that suits the edge length.
    pub(crate) fn kernel(&self) -> SheetKernel {
        SheetKernel::third_order(0.75 * self.edge)
    }

    /// A sum over the sheet's panels.
    pub(crate) fn sum(&self, summation: Summation) -> PairSum {
        let mut sum = PairSum::new(self.kernel(), summation).expect("a sound kernel");
        sum.place(&self.centres);
        sum
    }

    /// Mean normal velocity out of each region over each vertex's share of film, from potentials at centroids, m/s.
    /// Entries of regions that do not touch a vertex are zero.
    pub(crate) fn normal_velocities(&self, potentials: &[DVec3]) -> Vec<f64> {
        let regions = self.films.region_count() as usize;
        let mut flux = vec![0.0; self.films.positions.len() * regions];
        let mut area = flux.clone();
        for (face, potential) in potentials.iter().enumerate() {
            let x = corners(&self.films, face);
            let third = 0.5 * (x[1] - x[0]).cross(x[2] - x[0]).length() / 3.0;
            for k in 0..3 {
                let share = 0.5 * opposite_edge(&x, k).dot(*potential);
                for (region, sign) in self.films.labels[face].into_iter().zip([1.0, -1.0]) {
                    let at = self.films.triangles[face][k] as usize * regions + region as usize;
                    flux[at] += sign * share;
                    area[at] += third;
                }
            }
        }
        flux.iter().zip(area).map(|(flux, area)| if area > 0.0 { flux / area } else { 0.0 }).collect()
    }
}

fn corners(films: &LabelledTriangles, face: usize) -> [DVec3; 3] {
    films.triangles[face].map(|vertex| films.positions[vertex as usize])
}

/// Edge opposite a corner, counter-clockwise.
fn opposite_edge(x: &[DVec3; 3], corner: usize) -> DVec3 {
    x[(corner + 2) % 3] - x[(corner + 1) % 3]
}

/// A harmonic polynomial of degree 2 and one of degree 6.
pub(crate) fn waves(x: DVec3) -> f64 {
    let DVec3 { x, y, .. } = x;
    x * x - y * y + x.powi(6) - 15.0 * x.powi(4) * y * y + 15.0 * x * x * y.powi(4) - y.powi(6)
}

/// A sphere of radius 1 with waves of degree 2 and 6.
pub(crate) fn sphere(edge: f64) -> Sheet {
    Sheet::new("sphere", edge, icosphere(DVec3::ZERO, 1.0, edge), waves)
}

/// Sheets of different shape: closed, flat, of many cells, thin and long.
pub(crate) fn sheets(edge: f64) -> Vec<Sheet> {
    let jump = |x: DVec3| waves(0.7 * x) + (3.0 * x.z + x.x).sin();
    let mut two = double_bubble(DVec3::ZERO, DVec3::new(0.3, 1.0, 0.2), 1.0, 0.6, edge);
    two.append(&double_bubble(DVec3::new(2.5, 1.2, -0.7), DVec3::X, 0.8, 0.7, edge));
    let drum = move |x: DVec3| (1.0 - x.length_squared()).max(0.0).sqrt() * (1.0 + x.x);
    vec![
        sphere(edge),
        Sheet::new("double bubbles", edge, two, jump),
        Sheet::new("disc", edge, disc(DVec3::ZERO, 1.0, DVec3::new(0.2, 0.3, 1.0), edge), drum),
        Sheet::new("cube", edge, cube(DVec3::ZERO, 1.6, edge), jump),
        Sheet::new("foam", edge, lattice(DVec3::ZERO, [3, 3, 2], 0.7, edge), jump),
    ]
}

/// Root mean square of the difference over that of the reference.
pub(crate) fn relative_error(found: &[DVec3], reference: &[DVec3]) -> f64 {
    let square: f64 = found.iter().zip(reference).map(|(a, b)| a.distance_squared(*b)).sum();
    (square / reference.iter().map(|b| b.length_squared()).sum::<f64>()).sqrt()
}

/// As [`relative_error`], for numbers.
pub(crate) fn relative_error_of_numbers(found: &[f64], reference: &[f64]) -> f64 {
    let square: f64 = found.iter().zip(reference).map(|(a, b)| (a - b) * (a - b)).sum();
    (square / reference.iter().map(|b| b * b).sum::<f64>()).sqrt()
}
