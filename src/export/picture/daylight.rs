//! The light of a picture: sky, sun or key light, exposure, film curve.

use bevy::math::ops;
use bevy::prelude::*;

use super::noise::{rough, smooth};
use crate::environment::Scene;
use crate::shape::noise::srgb;

/// Share of the sky's light that a leaf of an average place in a crown gets, on both sides together.
const IN_CROWN: f32 = 0.8;

/// The picture's one hard light: the sun, or a soft light that stands in for it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Key {
    /// Towards the light, unit vector.
    pub(super) direction: Vec3,
    /// What a white surface that faces it gives off.
    pub(super) color: Vec3,
    /// Radius of its disc as seen from one metre, metres: how soft shadows are.
    pub(super) spread: f32,
}

/// Everything about light that is the same for the whole picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Daylight {
    pub(super) key: Option<Key>,
    /// Light that the ground throws back up.
    pub(super) from_ground: Vec3,
    /// Light left where no sky is seen.
    pub(super) dim: Vec3,
    /// Sky light on a leaf of an average place in a crown, on both sides together.
    pub(super) in_crown: Vec3,
    zenith: Vec3,
    middle: Vec3,
    horizon: Vec3,
    tint: Vec3,
    exposure: f32,
}

impl Daylight {
    /// The light of a scene seen along `forward`, `right`.
    pub(super) fn of(scene: &Scene, ground: Vec3, forward: Vec3, right: Vec3) -> Self {
        let sky = scene.sky.strength.max(0.0);
        let sun = scene.sun.map_or(0.0, |sun| sun.strength.max(0.0));
        let dusk = 1.0 - smooth(0.1, 0.6, sky + 0.6 * sun);
        let tint = Vec3::new(0.93, 0.98, 1.08).lerp(Vec3::new(0.74, 0.84, 1.2), dusk);

        let key = match scene.sun {
            Some(light) if light.direction.y > 0.0 && sun > 0.0 => {
                let low = 1.0 - smooth(0.0, 0.45, light.direction.y);
                let warm = Vec3::new(1.0, 0.92, 0.78).lerp(Vec3::new(1.0, 0.66, 0.38), low);
                Some(Key { direction: light.direction, color: warm * (2.8 * sun), spread: 0.012 })
            }
            Some(_) => None,
            None => {
                let level = Vec3::new(-forward.x, 0.0, -forward.z).normalize_or(Vec3::Z);
                let direction = (level * 0.75 - right * 0.85 + Vec3::Y * 1.05).normalize();
                Some(Key {
                    direction,
                    color: Vec3::new(1.0, 0.95, 0.86) * (1.35 * sky * (1.0 - 0.55 * dusk)),
                    spread: 0.09,
                })
            }
        };
        let lit = key.map_or(Vec3::ZERO, |key| key.color * key.direction.y.max(0.0));
        let night = Vec3::new(0.006, 0.009, 0.02);
        let ambient = tint * sky + night;

        // Lamps count by what they give at ten radii, wherever they stand: moving one must not flicker.
        let lamps =
            scene.lamps.iter().filter(|s| s.lamp.on).map(|s| s.lamp.strength.max(0.0) * 0.01).sum::<f32>();
        let level = 0.8 * sky + 0.35 * lit.element_sum() + 0.08 * lamps.min(4.0) + 0.01;
        // The eye adapts, but not all the way: dusk stays darker than noon.
        let exposure = 1.0 / ops::powf(level, 0.68);

        let day = [Vec3::new(0.17, 0.40, 0.84), Vec3::new(0.50, 0.73, 0.98), Vec3::new(0.97, 0.99, 1.0)];
        let late = [Vec3::new(0.13, 0.21, 0.50), Vec3::new(0.42, 0.38, 0.58), Vec3::new(1.30, 0.66, 0.36)];
        let shade = |i: usize| day[i].lerp(late[i], dusk) * (sky * (1.75 - 0.35 * dusk)) + night * 2.0;
        Self {
            key,
            from_ground: ground * (ambient * 0.8 + lit * 0.7),
            dim: ambient * 0.10,
            in_crown: ambient * IN_CROWN,
            zenith: shade(0),
            middle: shade(1),
            horizon: shade(2),
            tint,
            exposure,
        }
    }

    /// Light that falls on things from direction `d`, a unit vector.
    pub(super) fn sky_light(&self, scene: &Scene, d: Vec3) -> Vec3 {
        self.tint * scene.sky.radiance(d).max(0.0)
    }

    /// What stands behind everything in direction `d`, a unit vector: two pale rows of hills, then sky, which
    /// is taken along `smooth_d` to be free of grain.
    pub(super) fn distance(&self, d: Vec3, smooth_d: Vec3) -> Vec3 {
        let round = Vec3::new(d.x, 0.0, d.z).normalize_or_zero();
        let near = 0.004 + 0.020 * rough(round * 9.0 + Vec3::splat(3.0), 4);
        let far = 0.012 + 0.034 * rough(round * 5.0 + Vec3::splat(40.0), 3);
        let horizon = self.horizon.lerp(self.middle, 0.35);
        if d.y < near {
            horizon * Vec3::new(0.50, 0.60, 0.58)
        } else if d.y < far {
            horizon * Vec3::new(0.70, 0.79, 0.84)
        } else {
            self.backdrop(smooth_d)
        }
    }

    /// The far edge of the land.
    pub(super) fn haze(&self) -> Vec3 {
        self.horizon.lerp(self.middle, 0.35) * Vec3::new(0.58, 0.66, 0.56)
    }

    /// The clear sky as the picture shows it in direction `d`, a unit vector.
    pub(super) fn backdrop(&self, d: Vec3) -> Vec3 {
        let h = d.y.max(0.0);
        let low = self.horizon.lerp(self.middle, smooth(-0.04, 0.20, h));
        low.lerp(self.zenith, smooth(0.04, 0.75, h))
    }

    /// From light to what film shows of it: linear RGB 0..1, shoulders rounded.
    pub(super) fn develop(&self, light: Vec3) -> Vec3 {
        let x = light * self.exposure * 0.62;
        // A toe for depth, a shoulder that reaches white softly: the usual rational fit of a film's curve.
        let curve = |x: f32| {
            let x = x.max(0.0);
            (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).min(1.0)
        };
        Vec3::new(curve(x.x), curve(x.y), curve(x.z))
    }
}

/// Linear RGB 0..1 as a pixel.
pub(super) fn encode(linear: Vec3) -> [u8; 3] {
    linear.to_array().map(|c| (srgb(c) * 255.0 + 0.5) as u8)
}
