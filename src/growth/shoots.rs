//! Extending shoots: rule 1 (A -> I A), each sub-step steered and kept out of solids (`LK-4`, `ST-5`).

use std::time::Instant;

use bevy::math::ops;
use bevy::prelude::*;

use super::birth::Newborn;
use super::nodes::{FreshNode, FreshNodes};
use super::parts::{AT_ONCE, StepParts};
use super::{Mechanisms, StepCount};
use crate::chance::{self, Purpose};
use crate::environment::gather::capsule;
use crate::environment::obstacles::advance;
use crate::environment::standing_wood::StandingWood;
use crate::environment::{Ground, Solid, StandingSolid};
use crate::plant::{
    Allotment, ApicalBud, Attachment, Bears, BranchOrder, EnergyLedger, EnergyStore, GrowsFrom, GrowthSpan,
    GrowthTarget, Identity, Internode, Lineage, NO_PARENT, Node, OrganKind, Plant, Pose, Roster, pose,
};
use crate::species::{Allocation, Species};
use crate::tropism::{self, Control, Influence, Signals, Steering, Tropisms};

/// What a bud knows as it begins to extend.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tip {
    /// Where it is, metres.
    pub position: Vec3,
    /// Its turn.
    pub rotation: Quat,
    /// Turn of the stem, or plant, that bears its axis.
    pub bearer: Quat,
    /// Its counters.
    pub bud: ApicalBud,
    /// Its controller.
    pub steering: Steering,
    /// Corrections on their way.
    pub signals: Signals,
}

/// How far a bud grows, and how.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Length to grow, metres.
    pub length: f32,
    /// Whether the shoot ends in a node even if it is shorter than the node spacing (a short shoot).
    pub closes: bool,
    /// Most nodes to form.
    pub nodes: u32,
}

/// A new stem segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Its base.
    pub position: Vec3,
    /// Its turn.
    pub rotation: Quat,
    /// Its measures; radius that of a twig.
    pub internode: Internode,
    /// The node it ends in.
    pub node: Option<Node>,
    /// Phyllotaxis angle at that node, radians.
    pub phyllotaxis: f32,
}

/// What a shoot does not grow through.
#[derive(Debug, Clone, Copy)]
pub struct Obstacles<'a> {
    /// Walls and the like.
    pub solids: &'a [StandingSolid],
    /// Wood, for species that avoid it.
    pub wood: &'a StandingWood,
    /// Height of the ground, or of what the shoot keeps above it; `None`: there is none.
    pub floor: Option<f32>,
}

/// Length planned with an amount of energy.
pub fn plan(species: &Species, energy: f32) -> Plan {
    match species.allocation {
        Allocation::ByExposure => Plan {
            length: (energy / species.shoot_cost).min(species.extension_m),
            closes: false,
            nodes: if species.axis_continues { u32::MAX } else { 1 },
        },
        Allocation::ByVigour => {
            let whole = (energy / super::vigour::internode_cost(species) + 1e-3).floor();
            if whole >= 1.0 {
                Plan { length: whole * species.node_spacing_m, closes: false, nodes: whole as u32 }
            } else {
                Plan { length: species.short_internode * species.node_spacing_m, closes: true, nodes: 1 }
            }
        }
    }
}

/// Grows a shoot from its tip towards a target heading; returns the new segments and leaves the tip at the end.
///
/// Growth that meets an obstacle slides along it or stops. `influence` is asked once a sub-step, with the
/// length of the axis so far in metres.
pub fn extend(
    tip: &mut Tip,
    plan: Plan,
    target: Vec3,
    order: u32,
    species: &Species,
    obstacles: Obstacles,
    mut influence: impl FnMut(f32) -> Influence,
) -> Vec<Segment> {
    const LEAST: f32 = 1e-4;
    // A shoot that all but reaches its next node forms it: a hair less energy must not cost a whole node.
    const NEARLY: f32 = 0.95;
    let control = Control::of(species);
    let tropisms = Tropisms::of(species, order);
    if !tropisms.only_light() && tip.signals.outset == Vec3::ZERO {
        tip.signals.outset = tip.bearer.inverse() * tip.rotation * Vec3::Y;
    }
    let outset = tip.bearer * tip.signals.outset;
    let mut left = plan.length;
    let mut segments = Vec::new();
    let mut nodes = 0;
    while left > LEAST && nodes < plan.nodes {
        let to_node = species.node_spacing_m - tip.bud.height_since_node;
        // The last sub-segment is cut to fit (`ST-10`).
        let wanted = species.internode_m.min(to_node).min(left).max(LEAST);
        let along = tip.bud.height_in_branch;
        let goal = tropisms.set_point(target, tip.rotation * Vec3::Y, outset, Vec3::Y, along);
        let acting = influence(along);
        let (steering, signals) = (&mut tip.steering, &mut tip.signals);
        let steered = tropism::step(&control, steering, signals, tip.rotation, goal, acting);
        let (from, radius) = (tip.position, species.twig_radius_m);
        let Obstacles { solids, wood, floor } = obstacles;
        let step = if species.avoids_wood {
            wood.advance(solids, floor, from, steered, wanted, radius)
        } else {
            advance(solids, &[], floor, from, steered, wanted, radius)
        };
        if step.length < LEAST {
            break;
        }
        tip.rotation = tropism::turned_to(tip.rotation, step.direction);
        tip.bud.height_since_node += step.length;
        tip.bud.height_in_branch += step.length;
        left -= step.length;
        let blocked = step.length < wanted * 0.999;
        let closes = plan.closes && left <= LEAST;
        let at_node = tip.bud.height_since_node >= NEARLY * species.node_spacing_m || closes || blocked;
        let internode = Internode {
            length: step.length,
            radius: species.twig_radius_m,
            height_since_node: tip.bud.height_since_node,
            height_in_branch: tip.bud.height_in_branch,
            pipe: ops::powf(species.twig_radius_m, species.pipe_exponent),
            poor_steps: 0,
            sag: 0.0,
        };
        segments.push(Segment {
            position: tip.position,
            rotation: tip.rotation,
            internode,
            node: at_node.then_some(Node { ordinal: tip.bud.nodes }),
            phyllotaxis: tip.bud.phyllotaxis,
        });
        tip.position += tip.rotation * Vec3::Y * step.length;
        if at_node {
            nodes += 1;
            tip.bud.nodes += 1;
            tip.bud.height_since_node = 0.0;
            tip.bud.phyllotaxis =
                (tip.bud.phyllotaxis + species.phyllotaxis_deg.to_radians()) % core::f32::consts::TAU;
        }
        if blocked {
            break;
        }
    }
    segments
}

/// Gathers the wood that shoots find in their way, if any species avoids it: a part of what they sense of space.
pub fn gather_wood(
    roster: Res<Roster>,
    mechanisms: Res<Mechanisms>,
    plants: Query<&Plant>,
    stems: Query<(&Pose, &Internode)>,
    mut wood: ResMut<StandingWood>,
    mut parts: ResMut<StepParts>,
) {
    let asked = parts.rest.take().unwrap_or_else(|| {
        let avoid = mechanisms.space && plants.iter().any(|plant| plant.species.avoids_wood);
        let longest = plants.iter().map(|plant| plant.species.internode_m).fold(0.05, f32::max);
        wood.begin(avoid.then_some(longest));
        0..roster.next_birth
    });
    if !wood.minds() {
        return;
    }
    // By birth: between two parts the host may take organs away.
    for i in roster.birth.partition_point(|birth| *birth < asked.start)..roster.len() {
        let birth = roster.birth[i];
        if birth > asked.start && i.is_multiple_of(AT_ONCE) && parts.is_time_up() {
            parts.rest = Some(birth..asked.end);
            parts.leave_off_within();
            return;
        }
        if roster.kind[i] == OrganKind::Internode
            && let Ok((pose, internode)) = stems.get(roster.entity[i])
        {
            wood.add(capsule(pose, internode, birth, roster.plant[i]));
        }
    }
}

/// Extends every apical bud that has energy and a target; the bud is born anew beyond its new internodes.
#[allow(clippy::type_complexity, clippy::too_many_arguments, reason = "a system names what it reads")]
pub fn extend_shoots(
    mut commands: Commands,
    mut roster: ResMut<Roster>,
    mut fresh: ResMut<FreshNodes>,
    step: Res<StepCount>,
    mechanisms: Res<Mechanisms>,
    ground: Res<Ground>,
    plants: Query<(&Plant, &EnergyStore)>,
    stems: Query<(&Pose, &Internode), Without<ApicalBud>>,
    transforms: Query<(Option<&Transform>, Option<&ChildOf>)>,
    mut ledgers: Query<&mut EnergyLedger>,
    solids: Query<(&Solid, &Transform)>,
    mut buds: Query<(
        &mut Identity,
        &BranchOrder,
        &mut Pose,
        &mut Attachment,
        &mut GrowthSpan,
        &GrowthTarget,
        (&mut Steering, &mut Signals),
        &mut Allotment,
        &mut ApicalBud,
    )>,
    mut wood: ResMut<StandingWood>,
    mut parts: ResMut<StepParts>,
) {
    let began = Instant::now();
    let solids = crate::environment::standing_solids(solids.iter());
    let living = roster.len();
    let mut moved = vec![false; living];
    // By birth: a bud that has grown is born anew.
    let asked = parts.rest.take().unwrap_or(0..roster.next_birth);
    let mut buds_seen = 0;
    for i in 0..living {
        let birth = roster.birth[i];
        if roster.kind[i] != OrganKind::ApicalBud || !asked.contains(&birth) {
            continue;
        }
        if buds_seen > 0 && buds_seen % AT_ONCE == 0 && parts.is_time_up_with_births(began) {
            parts.rest = Some(birth..asked.end);
            parts.leave_off_within();
            break;
        }
        buds_seen += 1;
        let entity = roster.entity[i];
        let Ok((
            mut identity,
            order,
            mut pose,
            mut attachment,
            mut span,
            target,
            (mut steering, mut signals),
            mut allotment,
            mut bud,
        )) = buds.get_mut(entity)
        else {
            continue;
        };
        let Ok((plant, store)) = plants.get(identity.plant) else { continue };
        let species = &plant.species;
        if species.rests(store.age(step.0)) {
            continue;
        }
        if mechanisms.energy && allotment.0 <= 0.0 {
            bud.starved += 1;
            continue;
        }
        let energy = if mechanisms.energy { allotment.0 } else { full_energy(species, order.0) };
        let parent = roster.parent[i];
        let bearer = if Tropisms::of(species, order.0).only_light() {
            Quat::IDENTITY
        } else {
            let stem = |organ: u32| stems.get(roster.entity[organ as usize]).ok();
            match bearing_stem(parent, bud.height_in_branch > 0.0, &roster.parent, |i| stem(i).map(|s| s.1)) {
                NO_PARENT => pose::standing(identity.plant, |it| transforms.get(it).ok()).rotation,
                bearing => stem(bearing).map_or(Quat::IDENTITY, |(pose, _)| pose.rotation),
            }
        };
        let mut tip = Tip {
            position: pose.position,
            rotation: pose.rotation,
            bearer,
            bud: *bud,
            steering: *steering,
            signals: *signals,
        };
        let stream = |purpose| chance::stream(plant.seed, identity.lineage, step.0, purpose);
        let (mut wander, mut sensing) = (stream(Purpose::Wander), stream(Purpose::Steering));
        let heading = if target.heading == Vec3::ZERO { pose.heading() } else { target.heading };
        let plan = plan(species, energy);
        let floor = floor(species, ground.0, order.0, tip.position.y);
        let obstacles = Obstacles { solids: &solids, wood: &wood, floor };
        let segments = extend(&mut tip, plan, heading, order.0, species, obstacles, |along| {
            Influence::of(species, along, &mut sensing, &mut wander)
        });
        if segments.is_empty() {
            bud.starved += 1;
            continue;
        }
        let grown: f32 = segments.iter().map(|s| s.internode.length).sum();
        if mechanisms.energy {
            let spent = (grown * species.shoot_cost).min(allotment.0);
            allotment.0 -= spent;
            if let Ok(mut ledger) = ledgers.get_mut(identity.plant) {
                ledger.growth += f64::from(spent);
            }
        }
        let plant_index = roster.plant[i];
        let mut stem =
            (parent, if parent == NO_PARENT { identity.plant } else { roster.entity[parent as usize] });
        let mut below_rotation = (pose.rotation * attachment.0.inverse()).normalize();
        let count = segments.len() as f32;
        let last = segments.iter().rposition(|s| s.node.is_some());
        for (k, segment) in segments.iter().enumerate() {
            let index = roster.len() as u32;
            let birth = roster.next_birth;
            let base = Pose { position: segment.position, rotation: segment.rotation };
            let newborn = Newborn {
                plant: identity.plant,
                plant_index,
                from: stem.1,
                parent: stem.0,
                lineage: segment_lineage(identity.lineage, step.0, k as u32),
                order: order.0,
                attachment: (below_rotation.inverse() * segment.rotation).normalize(),
                pose: base,
                span: GrowthSpan {
                    start: step.0 as f32 + k as f32 / count,
                    end: step.0 as f32 + (k + 1) as f32 / count,
                },
            };
            let (kind, stem_state) = (OrganKind::Internode, (segment.internode, Bears::default()));
            let internode = match segment.node {
                Some(node) => newborn.bear(&mut commands, &mut roster, kind, (stem_state, node)),
                None => newborn.bear(&mut commands, &mut roster, kind, stem_state),
            };
            wood.add(capsule(&base, &segment.internode, birth, plant_index));
            if let Some(node) = segment.node {
                fresh.0.push(FreshNode {
                    internode,
                    birth,
                    bud: entity,
                    node,
                    phyllotaxis: segment.phyllotaxis,
                    rank: (k + 1) as f32 / count,
                    ends_unit: Some(k) == last,
                    short: plan.closes,
                });
            }
            stem = (index, internode);
            below_rotation = segment.rotation;
        }
        moved[i] = true;
        commands.entity(entity).insert(GrowsFrom(stem.1));
        identity.birth = roster.bear(entity, stem.0, plant_index, OrganKind::ApicalBud);
        *span = GrowthSpan::step(step.0);
        *pose = Pose { position: tip.position, rotation: tip.rotation };
        attachment.0 = Quat::IDENTITY;
        *steering = tip.steering;
        if *signals != tip.signals {
            *signals = tip.signals;
        }
        *bud = ApicalBud { starved: 0, ..tip.bud };
    }
    if parts.rest.is_none() {
        // Old trunks pass many cells: nothing of the grid is kept until the next step.
        wood.begin(None);
    }
    moved.resize(roster.len(), false);
    let stays: Vec<bool> = moved.iter().map(|m| !m).collect();
    roster.retain(&stays);
}

/// The stem that bears an axis whose tip grows from `below`, or [`NO_PARENT`] where the plant itself does; `set_out`:
/// whether the axis has stems of its own already.
fn bearing_stem<'a>(
    below: u32,
    set_out: bool,
    parents: &[u32],
    stem: impl Fn(u32) -> Option<&'a Internode>,
) -> u32 {
    let mut at = below;
    let mut own = set_out;
    while own && at != NO_PARENT {
        // The first of an axis is as long as the axis is high.
        own = stem(at).is_some_and(|wood| wood.height_in_branch > 1.0001 * wood.length);
        at = parents[at as usize];
    }
    at
}

/// Height at which a shoot that starts at height `from` stops as on the ground: side axes keep their species'
/// clearance, or the half of their own height where that is less.
pub fn floor(species: &Species, ground: Option<f32>, order: u32, from: f32) -> Option<f32> {
    let clearance = if order == 0 { 0.0 } else { species.ground_clearance_m };
    ground.map(|ground| ground + clearance.min(0.5 * (from - ground)).max(0.0))
}

/// Energy of a bud when energy is not modelled: all it can use.
pub(super) fn full_energy(species: &Species, order: u32) -> f32 {
    match species.allocation {
        Allocation::ByExposure => species.extension_m * species.shoot_cost,
        Allocation::ByVigour => {
            super::vigour::internode_cost(species) * species.flush_internodes.get(order).max(1.0).floor()
        }
    }
}

/// Lineage of the `k`-th internode a bud makes in a step.
pub(super) fn segment_lineage(bud: Lineage, step: u32, k: u32) -> Lineage {
    bud.child(1_000_000_000u32.wrapping_add(step)).child(k)
}
