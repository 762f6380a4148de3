//! Setting plants, solids, lamps and the sun into a world.

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::math::ops;
use bevy::prelude::*;

use super::{EditError, PlacedLamp, PlacedSolid, PlacedSun, Planting, Scenario};
use crate::environment::obstacles::touches;
use crate::environment::{Ground, Lamp, Shore, Solid, StandingSolid, Sun, standing_solids};
use crate::plant::{Plant, PlantRecord};
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

/// Deepest a seed may lie, metres below the ground.
pub(crate) const DEEPEST_SEED_M: f32 = 0.1;

/// Whether a seed lies in a solid; one on top of it does not.
pub(crate) fn lies_in(solid: &StandingSolid, at: Vec3) -> bool {
    const ON_TOP: Vec3 = Vec3::new(0.0, 0.002, 0.0);
    touches(solid, at + ON_TOP, at + ON_TOP, 0.0)
}

/// Refuses to sow where nothing can come up.
pub(super) fn can_come_up(world: &mut World, at: Vec3) -> Result<(), EditError> {
    finite("at", at)?;
    let refused = |allowed| Err(EditError::Invalid { field: "at", value: at.to_string(), allowed });
    if world.get_resource::<Ground>().and_then(|ground| ground.0).is_some_and(|y| at.y < y - DEEPEST_SEED_M) {
        return refused("at most 0.1 m below the ground");
    }
    let mut solids = world.query::<(&Solid, &Transform)>();
    if standing_solids(solids.iter(world)).iter().any(|solid| lies_in(solid, at)) {
        return refused("a place outside of every solid");
    }
    Ok(())
}

/// Makes the world's sky, ground and settings a scenario's.
pub(crate) fn set_conditions(world: &mut World, scenario: &Scenario) {
    world.insert_resource(scenario.sky);
    world.insert_resource(Ground(scenario.ground.then_some(0.0)));
    set_shore(world, scenario.shore);
    world.insert_resource(scenario.mechanisms);
    world.insert_resource(scenario.sensing);
}

/// Has a world lie at a sea, or at none.
pub(super) fn set_shore(world: &mut World, shore: Option<Shore>) {
    match shore {
        Some(shore) => world.insert_resource(shore),
        None => drop(world.remove_resource::<Shore>()),
    }
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
        Transform::from_translation(solid.at).with_rotation(solid.rotation()),
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

impl PlacedSolid {
    fn rotation(&self) -> Quat {
        Quat::from_rotation_y(self.turn_deg.to_radians())
    }

    /// As the environment sees it.
    pub(crate) fn standing(&self) -> StandingSolid {
        StandingSolid {
            shape: self.shape,
            position: self.at,
            rotation: self.rotation(),
            color: self.color.linear(),
        }
    }
}

impl PlacedSun {
    /// The sun whose rotation takes +Z to where it stands, to a hundredth of a degree.
    pub fn of(rotation: Quat, strength: f32) -> Self {
        let (azimuth_deg, elevation_deg) = turn_and_rise(rotation);
        Self { elevation_deg, azimuth_deg, strength }
    }

    /// Turn that takes +Z to where the sun stands.
    pub fn rotation(&self) -> Quat {
        Quat::from_rotation_y(self.azimuth_deg.to_radians())
            * Quat::from_rotation_x(-self.elevation_deg.to_radians())
    }
}

impl Planting {
    /// How a plant that stands in a run with a seed was sown.
    pub fn of(plant: &PlantRecord, seed: u64) -> Self {
        let (turn_deg, rise) = turn_and_rise(plant.rotation);
        Self {
            species: plant.species.name.clone(),
            at: plant.position,
            turn_deg,
            // Tilting takes +Z down as the seedling leans towards it.
            tilt_deg: -rise,
            seed: plant.seed.wrapping_sub(seed),
        }
    }
}

/// Degrees a rotation turns about the vertical, and then raises +Z above the horizon, to a hundredth.
fn turn_and_rise(rotation: Quat) -> (f32, f32) {
    let (right, ahead) = (rotation * Vec3::X, rotation * Vec3::Z);
    // Of what points straight up the side still tells the turn.
    let turn = ops::atan2(-right.z, right.x);
    let level = ahead.x * ops::sin(turn) + ahead.z * ops::cos(turn);
    let hundredth = |angle: f32| (angle.to_degrees() * 100.0).round() / 100.0;
    (hundredth(turn), hundredth(ops::atan2(ahead.y, level)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sun_is_known_by_its_rotation_straight_above_too() {
        for (azimuth_deg, elevation_deg) in [(30.0, 50.0), (-120.0, 0.0), (75.5, 90.0), (180.0, 12.25)] {
            let sun = PlacedSun { elevation_deg, azimuth_deg, strength: 0.7 };
            let again = PlacedSun::of(sun.rotation(), 0.7);
            assert!((again.elevation_deg - elevation_deg).abs() < 0.011, "{again:?}");
            let turned = (again.azimuth_deg - azimuth_deg).rem_euclid(360.0);
            assert!(turned.min(360.0 - turned) < 0.011, "{again:?}, not {sun:?}");
        }
    }

    #[test]
    fn a_plant_tells_how_it_was_sown() {
        let mut world = World::new();
        for (turn_deg, tilt_deg) in [(0.0, 0.0), (82.0, 38.0), (-100.0, 45.0)] {
            let at = Vec3::new(0.6, 0.0, 1.4);
            let planting = Planting { species: "palm".into(), at, turn_deg, tilt_deg, seed: u64::MAX };
            let species = Arc::new(Species { name: "palm".into(), ..Species::default() });
            let entity = sow(&mut world, &planting, species.clone(), 7);
            let place = world.get::<Transform>(entity).copied().unwrap();
            let plant = world.get::<Plant>(entity).unwrap();
            let record = PlantRecord {
                species,
                seed: plant.seed,
                position: place.translation,
                rotation: place.rotation,
                store: Default::default(),
                ledger: Default::default(),
            };
            assert_eq!(Planting::of(&record, 7), planting);
        }
    }
}
