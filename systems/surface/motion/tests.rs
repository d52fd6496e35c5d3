//! Films pushed into and through each other: they must not cross, and must not stand still for no reason.

use glam::DVec3;

use super::*;
use crate::kernel::crossing::triangles_cross;
use crate::rows::FaceRow;
use crate::surface::LabelledTriangles;

/// A flat sheet of `n` by `n` squares of side `edge` at height `z`.
fn sheet(n: u32, edge: f64, z: f64, pinned: impl Fn(u32, u32) -> bool) -> LabelledTriangles {
    let mut t = LabelledTriangles::default();
    for i in 0..=n {
        for j in 0..=n {
            t.add_vertex(DVec3::new(f64::from(i), f64::from(j), 0.0) * edge + DVec3::Z * z, pinned(i, j));
        }
    }
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let v = i * (n + 1) + j;
        t.add_film([v, v + n + 1, v + n + 2], [0, 1]);
        t.add_film([v, v + n + 2, v + 1], [0, 1]);
    }
    t
}

/// A sphere: an octahedron whose faces are quartered `times` times.
fn sphere(centre: DVec3, radius: f64, times: usize) -> LabelledTriangles {
    let mut points = vec![DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
    let mut triangles: Vec<[u32; 3]> =
        vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    for _ in 0..times {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                points.push((points[a as usize] + points[b as usize]).normalize());
                points.len() as u32 - 1
            })
        };
        let quarter = |[a, b, c]: [u32; 3]| {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        triangles = triangles.into_iter().flat_map(quarter).collect();
    }
    let mut t = LabelledTriangles::default();
    for x in &points {
        t.add_vertex(centre + *x * radius, false);
    }
    triangles.iter().for_each(|v| t.add_film(*v, [1, 0]));
    t
}

fn both(mut first: LabelledTriangles, second: &LabelledTriangles) -> Surface {
    first.append(second);
    Surface::from_triangles(&first)
}

fn mean_edge(surface: &Surface) -> f64 {
    let edges = surface.mesh.edges();
    let length = |[a, b]: &[VertexRow; 2]| surface.positions[*a].distance(surface.positions[*b]);
    edges.iter().map(length).sum::<f64>() / edges.len() as f64
}

/// Numbers in `-1..1` that are the same in every run.
fn noise(seed: u64) -> f64 {
    let mut z = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(0x1234_5678_9ABC_DEF1);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

fn noise_vector(seed: u64) -> DVec3 {
    DVec3::new(noise(3 * seed), noise(3 * seed + 1), noise(3 * seed + 2))
}

fn proposed(surface: &Surface, shift: impl Fn(usize, DVec3) -> DVec3) -> Vec<DVec3> {
    surface.positions.iter().enumerate().map(|(v, x)| *x + shift(v, *x)).collect()
}

/// Up to seven spheres of radius 1, `gap` apart.
fn cluster(count: usize, times: usize, gap: f64) -> Surface {
    let step = 2.0 + gap;
    let centres = [DVec3::ZERO, DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z];
    let mut all = LabelledTriangles::default();
    centres[..count].iter().for_each(|c| all.append(&sphere(*c * step, 1.0, times)));
    Surface::from_triangles(&all)
}

fn mean_motion(before: &[DVec3], surface: &Surface) -> f64 {
    before.iter().zip(surface.positions.iter()).map(|(a, b)| a.distance(*b)).sum::<f64>() / before.len() as f64
}

#[test]
fn what_meets_nothing_goes_all_the_way_in_one_round() {
    let mut surface = Surface::from_triangles(&sphere(DVec3::ZERO, 1.0, 4));
    let edge = mean_edge(&surface);
    let goal = proposed(&surface, |v, _| noise_vector(v as u64) * 0.05 * edge);
    let report = advance(&mut surface, &goal, &MotionSettings::new(edge));
    assert_eq!(surface.positions.0, goal);
    assert_eq!((report.limited_vertices, report.least_fraction, report.pinned_fraction), (0, 1.0, 1.0));
    assert_eq!(report.rounds, 1);
}

#[test]
fn two_sheets_do_not_pass_through_each_other() {
    let mut surface = both(sheet(12, 0.1, 0.0, |_, _| false), &sheet(11, 0.11, 0.2, |_, _| false));
    let settings = MotionSettings::new(0.1);
    let count = surface.positions.len();
    for step in 0..10 {
        let goal = proposed(&surface, |v, _| DVec3::Z * if v < 169 { 0.4 } else { -0.4 });
        let report = advance(&mut surface, &goal, &settings);
        assert_eq!(find_crossings(&surface, false), []);
        assert!(report.limited_vertices > 0 || step == 0);
        let highest = (0..169).map(|v| surface.positions.0[v].z).fold(f64::MIN, f64::max);
        let lowest = (169..count).map(|v| surface.positions.0[v].z).fold(f64::MAX, f64::min);
        assert!(lowest > 0.0 && highest < 0.2, "{lowest} {highest}");
    }
    let centre = |range: std::ops::Range<usize>| surface.positions.0[range].iter().map(|x| x.z).sum::<f64>();
    let distance = centre(169..count) / (count - 169) as f64 - centre(0..169) / 169.0;
    assert!(distance > 0.0 && distance < 0.1, "{distance}");
}

#[test]
fn a_sphere_is_not_shot_through_a_sheet() {
    let ball = sphere(DVec3::new(0.5, 0.5, 0.45), 0.3, 3);
    let balls = ball.positions.len();
    let mut surface = both(ball, &sheet(16, 0.0625, 0.0, |_, _| false));
    let settings = MotionSettings::new(0.0625);
    for _ in 0..20 {
        let goal = proposed(&surface, |v, _| DVec3::Z * if v < balls { -5.0 * 0.0625 } else { 0.0 });
        let report = advance(&mut surface, &goal, &settings);
        assert!(report.limited_vertices > 0);
        assert_eq!(find_crossings(&surface, false), []);
    }
    let lowest = surface.positions.0[..balls].iter().map(|x| x.z).fold(f64::MAX, f64::min);
    assert!(lowest < 0.02 && lowest > -0.5, "the sphere reaches the sheet: {lowest}");
}

#[test]
fn a_strip_does_not_fold_over_onto_itself() {
    let mut surface = Surface::from_triangles(&sheet(8, 0.1, 0.0, |_, _| false));
    let settings = MotionSettings::new(0.1);
    // The half beyond x = 0.4 turns about that line by 200 degrees in steps of 40.
    for _ in 0..5 {
        let turn = glam::DQuat::from_rotation_y(-40f64.to_radians());
        let hinge = DVec3::X * 0.4;
        let goal = proposed(&surface, |v, x| if v / 9 > 4 { hinge + turn * (x - hinge) - x } else { DVec3::ZERO });
        let before = surface.positions.0.clone();
        let _ = advance(&mut surface, &goal, &settings);
        assert!(mean_motion(&before, &surface) > 0.0);
        assert_eq!(find_crossings(&surface, false), []);
    }
}

#[test]
fn a_face_pushed_inside_out_stops_before() {
    let mut surface = Surface::from_triangles(&sheet(2, 1.0, 0.0, |_, _| false));
    let goal = proposed(&surface, |v, _| if v == 0 { DVec3::new(3.0, 3.0, 0.0) } else { DVec3::ZERO });
    let report = advance(&mut surface, &goal, &MotionSettings::new(1.0));
    assert!(report.limited_vertices == 1 && report.least_fraction > 0.1);
    assert!(surface.mesh.faces().all(|(row, _)| surface.double_area_normal(row).z.abs() > 0.05));
    assert_eq!(find_crossings(&surface, false), []);
}

#[test]
fn a_film_goes_along_with_its_wire() {
    let rim = |i: u32, j: u32| i == 0 || j == 0 || i == 8 || j == 8;
    let mut surface = Surface::from_triangles(&sheet(8, 0.1, 0.0, rim));
    let goal = proposed(&surface, |_, _| DVec3::Z * 0.3);
    let report = advance(&mut surface, &goal, &MotionSettings::new(0.1));
    assert_eq!(surface.positions.0, goal);
    assert_eq!((report.pinned_fraction, report.limited_vertices), (1.0, 0));
}

#[test]
fn a_wire_that_would_cut_through_a_film_is_cut_short() {
    let mut surface = both(sheet(4, 0.1, 0.13, |_, _| true), &sheet(8, 0.05, 0.0, |_, _| false));
    let goal = proposed(&surface, |v, _| DVec3::Z * if v < 25 { -0.5 } else { 0.0 });
    let report = advance(&mut surface, &goal, &MotionSettings::new(0.1));
    assert!(report.pinned_fraction < 0.26 && report.pinned_fraction > 0.1, "{report:?}");
    let way = surface.positions.0[..25].iter().map(|x| 0.13 - x.z);
    assert!(way.clone().all(|z| (z - 0.5 * report.pinned_fraction).abs() < 1e-12));
    assert_eq!(find_crossings(&surface, false), []);
}

#[test]
fn free_films_give_way_before_wires_do() {
    let mut surface = both(sheet(4, 0.1, 0.1, |_, _| true), &sheet(8, 0.05, 0.0, |_, _| false));
    let goal = proposed(&surface, |v, _| DVec3::Z * if v < 25 { 0.0 } else { 0.5 });
    let report = advance(&mut surface, &goal, &MotionSettings::new(0.1));
    assert_eq!(report.pinned_fraction, 1.0);
    assert!(report.limited_vertices > 0);
    assert_eq!(find_crossings(&surface, false), []);
}

#[test]
fn ghosts_let_films_pass_unless_told_otherwise() {
    let mut ghost = sheet(4, 0.1, 0.1, |_, _| true);
    ghost.ghosts.fill(true);
    let start = both(ghost, &sheet(8, 0.05, 0.0, |_, _| false));
    let goal = proposed(&start, |v, _| DVec3::new(0.013, 0.017, 0.5) * if v < 25 { 0.0 } else { 1.0 });
    let mut surface = start.clone();
    assert_eq!(advance(&mut surface, &goal, &MotionSettings::new(0.1)).limited_vertices, 0);
    let mut surface = start;
    let settings = MotionSettings { ghosts_collide: true, ..MotionSettings::new(0.1) };
    assert!(advance(&mut surface, &goal, &settings).limited_vertices > 0);
}

#[test]
fn wild_velocities_never_make_spheres_cross_and_something_moves() {
    let mut surface = cluster(3, 2, 0.02);
    let edge = mean_edge(&surface);
    assert_eq!(find_crossings(&surface, false), []);
    for step in 0..100 {
        let goal = proposed(&surface, |v, _| noise_vector(v as u64 + 10_000 * step) * 3.0 * edge);
        let before = surface.positions.0.clone();
        let report = advance(&mut surface, &goal, &MotionSettings::new(edge));
        assert_eq!(find_crossings(&surface, false), [], "step {step}: {report:?}");
        assert!(mean_motion(&before, &surface) > 1e-3 * edge, "step {step}: {report:?}");
    }
}

#[test]
fn spheres_pressed_together_for_long_never_cross() {
    let mut surface = cluster(7, 2, 0.02);
    let edge = mean_edge(&surface);
    for step in 0..60 {
        let goal = proposed(&surface, |v, x| -x * 0.1 + noise_vector(v as u64 + 10_000 * step) * 0.02 * edge);
        let report = advance(&mut surface, &goal, &MotionSettings::new(edge));
        assert_eq!(find_crossings(&surface, false), [], "step {step}: {report:?}");
    }
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let start = cluster(7, 4, 0.01);
    let edge = mean_edge(&start);
    let goal = proposed(&start, |v, x| -x * 0.05 + noise_vector(v as u64) * 0.5 * edge);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut surface = start.clone();
            let report = advance(&mut surface, &goal, &MotionSettings::new(edge));
            (report, surface.positions.iter().map(|x| x.to_array().map(f64::to_bits)).collect::<Vec<_>>())
        })
    };
    assert!(run(1) == run(2));
}

#[test]
fn the_unit_of_length_does_not_matter() {
    let start = cluster(7, 2, 0.02);
    let edge = mean_edge(&start);
    let run = |power: i32| {
        let scale = 2f64.powi(power);
        let mut surface = start.clone();
        surface.positions.iter_mut().for_each(|x| *x *= scale);
        let goal = proposed(&surface, |v, x| -x * 0.05 + noise_vector(v as u64) * (edge * scale));
        let report = advance(&mut surface, &goal, &MotionSettings::new(edge * scale));
        (report, surface.positions.iter().map(|x| *x / scale).collect::<Vec<_>>())
    };
    assert!(run(0) == run(-20) && run(0) == run(20));
}

#[test]
fn crossings_are_those_of_a_search_through_all_pairs() {
    let surface = both(sphere(DVec3::ZERO, 1.0, 3), &sphere(DVec3::new(0.9, 0.3, 0.1), 0.8, 3));
    let rows: Vec<FaceRow> = surface.mesh.faces().map(|(row, _)| row).collect();
    let data = |row: FaceRow| (surface.mesh.face(row).vertices(), surface.corners(row));
    let mut expected = Vec::new();
    for (i, a) in rows.iter().enumerate() {
        for b in &rows[i + 1..] {
            let ((va, xa), (vb, xb)) = (data(*a), data(*b));
            if triangles_cross(va, xa, vb, xb) {
                expected.push((*a, *b));
            }
        }
    }
    assert!(expected.len() > 50);
    assert_eq!(find_crossings(&surface, false), expected);
}

#[test]
fn crossings_with_ghosts_count_on_request_only() {
    let mut ghost = sheet(4, 0.25, 0.1, |_, _| true);
    ghost.ghosts.fill(true);
    let surface = both(ghost, &sphere(DVec3::new(0.51, 0.52, 0.0), 0.3, 2));
    assert_eq!(find_crossings(&surface, false), []);
    assert!(!find_crossings(&surface, true).is_empty());
}
