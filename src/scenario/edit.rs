//! The one way to change anything: [`Edit`].

use std::sync::Arc;

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::place::{self, SpeciesBook};
use super::preview::is_inside;
use super::{PlacedLamp, PlacedSolid, PlacedSun, Planting};
use crate::environment::plugin::standing_solids;
use crate::environment::{Lamp, Sky, Solid};
use crate::files::parse_value;
use crate::growth::Mechanisms;
use crate::plant::{Cause, Identity, Internode, Lineage, Plant, Pose, Roster, plant_transform, shed};
use crate::species::Species;

/// A change to a garden.
#[derive(Debug, Clone, PartialEq, Reflect, Serialize, Deserialize)]
pub enum Edit {
    /// Sow a plant.
    Plant(Planting),
    /// Set a solid. Living wood inside it and all it bears is shed (`Crushed`).
    PlaceSolid(PlacedSolid),
    /// Set a lamp.
    PlaceLamp(PlacedLamp),
    /// Move a solid or lamp. A solid moved onto living wood sheds it.
    Move {
        /// Its name.
        name: String,
        /// Its new centre, metres.
        to: Vec3,
        /// Its new turn about the vertical, degrees.
        turn_deg: f32,
    },
    /// Move, turn and scale a solid or lamp at once, as a gizmo does. A solid set onto living wood sheds it; of a
    /// lamp only the place is looked at.
    Pose {
        /// Its name.
        name: String,
        /// Its new centre, metres.
        to: Vec3,
        /// Its new turn about x, y and z, degrees: first about its own y, then x, then z.
        rotation_deg: Vec3,
        /// Its new size along its own axes, as a factor to the shape it was placed with, 0.01 to 100.
        scale: Vec3,
    },
    /// Set a copy of a solid or lamp, turned and scaled as that is. A solid set onto living wood sheds it.
    Duplicate {
        /// The name of what is copied.
        name: String,
        /// The name of the copy.
        copy: String,
        /// The centre of the copy, metres.
        to: Vec3,
    },
    /// Set how strong and how large a lamp is.
    Shine {
        /// Its name.
        name: String,
        /// Radiance of its surface, as a multiple of a full sky's.
        strength: f32,
        /// Its radius, metres.
        radius: f32,
    },
    /// Switch a lamp on or off.
    Switch {
        /// Its name.
        name: String,
        /// On or off.
        on: bool,
    },
    /// Take away a solid or lamp.
    Remove {
        /// Its name.
        name: String,
    },
    /// Cut an organ and all it bears.
    Prune {
        /// The plant, in the order of planting.
        plant: u32,
        /// Lineage of the organ.
        lineage: u64,
    },
    /// Cut everything of a plant that begins above a height.
    Top {
        /// The plant, in the order of planting.
        plant: u32,
        /// Height, metres.
        above: f32,
    },
    /// Shear all plants to a block: cut every side axis, leaf and tip of theirs that reaches out of it.
    Shear {
        /// One corner, metres.
        from: Vec3,
        /// The opposite corner, metres.
        to: Vec3,
    },
    /// Remove a plant.
    Uproot {
        /// The plant, in the order of planting.
        plant: u32,
    },
    /// Set a parameter of all plants of a species.
    Set {
        /// Name of the species.
        species: String,
        /// The parameter.
        parameter: String,
        /// Its value, as after `=` in `--set`.
        value: String,
    },
    /// Set or remove the sun.
    Sun(Option<PlacedSun>),
    /// Set the sky.
    Sky(Sky),
    /// Switch parts of the model on or off.
    Mechanisms(Mechanisms),
    /// Set several parameters of all plants of a species at once, or none of them.
    SetAll {
        /// Name of the species.
        species: String,
        /// Parameters and their values, as after `=` in `--set`.
        values: Vec<(String, String)>,
    },
}

/// An edit and the step before which it is made.
#[derive(Debug, Clone, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimedEdit {
    /// Made when this many steps have been grown.
    pub step: u32,
    /// What is changed.
    pub edit: Edit,
}

/// What an edit did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct EditOutcome {
    /// Organs it shed.
    pub shed: usize,
}

/// Why an edit could not be made; nothing was changed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EditError {
    /// Nothing of that name stands there.
    #[error("there is no solid or lamp named `{0}`")]
    NoSuchName(String),
    /// That name is taken.
    #[error("there is already something named `{0}`; names are unique")]
    NameTaken(String),
    /// No such plant.
    #[error("there is no plant number {0}")]
    NoSuchPlant(u32),
    /// No such organ.
    #[error("plant {plant} has no living organ of lineage {lineage}")]
    NoSuchOrgan {
        /// The plant.
        plant: u32,
        /// The lineage.
        lineage: u64,
    },
    /// No plant of that species.
    #[error("there is no species named `{0}` here")]
    NoSuchSpecies(String),
    /// The parameter could not be set.
    #[error(transparent)]
    Parameter(#[from] crate::species::parameter::ParameterError),
    /// A number is not finite or out of range.
    #[error("`{field}` is {value}; allowed: {allowed}")]
    Invalid {
        /// The field.
        field: &'static str,
        /// The value.
        value: String,
        /// What is allowed.
        allowed: &'static str,
    },
}

/// Makes an edit.
///
/// # Errors
/// [`EditError`] if what it names is not there or a value is out of range; nothing is changed then.
pub fn apply(world: &mut World, edit: &Edit) -> Result<EditOutcome, EditError> {
    let mut shed_count = 0;
    match edit {
        Edit::Plant(planting) => {
            place::can_come_up(world, planting.at)?;
            let species = species_named(world, &planting.species)?;
            place::sow(world, planting, species, world_seed(world));
        }
        Edit::PlaceSolid(solid) => {
            place::finite("at", solid.at)?;
            free_name(world, &solid.name)?;
            let entity = place::set_solid(world, solid);
            shed_count = crush(world, entity);
        }
        Edit::PlaceLamp(lamp) => {
            place::finite("at", lamp.at)?;
            free_name(world, &lamp.name)?;
            place::set_lamp(world, lamp);
        }
        Edit::Move { name, to, turn_deg } => {
            place::finite("to", *to)?;
            let entity = named(world, name)?;
            if let Some(mut transform) = world.get_mut::<Transform>(entity) {
                transform.translation = *to;
                transform.rotation = Quat::from_rotation_y(turn_deg.to_radians());
            }
            shed_count = crush(world, entity);
        }
        Edit::Pose { name, to, rotation_deg, scale } => {
            place::finite("to", *to)?;
            place::finite("rotation_deg", *rotation_deg)?;
            place::finite("scale", *scale)?;
            let entity = named(world, name)?;
            if let Some(mut transform) = world.get_mut::<Transform>(entity) {
                *transform = posed(*to, *rotation_deg, *scale);
            }
            shed_count = crush(world, entity);
        }
        Edit::Duplicate { name, copy, to } => {
            place::finite("to", *to)?;
            let original = named(world, name)?;
            free_name(world, copy)?;
            let transform = world.get::<Transform>(original).copied().unwrap_or_default();
            let (solid, lamp) = (world.get::<Solid>(original).copied(), world.get::<Lamp>(original).copied());
            let mut twin = world.spawn((Name::new(copy.clone()), transform.with_translation(*to)));
            if let Some(solid) = solid {
                twin.insert(solid);
            }
            if let Some(lamp) = lamp {
                twin.insert(lamp);
            }
            let twin = twin.id();
            shed_count = crush(world, twin);
        }
        Edit::Shine { name, strength, radius } => {
            place::finite("strength", Vec3::splat(*strength))?;
            place::finite("radius", Vec3::splat(*radius))?;
            let entity = named(world, name)?;
            match world.get_mut::<Lamp>(entity) {
                Some(mut lamp) => (lamp.strength, lamp.radius) = (*strength, *radius),
                None => return Err(EditError::NoSuchName(name.clone())),
            }
        }
        Edit::Switch { name, on } => {
            let entity = named(world, name)?;
            match world.get_mut::<Lamp>(entity) {
                Some(mut lamp) => lamp.on = *on,
                None => return Err(EditError::NoSuchName(name.clone())),
            }
        }
        Edit::Remove { name } => {
            let entity = named(world, name)?;
            world.despawn(entity);
        }
        Edit::Prune { plant, lineage } => {
            plant_entity(world, *plant)?;
            let birth = birth_of(world, *plant, Lineage(*lineage))
                .ok_or(EditError::NoSuchOrgan { plant: *plant, lineage: *lineage })?;
            shed_count = shed(world, &[(birth, Cause::Pruned)]);
        }
        Edit::Top { plant, above } => {
            let base = plant_entity(world, *plant)?;
            let floor = plant_transform(world, base).translation.y + above;
            let cut: Vec<(u32, Cause)> = organs_of(world, *plant, |pose| pose.position.y >= floor)
                .map(|b| (b, Cause::Pruned))
                .collect();
            shed_count = shed(world, &cut);
        }
        Edit::Shear { from, to } => {
            place::finite("from", *from)?;
            place::finite("to", *to)?;
            let (low, high) = (from.min(*to), from.max(*to));
            let outside = |place: Vec3| place.cmplt(low).any() || place.cmpgt(high).any();
            let roster = world.resource::<Roster>();
            let cut: Vec<(u32, Cause)> = (0..roster.len())
                .filter(|&i| {
                    let pose = world.get::<Pose>(roster.entity[i]);
                    let length = world.get::<Internode>(roster.entity[i]).map_or(0.0, |wood| wood.length);
                    pose.is_some_and(|pose| outside(pose.tip(length)))
                })
                .map(|i| (roster.birth[i], Cause::Pruned))
                .collect();
            shed_count = shed(world, &cut);
        }
        Edit::Uproot { plant } => {
            let entity = plant_entity(world, *plant)?;
            shed_count = world.resource::<Roster>().plant.iter().filter(|p| **p == *plant).count();
            world.despawn(entity);
            world.flush();
        }
        Edit::Set { species, parameter, value } => set_parameters(world, species, &[(parameter, value)])?,
        Edit::SetAll { species, values } => {
            let values: Vec<(&String, &String)> = values.iter().map(|(name, value)| (name, value)).collect();
            set_parameters(world, species, &values)?;
        }
        Edit::Sun(sun) => place::set_sun(world, *sun),
        Edit::Sky(sky) => world.insert_resource(*sky),
        Edit::Mechanisms(mechanisms) => world.insert_resource(*mechanisms),
    }
    Ok(EditOutcome { shed: shed_count })
}

/// Where [`Edit::Pose`] sets a thing.
fn posed(to: Vec3, rotation_deg: Vec3, scale: Vec3) -> Transform {
    let [x, y, z] = rotation_deg.to_array().map(f32::to_radians);
    let rotation = Quat::from_euler(EulerRot::YXZ, y, x, z);
    Transform { translation: to, rotation, scale }
}

impl Edit {
    /// The edit that sets a solid or lamp where a transform says, as a gizmo leaves it; scale is kept within what
    /// an edit may ask for.
    pub fn posing(name: impl Into<String>, transform: &Transform) -> Self {
        let (y, x, z) = transform.rotation.to_euler(EulerRot::YXZ);
        Self::Pose {
            name: name.into(),
            to: transform.translation,
            rotation_deg: Vec3::new(x.to_degrees(), y.to_degrees(), z.to_degrees()),
            scale: transform.scale.abs().clamp(Vec3::splat(0.01), Vec3::splat(100.0)),
        }
    }

    /// Whether this one says again, with other values, what another said: of two in a row, as while dragging, only
    /// the later matters.
    pub fn replaces(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Move { name, .. }, Self::Move { name: other, .. })
            | (Self::Pose { name, .. }, Self::Move { name: other, .. } | Self::Pose { name: other, .. })
            | (Self::Shine { name, .. }, Self::Shine { name: other, .. })
            | (Self::Switch { name, .. }, Self::Switch { name: other, .. }) => name == other,
            (
                Self::Set { species, parameter, .. },
                Self::Set { species: other, parameter: other_parameter, .. },
            ) => species == other && parameter == other_parameter,
            (Self::SetAll { species, values }, Self::SetAll { species: other, values: others }) => {
                let again = |(name, _): &(String, String)| values.iter().any(|(own, _)| own == name);
                species == other && others.iter().all(again)
            }
            (Self::Top { plant, .. }, Self::Top { plant: other, .. }) => plant == other,
            (Self::Sun(_), Self::Sun(_))
            | (Self::Sky(_), Self::Sky(_))
            | (Self::Mechanisms(_), Self::Mechanisms(_))
            | (Self::Shear { .. }, Self::Shear { .. }) => true,
            _ => false,
        }
    }
}

/// Sheds all living wood, leaves and buds inside a solid just set or moved, with what they bear. Returns how many
/// organs went; none if it is no solid.
pub fn crush(world: &mut World, solid: Entity) -> usize {
    let mut query = world.query::<(&Solid, &Transform)>();
    let solids = standing_solids(query.get(world, solid).into_iter());
    if solids.is_empty() {
        return 0;
    }
    let roster = world.resource::<Roster>();
    let mut crushed = Vec::new();
    for i in 0..roster.len() {
        let Some(pose) = world.get::<Pose>(roster.entity[i]) else { continue };
        if is_inside(&solids, pose, world.get::<Internode>(roster.entity[i])) {
            crushed.push((roster.birth[i], Cause::Crushed));
        }
    }
    shed(world, &crushed)
}

fn world_seed(world: &World) -> u64 {
    world.get_resource::<super::RunSeed>().map_or(0, |s| s.0)
}

fn species_named(world: &World, name: &str) -> Result<Arc<Species>, EditError> {
    world
        .get_resource::<SpeciesBook>()
        .and_then(|book| book.0.get(name).cloned())
        .ok_or_else(|| EditError::NoSuchSpecies(name.into()))
}

fn named_entities(world: &mut World) -> Vec<(Entity, String)> {
    let mut query = world.query_filtered::<(Entity, &Name), Or<(With<Solid>, With<Lamp>)>>();
    query.iter(world).map(|(entity, name)| (entity, name.to_string())).collect()
}

fn named(world: &mut World, name: &str) -> Result<Entity, EditError> {
    named_entities(world)
        .into_iter()
        .find(|(_, n)| n == name)
        .map(|(entity, _)| entity)
        .ok_or_else(|| EditError::NoSuchName(name.into()))
}

fn free_name(world: &mut World, name: &str) -> Result<(), EditError> {
    match named(world, name) {
        Ok(_) => Err(EditError::NameTaken(name.into())),
        Err(_) => Ok(()),
    }
}

fn plant_entity(world: &World, plant: u32) -> Result<Entity, EditError> {
    world
        .resource::<Roster>()
        .plants
        .get(plant as usize)
        .copied()
        .flatten()
        .ok_or(EditError::NoSuchPlant(plant))
}

fn birth_of(world: &World, plant: u32, lineage: Lineage) -> Option<u32> {
    let roster = world.resource::<Roster>();
    (0..roster.len())
        .filter(|&i| roster.plant[i] == plant)
        .find(|&i| world.get::<Identity>(roster.entity[i]).is_some_and(|id| id.lineage == lineage))
        .map(|i| roster.birth[i])
}

fn organs_of(world: &World, plant: u32, chosen: impl Fn(&Pose) -> bool) -> impl Iterator<Item = u32> {
    let roster = world.resource::<Roster>();
    (0..roster.len())
        .filter(move |&i| {
            roster.plant[i] == plant && world.get::<Pose>(roster.entity[i]).is_some_and(&chosen)
        })
        .map(|i| roster.birth[i])
}

fn set_parameters(world: &mut World, species: &str, values: &[(&String, &String)]) -> Result<(), EditError> {
    let mut changed = Species::clone(&*species_named(world, species)?);
    for (parameter, value) in values {
        changed.set(parameter, &parse_value(value))?;
    }
    let changed = Arc::new(changed);
    let plants: Vec<Entity> = world.resource::<Roster>().plants.iter().flatten().copied().collect();
    for plant in plants {
        if let Some(mut plant) = world.get_mut::<Plant>(plant)
            && plant.species.name == species
        {
            plant.species = changed.clone();
        }
    }
    world.resource_mut::<SpeciesBook>().0.insert(species.into(), changed);
    Ok(())
}
