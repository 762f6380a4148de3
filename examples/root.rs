//! A root laid level finds its way down by its surface alone; then its pot is turned, and it finds it again (`ST-4`).
//! Beside it Barlow's root, whose flanks are told how to grow (`ST-1`).
//!
//! ```sh
//! cargo run --no-default-features --example root -- out    # writes out/root.png
//! ```

use std::path::PathBuf;

use bevy::math::{Quat, Vec2, Vec3, Vec3Swizzles};
use burgeon::export::{canvas, film, plot::Plot};
use burgeon::tropism::relel::{BentRoot, Relel, bend};
use burgeon::tropism::root::{AuxinRoot, RootSettings};

const RIGHT_ANGLE: f32 = core::f32::consts::FRAC_PI_2;

/// Up one flank of a root and down the other.
fn outline(root: &AuxinRoot) -> impl Iterator<Item = Vec2> {
    let poses = root.assemble();
    let flank = |side: f32| -> Vec<Vec2> {
        let across = |k: usize| poses[k].rotation * Vec3::X * (side * root.segments[k].radius);
        (0..root.segments.len()).map(|k| (poses[k].position + across(k)).xy()).collect()
    };
    flank(1.0).into_iter().chain(flank(-1.0).into_iter().rev())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // It sets out along +x. Nothing below says that it bends, or where to.
    let mut root = AuxinRoot::new(RootSettings::default(), Quat::from_rotation_z(-RIGHT_ANGLE))?;
    let mut grown = Plot::of_shapes("auxin sinks, and slows the growth of the lower flank", "mm", "mm");
    for (pot, name) in ["laid level", "turned by 90 degrees"].into_iter().enumerate() {
        if pot > 0 {
            root.turn(Quat::from_rotation_z(RIGHT_ANGLE));
        }
        println!("{name}: the tip is {:.0} degrees off gravity", root.tip_angle().to_degrees());
        for (more, hours) in [(0.0, 0), (10.0, 10), (30.0, 40)] {
            root.grow(more);
            let aside = Vec2::X * 24.0 * pot as f32;
            grown.line(format!("{name}, {hours} h on"), outline(&root).map(|point| point + aside));
        }
        println!("40 hours later {:.1} degrees", root.tip_angle().to_degrees());
    }

    let zone = |most| Relel { most, centre: 3.0, spread: 1.0 };
    let mut told = Plot::of_shapes("the upper flank grows twice as fast", "diameters", "diameters");
    for time in [0.126, 0.380, 0.633] {
        let BentRoot { tip_angle, upper, lower, .. } = bend(zone(2.0), zone(1.0), time, 9.0, 1.0, 900);
        told.line(
            format!("{:.1} degrees", tip_angle.to_degrees()),
            upper.into_iter().chain(lower.into_iter().rev()),
        );
    }

    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    std::fs::create_dir_all(&out)?;
    let file = out.join("root.png");
    film::save_png(&file, &canvas::side_by_side(&[grown.draw(760, 460)?, told.draw(560, 460)?], 6))?;
    println!("picture: {}", file.display());
    Ok(())
}
