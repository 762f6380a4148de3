//! Plants in any Bevy app (feature `render`): drawn between growth steps, with light, shadow and wind.
//!
//! ```text
//!   Snapshot before ─┐                        ┌─ records of both states ─┐
//!                    ├─ pack (any thread) ────┤                          ├─ vertex shader mixes them
//!   Snapshot after ──┘    once a step         └─ chunks ─ shared meshes ─┘   by StepFraction, each frame
//! ```
//!
//! A host spawns a [`Drawn`] with the snapshots before and after a step and moves its [`StepFraction`] from 0 to 1;
//! between two steps the processor writes one small clock a frame, whatever the size of the plants.
//!
//! | to | add |
//! |---|---|
//! | draw snapshots that come from anywhere | [`PlantRenderPlugin`] and a [`Drawn`] |
//! | grow and draw plants of the app's own world | also [`BurgeonPlugins`](crate::BurgeonPlugins) and [`LiveGrowthPlugin`] |
//! | see walls, lamps, sun, sky and ground as they are sensed | [`SceneryPlugin`], and [`OutdoorCamera`] on a camera |

mod bark;
pub(crate) mod compiling;
mod drawn;
pub(crate) mod evidence;
mod live;
mod material;
mod noise;
mod offscreen;
mod overlay;
mod pack;
mod record;
mod scenery;
mod stage;

use bevy::prelude::*;

pub use drawn::{DrawSettings, Drawn, Ghost, Look, Marks, StepFraction, Wind};
pub use evidence::shows_plants;
pub use live::{GrowthPace, LiveGarden, LiveGrowthPlugin};
pub use offscreen::{PictureAndExit, offscreen_app, offscreen_target, take_picture};
pub use overlay::Overlay;
pub use scenery::{Daylight, OutdoorCamera, SceneryPlugin, ScenerySettings, SeenThrough, Tufts, is_software};
pub use stage::Stage;

/// Draws every [`Drawn`]. Needs Bevy's renderer (`PbrPlugin` and what it stands on).
pub struct PlantRenderPlugin;

/// What happens in a frame, in order, in [`PostUpdate`]. Hosts change [`Drawn`] before.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct PlantRenderSystems;

impl Plugin for PlantRenderPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(MaterialPlugin::<material::PlantMaterial>::default())
            .init_resource::<Wind>()
            .init_resource::<DrawSettings>()
            .init_resource::<material::ChunkMeshes>()
            .register_type::<Wind>()
            .register_type::<DrawSettings>()
            .register_type::<Look>()
            .register_type::<Marks>()
            .register_type::<StepFraction>()
            .add_systems(
                PostUpdate,
                (
                    blow,
                    stage::begin_packing,
                    stage::land,
                    stage::follow_looks,
                    stage::write_marks,
                    stage::write_clocks,
                )
                    .chain()
                    .in_set(PlantRenderSystems)
                    .before(bevy::camera::visibility::VisibilitySystems::CalculateBounds)
                    .before(TransformSystems::Propagate),
            );
        material::load_shader(app);
    }

    fn finish(&self, app: &mut App) {
        app.init_resource::<bark::BarkImage>();
    }
}

/// Lets the wind's time pass.
fn blow(time: Res<Time>, mut wind: ResMut<Wind>) {
    if wind.blows {
        wind.seconds += time.delta_secs();
    }
}
