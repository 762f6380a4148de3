//! Limits on what files may hold and a run may take.
//!
//! What a run takes is a resource, [`GrowthLimits`]: reaching one stops a [`Garden`](crate::scenario::Garden) with a
//! message and keeps the result so far.

use bevy::prelude::*;

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
/// Nested brackets of such a file.
pub const NESTING: usize = 64;
/// Bytes of a save.
pub const SAVE_BYTES: u64 = 4 << 30;
/// Threads.
pub const THREADS: usize = 256;
/// Bytes of snapshots a [`Timeline`](crate::scenario::Timeline) keeps unless it is told otherwise.
pub const HISTORY_BYTES: usize = 1 << 30;
/// Characters of a share code.
pub const CODE_CHARACTERS: usize = 1 << 20;
