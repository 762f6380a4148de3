//! Lamps: a glowing ball, its halo and the light it gives.

use bevy::asset::RenderAssetUsages;
use bevy::light::NotShadowCaster;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};

use super::{Daylight, OutdoorCamera, ScenerySettings};
use crate::environment::Lamp;

/// Light below this share of the ambient is not followed further.
const FAINT: f32 = 0.02;

/// Brightness of a burning ball on screen, 1 for white, where a camera makes bright things glow.
const GLOW: f32 = 30.0;
/// Where it does not: no brighter than its colour still shows.
const PLAIN: f32 = 2.6;
/// Radius of the halo that stands in for the glow there, in radii of the ball, and its brightness near it.
const HALO: f32 = 6.0;
const SHEEN: f32 = 0.55;

/// Marks a lamp that has its ball and light.
#[derive(Component)]
pub(super) struct Lit {
    ball: Entity,
    material: Handle<StandardMaterial>,
    halo: Entity,
    sheen: Handle<StandardMaterial>,
}

/// The halo of a lamp: a picture that always faces the camera.
#[derive(Component)]
pub(super) struct Halo;

/// What all halos are made of.
#[derive(Resource)]
pub(super) struct Glow {
    mesh: Handle<Mesh>,
    image: Handle<Image>,
}

impl FromWorld for Glow {
    fn from_world(world: &mut World) -> Self {
        let image = world.resource_mut::<Assets<Image>>().add(halo_image());
        let mesh = world.resource_mut::<Assets<Mesh>>().add(Rectangle::new(2.0, 2.0));
        Self { mesh, image }
    }
}

/// How bright a halo is at a distance from its middle, 0 to 1: 1 at the ball, nothing at the edge.
fn sheen(out: f32) -> f32 {
    let fades = (1.0 - out.clamp(0.0, 1.0)).powi(2);
    fades / (1.0 + 14.0 * out * out)
}

fn halo_image() -> Image {
    const SIDE: usize = 128;
    let at = |k: usize| (k as f32 + 0.5) / SIDE as f32 * 2.0 - 1.0;
    let texels = (0..SIDE * SIDE).flat_map(|k| {
        let out = Vec2::new(at(k % SIDE), at(k / SIDE)).length();
        let level = (255.0 * sheen(out)) as u8;
        [level, level, level, 255]
    });
    Image::new(
        Extent3d { width: SIDE as u32, height: SIDE as u32, depth_or_array_layers: 1 },
        TextureDimension::D2,
        texels.collect(),
        TextureFormat::Rgba8Unorm,
        RenderAssetUsages::RENDER_WORLD,
    )
}

/// Turns halos to the camera; a second camera beside it looks the same way.
pub(super) fn face_camera(
    cameras: Query<&Transform, (With<OutdoorCamera>, Without<Halo>)>,
    lamps: Query<&Transform, (With<Lit>, Without<Halo>, Without<OutdoorCamera>)>,
    mut halos: Query<(&mut Transform, &ChildOf), With<Halo>>,
) {
    let Some(camera) = cameras.iter().next() else { return };
    for (mut halo, of) in &mut halos {
        let lamp = lamps.get(of.parent()).map_or(Quat::IDENTITY, |lamp| lamp.rotation);
        let rotation = lamp.inverse() * camera.rotation;
        if halo.rotation != rotation {
            halo.rotation = rotation;
        }
    }
}

/// Gives every lamp its ball and light, and keeps them in line with it.
pub(super) fn show_lamps(
    mut commands: Commands,
    settings: Res<ScenerySettings>,
    daylight: Res<Daylight>,
    halos: Res<Glow>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    lamps: Query<(Entity, Ref<Lamp>, Option<&Lit>)>,
) {
    if !daylight.is_changed()
        && !settings.is_changed()
        && lamps.iter().all(|(_, lamp, lit)| lit.is_some() && !lamp.is_changed())
    {
        return;
    }
    let mut ranked: Vec<_> = lamps.iter().collect();
    ranked.sort_by(|a, b| Daylight::lumens(&b.1).total_cmp(&Daylight::lumens(&a.1)));
    for (rank, (entity, lamp, lit)) in ranked.into_iter().enumerate() {
        let [r, g, b] = lamp.color;
        let lumens = if lamp.on { Daylight::lumens(&lamp) } else { 0.0 };
        // Where its light falls below the ambient's by far.
        let ambient = (daylight.ambient[0].green * Daylight::FULL_SKY).max(1.0);
        let range = (lumens / (4.0 * core::f32::consts::PI) / (ambient * FAINT)).sqrt().clamp(1.0, 80.0);
        let light = PointLight {
            color: Color::linear_rgb(r, g, b),
            intensity: lumens,
            range,
            radius: lamp.radius,
            shadow_maps_enabled: lamp.on && rank < settings.lamp_shadows,
            shadow_depth_bias: 0.04,
            shadow_normal_bias: 1.0,
            ..default()
        };
        let bright = if settings.bloom { GLOW } else { PLAIN };
        let glow = StandardMaterial {
            base_color: match lamp.on {
                // As bright things look: nearly white in the middle, its colour in the glow about it.
                true => Color::linear_rgb(bright * r, bright * g, bright * b),
                false => Color::linear_rgb(0.55, 0.53, 0.48),
            },
            unlit: lamp.on,
            fog_enabled: false,
            ..default()
        };
        let aura = StandardMaterial {
            base_color: Color::linear_rgb(SHEEN * r, SHEEN * g * g, SHEEN * b * b),
            base_color_texture: Some(halos.image.clone()),
            alpha_mode: AlphaMode::Add,
            unlit: true,
            fog_enabled: false,
            ..default()
        };
        let form = Transform::from_scale(Vec3::splat(lamp.radius));
        let around = Transform::from_scale(Vec3::splat(HALO * lamp.radius));
        let seen = if lamp.on && !settings.bloom { Visibility::Inherited } else { Visibility::Hidden };
        match lit {
            Some(lit) => {
                if let Some(mut material) = materials.get_mut(&lit.material) {
                    *material = glow;
                }
                if let Some(mut material) = materials.get_mut(&lit.sheen) {
                    *material = aura;
                }
                commands.entity(lit.ball).insert(form);
                commands.entity(lit.halo).insert((around, seen));
                commands.entity(entity).insert(light);
            }
            None => {
                let material = materials.add(glow);
                let mesh = meshes.add(
                    Sphere::new(1.0).mesh().ico(4).unwrap_or_else(|_| Sphere::new(1.0).mesh().uv(24, 16)),
                );
                let ball = commands
                    .spawn((
                        ChildOf(entity),
                        Mesh3d(mesh),
                        MeshMaterial3d(material.clone()),
                        NotShadowCaster,
                        form,
                    ))
                    .id();
                let sheen = materials.add(aura);
                let halo = commands
                    .spawn((
                        ChildOf(entity),
                        Halo,
                        Mesh3d(halos.mesh.clone()),
                        MeshMaterial3d(sheen.clone()),
                        NotShadowCaster,
                        around,
                        seen,
                    ))
                    .id();
                commands.entity(entity).insert((light, Lit { ball, material, halo, sheen }));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_halo_fades_outwards_to_nothing() {
        assert_eq!((sheen(0.0), sheen(1.0), sheen(2.0)), (1.0, 0.0, 0.0));
        for k in 1..=20 {
            assert!(sheen(k as f32 / 20.0) < sheen((k - 1) as f32 / 20.0), "{k}");
        }
        assert!(sheen(0.95) < 0.01, "no edge is seen");
    }
}
