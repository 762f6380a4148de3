//! Where organs are in the world, derived from the turn of each relative to what it grows from.

use bevy::prelude::*;

use super::Pose;

/// What the pose of an organ follows from: the stem, or plant, that bears it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stem {
    /// Where it is.
    pub pose: Pose,
    /// Length, metres; 0 for plants, buds and leaves.
    pub length: f32,
    /// Radius, metres; 0 for plants, buds and leaves.
    pub radius: f32,
}

impl Stem {
    /// Pose of an organ at its tip, turned by `attachment`; on its bark if it is a leaf or a lateral bud, on its
    /// axis if it is a stem or an apical bud.
    pub fn bear(&self, attachment: Quat, sits_on_bark: bool) -> Pose {
        let rotation = (self.pose.rotation * attachment).normalize();
        let mut position = self.pose.tip(self.length);
        if sits_on_bark && self.radius > 0.0 {
            let stem = self.pose.heading();
            let heading = rotation * Vec3::Y;
            position += (heading - stem * heading.dot(stem)).normalize_or_zero() * self.radius;
        }
        Pose { position, rotation }
    }
}

/// Where a plant stands in the world, by its transform and those of the entities it is a child of; `of` gives both of
/// an entity.
pub fn standing<'a>(
    plant: Entity,
    of: impl Fn(Entity) -> Option<(Option<&'a Transform>, Option<&'a ChildOf>)>,
) -> Transform {
    let mut transform = Transform::IDENTITY;
    let mut at = Some(plant);
    while let Some((local, parent)) = at.and_then(&of) {
        transform = local.copied().unwrap_or_default().mul_transform(transform);
        at = parent.map(ChildOf::parent);
    }
    transform
}
