//! Films in motion: shape oscillation, momentum, held vertices, errors.

use glam::DVec3;

use super::stable_step::{gershgorin_bound, stable_step};
use super::*;
use crate::calculus::area::vertex_integrals;
use crate::calculus::test_shapes::{double_bubble, flat_disc, icosphere, shaken};
use crate::calculus::{Incidence, Weights};
use crate::rows::{PerVertex, Region};
use crate::surface::Surface;

fn step(surface: &mut Surface, state: &mut FlowState, forcing: &Forcing<'_>, settings: &Settings, dt: f64) -> StepInfo {
    let mut flow = Flow::new(surface);
    let info = flow.propose(surface, state, forcing, settings, dt).unwrap();
    surface.positions.clone_from(&flow.proposal().positions);
    flow.finish(&surface.positions, dt, state);
    info
}

/// Amplitude of the mode `3 cos²θ - 1` in the distances from the origin.
fn amplitude(surface: &Surface) -> f64 {
    let incidence = Incidence::new(surface);
    let mut areas = vec![0.0; surface.positions.len()];
    vertex_integrals(&incidence, &surface.positions, Weights::Uniform(1.0), &mut areas);
    surface.positions.iter().zip(&areas).map(|(x, a)| a * x.length() * (3.0 * (x.z / x.length()).powi(2) - 1.0)).sum()
}

/// Angular frequency of the shape oscillation l = 2 of a sphere with β = 1 and R = 1, from its first quarters.
fn shape_frequency(level: u32, tangential: Tangential) -> f64 {
    let mut surface = icosphere(1.0, level);
    let mut state = FlowState::at_rest(&surface);
    for x in surface.positions.iter_mut() {
        *x *= 1.0 + 0.01 * (3.0 * x.z * x.z - 1.0);
    }
    let settings = Settings { tangential, ..Settings::default() };
    let mut flow = Flow::new(&surface);
    let rest = amplitude(&icosphere(1.0, level));
    let (dt, mut crossings) = (0.002, Vec::new());
    let mut before = amplitude(&surface) - rest;
    for k in 0..3000 {
        flow.propose(&surface, &state, &Forcing::uniform(1.0, 1.0), &settings, dt).unwrap();
        surface.positions.clone_from(&flow.proposal().positions);
        flow.finish(&surface.positions, dt, &mut state);
        let now = amplitude(&surface) - rest;
        if before * now < 0.0 {
            crossings.push(dt * (f64::from(k) + before / (before - now)));
            if crossings.len() == 3 {
                break;
            }
        }
        before = now;
    }
    std::f64::consts::TAU / (crossings[2] - crossings[0])
}

/// A massive membrane around a fixed volume: tension and pressure are both normal to a sphere to first order, so vertices
/// that may move in all directions do move radially, and a changing mass per vertex multiplies an acceleration that is
/// zero at rest. So `ω² = β (l - 1)(l + 2) / R²`: 2 for l = 2.
#[test]
fn a_bubble_swings_in_its_second_mode_at_the_frequency_of_a_massive_membrane() {
    let found = [2, 3, 4].map(|level| shape_frequency(level, Tangential::Remove));
    let free = shape_frequency(3, Tangential::Keep);
    let errors = found.map(|omega| (omega / 2.0 - 1.0).abs());
    // Level 3 has edges of 0.15 R, level 4 of 0.08 R.
    assert!(errors[1] < 0.03 && errors[2] < 0.01, "{errors:?}");
    assert!((free / 2.0 - 1.0).abs() < 0.03);
    assert!(errors[0] / errors[1] > 3.0, "{errors:?}");
}

#[test]
fn a_free_cluster_keeps_its_momentum_and_its_angular_momentum() {
    let mut surface = shaken(&double_bubble(1.0, 0.7, 4), 0.02);
    let mut masses = vec![0.0; surface.positions.len()];
    let incidence = Incidence::new(&surface);
    vertex_integrals(&incidence, &surface.positions, Weights::Uniform(1.0), &mut masses);
    let forcing = Forcing { mass: Mass::PerVertex(&masses), ..Forcing::uniform(1.0, 1.0) };
    let momentum = |state: &FlowState| state.velocities.iter().zip(&masses).map(|(u, m)| *u * *m).sum::<DVec3>();
    let angular = |surface: &Surface, state: &FlowState| -> DVec3 {
        let arms = surface.positions.iter().zip(state.velocities.iter()).zip(&masses);
        arms.map(|((x, u), m)| x.cross(*u) * *m).sum()
    };
    let mut state = FlowState::at_rest(&surface);
    let swirl = |x: &DVec3| DVec3::new(1.0 - 0.2 * x.y, 2.0 + 0.2 * x.x, -0.5);
    state.velocities = PerVertex(surface.positions.iter().map(swirl).collect());
    let (before, turning) = (momentum(&state), angular(&surface, &state));
    for tangential in [Tangential::Keep, Tangential::Remove] {
        let settings = Settings { tangential, ..Settings::default() };
        for _ in 0..50 {
            step(&mut surface, &mut state, &forcing, &settings, 0.01);
        }
    }
    let (lost, unwound) = ((momentum(&state) - before).length(), (angular(&surface, &state) - turning).length());
    assert!(lost < 1e-10 * before.length());
    assert!(unwound < 1e-10 * turning.length());
    step(&mut surface, &mut state, &forcing, &Settings { scheme: Scheme::Implicit, ..Settings::default() }, 0.05);
    // The implicit step conserves momentum as far as its linear solve does: 1e-8.
    assert!((momentum(&state) - before).length() < 1e-7 * before.length());
}

#[test]
fn implicit_steps_damp_an_oscillation_as_documented() {
    let (mut surface, dt) = (icosphere(1.0, 3), 0.02);
    let mut state = FlowState::at_rest(&surface);
    let rest = amplitude(&surface);
    for x in surface.positions.iter_mut() {
        *x *= 1.0 + 0.01 * (3.0 * x.z * x.z - 1.0);
    }
    let settings = Settings { scheme: Scheme::Implicit, tangential: Tangential::Remove, ..Settings::default() };
    let mut heights = Vec::new();
    for _ in 0..320 {
        step(&mut surface, &mut state, &Forcing::uniform(1.0, 1.0), &settings, dt);
        heights.push(amplitude(&surface) - rest);
    }
    let first = heights[100..220].iter().copied().fold(0.0, f64::max);
    let second = heights[220..].iter().copied().fold(0.0, f64::max);
    // k = l (l + 1) + 2 = 8, rate 8 * 0.02 / 2, over a period of π.
    let expected = (-0.08 * std::f64::consts::PI).exp();
    assert!((second / first / expected - 1.0).abs() < 0.02, "{} {expected}", second / first);
}

#[test]
fn large_implicit_steps_of_a_thin_film_stay_stable_and_keep_the_volume() {
    // β = 150 m²/s², R = 5 cm: explicit steps would have to be some 1e-4 s.
    let mut surface = icosphere(0.05, 3);
    for x in surface.positions.iter_mut() {
        x.z *= 1.2;
    }
    let mut state = FlowState::at_rest(&surface);
    let settings = Settings { scheme: Scheme::Implicit, ..Settings::default() };
    let area = surface.film_area();
    for _ in 0..200 {
        let info = step(&mut surface, &mut state, &Forcing::uniform(0.06, 4e-4), &settings, 0.01);
        assert!(info.volume_error < 1e-12);
    }
    assert!(surface.film_area() < area);
    let radii = surface.positions.iter().map(|x| x.length());
    assert!(radii.clone().fold(0.0, f64::max) / radii.fold(1.0, f64::min) < 1.02);
}

#[test]
fn the_stable_step_is_that_of_theory_and_longer_steps_blow_up() {
    let surface = flat_disc(1.0, 10);
    let incidence = Incidence::new(&surface);
    let mut areas = vec![0.0; surface.positions.len()];
    vertex_integrals(&incidence, &surface.positions, Weights::Uniform(1.0), &mut areas);
    let inverse: Vec<f64> = surface.pinned.iter().zip(&areas).map(|(p, a)| if *p { 0.0 } else { 1.0 / a }).collect();
    let bound = gershgorin_bound(&incidence, &surface.positions, Weights::Uniform(1.0), &inverse, &mut areas);
    // Equilateral faces of side 0.1 in the middle of the disc; its outer ones are up to a few per cent smaller.
    assert!((0.95..1.6).contains(&(bound / 800.0)), "{bound}");
    let longest = stable_step(bound, Motion::Inertial);
    let height_after = |safety: f64| {
        let mut surface = surface.clone();
        let free: Vec<usize> = (0..surface.pinned.len()).filter(|v| !surface.pinned.0[*v]).collect();
        free.iter().for_each(|v| surface.positions.0[*v].z += 1e-6 * (*v as f64 * 1.7).sin());
        let mut state = FlowState::at_rest(&surface);
        let settings = Settings { explicit_safety: safety, ..Settings::default() };
        for _ in 0..200 {
            step(&mut surface, &mut state, &Forcing::uniform(1.0, 1.0), &settings, safety * longest);
        }
        surface.positions.iter().map(|x| x.z.abs()).fold(0.0, f64::max)
    };
    assert!(height_after(0.95) < 1e-4);
    assert!(height_after(1.6) > 1e-3);
}

#[test]
fn long_steps_are_cut_into_stable_ones_or_refused() {
    let mut surface = icosphere(1.0, 3);
    let mut state = FlowState::at_rest(&surface);
    let info = step(&mut surface, &mut state, &Forcing::uniform(1.0, 1.0), &Settings::default(), 1.0);
    assert!((10..40).contains(&info.substeps), "{info:?}");
    let few = Settings { max_substeps: 5, ..Settings::default() };
    let mut flow = Flow::new(&surface);
    let refused = flow.propose(&surface, &state, &Forcing::uniform(1.0, 1.0), &few, 1.0).unwrap_err();
    assert!(matches!(refused, FlowError::TooManySubsteps { most: 5, .. }), "{refused}");
}

#[test]
fn held_vertices_go_where_they_are_told_in_both_schemes() {
    for scheme in [Scheme::Explicit, Scheme::Implicit] {
        let mut surface = flat_disc(1.0, 4);
        let mut state = FlowState::at_rest(&surface);
        let targets: Vec<DVec3> = surface.positions.iter().map(|x| *x + DVec3::new(0.0, 0.0, 0.1)).collect();
        let forcing = Forcing { targets: Some(&targets), ..Forcing::uniform(1.0, 1.0) };
        let settings = Settings { scheme, motion: Motion::Overdamped { mobility: 1.0 }, ..Settings::default() };
        for _ in 0..200 {
            step(&mut surface, &mut state, &forcing, &settings, 0.1);
        }
        // The disc follows its ring: to the residual of the solver.
        assert!(surface.positions.iter().all(|x| (x.z - 0.1).abs() < 1e-8), "{scheme:?}");
    }
}

#[test]
fn gravity_accelerates_a_free_bubble_as_a_whole() {
    for scheme in [Scheme::Explicit, Scheme::Implicit] {
        let mut surface = icosphere(1.0, 2);
        let mut state = FlowState::at_rest(&surface);
        let fall = DVec3::new(0.0, 0.0, -9.81);
        let mut masses = vec![0.0; surface.positions.len()];
        vertex_integrals(&Incidence::new(&surface), &surface.positions, Weights::Uniform(0.5), &mut masses);
        let forcing = Forcing {
            acceleration: Acceleration::Uniform(fall),
            mass: Mass::PerVertex(&masses),
            ..Forcing::uniform(1.0, 0.5)
        };
        let settings = Settings { scheme, ..Settings::default() };
        for _ in 0..10 {
            step(&mut surface, &mut state, &forcing, &settings, 0.01);
        }
        let whole: f64 = masses.iter().sum();
        let mean: DVec3 = state.velocities.iter().zip(&masses).map(|(u, m)| *u * (*m / whole)).sum();
        assert!((mean - fall * 0.1).length() < 1e-7, "{scheme:?} {mean}");
    }
}

#[test]
fn damping_takes_its_rate_from_a_flying_bubble() {
    let mut surface = icosphere(1.0, 1);
    let mut state = FlowState::at_rest(&surface);
    state.velocities.fill(DVec3::X);
    let settings = Settings { damping_rate: 3.0, ..Settings::default() };
    for _ in 0..10 {
        step(&mut surface, &mut state, &Forcing::uniform(1e-9, 1.0), &settings, 0.02);
    }
    assert!(state.velocities.iter().all(|u| (u.x - (-0.6f64).exp()).abs() < 1e-6));
}

#[test]
fn a_detour_of_the_tracker_is_in_the_velocity() {
    let surface = icosphere(1.0, 1);
    let mut state = FlowState::at_rest(&surface);
    let mut flow = Flow::new(&surface);
    flow.propose(&surface, &state, &Forcing::uniform(1.0, 1.0), &Settings::default(), 0.01).unwrap();
    flow.finish(&surface.positions, 0.01, &mut state);
    assert!(state.velocities.iter().all(|u| u.length() < 1e-12), "a mesh that was not let move is at rest");
}

#[test]
fn regions_without_target_and_lists_of_wrong_length_are_refused_by_name() {
    let surface = double_bubble(1.0, 0.7, 3);
    let mut state = FlowState::at_rest(&surface);
    state.target_volumes.remove(&Region(2));
    let mut flow = Flow::new(&surface);
    let mut propose = |state: &FlowState, forcing: &Forcing<'_>| {
        flow.propose(&surface, state, forcing, &Settings::default(), 0.01).map(|_| ())
    };
    let forcing = Forcing::uniform(1.0, 1.0);
    assert_eq!(propose(&state, &forcing), Err(FlowError::NoTarget { region: Region(2) }));
    state.adopt_regions(&surface);
    assert_eq!(propose(&state, &forcing), Ok(()));
    let short = Forcing { tension: Weights::PerFace(&[1.0]), ..forcing };
    let expected = surface.mesh.face_rows();
    assert_eq!(propose(&state, &short), Err(FlowError::WrongLength { what: "tensions", expected, found: 1 }));
}

#[test]
fn a_region_that_bursts_is_forgotten() {
    let mut surface = double_bubble(1.0, 0.7, 3);
    let mut state = FlowState::at_rest(&surface);
    let rows: Vec<_> = surface.mesh.faces().map(|(row, _)| row).collect();
    for row in rows {
        surface.mesh.relabel(row, |region| if region == Region(2) { Region(0) } else { region });
        if surface.mesh.face(row).labels() == [Region(0); 2] {
            surface.mesh.remove_face(row);
        }
    }
    state.adopt_regions(&surface);
    assert_eq!(state.target_volumes.keys().copied().collect::<Vec<_>>(), [Region(1)]);
    step(&mut surface, &mut state, &Forcing::uniform(1.0, 1.0), &Settings::default(), 0.01);
}

#[test]
fn a_scene_in_other_units_moves_alike() {
    for scheme in [Scheme::Explicit, Scheme::Implicit] {
        let ends = [1.0, 1e-6, 1e6].map(|unit: f64| {
            let mut surface = shaken(&double_bubble(1.0, 0.7, 4), 0.03);
            surface.positions.iter_mut().for_each(|x| *x *= unit);
            let mut state = FlowState::at_rest(&surface);
            let settings = Settings { scheme, ..Settings::default() };
            for _ in 0..5 {
                // Tension 1, mass per area 1: times go with the unit of length.
                step(&mut surface, &mut state, &Forcing::uniform(1.0, 1.0), &settings, 0.02 * unit);
            }
            surface.positions.iter().map(|x| *x / unit).collect::<Vec<_>>()
        });
        for other in &ends[1..] {
            assert!(ends[0].iter().zip(other).all(|(a, b)| a.distance(*b) < 1e-7), "{scheme:?}");
        }
    }
}
