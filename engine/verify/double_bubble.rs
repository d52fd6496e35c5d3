//! Two bubbles of unequal volumes: Plateau's angles, Laplace's pressures, and the least area.
//!
//! # Equation
//! Outer radii `R1`, `R2`, wall `1/Rw = 1/R2 - 1/R1`, centres `d` apart with `d^2 = R1^2 + R2^2 - R1 R2`, films at 120 degrees;
//! pressures `4 sigma/R1`, `4 sigma/R2`. The volumes follow from the caps.
//!
//! # Discretisation
//! The scene starts with equal bubbles, and gas goes in and out until they have the exact volumes: the wall bulges and the circle
//! where the films meet moves over several edges. Flat faces that enclose the exact volume have an area in excess of second order.
//!
//! The films at rest are spheres: their slopes at each vertex of the border are those of the spheres that fit them within 0.4 `R1`.
//!
//! # Limits
//! At rest the areas of flat faces are in balance: the first rings beside the border are off by a part of their sagitta, and the slopes
//! of just two rings are good to the first order only. Those angles are listed too: their mean deviation, and the extreme of all vertices.

use froth_components::authored::mesh_shape::{DoubleBubble, Measured, TwoRadii};
use froth_components::authored::shape::Place;
use froth_components::quantity::Direction;
use froth_surface::Region;
use froth_surface::calculus::angles::{
    Deviation, border_angles, border_angles_of_spheres, border_deviation, mean_angle_within,
};
use froth_surface::calculus::borders::Borders;
use froth_surface::invariants::Violation;

use super::finding::{Finding, Refinement};
use super::mesh_run::{MeshRun, unbroken};
use super::scene_run::SceneRun;
use super::{Effort, LawError};

const RADII: [f64; 2] = [0.05, 0.03];
const TENSION: f64 = 0.03;
/// Nothing moves any more, s.
const END: f64 = 1.5;
/// Distance within which the films are fitted at the border, m.
const REACH: f64 = 0.4 * RADII[0];

/// The bubble at rest at one resolution.
struct Rest {
    area: f64,
    pressures: [f64; 2],
    volume_error: f64,
    /// Deviation of the angles between the films.
    angles: Deviation,
    /// The same by the two rings beside the border alone.
    ring_angles: Deviation,
    /// The angle in the outside air and in each bubble, averaged along the border, degrees.
    mean_angles: [f64; 3],
    violation: Option<Violation>,
}

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    // The angles are asked for at R/20.
    let parts: &[f64] = effort.choose(&[5.0, 7.0, 10.0], &[10.0, 20.0, 40.0]);
    let rests: Vec<Rest> = parts.iter().map(|parts| rest(RADII[0] / parts)).collect::<Result<_, LawError>>()?;
    let order = |error: &dyn Fn(&Rest) -> f64| -> Refinement {
        parts.iter().zip(&rests).map(|(parts, rest)| (1.0 / parts, error(rest))).collect()
    };
    let exact = exact().area();
    let at = effort.choose(2, 1);
    let (rest, coarseness) = (&rests[at], 20.0 / parts[at]);
    let angle = 0.5 * coarseness;
    let label = |what: &str| format!("{what} at R/{}", parts[at]);
    let mut findings = vec![
        Finding::relative(label("area, m^2,"), exact, rest.area, 1e-3 * coarseness * coarseness)
            .converging(&order(&|rest| rest.area / exact - 1.0), 1.7),
        Finding::vanishing(
            label("angles of the films less 120 degrees, mean size, degrees,"),
            mean(&rest.angles),
            angle,
        )
        .converging(&order(&|rest| mean(&rest.angles)), 1.7),
        Finding::vanishing(
            label("angles of the films less 120 degrees, extreme, degrees,"),
            worst(&rest.angles),
            angle,
        )
        .converging(&order(&|rest| worst(&rest.angles)), 1.7),
        Finding::vanishing(
            label("the same by two rings of faces, mean size, degrees,"),
            mean(&rest.ring_angles),
            angle,
        )
        .converging(&order(&|rest| mean(&rest.ring_angles)), 0.5),
        Finding::vanishing(
            label("the same by two rings of faces, extreme, degrees,"),
            worst(&rest.ring_angles),
            1.5 * angle,
        ),
        Finding::vanishing(label("largest error of a volume, relative,"), rest.volume_error, 1e-6),
        unbroken(rests.iter().map(|rest| rest.violation.clone())),
    ];
    findings.extend([0, 1, 2].map(|region| {
        let what = label(&format!("angle in region {region} along the border, degrees,"));
        Finding::relative(what, 120.0, rest.mean_angles[region], angle / 120.0)
    }));
    findings.extend([0, 1].map(|k| {
        let pressure = 4.0 * TENSION / RADII[k];
        let what = label(&format!("excess pressure in bubble {}, Pa,", k + 1));
        Finding::relative(what, pressure, rest.pressures[k], 2e-3 * coarseness * coarseness)
            .converging(&order(&|rest| rest.pressures[k] / pressure - 1.0), 1.5)
    }));
    Ok(findings)
}

fn exact() -> DoubleBubble {
    DoubleBubble { centre: Place::ZERO, axis: Direction::X, radii: TwoRadii::from_si(RADII[0], RADII[1]) }
}

fn rest(edge: f64) -> Result<Rest, LawError> {
    let scene = SceneRun::of("double_bubble").with("Spacing(\"2.5 mm\")", &format!("Spacing({edge})"));
    let mut run = MeshRun::at(&scene, END)?;
    let surface = run.surface();
    let borders = Borders::new(&surface);
    let measured = border_angles_of_spheres(&surface, &borders, REACH);
    Ok(Rest {
        area: run.area(),
        pressures: [1, 2].map(|k| run.observed(&format!("excess_pressure_{k}"))),
        volume_error: run.observed("volume_error"),
        angles: border_deviation(&measured).unwrap_or(Deviation::UNKNOWN),
        ring_angles: border_deviation(&border_angles(&surface, &borders)).unwrap_or(Deviation::UNKNOWN),
        mean_angles: [0, 1, 2].map(|region| mean_angle_within(&measured, Region(region)).to_degrees()),
        violation: run.violation(),
    })
}

/// Mean size of a deviation, degrees.
fn mean(angles: &Deviation) -> f64 {
    angles.mean.to_degrees()
}

/// Largest size of a deviation, degrees.
fn worst(angles: &Deviation) -> f64 {
    angles.above.max(-angles.below).to_degrees()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn the_scene_asks_for_the_volumes_of_the_exact_bubbles() {
        let ([first, second], [low, high]) = (RADII, exact().heights());
        // Caps on the plane of the circle, and the cap between that plane and the wall, which bulges into the first bubble.
        let cap = |r: f64, h: f64| PI * h * h * (3.0 * r - h) / 3.0;
        let wall = 1.0 / exact().wall_curvature();
        let bulge = cap(wall, wall - (wall * wall - exact().junction_radius().powi(2)).sqrt());
        let volumes = [cap(first, first - low) - bulge, cap(second, second + high) + bulge];
        let mut run = MeshRun::begin(&SceneRun::of("double_bubble")).unwrap();
        run.advance_to(0.31).unwrap();
        for (volume, exact) in run.volumes::<2>().into_iter().zip(volumes) {
            assert!((volume / exact - 1.0).abs() < 1e-6, "{volume} for {exact}");
        }
    }
}
