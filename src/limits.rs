//! Limits on what a run may take; reaching one stops with a message and keeps the result so far.

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
