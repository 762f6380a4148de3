//! Growth in the app's own world: plants spawned beside everything else grow while the app runs.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

use bevy::prelude::*;

use super::{Drawn, StepFraction};
use crate::growth::parts::{PartOfStep, grow_in_parts};
use crate::limits::limit_reached;
use crate::plant::{Roster, Snapshot};

/// How fast plants in the app's world grow.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Reflect)]
#[reflect(Resource)]
pub struct GrowthPace {
    /// Growth steps a second. No step is made up for: a slow machine shows the same steps later.
    pub steps_per_second: f32,
    /// Time a frame may spend on growth, milliseconds, at least 0.1. Other threads look around meanwhile; what is left
    /// of a step is done system by system, and one that takes longer is followed by as many frames without growth as
    /// bring the mean down to this.
    pub milliseconds_per_frame: f32,
    /// Whether growth stands still. A step that is under way is finished, but not shown.
    pub paused: bool,
}

impl Default for GrowthPace {
    fn default() -> Self {
        Self { steps_per_second: 0.5, milliseconds_per_frame: 4.0, paused: false }
    }
}

/// Grows the plants of the app's world at a [`GrowthPace`], and draws them.
///
/// Needs [`BurgeonPlugins`](crate::BurgeonPlugins) and [`PlantRenderPlugin`](super::PlantRenderPlugin). All plants
/// of the world are one [`Drawn`], marked [`LiveGarden`].
///
/// A step grows [in parts](crate::growth::parts) while the last one is shown, begun so that it is ready in time:
/// frames never wait for it, and what grows is bit for bit what [`grow`](crate::grow) grows. Organs are therefore up to
/// a step ahead of the picture, and what is changed in the world shows with the step after. On a machine with few cores
/// a [`Workers`](crate::environment::workers::Workers) with one thread fewer than there are leaves one to the game.
///
/// A despawned plant is gone from the world and from the picture at once. At a limit of
/// [`GrowthLimits`](crate::limits::GrowthLimits) growth stands still, what has grown stays, and the log says so once.
pub struct LiveGrowthPlugin;

impl Plugin for LiveGrowthPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<GrowthPace>()
            .init_resource::<Progress>()
            .register_type::<GrowthPace>()
            .register_type::<LiveGarden>()
            .add_systems(Update, live);
    }
}

/// Marks the [`Drawn`] of all plants that grow in the app's world.
#[derive(Component, Debug, Clone, Copy, Default, Reflect)]
#[reflect(Component)]
pub struct LiveGarden;

/// How far growth is.
#[derive(Resource, Debug, Default)]
struct Progress {
    /// Part of the step that is on screen.
    fraction: f32,
    /// Growth time spent beyond what frames allowed for.
    debt: Duration,
    /// What the next step is coming to.
    next: Next,
    /// Seconds since the step that is growing was begun.
    growing: f32,
    /// The limit that has been told of.
    told: Option<&'static str>,
    /// Seconds the last step took from then until it could be shown; `None` before the first.
    took: Option<f32>,
    /// Snapshots that were shown, whose memory serves again once nobody reads them.
    past: VecDeque<Arc<Snapshot>>,
}

/// The step after the one on screen.
#[derive(Debug, Default)]
enum Next {
    /// Not begun.
    #[default]
    Ahead,
    /// Under way.
    Growing,
    /// Over; its plants are to be looked at in two frames of their own.
    Grown,
    /// Half looked at.
    Seen(Box<Snapshot>),
    /// To be shown.
    Ready(Arc<Snapshot>),
}

/// Frames and part of the last step's time by which a step is begun early.
const EARLY: (f32, f32) = (4.0, 1.5);

/// Moves the clock on, shows what is ready and has the next step grow.
fn live(world: &mut World, mut gardens: Local<Option<QueryState<Entity, With<LiveGarden>>>>) {
    let gardens = gardens.get_or_insert_with(|| world.query_filtered());
    let Some(garden) = gardens.iter(world).next() else {
        if world.get_resource::<Roster>().is_some_and(|roster| roster.plants.iter().any(Option::is_some)) {
            let seeds = Drawn::still(Snapshot::take(world));
            world.spawn((LiveGarden, seeds));
            // There is nothing to see in a seed: the first step is shown as soon as it is there.
            world.resource_mut::<Progress>().fraction = 1.0;
        }
        return;
    };
    world.resource_scope(|world, mut progress: Mut<Progress>| {
        forget_the_gone(world, garden, &mut progress);
        let pace = *world.resource::<GrowthPace>();
        let passed = world.get_resource::<Time>().map_or(0.0, Time::delta_secs);
        progress.tick(&pace, passed);
        if progress.fraction >= 1.0 {
            if let (Next::Ready(shot), false) = (&progress.next, pace.paused)
                && let Some(mut drawn) = world.get_mut::<Drawn>(garden)
            {
                let past = drawn.before.clone();
                drawn.step_to(shot.clone());
                progress.past.push_back(past);
                progress.next = Next::Ahead;
                progress.fraction = (progress.fraction - 1.0).min(0.5);
            } else {
                // No catching up: the same steps are shown later.
                progress.fraction = 1.0;
            }
        }
        progress.get_on(world, &pace, passed);
        if let Some(mut shown) = world.get_mut::<StepFraction>(garden) {
            shown.set_if_neq(StepFraction(progress.fraction));
        }
    });
}

impl Progress {
    /// Lets time pass.
    fn tick(&mut self, pace: &GrowthPace, passed: f32) {
        if !pace.paused {
            self.fraction += passed * pace.steps_per_second.max(0.0);
        }
        self.growing += passed;
        self.debt = self.debt.saturating_sub(allowance(pace));
    }

    /// Does a frame's part of the next step.
    fn get_on(&mut self, world: &mut World, pace: &GrowthPace, passed: f32) {
        match &self.next {
            Next::Ready(_) => return,
            Next::Grown => {
                self.next = Next::Seen(Box::new(self.spare().half_taken_anew(world)));
                return;
            }
            Next::Seen(_) => {
                if let Next::Seen(half) = core::mem::take(&mut self.next) {
                    self.next = Next::Ready(Arc::new(half.other_half(world)));
                }
                self.took = Some(self.growing);
                return;
            }
            Next::Ahead if pace.paused || !self.is_time(pace, passed) => return,
            Next::Ahead | Next::Growing if self.debt > Duration::ZERO => return,
            Next::Ahead => {
                if self.is_at_a_limit(world) {
                    return;
                }
                self.growing = 0.0;
            }
            Next::Growing => {}
        }
        let began = Instant::now();
        self.next = match grow_in_parts(world, allowance(pace)) {
            PartOfStep::Finished => Next::Grown,
            PartOfStep::More | PartOfStep::Looking => Next::Growing,
        };
        self.debt += began.elapsed().saturating_sub(allowance(pace));
    }

    /// A snapshot nobody reads any more, if there is one.
    fn spare(&mut self) -> Snapshot {
        let free = self.past.iter().position(|shot| Arc::strong_count(shot) == 1);
        let spare = free.and_then(|free| self.past.remove(free)).and_then(Arc::into_inner);
        // Others have their own ends for what is read for so long.
        self.past.truncate(1);
        spare.unwrap_or_default()
    }

    /// Whether the next step might pass a limit; tells of each once.
    fn is_at_a_limit(&mut self, world: &World) -> bool {
        let began = Instant::now();
        let reached = limit_reached(world);
        self.debt += began.elapsed();
        if let Some(reached) = reached
            && self.told != Some(reached.what)
        {
            warn!("growth {reached}");
        }
        self.told = reached.map(|reached| reached.what);
        reached.is_some()
    }

    /// Whether a step begun now is ready just in time.
    fn is_time(&self, pace: &GrowthPace, passed: f32) -> bool {
        let Some(took) = self.took else { return true };
        let left = (1.0 - self.fraction).max(0.0) / pace.steps_per_second.max(f32::MIN_POSITIVE);
        left <= EARLY.0 * passed + EARLY.1 * took
    }
}

fn allowance(pace: &GrowthPace) -> Duration {
    let milliseconds = pace.milliseconds_per_frame;
    let milliseconds = if milliseconds.is_nan() { 0.1 } else { milliseconds.clamp(0.1, 1.0e6) };
    Duration::from_secs_f32(milliseconds * 1.0e-3)
}

/// Takes plants that were despawned out of the picture.
fn forget_the_gone(world: &mut World, garden: Entity, progress: &mut Progress) {
    let Some(drawn) = world.get::<Drawn>(garden) else { return };
    let Some(roster) = world.get_resource::<Roster>() else { return };
    let gone = |shot: &Snapshot| -> Vec<u32> {
        let plants = shot.plants.iter().enumerate();
        let gone =
            plants.filter(|(i, plant)| plant.is_some() && !matches!(roster.plants.get(*i), Some(Some(_))));
        gone.map(|(i, _)| i as u32).collect()
    };
    let without = |shot: &Arc<Snapshot>| {
        let gone = gone(shot);
        (!gone.is_empty()).then(|| Arc::new(shot.without(&gone)))
    };
    let is_still = Arc::ptr_eq(&drawn.before, &drawn.now);
    let now = without(&drawn.now);
    let before = if is_still { now.clone() } else { without(&drawn.before) };
    let ready = match &progress.next {
        Next::Ready(shot) => without(shot),
        _ => None,
    };
    if let Some(ready) = ready {
        progress.next = Next::Ready(ready);
    }
    if now.is_none() && before.is_none() {
        return;
    }
    if let Some(mut drawn) = world.get_mut::<Drawn>(garden) {
        drawn.now = now.unwrap_or_else(|| drawn.now.clone());
        drawn.before = before.unwrap_or_else(|| drawn.before.clone());
    }
}
