//! Tufts of grass about the middle of the ground: blades in one mesh, thinner outwards.

use bevy::asset::RenderAssetUsages;
use bevy::math::ops;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;

use crate::chance::mix;
use crate::shape::noise::periodic;

/// Blades of a patch.
const BLADES: u64 = 40_000;
/// How far from the middle they stand at most, metres.
pub(super) const REACH: f32 = 26.0;

/// A number in 0..1.
fn unit(blade: u64, what: u64) -> f32 {
    (mix(mix(blade) ^ what) >> 40) as f32 / (1u64 << 24) as f32
}

/// A patch of grass about the origin.
pub(super) fn mesh() -> Mesh {
    let (mut positions, mut normals, mut colors, mut indices) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for blade in 0..BLADES {
        // Denser towards the middle.
        let out = REACH * unit(blade, 1) * unit(blade, 2).sqrt().max(0.25);
        let turn = unit(blade, 3) * core::f32::consts::TAU;
        let (sin, cos) = ops::sin_cos(turn);
        let mut foot = Vec3::new(out * cos, 0.0, out * sin);
        // In tufts rather than evenly.
        let tuft = |seed: u32| periodic(foot.x / 64.0, foot.z / 64.0, [180, 180], seed) - 0.5;
        foot += Vec3::new(tuft(81), 0.0, tuft(82)) * 0.5;
        let lush = periodic(foot.x / 64.0, foot.z / 64.0, [60, 60], 83);
        if lush < 0.25 {
            continue;
        }
        let height = (0.035 + 0.12 * unit(blade, 4) * unit(blade, 5)) * (0.5 + lush);
        let (lean_sin, lean_cos) = ops::sin_cos(unit(blade, 6) * core::f32::consts::TAU);
        let lean = Vec3::new(lean_cos, 0.0, lean_sin) * (0.25 + 0.6 * unit(blade, 7)) * height;
        let side = Vec3::new(-lean_sin, 0.0, lean_cos) * (0.0028 + 0.0022 * unit(blade, 8));
        let middle = foot + lean * 0.3 + Vec3::Y * height * 0.62;
        let tip = foot + lean + Vec3::Y * height;
        let fresh = 0.45 + 0.55 * unit(blade, 9) * (0.4 + lush);
        let dry = Vec3::new(0.30, 0.28, 0.11);
        let green = Vec3::new(0.13, 0.24, 0.045);
        let color = dry.lerp(green, fresh.min(1.0)) * (0.8 + 0.5 * unit(blade, 10));
        let first = positions.len() as u32;
        for (at, light) in [
            (foot - side, 0.35),
            (foot + side, 0.35),
            (middle - side, 0.9),
            (middle + side, 0.9),
            (tip, 1.25),
        ] {
            positions.push(at.to_array());
            normals.push((Vec3::Y + 0.35 * lean.normalize_or_zero()).normalize().to_array());
            colors.push((color * light).extend(1.0).to_array());
        }
        indices.extend([0, 1, 2, 1, 3, 2, 2, 3, 4].map(|k| first + k));
    }
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::RENDER_WORLD)
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
        .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors)
        .with_inserted_indices(Indices::U32(indices))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grass_stands_on_the_ground() {
        let mesh = mesh();
        let Some(bevy::mesh::VertexAttributeValues::Float32x3(p)) = mesh.attribute(Mesh::ATTRIBUTE_POSITION)
        else {
            panic!("no positions")
        };
        assert!(p.len() > 50_000);
        assert!(p.iter().all(|p| p[1] >= 0.0 && p[1] < 0.25));
    }
}
