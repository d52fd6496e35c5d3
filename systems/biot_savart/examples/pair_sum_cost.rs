//! What pair sums cost, and how far the fast one is off: processor seconds over all threads, from some hundred panels to a million.
//!
//! ```text
//! cargo run --release -p froth_biot_savart --example pair_sum_cost                      # 1e-3, up to a million panels
//! cargo run --release -p froth_biot_savart --example pair_sum_cost -- 1e-4 20480 81920  # error bound, panels
//! ```
//!
//! The sheet is a sphere with waves of degree 2 and 6. Of several runs the cheapest is shown. Errors are held against direct sums
//! at vertices spread over the sphere: relative, root mean square, in potentials and in normal velocities from fluxes.

#![allow(clippy::print_stdout, reason = "the table is what the program is for")]

#[path = "../tests/common/mod.rs"]
mod common;

use std::time::{Duration, Instant};

use common::Sheet;
use froth_biot_savart::{Accuracy, PairSum, PanelSums, Summation};
use glam::DVec3;
use rustix::time::{ClockId, clock_gettime};

/// Panels above which the direct sum is not run whole.
const MOST_DIRECT: usize = 100_000;

/// Vertices at which errors are measured.
const SAMPLES: usize = 300;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let tolerance = arguments.next().map_or(1e-3, |text| text.parse().expect("an error bound"));
    let mut sizes: Vec<f64> = arguments.map(|text| text.parse().expect("a number of panels")).collect();
    if sizes.is_empty() {
        sizes = [320.0, 1280.0, 2420.0, 5120.0, 20_480.0, 81_920.0, 327_680.0, 1_000_000.0].into();
    }
    println!(
        "bound {tolerance:e} on the relative error of normal velocities; processor seconds over all threads, wall in brackets"
    );
    println!(
        "{:>8} {:>17} {:>17} {:>9} {:>17} {:>17} {:>5} {:>5} {:>8} {:>8}",
        "panels",
        "direct, both",
        "potential",
        "place",
        "fast, both",
        "potential",
        "order",
        "theta",
        "error A",
        "error u"
    );
    sizes.into_iter().for_each(|size| print_row(size, tolerance));
}

fn print_row(size: f64, tolerance: f64) {
    // An icosphere of frequency f has 20 f² faces with edges of 1.2/f.
    let sheet = common::sphere(1.2 / (size / 20.0).sqrt().round());
    let panels = sheet.centres.len();
    let mut direct = sheet.sum(Summation::Direct);
    let [both, potential] = if panels <= MOST_DIRECT {
        cost(&mut direct, &sheet).map(|spent| spent.to_string())
    } else {
        ["-".into(), "-".into()]
    };
    let mut fast = sheet.sum(Summation::Fast { tolerance });
    let place = measure(|| fast.place(&sheet.centres)).processor.as_secs_f64();
    let [fast_both, fast_potential] = cost(&mut fast, &sheet).map(|spent| spent.to_string());
    let Accuracy { order, opening } = fast.accuracy().expect("a fast sum expands");
    let [a, u] = errors(&mut fast, &mut direct, &sheet);
    println!(
        "{panels:8} {both:>17} {potential:>17} {place:9.4} {fast_both:>17} {fast_potential:>17} {order:5} {opening:5.2} {a:8.1e} {u:8.1e}"
    );
}

/// Time spent.
#[derive(Clone, Copy)]
struct Spent {
    processor: Duration,
    wall: Duration,
}

impl std::fmt::Display for Spent {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:.4} ({:.4})", self.processor.as_secs_f64(), self.wall.as_secs_f64())
    }
}

/// Time that all threads of this process have spent on processors.
fn process_time() -> Duration {
    let now = clock_gettime(ClockId::ProcessCPUTime);
    Duration::new(now.tv_sec as u64, now.tv_nsec as u32)
}

fn measure(work: impl FnOnce()) -> Spent {
    let (processor, wall) = (process_time(), Instant::now());
    work();
    Spent { processor: process_time() - processor, wall: wall.elapsed() }
}

/// The cheapest of several runs, fewer of long ones.
fn cheapest(mut work: impl FnMut()) -> Spent {
    let first = measure(&mut work);
    let repeats = if first.wall > Duration::from_secs(1) { 1 } else { 5 };
    (0..repeats).map(|_| measure(&mut work)).fold(first, |a, b| if b.processor < a.processor { b } else { a })
}

/// Cost of potentials with gradients, and of potentials alone.
fn cost(sum: &mut PairSum, sheet: &Sheet) -> [Spent; 2] {
    let mut sums = PanelSums::default();
    let both = cheapest(|| sum.potentials_and_gradients(&sheet.strengths, &mut sums).expect("one strength per panel"));
    let potential =
        cheapest(|| sum.potentials(&sheet.strengths, &mut sums.potentials).expect("one strength per panel"));
    [both, potential]
}

/// Errors of potentials and normal velocities at vertices spread over the sheet.
fn errors(fast: &mut PairSum, direct: &mut PairSum, sheet: &Sheet) -> [f64; 2] {
    let stride = sheet.films.positions.len().div_ceil(SAMPLES);
    let touches =
        |face: &usize| sheet.films.triangles[*face].iter().any(|vertex| (*vertex as usize).is_multiple_of(stride));
    let faces: Vec<usize> = (0..sheet.centres.len()).filter(touches).collect();
    let places: Vec<DVec3> = faces.iter().map(|face| sheet.centres[*face]).collect();
    let (mut approximate, mut exact) = (vec![], vec![]);
    fast.potentials(&sheet.strengths, &mut approximate).expect("one strength per panel");
    direct.potentials_at(&sheet.strengths, &places, &mut exact).expect("one strength per panel");
    let at_faces: Vec<DVec3> = faces.iter().map(|face| approximate[*face]).collect();
    // Fluxes of sampled vertices need the potentials of their own faces only.
    let mut reference = vec![DVec3::ZERO; sheet.centres.len()];
    faces.iter().zip(&exact).for_each(|(face, potential)| reference[*face] = *potential);
    let of_samples = |potentials: &[DVec3]| -> Vec<f64> {
        let velocities = sheet.normal_velocities(potentials);
        velocities.chunks(sheet.films.region_count() as usize).step_by(stride).flatten().copied().collect()
    };
    let velocities = common::relative_error_of_numbers(&of_samples(&approximate), &of_samples(&reference));
    [common::relative_error(&at_faces, &exact), velocities]
}
