//! Two oaks share one piece of sky, a third has its own.
//!
//! ```sh
//! cargo run --no-default-features --example two_trees
//! ```

use std::sync::Arc;

use bevy::prelude::*;
use burgeon::plant::measure::Form;
use burgeon::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, BurgeonPlugins));

    // Plants of one kind may share their species.
    let oak = Arc::new(Species::named("oak")?);
    for (x, seed) in [(-0.4, 1), (0.4, 2), (40.0, 1)] {
        app.world_mut().spawn((Plant::new(oak.clone(), seed), Transform::from_xyz(x, 0.0, 0.0)));
    }
    grow(app.world_mut(), 9);

    // Plants are numbered in the order of planting.
    let snapshot = Snapshot::take(app.world());
    let forms = [0, 1, 2].map(|plant| Form::of(&snapshot, Some(plant)));
    println!("          leaves  height  mean light");
    for (name, form) in ["west", "east", "alone"].iter().zip(&forms) {
        println!("{name:8}  {:6}  {:4.1} m  {:10.2}", form.leaves, form.height_m, form.mean_light);
    }

    // Each grows away from the other: their crowns lean outward.
    for (plant, x) in [(0, -0.4), (1, 0.4)] {
        let leaves: Vec<f32> = (0..snapshot.len())
            .filter(|&i| snapshot.plant[i] == plant && snapshot.state[i].kind() == OrganKind::Leaf)
            .map(|i| snapshot.pose[i].position.x - x)
            .collect();
        let lean = leaves.iter().sum::<f32>() / leaves.len().max(1) as f32;
        println!("the crown of tree {plant} stands {lean:+.2} m east of its foot");
    }
    Ok(())
}
