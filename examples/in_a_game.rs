//! Trees in a game: they grow in the game's own world, beside everything else, and people walk around them.
//!
//! ```sh
//! cargo run --example in_a_game
//! ```
//!
//! Space pauses growth; Delete fells the oak by despawning it. `--screenshot FILE --frames N` takes a picture and
//! ends.

use bevy::prelude::*;
use burgeon::prelude::*;
use burgeon::render::{
    GrowthPace, LiveGrowthPlugin, OutdoorCamera, PictureAndExit, PlantRenderPlugin, SceneryPlugin,
};

fn main() {
    let mut app = App::new();
    app.add_plugins((DefaultPlugins, BurgeonPlugins, PlantRenderPlugin, SceneryPlugin, LiveGrowthPlugin))
        .insert_resource(GrowthPace { steps_per_second: 1.0, ..default() })
        .add_systems(Startup, plant)
        .add_systems(Update, (walk, play));
    if let Some(picture) = PictureAndExit::from_arguments() {
        app.add_plugins(picture);
    }
    app.run();
}

fn plant(mut commands: Commands) -> Result {
    commands.spawn((Plant::new(Species::named("oak")?, 7), Transform::default()));
    commands.spawn((Solid::block(Vec3::new(5.0, 2.5, 0.4)), Transform::from_xyz(0.0, 1.25, -1.5)));
    commands.spawn((
        Sun { strength: 0.8 },
        Transform::default().looking_to(Vec3::new(-0.6, -0.8, -0.5), Vec3::Y),
    ));
    commands.spawn((OutdoorCamera, Msaa::Off, Transform::from_xyz(0.0, 2.0, 14.0)));
    Ok(())
}

/// To and fro before the wall, slowly, so that the tree never hides behind it.
fn walk(time: Res<Time>, mut camera: Single<&mut Transform, With<Camera3d>>) {
    let (sin, cos) = ops::sin_cos(1.1 * ops::sin(0.1 * time.elapsed_secs()));
    **camera = Transform::from_xyz(14.0 * sin, 2.5, 14.0 * cos).looking_at(Vec3::Y * 3.0, Vec3::Y);
}

fn play(
    mut commands: Commands,
    keys: Res<ButtonInput<KeyCode>>,
    mut pace: ResMut<GrowthPace>,
    plants: Query<Entity, With<Plant>>,
) {
    if keys.just_pressed(KeyCode::Space) {
        pace.paused = !pace.paused;
    }
    if keys.just_pressed(KeyCode::Delete) {
        plants.iter().for_each(|plant| commands.entity(plant).despawn());
    }
}
