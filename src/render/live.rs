//! Growth in the app's own world: plants spawned beside everything else grow while the app runs.

use std::sync::Arc;
use std::time::{Duration, Instant};

use bevy::prelude::*;

use super::{Drawn, StepFraction};
use crate::growth::grow;
use crate::plant::{Plant, Snapshot};

/// How fast plants in the app's world grow.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Reflect)]
#[reflect(Resource)]
pub struct GrowthPace {
    /// Growth steps a second.
    pub steps_per_second: f32,
    /// Time a frame may spend on growth, milliseconds. A step that takes longer is followed by as many frames
    /// without growth as bring the mean down to this.
    pub milliseconds_per_frame: f32,
    /// Whether growth stands still.
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
pub struct LiveGrowthPlugin;

impl Plugin for LiveGrowthPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<GrowthPace>()
            .init_resource::<Progress>()
            .register_type::<GrowthPace>()
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
}

/// Moves the clock on, and grows a step whenever the last has been shown.
fn live(world: &mut World) {
    let pace = *world.resource::<GrowthPace>();
    let passed = world.get_resource::<Time>().map_or(0.0, Time::delta_secs);
    let mut gardens = world.query_filtered::<Entity, With<LiveGarden>>();
    let garden = gardens.iter(world).next();
    let planted = world.query::<&Plant>().iter(world).next().is_some();
    let Some(garden) = garden else {
        if planted {
            let seeds = Drawn::still(Snapshot::take(world));
            world.spawn((LiveGarden, seeds));
        }
        return;
    };
    let mut progress = world.resource_mut::<Progress>();
    let allowance = Duration::from_secs_f32((pace.milliseconds_per_frame * 1e-3).max(0.0));
    progress.debt = progress.debt.saturating_sub(allowance);
    if !pace.paused {
        progress.fraction += passed * pace.steps_per_second.max(0.0);
    }
    // No catching up: a slow machine shows the same steps later.
    if progress.fraction >= 1.0 {
        if progress.debt > allowance {
            progress.fraction = 1.0;
        } else {
            progress.fraction = (progress.fraction - 1.0).min(0.5);
            let began = Instant::now();
            let next = advance(world);
            world.resource_mut::<Progress>().debt += began.elapsed();
            if let Some(mut drawn) = world.get_mut::<Drawn>(garden) {
                drawn.step_to(next);
            }
        }
    }
    let fraction = world.resource::<Progress>().fraction;
    if let Some(mut shown) = world.get_mut::<StepFraction>(garden) {
        shown.set_if_neq(StepFraction(fraction));
    }
}

/// One growth step. The one place where a step split into parts would be spread over frames.
fn advance(world: &mut World) -> Arc<Snapshot> {
    grow(world, 1);
    Arc::new(Snapshot::take(world))
}
