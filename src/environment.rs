//! What a plant senses: everything that stands in its light or its way, and the cube maps that look at it.
//!
//! The environment knows capsules (wood), leaf patches, solids, lamps, sky, sun and ground; it never sees a
//! mesh. A [`Scene`] is plain data gathered once a step. [`CubeMap`](cube_map::CubeMap)s rendered in it at
//! [`Probe`](probe::Probe)s give every bud and leaf its light and space (`LK-13`).

pub mod cube_map;
pub mod direct_light;
pub mod gather;
pub mod obstacles;
pub mod plugin;
pub mod probe;
pub mod scene;
pub mod segment;
pub mod sense;
pub mod standing_wood;
pub mod stem_grid;
pub mod trace;
pub mod workers;

pub use gather::{add_plants, capsules};
pub use plugin::{EnvironmentPlugin, Ground, standing_solids, whole_scene};
pub use scene::{
    Capsule, Lamp, LeafPatch, Scene, Shore, Sky, SkyGradient, Solid, SolidShape, StandingLamp, StandingSolid,
    Sun, SunLight,
};
