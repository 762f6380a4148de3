//! A scenario as a game would show it, in a picture, without a window.
//!
//! ```sh
//! cargo run --example portrait -- lamp 16 tree.png
//! ```
//!
//! Arguments: scenario, steps, file, and then, all optional, part of the step (0..1), azimuth, elevation in degrees,
//! width, height, an overlay (light, space, energy, radius, age, order), how much nearer (1 or more), and at what
//! height in metres to look.

use std::sync::Arc;

use bevy::prelude::*;
use burgeon::assets::Library;
use burgeon::environment::add_plants;
use burgeon::environment::plugin::standing_scene;
use burgeon::environment::workers::Workers;
use burgeon::export::picture::{Bounds, Camera as Framing};
use burgeon::prelude::*;
use burgeon::render::{
    DrawSettings, Drawn, Look, OutdoorCamera, Overlay, PlantRenderPlugin, SceneryPlugin, ScenerySettings,
    StepFraction, offscreen_app, offscreen_target, take_picture,
};
use burgeon::scenario::Garden;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let text = |k: usize, other: &str| arguments.get(k).map_or(other.to_string(), Clone::clone);
    let number = |k: usize, other: f32| arguments.get(k).and_then(|a| a.parse().ok()).unwrap_or(other);
    let (steps, file) = (number(1, 12.0) as u32, text(2, "portrait.png"));
    let (width, height) = (number(6, 960.0) as u32, number(7, 720.0) as u32);

    let resolved = Library::embedded().scenario(&text(0, "open"))?;
    let mut garden = Garden::new(resolved, 1, Workers::default())?;
    let mut before = Arc::new(garden.snapshot());
    let mut now = before.clone();
    while garden.steps() < steps {
        garden.step()?;
        before = now;
        now = Arc::new(garden.snapshot());
    }

    let mut app = offscreen_app();
    app.add_plugins((PlantRenderPlugin, SceneryPlugin));
    app.insert_resource(DrawSettings { pack_at_once: true, ..default() });
    // Nobody waits for the next frame.
    app.insert_resource(ScenerySettings { shadow_distance: 40.0, ..ScenerySettings::FULL });
    app.finish();
    app.cleanup();

    let mut scene = standing_scene(garden.world_mut());
    let world = app.world_mut();
    world.insert_resource(scene.sky);
    world.insert_resource(Ground(scene.ground));
    for solid in &scene.solids {
        let at = Transform::from_translation(solid.position).with_rotation(solid.rotation);
        world.spawn((Solid { shape: solid.shape, color: solid.color }, at));
    }
    for lamp in &scene.lamps {
        world.spawn((lamp.lamp, Transform::from_translation(lamp.position)));
    }
    if let Some(sun) = scene.sun {
        world.spawn((
            Sun { strength: sun.strength },
            Transform::default().looking_to(-sun.direction, Vec3::Y),
        ));
    }

    add_plants(&mut scene, &now);
    let bounds = Bounds::of(&scene);
    let framing = Framing::framing(&bounds, number(4, 20.0), number(5, 6.0), width as f32 / height as f32);
    let (image, target) = offscreen_target(&mut world.resource_mut::<Assets<Image>>(), width, height);
    let nearer = number(9, 1.0).max(1.0);
    let forward = match arguments.get(10) {
        Some(_) => (Vec3::Y * number(10, 0.0) - framing.eye).normalize(),
        None => framing.forward,
    };
    let lens = PerspectiveProjection {
        fov: 2.0 * bevy::math::ops::atan(framing.tan_half_view / nearer),
        far: 2000.0,
        ..default()
    };
    world.spawn((
        OutdoorCamera,
        target,
        Msaa::Off,
        bevy::anti_alias::fxaa::Fxaa::default(),
        Projection::Perspective(lens),
        Transform::from_translation(framing.eye).looking_to(forward, Vec3::Y),
    ));
    let overlay = Overlay::ALL.into_iter().find(|o| format!("{o:?}").to_lowercase() == text(8, "none"));
    world.spawn((Drawn { before, now }, StepFraction(number(3, 1.0)), Look { overlay, ghost: None }));

    for _ in 0..8 {
        app.update();
    }
    let picture = take_picture(&mut app, &image).ok_or("no picture arrived")?;
    picture.try_into_dynamic()?.to_rgb8().save(&file)?;
    println!("{file}");
    Ok(())
}
