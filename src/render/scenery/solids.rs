//! Solids: walls of courses of stone, balls and pillars of plaster.

use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;

use crate::environment::{Solid, SolidShape};
use crate::render::noise::tile;
use crate::shape::noise::{periodic, srgb};

/// Width and height of a tile of masonry: four stones by eight courses, metres.
const TILE: [f32; 2] = [1.76, 1.60];
/// Width of a joint, metres.
const JOINT: f32 = 0.016;
/// Side of its images, texels.
const SIZE: usize = 512;

/// Masonry: its colours and its relief.
#[derive(Resource)]
pub(super) struct Masonry {
    color: Handle<Image>,
    relief: Handle<Image>,
}

impl FromWorld for Masonry {
    fn from_world(world: &mut World) -> Self {
        let mut images = world.resource_mut::<Assets<Image>>();
        let at = |k: usize| (k as f32 + 0.5) / SIZE as f32;
        let stones: Vec<(f32, f32)> = (0..SIZE * SIZE).map(|k| stone(at(k % SIZE), at(k / SIZE))).collect();
        let of = |x: usize, y: usize| stones[(y % SIZE) * SIZE + x % SIZE].0;
        let (mut color, mut relief) = (Vec::new(), Vec::new());
        for k in 0..SIZE * SIZE {
            let (x, y) = (k % SIZE, k / SIZE);
            let (height, shade) = stones[k];
            let tone = shade * (0.62 + 0.38 * height);
            color.push([tone, tone * (0.985 + 0.015 * height), tone * (0.96 + 0.04 * height), 1.0]);
            let slope = |a: f32, b: f32| (a - b) * 2.2;
            let normal = Vec3::new(
                slope(of(x + SIZE - 1, y), of(x + 1, y)),
                slope(of(x, y + SIZE - 1), of(x, y + 1)),
                1.0,
            )
            .normalize();
            relief.push([normal.x * 0.5 + 0.5, normal.y * 0.5 + 0.5, normal.z * 0.5 + 0.5, 1.0]);
        }
        Self {
            color: images.add(tile(SIZE, color, srgb, TextureFormat::Rgba8UnormSrgb)),
            relief: images.add(tile(SIZE, relief, |v| v, TextureFormat::Rgba8Unorm)),
        }
    }
}

/// Height and shade of masonry at a point of the tile, each about 0..1.
fn stone(x: f32, y: f32) -> (f32, f32) {
    let wobble = 0.004 * (periodic(x, y, [13, 13], 51) - 0.5) + 0.003 * (periodic(x, y, [37, 37], 58) - 0.5);
    let courses = (y + wobble) * 8.0;
    let course = courses.floor().rem_euclid(8.0);
    let shift = 0.5 * (course % 2.0) + 0.3 * (periodic(0.3, (course + 0.5) / 8.0, [1, 8], 52) - 0.5);
    let along = (x + wobble) * 4.0 + shift;
    let which = along.floor().rem_euclid(4.0);
    let to_joint = |v: f32, size: f32| (0.5 - (v - v.floor() - 0.5).abs()) * size;
    let near = to_joint(courses, TILE[1] / 8.0).min(to_joint(along, TILE[0] / 4.0));
    let rough = 0.5 * periodic(x, y, [44, 44], 53)
        + 0.3 * periodic(x, y, [110, 110], 54)
        + 0.2 * periodic(x, y, [230, 230], 55);
    let face = ((near - JOINT * (0.2 + 0.5 * rough)) / (JOINT * 0.8)).clamp(0.0, 1.0);
    let height = face * (0.70 + 0.30 * rough) + (1.0 - face) * 0.25 * rough;
    let own = periodic(which / 4.0, course / 8.0, [4, 8], 56);
    let weathered = periodic(x, y, [3, 4], 57) - 0.5;
    let shade = 0.80 + 0.30 * (own - 0.5) + 0.26 * (rough - 0.5) + 0.16 * weathered;
    (height, (shade * (0.86 + 0.14 * face)).clamp(0.0, 1.0))
}

/// Whether a [`Solid`] is drawn as if of glass, so that what is inside it is seen.
#[derive(Component, Debug, Clone, Copy, PartialEq, Eq, Default, Reflect)]
#[reflect(Component)]
pub struct SeenThrough(pub bool);

/// How much of a solid's own colour is left when it is seen through.
const GLASS: f32 = 0.3;

/// Colour and blending of a solid.
fn paint(solid: &Solid, through: bool) -> (Color, AlphaMode) {
    let [r, g, b] = solid.color;
    // The tile's own shade is about 0.78.
    let base = Color::linear_rgb(r / 0.78, g / 0.78, b / 0.78);
    if through { (base.with_alpha(GLASS), AlphaMode::Blend) } else { (base, AlphaMode::Opaque) }
}

/// Marks a solid that has its mesh.
#[derive(Component)]
pub(super) struct Built {
    form: Entity,
    shape: SolidShape,
    material: Handle<StandardMaterial>,
}

/// Gives every solid its mesh, and keeps it in line with it.
pub(super) fn show_solids(
    mut commands: Commands,
    masonry: Res<Masonry>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut solids: Query<
        (Entity, &Solid, &Transform, Option<&SeenThrough>, Option<&mut Built>),
        Or<(Changed<Solid>, Changed<Transform>, Changed<SeenThrough>, Without<Built>)>,
    >,
) {
    for (entity, solid, transform, through, built) in &mut solids {
        let shape = solid.shape.scaled(transform.scale);
        let (base, alpha_mode) = paint(solid, through.is_some_and(|through| through.0));
        // The form undoes the scale of what it stands on: sizes are in the mesh, so that stones keep theirs.
        let undo = Transform::from_scale(transform.scale.map(|s| if s.abs() > 1e-6 { 1.0 / s } else { 1.0 }));
        match built {
            None => {
                let material = materials.add(StandardMaterial {
                    base_color: base,
                    alpha_mode,
                    base_color_texture: Some(masonry.color.clone()),
                    normal_map_texture: Some(masonry.relief.clone()),
                    perceptual_roughness: 0.94,
                    reflectance: 0.2,
                    ..default()
                });
                let form = commands
                    .spawn((
                        ChildOf(entity),
                        Mesh3d(meshes.add(mesh(shape))),
                        MeshMaterial3d(material.clone()),
                        undo,
                    ))
                    .id();
                commands.entity(entity).insert(Built { form, shape, material });
            }
            Some(mut built) => {
                if built.shape != shape {
                    built.shape = shape;
                    commands.entity(built.form).insert((Mesh3d(meshes.add(mesh(shape))), undo));
                }
                if materials.get(&built.material).is_some_and(|m| m.base_color != base)
                    && let Some(mut material) = materials.get_mut(&built.material)
                {
                    (material.base_color, material.alpha_mode) = (base, alpha_mode);
                }
            }
        }
    }
}

/// The mesh of a shape, its texture in whole metres.
fn mesh(shape: SolidShape) -> Mesh {
    let mut mesh = match shape {
        SolidShape::Box { size } => Cuboid::from_size(size).mesh().build(),
        SolidShape::Ball { radius } => Sphere::new(radius).mesh().uv(48, 32),
        SolidShape::Cylinder { radius, height } => {
            Cylinder::new(radius, height).mesh().resolution(48).build()
        }
    };
    let read = |id| match mesh.attribute(id) {
        Some(VertexAttributeValues::Float32x3(values)) => values.clone(),
        _ => Vec::new(),
    };
    let (positions, normals) = (read(Mesh::ATTRIBUTE_POSITION), read(Mesh::ATTRIBUTE_NORMAL));
    if let Some(VertexAttributeValues::Float32x2(uvs)) = mesh.attribute_mut(Mesh::ATTRIBUTE_UV_0) {
        for ((uv, p), n) in uvs.iter_mut().zip(&positions).zip(&normals) {
            *uv = match shape {
                SolidShape::Box { .. } => on_face(*p, *n),
                SolidShape::Ball { radius } => {
                    [around(uv[0], radius), uv[1] * core::f32::consts::PI * radius / TILE[1]]
                }
                SolidShape::Cylinder { .. } if n[1].abs() > 0.5 => on_face(*p, *n),
                SolidShape::Cylinder { radius, .. } => [around(uv[0], radius), -p[1] / TILE[1]],
            };
        }
    }
    mesh.generate_tangents().map_or_else(|_| mesh.clone(), |()| mesh.clone())
}

/// Texture place on a flat face, by where it is and which way it faces.
fn on_face(p: [f32; 3], n: [f32; 3]) -> [f32; 2] {
    let (across, up) = match n.map(f32::abs) {
        [_, y, _] if y > 0.5 => (p[0], p[2]),
        [x, _, _] if x > 0.5 => (-p[2] * n[0].signum(), p[1]),
        _ => (p[0] * n[2].signum(), p[1]),
    };
    [across / TILE[0], -up / TILE[1]]
}

/// Whole tiles around a body of this radius.
fn around(u: f32, radius: f32) -> f32 {
    u * (core::f32::consts::TAU * radius / TILE[0]).round().max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masonry_repeats_without_a_seam() {
        for k in 0..40 {
            let v = (k as f32 + 0.5) / 40.0;
            assert!((stone(0.0, v).0 - stone(1.0, v).0).abs() < 0.02, "{v}");
            assert!((stone(v, 0.0).0 - stone(v, 1.0).0).abs() < 0.02, "{v}");
        }
    }

    #[test]
    fn a_solid_is_of_stone_until_it_is_seen_through() {
        let solid = Solid::block(Vec3::ONE);
        let (stone, glass) = (paint(&solid, false), paint(&solid, true));
        assert_eq!((stone.0.alpha(), stone.1), (1.0, AlphaMode::Opaque));
        assert!(glass.0.alpha() < 0.5 && glass.1 == AlphaMode::Blend);
        assert_eq!(glass.0.with_alpha(1.0), stone.0);
    }

    #[test]
    fn every_shape_has_a_mesh_of_its_size() {
        for (shape, half) in [
            (SolidShape::Box { size: Vec3::new(2.0, 4.0, 6.0) }, Vec3::new(1.0, 2.0, 3.0)),
            (SolidShape::Ball { radius: 1.5 }, Vec3::splat(1.5)),
            (SolidShape::Cylinder { radius: 1.0, height: 3.0 }, Vec3::new(1.0, 1.5, 1.0)),
        ] {
            let mesh = mesh(shape);
            let Some(VertexAttributeValues::Float32x3(p)) = mesh.attribute(Mesh::ATTRIBUTE_POSITION) else {
                panic!("no positions")
            };
            let most = p.iter().fold(Vec3::ZERO, |most, p| most.max(Vec3::from(*p).abs()));
            assert!((most - half).abs().max_element() < 0.02, "{shape:?} {most}");
            assert!(mesh.attribute(Mesh::ATTRIBUTE_TANGENT).is_some());
        }
    }
}
