//! The environment as entities and resources: what people drag about, gathered into a [`Scene`].

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::workers::Workers;
use super::{
    Lamp, Scene, Shore, Sky, Solid, StandingLamp, StandingSolid, Sun, SunLight, add_plants, probe::Sensing,
};
use crate::plant::Snapshot;

/// Height of the infinite ground, metres; `None` for no ground. A resource.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Resource)]
pub struct Ground(pub Option<f32>);

impl Default for Ground {
    fn default() -> Self {
        Self(Some(0.0))
    }
}

/// Sky, ground, sensing and the worker threads.
pub struct EnvironmentPlugin;

impl Plugin for EnvironmentPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Sky>()
            .init_resource::<Ground>()
            .init_resource::<Sensing>()
            .init_resource::<Workers>()
            .register_type::<Sky>()
            .register_type::<Ground>()
            .register_type::<Shore>()
            .register_type::<Sensing>()
            .register_type::<Workers>()
            .register_type::<Solid>()
            .register_type::<Lamp>()
            .register_type::<Sun>();
    }
}

/// Solids in their places, in an order that depends on nothing but where and what they are.
pub fn standing_solids<'a>(solids: impl Iterator<Item = (&'a Solid, &'a Transform)>) -> Vec<StandingSolid> {
    let mut standing: Vec<StandingSolid> = solids
        .map(|(solid, transform)| StandingSolid {
            shape: solid.shape.scaled(transform.scale),
            position: transform.translation,
            rotation: transform.rotation,
            color: solid.color,
        })
        .collect();
    standing
        .sort_by_cached_key(|s| (place(s.position), s.rotation.to_array().map(f32::to_bits), s.shape.bits()));
    standing
}

/// Lamps in their places, in an order that depends on nothing but where and what they are.
pub fn standing_lamps<'a>(lamps: impl Iterator<Item = (&'a Lamp, &'a Transform)>) -> Vec<StandingLamp> {
    let mut standing: Vec<StandingLamp> = lamps
        .map(|(lamp, transform)| StandingLamp { lamp: *lamp, position: transform.translation })
        .collect();
    standing.sort_by_cached_key(|l| (place(l.position), l.lamp.strength.to_bits(), l.lamp.radius.to_bits()));
    standing
}

fn place(position: Vec3) -> [u32; 3] {
    position.to_array().map(f32::to_bits)
}

/// Everything that stands in a world but its plants.
pub fn standing_scene(world: &mut World) -> Scene {
    let mut solids = world.query::<(&Solid, &Transform)>();
    let solids = standing_solids(solids.iter(world));
    let mut lamps = world.query::<(&Lamp, &Transform)>();
    let lamps = standing_lamps(lamps.iter(world));
    let mut suns = world.query::<(&Sun, &Transform)>();
    let sun = suns
        .iter(world)
        .map(|(sun, transform)| SunLight { direction: transform.rotation * Vec3::Z, strength: sun.strength })
        // Of equally strong ones the direction decides, never the order of entities.
        .max_by(|a, b| {
            let place = |sun: &SunLight| place(sun.direction);
            a.strength.total_cmp(&b.strength).then(place(a).cmp(&place(b)))
        });
    Scene {
        solids,
        lamps,
        sun,
        sky: world.get_resource::<Sky>().copied().unwrap_or_default(),
        ground: world.get_resource::<Ground>().copied().unwrap_or_default().0,
        shore: world.get_resource().copied(),
        ..Scene::default()
    }
}

/// Everything in a world that can be seen: what stands there, and its plants.
pub fn whole_scene(world: &mut World) -> Scene {
    let mut scene = standing_scene(world);
    add_plants(&mut scene, &Snapshot::take(world));
    scene
}
