//! The smallest program that grows a tree: a plugin, a plant, some steps.
//!
//! ```sh
//! cargo run --no-default-features --example minimal
//! ```

use bevy::prelude::*;
use burgeon::plant::measure::Form;
use burgeon::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Any Bevy app will do; this one has no window, no clock and no GPU.
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, BurgeonPlugins));

    // A plant is its species, the seed of its chances, and where it stands.
    let oak = Species::named("oak")?;
    app.world_mut().spawn((Plant::new(oak, 7), Transform::from_xyz(0.0, 0.0, 0.0)));

    // Growth happens when you ask for it, as many steps as you like. A step of an oak is a year.
    println!("year  organs  leaves  height");
    for year in 1..=10 {
        grow(app.world_mut(), 1);
        // Whatever reads a plant reads a snapshot: plain columns, in order of birth.
        let form = Form::of(&Snapshot::take(app.world()), None);
        println!("{year:4}  {:6}  {:6}  {:4.1} m", form.organs, form.leaves, form.height_m);
    }

    // Every organ is an entity too, so queries work as everywhere in Bevy.
    let world = app.world_mut();
    let mut leaves = world.query::<(&Leaf, &Exposure)>();
    let sunlit = leaves.iter(world).filter(|(_, exposure)| exposure.light > 0.5).count();
    println!("{sunlit} leaves see more than half of the light of an open sky");
    Ok(())
}
