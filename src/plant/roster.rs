//! The living organs in birth order, which every order-sensitive system walks.

use bevy::prelude::*;

use super::OrganKind;

/// Parent index of an organ that grows straight from its plant.
pub const NO_PARENT: u32 = u32::MAX;

/// Living organs of all plants, in birth order: parents come before what they bear.
///
/// Bevy's query order changes after a despawn, so whatever depends on order walks this. Structure of arrays:
/// index `i` of every column is the same organ.
#[derive(Resource, Debug, Default, Clone, Reflect)]
#[reflect(Resource, Default)]
pub struct Roster {
    /// The organ.
    pub entity: Vec<Entity>,
    /// Birth number, strictly rising.
    pub birth: Vec<u32>,
    /// Index of the internode it grows from, or [`NO_PARENT`].
    pub parent: Vec<u32>,
    /// Index of its plant in [`Roster::plants`].
    pub plant: Vec<u32>,
    /// Its kind.
    pub kind: Vec<OrganKind>,
    /// Plants in the order of planting; gone ones leave `None`.
    pub plants: Vec<Option<Entity>>,
    /// Birth number of the next organ.
    pub next_birth: u32,
}

impl Roster {
    /// Living organs.
    pub fn len(&self) -> usize {
        self.entity.len()
    }

    /// Whether nothing lives.
    pub fn is_empty(&self) -> bool {
        self.entity.is_empty()
    }

    /// Index of the organ with a birth number.
    pub fn index_of(&self, birth: u32) -> Option<usize> {
        self.birth.binary_search(&birth).ok()
    }

    /// Where every organ stands in it, by entity.
    pub fn places(&self) -> Places<'_> {
        let last = self.entity.iter().map(|entity| entity.index_u32() as usize + 1).max().unwrap_or(0);
        let mut by_index = vec![u32::MAX; last];
        for (i, entity) in self.entity.iter().enumerate() {
            by_index[entity.index_u32() as usize] = i as u32;
        }
        Places { roster: self, by_index }
    }

    /// Adds an organ at the end and gives it the next birth number.
    pub fn bear(&mut self, entity: Entity, parent: u32, plant: u32, kind: OrganKind) -> u32 {
        let birth = self.next_birth;
        self.next_birth += 1;
        self.entity.push(entity);
        self.birth.push(birth);
        self.parent.push(parent);
        self.plant.push(plant);
        self.kind.push(kind);
        birth
    }

    /// Keeps the organs for which `stays` is true. What stays must not grow from what goes.
    pub fn retain(&mut self, stays: &[bool]) {
        let mut new_index = vec![NO_PARENT; self.len()];
        let mut kept = 0;
        for i in 0..self.len() {
            if stays[i] {
                new_index[i] = kept as u32;
                let parent = self.parent[i];
                self.entity[kept] = self.entity[i];
                self.birth[kept] = self.birth[i];
                self.plant[kept] = self.plant[i];
                self.kind[kept] = self.kind[i];
                self.parent[kept] = if parent == NO_PARENT { NO_PARENT } else { new_index[parent as usize] };
                kept += 1;
            }
        }
        self.entity.truncate(kept);
        self.birth.truncate(kept);
        self.parent.truncate(kept);
        self.plant.truncate(kept);
        self.kind.truncate(kept);
    }
}

/// Indices in a [`Roster`] by entity, for those who walk organs as they lie in memory.
#[derive(Debug)]
pub struct Places<'a> {
    roster: &'a Roster,
    /// By the index of the entity.
    by_index: Vec<u32>,
}

impl Places<'_> {
    /// Index of an entity in the roster, if it is an organ there.
    pub fn get(&self, entity: Entity) -> Option<usize> {
        let i = *self.by_index.get(entity.index_u32() as usize)? as usize;
        (self.roster.entity.get(i) == Some(&entity)).then_some(i)
    }
}
