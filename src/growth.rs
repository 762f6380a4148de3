//! The loop (`LK-1`): all of a growth step, in order.
//!
//! ```text
//! Germinate  open new seeds · look around once
//! Generate   sprout · wake lateral buds · extend shoots (steered, round wood) · form nodes · unfold leaves ·
//!            thicken and bend wood
//! Update     photosynthesise · pay upkeep · shed liabilities · share surplus
//! Sense      gather scene and probes · look around · choose growth targets
//! Finish     close the books · count the step
//! ```
//!
//! [`grow`] runs [`GrowthStep`] as often as asked; it is not `FixedUpdate`, and no host ever catches up. A host that
//! draws frames grows a step [in parts](parts).

mod birth;
pub mod buds;
pub mod energy;
pub mod explain;
pub mod finish;
pub mod forecast;
pub mod generation;
pub mod liabilities;
pub mod nodes;
pub mod parts;
pub mod sag;
pub mod sensing;
pub mod share;
pub mod shoots;
pub mod sprouts;
pub mod vigour;
pub mod wood;

use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use finish::{StageTimes, time_stage};

/// One growth step.
#[derive(ScheduleLabel, Debug, Clone, PartialEq, Eq, Hash)]
pub struct GrowthStep;

/// The stages of a growth step, in order.
#[derive(SystemSet, Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Seeds open.
    Germinate,
    /// The tree generates new organs.
    Generate,
    /// It settles its energy.
    Update,
    /// It looks at light and space.
    Sense,
    /// The step is booked.
    Finish,
}

/// Growth steps finished.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq, Default, Reflect)]
#[reflect(Resource)]
pub struct StepCount(pub u32);

/// Which parts of the model run (figure 1 a to d of Lam & King), a resource.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq, Reflect, Serialize, Deserialize)]
#[reflect(Resource)]
#[serde(default, deny_unknown_fields)]
pub struct Mechanisms {
    /// Buds grow towards light, leaves earn by it; off: everything counts as fully lit.
    pub light: bool,
    /// Buds grow towards space and shoots round wood; off: everything counts as free.
    pub space: bool,
    /// Growth needs energy; off: every bud and leaf has all it can use, nothing is paid or shed.
    pub energy: bool,
}

impl Default for Mechanisms {
    fn default() -> Self {
        Self { light: true, space: true, energy: true }
    }
}

/// Adds the growth step to an app; it runs when the host calls [`grow`].
pub struct GrowthPlugin;

impl Plugin for GrowthPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<StepCount>()
            .init_resource::<Mechanisms>()
            .init_resource::<StageTimes>()
            .init_resource::<parts::StepParts>()
            .init_resource::<nodes::FreshNodes>()
            .init_resource::<generation::Condemned>()
            .init_resource::<share::Claims>()
            .init_resource::<crate::environment::standing_wood::StandingWood>()
            .init_resource::<sensing::SensingJob>()
            .init_resource::<sensing::ProbeCount>()
            .init_resource::<crate::limits::GrowthLimits>()
            .init_resource::<Messages<generation::BudBroke>>()
            .register_type::<StepCount>()
            .register_type::<Mechanisms>()
            .register_type::<StageTimes>()
            .register_type::<parts::StepParts>()
            .register_type::<nodes::FreshNodes>()
            .register_type::<generation::Condemned>()
            .register_type::<share::Claims>()
            .register_type::<crate::environment::standing_wood::StandingWood>()
            .register_type::<sensing::SensingJob>()
            .register_type::<sensing::ProbeCount>()
            .register_type::<crate::limits::GrowthLimits>()
            .register_type::<Messages<generation::BudBroke>>()
            .add_schedule(growth_step());
    }
}

/// The growth step, stage by stage.
fn growth_step() -> Schedule {
    let mut step = Schedule::new(GrowthStep);
    step.set_executor(parts::InParts::default()).add_build_pass(parts::TakeTurns::default());
    step.configure_sets(
        (Stage::Germinate, Stage::Generate, Stage::Update, Stage::Sense, Stage::Finish).chain(),
    );
    step.add_systems((
        (
            generation::open_books,
            generation::germinate,
            (parts::begin_to_look, parts::end_looking).chain().run_if(generation::any_germinated),
        )
            .chain()
            .in_set(Stage::Germinate),
        (
            sprouts::sprout,
            buds::wake_lateral_buds,
            shoots::gather_wood,
            shoots::extend_shoots,
            nodes::form_nodes,
            nodes::unfold_leaves,
            wood::thicken_wood,
            sag::bend_stems,
            generation::shed_condemned,
            generation::derive_poses,
            time_stage::<{ Stage::Generate as usize }>,
        )
            .chain()
            .in_set(Stage::Generate),
        (
            energy::photosynthesise,
            energy::pay_upkeep,
            liabilities::shed_liabilities,
            generation::shed_condemned,
            share::gather_claims,
            share::share_surplus,
            time_stage::<{ Stage::Update as usize }>,
        )
            .chain()
            .in_set(Stage::Update),
        (parts::begin_to_look, parts::end_looking, time_stage::<{ Stage::Sense as usize }>)
            .chain()
            .in_set(Stage::Sense),
        (finish::close_books, finish::count_step).chain().in_set(Stage::Finish),
    ));
    step
}

/// The three parts of sensing, at once.
pub(crate) fn look_around(world: &mut World) {
    sensing::gather_probes(world);
    sensing::render_cube_maps(world);
    sensing::choose_growth_targets(world);
}

/// Grows everything planted in the world by a number of steps.
///
/// The world needs [`BurgeonPlugins`](crate::BurgeonPlugins). A step [grown in parts](parts::grow_in_parts) that is
/// under way comes to its end first; it is not counted.
///
/// Bevy remembers what was removed until the app's next update; a world without an app forgets it with
/// [`World::clear_trackers`], to be called now and then in a long life.
pub fn grow(world: &mut World, steps: u32) {
    parts::finish_step(world);
    for _ in 0..steps {
        world.run_schedule(GrowthStep);
    }
}
