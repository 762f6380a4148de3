//! A grid of space that finds the stems near a place.

use bevy::math::{IVec3, Vec3};
use bevy::platform::collections::HashMap;
use smallvec::SmallVec;

/// Stems in the cells of a grid that they pass; found in the order in which they came.
#[derive(Debug, Clone)]
pub struct StemGrid<S> {
    cell: f32,
    stems: Vec<S>,
    /// Only ever asked for a cell, never walked: its order does not matter.
    cells: HashMap<IVec3, SmallVec<[u32; 4]>>,
}

impl<S> StemGrid<S> {
    /// An empty grid with cells of that side, metres: about as long as its stems.
    pub fn new(cell: f32) -> Self {
        Self { cell, stems: Vec::new(), cells: HashMap::default() }
    }

    /// Adds a stem that reaches from one place to another with some radius, metres.
    pub fn add(&mut self, stem: S, from: Vec3, to: Vec3, radius: f32) {
        let girth = Vec3::splat(radius);
        let index = self.stems.len() as u32;
        for cell in self.cells(from.min(to) - girth, from.max(to) + girth) {
            self.cells.entry(cell).or_default().push(index);
        }
        self.stems.push(stem);
    }

    /// Stems whose bounds may meet the box between two corners; one that passes several cells comes as often.
    pub fn near(&self, low: Vec3, high: Vec3) -> impl Iterator<Item = &S> {
        self.cells(low, high)
            .flat_map(|cell| self.cells.get(&cell).map_or(&[][..], SmallVec::as_slice))
            .map(|&index| &self.stems[index as usize])
    }

    fn cells(&self, low: Vec3, high: Vec3) -> impl Iterator<Item = IVec3> + use<S> {
        let (low, high) = ((low / self.cell).floor().as_ivec3(), (high / self.cell).floor().as_ivec3());
        (low.x..=high.x).flat_map(move |x| {
            (low.y..=high.y).flat_map(move |y| (low.z..=high.z).map(move |z| IVec3::new(x, y, z)))
        })
    }
}
