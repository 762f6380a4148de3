//! Geometry from a [`Snapshot`](crate::plant::Snapshot): branch tubes, leaf surfaces, no rendering.

pub mod bark;
pub mod foliage;
pub mod leaves;
pub mod outline;
mod surface;
pub mod tubes;

pub use surface::Surface;
