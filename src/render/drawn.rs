//! What a host says: which plants to draw, when, and how.

use std::sync::Arc;

use bevy::prelude::*;

use super::Overlay;
use crate::plant::Snapshot;

/// All plants of a snapshot, drawn between the state before a growth step and the state after it.
///
/// Spawn one, and replace it whenever a step is finished; [`StepFraction`] says how far between the two the plants
/// are drawn. Packing a large change takes a few frames; until then the old one is held at its end. Despawning it
/// removes its meshes and buffers. Positions are those of the snapshots, under the entity's own [`Transform`].
#[derive(Component, Debug, Clone)]
#[require(Transform, Visibility, StepFraction, Look, Marks)]
pub struct Drawn {
    /// Before the step.
    pub before: Arc<Snapshot>,
    /// After the step. The same as `before` for plants that stand still.
    pub now: Arc<Snapshot>,
}

impl Drawn {
    /// Plants that stand still.
    pub fn still(snapshot: impl Into<Arc<Snapshot>>) -> Self {
        let now = snapshot.into();
        Self { before: now.clone(), now }
    }

    /// Moves on: what was after the last step is before the next.
    pub fn step_to(&mut self, next: impl Into<Arc<Snapshot>>) {
        self.before = std::mem::replace(&mut self.now, next.into());
    }
}

/// How far between its two states a [`Drawn`] is drawn, 0 (before) to 1 (now).
#[derive(Component, Debug, Clone, Copy, PartialEq, Default, Reflect)]
#[reflect(Component)]
pub struct StepFraction(pub f32);

/// How a [`Drawn`] looks.
#[derive(Component, Debug, Clone, PartialEq, Default, Reflect)]
#[reflect(Component)]
pub struct Look {
    /// False colours instead of the plants' own.
    pub overlay: Option<Overlay>,
    /// Drawn as a ghost: without shadow, through a fine grid, tinted.
    pub ghost: Option<Ghost>,
    /// Light that nothing gives, which lifts small plants out of the dark about them: 0 none, 1 as much as dusk needs.
    pub fill: f32,
}

/// How a ghost is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Reflect)]
pub struct Ghost {
    /// Its tint.
    pub color: LinearRgba,
    /// Share of its surface that is drawn, 0..1.
    pub share: f32,
}

impl Default for Ghost {
    fn default() -> Self {
        Self { color: LinearRgba::rgb(0.35, 0.55, 0.85), share: 0.4 }
    }
}

/// Organs of a [`Drawn`] that are lit up, by birth number.
#[derive(Component, Debug, Clone, PartialEq, Eq, Default, Reflect)]
#[reflect(Component)]
pub struct Marks {
    /// Under the pointer.
    pub hovered: Vec<u32>,
    /// Chosen.
    pub chosen: Vec<u32>,
    /// To be cut or crushed; stands above the others.
    pub doomed: Vec<u32>,
}

/// Colours of marks: hovered, chosen, doomed; the last is how strong.
pub(super) const MARK_COLORS: [[f32; 4]; 3] =
    [[0.95, 0.75, 0.25, 0.6], [0.25, 0.65, 1.0, 0.6], [1.0, 0.16, 0.08, 0.75]];

impl Marks {
    /// Whether nothing is marked.
    pub fn is_empty(&self) -> bool {
        self.hovered.is_empty() && self.chosen.is_empty() && self.doomed.is_empty()
    }

    /// Two bits for each record, sixteen records a word, by the birth numbers of the records.
    pub(super) fn bits(&self, births: &[u32]) -> Vec<u32> {
        let mut words = vec![0; births.len().div_ceil(16)];
        if self.is_empty() {
            return words;
        }
        let sorted = [&self.hovered, &self.chosen, &self.doomed].map(|births| {
            let mut births = births.clone();
            births.sort_unstable();
            births
        });
        for (i, birth) in births.iter().enumerate() {
            let mark = sorted.iter().rposition(|marked| marked.binary_search(birth).is_ok());
            words[i / 16] |= mark.map_or(0, |mark| mark as u32 + 1) << (2 * (i % 16));
        }
        words
    }
}

/// The light wind plants stir in. Growth never feels it.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Reflect)]
#[reflect(Resource)]
pub struct Wind {
    /// Where it blows to, in the plane; need not be of length 1.
    pub direction: Vec2,
    /// 0 still, 1 a light wind.
    pub strength: f32,
    /// Time of the wind, seconds; passes by itself while [`Wind::blows`].
    pub seconds: f32,
    /// Whether its time passes.
    pub blows: bool,
}

impl Default for Wind {
    fn default() -> Self {
        Self { direction: Vec2::new(0.8, 0.6), strength: 1.0, seconds: 0.0, blows: true }
    }
}

/// How much is drawn, for slow and fast machines, and how packing is done.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Reflect)]
#[reflect(Resource)]
pub struct DrawSettings {
    /// Distance at which leaves begin to be thinned out, in blade lengths.
    pub leaf_distance: f32,
    /// Distance at which twigs are left out, metres.
    pub twig_distance: f32,
    /// Whether packing is done at once, in the frame it is asked for, however long it takes; else large plants are
    /// packed on another thread.
    pub pack_at_once: bool,
}

impl Default for DrawSettings {
    fn default() -> Self {
        Self { leaf_distance: 220.0, twig_distance: 90.0, pack_at_once: false }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_two_bits_a_record() {
        let marks = Marks { hovered: vec![5, 3], chosen: vec![4], doomed: vec![5] };
        let births: Vec<u32> = (0..20).collect();
        let words = marks.bits(&births);
        assert_eq!(words.len(), 2);
        assert_eq!(words[0], 1 << 6 | 2 << 8 | 3 << 10);
        assert_eq!(words[1], 0);
    }
}
