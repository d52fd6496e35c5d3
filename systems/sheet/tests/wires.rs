//! Films on wires, still and moving: a drum in air, a disc that is carried about, bubbles held on a ring, a held Plateau border.

mod common;

use common::spheres::{even_sphere, legendre};
use common::{Film, Settings, report};
use froth_surface::calculus::borders::Borders;
use froth_surface::shapes::{disc, double_bubble};
use froth_surface::{LabelledTriangles, Region, Surface};
use glam::DVec3;

/// `omega^2` of the slowest axisymmetric mode of a film on a ring in air, R = rho = T = 1: from the disc's Legendre functions (a
/// disc in an infinite fluid: Lamb 1932, §108) and 30 Bessel functions for the film.
const DRUM: f64 = 5.8598;
/// Most iterations on wires: conditions of 1.4 to 3.3 need about ten to 1e-10.
const MOST_ITERATIONS: u32 = 20;

fn drum(edge: f64) -> Film {
    Film::new(&disc(DVec3::ZERO, 1.0, DVec3::Z, edge), Settings::default())
}

fn mean_height(film: &Film) -> f64 {
    film.mean(|v| film.state.positions[v].z)
}

/// Angular frequency of the drum over the exact one, from zeros of its mean height.
fn drum_ratio(edge: f64) -> f64 {
    let mut film = drum(edge);
    // The first mode of a drum in air is close to that of one in a vacuum.
    film.reshape(|x| x + DVec3::Z * (1e-3 * (1.0 - x.length_squared()) * (1.0 - 0.25 * x.length_squared())));
    let dt = film.capillary_step(0.2);
    let (mut before, mut zeros) = (mean_height(&film), Vec::new());
    while zeros.len() < 5 {
        film.step(dt);
        let now = mean_height(&film);
        if before * now < 0.0 {
            zeros.push(film.time - dt * now / (now - before));
        }
        before = now;
        assert!(film.time < 40.0, "no period");
    }
    let ratio = 2.0 * std::f64::consts::TAU / (zeros[4] - zeros[0]) / DRUM.sqrt();
    report(format!("drum of {} vertices: {ratio:.5} of exact", film.state.positions.len()));
    ratio
}

#[test]
fn a_drum_in_air_rings_true() {
    for edge in [0.13, 0.09] {
        // Bar 0.5 % at 469 vertices. At the rim the circulation has a root, and the error is of first order: at these
        // meshes the film's own, of second order and the other sign, cancels part of it.
        let ratio = drum_ratio(edge);
        assert!((ratio - 1.0).abs() < 0.005, "{ratio:.5}");
    }
}

#[test]
#[ignore = "half a minute of pair sums: the ratio is at its largest, 1.0023, near a thousand vertices"]
fn a_fine_drum_in_air_rings_true() {
    for edge in [0.0625, 0.045] {
        let ratio = drum_ratio(edge);
        assert!((ratio - 1.0).abs() < 0.005, "{ratio:.5}");
    }
}

/// Moves the wires of a film at a velocity (m/s) for a step; their vertices are where the wire is.
fn carry(film: &mut Film, velocity: DVec3) {
    let pinned = &film.surface.pinned.0;
    film.wire_velocities = pinned.iter().map(|pinned| if *pinned { velocity } else { DVec3::ZERO }).collect();
}

/// Impulse of the air per density across an open film whose region in the back has the least label, m^4/s.
fn impulse(film: &Film) -> DVec3 {
    film.state.potentials.iter().zip(&film.sheet.geometry.gradients).map(|(phi, n)| *n * *phi).sum()
}

#[test]
fn a_disc_carried_along_its_axis_has_the_impulse_of_a_plate() {
    // A plate that moves at U across: Gamma = 4/pi U sqrt(1 - r^2), P = 8/3 rho U (Lamb 1932, §102).
    let off = |edge| {
        let speed = 0.05;
        let mut film = drum(edge);
        let normal = film.sheet.geometry.area_vectors[0].z.signum();
        let root = |x: DVec3| (1.0 - x.length_squared()).max(0.0).sqrt();
        film.set_circulation(|x| -normal * speed * 4.0 / std::f64::consts::PI * root(x));
        carry(&mut film, DVec3::Z * speed);
        let (mut impulses, mut farthest) = (Vec::new(), 0.0f64);
        film.run(0.4, 5.0, 1, |film| {
            impulses.push(impulse(film).z);
            farthest = farthest.max((mean_height(film) - speed * film.time).abs());
        });
        let mean = impulses.iter().sum::<f64>() / impulses.len() as f64 / speed * 0.375;
        report(format!(
            "plate of {} vertices: impulse {mean:.4} of 8/3 rho U a^3, film away by {farthest:.1e}",
            film.state.positions.len()
        ));
        // The plate's film stays flat but for the error of the start.
        assert!(farthest < 0.02 * speed * film.time);
        1.0 - mean
    };
    // The circulation has a root at the rim: first order in the edge.
    let [coarse, fine] = [0.13, 0.0625].map(off);
    assert!(coarse < 0.05 && fine < 0.65 * coarse, "{coarse} {fine}");
}

#[test]
fn a_film_follows_a_ring_that_starts_to_move() {
    let speed = 0.05;
    let mut film = drum(0.09);
    carry(&mut film, DVec3::Z * speed);
    let mut farthest = 0.0f64;
    film.run(0.4, 8.0, 1, |film| farthest = farthest.max((mean_height(film) - speed * film.time).abs()));
    let rim = (0..film.state.positions.len()).filter(|v| film.sheet.layout.is_rim(*v));
    let off = rim.map(|v| (film.state.positions[v].z - speed * film.time).abs()).fold(0.0, f64::max);
    // As a drum that is hit: the mean swings by U / omega about the ring.
    report(format!(
        "started ring: {off:.1e} off its way, film away by {farthest:.2e}, U / omega {:.2e}",
        speed / DRUM.sqrt()
    ));
    assert!(off < 1e-12 && farthest < 1.2 * speed / DRUM.sqrt());
}

/// Holds the vertices that `is_held` picks.
fn held(mut triangles: LabelledTriangles, is_held: impl Fn(usize, DVec3) -> bool) -> LabelledTriangles {
    for v in 0..triangles.positions.len() {
        triangles.pinned[v] = is_held(v, triangles.positions[v]);
    }
    triangles
}

/// Runs a film whose wires stay; most iterations and largest deviation of the energy over its largest kinetic part.
fn ring(mut film: Film, courant: f64, end: f64) -> (u32, f64) {
    let start = film.state.positions.clone();
    let whole: f64 = film.energies().iter().sum();
    let (mut iterations, mut largest, mut worst) = (0, 0.0f64, 0.0f64);
    film.run(courant, end, 2, |film| {
        iterations = iterations.max(film.sheet.measured.wires.iterations);
        let [kinetic, surface] = film.energies();
        largest = largest.max(kinetic);
        worst = worst.max((kinetic + surface - whole).abs());
    });
    for ((x, old), pinned) in film.state.positions.iter().zip(&start).zip(&film.surface.pinned.0) {
        assert!(!pinned || x.distance(*old) < 1e-14, "a wire moved");
    }
    (iterations, worst / largest)
}

#[test]
fn a_bubble_pinned_on_its_equator_rings_and_the_ring_stays() {
    let energy = |courant| {
        let set = held(even_sphere(4), |_, x| x.z.abs() < 1e-9);
        let mut film = Film::new(&set, Settings::default());
        film.reshape(|x| x * (1.0 + 0.1 * (legendre(2, x.z) - legendre(2, 0.0)) + 0.1 * legendre(3, x.z)));
        let (iterations, drift) = ring(film, courant, 10.0);
        report(format!("pinned equator, C {courant}: {iterations} iterations, energy {drift:.2e}"));
        assert!(iterations < MOST_ITERATIONS);
        drift
    };
    let [coarse, fine] = [0.3, 0.075].map(energy);
    assert!(coarse < 0.1 && fine < 0.5 * coarse);
}

#[test]
fn a_double_bubble_held_by_its_border_rings_and_the_border_stays() {
    let set = double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.7, 0.25);
    let borders = Borders::new(&Surface::from_triangles(&set));
    let on_border: Vec<usize> = borders.vertices().map(|v| v.index()).collect();
    for courant in [0.3, 0.1] {
        let mut film = Film::new(&held(set.clone(), |v, _| on_border.contains(&v)), Settings::default());
        let pinned = film.surface.pinned.0.clone();
        let heights: Vec<f64> = film.state.positions.iter().map(|x| x.x).collect();
        for (v, x) in film.state.positions.iter_mut().enumerate().filter(|(v, _)| !pinned[*v]) {
            x.x += 0.1 * heights[v] * x.y;
        }
        film.reshape(|x| x);
        let (iterations, drift) = ring(film, courant, 4.0);
        report(format!(
            "held border, C {courant}: {} held, {iterations} iterations, energy {drift:.2e}",
            on_border.len()
        ));
        assert!(iterations < MOST_ITERATIONS);
    }
}

#[test]
fn a_ring_carries_its_bubble_sideways() {
    let mut film = Film::new(&held(even_sphere(4), |_, x| x.z.abs() < 1e-9), Settings::default());
    let velocity = DVec3::new(0.1, 0.0, 0.0);
    carry(&mut film, velocity);
    let (mut iterations, mut farthest) = (0, 0.0f64);
    film.run(0.3, 10.0, 1, |film| {
        iterations = iterations.max(film.sheet.measured.wires.iterations);
        farthest = farthest.max((film.mean(|v| film.state.positions[v].x) - velocity.x * film.time).abs());
    });
    let volume = film.surface.volumes()[1] / film.volumes[&Region(1)] - 1.0;
    report(format!(
        "carried bubble: {iterations} iterations, away by {farthest:.2e} of {}, volume {volume:.1e}",
        velocity.x * film.time
    ));
    assert!(iterations < MOST_ITERATIONS && volume.abs() < 1e-12);
}
