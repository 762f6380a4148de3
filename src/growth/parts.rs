//! A growth step in parts, for hosts that draw frames: [`grow_in_parts`] leaves off when its time is up, and sensing,
//! nearly all of a step, runs on other threads meanwhile. What grows is bit for bit what [`grow`](super::grow) grows.
//!
//! ```text
//! frame      1          2          3 ... 20              21        22
//! host's     open  wake extend     (free)                choose    close   draws the step
//! others'                          look around ───────▶
//! ```
//!
//! [`GrowthStep`] runs once a step whether in parts or whole, systems of the host's own included, in the same order:
//! every system is asked whether it is its turn.

use core::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use bevy::ecs::error::{BevyError, ErrorContext};
use bevy::ecs::schedule::graph::DiGraph;
use bevy::ecs::schedule::{
    BoxedCondition, ConditionWithAccess, FixedBitSet, FlattenedDependencies, NodeId, ScheduleBuildError,
    ScheduleBuildPass, ScheduleGraph, SingleThreadedExecutor, SystemExecutor, SystemKey, SystemSchedule,
    SystemSetKey,
};
use bevy::platform::collections::HashSet;
use bevy::platform::hash::FixedHasher;
use bevy::prelude::*;
use indexmap::IndexSet;

use super::finish::StageTimes;
use super::sensing::{SensingJob, Survey, choose_growth_targets, gather_probes, render_cube_maps};
use super::{GrowthStep, generation::ensure_workers};
use crate::environment::workers::Workers;
use crate::plant::{Snapshot, shed_missing};

/// How many things a system that can leave off does before it looks at the time.
pub(super) const AT_ONCE: usize = 64;

/// How many times as long it takes to bear organs as to ask for them.
const BEARING: u32 = 3;

/// How far a call of [`grow_in_parts`] came.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PartOfStep {
    /// The step is over.
    Finished,
    /// There is more for this thread to do.
    More,
    /// Other threads look around; until they are ready a call does nothing.
    Looking,
}

/// Which system of a step is next, a resource. All of it is the business of [`grow_in_parts`].
#[derive(Resource, Debug, Default, Reflect)]
#[reflect(Resource, Default)]
pub struct StepParts {
    /// Systems that had their turn in this step.
    #[reflect(ignore)]
    done: AtomicUsize,
    /// Systems asked in this run of the schedule.
    #[reflect(ignore)]
    asked: AtomicUsize,
    /// Whether none had its turn in this run yet.
    #[reflect(ignore)]
    is_first: AtomicBool,
    /// Whether this run of the schedule leaves off here.
    #[reflect(ignore)]
    left_off: AtomicBool,
    /// What is left to the system that left off within its turn, by births or indices, if it has to be told.
    #[reflect(ignore)]
    pub(super) rest: Option<Range<u32>>,
    /// When to leave off; `None`: at the end of the step.
    #[reflect(ignore)]
    until: Option<Instant>,
    /// A snapshot whose memory the next look around uses again.
    #[reflect(ignore)]
    pub(super) spare: Snapshot,
    /// The first half of the snapshot from which organs are about to look around.
    #[reflect(ignore)]
    half: Option<Snapshot>,
    /// What other threads see.
    #[reflect(ignore)]
    looking: Option<JoinHandle<Looked>>,
}

/// What was seen, and how long it took.
struct Looked {
    job: SensingJob,
    shot: Snapshot,
    took: Duration,
}

impl core::fmt::Debug for Looked {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Looked").field("took", &self.took).finish_non_exhaustive()
    }
}

impl StepParts {
    /// Whether a step has begun and is not over.
    pub fn is_under_way(&self) -> bool {
        self.done.load(Ordering::Relaxed) > 0
    }

    /// Whether a system that could go on later should leave off: the time of this part is up.
    pub(super) fn is_time_up(&self) -> bool {
        self.until.is_some_and(|until| Instant::now() >= until)
    }

    /// Whether a system that has asked for births since some time should leave off: no time is left but for bearing them.
    pub(super) fn is_time_up_with_births(&self, since: Instant) -> bool {
        self.until.is_some_and(|until| {
            let now = Instant::now();
            now + (now - since) * BEARING >= until
        })
    }

    /// Leaves off within the system that has its turn: it has another at the beginning of the next part.
    pub(super) fn leave_off_within(&mut self) {
        *self.done.get_mut() -= 1;
        *self.left_off.get_mut() = true;
    }

    /// Whether the system that is asked, one after the other, has its turn.
    fn is_due(&self) -> bool {
        let k = self.asked.fetch_add(1, Ordering::Relaxed);
        if k < self.done.load(Ordering::Relaxed) || self.left_off.load(Ordering::Relaxed) {
            return false;
        }
        // The first of a run always has its turn, so that every call gets on.
        let is_first = self.is_first.swap(false, Ordering::Relaxed);
        if !is_first && self.is_time_up() {
            self.left_off.store(true, Ordering::Relaxed);
            return false;
        }
        self.done.store(k + 1, Ordering::Relaxed);
        true
    }
}

/// Grows a step, or goes on with one, for about as long as `budget`: no system is begun after it, those that take
/// longest leave off within, and whenever organs look around this thread leaves off at once and others go on. Call it
/// again, a frame later, until it is over.
///
/// Between two calls the world is the host's. What it changes counts from the next stage that reads it; a plant that is
/// despawned takes its organs along as ever. [`grow`](super::grow) and a plain run of [`GrowthStep`] bring a step that
/// is under way to its end first.
///
/// A run condition of a host's system is asked in every part: one that tells of what happened since it was last asked
/// (`run_once`, `resource_changed`) may miss its turn.
pub fn grow_in_parts(world: &mut World, budget: Duration) -> PartOfStep {
    let mut parts = world.resource_mut::<StepParts>();
    if parts.looking.as_ref().is_some_and(|looking| !looking.is_finished()) {
        return PartOfStep::Looking;
    }
    let under_way = parts.is_under_way();
    parts.until = Some(Instant::now() + budget);
    if under_way {
        shed_missing(world);
    }
    world.run_schedule(GrowthStep);
    let mut parts = world.resource_mut::<StepParts>();
    parts.until = None;
    match (parts.is_under_way(), &parts.looking) {
        (false, _) => PartOfStep::Finished,
        (true, None) => PartOfStep::More,
        (true, Some(_)) => PartOfStep::Looking,
    }
}

/// Brings a step that is under way to its end; waits for those who look around.
pub fn finish_step(world: &mut World) {
    if world.get_resource::<StepParts>().is_some_and(StepParts::is_under_way) {
        shed_missing(world);
        world.run_schedule(GrowthStep);
    }
}

/// Begins to look around; in parts, on other threads.
pub(super) fn begin_to_look(world: &mut World) {
    let mut parts = world.resource_mut::<StepParts>();
    // What others saw for seeds that are gone again has no reader.
    parts.looking = None;
    let half = parts.half.take();
    if parts.until.is_none() {
        gather_probes(world);
        return;
    }
    ensure_workers(world);
    let half = match half {
        Some(half) => half,
        None => {
            let spare = core::mem::take(&mut world.resource_mut::<StepParts>().spare);
            let half = spare.half_taken_anew(world);
            let mut parts = world.resource_mut::<StepParts>();
            if parts.is_time_up() {
                parts.half = Some(half);
                return parts.leave_off_within();
            }
            half
        }
    };
    let workers = world.resource::<Workers>().clone();
    let survey = Survey::finish(world, half);
    let look = move || {
        let began = Instant::now();
        let (mut job, shot) = survey.job();
        job.look(&workers);
        Looked { job, shot, took: began.elapsed() }
    };
    let mut parts = world.resource_mut::<StepParts>();
    match std::thread::Builder::new().name("burgeon looks around".into()).spawn(look) {
        Ok(looking) => {
            parts.looking = Some(looking);
            *parts.left_off.get_mut() = true;
        }
        // A system that gives no thread has to wait for its frame.
        Err(_) => gather_probes(world),
    }
}

/// Writes back what was seen.
pub(super) fn end_looking(world: &mut World) {
    if world.resource::<StepParts>().rest.is_some() {
        return choose_growth_targets(world);
    }
    match world.resource_mut::<StepParts>().looking.take().map(JoinHandle::join) {
        Some(Ok(Looked { job, shot, took })) => {
            world.resource_mut::<StageTimes>().add(took);
            job.install(world, shot);
        }
        // What went wrong there goes wrong here.
        Some(Err(panic)) => std::panic::resume_unwind(panic),
        None => render_cube_maps(world),
    }
    choose_growth_targets(world);
}

/// Runs the systems of a step whose turn it is, in order, on the calling thread.
pub(super) struct InParts(SingleThreadedExecutor);

impl Default for InParts {
    /// Commands are applied at the end of every part: the world is whole while the host has it.
    fn default() -> Self {
        Self(SingleThreadedExecutor::new())
    }
}

impl SystemExecutor for InParts {
    fn init(&mut self, schedule: &SystemSchedule) {
        self.0.init(schedule);
    }

    fn run(
        &mut self,
        schedule: &mut SystemSchedule,
        world: &mut World,
        skip: Option<&FixedBitSet>,
        error_handler: fn(BevyError, ErrorContext),
    ) {
        let mut parts = world.resource_mut::<StepParts>();
        *parts.asked.get_mut() = 0;
        *parts.is_first.get_mut() = true;
        *parts.left_off.get_mut() = false;
        if parts.is_under_way() {
            world.resource_mut::<StageTimes>().go_on();
        }
        self.0.run(schedule, world, skip, error_handler);
        let mut parts = world.resource_mut::<StepParts>();
        if *parts.left_off.get_mut() {
            world.resource_mut::<StageTimes>().pause();
        } else {
            *parts.done.get_mut() = 0;
            parts.rest = None;
        }
    }

    fn set_apply_final_deferred(&mut self, value: bool) {
        self.0.set_apply_final_deferred(value);
    }
}

/// Has every system of a schedule asked whether it is its turn, those of hosts included.
#[derive(Debug, Default)]
pub(super) struct TakeTurns {
    asked: HashSet<SystemKey>,
}

impl ScheduleBuildPass for TakeTurns {
    type EdgeOptions = ();

    fn add_dependency(&mut self, _: NodeId, _: NodeId, _: Option<&()>) {}

    fn collapse_set(
        &mut self,
        _: SystemSetKey,
        _: &IndexSet<SystemKey, FixedHasher>,
        _: &DiGraph<NodeId>,
    ) -> impl Iterator<Item = (NodeId, NodeId)> {
        core::iter::empty()
    }

    fn build(
        &mut self,
        world: &mut World,
        graph: &mut ScheduleGraph,
        _: FlattenedDependencies<'_>,
    ) -> Result<(), ScheduleBuildError> {
        let keys: Vec<SystemKey> = graph.systems.iter().map(|(key, ..)| key).collect();
        for key in keys {
            // A schedule that is built again keeps the conditions it has.
            if let Some(conditions) = graph.systems.get_conditions_mut(key)
                && self.asked.insert(key)
            {
                let mut condition: BoxedCondition =
                    Box::new(IntoSystem::into_system(|parts: Res<StepParts>| parts.is_due()));
                let access = condition.initialize(world);
                conditions.push(ConditionWithAccess { condition, access });
            }
        }
        Ok(())
    }
}
