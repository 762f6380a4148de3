//! Geometry from a [`Snapshot`](crate::plant::Snapshot): branch tubes, leaf surfaces, no rendering.

pub mod outline;
