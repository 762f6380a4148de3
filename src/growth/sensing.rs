//! Looking around: every bud and leaf finds its light and space, every bud that will grow its target (`LK-13` to
//! `LK-15`).
//!
//! [`SensingJob::look`] is a pure function of what a [`Survey`] took from the world, so a step
//! [in parts](super::parts) has other threads do it, with the same result.

use bevy::platform::collections::HashMap;
use bevy::prelude::*;

use super::Mechanisms;
use super::generation::ensure_workers;
use super::parts::{AT_ONCE, StepParts};
use crate::environment::plugin::standing_scene;
use crate::environment::probe::{Probe, Sensing};
use crate::environment::sense::room::{self, Wish};
use crate::environment::sense::{Reading, Search, SenseRequest, Sensed, sense};
use crate::environment::trace::Tracer;
use crate::environment::workers::Workers;
use crate::environment::{Scene, gather};
use crate::plant::{Exposure, GrowthTarget, NO_PARENT, OrganKind, OrganState, Snapshot};
use crate::species::{Allocation, Species};

/// What there is to look at, from where, and what was seen: plain data.
#[derive(Resource, Debug, Default, Reflect)]
#[reflect(Resource, Default)]
pub struct SensingJob {
    /// What can be seen.
    #[reflect(ignore)]
    pub scene: Scene,
    /// From where they look.
    #[reflect(ignore)]
    pub requests: Vec<SenseRequest>,
    /// The organs that read what is found, and where: some share a look ([`Lookouts`]).
    pub lookers: Vec<(Entity, Place)>,
    /// What each found; filled by [`SensingJob::look`].
    #[reflect(ignore)]
    pub found: Vec<Sensed>,
    /// How they look.
    pub settings: Sensing,
    /// Whether buds keep out of each other's way: if space counts.
    pub keep_apart: bool,
}

/// From how many points organs looked around when they last did, a resource.
#[derive(Resource, Debug, Default, Clone, Copy, PartialEq, Eq, Reflect)]
#[reflect(Resource)]
pub struct ProbeCount(pub usize);

/// What sensing reads of a world: plain data.
#[derive(Debug)]
pub struct Survey {
    shot: Snapshot,
    /// The organs of the snapshot.
    entities: Vec<Entity>,
    /// What stands there but plants.
    standing: Scene,
    settings: Sensing,
    mechanisms: Mechanisms,
}

impl Survey {
    /// Of a world as it is, in the memory of the last one.
    pub fn take(world: &mut World) -> Self {
        let spare = core::mem::take(&mut world.resource_mut::<StepParts>().spare);
        let half = spare.half_taken_anew(world);
        Self::finish(world, half)
    }

    /// Of a world of which half a snapshot is taken.
    pub(super) fn finish(world: &mut World, half: Snapshot) -> Self {
        Self {
            shot: half.other_half(world),
            standing: standing_scene(world),
            entities: world.resource::<crate::plant::Roster>().entity.clone(),
            settings: *world.resource::<Sensing>(),
            mechanisms: *world.resource::<Mechanisms>(),
        }
    }

    /// What there is to look at, and from where; and the snapshot it was read from.
    pub fn job(self) -> (SensingJob, Snapshot) {
        let Self { shot, entities, standing: mut scene, settings, mechanisms } = self;
        gather::add_plants(&mut scene, &shot);
        let mut job = SensingJob { scene, settings, keep_apart: mechanisms.space, ..SensingJob::default() };
        if mechanisms.light || mechanisms.space {
            job.ask(&shot, &entities, mechanisms);
        }
        (job, shot)
    }
}

impl SensingJob {
    /// Asks for what every organ looks for.
    fn ask(&mut self, shot: &Snapshot, entities: &[Entity], mechanisms: Mechanisms) {
        let lookouts = Lookouts::of(shot, &self.settings, mechanisms);
        let reads = lookouts.read.iter().enumerate().filter_map(|(i, here)| Some((entities[i], (*here)?)));
        self.lookers = reads.collect();
        self.requests = lookouts.requests;
    }

    /// Looks around from every probe.
    pub fn look(&mut self, workers: &Workers) {
        if self.requests.is_empty() {
            return;
        }
        let tracer = Tracer::build(&self.scene);
        self.found = sense(&tracer, &self.requests, &self.settings, workers);
        if self.keep_apart {
            keep_apart(self);
        }
    }

    /// Becomes what the world's organs will read; the memory of `spare` is used again.
    pub(super) fn install(self, world: &mut World, spare: Snapshot) {
        world.resource_mut::<StepParts>().spare = spare;
        world.insert_resource(ProbeCount(self.requests.len()));
        world.insert_resource(self);
    }
}

/// Where an organ finds what it looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Reflect)]
pub struct Place {
    /// Which request.
    pub request: usize,
    /// Which of its guests, if it is not the organ that looks.
    pub guest: Option<usize>,
}

impl Place {
    /// What was read there.
    fn reading(self, found: &Sensed) -> Option<Reading> {
        match self.guest {
            None => Some(Reading { light: found.light, space: found.space }),
            Some(guest) => found.guests.get(guest).copied(),
        }
    }
}

/// From where the organs of some plants look around, and who reads what is seen there: an organ that chooses no way
/// shares a look with others of its cell, blind to itself all the same; a bud asleep by a leaf takes what the leaf sees.
#[derive(Debug, Default)]
pub struct Lookouts {
    /// What is asked from each.
    pub requests: Vec<SenseRequest>,
    /// The organ that stands at each, by its index.
    pub organs: Vec<usize>,
    /// Where each organ reads, if it does.
    pub read: Vec<Option<Place>>,
}

impl Lookouts {
    /// Of the organs of a snapshot.
    pub fn of(shot: &Snapshot, settings: &Sensing, mechanisms: Mechanisms) -> Self {
        let mut all = Self { read: vec![None; shot.len()], ..Self::default() };
        let mut cells: HashMap<(u32, IVec3), usize> = HashMap::new();
        let leaves = axillant_leaves(shot);
        let is_leaf = |i: &usize| matches!(shot.state[*i], OrganState::Leaf(_));
        // Leaves first: they look out for the buds beside them.
        for i in (0..shot.len()).filter(is_leaf).chain((0..shot.len()).filter(|i| !is_leaf(i))) {
            let Some(request) = request(shot, i, settings, mechanisms) else { continue };
            let leaf = match shot.parent[i] {
                stem if stem != NO_PARENT && !is_leaf(&i) => leaves[stem as usize],
                _ => u32::MAX,
            };
            let rests = request.search.is_none();
            let through = (rests && leaf != u32::MAX).then(|| all.read[leaf as usize]).flatten();
            let shared =
                (rests && through.is_none()).then(|| cell(shot, i, request.probe.position)).flatten();
            let new = all.requests.len();
            let host = shared.map_or(new, |cell| *cells.entry(cell).or_insert(new));
            all.read[i] = Some(match (through, host) {
                (Some(through), _) => through,
                (None, host) if host < new => {
                    let guests = &mut all.requests[host].guests;
                    guests.push(request.probe.blind_to);
                    Place { request: host, guest: Some(guests.len() - 1) }
                }
                (None, _) => {
                    all.requests.push(request);
                    all.organs.push(i);
                    Place { request: new, guest: None }
                }
            });
        }
        all
    }
}

/// Gathers scene and probes.
pub fn gather_probes(world: &mut World) {
    let (job, shot) = Survey::take(world).job();
    job.install(world, shot);
}

/// The cell in which an organ that chooses no way shares its look around with others of its plant, if its species does so.
fn cell(shot: &Snapshot, i: usize, position: Vec3) -> Option<(u32, IVec3)> {
    let side = shot.plants[shot.plant[i] as usize].as_ref()?.species.light_cell_m;
    (side > 0.0).then(|| (shot.plant[i], (position / side).floor().as_ivec3()))
}

/// The first living leaf on each stem segment, `u32::MAX` where there is none.
fn axillant_leaves(shot: &Snapshot) -> Vec<u32> {
    let mut leaves = vec![u32::MAX; shot.len()];
    for i in (0..shot.len()).rev() {
        if matches!(shot.state[i], OrganState::Leaf(leaf) if leaf.size > 0.0) && shot.parent[i] != NO_PARENT {
            leaves[shot.parent[i] as usize] = i as u32;
        }
    }
    leaves
}

/// What organ `i` asks of the environment, if it looks at all.
pub fn request(
    shot: &Snapshot,
    i: usize,
    settings: &Sensing,
    mechanisms: Mechanisms,
) -> Option<SenseRequest> {
    let species = &*shot.plants[shot.plant[i] as usize].as_ref()?.species;
    let pose = shot.pose[i];
    // A short shoot goes on as it stands; it has no length to choose a way for.
    let short = species.allocation == Allocation::ByVigour
        && mechanisms.energy
        && super::shoots::plan(species, shot.allotment[i]).closes;
    let will_grow = (shot.allotment[i] > 0.0 || !mechanisms.energy) && !short;
    let (position, searches) = match shot.state[i] {
        OrganState::Internode(..) => return None,
        OrganState::ApicalBud(..) => (pose.position, will_grow),
        OrganState::LateralBud(bud, _) => {
            if bud.state != crate::plant::LateralBudState::Dormant {
                return None;
            }
            (pose.position, will_grow && bud.dormancy == 0)
        }
        OrganState::Leaf(leaf) => {
            let half_blade = 0.5 * species.leaf_length_m * leaf.size.sqrt();
            (pose.position + pose.heading() * half_blade, false)
        }
    };
    let support = shot.parent[i];
    let support = if support == NO_PARENT { u32::MAX } else { shot.birth[support as usize] };
    let probe = Probe {
        position,
        blind_to: [shot.birth[i], support],
        face: if searches { settings.bud_face } else { settings.leaf_face },
        space_range: species.space_range_m,
    };
    Some(SenseRequest {
        probe,
        reading: species.light_reading,
        search: searches.then(|| search(species, shot, i, mechanisms)),
        guests: Vec::new(),
    })
}

fn search(species: &Species, shot: &Snapshot, i: usize, mechanisms: Mechanisms) -> Search {
    let order = shot.order[i];
    let age = shot.plants[shot.plant[i] as usize].as_ref().map_or(0, |plant| plant.store.age(shot.step));
    let maturity = species.maturity(age);
    let reach = match species.allocation {
        Allocation::ByExposure if mechanisms.energy => {
            (shot.allotment[i] / species.shoot_cost).min(species.extension_m)
        }
        Allocation::ByExposure => species.extension_m,
        Allocation::ByVigour => super::shoots::plan(species, shot.allotment[i]).length,
    };
    Search {
        rotation: shot.pose[i].rotation,
        cone: species.bending_angle_deg.to_radians(),
        reach: reach.max(species.node_spacing_m),
        radius: species.twig_radius_m,
        candidates: species.candidates,
        weight_light: species.weight_light,
        weight_space: species.weight_space,
        weight_heading: species.weight_heading,
        weight_set_point: species.weight_set_point.get(order),
        set_point: species.set_point(order, maturity),
        rescale: species.rescale_fitness,
        light_on: mechanisms.light,
        space_on: mechanisms.space,
    }
}

/// Looks around from every probe.
pub fn render_cube_maps(world: &mut World) {
    ensure_workers(world);
    world.resource_scope(|world, mut job: Mut<SensingJob>| job.look(world.resource::<Workers>()));
}

/// Lets buds that would grow into each other, or into wood, take their next best candidate.
fn keep_apart(job: &mut SensingJob) {
    let searching: Vec<usize> =
        (0..job.requests.len()).filter(|&i| job.requests[i].search.is_some()).collect();
    let wishes: Vec<Wish> = searching
        .iter()
        .map(|&i| Wish {
            from: job.requests[i].probe.position,
            reach: job.requests[i].search.map_or(0.0, |search| search.reach),
            radius: job.requests[i].search.map_or(0.0, |search| search.radius),
            ranked: &job.found[i].ranked,
        })
        .collect();
    let taken = room::settle(&job.scene.capsules, &wishes);
    for (i, rank) in searching.into_iter().zip(taken) {
        let found = &mut job.found[i];
        found.choice = found.ranked.get(rank).copied();
    }
}

/// Writes light, space and growth targets back to the organs that looked.
pub fn choose_growth_targets(world: &mut World) {
    let job = std::mem::take(&mut *world.resource_mut::<SensingJob>());
    let mechanisms = *world.resource::<Mechanisms>();
    let mut organs = world.query::<(&mut Exposure, Option<&mut GrowthTarget>)>();
    let first = world.resource_mut::<StepParts>().rest.take().map_or(0, |rest| rest.start as usize);
    for (k, &(entity, place)) in job.lookers.iter().enumerate().skip(first) {
        if k > first && k % (16 * AT_ONCE) == 0 && world.resource::<StepParts>().is_time_up() {
            let mut parts = world.resource_mut::<StepParts>();
            parts.rest = Some(k as u32..job.lookers.len() as u32);
            parts.leave_off_within();
            world.insert_resource(job);
            return;
        }
        let Some(found) = job.found.get(place.request) else { continue };
        let Some(Reading { light, space }) = place.reading(found) else { continue };
        let Ok((mut exposure, target)) = organs.get_mut(world, entity) else { continue };
        *exposure = Exposure {
            light: if mechanisms.light { light } else { 1.0 },
            space: if mechanisms.space { space } else { 1.0 },
            sensed: true,
        };
        if let Some(mut target) = target {
            *target = match &found.choice {
                Some(choice) => GrowthTarget { heading: choice.heading, fitness: choice.fitness },
                None => GrowthTarget::default(),
            };
        }
    }
    if !(mechanisms.light || mechanisms.space) {
        let roster = world.resource::<crate::plant::Roster>().clone();
        for i in (0..roster.len()).filter(|&i| roster.kind[i] != OrganKind::Internode) {
            if let Ok((mut exposure, _)) = organs.get_mut(world, roster.entity[i]) {
                *exposure = Exposure { light: 1.0, space: 1.0, sensed: true };
            }
        }
    }
}
