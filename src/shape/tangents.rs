//! Tangents, by which a normal texture knows which way it lies on a surface.

use bevy::prelude::*;

use super::Surface;

/// A tangent for each vertex as glTF has it: the way in which u rises (unit vector across the normal), and the sign
/// with which normal x tangent points against v.
pub fn tangents(surface: &Surface) -> Vec<[f32; 4]> {
    let mut along = vec![(Vec3::ZERO, Vec3::ZERO); surface.positions.len()];
    for corners in surface.indices.chunks_exact(3) {
        let [a, b, c] = [corners[0], corners[1], corners[2]].map(|i| i as usize);
        let at = |i: usize| Vec3::from(surface.positions[i]);
        let uv = |i: usize| Vec2::from(surface.uvs[i]);
        let (edge, other) = (at(b) - at(a), at(c) - at(a));
        let (d, e) = (uv(b) - uv(a), uv(c) - uv(a));
        let sign = d.perp_dot(e).signum();
        let u = (edge * e.y - other * d.y) * sign;
        let v = (other * d.x - edge * e.x) * sign;
        for i in [a, b, c] {
            along[i].0 += u;
            along[i].1 += v;
        }
    }
    along
        .into_iter()
        .zip(&surface.normals)
        .map(|((u, v), normal)| {
            let normal = Vec3::from(*normal);
            let across = (u - normal * normal.dot(u)).try_normalize();
            let across = across.unwrap_or_else(|| normal.any_orthonormal_vector());
            let sign = if normal.cross(across).dot(v) > 0.0 { -1.0 } else { 1.0 };
            across.extend(sign).to_array()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Place;

    #[test]
    fn tangents_follow_u_and_tell_where_v_goes() {
        for (v, sign) in [(1.0, -1.0), (-1.0, 1.0)] {
            let mut surface = Surface::default();
            for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)] {
                surface.vertex(Vec3::new(x, y, 0.0), Vec3::Z, [x, v * y], Place::default());
            }
            surface.triangle(0, 1, 2);
            assert_eq!(tangents(&surface), [[1.0, 0.0, 0.0, sign]; 3]);
        }
    }

    #[test]
    fn a_surface_without_extent_has_tangents_all_the_same() {
        let mut surface = Surface::default();
        for _ in 0..3 {
            surface.vertex(Vec3::ONE, Vec3::Y, [0.5, 0.5], Place::default());
        }
        surface.triangle(0, 1, 2);
        for [x, y, z, w] in tangents(&surface) {
            assert!((Vec3::new(x, y, z).length() - 1.0).abs() < 1e-6 && y.abs() < 1e-6 && w.abs() == 1.0);
        }
    }
}
