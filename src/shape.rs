//! Geometry from a [`Snapshot`](crate::plant::Snapshot): branch tubes, leaf surfaces, no rendering.

pub mod bark;
pub mod blade;
pub mod crown;
pub mod foliage;
pub mod leaves;
pub mod levels;
pub(crate) mod noise;
pub mod outline;
pub mod paint;
pub(crate) mod shore;
mod surface;
pub mod tangents;
pub mod texture;
pub mod tubes;

pub use surface::{Place, Surface};
