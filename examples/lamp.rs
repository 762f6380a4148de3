//! A lamp in the dusk, carried across half-way: what grows later leans the other way.
//!
//! ```sh
//! cargo run --no-default-features --example lamp -- out    # writes out/lamp.png
//! ```

use std::path::PathBuf;

use bevy::prelude::*;
use burgeon::export::{canvas, film, picture};
use burgeon::prelude::*;

/// Mean east-west position of the leaves, metres.
fn lean(world: &mut World) -> f32 {
    let mut leaves = world.query_filtered::<&Pose, With<Leaf>>();
    let xs: Vec<f32> = leaves.iter(world).map(|leaf| leaf.position.x).collect();
    xs.iter().sum::<f32>() / xs.len().max(1) as f32
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, BurgeonPlugins));
    // The sky is a resource: a dim one, brighter overhead than at the horizon.
    app.insert_resource(Sky { strength: 0.15, gradient: SkyGradient::Overcast });
    let world = app.world_mut();
    world.spawn((Plant::new(Species::named("oak")?, 5), Transform::default()));
    // The lamp that is drawn is the lamp that is sensed: 260 times as bright as a full sky, 0.3 m in radius.
    let lamp = world.spawn((Lamp::new(260.0, 0.3), Transform::from_xyz(4.0, 4.0, 0.0))).id();

    let mut pictures = Vec::new();
    for (x, side) in [(4.0, "east"), (-4.0, "west")] {
        // Dragging a lamp is changing its Transform.
        if let Some(mut at) = world.get_mut::<Transform>(lamp) {
            at.translation.x = x;
        }
        let before = lean(world);
        grow(world, 9);
        println!("lamp in the {side}: the crown went {:+.2} m eastward", lean(world) - before);

        let size = picture::PictureSettings { width: 320, height: 320, samples: 3 };
        let mut seen = picture::photograph(world, size, 0.0);
        canvas::caption(&mut seen, &format!("lamp in the {side}"), 2);
        pictures.push(seen);
    }

    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    std::fs::create_dir_all(&out)?;
    let file = out.join("lamp.png");
    film::save_png(&file, &canvas::side_by_side(&pictures, 6))?;
    println!("picture: {}", file.display());
    Ok(())
}
