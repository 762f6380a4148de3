//! Wood as capsules, as any physics crate takes it: balls dropped on an oak, and what each hits first.
//!
//! ```sh
//! cargo run --no-default-features --example capsules
//! ```

use bevy::prelude::*;
use burgeon::environment::{Capsule, capsules};
use burgeon::prelude::*;

/// Radius of a ball, metres.
const BALL: f32 = 0.1;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, BurgeonPlugins));
    app.world_mut().spawn(Plant::new(Species::named("oak")?, 7));
    grow(app.world_mut(), 10);

    let wood: Vec<Capsule> = capsules(&Snapshot::take(app.world())).collect();
    println!("{} capsules; the first, from the ground up:", wood.len());
    for piece in wood.iter().take(5) {
        // Avian's and Rapier's capsules lie along y, about their middle.
        let axis = piece.to - piece.from;
        let middle = Isometry3d::new(
            piece.from.midpoint(piece.to),
            Quat::from_rotation_arc(Vec3::Y, axis.normalize_or(Vec3::Y)),
        );
        let (at, half) = (middle.translation, 0.5 * axis.length());
        println!(
            "  organ {:3} at {at:.2}, half length {half:.3} m, radius {:.4} m",
            piece.organ, piece.radius
        );
    }

    println!("\nballs dropped from above, from west to east:");
    for x in -4..=4 {
        let x = 0.5 * x as f32;
        match fall(&wood, Vec3::new(x, 20.0, 0.0)) {
            Some((piece, y)) => println!("  x {x:5.2} m: hits organ {} at {y:.2} m", piece.organ),
            None => println!("  x {x:5.2} m: falls to the ground"),
        }
    }
    Ok(())
}

/// Lets a ball fall from a point: the first piece of wood it touches, and how high it is then.
fn fall(wood: &[Capsule], from: Vec3) -> Option<(&Capsule, f32)> {
    let mut at = from;
    while at.y > 0.0 {
        // As far as it can fall without passing through anything.
        let (near, gap) =
            wood.iter().map(|piece| (piece, gap(piece, at))).min_by(|a, b| a.1.total_cmp(&b.1))?;
        if gap <= 1e-3 {
            return Some((near, at.y));
        }
        at.y -= gap;
    }
    None
}

/// From the ball at a point to a capsule, metres; below 0 they overlap.
fn gap(piece: &Capsule, at: Vec3) -> f32 {
    let axis = piece.to - piece.from;
    let along = ((at - piece.from).dot(axis) / axis.length_squared().max(1e-12)).clamp(0.0, 1.0);
    at.distance(piece.from + axis * along) - piece.radius - BALL
}
