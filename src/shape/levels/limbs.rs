//! Wood with fewer triangles: one tolerance for what may be left out.

use bevy::math::ops;
use bevy::prelude::*;

use crate::plant::{NO_PARENT, Snapshot};
use crate::shape::Surface;
use crate::shape::tubes::{Axes, Ring, lay_rings, sides, skin, tube_triangles};

/// Finest tolerance tried, metres, and how many: each is a quarter of an octave coarser than the last.
const FINEST: f32 = 1e-4;
const TOLERANCES: u32 = 72;
/// A limb goes when its radius is below this share of the tolerance: it is a line then.
const THIN: f32 = 0.125;

/// An axis and what it grows from.
pub(super) struct Limb {
    rings: Vec<Ring>,
    /// Index of the limb it grows from among those of its plant.
    below: Option<usize>,
}

/// The limbs of each plant, by its index in [`Snapshot::plants`]; parents first.
pub(super) fn of(snapshot: &Snapshot) -> Vec<Vec<Limb>> {
    let axes = Axes::of(snapshot);
    let mut plants: Vec<Vec<Limb>> = snapshot.plants.iter().map(|_| Vec::new()).collect();
    // Of each organ, the limb it is on.
    let mut limb_of = vec![usize::MAX; snapshot.len()];
    for &start in &axes.starts {
        let plant = snapshot.plant[start as usize] as usize;
        let Some(limbs) = plants.get_mut(plant).filter(|_| snapshot.plants[plant].is_some()) else {
            continue;
        };
        let mut rings = Vec::new();
        lay_rings(snapshot, &axes, start, &mut rings);
        let parent = snapshot.parent[start as usize];
        let below = Some(parent).filter(|&p| p != NO_PARENT).map(|p| limb_of[p as usize]);
        for i in axes.walk(start) {
            limb_of[i as usize] = limbs.len();
        }
        limbs.push(Limb { rings, below: below.filter(|&limb| limb < limbs.len()) });
    }
    plants
}

/// The limbs of a plant with at most so many triangles; `leaves` is the box of its leaves.
pub(super) fn within(limbs: &[Limb], leaves: Option<(Vec3, Vec3)>, triangles: usize) -> Surface {
    let held = outermost(limbs, leaves);
    let none = vec![false; limbs.len()];
    // Outermost limbs go only if there is no other way.
    for held in [&held, &none] {
        let fits = |k: u32| {
            let tolerance = FINEST * ops::powf(2.0, 0.25 * k as f32);
            let kept = keep(limbs, held, tolerance);
            let count: usize = kept.iter().map(|(rings, sides)| tube_triangles(rings.len(), *sides)).sum();
            (count <= triangles).then_some(kept)
        };
        let (mut coarse, mut fine) = (TOLERANCES, 0);
        let Some(mut best) = fits(coarse) else { continue };
        while coarse - fine > 1 {
            let middle = (coarse + fine) / 2;
            match fits(middle) {
                Some(kept) => (coarse, best) = (middle, kept),
                None => fine = middle,
            }
        }
        let mut surface = Surface::default();
        for (rings, sides) in best {
            skin(&mut surface, &rings, sides);
        }
        return surface;
    }
    Surface::default()
}

/// Limbs that reach farthest up and to the four sides, as far as leaves do not, with all that bears them.
fn outermost(limbs: &[Limb], leaves: Option<(Vec3, Vec3)>) -> Vec<bool> {
    let mut held = vec![false; limbs.len()];
    for way in [Vec3::Y, Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
        let reach = |limb: &Limb| {
            limb.rings.iter().map(|ring| ring.center.dot(way)).fold(f32::NEG_INFINITY, f32::max)
        };
        let Some(farthest) = (0..limbs.len()).max_by(|&a, &b| reach(&limbs[a]).total_cmp(&reach(&limbs[b])))
        else {
            continue;
        };
        let behind =
            leaves.is_some_and(|(low, high)| low.dot(way).max(high.dot(way)) >= reach(&limbs[farthest]));
        let chain = core::iter::successors(Some(farthest), |&limb| limbs[limb].below);
        chain.filter(|_| !behind).for_each(|limb| held[limb] = true);
    }
    held
}

/// Rings and sides of the limbs that stay at a tolerance, metres.
fn keep(limbs: &[Limb], held: &[bool], tolerance: f32) -> Vec<(Vec<Ring>, u32)> {
    let mut stays = vec![false; limbs.len()];
    let mut kept = Vec::new();
    for (i, limb) in limbs.iter().enumerate() {
        let (Some(base), Some(tip)) = (limb.rings.first(), limb.rings.last()) else { continue };
        let plain = tip.along >= tolerance && base.radius >= THIN * tolerance;
        stays[i] = held[i] || limb.below.is_none() || (plain && limb.below.is_some_and(|below| stays[below]));
        if stays[i] {
            kept.push((thin_out(&limb.rings, tolerance), round(base.radius, tolerance)));
        }
    }
    kept
}

/// Sides of a tube whose flats lie within half the tolerance of its round.
fn round(radius: f32, tolerance: f32) -> u32 {
    let most = sides(radius);
    (3..most)
        .find(|&n| radius * (1.0 - ops::cos(core::f32::consts::PI / n as f32)) <= 0.5 * tolerance)
        .unwrap_or(most)
}

/// Rings left of a tube if its middle line and its radius may be off by a tolerance (Douglas and Peucker 1973).
fn thin_out(rings: &[Ring], tolerance: f32) -> Vec<Ring> {
    let last = rings.len() - 1;
    let mut stays = vec![false; rings.len()];
    (stays[0], stays[last]) = (true, true);
    let mut open = vec![(0, last)];
    while let Some((a, b)) = open.pop() {
        let (from, to) = (&rings[a], &rings[b]);
        let way = to.center - from.center;
        let off = |ring: &Ring| {
            let t = ((ring.center - from.center).dot(way) / way.length_squared().max(1e-12)).clamp(0.0, 1.0);
            let line = ring.center.distance(from.center + way * t);
            line.max((ring.radius - (from.radius + (to.radius - from.radius) * t)).abs())
        };
        let worst = (a + 1..b).map(|k| (k, off(&rings[k]))).max_by(|x, y| x.1.total_cmp(&y.1));
        if let Some((k, off)) = worst
            && off > tolerance
        {
            stays[k] = true;
            open.extend([(a, k), (k, b)]);
        }
    }
    rings.iter().zip(stays).filter_map(|(ring, stays)| stays.then_some(*ring)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Place;

    fn ring(center: Vec3, radius: f32, along: f32) -> Ring {
        Ring { center, direction: Vec3::Y, radius, along, place: Place::default() }
    }

    #[test]
    fn straight_stretches_need_no_rings() {
        let straight: Vec<Ring> = (0..9).map(|k| ring(Vec3::Y * k as f32, 0.1, k as f32)).collect();
        assert_eq!(thin_out(&straight, 0.01).len(), 2);
        let mut bent = straight.clone();
        bent[4].center.x = 0.5;
        assert_eq!(thin_out(&bent, 0.01).len(), 5);
        assert_eq!(thin_out(&bent, 0.6).len(), 2);
        let mut thick = straight;
        thick[4].radius = 0.3;
        assert_eq!(thin_out(&thick, 0.1).len(), 5);
    }

    #[test]
    fn thick_wood_keeps_its_round_longest() {
        assert_eq!((round(0.2, 1e-4), round(0.2, 0.1), round(0.2, 1.0)), (12, 5, 3));
    }
}
