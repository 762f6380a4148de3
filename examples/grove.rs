//! Two hundred trees, growing: what is far is drawn with less.
//!
//! ```sh
//! cargo run --release --example grove
//! ```
//!
//! `--screenshot FILE --frames N` takes a picture and ends.

use bevy::diagnostic::{FrameTimeDiagnosticsPlugin, LogDiagnosticsPlugin};
use bevy::prelude::*;
use burgeon::environment::probe::Sensing;
use burgeon::prelude::*;
use burgeon::render::{
    GrowthPace, LiveGrowthPlugin, OutdoorCamera, PictureAndExit, PlantRenderPlugin, SceneryPlugin,
};

/// Trees a row and rows.
const ROWS: [i32; 2] = [20, 10];
/// Metres between two trees.
const SPACING: f32 = 6.0;

fn main() {
    let mut app = App::new();
    app.add_plugins((DefaultPlugins, BurgeonPlugins, PlantRenderPlugin, SceneryPlugin, LiveGrowthPlugin))
        .add_plugins((FrameTimeDiagnosticsPlugin::default(), LogDiagnosticsPlugin::default()))
        .insert_resource(GrowthPace { steps_per_second: 0.5, ..default() })
        .insert_resource(Sensing { leaf_face: 4, bud_face: 4, ..default() })
        .add_systems(Startup, plant)
        .add_systems(Update, fly);
    if let Some(picture) = PictureAndExit::from_arguments() {
        app.add_plugins(picture);
    }
    app.run();
}

fn plant(mut commands: Commands) -> Result {
    let oak = std::sync::Arc::new(Species::named("oak")?);
    for k in 0..ROWS[0] * ROWS[1] {
        let (i, j) = (k % ROWS[0], k / ROWS[0]);
        // Every other row stands in the gaps, and nobody stands quite in line.
        let off = Vec2::new((k * 7 % 11) as f32 - 5.0, (k * 5 % 13) as f32 - 6.0) * 0.2;
        let x = (i - ROWS[0] / 2) as f32 * SPACING + 0.5 * SPACING * (j % 2) as f32 + off.x;
        let z = -(j as f32) * SPACING + off.y;
        commands.spawn((Plant::new(oak.clone(), k as u64), Transform::from_xyz(x, 0.0, z)));
    }
    commands.spawn((
        Sun { strength: 0.8 },
        Transform::default().looking_to(Vec3::new(-0.7, -0.6, -0.4), Vec3::Y),
    ));
    commands.spawn((OutdoorCamera, Msaa::Off, Transform::default()));
    Ok(())
}

/// Over the grove, to and fro.
fn fly(time: Res<Time>, mut camera: Single<&mut Transform, With<Camera3d>>) {
    let (sin, cos) = ops::sin_cos(0.15 * time.elapsed_secs());
    **camera = Transform::from_xyz(30.0 * sin, 5.0 + 2.0 * cos, 18.0)
        .looking_at(Vec3::new(10.0 * sin, 2.0, -25.0), Vec3::Y);
}
