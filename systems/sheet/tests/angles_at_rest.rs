//! Films at rest meet at 120 degrees, whatever they start from, and pressures are those of Young and Laplace.
//!
//! A double bubble is put together wrong, and comes to rest with its potentials damped. At rest every outer film has
//! `p = 2 T / R` and the wall the difference, so that `1/R_wall = 1/R2 - 1/R1` (Plateau 1873).

mod common;

use common::{Film, Settings, report};
use froth_sheet::Sliding;
use froth_surface::Region;
use froth_surface::calculus::angles::{Deviation, border_angles, border_deviation};
use froth_surface::calculus::borders::Borders;
use froth_surface::shapes::{DoubleBubble, double_bubble};
use glam::DVec3;

/// Rate at which potentials die, 1/s: near critical damping for the slow modes.
const DAMPING: f64 = 2.0;

/// A double bubble of outer radii 1 and `small` at rest, which started with angles off by tens of degrees.
fn at_rest(small: f64, edge: f64) -> Film {
    let settings = Settings { sliding: Sliding::everywhere(0.1), ..Settings::default() };
    let mut film = Film::new(&double_bubble(DVec3::ZERO, DVec3::X, 1.0, small, edge), settings);
    let volumes = film.volumes.clone();
    // Longer and thinner, with the volumes of the double bubble at rest.
    film.reshape(|x| x * DVec3::new(1.44, 1.0 / 1.2, 1.0 / 1.2));
    film.volumes = volumes;
    assert!(deviation(&film).mean.to_degrees() > 10.0);
    let mut fastest = f64::INFINITY;
    while film.time < 2.0 || fastest > 1e-3 {
        let dt = film.capillary_step(0.4);
        film.step(dt);
        film.state.potentials.iter_mut().for_each(|phi| *phi *= (-DAMPING * dt).exp());
        fastest = film.sheet.velocities.iter().map(|w| w.length()).fold(0.0, f64::max);
        assert!(film.time < 60.0, "not at rest: {fastest:.1e}");
    }
    film.evaluate(1.0);
    film
}

fn deviation(film: &Film) -> Deviation {
    border_deviation(&border_angles(&film.surface, &Borders::new(&film.surface))).unwrap()
}

/// Places of the border.
fn rim(film: &Film) -> Vec<DVec3> {
    Borders::new(&film.surface).vertices().map(|v| film.surface.positions[v]).collect()
}

fn mean(places: &[DVec3]) -> DVec3 {
    places.iter().sum::<DVec3>() / places.len() as f64
}

fn ring_radius(film: &Film) -> f64 {
    let rim = rim(film);
    rim.iter().map(|x| x.distance(mean(&rim))).sum::<f64>() / rim.len() as f64
}

/// Radius of the sphere that fits the film between two regions best, its centre on the axis, metres.
///
/// `|x|^2 = 2 c x + d` from the middle of the ring, by least squares for the centre `c` and `d = R^2 - c^2`.
fn radius(film: &Film, regions: [u32; 2]) -> f64 {
    let middle = mean(&rim(film));
    let layout = &film.sheet.layout;
    let is_of = |v: &usize| layout.sides_of(*v).map(|side| layout.regions()[side].0).eq(regions);
    let points: Vec<DVec3> =
        (0..film.state.positions.len()).filter(is_of).map(|v| film.state.positions[v] - middle).collect();
    let axis = (film_centre(film, 2) - film_centre(film, 1)).normalize();
    let data: Vec<[f64; 2]> = points.iter().map(|x| [x.dot(axis), x.length_squared()]).collect();
    let count = data.len() as f64;
    let [mx, my] = [0, 1].map(|k| data.iter().map(|d| d[k]).sum::<f64>() / count);
    let slope = data.iter().map(|[x, y]| (x - mx) * (y - my)).sum::<f64>()
        / data.iter().map(|[x, _]| (x - mx).powi(2)).sum::<f64>();
    (my - slope * mx + 0.25 * slope * slope).sqrt()
}

/// Mean of the vertices of a region, metres.
fn film_centre(film: &Film, region: u32) -> DVec3 {
    let layout = &film.sheet.layout;
    let sides = (0..layout.side_count() as u32).filter(|side| layout.regions()[*side as usize].0 == region);
    let points: Vec<DVec3> = sides.map(|side| film.state.positions[layout.vertex_of(side) as usize]).collect();
    points.iter().sum::<DVec3>() / points.len() as f64
}

/// Outer radii of the double bubble at rest with these volumes, metres.
fn ideal(volumes: [f64; 2]) -> [f64; 2] {
    let wanted = volumes[1] / volumes[0];
    let (mut low, mut high) = (0.1, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let [large, small] = DoubleBubble::new(1.0, middle).volumes();
        if small / large < wanted { low = middle } else { high = middle }
    }
    let scale = (volumes[0] / DoubleBubble::new(1.0, high).volumes()[0]).cbrt();
    [scale, scale * high]
}

/// Angles at the border between spheres of these radii through a ring, degrees: outside, in bubble 1, in bubble 2.
fn angles_of(radii: [f64; 3], ring: f64) -> [f64; 3] {
    // Slopes against the axis: caps larger than half a sphere lean outwards.
    let [one, two, wall] = radii.map(|r| (ring / r).asin());
    let [a, b, c] = [std::f64::consts::PI - one, std::f64::consts::PI - two, wall];
    [360.0 - (a + b).to_degrees(), (a - c).to_degrees(), (b + c).to_degrees()]
}

/// What a double bubble at rest shows, each as a deviation: degrees, then parts of the exact value.
struct Shown {
    angles: f64,
    fitted_angles: f64,
    pressures: f64,
    wall: f64,
}

fn show(small: f64, edge: f64) -> Shown {
    let film = at_rest(small, edge);
    let fitted = [[0, 1], [0, 2], [1, 2]].map(|of| radius(&film, of));
    let ideal = ideal([1, 2].map(|region| film.volumes[&Region(region)]));
    let pressures = film.sheet.region_pressures();
    let off = |k: usize| (pressures[&Region(k as u32 + 1)] * ideal[k] / 2.0 - 1.0).abs();
    let largest = |angles: [f64; 3]| angles.map(|angle| (angle - 120.0).abs()).into_iter().fold(0.0, f64::max);
    let bend = 1.0 / ideal[1] - 1.0 / ideal[0];
    let shown = Shown {
        angles: deviation(&film).mean.to_degrees(),
        fitted_angles: largest(angles_of(fitted, ring_radius(&film))),
        pressures: off(0).max(off(1)),
        // Of a flat wall against the curvature of the outer films.
        wall: (1.0 / fitted[2] - bend).abs() / bend.max(f64::from(small == 1.0)),
    };
    report(format!(
        "R2/R1 {small}, {} vertices: angles {:.3} (fitted {:.3}) degrees, pressures {:.2e}, wall {:.2e}",
        film.state.positions.len(),
        shown.angles,
        shown.fitted_angles,
        shown.pressures,
        shown.wall
    ));
    shown
}

fn assert_plateau(shown: &Shown) {
    // Bars: 0.7 degrees, 1 %. Angles at single vertices scatter with the mesh; their mean does not.
    assert!(shown.angles < 0.7 && shown.fitted_angles < 0.7);
    assert!(shown.pressures < 0.01 && shown.wall < 0.01);
}

#[test]
fn equal_bubbles_meet_at_120_degrees_over_a_flat_wall_and_converge() {
    let [coarse, fine] = [0.3, 0.2].map(|edge| show(1.0, edge));
    assert_plateau(&fine);
    let order = (coarse.pressures / fine.pressures).ln() / 1.5f64.ln();
    assert!(order > 1.8, "order of the pressures: {order:.2}");
}

#[test]
fn uneven_bubbles_meet_at_120_degrees_over_a_curved_wall() {
    // The small bubble needs as many edges to its radius as the large one of the other test.
    assert_plateau(&show(0.56, 0.13));
}
