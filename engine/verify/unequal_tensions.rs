//! Two bubbles of different soaps: Neumann's triangle where their films meet, Laplace's pressures, and the least energy.
//!
//! # Equation
//! Films pull with `t = 2 sigma`: `t1` and `t2` outside, and the wall, which is made of both soaps, with their mean `t3`. They are in balance
//! where they meet, so the angle between films `i` and `j` has the cosine `(tk^2 - ti^2 - tj^2)/(2 ti tj)`. The films are spheres that
//! meet in a circle of radius `c`. A cap that leaves the disc of that circle at the angle `a` has the height `h = c tan(a/2)`,
//! the area `pi (c^2 + h^2)` and the volume `pi h (3 c^2 + h^2)/6`, and its sphere the radius `c/sin a`. The angles leave one unknown, how
//! far the wall bulges, and that follows from the ratio of the volumes. Laplace's three pressures `4 sigma/R` then add up by themselves.
//!
//! # Discretisation
//! The scene starts with two spheres a hair apart, which touch and share a wall. Volumes are those of flat faces, which are kept. Angles are
//! taken as under [`double_bubble`](super::double_bubble).

use std::f64::consts::PI;

use froth_surface::Region;
use froth_surface::calculus::angles::{BorderAngles, border_angles_of_spheres, mean_angle_within};
use froth_surface::calculus::borders::Borders;
use froth_surface::invariants::Violation;

use super::finding::{Finding, Refinement};
use super::mesh_run::{MeshRun, unbroken};
use super::scene_run::SceneRun;
use super::{Effort, LawError};

/// Radius of the spheres at the start, m.
const RADIUS: f64 = 0.04;
/// Tension of an interface of each soap, N/m.
const TENSIONS: [f64; 2] = [0.02, 0.035];
/// Nothing moves any more, s.
const END: f64 = 3.0;
/// Distance within which the films are fitted at the border, m.
const REACH: f64 = 0.4 * RADIUS;

/// The bubbles at rest at one resolution.
struct Rest {
    /// Bubbles with these volumes, in closed form.
    exact: Pair,
    /// Mean angle outside and in each bubble, radians.
    angles: [f64; 3],
    /// Largest difference of an angle at a vertex from Neumann's, radians.
    extreme: f64,
    pressures: [f64; 2],
    energy: f64,
    volume_error: f64,
    violation: Option<Violation>,
}

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let parts: &[f64] = effort.choose(&[8.0, 12.0], &[10.0, 15.0, 22.0]);
    let rests: Vec<Rest> = parts.iter().map(|parts| rest(RADIUS / parts)).collect::<Result<_, LawError>>()?;
    let order = |error: &dyn Fn(&Rest) -> f64| -> Refinement {
        parts.iter().zip(&rests).map(|(parts, rest)| (1.0 / parts, error(rest))).collect()
    };
    let (rest, coarseness) = (&rests[1], effort.choose(2.0, 1.0));
    let label = |what: &str| format!("{what} at R/{}", parts[1]);
    let [t1, t2] = TENSIONS;
    let mut findings: Vec<Finding> = [0, 1, 2]
        .map(|region: usize| {
            let exact = neumann(t1, t2)[region].to_degrees();
            let what = label(&format!("angle in region {region} along the border, degrees,"));
            Finding::relative(what, exact, rest.angles[region].to_degrees(), 0.25 * coarseness / exact)
        })
        .into();
    let extreme = |rest: &Rest| rest.extreme.to_degrees();
    findings.push(
        Finding::vanishing(label("largest difference from these, degrees,"), extreme(rest), 0.5 * coarseness)
            .converging(&order(&extreme), 1.0),
    );
    findings.extend([0, 1].map(|k| {
        let pressure = |rest: &Rest| 4.0 * TENSIONS[k] / rest.exact.radii()[k];
        let what = label(&format!("excess pressure in bubble {}, Pa,", k + 1));
        Finding::relative(what, pressure(rest), rest.pressures[k], 1e-3 * coarseness)
            .converging(&order(&|rest| rest.pressures[k] / pressure(rest) - 1.0), 1.5)
    }));
    findings.extend([
        Finding::relative(label("energy of the films, J,"), rest.exact.energy(), rest.energy, 5e-4 * coarseness)
            .converging(&order(&|rest| rest.energy / rest.exact.energy() - 1.0), 1.7),
        Finding::vanishing(label("largest error of a volume, relative,"), rest.volume_error, 1e-6),
        unbroken(rests.iter().map(|rest| rest.violation.clone())),
    ]);
    Ok(findings)
}

fn rest(edge: f64) -> Result<Rest, LawError> {
    // As far apart, in edges, as in the scene.
    let place = RADIUS + 0.2 * edge;
    let scene = SceneRun::of("unequal_tensions")
        .with("Spacing(\"4 mm\")", &format!("Spacing({edge})"))
        .with("\"-4.08 cm\"", &(-place).to_string())
        .with("\"4.08 cm\"", &place.to_string());
    let mut run = MeshRun::at(&scene, END)?;
    let surface = run.surface();
    let measured = border_angles_of_spheres(&surface, &Borders::new(&surface), REACH);
    let [t1, t2] = TENSIONS;
    Ok(Rest {
        exact: Pair::at_rest(TENSIONS, run.volumes()),
        angles: [0, 1, 2].map(|region| mean_angle_within(&measured, Region(region))),
        extreme: largest_difference(&measured, neumann(t1, t2)),
        pressures: [1, 2].map(|k| run.observed(&format!("excess_pressure_{k}"))),
        energy: run.observed("surface_energy"),
        volume_error: run.observed("volume_error"),
        violation: run.violation(),
    })
}

/// Largest difference of an angle from the one of its region, radians.
fn largest_difference(measured: &[BorderAngles], exact: [f64; 3]) -> f64 {
    let differences = measured
        .iter()
        .flat_map(|at| at.angles)
        .map(|(region, angle)| exact.get(region.0 as usize).map_or(f64::INFINITY, |expected| (angle - expected).abs()));
    differences.fold(f64::NAN, f64::max)
}

/// Angles outside and in the bubbles, radians, between films of tensions `t1`, `t2` and the mean of both.
fn neumann(t1: f64, t2: f64) -> [f64; 3] {
    let wall = 0.5 * (t1 + t2);
    let between = |a: f64, b: f64, third: f64| ((third * third - a * a - b * b) / (2.0 * a * b)).acos();
    [between(t1, t2, wall), between(t1, wall, t2), between(t2, wall, t1)]
}

/// Two bubbles of different soaps at rest, in closed form.
#[derive(Clone, Copy)]
struct Pair {
    /// Tension of an interface of each soap, N/m.
    tensions: [f64; 2],
    /// Radius of the circle where the films meet, m.
    circle: f64,
    /// At which the caps leave the disc of that circle, radians.
    caps: [f64; 2],
    /// At which the wall does, into the first bubble, radians.
    wall: f64,
}

impl Pair {
    /// Bubbles of volumes in m^3.
    fn at_rest(tensions: [f64; 2], volumes: [f64; 2]) -> Self {
        let [_, first, second] = neumann(tensions[0], tensions[1]);
        let bulging = |wall: f64| Self { tensions, circle: 1.0, caps: [first + wall, second - wall], wall };
        // The more the wall bulges into the first bubble, the larger that is beside the second.
        let (mut low, mut high) = ((second - PI).max(-first), second.min(PI - first));
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            let [one, other] = bulging(middle).volumes();
            if one * volumes[1] < other * volumes[0] { low = middle } else { high = middle }
        }
        let pair = bulging(0.5 * (low + high));
        let scale = (volumes.iter().sum::<f64>() / pair.volumes().iter().sum::<f64>()).cbrt();
        Self { circle: scale, ..pair }
    }

    /// m^3.
    fn volumes(&self) -> [f64; 2] {
        let cap = |angle: f64| {
            let height = self.circle * (0.5 * angle).tan();
            PI * height * (3.0 * self.circle * self.circle + height * height) / 6.0
        };
        [cap(self.caps[0]) - cap(self.wall), cap(self.caps[1]) + cap(self.wall)]
    }

    /// Of the caps, m.
    fn radii(&self) -> [f64; 2] {
        self.caps.map(|angle| self.circle / angle.sin())
    }

    /// `2 sigma A` of the three films, J.
    fn energy(&self) -> f64 {
        let area = |angle: f64| PI * self.circle * self.circle * (1.0 + (0.5 * angle).tan().powi(2));
        let [first, second] = self.tensions;
        2.0 * (first * area(self.caps[0]) + second * area(self.caps[1])) + (first + second) * area(self.wall)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use froth_components::authored::mesh_shape::{DoubleBubble, Measured, TwoRadii};
    use froth_components::authored::shape::Place;
    use froth_components::quantity::Direction;

    #[test]
    fn pulls_at_the_angles_of_neumann_are_in_balance() {
        let [t1, t2] = TENSIONS;
        let [outside, _, second] = neumann(t1, t2);
        // The directions of the films, from that of the second cap on.
        let pull = |tension: f64, angle: f64| [tension * angle.cos(), tension * angle.sin()];
        let pulls = [pull(t2, 0.0), pull(t1, outside), pull(0.5 * (t1 + t2), -second)];
        let sum = [0, 1].map(|axis| pulls.iter().map(|pull| pull[axis]).sum::<f64>());
        assert!(sum.iter().all(|sum| sum.abs() < 1e-15), "{sum:?}");
        assert!((neumann(t1, t2).iter().sum::<f64>() - 2.0 * PI).abs() < 1e-12);
    }

    #[test]
    fn two_bubbles_of_one_soap_are_the_double_bubble() {
        let known = DoubleBubble { centre: Place::ZERO, axis: Direction::X, radii: TwoRadii::from_si(0.05, 0.03) };
        // In millilitres, as in the scene of the double bubble.
        let pair = Pair::at_rest([0.03; 2], [500.614498037201e-6, 74.9743865678895e-6]);
        assert!((pair.radii()[0] / 0.05 - 1.0).abs() < 1e-12 && (pair.radii()[1] / 0.03 - 1.0).abs() < 1e-12);
        assert!((pair.circle / known.junction_radius() - 1.0).abs() < 1e-12);
        assert!((pair.energy() / (0.06 * known.area()) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_pressures_of_the_three_films_add_up() {
        let pair = Pair::at_rest(TENSIONS, [3e-4, 2e-4]);
        let [first, second] = [0, 1].map(|k| 4.0 * TENSIONS[k] / pair.radii()[k]);
        let across = 2.0 * (TENSIONS[0] + TENSIONS[1]) * pair.wall.sin() / pair.circle;
        assert!((second - first - across).abs() < 1e-12 * second);
        assert!((pair.volumes()[0] / 3e-4 - 1.0).abs() < 1e-12 && (pair.volumes()[1] / 2e-4 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_energy_is_the_least_for_these_volumes() {
        // A small change of the volumes costs the pressures' work, and none beside it.
        let energy = |volumes: [f64; 2]| Pair::at_rest(TENSIONS, volumes).energy();
        let pair = Pair::at_rest(TENSIONS, [3e-4, 2e-4]);
        for k in 0..2 {
            let varied = |by: f64| {
                let mut volumes = [3e-4, 2e-4];
                volumes[k] += by;
                energy(volumes)
            };
            let pressure = (varied(1e-8) - varied(-1e-8)) / 2e-8;
            assert!((pressure / (4.0 * TENSIONS[k] / pair.radii()[k]) - 1.0).abs() < 1e-6);
        }
    }
}
