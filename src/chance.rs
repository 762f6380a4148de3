//! Chance: one random stream per organ, step and purpose, the same on every machine.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use crate::plant::Lineage;

/// What a draw is for; each purpose of an organ in a step has its own stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u64)]
pub enum Purpose {
    /// Rounding vigour to whole internodes.
    Rounding = 1,
    /// Whether a terminal bud dies.
    TerminalDeath = 2,
    /// Phyllotaxis and angles of new organs.
    Divergence = 3,
    /// Sensing error and disturbance of steering.
    Steering = 4,
    /// Crookedness of a new shoot.
    Wander = 5,
    /// Whether a bare node opens a new bud, and where.
    Sprouting = 6,
}

/// Finaliser of splitmix64: spreads every input bit over the output.
pub fn mix(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// The top 24 bits of a well mixed number as a number in 0..1.
pub(crate) fn share(bits: u64) -> f32 {
    (bits >> 40) as f32 / (1_u64 << 24) as f32
}

/// The random stream of an organ for one purpose in one step.
pub fn stream(plant_seed: u64, lineage: Lineage, step: u32, purpose: Purpose) -> Pcg64Mcg {
    let key = mix(plant_seed ^ mix(lineage.0 ^ mix(u64::from(step) << 8 | purpose as u64)));
    Pcg64Mcg::seed_from_u64(key)
}

/// A uniform draw in 0..1.
pub fn unit(rng: &mut Pcg64Mcg) -> f32 {
    use rand::RngExt;
    rng.random::<f32>()
}

/// A draw from the standard normal distribution.
pub fn normal(rng: &mut Pcg64Mcg) -> f32 {
    StandardNormal.sample(rng)
}
