//! What stands in a garden besides its plants.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::place;
use crate::environment::plugin::standing_lamps;
use crate::environment::{
    Lamp, Scene, Shore, Sky, Solid, SolidShape, StandingSolid, Sun, SunLight, standing_solids,
};
use crate::files::{FARTHEST_M, LARGEST_M};
use crate::growth::Mechanisms;

/// Solids, lamps, sun, sky and sea as they stand at one moment, and which parts of the model run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fixtures {
    /// Solids, by name.
    pub solids: Vec<Fixture<Solid>>,
    /// Lamps, by name.
    pub lamps: Vec<Fixture<Lamp>>,
    /// The sun, if it is up: the turn that takes +Z to where it stands, and its strength.
    pub sun: Option<(Quat, f32)>,
    /// The sky.
    pub sky: Sky,
    /// Where a sea begins, if there is one.
    pub shore: Option<Shore>,
    /// Which parts of the model run.
    pub mechanisms: Mechanisms,
}

/// A solid or lamp with its name and exact place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fixture<T> {
    /// Name by which edits find it.
    pub name: String,
    /// What it is.
    pub thing: T,
    /// Its centre, metres.
    pub position: Vec3,
    /// Its turn.
    pub rotation: Quat,
    /// Its scale, a factor along its own axes.
    pub scale: Vec3,
}

/// A fixture that cannot stand.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("`{field}` of {name:?} is {value}")]
pub struct FixtureError {
    /// Its name.
    pub name: String,
    /// What is wrong with it.
    pub field: &'static str,
    /// Its value.
    pub value: String,
}

impl<T> Fixture<T> {
    /// Its place, as Bevy has it.
    pub fn transform(&self) -> Transform {
        Transform { translation: self.position, rotation: self.rotation, scale: self.scale }
    }
}

impl Fixture<Solid> {
    /// As the environment sees it.
    pub fn standing(&self) -> StandingSolid {
        StandingSolid {
            shape: self.thing.shape.scaled(self.scale),
            position: self.position,
            rotation: self.rotation,
            color: self.thing.color,
        }
    }
}

impl Fixtures {
    /// What stands in a world.
    pub fn take(world: &mut World) -> Self {
        let mut suns = world.query::<(&Sun, &Transform)>();
        let sun = suns.iter(world).map(|(sun, transform)| (transform.rotation, sun.strength)).next();
        Self {
            solids: named_things(world),
            lamps: named_things(world),
            sun,
            sky: world.get_resource().copied().unwrap_or_default(),
            shore: world.get_resource().copied(),
            mechanisms: world.get_resource().copied().unwrap_or_default(),
        }
    }

    /// Has exactly this stand in a world, and nothing else.
    pub fn stand(&self, world: &mut World) {
        let mut old = world.query_filtered::<Entity, Or<(With<Solid>, With<Lamp>, With<Sun>)>>();
        for entity in old.iter(world).collect::<Vec<_>>() {
            world.despawn(entity);
        }
        for solid in &self.solids {
            world.spawn((Name::new(solid.name.clone()), solid.thing, solid.transform()));
        }
        for lamp in &self.lamps {
            world.spawn((Name::new(lamp.name.clone()), lamp.thing, lamp.transform()));
        }
        if let Some((rotation, strength)) = self.sun {
            world.spawn((Sun { strength }, Transform::from_rotation(rotation)));
        }
        world.insert_resource(self.sky);
        place::set_shore(world, self.shore);
        world.insert_resource(self.mechanisms);
    }

    /// As the environment sees it, over ground at a height.
    pub fn scene(&self, ground: Option<f32>) -> Scene {
        let solids: Vec<Transform> = self.solids.iter().map(Fixture::transform).collect();
        let lamps: Vec<Transform> = self.lamps.iter().map(Fixture::transform).collect();
        Scene {
            solids: standing_solids(self.solids.iter().map(|solid| &solid.thing).zip(&solids)),
            lamps: standing_lamps(self.lamps.iter().map(|lamp| &lamp.thing).zip(&lamps)),
            sun: self.sun.map(|(rotation, strength)| SunLight { direction: rotation * Vec3::Z, strength }),
            sky: self.sky,
            ground,
            shore: self.shore,
            ..Scene::default()
        }
    }

    /// Checks that all of it can stand.
    ///
    /// # Errors
    /// The first that cannot.
    pub(super) fn check(&self) -> Result<(), FixtureError> {
        for solid in &self.solids {
            solid.check_place()?;
            let sizes = match solid.standing().shape {
                SolidShape::Box { size } => size,
                SolidShape::Ball { radius } => Vec3::splat(radius),
                SolidShape::Cylinder { radius, height } => Vec3::new(radius, height, radius),
            };
            let fits = sizes.is_finite() && sizes.min_element() >= 0.0 && sizes.max_element() <= MOST_M;
            hold(fits, &solid.name, "shape", sizes)?;
        }
        for lamp in &self.lamps {
            lamp.check_place()?;
            hold(positive(lamp.thing.strength), &lamp.name, "strength", lamp.thing.strength)?;
            hold(positive(lamp.thing.radius), &lamp.name, "radius", lamp.thing.radius)?;
        }
        if let Some((rotation, strength)) = self.sun {
            hold(positive(strength), "sun", "strength", strength)?;
            hold(turned(rotation), "sun", "rotation", rotation)?;
        }
        if let Some(shore) = self.shore {
            hold(shore.azimuth_deg.is_finite(), "shore", "azimuth_deg", shore.azimuth_deg)?;
            hold(shore.distance_m.is_finite(), "shore", "distance_m", shore.distance_m)?;
        }
        hold(positive(self.sky.strength), "sky", "strength", self.sky.strength)
    }
}

/// Ten times what a scenario may ask for: scale makes a solid larger.
const MOST_M: f32 = 10.0 * LARGEST_M as f32;

fn positive(x: f32) -> bool {
    x.is_finite() && x >= 0.0
}

fn turned(rotation: Quat) -> bool {
    rotation.is_finite() && (rotation.length() - 1.0).abs() < 0.1
}

fn hold(good: bool, name: &str, field: &'static str, value: impl ToString) -> Result<(), FixtureError> {
    if good { Ok(()) } else { Err(FixtureError { name: name.into(), field, value: value.to_string() }) }
}

impl<T> Fixture<T> {
    fn check_place(&self) -> Result<(), FixtureError> {
        let near = self.position.is_finite() && self.position.abs().max_element() <= FARTHEST_M as f32;
        hold(near, &self.name, "position", self.position)?;
        hold(turned(self.rotation), &self.name, "rotation", self.rotation)?;
        hold(self.scale.is_finite(), &self.name, "scale", self.scale)
    }
}

fn named_things<T: Component + Copy>(world: &mut World) -> Vec<Fixture<T>> {
    let mut things = world.query::<(&Name, &T, &Transform)>();
    let mut standing: Vec<Fixture<T>> = things
        .iter(world)
        .map(|(name, thing, transform)| Fixture {
            name: name.to_string(),
            thing: *thing,
            position: transform.translation,
            rotation: transform.rotation,
            scale: transform.scale,
        })
        .collect();
    standing.sort_by(|a, b| a.name.cmp(&b.name));
    standing
}
