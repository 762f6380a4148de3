//! Gathering: the plants of a snapshot as capsules and leaves of a scene.

use super::{Capsule, Scene};
use crate::plant::{OrganState, Snapshot};
use crate::shape::foliage::Foliage;

/// Adds the wood and leaves of all plants, in birth order: a capsule an internode, a patch a blade.
///
/// Organs of plants that are gone, and leaves not yet begun, are left out.
pub fn add_plants(scene: &mut Scene, snapshot: &Snapshot) {
    let foliage: Vec<Option<Foliage>> =
        snapshot.plants.iter().map(|plant| plant.as_ref().map(|p| Foliage::of(&p.species))).collect();
    for (i, state) in snapshot.state.iter().enumerate() {
        let (organ, plant) = (snapshot.birth[i], snapshot.plant[i]);
        let Some(Some(foliage)) = foliage.get(plant as usize) else { continue };
        let pose = &snapshot.pose[i];
        match state {
            OrganState::Internode(internode, _) => scene.capsules.push(Capsule {
                from: pose.position,
                to: pose.tip(internode.length),
                radius: internode.radius,
                organ,
                plant,
            }),
            OrganState::Leaf(leaf) if leaf.size > 0.0 => {
                let blades = foliage.blades(pose, leaf.size, snapshot.lineage[i]);
                scene.leaves.extend(blades.map(|blade| blade.patch(foliage.outline, organ, plant)));
            }
            _ => {}
        }
    }
}
