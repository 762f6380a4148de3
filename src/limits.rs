//! Limits on what files may hold and a run may take.
//!
//! What a run takes is a resource, [`GrowthLimits`]: reaching one stops a [`Garden`](crate::scenario::Garden) with a
//! message and keeps the result so far, and so do plants that grow live.

use bevy::prelude::*;

use crate::growth::sensing::ProbeCount;
use crate::growth::{StepCount, forecast};
use crate::plant::Roster;

/// What a growing garden may take, a resource. [`Garden`](crate::scenario::Garden) looks before each step.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq, Reflect)]
#[reflect(Resource)]
pub struct GrowthLimits {
    /// Organs alive at once.
    pub organs: usize,
    /// Points from which organs look around in one step.
    pub probes: usize,
    /// Steps of one run.
    pub steps: usize,
    /// Memory, bytes, reckoned at [`ORGAN_BYTES`] for each living organ.
    pub memory: usize,
}

impl Default for GrowthLimits {
    fn default() -> Self {
        Self { organs: ORGANS, probes: PROBES, steps: STEPS as usize, memory: MEMORY }
    }
}

/// A limit that growth has come to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("stopped at step {step}: {what} {reached}, and {limit} is the limit")]
pub struct LimitReached {
    /// Steps grown.
    pub step: u32,
    /// What there is too much of.
    pub what: &'static str,
    /// How much there is.
    pub reached: usize,
    /// How much there may be.
    pub limit: usize,
}

/// The limit of a world's [`GrowthLimits`] that its next step might pass, if there is one: a step is not begun that
/// might not be ended.
pub fn limit_reached(world: &World) -> Option<LimitReached> {
    let most = world.get_resource::<GrowthLimits>().copied().unwrap_or_default();
    let step = world.get_resource::<StepCount>().map_or(0, |steps| steps.0);
    let probes = world.get_resource::<ProbeCount>().map_or(0, |probes| probes.0);
    let organs =
        world.get_resource::<Roster>().map_or(0, Roster::len).saturating_add(forecast::next_step(world));
    let taken = [
        ("probes in one step are", probes, most.probes),
        ("steps grown are", step as usize, most.steps),
        ("organs after the next step could be", organs, most.organs),
        ("bytes of memory after the next step could be", organs.saturating_mul(ORGAN_BYTES), most.memory),
    ];
    let (what, reached, limit) = taken.into_iter().find(|(_, reached, limit)| reached >= limit)?;
    Some(LimitReached { step, what, reached, limit })
}

/// Memory an organ takes while it grows, bytes: about 900 for its entity and snapshots, the rest for what it looks at
/// and what it may grow to.
pub const ORGAN_BYTES: usize = 2_500;
/// Memory of a run, bytes.
pub const MEMORY: usize = 8 << 30;
/// Points from which organs look around in one step.
pub const PROBES: usize = 2_000_000;

/// Organs alive at once.
pub const ORGANS: usize = 4_000_000;
/// Growth steps of one run.
pub const STEPS: u32 = 1_000_000;
/// Plants of one scenario.
pub const PLANTS: usize = 10_000;
/// Solids of one scenario.
pub const SOLIDS: usize = 10_000;
/// Lamps of one scenario.
pub const LAMPS: usize = 256;
/// Edits of one scenario.
pub const EDITS: usize = 100_000;
/// Texels along the side of a cube map's face.
pub const FACE: u32 = 512;
/// Entries of a list by branch order.
pub const ORDERS: usize = 64;
/// Bytes of a file people write.
pub const FILE_BYTES: u64 = 4 << 20;
/// Bytes of a skeleton file, which a program may have written.
pub const SKELETON_BYTES: u64 = 64 << 20;
/// Nested brackets of such a file.
pub const NESTING: usize = 64;
/// Sessions that ended in order whose saves are kept; of the others all are.
pub const SESSIONS: usize = 10;
/// Bytes of a save.
pub const SAVE_BYTES: u64 = 4 << 30;
/// Threads.
pub const THREADS: usize = 256;
/// Bytes of snapshots a [`Timeline`](crate::scenario::Timeline) keeps unless it is told otherwise.
pub const HISTORY_BYTES: usize = 1 << 30;
/// Characters of a share code.
pub const CODE_CHARACTERS: usize = 1 << 20;
