//! A picture of a world in one call.

use bevy::prelude::World;
use image::RgbImage;

use super::{Bounds, Camera, Palette, PictureSettings, render};
use crate::environment::plugin::whole_scene;
use crate::environment::trace::Tracer;
use crate::environment::workers::Workers;
use crate::plant::Snapshot;

/// Height of the camera's stand above the plants' foot, degrees.
const ELEVATION_DEG: f32 = 5.0;

/// A picture of all that stands in a world, seen from `azimuth_deg` (from +z towards +x) at eye level.
///
/// The camera frames the plants and what is near them; see [`Camera::framing`] and [`render`] for more say.
pub fn photograph(world: &mut World, settings: PictureSettings, azimuth_deg: f32) -> RgbImage {
    let scene = whole_scene(world);
    let palette = Palette::of_snapshot(&Snapshot::take(world));
    let camera = Camera::framing(&Bounds::of(&scene), azimuth_deg, ELEVATION_DEG, settings.aspect());
    world.init_resource::<Workers>();
    render(&Tracer::build(&scene), &camera, &palette, settings, world.resource::<Workers>())
}
