//! Clusters that were stretched and damped come to rest in air with Plateau's angles and Laplace's pressures.
//!
//! # Equation
//! Films meet at 120 degrees, borders at 109.47; caps of radius `R` hold `4 sigma/R`; the wall between caps of radii `R1 > R2` has the
//! curvature `1/R2 - 1/R1`.
//!
//! # Discretisation
//! At rest the areas of flat faces are in balance, as under [`double_bubble`](super::double_bubble): slopes at the borders are those of the
//! spheres that fit the films there. The wall's curvature is that of the sphere that fits its vertices but those of the border.

use froth_surface::calculus::angles::{
    Deviation, border_angles_of_spheres, border_deviation, quadruple_angles, quadruple_deviation,
};
use froth_surface::calculus::borders::Borders;
use froth_surface::{Face, Region, Surface};
use glam::DVec3;

use super::finding::Finding;
use super::mesh_run::{MeshRun, unbroken};
use super::oscillation::least_squares;
use super::sheet_run::{TENSION, free_film};
use super::{Effort, LawError};

/// Nothing moves any more, s.
const END: f64 = 0.4;
/// Distance within which films are fitted at a border, in radii of the smallest cap.
const REACH: f64 = 0.4;
/// Largest deviation of an angle, degrees: two bubbles, and more.
const ANGLES: [f64; 2] = [0.7, 1.0];
/// Relative error of pressures and curvatures.
const CURVATURE: f64 = 0.01;

/// A cluster at rest.
struct Cluster {
    name: &'static str,
    shape: &'static str,
    /// Radii of the caps of regions 1, 2, ..., m.
    radii: &'static [f64],
}

const CLUSTERS: [Cluster; 4] = [
    Cluster { name: "double", shape: "DoubleBubble(radii: (\"4 cm\", \"4 cm\"))", radii: &[0.04, 0.04] },
    Cluster { name: "double 0.56", shape: "DoubleBubble(radii: (\"4 cm\", \"2.24 cm\"))", radii: &[0.04, 0.0224] },
    Cluster { name: "triple", shape: "TripleBubble(radius: \"3.5 cm\")", radii: &[0.035; 3] },
    Cluster { name: "quadruple", shape: "QuadrupleBubble(radius: \"3.5 cm\")", radii: &[0.035; 4] },
];

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let parts = effort.choose(5.0, 10.0);
    let findings = CLUSTERS.iter().map(|cluster| held_against(cluster, parts, effort));
    Ok(findings.collect::<Result<Vec<_>, LawError>>()?.into_iter().flatten().collect())
}

fn held_against(cluster: &Cluster, parts: f64, effort: Effort) -> Result<Vec<Finding>, LawError> {
    let smallest = cluster.radii.iter().copied().fold(f64::INFINITY, f64::min);
    // The product of the factors is 1: volumes stay those of the cluster.
    let shape = format!("{}, Stretch((1.05, 0.976, 0.9758))", cluster.shape);
    let mut run = MeshRun::at(&free_film(&shape, &format!("Spacing({})", smallest / parts), "damping: 40"), END)?;
    let surface = run.surface();
    let borders = Borders::new(&surface);
    // Errors of second order.
    let coarse = effort.choose(4.0, 1.0);
    let angle = coarse * ANGLES[usize::from(cluster.radii.len() > 2)];
    let name = cluster.name;
    let deviation = border_deviation(&border_angles_of_spheres(&surface, &borders, REACH * smallest));
    let mut findings = vec![
        Finding::vanishing(format!("{name}: angles less 120 degrees, mean size, degrees"), mean(deviation), angle),
        Finding::vanishing(format!("{name}: angles less 120 degrees, extreme, degrees"), extreme(deviation), angle),
    ];
    if cluster.radii.len() == 4 {
        let deviation = quadruple_deviation(&quadruple_angles(&surface, &borders));
        let what = format!("{name}: angles of borders less 109.47 degrees, mean size, degrees");
        findings.push(Finding::vanishing(what, mean(deviation), 2.0 * angle));
    }
    findings.extend((1..).zip(cluster.radii).map(|(region, radius)| {
        let what = format!("{name}: excess pressure in bubble {region}, Pa");
        let measured = run.observed(&format!("excess_pressure_{region}"));
        Finding::relative(what, 4.0 * TENSION / radius, measured, coarse * CURVATURE)
    }));
    findings.push(wall(cluster, &surface, smallest, coarse * CURVATURE));
    findings.push(Finding::vanishing(format!("{name}: error of a volume in any step"), run.volume_error, 1e-4));
    findings.push(unbroken([run.violation()]));
    Ok(findings)
}

/// Curvature of the wall between bubbles 1 and 2; where it is flat, in units of that of the caps.
fn wall(cluster: &Cluster, surface: &Surface, smallest: f64, tolerance: f64) -> Finding {
    let (expected, measured) = (1.0 / cluster.radii[1] - 1.0 / cluster.radii[0], wall_curvature(surface));
    let name = cluster.name;
    if expected > 0.0 {
        Finding::relative(format!("{name}: curvature of the wall, 1/m"), expected, measured, tolerance)
    } else {
        Finding::vanishing(
            format!("{name}: curvature of the wall, in that of the caps"),
            measured * smallest,
            tolerance,
        )
    }
}

/// Curvature of the sphere that fits the film between regions 1 and 2, away from its border, 1/m.
fn wall_curvature(surface: &Surface) -> f64 {
    let of_wall = |face: &Face| face.borders(Region(1)) && face.borders(Region(2));
    let within = surface.mesh.faces().filter(|(_, face)| !face.is_ghost() && of_wall(face));
    let mut rows: Vec<usize> = within.flat_map(|(_, face)| face.vertices().map(|v| v.index())).collect();
    rows.sort_unstable();
    rows.dedup();
    let beyond = surface.mesh.faces().filter(|(_, face)| !face.is_ghost() && !of_wall(face));
    let mut border: Vec<usize> = beyond.flat_map(|(_, face)| face.vertices().map(|v| v.index())).collect();
    border.sort_unstable();
    rows.retain(|row| border.binary_search(row).is_err());
    let places: Vec<DVec3> = rows.iter().map(|row| surface.positions.0[*row]).collect();
    let middle = places.iter().sum::<DVec3>() / places.len() as f64;
    let normal = thinnest(&places, middle);
    // In the frame of the film `z = c + s.(x, y) + k (x^2 + y^2 + z^2)/2`: exact for spheres and planes.
    let (u, v) = normal.any_orthonormal_pair();
    let row = |x: &DVec3| {
        let d = *x - middle;
        ([1.0, d.dot(u), d.dot(v), 0.5 * d.length_squared()], d.dot(normal))
    };
    let [c, s, t, k] = least_squares(places.iter().map(row));
    k.abs() / (1.0 + s * s + t * t - 2.0 * c * k).sqrt()
}

/// Direction across a nearly flat set of points: the mean normal of triangles about their middle.
fn thinnest(places: &[DVec3], middle: DVec3) -> DVec3 {
    let farthest =
        places.iter().map(|x| *x - middle).max_by(|a, b| a.length().total_cmp(&b.length())).unwrap_or(DVec3::X);
    let across = |x: &DVec3| farthest.cross(*x - middle);
    let widest = places.iter().map(across).max_by(|a, b| a.length().total_cmp(&b.length())).unwrap_or(DVec3::Z);
    widest.normalize_or(DVec3::Z)
}

fn mean(deviation: Option<Deviation>) -> f64 {
    deviation.unwrap_or(Deviation::UNKNOWN).mean.to_degrees()
}

fn extreme(deviation: Option<Deviation>) -> f64 {
    let Deviation { above, below, .. } = deviation.unwrap_or(Deviation::UNKNOWN);
    above.max(-below).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;
    use froth_surface::shapes::double_bubble;

    #[test]
    fn the_wall_of_an_unequal_double_bubble_has_the_difference_of_curvatures() {
        let surface = Surface::from_triangles(&double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.56, 0.06));
        let expected = 1.0 / 0.56 - 1.0;
        assert!((wall_curvature(&surface) / expected - 1.0).abs() < 1e-6, "{}", wall_curvature(&surface));
    }
}
