//! The light of the open: what sky and sun come to in photometric units, and what a camera makes of it.

use bevy::asset::RenderAssetUsages;
use bevy::math::ops;
use bevy::prelude::*;
use bevy::render::render_resource::{
    Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension,
};
use half::f16;

use crate::environment::{Lamp, Sky, Sun};
use crate::shape::noise::{periodic, smooth};

/// The light of sky and sun, a resource kept in line with [`Sky`], [`Sun`] and [`Lamp`]s by
/// [`SceneryPlugin`](super::SceneryPlugin).
///
/// Radiance 1 of a sky is [`Daylight::FULL_SKY`] on screen, and lamps and sun are in proportion, as plants sense
/// them.
#[derive(Resource, Debug, Clone, Copy, PartialEq)]
pub struct Daylight {
    /// Unit vector towards the sun or what stands in for it.
    pub key_direction: Vec3,
    /// Colour of its light.
    pub key_color: Color,
    /// Light it gives a surface that faces it, lux.
    pub key_lux: f32,
    /// Light from above, the side and below, as multiples of a full sky's.
    pub ambient: [LinearRgba; 3],
    /// The sky at the zenith, halfway and at the horizon, as multiples of a full sky's.
    pub sky: [LinearRgba; 3],
    /// What the far land fades into, cd/m2.
    pub haze: LinearRgba,
    /// Exposure value of a camera at ISO 100.
    pub ev100: f32,
    /// Whether the sun itself is in the sky.
    pub sun_is_up: bool,
}

impl Default for Daylight {
    fn default() -> Self {
        Self::of(&Sky::default(), None, &[])
    }
}

impl Daylight {
    /// Luminance of a full sky, cd/m2.
    pub const FULL_SKY: f32 = 3000.0;

    /// The light of a sky, a sun (towards it, strength) and lamps.
    pub fn of(sky: &Sky, sun: Option<(Vec3, f32)>, lamps: &[Lamp]) -> Self {
        let strength = sky.strength.max(0.0);
        let sunlight = sun.map_or(0.0, |(_, sun)| sun.max(0.0));
        let dusk = 1.0 - smooth(0.1, 0.6, strength + 0.6 * sunlight);
        let tint = Vec3::new(0.93, 0.98, 1.08).lerp(Vec3::new(0.74, 0.84, 1.2), dusk);
        let (direction, color, key, sun_is_up) = match sun {
            Some((direction, _)) if direction.y > 0.0 && sunlight > 0.0 => {
                let low = 1.0 - smooth(0.0, 0.45, direction.y);
                let warm = Vec3::new(1.0, 0.92, 0.78).lerp(Vec3::new(1.0, 0.66, 0.38), low);
                (direction, warm, 2.8 * sunlight, true)
            }
            Some((direction, _)) => {
                (direction.with_y(direction.y.max(0.05)).normalize(), Vec3::ONE, 0.0, false)
            }
            None => {
                let soft = Vec3::new(0.55, 0.75, 0.62).normalize();
                (soft, Vec3::new(1.0, 0.95, 0.86), 2.3 * strength * (1.0 - 0.65 * dusk), false)
            }
        };
        let night = Vec3::new(0.006, 0.009, 0.02);
        // In dusk the eye opens up the shadows.
        let ambient = tint * (strength * (0.85 + 0.75 * dusk)) + night;
        let meadow = Vec3::new(0.13, 0.17, 0.06);
        let bounced = meadow * (ambient * 0.8 + color * key * direction.y.max(0.0) * 0.35);
        let (above, beside) = (ambient * 1.05, ambient * 0.72 + bounced * 0.25);

        let day = [Vec3::new(0.10, 0.30, 0.78), Vec3::new(0.36, 0.62, 0.98), Vec3::new(0.86, 0.95, 1.02)];
        let late = [Vec3::new(0.13, 0.21, 0.50), Vec3::new(0.42, 0.38, 0.58), Vec3::new(1.30, 0.66, 0.36)];
        let bright = strength * (2.0 - 1.1 * dusk);
        let shade = |i: usize| day[i].lerp(late[i], dusk) * bright + night * 2.0;
        let haze = (shade(2).lerp(shade(1), 0.35) * Vec3::new(0.34, 0.44, 0.40)) * Self::FULL_SKY;

        // Lamps count by what they give at ten radii, wherever they stand: moving one must not flicker.
        let lit: f32 = lamps.iter().filter(|l| l.on).map(|l| l.strength.max(0.0) * 0.01).sum();
        let level =
            0.8 * strength + 0.35 * (color * key).element_sum() * direction.y + 0.08 * lit.min(4.0) + 0.01;
        // The eye adapts, but not all the way: dusk stays darker than noon.
        let exposure = 1.3 / ops::powf(level, 0.68);
        let ev100 = ops::log2(Self::FULL_SKY / (1.2 * exposure));
        let linear = |v: Vec3| LinearRgba::rgb(v.x, v.y, v.z);
        Self {
            key_direction: direction,
            key_color: Color::LinearRgba(linear(color)),
            key_lux: key * Self::FULL_SKY * core::f32::consts::PI,
            ambient: [linear(above), linear(beside), linear(bounced)],
            sky: [shade(0), shade(1), shade(2)].map(linear),
            haze: linear(haze),
            ev100,
            sun_is_up,
        }
    }

    /// Brightness on screen of a cd/m2.
    pub fn exposure(&self) -> f32 {
        ops::exp2(-self.ev100) / 1.2
    }

    /// Luminous flux of a lamp, lumen: what makes it as bright beside the sky as plants sense it.
    pub fn lumens(lamp: &Lamp) -> f32 {
        let intensity =
            Self::FULL_SKY * lamp.strength.max(0.0) * core::f32::consts::PI * lamp.radius * lamp.radius;
        4.0 * core::f32::consts::PI * intensity
    }

    /// The sky in a direction, unit vector, as a multiple of a full sky's: gradient, thin clouds, hills, sun.
    fn seen(&self, d: Vec3) -> Vec3 {
        let [zenith, middle, horizon] = self.sky.map(|c| Vec3::new(c.red, c.green, c.blue));
        let h = d.y.max(0.0);
        let low = horizon.lerp(middle, smooth(-0.04, 0.22, h));
        let mut color = low.lerp(zenith, smooth(0.04, 0.75, h));
        let around = ops::atan2(d.z, d.x) / core::f32::consts::TAU + 0.5;
        // Thin clouds on a flat layer, drawn out by perspective, lost in the haze.
        if d.y > 0.02 {
            let at = Vec2::new(d.x, d.z) / (d.y + 0.12) * 0.11;
            let puff = 0.6 * periodic(at.x, at.y * 1.7, [5, 5], 21)
                + 0.3 * periodic(at.x, at.y, [13, 13], 22)
                + 0.15 * periodic(at.x, at.y, [31, 31], 23);
            let cover = smooth(0.48, 0.78, puff) * smooth(0.03, 0.2, d.y) * 0.75;
            let lit = horizon.max(middle) * 1.04;
            color = color.lerp(lit, cover);
        }
        if self.sun_is_up {
            let near = d.dot(self.key_direction).max(0.0);
            let glow = Vec3::new(1.0, 0.86, 0.62) * horizon.max_element();
            color += glow * (0.35 * ops::powf(near, 24.0) + 1.2 * ops::powf(near, 400.0));
            if near > 0.99985 {
                color = Vec3::splat(40.0);
            }
        }
        let wave = |cells: u32, seed: u32| {
            0.6 * periodic(around, 0.3, [cells, 1], seed)
                + 0.4 * periodic(around, 0.7, [cells * 3, 1], seed + 1)
        };
        let haze = Vec3::new(self.haze.red, self.haze.green, self.haze.blue) / Self::FULL_SKY;
        let edge = |top: f32| smooth(top - 0.006, top + 0.003, d.y);
        let far = haze.lerp(low, 0.45);
        color = far.lerp(color, edge(0.014 + 0.050 * wave(7, 31)));
        haze.lerp(color, edge(0.002 + 0.026 * wave(11, 41)))
    }

    /// The sky as a cube map.
    pub(super) fn sky_image(&self) -> Image {
        const SIDE: usize = 256;
        // Right, left, up, down, front and back, as graphics cards order them: forward, right and down in each.
        let faces = [
            (Vec3::X, Vec3::NEG_Z, Vec3::NEG_Y),
            (Vec3::NEG_X, Vec3::Z, Vec3::NEG_Y),
            (Vec3::Y, Vec3::X, Vec3::Z),
            (Vec3::NEG_Y, Vec3::X, Vec3::NEG_Z),
            (Vec3::Z, Vec3::X, Vec3::NEG_Y),
            (Vec3::NEG_Z, Vec3::NEG_X, Vec3::NEG_Y),
        ];
        let mut bytes = Vec::with_capacity(6 * SIDE * SIDE * 8);
        for (forward, right, down) in faces {
            for k in 0..SIDE * SIDE {
                let at = |k: usize| (k as f32 + 0.5) / SIDE as f32 * 2.0 - 1.0;
                let d = (forward + right * at(k % SIDE) + down * at(k / SIDE)).normalize();
                // A cube map is seen from inside, in a left-handed frame.
                let color = self.seen(d.with_z(-d.z));
                for part in [color.x, color.y, color.z, 1.0] {
                    bytes.extend(f16::from_f32(part).to_le_bytes());
                }
            }
        }
        Image {
            texture_view_descriptor: Some(TextureViewDescriptor {
                dimension: Some(TextureViewDimension::Cube),
                ..default()
            }),
            ..Image::new(
                Extent3d { width: SIDE as u32, height: SIDE as u32, depth_or_array_layers: 6 },
                TextureDimension::D2,
                bytes,
                TextureFormat::Rgba16Float,
                RenderAssetUsages::RENDER_WORLD,
            )
        }
    }
}

/// Keeps [`Daylight`] in line with what shines.
pub(super) fn follow_light(
    sky: Res<Sky>,
    suns: Query<(&Sun, &Transform)>,
    lamps: Query<&Lamp>,
    mut daylight: ResMut<Daylight>,
) {
    let sun =
        suns.iter().map(|(sun, at)| (at.rotation * Vec3::Z, sun.strength)).max_by(|a, b| a.1.total_cmp(&b.1));
    let lamps: Vec<Lamp> = lamps.iter().copied().collect();
    daylight.set_if_neq(Daylight::of(&sky, sun, &lamps));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dusk_is_darker_than_day_on_screen_and_brighter_than_in_the_world() {
        let day = Daylight::of(&Sky::default(), None, &[]);
        let dusk = Daylight::of(&Sky { strength: 0.15, ..default() }, None, &[]);
        let shown = |light: &Daylight| {
            let key = light.key_lux / core::f32::consts::PI * light.key_direction.y;
            (light.ambient[0].green * Daylight::FULL_SKY + key) * light.exposure()
        };
        assert!(shown(&dusk) < 0.8 * shown(&day));
        assert!(shown(&dusk) > 0.2 * shown(&day));
        assert!(dusk.ev100 < day.ev100);
    }

    #[test]
    fn a_lamp_gives_what_plants_sense_of_it() {
        let lamp = Lamp::new(100.0, 0.2);
        // At ten radii a lamp of radiance 100 gives as much as a full sky.
        let lux = Daylight::lumens(&lamp) / (4.0 * core::f32::consts::PI * 4.0);
        assert!((lux / (Daylight::FULL_SKY * core::f32::consts::PI) - 1.0).abs() < 1e-4);
    }
}
