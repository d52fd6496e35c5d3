//! The library's entrance: stepping, reading, plugging in, and what a fault says.

mod common;

use bevy_ecs::prelude::*;
use common::{SCENE, simulation};
use froth::Simulation;
use froth::method::{DiscretiseError, Method};
use froth::simulation::{BuildError, StepError};
use froth_components::clock::Clock;
use froth_components::columns;
use froth_components::identity::StableId;
use froth_components::kind::{EulerianParticle, LagrangianParticle};
use froth_components::motion::{ExternalAcceleration, Position, Velocity};
use froth_systems::clock::StepLimits;
use froth_systems::plan::{Requires, SchedulePlan};
use froth_systems::rows::registry::ColumnRegistry;
use froth_systems::rows::{fill_column, spawn_rows};
use froth_systems::stage::Stage;
use glam::DVec3;

columns! {
    /// A column that only some particles get, which is a mistake.
    pub struct Stray(f64), "stray", "1";
}

/// A method of the test's own: three points that fall.
const FALLING: Method = Method {
    name: "falling",
    summary: "points that fall",
    register: |world| {
        ColumnRegistry::register::<EulerianParticle, StableId>(world);
        ColumnRegistry::register::<EulerianParticle, Position>(world);
        ColumnRegistry::register::<EulerianParticle, Velocity>(world);
        ColumnRegistry::register::<EulerianParticle, ExternalAcceleration>(world);
    },
    discretise: spawn_three,
    assemble: |plan: &mut SchedulePlan| {
        plan.add(Stage::Clock, "limit", |mut l: ResMut<StepLimits>| l.propose("test", 0.004), Requires::nothing());
        plan.add(Stage::Advance, "fall", fall, Requires::nothing());
        plan.add(Stage::Scatter, "never", || {}, Requires::kind::<LagrangianParticle>());
    },
};

fn spawn_three(world: &mut World) -> Result<(), DiscretiseError> {
    spawn_rows::<EulerianParticle>(world, 3);
    fill_column::<EulerianParticle, _>(world, &[10, 11, 12].map(StableId));
    Ok(())
}

fn fall(mut points: Query<(&mut Position, &mut Velocity, &mut ExternalAcceleration)>, clock: Res<Clock>) {
    for (mut position, mut velocity, mut acceleration) in &mut points {
        velocity.0 += clock.step_length * std::mem::take(&mut acceleration.0);
        position.0 += clock.step_length * velocity.0;
    }
}

fn falling() -> Simulation {
    Simulation::builder().method(FALLING).build_from_text("small.ron", SCENE).unwrap()
}

fn pull(mut points: Query<&mut ExternalAcceleration>) {
    points.iter_mut().for_each(|mut acceleration| acceleration.0 += DVec3::X);
}

#[test]
fn steps_end_on_frames_and_on_targets_exactly() {
    let mut simulation = falling();
    let mut frames = Vec::new();
    while simulation.time() < 0.05 {
        let report = simulation.step().unwrap();
        assert!(report.step_length <= 0.004 && report.step_length > 0.003);
        assert_eq!(report.limited_by, Some("test"));
        frames.extend(report.frame.map(|frame| (frame, report.time)));
    }
    assert_eq!(frames, [(1, 0.01), (2, 0.02), (3, 0.03), (4, 0.04), (5, 0.05)]);
    simulation.advance_to(0.0555).unwrap();
    assert_eq!(simulation.time(), 0.0555);
    simulation.run().unwrap();
    assert_eq!(simulation.time(), 0.12);
}

#[test]
fn forces_act_in_a_method_of_ones_own() {
    let mut simulation = falling();
    simulation.add_force("pull", pull).add_force("pull again", pull);
    simulation.advance_to(0.1).unwrap();
    let velocities = simulation.column::<EulerianParticle, Velocity>();
    assert!(velocities.iter().all(|velocity| (velocity.0.x - 0.2).abs() < 1e-12));
    let names: Vec<String> = simulation.explain().into_iter().map(|system| system.name).collect();
    let wanted = ["limit", "choose the step length", "pull", "pull again", "never", "fall", "check for finite values"];
    assert_eq!(names, wanted);
    assert_eq!(simulation.explain()[4].unmet, ["lagrangian particles"]);
}

#[test]
fn a_fault_names_stage_component_particle_and_time_and_comes_again() {
    let mut simulation = falling();
    simulation.add_force("break", |mut points: Query<(&StableId, &mut ExternalAcceleration)>, clock: Res<Clock>| {
        for (id, mut acceleration) in &mut points {
            if id.0 == 11 && clock.time >= 0.01 {
                acceleration.0.y = f64::NAN;
            }
        }
    });
    let error = simulation.run().unwrap_err();
    let message = error.to_string();
    assert!(message.starts_with("step 4 from t = 0.010000000 s (length 3.333e-3 s) stopped in Observe"), "{message}");
    assert!(message.contains("`velocity` of eulerian particle 11 is not finite"), "{message}");
    assert_eq!(simulation.step(), Err(error));
    assert_eq!(simulation.time(), 0.01);
}

#[test]
fn a_component_on_some_particles_only_is_refused_before_the_step() {
    let mut simulation = falling();
    let world = simulation.world_mut();
    let first = world.query_filtered::<Entity, With<EulerianParticle>>().iter(world).next().unwrap();
    world.entity_mut(first).insert(Stray(1.0));
    assert!(matches!(simulation.step(), Err(StepError::Split(split)) if split.tables == 2));
}

#[test]
fn columns_can_be_read_and_written() {
    let mut simulation = Simulation::builder().column::<EulerianParticle, Stray>().method(FALLING);
    simulation = simulation.seed(5);
    let mut simulation = simulation.build_from_text("small.ron", SCENE).unwrap();
    simulation.set_column::<EulerianParticle, _>(&[Stray(1.0), Stray(2.0), Stray(3.0)]);
    simulation.step().unwrap();
    assert_eq!(simulation.column::<EulerianParticle, Stray>()[2], Stray(3.0));
    assert_eq!(simulation.scene().header.seed, 5);
}

#[test]
fn a_simulation_steps_in_any_thread() {
    let mut simulation = simulation();
    let stepped = std::thread::spawn(move || simulation.step().map(|report| report.step));
    assert_eq!(stepped.join().unwrap(), Ok(1));
}

#[test]
fn a_stage_that_works_takes_time() {
    let mut simulation = simulation();
    simulation.advance_to(0.01).unwrap();
    let times = simulation.stage_times();
    assert_eq!(times.steps(), simulation.clock().steps);
    assert!(times.total().any(|(stage, time)| stage == Stage::Dynamics && !time.is_zero()));
}

#[test]
fn a_factor_that_is_none_is_refused() {
    for factor in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = Simulation::builder().resolution(factor).build_from_text("small.ron", SCENE).err();
        assert!(matches!(error, Some(BuildError::ResolutionFactor { .. })), "{factor}");
    }
}
