//! What stands around the plants, drawn as it is sensed: walls, lamps, sun, sky and ground.

mod daylight;
mod grass;
mod ground;
mod lamps;
mod shore;
mod solids;

use bevy::camera::{Exposure, Hdr};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::light::{
    CascadeShadowConfig, CascadeShadowConfigBuilder, DirectionalLightShadowMap, EnvironmentMapLight, Skybox,
};
use bevy::pbr::{DistanceFog, FogFalloff};
use bevy::post_process::bloom::Bloom;
use bevy::prelude::*;
use bevy::render::renderer::RenderAdapterInfo;

use crate::environment::{Lamp, Sky, Solid};
pub use daylight::Daylight;
pub use ground::Tufts;
pub use solids::SeenThrough;

/// Draws every [`Solid`], [`Lamp`] and [`Sun`](crate::environment::Sun), the [`Sky`], the [`Ground`](crate::environment::Ground)
/// and, where there is one, the [`Shore`](crate::environment::Shore).
///
/// Without a sun a soft light stands in for the brighter half of the sky, so that things have a lit and a shaded
/// side. Cameras marked [`OutdoorCamera`] get sky, haze and exposure.
pub struct SceneryPlugin;

/// How much the scenery costs.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Reflect)]
#[reflect(Resource)]
pub struct ScenerySettings {
    /// Distance from the camera up to which the sun casts shadows, metres.
    pub shadow_distance: f32,
    /// Shadow maps the distance is split into, 1 to 4.
    pub cascades: usize,
    /// Side of each of them, texels.
    pub shadow_map: usize,
    /// How many lamps cast shadows, brightest first.
    pub lamp_shadows: usize,
    /// Whether bright things glow.
    pub bloom: bool,
}

impl ScenerySettings {
    /// For a graphics card.
    pub const FULL: Self =
        Self { shadow_distance: 60.0, cascades: 3, shadow_map: 2048, lamp_shadows: 4, bloom: true };
    /// For a processor that stands in for one.
    pub const LEAN: Self =
        Self { shadow_distance: 40.0, cascades: 1, shadow_map: 1024, lamp_shadows: 1, bloom: false };
}

/// Marks a [`Camera3d`] that looks out into the open: it gets sky, haze, ambient light and exposure.
#[derive(Component, Debug, Clone, Copy, Default, Reflect)]
#[reflect(Component)]
#[require(Camera3d)]
pub struct OutdoorCamera;

/// The light that is the sun, or stands in for it.
#[derive(Component)]
struct KeyLight;

impl Plugin for SceneryPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Sky>()
            .init_resource::<crate::environment::Ground>()
            .init_resource::<Daylight>()
            .register_type::<ScenerySettings>()
            .register_type::<OutdoorCamera>()
            .register_type::<Tufts>()
            .register_type::<SeenThrough>()
            .register_required_components::<Solid, Visibility>();
        app.register_required_components::<Lamp, Visibility>();
        app.add_systems(
            PostUpdate,
            (
                daylight::follow_light,
                (
                    solids::show_solids,
                    lamps::show_lamps,
                    lamps::face_camera,
                    ground::show_ground,
                    ground::show_tufts,
                    shore::show_shore,
                    set_key_light,
                    set_cameras,
                ),
            )
                .chain()
                .before(TransformSystems::Propagate)
                .before(bevy::light::SimulationLightSystems::UpdateDirectionalLightCascades)
                .before(bevy::camera::visibility::VisibilitySystems::CalculateBounds),
        );
    }

    fn finish(&self, app: &mut App) {
        if !app.world().contains_resource::<ScenerySettings>() {
            let software = app.world().get_resource::<RenderAdapterInfo>().is_some_and(is_software);
            app.insert_resource(if software { ScenerySettings::LEAN } else { ScenerySettings::FULL });
        }
        app.init_resource::<solids::Masonry>()
            .init_resource::<ground::Meadow>()
            .init_resource::<lamps::Glow>();
    }
}

/// Whether an adapter is a processor that stands in for a graphics card.
pub fn is_software(info: &RenderAdapterInfo) -> bool {
    // Bevy does not pass on the type of this field; its name is stable.
    format!("{:?}", info.device_type) == "Cpu"
}

/// Keeps the one directional light in line with the sun.
fn set_key_light(
    mut commands: Commands,
    daylight: Res<Daylight>,
    settings: Res<ScenerySettings>,
    mut lights: Query<(Entity, &mut DirectionalLight, &mut Transform), With<KeyLight>>,
) {
    if !daylight.is_changed() && !settings.is_changed() && !lights.is_empty() {
        return;
    }
    let light = DirectionalLight {
        color: daylight.key_color,
        illuminance: daylight.key_lux,
        shadow_maps_enabled: daylight.key_lux > 0.0,
        shadow_depth_bias: 0.02,
        shadow_normal_bias: 1.2,
        ..default()
    };
    let transform = Transform::IDENTITY.looking_to(-daylight.key_direction, Vec3::Y);
    let cascades: CascadeShadowConfig = CascadeShadowConfigBuilder {
        num_cascades: settings.cascades.clamp(1, 4),
        minimum_distance: 0.1,
        maximum_distance: settings.shadow_distance,
        first_cascade_far_bound: (settings.shadow_distance * 0.2).min(12.0),
        overlap_proportion: 0.2,
    }
    .build();
    commands.insert_resource(DirectionalLightShadowMap { size: settings.shadow_map });
    match lights.iter_mut().next() {
        Some((entity, mut old, mut at)) => {
            (*old, *at) = (light, transform);
            commands.entity(entity).insert(cascades);
        }
        None => {
            commands.spawn((KeyLight, Name::new("key light"), light, transform, cascades));
        }
    }
}

/// Gives cameras their sky, haze, ambient light and exposure.
fn set_cameras(
    mut commands: Commands,
    daylight: Res<Daylight>,
    settings: Res<ScenerySettings>,
    mut images: ResMut<Assets<Image>>,
    mut sky: Local<Option<(Handle<Image>, EnvironmentMapLight)>>,
    cameras: Query<(Entity, Has<Skybox>), With<OutdoorCamera>>,
) {
    let fresh = daylight.is_changed() || settings.is_changed() || sky.is_none();
    if !fresh && cameras.iter().all(|(_, dressed)| dressed) {
        return;
    }
    if fresh {
        let [top, middle, bottom] = daylight.ambient;
        let ambient = EnvironmentMapLight {
            intensity: Daylight::FULL_SKY,
            ..EnvironmentMapLight::hemispherical_gradient(&mut images, top, middle, bottom)
        };
        *sky = Some((images.add(daylight.sky_image()), ambient));
    }
    let Some((image, ambient)) = &*sky else { return };
    for (camera, dressed) in &cameras {
        if dressed && !fresh {
            continue;
        }
        if settings.bloom {
            commands.entity(camera).insert(Bloom { intensity: 0.10, ..Bloom::NATURAL });
        } else {
            commands.entity(camera).remove::<Bloom>();
        }
        commands.entity(camera).insert((
            // Without, the sky alone would not pass through the film curve.
            Hdr,
            Skybox { image: Some(image.clone()), brightness: Daylight::FULL_SKY, ..default() },
            ambient.clone(),
            Exposure { ev100: daylight.ev100 },
            Tonemapping::AcesFitted,
            DistanceFog {
                color: Color::LinearRgba(daylight.haze * daylight.exposure()).with_alpha(1.0),
                directional_light_color: Color::NONE,
                directional_light_exponent: 8.0,
                falloff: FogFalloff::ExponentialSquared { density: 0.0042 },
            },
        ));
    }
}
