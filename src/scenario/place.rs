//! Setting plants, solids, lamps and the sun into a world.

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::prelude::*;

use super::{EditError, PlacedLamp, PlacedSolid, PlacedSun, Planting, Scenario};
use crate::environment::{Ground, Lamp, Solid, Sun};
use crate::plant::Plant;
use crate::species::Species;

/// The species a run may plant, by name. A resource.
#[derive(Resource, Debug, Clone, Default, Reflect)]
#[reflect(Resource, Default)]
pub struct SpeciesBook(pub BTreeMap<String, Arc<Species>>);

/// The seed of the run, to which each planting adds its own. A resource.
#[derive(Resource, Debug, Clone, Copy, Default, Reflect)]
#[reflect(Resource, Default)]
pub struct RunSeed(pub u64);

pub(super) fn finite(field: &'static str, at: Vec3) -> Result<(), EditError> {
    if at.is_finite() && at.abs().max_element() <= 10_000.0 {
        return Ok(());
    }
    Err(EditError::Invalid { field, value: at.to_string(), allowed: "metres, at most 10 km from the origin" })
}

/// Makes the world's sky, ground and settings a scenario's.
pub(crate) fn set_conditions(world: &mut World, scenario: &Scenario) {
    world.insert_resource(scenario.sky);
    world.insert_resource(Ground(scenario.ground.then_some(0.0)));
    world.insert_resource(scenario.mechanisms);
    world.insert_resource(scenario.sensing);
}

pub(crate) fn sow(world: &mut World, planting: &Planting, species: Arc<Species>, seed: u64) -> Entity {
    let sown = world.spawn((
        Plant { species, seed: seed.wrapping_add(planting.seed) },
        Transform::from_translation(planting.at).with_rotation(
            Quat::from_rotation_y(planting.turn_deg.to_radians())
                * Quat::from_rotation_x(planting.tilt_deg.to_radians()),
        ),
    ));
    sown.id()
}

pub(crate) fn set_solid(world: &mut World, solid: &PlacedSolid) -> Entity {
    let placed = world.spawn((
        Name::new(solid.name.clone()),
        Solid { shape: solid.shape, color: solid.color.linear() },
        Transform::from_translation(solid.at)
            .with_rotation(Quat::from_rotation_y(solid.turn_deg.to_radians())),
    ));
    placed.id()
}

pub(crate) fn set_lamp(world: &mut World, lamp: &PlacedLamp) -> Entity {
    let placed = world.spawn((
        Name::new(lamp.name.clone()),
        Lamp { strength: lamp.strength, radius: lamp.radius, on: lamp.on, color: lamp.color.linear() },
        Transform::from_translation(lamp.at),
    ));
    placed.id()
}

pub(super) fn set_sun(world: &mut World, sun: Option<PlacedSun>) {
    let old: Vec<Entity> = world.query_filtered::<Entity, With<Sun>>().iter(world).collect();
    for entity in old {
        world.despawn(entity);
    }
    if let Some(sun) = sun {
        raise_sun(world, &sun);
    }
}

pub(crate) fn raise_sun(world: &mut World, sun: &PlacedSun) -> Entity {
    world.spawn((Sun { strength: sun.strength }, Transform::from_rotation(sun.rotation()))).id()
}

impl PlacedSun {
    /// Turn that takes +Z to where the sun stands.
    pub fn rotation(&self) -> Quat {
        Quat::from_rotation_y(self.azimuth_deg.to_radians())
            * Quat::from_rotation_x(-self.elevation_deg.to_radians())
    }
}
