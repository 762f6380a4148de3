//! Lamps: a glowing ball and the light it gives.

use bevy::light::NotShadowCaster;
use bevy::prelude::*;

use super::{Daylight, ScenerySettings};
use crate::environment::Lamp;

/// Light below this share of the ambient is not followed further.
const FAINT: f32 = 0.02;

/// Brightness of a burning ball on screen, 1 for white.
const GLOW: f32 = 30.0;

/// Marks a lamp that has its ball and light.
#[derive(Component)]
pub(super) struct Lit {
    ball: Entity,
    material: Handle<StandardMaterial>,
}

/// Gives every lamp its ball and light, and keeps them in line with it.
pub(super) fn show_lamps(
    mut commands: Commands,
    settings: Res<ScenerySettings>,
    daylight: Res<Daylight>,
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
        let glow = StandardMaterial {
            base_color: match lamp.on {
                // As bright things look: white in the middle, its colour in the glow about it.
                true => Color::linear_rgb(GLOW * r, GLOW * g, GLOW * b),
                false => Color::linear_rgb(0.55, 0.53, 0.48),
            },
            unlit: lamp.on,
            fog_enabled: false,
            ..default()
        };
        let form = Transform::from_scale(Vec3::splat(lamp.radius));
        match lit {
            Some(lit) => {
                if let Some(mut material) = materials.get_mut(&lit.material) {
                    *material = glow;
                }
                commands.entity(lit.ball).insert(form);
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
                commands.entity(entity).insert((light, Lit { ball, material }));
            }
        }
    }
}
