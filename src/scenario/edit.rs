//! The one way to change anything: [`Edit`].

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::{PlacedLamp, PlacedSolid, PlacedSun, Planting};
use crate::environment::Sky;
use crate::growth::Mechanisms;

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
pub fn apply(_world: &mut World, _edit: &Edit) -> Result<EditOutcome, EditError> {
    todo!()
}
