//! A beach and the sea before it: a strip of sand on the meadow, and water on the strip.

use bevy::light::NotShadowCaster;
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;

use super::ground::{Blades, grid};
use crate::environment::{Ground, Shore};
use crate::render::noise::tile;
use crate::shape::noise::{periodic, smooth, srgb};
use crate::shape::shore;

/// How far the sea reaches out and to the sides, metres.
const REACH: f32 = 600.0;
/// Cells along the shore; they are smaller near the middle.
const CELLS: usize = 160;
/// Heights over the ground, metres: what lies on what.
const SAND_LIES: f32 = 0.004;
const WATER_LIES: f32 = 0.012;
/// Side of a tile of sand and of waves, metres.
const SAND_TILE: f32 = 1.7;
const WAVE_TILE: f32 = 4.3;
const SIZE: usize = 256;

/// Marks beach and sea on screen.
#[derive(Component)]
pub(super) struct DrawnShore;

/// Lays beach and sea where a world has them, anew when they change. Grass makes way.
pub(super) fn show_shore(
    mut commands: Commands,
    shore: Option<Res<Shore>>,
    ground: Res<Ground>,
    drawn: Query<Entity, With<DrawnShore>>,
    mut blades: Query<&mut Visibility, With<Blades>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut images: ResMut<Assets<Image>>,
    mut last: Local<Option<(Shore, f32)>>,
) {
    let wanted = shore.as_deref().copied().zip(ground.0);
    let grass = if wanted.is_some() { Visibility::Hidden } else { Visibility::Inherited };
    for mut seen in &mut blades {
        seen.set_if_neq(grass);
    }
    if *last == wanted {
        return;
    }
    *last = wanted;
    drawn.iter().for_each(|entity| commands.entity(entity).despawn());
    let Some((shore, height)) = wanted else { return };
    let sand = materials.add(StandardMaterial {
        base_color_texture: Some(images.add(sand_image())),
        perceptual_roughness: 1.0,
        reflectance: 0.1,
        alpha_mode: AlphaMode::Blend,
        ..default()
    });
    let water = materials.add(StandardMaterial {
        normal_map_texture: Some(images.add(wave_image())),
        perceptual_roughness: 0.12,
        reflectance: 0.5,
        alpha_mode: AlphaMode::Blend,
        // Over the sand, whichever is nearer to the camera.
        depth_bias: 10.0,
        ..default()
    });
    let turn = Quat::from_rotation_y(shore.azimuth_deg.to_radians());
    let at = Transform::from_translation(shore.outward() * shore.distance_m + Vec3::Y * height);
    commands.spawn((
        DrawnShore,
        Name::new("shore"),
        at.with_rotation(turn),
        Visibility::default(),
        children![
            (
                Mesh3d(meshes.add(strip(&SAND_ROWS, SAND_TILE, on_land))),
                MeshMaterial3d(sand),
                Transform::from_xyz(0.0, SAND_LIES, 0.0),
                NotShadowCaster,
            ),
            (
                Mesh3d(meshes.add(strip(&WATER_ROWS, WAVE_TILE, at_sea))),
                MeshMaterial3d(water),
                Transform::from_xyz(0.0, WATER_LIES, 0.0),
                NotShadowCaster,
            ),
        ],
    ));
}

/// How far out the rows of each mesh lie, metres.
const SAND_ROWS: [f32; 24] = [
    -52.0, -46.0, -43.0, -40.5, -38.0, -36.0, -34.0, -32.0, -30.0, -27.0, -22.0, -15.0, -9.0, -5.0, -3.0,
    -1.8, -1.2, -0.8, -0.4, 0.0, 0.6, 2.0, 5.0, 12.0,
];
const WATER_ROWS: [f32; 24] = [
    -1.8, -1.4, -1.1, -0.9, -0.7, -0.5, -0.3, -0.1, 0.1, 0.3, 0.5, 0.7, 0.9, 1.2, 1.6, 2.0, 2.5, 3.2, 4.5,
    7.0, 14.0, 40.0, 160.0, REACH,
];

/// The waterline is not straight: how much farther out a place along it counts.
fn wiggle(along: f32, out: f32) -> f32 {
    let noise =
        |size: f32, seed: u32| periodic(along / (64.0 * size), out / (64.0 * size), [64, 64], seed) - 0.5;
    1.6 * noise(6.0, 91) + 0.6 * noise(1.4, 92)
}

fn on_land(along: f32, out: f32) -> Vec4 {
    let here = out + wiggle(along, out);
    let ragged = here + 4.0 * (periodic(along / 160.0, out / 160.0, [64, 64], 93) - 0.5);
    // Its image is sand as it is dry.
    (shore::sand(here) / shore::SAND).extend(shore::sandy(ragged))
}

fn at_sea(along: f32, out: f32) -> Vec4 {
    let here = out + wiggle(along, out);
    let foam = shore::foam(here) * smooth(0.2, 0.6, periodic(along / 64.0, out / 64.0, [90, 90], 94));
    let color = shore::water(here).lerp(shore::FOAM, foam);
    color.extend(shore::depth(here).max(0.9 * foam))
}

/// A grid along the shore, of a colour by place.
fn strip(rows: &[f32], tile: f32, color: impl Fn(f32, f32) -> Vec4) -> Mesh {
    let along = |k: usize| {
        let v = k as f32 / CELLS as f32 * 2.0 - 1.0;
        (0.12 * v + 0.88 * v.powi(3)) * REACH
    };
    let along: Vec<f32> = (0..=CELLS).map(along).collect();
    let mesh = grid(&along, rows, tile, |x, out| color(x, out).to_array());
    let count = mesh.count_vertices();
    mesh.with_inserted_attribute(Mesh::ATTRIBUTE_TANGENT, vec![[1.0, 0.0, 0.0, 1.0]; count])
}

/// Dry sand from above.
fn sand_image() -> Image {
    let texel = |k: usize| {
        let (x, y) = ((k % SIZE) as f32 / SIZE as f32, (k / SIZE) as f32 / SIZE as f32);
        let fine = periodic(x, y, [120, 120], 95) - 0.5;
        let wide = periodic(x, y, [9, 9], 96) + 0.6 * periodic(x, y, [23, 23], 97) - 0.8;
        (shore::SAND * (1.0 + 0.35 * fine + 0.14 * wide)).extend(1.0).to_array()
    };
    tile(SIZE, (0..SIZE * SIZE).map(texel).collect(), srgb, TextureFormat::Rgba8UnormSrgb)
}

/// The slope of small waves, as a normal map.
fn wave_image() -> Image {
    let height = |x: f32, y: f32| {
        periodic(x, y, [5, 7], 98) + 0.5 * periodic(x, y, [13, 17], 99) + 0.25 * periodic(x, y, [31, 37], 100)
    };
    let step = 1.0 / SIZE as f32;
    let texel = |k: usize| {
        let (x, y) = ((k % SIZE) as f32 * step, (k / SIZE) as f32 * step);
        let slope = |dx: f32, dy: f32| 2.2 * (height(x + dx, y + dy) - height(x - dx, y - dy));
        let normal = Vec3::new(-slope(step, 0.0), -slope(0.0, step), 1.0).normalize();
        (normal * 0.5 + 0.5).extend(1.0).to_array()
    };
    tile(SIZE, (0..SIZE * SIZE).map(texel).collect(), |v| v, TextureFormat::Rgba8Unorm)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sand_ends_in_the_meadow_and_under_water() {
        for along in [-200.0, -3.0, 0.0, 40.0] {
            assert_eq!(on_land(along, SAND_ROWS[0]).w, 0.0, "at its edge one sees the meadow");
            assert_eq!(at_sea(along, WATER_ROWS[0]).w, 0.0, "the water's edge is no edge");
            assert!(at_sea(along, SAND_ROWS[23]).w > 0.95, "nor is that of the sand");
        }
    }
}
