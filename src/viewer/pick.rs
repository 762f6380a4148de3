//! What is under the pointer: rays against organs and things.

use bevy::math::Ray3d;
use bevy::prelude::*;

use crate::environment::SolidShape;
use crate::plant::{OrganState, Snapshot};

/// How much wider than it is an organ is to the pointer, as a share of its distance: thin twigs can be hit too.
const REACH: f32 = 0.006;

/// The organ a ray meets first, as its birth number, with its distance. Buds win over the stem they sit on.
pub fn pick_organ(shot: &Snapshot, ray: Ray3d) -> Option<(u32, f32)> {
    let mut best: Option<(u32, f32)> = None;
    for i in 0..shot.len() {
        let pose = &shot.pose[i];
        let (end, radius, ahead) = match &shot.state[i] {
            OrganState::Internode(wood, _) => (pose.tip(wood.length), wood.radius, 0.0),
            OrganState::Leaf(leaf) => {
                let record = shot.plants.get(shot.plant[i] as usize).and_then(|plant| plant.as_ref());
                let (length, width) =
                    record.map_or((0.05, 0.03), |p| (p.species.leaf_length_m, p.species.leaf_width_m));
                let size = leaf.size.max(0.0).sqrt();
                (pose.tip(length * size), 0.4 * width * size, 0.0)
            }
            OrganState::ApicalBud(..) | OrganState::LateralBud(..) => (pose.position, 0.008, 0.03),
        };
        if let Some(distance) = hit_capsule(ray, pose.position, end, radius) {
            let distance = distance - ahead;
            if best.is_none_or(|(_, nearest)| distance < nearest) {
                best = Some((shot.birth[i], distance));
            }
        }
    }
    best
}

/// Distance at which a ray passes a capsule, widened by [`REACH`]; `None` if it does not.
fn hit_capsule(ray: Ray3d, start: Vec3, end: Vec3, radius: f32) -> Option<f32> {
    let direction = Vec3::from(ray.direction);
    let axis = end - start;
    let to_start = ray.origin - start;
    // The nearest points of a line and a segment.
    let (b, c) = (direction.dot(axis), axis.length_squared());
    let (d, e) = (direction.dot(to_start), axis.dot(to_start));
    let denominator = c - b * b;
    let along = if c < 1e-12 {
        0.0
    } else if denominator.abs() < 1e-9 * c {
        (e / c).clamp(0.0, 1.0)
    } else {
        ((e - b * d) / denominator).clamp(0.0, 1.0)
    };
    let point = start + axis * along;
    let distance = (point - ray.origin).dot(direction);
    let apart = (ray.origin + direction * distance).distance(point);
    (distance > 0.0 && apart <= radius + REACH * distance).then_some(distance)
}

/// Distance at which a ray meets a solid in its place; `None` if it does not.
pub fn pick_solid(shape: SolidShape, place: &Transform, ray: Ray3d) -> Option<f32> {
    let turn = place.rotation.inverse();
    let origin = turn * (ray.origin - place.translation);
    let direction = turn * Vec3::from(ray.direction);
    let shape = shape.scaled(place.scale);
    if let SolidShape::Ball { radius } = shape {
        return hit_ball(origin, direction, radius);
    }
    // Of a pillar the box around it: near enough for a pointer.
    let half = shape.half_size();
    let inverse = direction.recip();
    let (a, b) = ((-half - origin) * inverse, (half - origin) * inverse);
    let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
    (near <= far && far > 0.0).then_some(near.max(0.0))
}

/// Distance at which a ray meets a ball about the origin.
pub(super) fn hit_ball(origin: Vec3, direction: Vec3, radius: f32) -> Option<f32> {
    let b = origin.dot(direction);
    let c = origin.length_squared() - radius * radius;
    let root = (b * b - c).sqrt();
    let near = -b - root;
    // Of a negative square the root is no number, and no comparison holds.
    (near > 0.0).then_some(near)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ray(from: Vec3, to: Vec3) -> Ray3d {
        Ray3d { origin: from, direction: Dir3::new(to - from).unwrap() }
    }

    #[test]
    fn a_ray_meets_a_capsule_where_it_passes() {
        let hit = |x: f32| {
            hit_capsule(ray(Vec3::new(x, 0.5, 5.0), Vec3::new(x, 0.5, 0.0)), Vec3::ZERO, Vec3::Y, 0.1)
        };
        assert!((hit(0.0).unwrap() - 5.0).abs() < 1e-4);
        assert!(hit(0.1).is_some() && hit(0.2).is_none());
        let behind = hit_capsule(ray(Vec3::Z, Vec3::Z * 2.0), Vec3::ZERO, Vec3::Y, 0.1);
        assert_eq!(behind, None);
    }

    #[test]
    fn a_turned_wall_is_met_where_it_stands() {
        let wall = SolidShape::Box { size: Vec3::new(4.0, 2.0, 0.2) };
        let place = Transform::from_xyz(0.0, 1.0, 0.0)
            .with_rotation(Quat::from_rotation_y(0.5 * std::f32::consts::PI));
        let hit = |z: f32| pick_solid(wall, &place, ray(Vec3::new(5.0, 1.0, z), Vec3::new(0.0, 1.0, z)));
        assert!((hit(1.9).unwrap() - 4.9).abs() < 1e-4);
        assert_eq!(hit(2.1), None);
    }
}
