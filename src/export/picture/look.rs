//! Colours of what is drawn.

use bevy::prelude::*;

use crate::plant::{PlantRecord, Snapshot};
use crate::shape::bark::Bark;
use crate::species::Species;
use crate::species::parameter::Color;

/// Colours of one plant, linear RGB.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlantLook {
    /// Bark.
    pub bark: Bark,
    /// The upper side of a leaf.
    pub leaf: Vec3,
}

impl PlantLook {
    /// The colours of a species.
    pub fn of(species: &Species) -> Self {
        Self { bark: Bark::of(species), leaf: species.leaf_color.linear().into() }
    }
}

impl Default for PlantLook {
    fn default() -> Self {
        Self::of(&Species::default())
    }
}

/// Colours of all that has none of its own in the scene; solids and lamps bring theirs.
#[derive(Debug, Clone, PartialEq)]
pub struct Palette {
    /// A look for each plant, in the order of the scene's plant indices.
    pub plants: Vec<PlantLook>,
    /// Grass, linear RGB.
    pub grass: Vec3,
    /// Bare earth between the grass, linear RGB.
    pub earth: Vec3,
}

impl Default for Palette {
    fn default() -> Self {
        let linear = |hex| Vec3::from(Color::hex(hex).linear());
        Self { plants: Vec::new(), grass: linear(0x83_8F_55), earth: linear(0x9B_8A_68) }
    }
}

impl Palette {
    /// The usual meadow and the colours of these species, one for each plant.
    pub fn of<'a>(species: impl IntoIterator<Item = &'a Species>) -> Self {
        Self { plants: species.into_iter().map(PlantLook::of).collect(), ..Self::default() }
    }

    /// The usual meadow and the colours of the plants of a snapshot.
    pub fn of_snapshot(snapshot: &Snapshot) -> Self {
        let look = |plant: &Option<PlantRecord>| {
            plant.as_ref().map_or_else(PlantLook::default, |plant| PlantLook::of(&plant.species))
        };
        Self { plants: snapshot.plants.iter().map(look).collect(), ..Self::default() }
    }

    /// Look of a plant; the default one if it has none here.
    pub(super) fn plant(&self, index: u32) -> PlantLook {
        self.plants.get(index as usize).copied().unwrap_or_default()
    }
}
