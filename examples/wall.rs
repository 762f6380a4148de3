//! A wall beside a seed: the same tree, with and without.
//!
//! ```sh
//! cargo run --no-default-features --example wall -- out    # writes out/wall.png
//! ```

use std::path::PathBuf;

use bevy::prelude::*;
use burgeon::export::{canvas, film, picture};
use burgeon::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut pictures = Vec::new();
    let mut leanings = Vec::new();
    for walled in [false, true] {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, BurgeonPlugins));
        // Same species and seed both times: whatever differs is the wall's doing.
        app.world_mut().spawn((Plant::new(Species::named("lam_king")?, 3), Transform::default()));
        if walled {
            // A solid hides light, takes up space, and no branch ever grows through it. It is an entity under
            // a Transform: move it between two steps and the plants feel it in the next.
            let wall = Solid::block(Vec3::new(0.2, 3.0, 5.0));
            app.world_mut().spawn((wall, Transform::from_xyz(0.5, 1.5, 0.0)));
        }
        grow(app.world_mut(), 7);

        let world = app.world_mut();
        let mut leaves = world.query_filtered::<&Pose, With<Leaf>>();
        let count = leaves.iter(world).count();
        let lean = leaves.iter(world).map(|leaf| leaf.position.x).sum::<f32>() / count as f32;
        println!("{count:4} leaves, centred {:+.2} m towards the wall's side", lean);
        leanings.push(lean);

        let size = picture::PictureSettings { width: 320, height: 360, samples: 3 };
        let mut seen = picture::photograph(world, size, 0.0);
        canvas::caption(&mut seen, if walled { "with a wall" } else { "without" }, 2);
        pictures.push(seen);
    }
    println!("the wall moved the crown by {:+.2} m", leanings[1] - leanings[0]);

    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    std::fs::create_dir_all(&out)?;
    let file = out.join("wall.png");
    film::save_png(&file, &canvas::side_by_side(&pictures, 6))?;
    println!("picture: {}", file.display());
    Ok(())
}
