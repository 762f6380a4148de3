//! The one currency for everything that reads a plant: a [`Snapshot`].

use std::sync::Arc;

use bevy::ecs::query::ReadOnlyQueryData;
use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::{
    Allotment, ApicalBud, Attachment, BranchOrder, EnergyFlow, EnergyLedger, EnergyStore, Exposure,
    GrowsFrom, GrowthSpan, GrowthTarget, Identity, Internode, LateralBud, Leaf, Lineage, NO_PARENT, Node,
    OrganKind, Plant, Pose, Roster, roster::Places,
};
use crate::environment::workers::Workers;
use crate::growth::StepCount;
use crate::species::Species;
use crate::tropism::{Signals, Steering};

/// What an organ is and the state only its kind has.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum OrganState {
    /// A stem segment, and the node it ends in if it does.
    Internode(Internode, Option<Node>),
    /// A growing tip.
    ApicalBud(ApicalBud, Steering, GrowthTarget),
    /// A side bud.
    LateralBud(LateralBud, GrowthTarget),
    /// A leaf.
    Leaf(Leaf),
}

impl OrganState {
    /// That of an organ of which nothing is known.
    fn none(kind: OrganKind) -> Self {
        match kind {
            OrganKind::Internode => Self::Internode(Internode::default(), None),
            OrganKind::ApicalBud => {
                Self::ApicalBud(ApicalBud::default(), Steering::default(), GrowthTarget::default())
            }
            OrganKind::LateralBud => Self::LateralBud(LateralBud::default(), GrowthTarget::default()),
            OrganKind::Leaf => Self::Leaf(Leaf::default()),
        }
    }

    /// Its kind.
    pub fn kind(&self) -> OrganKind {
        match self {
            Self::Internode(..) => OrganKind::Internode,
            Self::ApicalBud(..) => OrganKind::ApicalBud,
            Self::LateralBud(..) => OrganKind::LateralBud,
            Self::Leaf(_) => OrganKind::Leaf,
        }
    }
}

/// A plant, as a snapshot holds it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlantRecord {
    /// Its species.
    pub species: Arc<Species>,
    /// Its seed.
    pub seed: u64,
    /// Where it stands.
    pub position: Vec3,
    /// Its turn.
    pub rotation: Quat,
    /// Its store.
    pub store: EnergyStore,
    /// Its books of the last step.
    pub ledger: EnergyLedger,
}

/// All plants of a world at the end of a step: structure of arrays in birth order, parents first.
///
/// Index `i` of every column is the same organ.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Steps grown.
    pub step: u32,
    /// Birth number of the next organ.
    pub next_birth: u32,
    /// Plants in the order of planting; gone ones leave `None`.
    pub plants: Vec<Option<PlantRecord>>,
    /// Birth number, strictly rising.
    pub birth: Vec<u32>,
    /// Index of the organ it grows from, or [`NO_PARENT`].
    pub parent: Vec<u32>,
    /// Index of its plant.
    pub plant: Vec<u32>,
    /// Its place in the family.
    pub lineage: Vec<Lineage>,
    /// When it grew.
    pub span: Vec<GrowthSpan>,
    /// Order of its axis.
    pub order: Vec<u32>,
    /// Turn relative to its parent.
    pub attachment: Vec<Quat>,
    /// Where it is in the world.
    pub pose: Vec<Pose>,
    /// Light and space.
    pub exposure: Vec<Exposure>,
    /// Energy set aside for it.
    pub allotment: Vec<f32>,
    /// What it earned and used in the last step.
    pub flow: Vec<EnergyFlow>,
    /// What only its kind has.
    pub state: Vec<OrganState>,
    /// Signals on their way in apical buds, by index of the organ, rising; buds without any are left out.
    pub signals: Vec<(u32, Signals)>,
}

/// What an organ may have, in four parts that are read apart; [`PlantPlugin`](super::PlantPlugin) makes all of it known
/// to a world.
type DescentParts = (Option<&'static Identity>, Option<&'static GrowthSpan>, Option<&'static BranchOrder>);
type FormParts = (Option<&'static Attachment>, Option<&'static Pose>, Option<&'static EnergyFlow>);
type StockParts = (Option<&'static Exposure>, Option<&'static Allotment>);
type StateParts = (
    Option<&'static Internode>,
    Option<&'static Node>,
    Option<&'static ApicalBud>,
    Option<(&'static Steering, &'static Signals)>,
    Option<&'static GrowthTarget>,
    Option<&'static LateralBud>,
    Option<&'static Leaf>,
);

/// Organs from which reading them on two threads is worth their start.
const MANY: usize = 4096;

/// An organ of any kind, and nothing else that lives in the world.
type AnyOrgan = Or<(With<Internode>, With<ApicalBud>, With<LateralBud>, With<Leaf>)>;

/// Gives a column `n` rows, all the same.
fn fill<T: Clone>(column: &mut Vec<T>, n: usize, with: T) {
    column.clear();
    column.resize(n, with);
}

/// Reads parts of every organ as they lie in memory, with its index.
fn each<Parts: ReadOnlyQueryData>(
    world: &World,
    places: &Places,
    mut take: impl FnMut(usize, Parts::Item<'_, '_>),
) {
    let Some(mut organs) = world.try_query_filtered::<(Entity, Parts), AnyOrgan>() else { return };
    for (entity, parts) in organs.iter(world) {
        if let Some(i) = places.get(entity) {
            take(i, parts);
        }
    }
}

/// Does two things, on two threads if `n` organs are worth it.
fn at_once(world: &World, n: usize, one: impl FnOnce() + Send, other: impl FnOnce() + Send) {
    match world.get_resource::<Workers>().filter(|_| n > MANY) {
        Some(workers) => workers.both(one, other),
        None => {
            one();
            other();
        }
    }
}

fn read<C: Copy + Default>(part: Option<&C>) -> C {
    part.copied().unwrap_or_default()
}

impl Snapshot {
    /// Organs in it.
    pub fn len(&self) -> usize {
        self.birth.len()
    }

    /// Whether nothing lives.
    pub fn is_empty(&self) -> bool {
        self.birth.is_empty()
    }

    /// Memory it takes, bytes, species not counted.
    pub fn bytes(&self) -> usize {
        let organ = 5 * size_of::<u32>()
            + size_of::<Lineage>()
            + size_of::<GrowthSpan>()
            + size_of::<Quat>()
            + size_of::<Pose>()
            + size_of::<Exposure>()
            + size_of::<EnergyFlow>()
            + size_of::<OrganState>();
        size_of::<Self>()
            + self.plants.len() * size_of::<Option<PlantRecord>>()
            + self.len() * organ
            + self.signals.len() * size_of::<(u32, Signals)>()
    }

    /// Index of the organ with a birth number.
    pub fn index_of(&self, birth: u32) -> Option<usize> {
        self.birth.binary_search(&birth).ok()
    }

    /// Takes a snapshot of a world.
    pub fn take(world: &World) -> Self {
        Self::default().taken_anew(world)
    }

    /// Takes a snapshot in the memory of one that is no longer needed.
    pub fn taken_anew(self, world: &World) -> Self {
        self.half_taken_anew(world).other_half(world)
    }

    /// The first half of taking it, for those who cannot wait for all of it at once: who there is, and where.
    pub fn half_taken_anew(mut self, world: &World) -> Self {
        let Some(roster) = world.get_resource::<Roster>() else { return Self::default() };
        let n = roster.len();
        self.step = world.get_resource::<StepCount>().map_or(0, |s| s.0);
        self.next_birth = roster.next_birth;
        self.plants.clear();
        self.plants.extend(roster.plants.iter().map(|p| p.and_then(|p| plant_record(world, p))));
        self.birth.clone_from(&roster.birth);
        self.parent.clone_from(&roster.parent);
        self.plant.clone_from(&roster.plant);
        fill(&mut self.lineage, n, Lineage::default());
        fill(&mut self.span, n, GrowthSpan::default());
        fill(&mut self.order, n, 0);
        fill(&mut self.attachment, n, Quat::IDENTITY);
        fill(&mut self.pose, n, Pose::default());
        fill(&mut self.flow, n, EnergyFlow::default());
        let places = roster.places();
        let Self { lineage, span, order, attachment, pose, flow, .. } = &mut self;
        let descent = || {
            each::<DescentParts>(world, &places, |i, (identity, spans, orders)| {
                lineage[i] = identity.map_or_else(Lineage::default, |identity| identity.lineage);
                span[i] = read(spans);
                order[i] = read(orders).0;
            });
        };
        let form = || {
            each::<FormParts>(world, &places, |i, (attached, posed, flows)| {
                attachment[i] = read(attached).0;
                pose[i] = read(posed);
                flow[i] = read(flows);
            });
        };
        at_once(world, n, descent, form);
        self
    }

    /// The second half: what is peculiar to each kind, and what it holds. All is taken anew if the world grew, or
    /// organs or plants were born or went, since the first.
    pub fn other_half(mut self, world: &World) -> Self {
        let Some(roster) = world.get_resource::<Roster>() else { return Self::default() };
        let step = world.get_resource::<StepCount>().map_or(0, |s| s.0);
        if self.step != step || self.birth != roster.birth || self.plants.len() != roster.plants.len() {
            return self.taken_anew(world);
        }
        let n = roster.len();
        fill(&mut self.exposure, n, Exposure::default());
        fill(&mut self.allotment, n, 0.0);
        // An organ despawned from outside stays in the roster until the next step sheds what it bore.
        self.state.clear();
        self.state.extend(roster.kind.iter().map(|kind| OrganState::none(*kind)));
        self.signals.clear();
        let places = roster.places();
        let Self { exposure, allotment, state, signals, .. } = &mut self;
        let stock = || {
            each::<StockParts>(world, &places, |i, (exposed, allotted)| {
                exposure[i] = read(exposed);
                allotment[i] = read(allotted).0;
            });
        };
        let states = || {
            each::<StateParts>(world, &places, |i, (wood, node, apical, steering, target, lateral, leaf)| {
                state[i] = match roster.kind[i] {
                    OrganKind::Internode => OrganState::Internode(read(wood), node.copied()),
                    OrganKind::ApicalBud => {
                        let (steering, sent) = steering.map_or_else(Default::default, |(a, b)| (*a, *b));
                        if !sent.is_default() {
                            signals.push((i as u32, sent));
                        }
                        OrganState::ApicalBud(read(apical), steering, read(target))
                    }
                    OrganKind::LateralBud => OrganState::LateralBud(read(lateral), read(target)),
                    OrganKind::Leaf => OrganState::Leaf(read(leaf)),
                };
            });
        };
        at_once(world, n, stock, states);
        self.signals.sort_unstable_by_key(|(i, _)| *i);
        self
    }

    /// The same without some plants, by index; the others keep theirs.
    pub fn without(&self, plants: &[u32]) -> Self {
        let mut left = Self { step: self.step, next_birth: self.next_birth, ..Self::default() };
        left.plants = self.plants.clone();
        for &gone in plants {
            if let Some(plant) = left.plants.get_mut(gone as usize) {
                *plant = None;
            }
        }
        let mut index = vec![NO_PARENT; self.len()];
        for i in (0..self.len()).filter(|&i| !plants.contains(&self.plant[i])) {
            index[i] = left.len() as u32;
            left.birth.push(self.birth[i]);
            left.parent.push(self.parent[i]);
            left.plant.push(self.plant[i]);
            left.lineage.push(self.lineage[i]);
            left.span.push(self.span[i]);
            left.order.push(self.order[i]);
            left.attachment.push(self.attachment[i]);
            left.pose.push(self.pose[i]);
            left.exposure.push(self.exposure[i]);
            left.allotment.push(self.allotment[i]);
            left.flow.push(self.flow[i]);
            left.state.push(self.state[i]);
        }
        for parent in left.parent.iter_mut().filter(|parent| **parent != NO_PARENT) {
            *parent = index[*parent as usize];
        }
        let signals = self.signals.iter().map(|&(i, signals)| (index[i as usize], signals));
        left.signals = signals.filter(|(i, _)| *i != NO_PARENT).collect();
        left
    }

    /// Length of organ `i`, metres; 0 for buds and leaves.
    pub fn length(&self, i: usize) -> f32 {
        match &self.state[i] {
            OrganState::Internode(internode, _) => internode.length,
            _ => 0.0,
        }
    }

    /// A hash of every bit that growth depends on. Two trees are the same if and only if their hashes are.
    ///
    /// # Panics
    /// Never: postcard writes to memory, and every type in a snapshot can be written.
    pub fn hash(&self) -> u64 {
        let bytes = postcard::to_stdvec(self).unwrap_or_default();
        fnv1a(&bytes)
    }
}

/// FNV-1a over eight bytes at a time.
fn fnv1a(bytes: &[u8]) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for chunk in bytes.chunks(8) {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        hash = (hash ^ u64::from_le_bytes(word)).wrapping_mul(0x0100_0000_01b3);
        hash ^= hash >> 32;
    }
    hash ^ bytes.len() as u64
}

fn plant_record(world: &World, plant: Entity) -> Option<PlantRecord> {
    let transform = plant_transform(world, plant);
    Some(PlantRecord {
        species: world.get::<Plant>(plant)?.species.clone(),
        seed: world.get::<Plant>(plant)?.seed,
        position: transform.translation,
        rotation: transform.rotation,
        store: *world.get::<EnergyStore>(plant)?,
        ledger: *world.get::<EnergyLedger>(plant)?,
    })
}

/// Where an entity stands in the world, through all its parents.
pub(crate) fn plant_transform(world: &World, entity: Entity) -> Transform {
    let of = |it: Entity| Some((world.get::<Transform>(it), world.get::<ChildOf>(it)));
    super::pose::standing(entity, of)
}

/// Puts the organs of a snapshot back into a world that holds none. One from outside must pass
/// [`Snapshot::check`] first: its columns are taken to belong together.
pub fn restore(world: &mut World, shot: &Snapshot) {
    world.insert_resource(StepCount(shot.step));
    let mut roster = Roster { next_birth: shot.next_birth, ..Default::default() };
    for record in &shot.plants {
        roster.plants.push(record.as_ref().map(|record| {
            world
                .spawn((
                    Plant { species: record.species.clone(), seed: record.seed },
                    Transform::from_translation(record.position).with_rotation(record.rotation),
                    record.store,
                    record.ledger,
                ))
                .id()
        }));
    }
    let mut signals = shot.signals.iter().copied().peekable();
    for i in 0..shot.len() {
        let here = signals.next_if(|(organ, _)| *organ as usize == i);
        let Some(plant) = roster.plants[shot.plant[i] as usize] else { continue };
        let parent = match shot.parent[i] {
            NO_PARENT => plant,
            p => roster.entity[p as usize],
        };
        let mut organ = world.spawn((
            Identity { plant, birth: shot.birth[i], lineage: shot.lineage[i] },
            GrowsFrom(parent),
            shot.span[i],
            BranchOrder(shot.order[i]),
            Attachment(shot.attachment[i]),
            shot.pose[i],
            shot.flow[i],
        ));
        match shot.state[i] {
            OrganState::Internode(internode, node) => {
                organ.insert(internode);
                if let Some(node) = node {
                    organ.insert(node);
                }
            }
            OrganState::ApicalBud(bud, steering, target) => {
                let signals = here.map_or_else(Signals::default, |(_, signals)| signals);
                let state = (bud, steering, signals, target, shot.exposure[i], Allotment(shot.allotment[i]));
                organ.insert(state);
            }
            OrganState::LateralBud(bud, target) => {
                organ.insert((bud, target, shot.exposure[i], Allotment(shot.allotment[i])));
            }
            OrganState::Leaf(leaf) => {
                organ.insert((leaf, shot.exposure[i], Allotment(shot.allotment[i])));
            }
        }
        let entity = organ.id();
        roster.entity.push(entity);
        roster.birth.push(shot.birth[i]);
        roster.parent.push(shot.parent[i]);
        roster.plant.push(shot.plant[i]);
        roster.kind.push(shot.state[i].kind());
    }
    world.insert_resource(roster);
}
