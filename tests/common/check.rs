//! What holds after every step, whatever grows.

use std::collections::HashMap;

use bevy::math::ops;
use bevy::prelude::*;
use burgeon::environment::Solid;
use burgeon::environment::{SolidShape, StandingSolid, standing_solids};
use burgeon::files::ResolvedScenario;
use burgeon::plant::{Identity, NO_PARENT, OrganKind, OrganState, Roster, Snapshot};

/// Fails with a sentence.
macro_rules! hold {
    ($condition:expr, $($words:tt)+) => {
        match $condition {
            true => {}
            false => return Err(format!($($words)+)),
        }
    };
}

fn in_unit(x: f32) -> bool {
    (0.0..=1.0).contains(&x)
}

/// Topology, numbers, orders, energy and wood of a snapshot.
pub fn check(shot: &Snapshot) -> Result<(), String> {
    topology(shot)?;
    numbers(shot)?;
    energy(shot)?;
    wood(shot)
}

fn topology(shot: &Snapshot) -> Result<(), String> {
    let mut roots = vec![0; shot.plants.len()];
    let mut lineages = HashMap::new();
    for i in 0..shot.len() {
        let kind = shot.state[i].kind();
        hold!(i == 0 || shot.birth[i - 1] < shot.birth[i], "births do not rise at {i}");
        hold!(shot.birth[i] < shot.next_birth, "organ {i} is not born yet");
        hold!(shot.plants[shot.plant[i] as usize].is_some(), "organ {i} has no plant");
        if let Some(other) = lineages.insert((shot.plant[i], shot.lineage[i]), i) {
            return Err(format!("organs {other} and {i} have one lineage"));
        }
        if shot.parent[i] == NO_PARENT {
            roots[shot.plant[i] as usize] += 1;
            hold!(matches!(kind, OrganKind::Internode | OrganKind::ApicalBud), "{kind:?} {i} on the ground");
            hold!(shot.order[i] == 0, "trunk {i} is of order {}", shot.order[i]);
            continue;
        }
        let p = shot.parent[i] as usize;
        hold!(p < i, "organ {i} comes before its parent {p}");
        hold!(shot.plant[p] == shot.plant[i], "organ {i} grows from another plant");
        hold!(shot.state[p].kind() == OrganKind::Internode, "organ {i} grows from no stem");
        let (order, below) = (shot.order[i], shot.order[p]);
        let right = match kind {
            OrganKind::Leaf => order == below,
            OrganKind::LateralBud => order == below + 1,
            OrganKind::Internode | OrganKind::ApicalBud => order == below || order == below + 1,
        };
        hold!(right, "{kind:?} {i} of order {order} on order {below}");
    }
    for (plant, &n) in roots.iter().enumerate() {
        hold!(n <= 1, "plant {plant} has {n} trunks");
    }
    Ok(())
}

fn numbers(shot: &Snapshot) -> Result<(), String> {
    for i in 0..shot.len() {
        let pose = &shot.pose[i];
        hold!(pose.position.is_finite(), "organ {i} is at {}", pose.position);
        hold!((pose.heading().length() - 1.0).abs() < 1e-4, "heading of {i} is {}", pose.heading());
        hold!(shot.attachment[i].is_finite(), "attachment of {i}");
        let (exposure, flow) = (&shot.exposure[i], &shot.flow[i]);
        hold!(in_unit(exposure.light), "light of {i} is {}", exposure.light);
        hold!(in_unit(exposure.space), "space of {i} is {}", exposure.space);
        hold!(shot.allotment[i].is_finite() && shot.allotment[i] >= 0.0, "allotment {}", shot.allotment[i]);
        hold!(flow.income.is_finite() && flow.income >= 0.0, "income of {i} is {}", flow.income);
        hold!(flow.upkeep.is_finite() && flow.upkeep >= 0.0, "upkeep of {i} is {}", flow.upkeep);
        match &shot.state[i] {
            OrganState::Internode(stem, _) => {
                hold!(stem.length.is_finite() && stem.length > 0.0, "length of {i} is {}", stem.length);
                hold!(stem.radius.is_finite() && stem.radius > 0.0, "radius of {i} is {}", stem.radius);
                hold!(stem.height_in_branch >= stem.length * 0.999, "height of {i}");
                if shot.parent[i] != NO_PARENT {
                    let p = shot.parent[i] as usize;
                    let gap = shot.pose[p].tip(shot.length(p)).distance(pose.position);
                    hold!(gap < 1e-4, "stem {i} begins {gap} m off the one below");
                }
            }
            OrganState::Leaf(leaf) => hold!(in_unit(leaf.size), "size of leaf {i} is {}", leaf.size),
            OrganState::ApicalBud(bud, _, target) => {
                hold!(bud.height_since_node >= 0.0 && bud.height_in_branch.is_finite(), "bud {i}");
                hold!(unit_or_none(target.heading), "target of {i} is {}", target.heading);
            }
            OrganState::LateralBud(_, target) => {
                hold!(unit_or_none(target.heading), "target of {i} is {}", target.heading);
            }
        }
    }
    Ok(())
}

fn unit_or_none(heading: Vec3) -> bool {
    heading == Vec3::ZERO || (heading.length() - 1.0).abs() < 1e-3
}

fn energy(shot: &Snapshot) -> Result<(), String> {
    for (index, plant) in shot.plants.iter().enumerate() {
        let Some(plant) = plant else { continue };
        let ledger = &plant.ledger;
        hold!(ledger.imbalance() <= 1e-6, "plant {index} is off by {}: {ledger:?}", ledger.imbalance());
        hold!(plant.store.stored.is_finite() && plant.store.stored >= 0.0, "store {}", plant.store.stored);
        let held: f64 = (0..shot.len())
            .filter(|&i| shot.plant[i] as usize == index)
            .map(|i| f64::from(shot.allotment[i]))
            .sum();
        let held = held + plant.store.stored;
        hold!((ledger.closed - held).abs() <= 1e-6 * held.max(1.0), "closed {} holds {held}", ledger.closed);
    }
    Ok(())
}

/// Every stem is a pipe at least as wide as all it bears, where wood is free.
fn wood(shot: &Snapshot) -> Result<(), String> {
    let mut borne = vec![0.0_f64; shot.len()];
    for i in (0..shot.len()).rev() {
        let OrganState::Internode(stem, _) = &shot.state[i] else { continue };
        let Some(plant) = &shot.plants[shot.plant[i] as usize] else { continue };
        let pipe = f64::from(ops::powf(stem.radius, plant.species.pipe_exponent));
        let off = (pipe - f64::from(stem.pipe)).abs() / pipe;
        hold!(off < 1e-3, "pipe of {i} is {} at radius {}", stem.pipe, stem.radius);
        if plant.species.wood_cost == 0.0 {
            hold!(pipe >= 0.999 * borne[i], "stem {i} of pipe {pipe} bears {}", borne[i]);
        }
        if shot.parent[i] != NO_PARENT {
            borne[shot.parent[i] as usize] += pipe;
        }
    }
    Ok(())
}

/// What no step may undo: radii, births.
pub fn check_since(before: &Snapshot, after: &Snapshot) -> Result<(), String> {
    for i in 0..after.len() {
        let OrganState::Internode(stem, _) = &after.state[i] else { continue };
        let Ok(k) = before.birth.binary_search(&after.birth[i]) else {
            hold!(after.birth[i] >= before.next_birth, "stem {i} was never born");
            continue;
        };
        let OrganState::Internode(old, _) = &before.state[k] else {
            return Err(format!("organ {i} turned into a stem"));
        };
        hold!(stem.radius >= old.radius, "stem {i} shrank from {} to {}", old.radius, stem.radius);
        hold!(stem.length == old.length, "stem {i} changed length");
    }
    Ok(())
}

/// Entities are the living organs, no more, no less.
pub fn check_world(world: &mut World) -> Result<(), String> {
    let entities = world.query::<&Identity>().iter(world).count();
    let roster = world.resource::<Roster>();
    hold!(entities == roster.len(), "{entities} entities, {} organs", roster.len());
    for (&entity, &birth) in roster.entity.iter().zip(&roster.birth) {
        let found = world.get::<Identity>(entity).map(|id| id.birth);
        hold!(found == Some(birth), "organ {birth} is entity {found:?}");
    }
    Ok(())
}

/// No centre line of wood passes through a solid or underground.
pub fn check_solids(world: &mut World, shot: &Snapshot) -> Result<(), String> {
    let mut query = world.query::<(&Solid, &Transform)>();
    let solids = standing_solids(query.iter(world));
    for i in 0..shot.len() {
        let OrganState::Internode(stem, _) = &shot.state[i] else { continue };
        for k in 0..=32 {
            let point = shot.pose[i].tip(stem.length * k as f32 / 32.0);
            hold!(point.y > -1e-3, "stem {i} is underground at {point}");
            if let Some(solid) = solids.iter().find(|s| inside(s, point)) {
                return Err(format!("stem {i} is inside the solid at {} at {point}", solid.position));
            }
        }
    }
    Ok(())
}

/// Grows a scenario by a number of steps; after each no wood passes through a solid.
pub fn grow_past_solids(resolved: ResolvedScenario, seed: u64, steps: u32) {
    let name = resolved.scenario.name.clone();
    let mut garden = super::garden(resolved, seed);
    for step in 0..steps {
        garden.step().unwrap();
        let shot = garden.snapshot();
        check_solids(garden.world_mut(), &shot)
            .unwrap_or_else(|why| panic!("{name}, seed {seed}, step {step}: {why}"));
    }
}

/// Whether a point lies inside a solid.
pub fn inside(solid: &StandingSolid, point: Vec3) -> bool {
    let local = solid.rotation.inverse() * (point - solid.position);
    match solid.shape {
        SolidShape::Box { size } => local.abs().cmplt(0.5 * size).all(),
        SolidShape::Ball { radius } => local.length() < radius,
        SolidShape::Cylinder { radius, height } => {
            local.y.abs() < 0.5 * height && local.xz().length() < radius
        }
    }
}
