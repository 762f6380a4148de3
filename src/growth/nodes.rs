//! Nodes: rule 2 (`A -> N [L B] [A]`), and the leaves that unfold there (`LK-5`, `LK-8`).

use std::time::Instant;

use bevy::math::ops;
use bevy::prelude::*;

use super::birth::Newborn;
use super::generation::Condemned;
use super::parts::{AT_ONCE, StepParts};
use super::{Mechanisms, StepCount};
use crate::chance::{self, Purpose};
use crate::plant::{
    Allotment, ApicalBud, Attachment, BranchOrder, Cause, EnergyLedger, EnergyStore, Exposure, GrowthSpan,
    GrowthTarget, Identity, LateralBud, Leaf, LeafState, Lineage, Node, OrganKind, Plant, Pose, Roster, pose,
};
use crate::species::{Allocation, Species};
use crate::tropism::Steering;

/// A node formed in this step, whose organs are still to come.
#[derive(Debug, Clone, Copy, Reflect)]
pub struct FreshNode {
    /// The internode that ends in it.
    pub internode: Entity,
    /// Birth number of that internode.
    pub birth: u32,
    /// The bud that formed it.
    pub bud: Entity,
    /// The node.
    pub node: Node,
    /// Angle about the stem of its first organ, radians.
    pub phyllotaxis: f32,
    /// Place in its growth unit, 0 base to 1 tip.
    pub rank: f32,
    /// Whether it is the last of its growth unit.
    pub ends_unit: bool,
    /// Whether that unit is a short shoot, which bears no whorl.
    pub short: bool,
}

/// The nodes formed in this step, a resource.
#[derive(Resource, Debug, Default, Reflect)]
#[reflect(Resource, Default)]
pub struct FreshNodes(pub Vec<FreshNode>);

/// An organ a node bears: its kind and its turn relative to the stem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeOrgan {
    /// Leaf, lateral bud or apical bud.
    pub kind: OrganKind,
    /// Turn relative to the internode that ends in the node.
    pub attachment: Quat,
    /// Order added to the stem's.
    pub order: u32,
}

/// Turn of an organ that leaves its stem at `angle`, at `azimuth` about it (radians).
pub fn leaving(azimuth: f32, angle: f32) -> Quat {
    Quat::from_rotation_y(azimuth) * Quat::from_rotation_x(angle)
}

/// The organs of a node (`LK-5`): leaves spread about the stem from the phyllotaxis angle, a lateral bud in the
/// axil of each, apical buds between them.
pub fn layout(species: &Species, phyllotaxis: f32, order: u32) -> Vec<NodeOrgan> {
    let mut organs = Vec::new();
    let around = |k: u32, n: u32| phyllotaxis + core::f32::consts::TAU * k as f32 / n as f32;
    let branching = species.branching_angle(order);
    for k in 0..species.leaves_per_node {
        let attachment = leaving(around(k, species.leaves_per_node), species.leaf_angle_deg.to_radians());
        organs.push(NodeOrgan { kind: OrganKind::Leaf, attachment, order: 0 });
    }
    if order >= species.max_order {
        return organs;
    }
    for k in 0..species.lateral_buds_per_node {
        let attachment = leaving(around(k, species.lateral_buds_per_node), branching);
        organs.push(NodeOrgan { kind: OrganKind::LateralBud, attachment, order: 1 });
    }
    for k in 0..species.apical_buds_per_node {
        let between = core::f32::consts::PI / species.apical_buds_per_node as f32;
        let attachment = leaving(around(k, species.apical_buds_per_node) + between, branching);
        organs.push(NodeOrgan { kind: OrganKind::ApicalBud, attachment, order: 1 });
    }
    organs
}

/// The ring of lateral buds at the end of a growth unit.
pub fn whorl(species: &Species, phyllotaxis: f32, order: u32) -> impl Iterator<Item = NodeOrgan> {
    let buds = if order < species.max_order { species.whorl_buds.get(order).round() as u32 } else { 0 };
    let branching = species.branching_angle(order);
    // Between the lateral buds of the node, if it has any.
    let between = if species.lateral_buds_per_node > 0 { core::f32::consts::PI / buds as f32 } else { 0.0 };
    (0..buds).map(move |k| NodeOrgan {
        kind: OrganKind::LateralBud,
        attachment: leaving(
            phyllotaxis + between + core::f32::consts::TAU * k as f32 / buds as f32,
            branching,
        ),
        order: 1,
    })
}

/// The shoots that follow a terminal bud that died: of its order, spread about its axis.
pub fn fork(species: &Species, phyllotaxis: f32) -> impl Iterator<Item = NodeOrgan> {
    let (angle, shoots) = (species.fork_angle_deg.to_radians(), species.fork_shoots);
    (0..shoots).map(move |k| NodeOrgan {
        kind: OrganKind::ApicalBud,
        attachment: leaving(phyllotaxis + core::f32::consts::TAU * k as f32 / shoots as f32, angle),
        order: 0,
    })
}

/// Planation: an organ of a stem turned about it towards the level plane, by `planation` (0..1) where the stem is
/// level, less where it rises, not at all where it is upright.
pub fn planated(stem: Quat, attachment: Quat, planation: f32) -> Quat {
    let level = (stem * Vec3::Y).cross(Vec3::Y);
    let lying = level.length();
    let now = attachment * Vec3::Y;
    if planation <= 0.0 || lying < 1e-3 || now.xz().length_squared() < 1e-6 {
        return attachment;
    }
    let flank = stem.inverse() * (level / lying);
    let flank = if now.dot(flank) < 0.0 { -flank } else { flank };
    let turn = ops::atan2(now.cross(flank).y, now.xz().dot(flank.xz()));
    Quat::from_rotation_y(turn * planation * lying.min(1.0)) * attachment
}

/// Epitony: demand of a bud by the side of its stem it sits on, 1 at the flanks.
pub fn favour(stem: Quat, attachment: Quat, epitony: f32) -> f32 {
    let outwards = (attachment * Vec3::Y).with_y(0.0).normalize_or_zero();
    (1.0 + epitony * (stem * outwards).y).max(0.0)
}

/// Forms the organs of fresh nodes. The bud that made the node goes on, or ends in its organs.
#[allow(clippy::type_complexity, clippy::too_many_arguments, reason = "a system names what it reads")]
pub fn form_nodes(
    mut commands: Commands,
    mut roster: ResMut<Roster>,
    mut fresh: ResMut<FreshNodes>,
    mut condemned: ResMut<Condemned>,
    step: Res<StepCount>,
    mechanisms: Res<Mechanisms>,
    plants: Query<&Plant>,
    mut stores: Query<&mut EnergyStore>,
    stems: Query<(&Pose, &crate::plant::Internode)>,
    mut buds: Query<(&Identity, &BranchOrder, &Exposure, &mut Allotment, &ApicalBud)>,
    mut parts: ResMut<StepParts>,
) {
    let began = Instant::now();
    let nodes = core::mem::take(&mut fresh.0);
    for (k, node) in nodes.iter().enumerate() {
        if k > 0 && k % AT_ONCE == 0 && parts.is_time_up_with_births(began) {
            fresh.0.extend_from_slice(&nodes[k..]);
            parts.leave_off_within();
            break;
        }
        let Ok((identity, order, exposure, mut allotment, bud)) = buds.get_mut(node.bud) else { continue };
        let Ok(plant) = plants.get(identity.plant) else { continue };
        let Ok((stem, internode)) = stems.get(node.internode) else { continue };
        let Some(index) = roster.index_of(node.birth) else { continue };
        let species = &plant.species;
        let mut organs = layout(species, node.phyllotaxis, order.0);
        let lineage = node_lineage(identity.lineage, node.node);
        let mut spread = chance::stream(plant.seed, lineage, step.0, Purpose::Divergence);
        if node.ends_unit && !node.short {
            organs.extend(whorl(species, node.phyllotaxis, order.0));
        }
        for organ in &mut organs {
            if organ.kind == OrganKind::LateralBud {
                organ.attachment = planated(stem.rotation, organ.attachment, species.planation.get(order.0));
            }
            organ.attachment *= strayed(species, &mut spread);
        }
        let mut rng = chance::stream(plant.seed, identity.lineage, step.0, Purpose::TerminalDeath);
        let dies =
            node.ends_unit && bud.nodes > 1 && chance::unit(&mut rng) < species.terminal_death.get(order.0);
        if dies {
            organs.extend(fork(species, node.phyllotaxis + core::f32::consts::FRAC_PI_2));
        }
        let prepaid = mechanisms.energy && species.allocation == Allocation::ByVigour;
        let inherited = Exposure { sensed: false, ..*exposure };
        let stem = pose::Stem { pose: *stem, length: internode.length, radius: internode.radius };
        for (k, organ) in organs.into_iter().enumerate() {
            let pose = stem.bear(organ.attachment, organ.kind != OrganKind::ApicalBud);
            let newborn = Newborn {
                plant: identity.plant,
                plant_index: roster.plant[index],
                from: node.internode,
                parent: index as u32,
                lineage: lineage.child(k as u32),
                order: order.0 + organ.order,
                attachment: organ.attachment,
                pose,
                span: GrowthSpan::step(step.0),
            };
            let target = GrowthTarget::default();
            match organ.kind {
                OrganKind::Leaf => {
                    let paid = if prepaid { species.leaf_cost.min(allotment.0.max(0.0)) } else { 0.0 };
                    allotment.0 -= paid;
                    let state = (Leaf::default(), inherited, Allotment(paid));
                    newborn.bear(&mut commands, &mut roster, organ.kind, state);
                }
                OrganKind::LateralBud => {
                    let bud = LateralBud {
                        dormancy: species.dormancy_steps,
                        rank: node.rank,
                        favour: favour(stem.pose.rotation, organ.attachment, species.epitony),
                        ..Default::default()
                    };
                    let state = (bud, target, inherited, Allotment(0.0));
                    newborn.bear(&mut commands, &mut roster, organ.kind, state);
                }
                _ => {
                    let state =
                        (ApicalBud::default(), Steering::default(), target, inherited, Allotment(0.0));
                    newborn.bear(&mut commands, &mut roster, organ.kind, state);
                }
            }
        }
        if dies || !species.axis_continues {
            if let Ok(mut store) = stores.get_mut(identity.plant) {
                store.stored += f64::from(allotment.0);
            }
            allotment.0 = 0.0;
            condemned.0.push((identity.birth, if dies { Cause::Aborted } else { Cause::Branched }));
        }
    }
}

/// A leaf sunk away from its stem by an angle (radians), to 150 degrees at most.
pub fn drooped(attachment: Quat, by: f32) -> Quat {
    /// Lower no leaf hangs.
    const LOWEST: f32 = 150.0 / 180.0 * core::f32::consts::PI;
    let angle = (attachment * Vec3::Y).angle_between(Vec3::Y);
    attachment * Quat::from_rotation_x(by.min(LOWEST - angle).max(0.0))
}

/// A chance turn of an organ: sideways and away from its stem.
fn strayed(species: &Species, rng: &mut rand_pcg::Pcg64Mcg) -> Quat {
    let spread = species.angle_spread_deg.to_radians();
    if spread == 0.0 {
        return Quat::IDENTITY;
    }
    let [sideways, away] = [0; 2].map(|_| chance::normal(rng) * spread);
    Quat::from_rotation_z(sideways) * Quat::from_rotation_x(away)
}

/// Lineage that the organs of a node descend from.
fn node_lineage(bud: Lineage, node: Node) -> Lineage {
    bud.child(2_000_000_000u32.wrapping_add(node.ordinal))
}

/// Unfolds leaves by the energy allotted to them.
pub fn unfold_leaves(
    roster: Res<Roster>,
    mechanisms: Res<Mechanisms>,
    plants: Query<&Plant>,
    mut ledgers: Query<&mut EnergyLedger>,
    mut leaves: Query<(&Identity, &mut Leaf, &mut Allotment, &mut Attachment)>,
) {
    for i in 0..roster.len() {
        if roster.kind[i] != OrganKind::Leaf {
            continue;
        }
        let Ok((identity, mut leaf, mut allotment, mut attachment)) = leaves.get_mut(roster.entity[i]) else {
            continue;
        };
        let Ok(plant) = plants.get(identity.plant) else { continue };
        let species = &plant.species;
        if species.leaf_droop_deg > 0.0 {
            attachment.0 = drooped(attachment.0, species.leaf_droop_deg.to_radians());
        }
        if leaf.state == LeafState::Growing {
            let room = (1.0 - leaf.size).min(species.leaf_growth);
            let growth = if mechanisms.energy { (allotment.0 / species.leaf_cost).min(room) } else { room };
            if growth > 0.0 {
                leaf.size = (leaf.size + growth).min(1.0);
                if leaf.size >= 1.0 - 1e-4 {
                    leaf.size = 1.0;
                    leaf.state = LeafState::Terminated;
                }
                if mechanisms.energy {
                    let spent = (growth * species.leaf_cost).min(allotment.0);
                    allotment.0 -= spent;
                    if let Ok(mut ledger) = ledgers.get_mut(identity.plant) {
                        ledger.growth += f64::from(spent);
                    }
                }
            }
        }
    }
}
