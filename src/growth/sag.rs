//! Sag: wood bends under what it bears, by load over the fourth power of its radius, and sets as it thickens.
//!
//! Each step a stem bends by as much as its load asks beyond what has set before, so that a limb that was once
//! weighed down keeps its bow when it has grown stout. What would go underground or into a solid does not bend, and an
//! axis that comes to lie on another rests there.

mod contact;

use bevy::prelude::*;

use super::Mechanisms;
use crate::environment::obstacles::touches;
use crate::environment::{Ground, Solid, StandingSolid};
use crate::plant::{Attachment, BranchOrder, Internode, Leaf, NO_PARENT, OrganKind, Plant, Pose, Roster};

/// Fresh wood, kg/m3 (oak and beech about 1000, pine 800).
pub const WOOD_DENSITY: f32 = 900.0;
/// Fresh leaves, kg/m2 of one side (about 90 g/m2 dry, twice that in water).
pub const LEAF_DENSITY: f32 = 0.25;
/// Widest turn of one stem in one step, radians.
pub const MOST_A_STEP: f32 = 0.12;
const GRAVITY: f32 = 9.81;

/// Mass, and mass times place: of an organ, or of all it bears.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Load {
    /// Kilograms.
    pub mass: f32,
    /// Kilogram metres.
    pub moment: Vec3,
}

impl Load {
    /// A mass at a place.
    pub fn at(mass: f32, place: Vec3) -> Self {
        Self { mass, moment: mass * place }
    }
}

/// Sums every organ's load with that of all it bears, tips to base in one pass.
pub fn loads(parents: &[u32], own: &[Load]) -> Vec<Load> {
    let mut all = own.to_vec();
    for i in (0..parents.len()).rev() {
        if parents[i] != NO_PARENT {
            let here = all[i];
            let below = &mut all[parents[i] as usize];
            below.mass += here.mass;
            below.moment += here.moment;
        }
    }
    all
}

/// By what rotation (axis times angle, radians) a load bends the stem that bears it, were it straight without it:
/// torque x length / (E I), with I = pi r^4 / 4.
pub fn deflection(load: Load, stem: &Pose, wood: &Internode, stiffness_gpa: f32) -> Vec3 {
    let torque = (load.moment - load.mass * stem.position).cross(Vec3::NEG_Y * GRAVITY);
    let heading = stem.heading();
    let bending = torque - heading * torque.dot(heading);
    let second_moment = core::f32::consts::FRAC_PI_4 * wood.radius.powi(4);
    bending * (wood.length / (stiffness_gpa * 1.0e9 * second_moment).max(f32::MIN_POSITIVE))
}

/// Rotations of all stems below an organ, summed: what they do to a place, to first order.
#[derive(Debug, Clone, Copy, Default)]
struct Carried {
    turn: Vec3,
    moment: Vec3,
}

impl Carried {
    fn and(self, turn: Vec3, base: Vec3) -> Self {
        Self { turn: self.turn + turn, moment: self.moment + turn.cross(base) }
    }

    fn moves(self, place: Vec3) -> Vec3 {
        self.turn.cross(place) - self.moment
    }
}

/// A stem about to bend.
#[derive(Debug, Clone, Copy, Default)]
struct Bend {
    /// Rotation, axis times angle.
    turn: Vec3,
    pose: Pose,
    /// Its turn relative to what it grows from.
    attachment: Quat,
    length: f32,
    radius: f32,
    order: u32,
    /// Radius it had when new, metres, if its species avoids wood: no nearer to others does it bend.
    keeps_off: Option<f32>,
}

impl Bend {
    fn from(&self) -> Vec3 {
        self.pose.position
    }

    fn to(&self) -> Vec3 {
        self.pose.tip(self.length)
    }

    /// The turn of what bears it.
    fn below(&self) -> Quat {
        self.pose.rotation * self.attachment.inverse()
    }

    /// Its turn, once bent, relative to what it grows from.
    fn bent(&self) -> Quat {
        (self.below().inverse() * Quat::from_scaled_axis(self.turn) * self.pose.rotation).normalize()
    }
}

/// Holds every stem still whose bending would carry what it bears underground or into a solid.
fn hold_back(parents: &[u32], bends: &mut [Option<Bend>], solids: &[StandingSolid], ground: Option<f32>) {
    // Holding some back changes where others go; after a few rounds the rest is let be.
    const ROUNDS: u32 = 6;
    for round in 0..ROUNDS {
        let mut carried = vec![Carried::default(); bends.len()];
        let mut wrong = Vec::new();
        for (i, bend) in bends.iter().enumerate() {
            let below = match parents[i] {
                NO_PARENT => Carried::default(),
                parent => carried[parent as usize],
            };
            let Some(bend) = bend else {
                carried[i] = below;
                continue;
            };
            let here = below.and(bend.turn, bend.from());
            carried[i] = here;
            let (by_base, by_end) = (below.moves(bend.from()), here.moves(bend.to()));
            if by_base == Vec3::ZERO && by_end == Vec3::ZERO {
                continue;
            }
            let (from, to) = (bend.from() + by_base, bend.to() + by_end);
            // First-order places err by the square of the turn.
            let keep = bend.radius + 0.01 + 0.5 * here.turn.length_squared() * bend.radius.max(0.1);
            let sinks = ground.is_some_and(|ground| to.y < ground + keep && to.y < bend.to().y);
            if sinks || solids.iter().any(|solid| touches(solid, from, to, keep)) {
                wrong.push(i);
            }
        }
        if wrong.is_empty() {
            return;
        }
        for i in wrong {
            let mut at = i as u32;
            while at != NO_PARENT {
                if let Some(bend) = &mut bends[at as usize] {
                    bend.turn = Vec3::ZERO;
                }
                at = parents[at as usize];
            }
        }
        if round + 1 == ROUNDS {
            bends.iter_mut().flatten().for_each(|bend| bend.turn = Vec3::ZERO);
        }
    }
}

/// Bends stems under their load, where their species' wood gives way.
pub fn bend_stems(
    roster: Res<Roster>,
    ground: Res<Ground>,
    mechanisms: Res<Mechanisms>,
    plants: Query<&Plant>,
    solids: Query<(&Solid, &Transform)>,
    leaves: Query<(&Pose, &Leaf)>,
    mut stems: Query<(&Pose, &BranchOrder, &mut Internode, &mut Attachment)>,
) {
    let species: Vec<_> =
        roster.plants.iter().map(|p| p.and_then(|p| plants.get(p).ok()).map(|p| p.species.clone())).collect();
    let gives: Vec<bool> = species
        .iter()
        .map(|s| s.as_ref().is_some_and(|s| s.stiffness_gpa.0.iter().any(|e| *e > 0.0)))
        .collect();
    if !gives.contains(&true) {
        return;
    }
    let mut own = vec![Load::default(); roster.len()];
    for i in 0..roster.len() {
        let Some(species) =
            species[roster.plant[i] as usize].as_ref().filter(|_| gives[roster.plant[i] as usize])
        else {
            continue;
        };
        let entity = roster.entity[i];
        if roster.kind[i] == OrganKind::Leaf
            && let Ok((pose, leaf)) = leaves.get(entity)
        {
            own[i] = Load::at(LEAF_DENSITY * species.leaf_area() * leaf.size, pose.position);
        } else if let Ok((pose, _, wood, _)) = stems.get(entity) {
            let volume = core::f32::consts::PI * wood.radius * wood.radius * wood.length;
            own[i] = Load::at(WOOD_DENSITY * volume, pose.tip(0.5 * wood.length));
        }
    }
    let loads = loads(&roster.parent, &own);
    let mut bends: Vec<Option<Bend>> = vec![None; roster.len()];
    for (i, bend) in bends.iter_mut().enumerate() {
        let plant = roster.plant[i] as usize;
        let (true, Some(species)) = (gives[plant], &species[plant]) else { continue };
        let Ok((pose, order, wood, attachment)) = stems.get(roster.entity[i]) else { continue };
        let stiffness = species.stiffness_gpa.get(order.0);
        let turn = if stiffness > 0.0 {
            let whole = deflection(loads[i], pose, wood, stiffness);
            let angle = whole.length();
            whole.normalize_or_zero() * (angle - wood.sag).clamp(0.0, MOST_A_STEP)
        } else {
            Vec3::ZERO
        };
        *bend = Some(Bend {
            turn,
            pose: *pose,
            attachment: attachment.0,
            length: wood.length,
            radius: wood.radius,
            order: order.0,
            keeps_off: (mechanisms.space && species.avoids_wood).then_some(species.twig_radius_m),
        });
    }
    contact::rest(&roster.parent, &mut bends);
    let standing = crate::environment::standing_solids(solids.iter());
    hold_back(&roster.parent, &mut bends, &standing, ground.0);
    for (i, bend) in bends.into_iter().enumerate() {
        let Some(bend) = bend.filter(|bend| bend.turn != Vec3::ZERO) else { continue };
        let Ok((_, _, mut wood, mut attachment)) = stems.get_mut(roster.entity[i]) else { continue };
        attachment.0 = bend.bent();
        wood.sag += bend.turn.length();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn beam(radius: f32) -> (Pose, Internode) {
        let pose =
            Pose { position: Vec3::ZERO, rotation: Quat::from_rotation_z(-core::f32::consts::FRAC_PI_2) };
        (pose, Internode { length: 0.1, radius, ..default() })
    }

    #[test]
    fn a_level_stem_bends_by_load_times_lever_over_e_i() {
        let (pose, wood) = beam(0.01);
        // Two kilograms half a metre out, wood of 1 GPa: 9.81 N m on E I = 7.854 N m2, a tenth of a metre long.
        let turn = deflection(Load::at(2.0, Vec3::X * 0.5), &pose, &wood, 1.0);
        assert!((turn.length() - 9.81 * 0.1 / 7.854).abs() < 1e-4, "{turn}");
        let lowered = Quat::from_scaled_axis(turn) * Vec3::X;
        assert!(lowered.y < 0.0, "downwards");
        let (pose, stout) = beam(0.02);
        let less = deflection(Load::at(2.0, Vec3::X * 0.5), &pose, &stout, 1.0);
        assert!((turn.length() / less.length() - 16.0).abs() < 1e-3, "the fourth power of the radius");
    }

    #[test]
    fn what_hangs_or_stands_straight_does_not_bend() {
        let wood = beam(0.01).1;
        for (rotation, load) in
            [(Quat::IDENTITY, Vec3::Y), (Quat::from_rotation_x(core::f32::consts::PI), Vec3::NEG_Y)]
        {
            let pose = Pose { position: Vec3::ZERO, rotation };
            assert_eq!(deflection(Load::at(5.0, load), &pose, &wood, 1.0), Vec3::ZERO);
        }
    }

    #[test]
    fn loads_sum_from_the_tips_down() {
        let own = [1.0, 2.0, 4.0, 8.0].map(|mass| Load::at(mass, Vec3::X * mass));
        let all = loads(&[NO_PARENT, 0, 1, 0], &own);
        assert_eq!(all.iter().map(|l| l.mass).collect::<Vec<_>>(), [15.0, 6.0, 4.0, 8.0]);
        assert_eq!(all[1].moment, Vec3::X * 20.0);
    }

    #[test]
    fn nothing_bends_underground() {
        let level = Quat::from_rotation_z(-core::f32::consts::FRAC_PI_2);
        let bend = |turn: f32, from: f32| Bend {
            turn: Vec3::NEG_Z * turn,
            pose: Pose { position: Vec3::new(from, 0.1, 0.0), rotation: level },
            length: 1.0,
            radius: 0.01,
            ..default()
        };
        let mut bends = [Some(bend(0.05, 0.0)), Some(bend(0.05, 1.0)), Some(bend(0.0, 0.0))];
        hold_back(&[NO_PARENT, 0, NO_PARENT], &mut bends, &[], Some(0.0));
        assert!(bends.iter().flatten().all(|b| b.turn == Vec3::ZERO), "0.05 + 0.1 down from 0.1 is too low");
        let mut bends = [Some(bend(0.05, 0.0)), Some(bend(0.05, 1.0))];
        hold_back(&[NO_PARENT, 0], &mut bends, &[], None);
        assert!(bends.iter().flatten().all(|b| b.turn != Vec3::ZERO), "without a ground they do");
    }
}
