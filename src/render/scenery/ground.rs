//! The ground: a meadow out to the haze, with tufts of grass where one looks.

use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::VisibilityRange;
use bevy::light::{NotShadowCaster, TransmittedShadowReceiver};
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;

use super::grass;
use crate::environment::Ground;
use crate::render::noise::tile;
use crate::shape::noise::{periodic, srgb};

/// Half the side of the ground, metres.
const REACH: f32 = 320.0;
/// Cells along a side; they are smaller near the middle.
const CELLS: usize = 96;
/// Side of a tile of grass, metres.
const TILE: f32 = 3.1;
/// Distance from the camera up to which blades of grass are drawn, metres.
const GRASS_DISTANCE: f32 = 60.0;
/// Side of its image, texels.
const SIZE: usize = 512;

/// What the ground is made of.
#[derive(Resource)]
pub(super) struct Meadow {
    mesh: Handle<Mesh>,
    material: Handle<StandardMaterial>,
    grass: Handle<Mesh>,
    blades: Handle<StandardMaterial>,
}

impl FromWorld for Meadow {
    fn from_world(world: &mut World) -> Self {
        let image = world.resource_mut::<Assets<Image>>().add(grass_image());
        let material = world.resource_mut::<Assets<StandardMaterial>>().add(StandardMaterial {
            base_color_texture: Some(image),
            perceptual_roughness: 1.0,
            reflectance: 0.05,
            ..default()
        });
        let blades = world.resource_mut::<Assets<StandardMaterial>>().add(StandardMaterial {
            perceptual_roughness: 0.8,
            reflectance: 0.2,
            diffuse_transmission: 0.3,
            cull_mode: None,
            ..default()
        });
        let mut meshes = world.resource_mut::<Assets<Mesh>>();
        Self { mesh: meshes.add(ground_mesh()), material, grass: meshes.add(grass::mesh()), blades }
    }
}

/// Grass about a point: its tufts stand thick there, and go with it. About the origin they always do.
#[derive(Component, Debug, Clone, Copy, Default, Reflect)]
#[reflect(Component)]
#[require(Transform, Visibility)]
pub struct Tufts;

/// Gives every [`Tufts`] its grass.
pub(super) fn show_tufts(
    mut commands: Commands,
    meadow: Res<Meadow>,
    bare: Query<Entity, (With<Tufts>, Without<Mesh3d>)>,
) {
    for entity in &bare {
        commands.entity(entity).insert(tufts(&meadow));
    }
}

/// Marks blades of grass on screen.
#[derive(Component)]
pub(super) struct Blades;

fn tufts(meadow: &Meadow) -> impl Bundle {
    (
        Blades,
        Visibility::default(),
        Mesh3d(meadow.grass.clone()),
        MeshMaterial3d(meadow.blades.clone()),
        NotShadowCaster,
        TransmittedShadowReceiver,
        VisibilityRange::abrupt(0.0, GRASS_DISTANCE),
    )
}

/// Marks the ground on screen.
#[derive(Component)]
pub(super) struct DrawnGround;

/// Lays the ground, and keeps it at its height.
pub(super) fn show_ground(
    mut commands: Commands,
    ground: Res<Ground>,
    meadow: Res<Meadow>,
    mut drawn: Query<(Entity, &mut Transform), With<DrawnGround>>,
) {
    match (ground.0, drawn.single_mut()) {
        (Some(height), Ok((_, mut at))) => {
            if at.translation.y != height {
                at.translation.y = height;
            }
        }
        (Some(height), Err(_)) => {
            commands.spawn((
                DrawnGround,
                Name::new("ground"),
                Mesh3d(meadow.mesh.clone()),
                MeshMaterial3d(meadow.material.clone()),
                Transform::from_xyz(0.0, height, 0.0),
                NotShadowCaster,
                children![tufts(&meadow)],
            ));
        }
        (None, Ok((entity, _))) => commands.entity(entity).despawn(),
        (None, Err(_)) => {}
    }
}

/// A flat grid, finer in the middle, coloured in wide patches so that tiles do not show.
fn ground_mesh() -> Mesh {
    let place = |k: usize| {
        let v = k as f32 / CELLS as f32 * 2.0 - 1.0;
        v.signum() * v.abs().powi(3) * REACH
    };
    let places: Vec<f32> = (0..=CELLS).map(place).collect();
    grid(&places, &places, TILE, patch)
}

/// A level grid with its vertices at these x and z, under an image whose tile has a side in metres, coloured by place.
pub(super) fn grid(xs: &[f32], zs: &[f32], tile: f32, color: impl Fn(f32, f32) -> [f32; 4]) -> Mesh {
    let places = || zs.iter().flat_map(|&z| xs.iter().map(move |&x| (x, z)));
    let positions: Vec<_> = places().map(|(x, z)| [x, 0.0, z]).collect();
    let uvs: Vec<_> = places().map(|(x, z)| [x / tile, z / tile]).collect();
    let colors: Vec<_> = places().map(|(x, z)| color(x, z)).collect();
    let mut indices = Vec::new();
    for j in 1..zs.len() {
        for i in 1..xs.len() {
            let d = (j * xs.len() + i) as u32;
            let (a, b, c) = (d - xs.len() as u32 - 1, d - xs.len() as u32, d - 1);
            indices.extend([a, c, b, b, c, d]);
        }
    }
    let normals = vec![[0.0, 1.0, 0.0]; positions.len()];
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::RENDER_WORLD)
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
        .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors)
        .with_inserted_indices(Indices::U32(indices))
}

/// The tint of the meadow in the large, linear.
fn patch(x: f32, z: f32) -> [f32; 4] {
    let at = |size: f32, seed: u32| periodic(x / (size * 16.0), z / (size * 16.0), [16, 16], seed) - 0.5;
    let wide = 0.6 * at(23.0, 61) + 0.5 * at(7.0, 62) + 0.3 * at(2.6, 63);
    let dry = 0.5 * at(31.0, 64) + 0.4 * at(5.0, 65);
    let tone = 1.0 + 0.55 * wide;
    [tone * (1.0 + 0.30 * dry), tone * (1.0 + 0.06 * dry), tone * (1.0 - 0.15 * dry), 1.0]
}

/// Grass from above: blades over blades, and earth between.
fn grass_image() -> Image {
    let mut texels = vec![[0.050, 0.052, 0.024, 1.0]; SIZE * SIZE];
    for (k, texel) in texels.iter_mut().enumerate() {
        let (x, y) = ((k % SIZE) as f32 / SIZE as f32, (k / SIZE) as f32 / SIZE as f32);
        let n = 0.5 * periodic(x, y, [40, 40], 71) + 0.5 * periodic(x, y, [130, 130], 72);
        for part in &mut texel[..3] {
            *part *= 0.6 + 0.8 * n;
        }
    }
    let unit = |k: u32, seed: u32| {
        periodic((k as f32 * 0.618_034).fract(), (k as f32 * 0.754_877).fract(), [509, 521], seed)
    };
    const BLADES: u32 = 16_000;
    for k in 0..BLADES {
        let (mut x, mut y) = (unit(k, 73) * 7.0, unit(k, 74) * 7.0);
        let turn = unit(k, 75) * 2.0 * core::f32::consts::TAU;
        let (sin, cos) = bevy::math::ops::sin_cos(turn);
        let length = 7.0 + 16.0 * unit(k, 76);
        let clump = periodic(x.fract(), y.fract(), [7, 7], 77);
        let fresh = (0.35 + 0.5 * unit(k, 78) + 0.5 * clump).clamp(0.0, 1.0);
        let tone = (0.45 + 0.55 * k as f32 / BLADES as f32) * (0.75 + 0.5 * unit(k, 79));
        let tip = [0.135, 0.205, 0.050].map(|c: f32| c * tone);
        let dry = [0.215, 0.205, 0.085].map(|c: f32| c * tone);
        for step in 0..length as u32 {
            let along = step as f32 / length;
            (x, y) = (x + cos / SIZE as f32, y + sin / SIZE as f32);
            let wrap = |v: f32| ((v - v.floor()) * SIZE as f32) as usize % SIZE;
            let texel = &mut texels[wrap(y) * SIZE + wrap(x)];
            for part in 0..3 {
                let color = (dry[part] + (tip[part] - dry[part]) * fresh) * (0.55 + 0.6 * along);
                texel[part] += (color - texel[part]) * 0.8;
            }
        }
    }
    tile(SIZE, texels, srgb, TextureFormat::Rgba8UnormSrgb)
}
