//! Gathering: the plants of a snapshot as capsules and leaves of a scene.

use super::{Capsule, Scene};
use crate::plant::{Internode, OrganState, PlantRecord, Pose, Snapshot};
use crate::shape::foliage::Foliage;

/// The wood of all plants as capsules, one an internode, in birth order: for a scene, and for any physics crate.
///
/// Wood of plants that are gone is left out. Neighbours on a stem share the middle of a cap; capsules thicken, and new
/// ones come, with every growth step, and `organ` says which of them is the same as before.
///
/// ```
/// # use bevy::prelude::*;
/// # use burgeon::prelude::*;
/// # let mut app = App::new();
/// # app.add_plugins((MinimalPlugins, BurgeonPlugins));
/// # app.world_mut().spawn(Plant::new(Species::default(), 1));
/// # grow(app.world_mut(), 2);
/// let snapshot = Snapshot::take(app.world());
/// for wood in burgeon::environment::capsules(&snapshot) {
///     let (middle, axis) = ((wood.from + wood.to) * 0.5, wood.to - wood.from);
///     // collider(middle, Quat::from_rotation_arc(Vec3::Y, axis.normalize_or(Vec3::Y)), wood.radius, axis.length())
///     # assert!(middle.is_finite() && axis.length() > 0.0 && wood.radius > 0.0);
/// }
/// ```
pub fn capsules(snapshot: &Snapshot) -> impl Iterator<Item = Capsule> + '_ {
    snapshot.state.iter().enumerate().filter_map(|(i, state)| match state {
        OrganState::Internode(internode, _) => {
            let (organ, plant) = (snapshot.birth[i], snapshot.plant[i]);
            snapshot.plants.get(plant as usize)?.as_ref()?;
            Some(capsule(&snapshot.pose[i], internode, organ, plant))
        }
        _ => None,
    })
}

/// A stem segment as a capsule.
pub fn capsule(pose: &Pose, internode: &Internode, organ: u32, plant: u32) -> Capsule {
    Capsule { from: pose.position, to: pose.tip(internode.length), radius: internode.radius, organ, plant }
}

/// Adds the wood and leaves of all plants, in birth order: a capsule an internode, a patch a blade.
///
/// Organs of plants that are gone, and leaves not yet begun, are left out.
pub fn add_plants(scene: &mut Scene, snapshot: &Snapshot) {
    scene.capsules.extend(capsules(snapshot));
    let of = |plant: &Option<PlantRecord>| plant.as_ref().map(|plant| Foliage::of(&plant.species));
    let foliage: Vec<Option<Foliage>> = snapshot.plants.iter().map(of).collect();
    for (i, state) in snapshot.state.iter().enumerate() {
        let (organ, plant) = (snapshot.birth[i], snapshot.plant[i]);
        let Some(Some(foliage)) = foliage.get(plant as usize) else { continue };
        if let OrganState::Leaf(leaf) = state
            && leaf.size > 0.0
        {
            let blades = foliage.blades(&snapshot.pose[i], leaf.size, snapshot.lineage[i]);
            scene.leaves.extend(blades.map(|blade| blade.patch(foliage.outline, organ, plant)));
        }
    }
}
