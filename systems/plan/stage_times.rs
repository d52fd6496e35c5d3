//! Wall time per stage, by markers on the borders between stages.

use std::time::{Duration, Instant};

use bevy_ecs::resource::Resource;
use bevy_ecs::schedule::{IntoScheduleConfigs, SystemSet};
use bevy_ecs::system::ResMut;
use bevy_ecs::world::World;

use super::SchedulePlan;
use crate::stage::{Part, Stage};

/// Wall time of each stage, of the last step and of all steps. Not part of the state of a run.
#[derive(Resource, Clone, Debug, Default)]
pub struct StageTimes {
    border: Option<Instant>,
    last: [Duration; Stage::ALL.len()],
    total: [Duration; Stage::ALL.len()],
    steps: u64,
}

/// The border after a stage; `None` begins a part of the step.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Border(Option<Stage>);

impl StageTimes {
    /// Adds the resource, and the markers to the schedules of a plan.
    ///
    /// Each marker is ordered against the stages on both sides, hence against every system of a stage.
    pub fn install(world: &mut World, plan: &mut SchedulePlan) {
        world.init_resource::<Self>();
        for (part, schedule) in plan.schedules_mut() {
            let begin = move |mut times: ResMut<Self>| times.begin(part);
            let mut before = Border(None);
            schedule.add_systems(begin.in_set(before));
            for stage in part.stages() {
                schedule.configure_sets((before, stage, Border(Some(stage))).chain());
                let close = move |mut times: ResMut<Self>| times.close(stage);
                before = Border(Some(stage));
                schedule.add_systems(close.in_set(before));
            }
        }
    }

    fn begin(&mut self, part: Part) {
        if part == Part::Begin {
            self.steps += 1;
            self.last = Default::default();
        }
        self.border = Some(Instant::now());
    }

    fn close(&mut self, stage: Stage) {
        let now = Instant::now();
        if let Some(since) = self.border {
            self.last[stage as usize] += now - since;
            self.total[stage as usize] += now - since;
        }
        self.border = Some(now);
    }

    /// Time of each stage in the last step.
    pub fn last(&self) -> impl Iterator<Item = (Stage, Duration)> {
        Stage::ALL.into_iter().zip(self.last)
    }

    /// Time of each stage in all steps together.
    pub fn total(&self) -> impl Iterator<Item = (Stage, Duration)> {
        Stage::ALL.into_iter().zip(self.total)
    }

    /// Steps that were timed.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Requires;
    use std::thread::sleep;

    #[test]
    fn time_is_counted_for_the_stage_that_takes_it() {
        let mut world = World::new();
        let mut plan = SchedulePlan::new();
        // An exclusive system conflicts with every marker unless the two are ordered.
        let dawdle = |_: &mut World| sleep(Duration::from_millis(20));
        plan.add(Stage::Dynamics, "dawdle", dawdle, Requires::nothing());
        StageTimes::install(&mut world, &mut plan);
        plan.run(&mut world);
        plan.run(&mut world);
        let times = world.resource::<StageTimes>();
        let of = |stage| times.total().find(|(other, _)| *other == stage).unwrap().1;
        assert_eq!(times.steps(), 2);
        assert!(of(Stage::Dynamics) >= Duration::from_millis(40));
        assert!(of(Stage::Forces) < Duration::from_millis(20));
    }
}
