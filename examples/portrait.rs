//! A scenario as a game would show it, in a picture, without a window.
//!
//! ```sh
//! cargo run --example portrait -- lamp 16 tree.png
//! ```
//!
//! Arguments: scenario, steps, file, and then, all optional, azimuth and elevation of the camera, degrees, and how much
//! farther off it stands than shows all, metres.

use bevy::anti_alias::fxaa::Fxaa;
use bevy::prelude::*;
use burgeon::assets::Library;
use burgeon::environment::workers::Workers;
use burgeon::export::picture::{Bounds, Camera as Framing};
use burgeon::prelude::*;
use burgeon::render::{
    DrawSettings, Drawn, OutdoorCamera, PlantRenderPlugin, SceneryPlugin, offscreen_app, offscreen_target,
    shows_plants, take_picture,
};
use burgeon::scenario::{Fixtures, Garden};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let text = |k: usize, other: &'static str| arguments.get(k).map_or(other, String::as_str);
    let number = |k: usize, other: f32| arguments.get(k).and_then(|a| a.parse().ok()).unwrap_or(other);

    let scenario = Library::embedded().scenario(text(0, "open"))?;
    let mut garden = Garden::new(scenario, 1, Workers::default())?;
    for _ in 0..number(1, 12.0) as u32 {
        garden.step()?;
    }

    let mut app = offscreen_app();
    app.add_plugins((PlantRenderPlugin, SceneryPlugin));
    app.insert_resource(DrawSettings { pack_at_once: true, ..default() });
    app.finish();
    app.cleanup();

    let scene = garden.scene();
    let framing = Framing::framing(&Bounds::of(&scene), number(3, 20.0), number(4, 6.0), 4.0 / 3.0);
    let world = app.world_mut();
    Fixtures::take(garden.world_mut()).stand(world);
    world.insert_resource(Ground(scene.ground));
    world.spawn(Drawn::still(garden.snapshot()));
    let (image, target) = offscreen_target(&mut world.resource_mut::<Assets<Image>>(), 960, 720);
    let fov = 2.0 * ops::atan(framing.tan_half_view);
    let lens = Projection::Perspective(PerspectiveProjection { fov, far: 2000.0, ..default() });
    let stand = Transform::from_translation(framing.eye - framing.forward * number(5, 0.0))
        .looking_to(framing.forward, Vec3::Y);
    world.spawn((OutdoorCamera, target, Msaa::Off, Fxaa::default(), lens, stand));

    for _ in 0..8 {
        app.update();
    }
    let picture = take_picture(&mut app, &image).ok_or("no picture arrived")?;
    if !shows_plants(&mut app, &image, &picture) {
        return Err("no plant is to be seen from there".into());
    }
    picture.try_into_dynamic()?.to_rgb8().save(text(2, "portrait.png"))?;
    Ok(())
}
