//! Figure 14: palms on a beach (`ST-12`).

use core::ops::RangeInclusive;

use bevy::math::{Quat, Vec3, ops};
use bevy::prelude::Transform;

use super::plants::{daylight, looks, ratio, row, same_species};
use super::{csv, models};
use crate::assets::Library;
use crate::environment::Shore;
use crate::environment::trace::Tracer;
use crate::environment::workers::Workers;
use crate::export::picture::{Bounds, Camera, PictureSettings, render};
use crate::reproduce::{Claim, Findings, ReproduceError};
use crate::tropism::vary::{Variation, vary};

/// Figure 14: a grove of palms from one base model, three of them tilted by their target.
pub fn palms(
    seeds: RangeInclusive<u64>,
    library: &Library,
    size: PictureSettings,
    workers: &Workers,
) -> Result<Findings, ReproduceError> {
    const PLACES: [(f32, f32, f32); 13] = [
        (-9.6, -1.5, 0.95),
        (-7.9, 1.0, 1.1),
        (-6.8, -3.4, 0.85),
        (-5.2, -0.4, 1.05),
        (-3.9, 1.9, 0.8),
        (-0.9, 0.6, 1.1),
        (0.3, -0.6, 0.95),
        (1.4, 1.0, 1.0),
        (4.6, -1.2, 1.1),
        (5.9, 1.4, 0.9),
        (7.2, -3.0, 1.0),
        (8.3, 0.2, 1.05),
        (9.8, -1.8, 0.85),
    ];
    const TILTED: [usize; 3] = [5, 6, 7];
    const TILT_DEG: [f32; 3] = [-26.0, 20.0, 33.0];
    let model = models::palm();
    let variation = Variation {
        control: ratio(0.85, 12)?,
        sensing_error: 2_f32.to_radians(),
        disturbance: 1.8_f32.to_radians(),
        sub_step: Some(0.1),
        relative_to_parent: 0.5,
        ..Variation::default()
    };
    let mut scene = daylight();
    let mut rows = Vec::new();
    let mut lines: Vec<Vec<Vec3>> = Vec::new();
    let mut lean = Vec::new();
    let mut grown = Vec::new();
    for (n, (x, z, scale)) in PLACES.into_iter().enumerate() {
        let tilt = TILTED.iter().position(|t| *t == n).map_or(0.0, |k| TILT_DEG[k]);
        // It sets out upright; only the course it tries to keep is tilted.
        let base = model.skeleton.moved(Transform::from_rotation(Quat::from_rotation_y(1.9 * n as f32)));
        let leaning = Variation { lean: Quat::from_rotation_z(-tilt.to_radians()), ..variation };
        let mut palm = vary(&base, &leaning, seeds.start() + n as u64)?;
        lines.push(palm.segments.iter().filter(|s| s.order == 0).map(|s| s.tip()).collect());
        let top = lines[n].last().copied().unwrap_or(Vec3::Y);
        lean.push((tilt, ops::atan2(top.x, top.y).to_degrees()));
        rows.push([n as f32, x, z, tilt, lean[n].1, palm.height()]);
        grown.push(palm.clone());
        for stem in &mut palm.segments {
            stem.pose.position = stem.pose.position * scale + Vec3::new(x, 0.0, z);
            stem.length *= scale;
            stem.radius *= scale;
        }
        model.add_to(&palm, &mut scene, 0);
    }
    let mut nearest = f32::INFINITY;
    for (k, one) in lines.iter().enumerate() {
        for other in &lines[k + 1..] {
            let apart = one.iter().zip(other).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
            nearest = nearest.min(apart);
        }
    }
    let upright = lean.iter().filter(|l| l.0 == 0.0).map(|l| l.1.abs()).fold(0.0, f32::max);
    let tilted: Vec<String> =
        lean.iter().filter(|l| l.0 != 0.0).map(|l| format!("{:.0} for {:.0}", l.1, l.0)).collect();
    let claims = vec![
        Claim {
            row: "ST-12",
            paper: "a grove of palms from one base model, none exactly alike",
            measured: format!(
                "{} palms; the stems of the two most alike part by {nearest:.2} m",
                PLACES.len()
            ),
            holds: nearest > 0.1,
        },
        Claim {
            row: "ST-12",
            paper: "three palms are tilted by their desired direction",
            measured: format!("leaning by {} degrees; the others by at most {upright:.0}", tilted.join(", ")),
            holds: lean.iter().all(|(tilt, seen)| (seen - tilt).abs() < 6.0_f32.max(tilt.abs() / 3.0)),
        },
        // Those that lean over by a third of a right angle lose a seventh of their height by that alone.
        same_species(&model.skeleton, &grown.iter().collect::<Vec<_>>(), 0.2),
    ];
    scene.shore = Some(Shore { azimuth_deg: 180.0, distance_m: 11.0 });
    let palette = looks(&library.species("palm")?, 0xFFFFFF);
    let wide = PictureSettings { width: size.width * 4, height: size.height * 8 / 5, ..size };
    let camera = Camera::framing(&Bounds::of(&scene), 4.0, 5.0, wide.aspect());
    let picture = render(&Tracer::build(&scene), &camera, &palette, wide, workers);
    let header = ["palm", "x_m", "z_m", "target_tilt_deg", "lean_deg", "height_m"];
    let base = row(&[(&model, &model.skeleton, "base model".into())], palette, 4.0, size, workers);
    Ok(Findings {
        claims,
        picture,
        tables: vec![("palms.csv".into(), csv(header, rows))],
        pictures: base.into_iter().map(|image| ("base.png".into(), image)).collect(),
    })
}
