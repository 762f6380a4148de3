//! Two snapshots as one list of organs, each with its place in either.

use bevy::prelude::*;

use crate::plant::{Internode, Lineage, NO_PARENT, OrganState, PlantRecord, Snapshot};
use crate::render::overlay::{age, most_energy, values};
use crate::render::record::{Owner, Values, Window};

/// No index.
pub(super) const NONE: u32 = u32::MAX;
/// The longest part of the step an organ waits before it falls.
const HANGS_ON: f32 = 0.45;
/// The part of the step a fall takes.
const FALL: f32 = 0.5;

/// All organs of two snapshots in birth order.
pub(super) struct Union<'a> {
    pub(super) before: &'a Snapshot,
    pub(super) now: &'a Snapshot,
    /// Index in the earlier snapshot, or [`NONE`].
    pub(super) old: Vec<u32>,
    /// Index in the later snapshot, or [`NONE`].
    pub(super) new: Vec<u32>,
    /// Index here of the organ it grows from, or [`NONE`].
    pub(super) parent: Vec<u32>,
    /// For a dying organ, the lowest dying organ that bears it: they fall together.
    pub(super) falls_with: Vec<u32>,
    /// Where the organ's far end was at the begin of the step; that of the shoot it is new on, for a new one.
    pub(super) tip_before: Vec<Vec3>,
    /// When it came to its place.
    pub(super) window: Vec<Window>,
    /// What can be shown of each organ of the earlier and the later snapshot.
    values: [Vec<Values>; 2],
}

impl<'a> Union<'a> {
    pub(super) fn of(before: &'a Snapshot, now: &'a Snapshot) -> Self {
        let room = now.len() + now.len() / 4;
        let mut union = Self {
            before,
            now,
            old: Vec::with_capacity(room),
            new: Vec::with_capacity(room),
            parent: Vec::with_capacity(room),
            falls_with: Vec::with_capacity(room),
            tip_before: Vec::with_capacity(room),
            window: Vec::with_capacity(room),
            values: [before, now].map(|snapshot| values(snapshot, most_energy(snapshot))),
        };
        let (mut from_old, mut from_new) = (vec![NONE; before.len()], vec![NONE; now.len()]);
        let (mut a, mut b) = (0, 0);
        while a < before.len() || b < now.len() {
            let birth_a = before.birth.get(a).copied().unwrap_or(u32::MAX);
            let birth_b = now.birth.get(b).copied().unwrap_or(u32::MAX);
            let at = union.old.len() as u32;
            // A birth number used anew for another organ, as after a fork, is another organ.
            let same = birth_a == birth_b && before.lineage[a] == now.lineage[b];
            let (old, new) = match (same, birth_a <= birth_b) {
                (true, _) => (a as u32, b as u32),
                (false, true) => (a as u32, NONE),
                (false, false) => (NONE, b as u32),
            };
            let mut parent = NONE;
            if old != NONE {
                from_old[a] = at;
                parent = above(&from_old, before.parent[a]);
                a += 1;
            }
            if new != NONE {
                from_new[b] = at;
                parent = above(&from_new, now.parent[b]);
                b += 1;
            }
            union.push(old, new, parent);
        }
        union
    }

    fn push(&mut self, old: u32, new: u32, parent: u32) {
        let at = self.old.len() as u32;
        self.old.push(old);
        self.new.push(new);
        self.parent.push(parent);
        let falls_with = match (new, self.falls_with.get(parent as usize)) {
            (NONE, Some(&with)) if with != NONE => with,
            (NONE, _) => at,
            _ => NONE,
        };
        self.falls_with.push(falls_with);
        let i = at as usize;
        let tip = if old != NONE {
            let old = old as usize;
            self.before.pose[old].tip(self.before.length(old))
        } else {
            self.tip_before.get(parent as usize).copied().unwrap_or(self.now.pose[new as usize].position)
        };
        self.tip_before.push(tip);
        let window = if new == NONE {
            let start = HANGS_ON * unit(self.lineage(falls_with as usize));
            Window { start, end: start + FALL }
        } else if old == NONE {
            Window { start: 0.0, end: self.part(self.now.span[new as usize].end) }
        } else {
            Window::STEP
        };
        self.window.push(window);
        debug_assert_eq!(self.window.len(), i + 1);
    }

    /// The part of the step at which a point of time lies.
    fn part(&self, time: f32) -> f32 {
        // Spans are written in the count of finished steps: a step that ends with count n spans n - 1 to n.
        let (start, end) = (self.before.step as f32, self.now.step as f32);
        if end > start { ((time - start) / (end - start)).clamp(0.02, 1.0) } else { 1.0 }
    }

    pub(super) fn len(&self) -> usize {
        self.old.len()
    }

    pub(super) fn is_dying(&self, i: usize) -> bool {
        self.new[i] == NONE
    }

    pub(super) fn is_new(&self, i: usize) -> bool {
        self.old[i] == NONE
    }

    /// The latest snapshot it is in, and its index there.
    pub(super) fn latest(&self, i: usize) -> (&'a Snapshot, usize) {
        match self.new[i] {
            NONE => (self.before, self.old[i] as usize),
            new => (self.now, new as usize),
        }
    }

    /// The earliest snapshot it is in, and its index there.
    pub(super) fn earliest(&self, i: usize) -> (&'a Snapshot, usize) {
        match self.old[i] {
            NONE => (self.now, self.new[i] as usize),
            old => (self.before, old as usize),
        }
    }

    pub(super) fn state(&self, i: usize) -> &'a OrganState {
        let (snapshot, i) = self.latest(i);
        &snapshot.state[i]
    }

    pub(super) fn lineage(&self, i: usize) -> Lineage {
        let (snapshot, i) = self.latest(i);
        snapshot.lineage[i]
    }

    pub(super) fn order(&self, i: usize) -> u32 {
        let (snapshot, i) = self.latest(i);
        snapshot.order[i]
    }

    pub(super) fn plant(&self, i: usize) -> u32 {
        let (snapshot, i) = self.latest(i);
        snapshot.plant[i]
    }

    pub(super) fn internode(&self, i: usize) -> Option<&'a Internode> {
        match self.state(i) {
            OrganState::Internode(internode, _) => Some(internode),
            _ => None,
        }
    }

    /// A plant's record, of a plant that is gone its last.
    pub(super) fn plant_record(&self, plant: usize) -> Option<&'a PlantRecord> {
        let of = |s: &'a Snapshot| s.plants.get(plant).and_then(Option::as_ref);
        of(self.now).or_else(|| of(self.before))
    }

    /// Everything about an organ that does not say where it is.
    pub(super) fn owner(&self, i: usize) -> Owner {
        let (latest, l) = self.latest(i);
        let of = |state: usize, at: u32| self.values[state].get(at as usize).copied();
        let (old, new) = (of(0, self.old[i]), of(1, self.new[i]));
        Owner {
            birth: latest.birth[l],
            plant: latest.plant[l],
            order: latest.order[l],
            age: age(latest, l),
            values: [old.or(new), new.or(old)].map(Option::unwrap_or_default),
        }
    }
}

fn above(index: &[u32], parent: u32) -> u32 {
    if parent == NO_PARENT { NONE } else { index.get(parent as usize).copied().unwrap_or(NONE) }
}

/// A number in 0..1 that belongs to a lineage.
pub(super) fn unit(lineage: Lineage) -> f32 {
    crate::chance::share(crate::chance::mix(lineage.0 ^ 0x5EED_FA11))
}
