//! Light of lamps and sun, by their own shadow rays.
//!
//! A lamp 0.2 m wide and 3 m away is smaller than a texel of any cube map in use. So lamps and sun are not
//! looked for in texels: rays go to fixed points on them (`LK-13`). The points are spread evenly over the
//! disc a lamp or the sun shows: point i of n lies `(i + 1/2) / n` of the disc's solid angle from its middle,
//! turned by i golden angles.

use std::f32::consts::{PI, TAU};

use bevy::math::{Vec3, ops};

use super::scene::{StandingLamp, SunLight};
use super::trace::Tracer;

/// How many points of a lamp and of the sun are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LightRays {
    /// Points on each lamp.
    pub lamp: u32,
    /// Points on the sun.
    pub sun: u32,
}

impl LightRays {
    /// For what an organ lives by.
    pub const FINE: Self = Self { lamp: 16, sun: 4 };
    /// For comparing the many places a bud could grow to.
    pub const COARSE: Self = Self { lamp: 4, sun: 1 };
}

/// 1 - cosine of the sun's angular radius, 0.266 degrees.
const SUN_HEIGHT: f32 = 1.08e-5;
/// Turn from one point to the next, radians.
pub(crate) const GOLDEN_ANGLE: f32 = 2.399_963_1;

/// Light from lamps and sun on a point, as a share of a full open sky's; not saturated.
///
/// A lamp gives its strength x the share of it that is visible x the solid angle it fills / 4 pi, and its
/// whole strength to a point inside it. The sun gives its strength x the share that is visible.
pub fn direct_light(tracer: &Tracer, point: Vec3, blind: &[u32], rays: LightRays) -> f32 {
    let scene = tracer.scene();
    let lamps: f32 = scene.lamps.iter().map(|lamp| lamp_light(tracer, lamp, point, blind, rays.lamp)).sum();
    lamps + scene.sun.as_ref().map_or(0.0, |sun| sun_light(tracer, sun, point, blind, rays.sun))
}

/// Solid angle of a ball of radius `radius` at `distance` from a point, steradians; all of 4 pi inside it.
pub fn ball_solid_angle(radius: f32, distance: f32) -> f32 {
    if distance <= radius {
        return 4.0 * PI;
    }
    let x = (radius / distance) * (radius / distance);
    // 1 - sqrt(1 - x) without cancellation.
    TAU * x / (1.0 + (1.0 - x).sqrt())
}

fn lamp_light(tracer: &Tracer, standing: &StandingLamp, point: Vec3, blind: &[u32], rays: u32) -> f32 {
    let lamp = standing.lamp;
    let to_lamp = standing.position - point;
    let distance = to_lamp.length();
    let shines = lamp.on && lamp.strength > 0.0 && lamp.radius > 0.0 && distance.is_finite();
    if !shines {
        return 0.0;
    }
    if distance <= lamp.radius {
        return lamp.strength;
    }
    let solid_angle = ball_solid_angle(lamp.radius, distance);
    let visible = visible_share(rays, to_lamp / distance, solid_angle / TAU, |ray, cosine| {
        // Where the ray meets the ball.
        let along = distance * cosine;
        let inside = (lamp.radius * lamp.radius - distance * distance + along * along).max(0.0).sqrt();
        !tracer.occluded(point, ray, along - inside, blind)
    });
    lamp.strength * visible * solid_angle / (4.0 * PI)
}

fn sun_light(tracer: &Tracer, sun: &SunLight, point: Vec3, blind: &[u32], rays: u32) -> f32 {
    let towards = sun.direction.normalize_or_zero();
    if towards == Vec3::ZERO || sun.strength <= 0.0 {
        return 0.0;
    }
    sun.strength
        * visible_share(rays, towards, SUN_HEIGHT, |ray, _| {
            !tracer.occluded(point, ray, f32::INFINITY, blind)
        })
}

/// Share of `n` rays to a disc about `axis` that pass; `height` is 1 - cosine of its angular radius.
fn visible_share(n: u32, axis: Vec3, height: f32, passes: impl Fn(Vec3, f32) -> bool) -> f32 {
    let (right, up) = axis.any_orthonormal_pair();
    let passed = (0..n)
        .filter(|&i| {
            let down = height * (i as f32 + 0.5) / n as f32;
            let cosine = 1.0 - down;
            let sine = (down * (2.0 - down)).sqrt();
            let (y, x) = ops::sin_cos(i as f32 * GOLDEN_ANGLE);
            passes(axis * cosine + (right * x + up * y) * sine, cosine)
        })
        .count();
    passed as f32 / n as f32
}
