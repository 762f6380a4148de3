//! Packing: two snapshots as records for the graphics card, and the chunks they are drawn in.
//!
//! Plain data in, plain data out; may run on any thread.

mod blades;
mod union;
mod wood;

use bevy::prelude::*;

use super::record::{PlantEntry, Record};
use crate::plant::Snapshot;
use crate::shape::bark::Bark;
use crate::shape::foliage::Foliage;
use crate::shape::outline::LeafOutline;

/// Records a chunk can hold, largest first; a lot is filled up with the smallest.
pub const CAPACITIES: [u32; 4] = [1024, 256, 64, 16];
/// How far wind and falls carry things at most, sideways and down, metres.
const SWAY: [f32; 2] = [0.6, 3.0];

/// What a chunk holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Class {
    /// Rings of trunks and limbs.
    Limbs,
    /// Rings of branches.
    Branches,
    /// Rings of twigs.
    Twigs,
    /// Blades whose margin has this many points.
    Blades(u8),
}

/// A run of records drawn as one mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chunk {
    /// What it holds.
    pub class: Class,
    /// Its first record.
    pub first: u32,
    /// Which of [`CAPACITIES`] it has.
    pub capacity: u8,
    /// Least corner of all it shows in the step, metres.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
    /// Length of the largest blade for blades, metres; else of no meaning.
    pub blade: f32,
}

/// Everything drawn of two snapshots.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Packed {
    /// Rings of all branches.
    pub rings: Vec<Record>,
    /// Blades of all leaves.
    pub blades: Vec<Record>,
    /// What the organs of a plant share, by its index.
    pub plants: Vec<PlantEntry>,
    /// What is drawn as what.
    pub chunks: Vec<Chunk>,
}

/// Packs two snapshots: what was before a step and what is after it.
pub fn pack(before: &Snapshot, now: &Snapshot) -> Packed {
    let union = union::Union::of(before, now);
    let count = before.plants.len().max(now.plants.len());
    let foliage: Vec<Option<Foliage>> =
        (0..count).map(|p| union.plant_record(p).map(|plant| Foliage::of(&plant.species))).collect();

    let mut packed = Packed { plants: entries(&union, count), ..default() };
    let mut wood = [(); wood::CLASSES].map(|()| vec![Lot::default(); count]);
    let axes = wood::Axes::of(&union);
    wood::lay_wood(&union, &axes, &mut wood);
    for (lots, class) in wood.iter().zip([Class::Limbs, Class::Branches, Class::Twigs]) {
        for lot in lots {
            lot.settle(class, 0.0, Record::ring, &mut packed.rings, &mut packed.chunks);
        }
    }
    // The last segment of all looks one ring ahead.
    packed.rings.push(Record::PAD);

    let mut leaves = vec![Lot::default(); count];
    blades::lay_blades(&union, &foliage, &mut leaves);
    for (plant, lot) in leaves.iter().enumerate() {
        let Some(record) = union.plant_record(plant) else { continue };
        let points = margin(record.species.leaf_outline).1;
        let class = Class::Blades(points);
        lot.settle(
            class,
            record.species.leaf_length_m,
            Record::blade,
            &mut packed.blades,
            &mut packed.chunks,
        );
    }
    packed
}

/// What is drawn of one plant and class, and the room it takes.
#[derive(Debug, Clone)]
struct Lot<T> {
    things: Vec<T>,
    /// Least and greatest corner of each.
    boxes: Vec<[Vec3; 2]>,
}

impl<T> Default for Lot<T> {
    fn default() -> Self {
        Self { things: Vec::new(), boxes: Vec::new() }
    }
}

impl<T> Lot<T> {
    /// Adds a thing that is at one and later at the other place and reaches this far, metres.
    fn add(&mut self, thing: T, places: [Vec3; 2], reach: f32) {
        self.things.push(thing);
        let reach = Vec3::splat(reach);
        self.boxes.push([places[0].min(places[1]) - reach, places[0].max(places[1]) + reach]);
    }

    /// Writes the records, filled up to whole chunks.
    fn settle(
        &self,
        class: Class,
        blade: f32,
        record: impl Fn(&T) -> Record,
        records: &mut Vec<Record>,
        chunks: &mut Vec<Chunk>,
    ) {
        let mut at = 0;
        while at < self.things.len() {
            let left = (self.things.len() - at) as u32;
            let fits = CAPACITIES.iter().position(|&c| c <= left).unwrap_or(CAPACITIES.len() - 1);
            let capacity = CAPACITIES[fits] as usize;
            let end = (at + capacity).min(self.things.len());
            // A chunk of rings shows the way to the first ring of the next.
            let shown = &self.boxes[at..(end + 1).min(self.boxes.len())];
            let [min, max] = shown
                .iter()
                .fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], b| [low.min(b[0]), high.max(b[1])]);
            let sway = Vec3::new(SWAY[0], 0.3, SWAY[0]);
            let fall = Vec3::Y * (SWAY[1] - 0.3);
            chunks.push(Chunk {
                class,
                first: records.len() as u32,
                capacity: fits as u8,
                min: min - sway - fall,
                max: max + sway,
                blade,
            });
            records.extend(self.things[at..end].iter().map(&record));
            records.resize(records.len() + capacity - (end - at), Record::PAD);
            at = end;
        }
    }
}

/// A linear colour in five bits a channel, each the root of how bright it is: a number every `f32` holds.
fn five_bits(color: Vec3) -> f32 {
    let root = |bright: f32| (31.0 * bright.clamp(0.0, 1.0).sqrt()).round();
    (root(color.x) * 32.0 + root(color.y)) * 32.0 + root(color.z)
}

/// The points of a blade's margin, and how many there are.
fn margin(outline: LeafOutline) -> ([[f32; 4]; 4], u8) {
    let mut rows = [[0.0; 4]; 4];
    let stations = outline.stations();
    for (k, &s) in stations.iter().enumerate() {
        // The base is as wide as the petiole.
        let width = if k == 0 { 0.05 } else { outline.half_width(s) };
        rows[k / 2][2 * (k % 2)] = s;
        rows[k / 2][2 * (k % 2) + 1] = width;
    }
    (rows, stations.len() as u8)
}

fn entries(union: &union::Union, count: usize) -> Vec<PlantEntry> {
    let mut entries = vec![PlantEntry::default(); count];
    let (before, now) = (blades::crowns(union.before), blades::crowns(union.now));
    for (i, entry) in entries.iter_mut().enumerate() {
        let Some(plant) = union.plant_record(i) else { continue };
        let species = &plant.species;
        let crown = |crowns: &[[f32; 4]], other: &[[f32; 4]]| {
            let of = |crowns: &[[f32; 4]]| crowns.get(i).copied().filter(|crown| crown[3] > 0.0);
            of(crowns).or_else(|| of(other)).unwrap_or(plant.position.extend(0.0).to_array())
        };
        let bark = Bark::of(species);
        let [lr, lg, lb] = species.leaf_color.linear();
        *entry = PlantEntry {
            base: plant.position.extend(five_bits(bark.mark)).to_array(),
            crown_before: crown(&before, &now),
            crown_now: crown(&now, &before),
            bark: bark.old.extend(bark.pattern as u32 as f32).to_array(),
            twig: bark.young.extend(bark.old_radius).to_array(),
            leaf: [lr, lg, lb, species.leaf_length_m],
            margin: margin(species.leaf_outline).0,
        };
    }
    entries
}

#[cfg(test)]
mod tests;
