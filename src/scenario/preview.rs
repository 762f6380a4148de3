//! What an edit would take, before it is made. Reads a snapshot and changes nothing.

use bevy::prelude::*;

use crate::environment::StandingSolid;
use crate::environment::obstacles::touches;
use crate::plant::{Internode, NO_PARENT, OrganState, Pose, Snapshot};

/// Birth numbers of the organs a solid set there would shed, with all they bear; their count is the length.
pub fn crushed_by(shot: &Snapshot, solid: &StandingSolid) -> Vec<u32> {
    let solid = std::slice::from_ref(solid);
    fallen(shot, |i| {
        let wood = match &shot.state[i] {
            OrganState::Internode(wood, _) => Some(wood),
            _ => None,
        };
        is_inside(solid, &shot.pose[i], wood)
    })
}

/// Birth numbers of the organs a cut would shed: the organ itself and all it bears. Empty if it does not live.
pub fn borne_by(shot: &Snapshot, birth: u32) -> Vec<u32> {
    fallen(shot, |i| shot.birth[i] == birth)
}

/// Whether a seedling of a height, metres, sown at a point would stand within a hand's breadth of a solid or in it.
pub fn is_covered(solid: &StandingSolid, at: Vec3, height: f32) -> bool {
    touches(solid, at, at + Vec3::Y * height, 0.1)
}

/// The organs for which `cut` is true, and all they bear.
fn fallen(shot: &Snapshot, cut: impl Fn(usize) -> bool) -> Vec<u32> {
    let mut goes = vec![false; shot.len()];
    for i in 0..shot.len() {
        // Parents come first.
        let parent = shot.parent[i];
        goes[i] = (parent != NO_PARENT && goes[parent as usize]) || cut(i);
    }
    (0..shot.len()).filter(|&i| goes[i]).map(|i| shot.birth[i]).collect()
}

/// How much of a stem's radius a solid may press into: bark gives way, the core does not.
const CORE: f32 = 0.5;

/// Whether an organ, with the core of its wood if it is wood, meets one of the solids.
pub(super) fn is_inside(solids: &[StandingSolid], pose: &Pose, wood: Option<&Internode>) -> bool {
    let (tip, radius) = wood.map_or((pose.position, 0.0), |wood| (pose.tip(wood.length), CORE * wood.radius));
    let reach = 0.5 * tip.distance(pose.position) + radius;
    let middle = 0.5 * (tip + pose.position);
    solids.iter().any(|solid| {
        // Most are far from it: a ball about each tells, with room for rounding.
        let apart = solid.position.distance(middle) - solid.shape.bound() - reach;
        let far = apart > 1e-3 * (10.0 + middle.length());
        !far && touches(solid, pose.position, tip, radius)
    })
}
