//! Geometry from a [`Snapshot`](crate::plant::Snapshot): branch tubes, leaf surfaces, no rendering.

pub mod foliage;
pub mod outline;
