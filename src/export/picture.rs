//! Pictures without a GPU: the scene plants sense, seen with the same rays.
//!
//! Sun with shadow, sky light that finds its way into crowns, lamps with their glow, bark, translucent leaves,
//! masonry and meadow. Every number a pixel depends on comes from the scene and the pixel's place, so pictures
//! are the same bit for bit on any number of threads, and the grain of a film stands still.
//!
//! A scene without a sun has shadowless light; a soft light from the upper left of the camera, in proportion
//! to the sky, is added in pictures alone so that things have form.

mod camera;
mod cross;
mod daylight;
mod look;
mod noise;
mod photograph;
mod shore;
mod surface;
mod wood;

use bevy::math::ops;
use bevy::prelude::*;
use image::{Rgb, RgbImage};

use crate::environment::Scene;
use crate::environment::trace::{Hit, Seen, Tracer};
use crate::environment::workers::Workers;
use crate::shape::shore::SAND;
use daylight::{Daylight, encode};
use noise::{fract, hash, mix, smooth, unit};
use surface::{Surface, View, around};
use wood::SeenWood;

pub use camera::{Bounds, Camera};
pub use cross::{CubeMapView, cube_map_picture};
pub use look::{Palette, PlantLook};
pub use photograph::photograph;

/// How much light the air about a lamp scatters.
const AIR: f32 = 0.007;

/// Size and quality of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PictureSettings {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Samples a pixel, at least 1; pixels where wood, leaf and background mix get twice as many.
    pub samples: u32,
}

impl Default for PictureSettings {
    fn default() -> Self {
        Self { width: 640, height: 720, samples: 5 }
    }
}

impl PictureSettings {
    /// Width over height.
    pub fn aspect(&self) -> f32 {
        self.width.max(1) as f32 / self.height.max(1) as f32
    }
}

/// Numbers that spread samples evenly over a pixel's choices.
#[derive(Clone, Copy)]
struct Stream {
    pixel: u32,
    sample: u32,
}

impl Stream {
    /// Two numbers in 0..1 for choice `what`, of its `round`-th ray.
    fn pair(self, what: u32, round: u32) -> (f32, f32) {
        let h = mix(self.pixel, what);
        // Steps of the plane's golden ratio fill the square evenly however many are taken.
        let n = (round + 1) as f32;
        (fract(unit(h) + n * 0.754_877_7), fract(unit(hash(h)) + n * 0.569_840_3))
    }
}

struct Painter<'a> {
    tracer: &'a Tracer<'a>,
    /// Sees wood as the eye does.
    eyes: &'a Tracer<'a>,
    wood: &'a SeenWood,
    scene: &'a Scene,
    palette: &'a Palette,
    camera: &'a Camera,
    daylight: Daylight,
    size: Vec2,
    view: View,
}

/// Draws what a camera sees of the tracer's scene, rows shared among workers.
///
/// A width or height of 0 gives an empty picture.
pub fn render(
    tracer: &Tracer,
    camera: &Camera,
    palette: &Palette,
    settings: PictureSettings,
    workers: &Workers,
) -> RgbImage {
    let PictureSettings { width, height, samples } = settings;
    let scene = tracer.scene();
    let ground = if scene.shore.is_some() { SAND } else { palette.grass };
    let view = View::of(camera, height);
    let wood = SeenWood::of(scene, camera, view.pixel);
    let eyes = Tracer::build(&wood.scene);
    let painter = Painter {
        tracer,
        eyes: &eyes,
        wood: &wood,
        scene,
        palette,
        camera,
        daylight: Daylight::of(scene, ground, camera.forward, camera.right),
        size: Vec2::new(width as f32, height as f32),
        view,
    };
    let row = |y: usize| -> Vec<[u8; 3]> {
        (0..width).map(|x| painter.pixel_at(x, y as u32, samples.max(1))).collect()
    };
    let rows = workers.map(height as usize, row);
    RgbImage::from_fn(width, height, |x, y| Rgb(rows[y as usize][x as usize]))
}

impl Painter<'_> {
    fn pixel_at(&self, x: u32, y: u32, samples: u32) -> [u8; 3] {
        let pixel = mix(hash(x), y);
        let mut sum = Vec3::ZERO;
        let mut first = None;
        let mut mixed = false;
        let mut taken = 0;
        while taken < samples || (mixed && taken < 2 * samples) {
            let stream = Stream { pixel, sample: taken };
            let (u, v) = stream.pair(0, taken);
            let (light, kind) = self.look(x as f32 + u, y as f32 + v, stream);
            mixed |= *first.get_or_insert(kind) != kind;
            sum += light;
            taken += 1;
        }
        encode(sum / taken as f32)
    }

    /// What is seen through a point of the picture, developed, and what kind of thing it is.
    fn look(&self, x: f32, y: f32, stream: Stream) -> (Vec3, u32) {
        let aspect = self.size.x / self.size.y;
        let d = self.camera.ray(2.0 * x / self.size.x - 1.0, 1.0 - 2.0 * y / self.size.y, aspect);
        let layers = self.wood.layers(self.eyes, self.camera.eye, d);
        let mut sum = Vec3::ZERO;
        let mut kinds = 0;
        for (hit, share) in &layers {
            let (light, kind) = self.see(hit, d, (x, y), stream);
            sum += light * *share;
            kinds = mix(kinds, kind);
        }
        (sum, kinds)
    }

    /// What a hit along direction `d` through a point of the picture looks like, developed, and its kind.
    fn see(&self, hit: &Hit, d: Vec3, (x, y): (f32, f32), stream: Stream) -> (Vec3, u32) {
        let aspect = self.size.x / self.size.y;
        let glow = self.glow(d, hit.t);
        let (light, kind) = match hit.seen {
            Seen::Sky => {
                // The middle of the pixel's row: a smooth sky without grain.
                let row = 1.0 - 2.0 * (y.floor() + 0.5) / self.size.y;
                let column = 2.0 * (x.floor() + 0.5) / self.size.x - 1.0;
                let smooth_d = self.camera.ray(column, row, aspect);
                let seawards = self.scene.shore.is_some_and(|sea| sea.outward().dot(d) > 0.0);
                let land = self.scene.ground.is_some() && !seawards;
                let light =
                    if land { self.daylight.distance(d, smooth_d) } else { self.daylight.backdrop(smooth_d) };
                (light, 0)
            }
            Seen::Lamp(i) if self.scene.lamps[i as usize].lamp.on => {
                let color = Vec3::from(self.scene.lamps[i as usize].lamp.color);
                let rim = 1.0 - hit.normal.dot(-d).max(0.0);
                return (Vec3::new(1.0, 0.98, 0.93).lerp(color, 0.15 + 0.5 * rim * rim), 100 + i);
            }
            Seen::Ground => {
                // Land fades into the air above the horizon.
                let far = 1.0 - smooth(0.0, 0.03, -d.y);
                let light = self.shade(self.camera.eye, hit, d, stream);
                match self.mirrored(hit, d, stream) {
                    Some((sky, share)) => (light.lerp(sky, share), 4),
                    None => (light.lerp(self.daylight.haze(), far * 0.75), 1),
                }
            }
            Seen::Solid(i) => (self.shade(self.camera.eye, hit, d, stream), 10_000 + i),
            Seen::Lamp(i) => (self.shade(self.camera.eye, hit, d, stream), 100 + i),
            Seen::Wood(_) => (self.shade(self.camera.eye, hit, d, stream), 2),
            Seen::Leaf(_) => (self.shade(self.camera.eye, hit, d, stream), 3),
        };
        (self.daylight.develop(light + glow), kind)
    }

    /// What a sea mirrors of sky and plants along a ray of direction `d`, and its share of what is seen there.
    fn mirrored(&self, hit: &Hit, d: Vec3, stream: Stream) -> Option<(Vec3, f32)> {
        let point = self.camera.eye + d * hit.t;
        let (back, share) = shore::mirror(&self.scene.shore?, point, d, hit.t * self.view.pixel)?;
        let from = point + Vec3::Y * 1e-3;
        let seen = self.tracer.closest(from, back, f32::INFINITY, &[]);
        let light = match seen.seen {
            Seen::Sky | Seen::Ground => self.daylight.backdrop(back),
            _ => self.shade(from, &seen, back, stream),
        };
        Some((light, share))
    }

    /// Light a surface sends back along a ray of direction `d` from a place.
    fn shade(&self, eye: Vec3, hit: &Hit, d: Vec3, stream: Stream) -> Vec3 {
        let point = eye + d * hit.t;
        let surface = Surface::at(self.wood, self.palette, hit, point, d, &self.view);
        let skin = 2e-4 + 1e-5 * hit.t;
        let thin = surface.through != Vec3::ZERO;
        let front = point + hit.normal * skin;
        let back = point - hit.normal * skin;

        let mut light = Vec3::ZERO;
        let rays = sky_rays(hit.seen);
        for ray in 0..rays {
            let (u, v) = stream.pair(1, stream.sample * rays + ray);
            let to = around(surface.normal, u, v);
            light += surface.color * self.sky_from(front, to);
            if thin && ray == 0 {
                light += surface.through * rays as f32 * self.sky_from(back, -to);
            }
        }
        light /= rays as f32;

        // What a hard light gives, reached or not, on whichever side it falls.
        let mut direct = |towards: Vec3, reach: f32, color: Vec3| {
            let facing = surface.normal.dot(towards);
            let share = if facing > 0.0 { surface.color } else { surface.through };
            let from = if facing > 0.0 { front } else { back };
            if share != Vec3::ZERO && !self.tracer.occluded(from, towards, reach, &[]) {
                let gloss = surface.sheen * gloss(surface.normal, towards, d);
                light += color * (share * facing.abs() + Vec3::splat(gloss));
            }
        };
        if let Some(key) = self.daylight.key {
            let (u, v) = stream.pair(2, stream.sample);
            direct(within(key.direction, key.spread, u, v), f32::INFINITY, key.color);
        }
        for (i, standing) in self.scene.lamps.iter().enumerate().filter(|(_, s)| s.lamp.on) {
            let to = standing.position - point;
            let distance = to.length().max(1e-4);
            let (u, v) = stream.pair(3 + i as u32, stream.sample);
            let towards = within(to / distance, standing.lamp.radius / distance, u, v);
            let solid_angle = (standing.lamp.radius / distance).powi(2).min(1.0);
            let color = Vec3::from(standing.lamp.color) * standing.lamp.strength.max(0.0) * solid_angle;
            direct(towards, distance, color);
        }
        light
    }

    /// Sky light, or what ground and leaves throw back, that reaches `from` out of direction `to`.
    fn sky_from(&self, from: Vec3, to: Vec3) -> Vec3 {
        let (reach, light) = match self.scene.ground {
            Some(ground) if to.y < 0.0 => {
                (((from.y - ground) / -to.y * 0.999).max(0.0), self.daylight.from_ground)
            }
            _ => (f32::INFINITY, self.daylight.sky_light(self.scene, to)),
        };
        let hit = self.tracer.closest(from, to, reach, &[]);
        match hit.seen {
            Seen::Sky | Seen::Ground => light,
            Seen::Leaf(i) => {
                let leaf = self.palette.plant(self.scene.leaves[i as usize].plant).leaf;
                let sun = self.daylight.key.map_or(Vec3::ZERO, |key| {
                    let at = from + to * hit.t - to * 2e-4;
                    match self.tracer.occluded(at, key.direction, f32::INFINITY, &[]) {
                        true => Vec3::ZERO,
                        false => key.color * hit.normal.dot(key.direction).abs(),
                    }
                });
                self.daylight.dim + leaf * (self.daylight.in_crown + sun)
            }
            _ => self.daylight.dim,
        }
    }

    /// Light that the air about burning lamps scatters along a ray as far as `reach`.
    fn glow(&self, d: Vec3, reach: f32) -> Vec3 {
        let lamps = self.scene.lamps.iter().filter(|s| s.lamp.on);
        lamps.fold(Vec3::ZERO, |sum, standing| {
            let to = standing.position - self.camera.eye;
            let along = to.dot(d);
            let radius = standing.lamp.radius;
            let miss = (to - d * along).length().max(radius);
            // The inverse square summed along the ray: an angle over the distance at which it passes.
            let end = if reach.is_finite() {
                ops::atan((reach - along) / miss)
            } else {
                core::f32::consts::FRAC_PI_2
            };
            let seen = (end + ops::atan(along / miss)).max(0.0) / miss;
            sum + Vec3::from(standing.lamp.color)
                * (AIR * standing.lamp.strength.max(0.0) * radius * radius * seen)
        })
    }
}

/// Sky-light rays at each sample: more on the large smooth surfaces, where grain would show.
fn sky_rays(seen: Seen) -> u32 {
    match seen {
        Seen::Wood(_) | Seen::Leaf(_) => 2,
        Seen::Ground | Seen::Sky => 4,
        Seen::Solid(_) | Seen::Lamp(_) => 8,
    }
}

/// Brightness of a soft highlight.
fn gloss(normal: Vec3, towards: Vec3, view: Vec3) -> f32 {
    let half = (towards - view).normalize_or_zero();
    let c = normal.dot(half).max(0.0);
    let c = c * c * c * c;
    c * c * c * 4.0
}

/// A direction towards a point of a disc of that radius one metre away.
fn within(direction: Vec3, spread: f32, u: f32, v: f32) -> Vec3 {
    let (x, z) = direction.any_orthonormal_pair();
    let (r, turn) = (u.sqrt() * spread.min(1.0), v * core::f32::consts::TAU);
    (direction + x * (r * ops::cos(turn)) + z * (r * ops::sin(turn))).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::{
        Capsule, Lamp, LeafPatch, Sky, SolidShape, StandingLamp, StandingSolid, SunLight,
    };
    use crate::shape::outline::LeafOutline;

    const SMALL: PictureSettings = PictureSettings { width: 64, height: 72, samples: 3 };

    fn stem(radius: f32) -> Scene {
        let capsules =
            vec![Capsule { from: Vec3::ZERO, to: Vec3::new(0.0, 2.0, 0.0), radius, organ: 0, plant: 0 }];
        let leaves = (1..9)
            .map(|i| LeafPatch {
                base: Vec3::new(0.0, 1.0 + 0.1 * i as f32, 0.0),
                midrib: Quat::from_rotation_y(i as f32 * 2.4) * Vec3::new(0.4, 0.1, 0.0),
                across: Quat::from_rotation_y(i as f32 * 2.4) * Vec3::new(0.0, 0.0, 0.1),
                outline: LeafOutline::Elliptic,
                organ: i,
                plant: 0,
            })
            .collect();
        Scene { capsules, leaves, ground: Some(0.0), ..Scene::default() }
    }

    fn draw(scene: &Scene, camera: &Camera, threads: usize) -> RgbImage {
        let workers = Workers::new(threads).unwrap();
        render(&Tracer::build(scene), camera, &Palette::default(), SMALL, &workers)
    }

    /// Mean brightness about the place where a point of the world is seen.
    fn brightness(image: &RgbImage, camera: &Camera, point: Vec3) -> f32 {
        let at = camera.project(point, SMALL.aspect()).unwrap();
        let x = ((at.x + 1.0) * 0.5 * SMALL.width as f32) as u32;
        let y = ((1.0 - at.y) * 0.5 * SMALL.height as f32) as u32;
        let near = (0..9).map(|i| image.get_pixel(x + i % 3 - 1, y + i / 3 - 1).0);
        near.map(|p| p.iter().map(|c| f32::from(*c)).sum::<f32>()).sum::<f32>() / 27.0
    }

    #[test]
    fn a_picture_is_the_same_bit_for_bit_on_any_number_of_threads() {
        let scene = stem(0.1);
        let camera = Camera::framing(&Bounds::of(&scene), 25.0, 5.0, SMALL.aspect());
        let one = draw(&scene, &camera, 1);
        assert_eq!(one, draw(&scene, &camera, 2));
        assert_eq!(one, draw(&scene, &camera, 3));
    }

    #[test]
    fn plants_fill_most_of_the_height_and_stay_inside() {
        let scene = stem(0.05);
        for (azimuth, elevation) in [(0.0, 5.0), (130.0, 0.5), (-60.0, 40.0)] {
            let camera = Camera::framing(&Bounds::of(&scene), azimuth, elevation, SMALL.aspect());
            let ends =
                [Vec3::ZERO, Vec3::new(0.0, 2.0, 0.0)].map(|p| camera.project(p, SMALL.aspect()).unwrap());
            assert!(ends.iter().all(|p| p.abs().max_element() < 0.98), "{ends:?}");
            let height = (ends[1].y - ends[0].y) * 0.5;
            assert!((0.6..0.9).contains(&height), "{height}");
        }
    }

    #[test]
    fn a_walls_shadow_is_darker_than_what_surrounds_it() {
        let mut scene = stem(0.05);
        scene.sun = Some(SunLight { direction: Vec3::new(-1.0, 1.0, 0.0).normalize(), strength: 0.5 });
        scene.solids.push(StandingSolid {
            shape: SolidShape::Box { size: Vec3::new(0.2, 2.0, 2.0) },
            position: Vec3::new(-2.0, 1.0, 0.0),
            rotation: Quat::IDENTITY,
            color: [0.5; 3],
        });
        let camera = Camera::looking(Vec3::new(0.0, 8.0, 12.0), Vec3::new(0.0, 0.5, 0.0));
        let image = draw(&scene, &camera, 1);
        let shadow = brightness(&image, &camera, Vec3::new(-1.0, 0.0, 0.0));
        let lit = brightness(&image, &camera, Vec3::new(-1.0, 0.0, 2.0));
        assert!(shadow < lit - 25.0, "{shadow} against {lit}");
    }

    #[test]
    fn a_lamp_brightens_the_near_side() {
        let mut scene = stem(0.3);
        scene.leaves.clear();
        scene.sky = Sky { strength: 0.1, ..Sky::default() };
        let lamp = Lamp { strength: 100.0, radius: 0.2, on: true, color: [1.0, 0.6, 0.3] };
        scene.lamps.push(StandingLamp { lamp, position: Vec3::new(1.6, 1.0, 0.6) });
        let camera = Camera::looking(Vec3::new(0.0, 1.0, 9.0), Vec3::new(0.0, 1.0, 0.0));
        let sides = |scene: &Scene| {
            let image = draw(scene, &camera, 1);
            [-0.18, 0.18].map(|x| brightness(&image, &camera, Vec3::new(x, 1.0, 0.24)))
        };
        let [far, near] = sides(&scene);
        assert!(near > far + 40.0, "{near} against {far}");
        scene.lamps[0].lamp.on = false;
        let [left, right] = sides(&scene);
        assert!(left > right - 5.0, "the key light comes from the left: {left} against {right}");
    }

    #[test]
    fn a_twig_thinner_than_a_pixel_is_a_line_and_no_row_of_dots() {
        let mut scene = stem(0.008);
        scene.leaves.clear();
        scene.ground = None;
        // Less than a quarter of a pixel.
        scene.capsules[0].radius = 0.004;
        let camera = Camera::looking(Vec3::new(0.0, 1.0, 6.0), Vec3::new(0.0, 1.0, 0.0));
        let with = draw(&scene, &camera, 1);
        // A stem of many pieces is no darker where they meet.
        let pieces = (0..20).map(|k| Capsule {
            from: Vec3::Y * (k as f32 * 0.1),
            to: Vec3::Y * (k as f32 * 0.1 + 0.1),
            organ: 100 + k,
            ..scene.capsules[0]
        });
        let in_pieces = draw(&Scene { capsules: pieces.collect(), ..scene.clone() }, &camera, 1);
        scene.capsules.clear();
        let without = draw(&scene, &camera, 1);
        let dark = |image: &RgbImage| -> Vec<f32> {
            let sum =
                |image: &RgbImage, y: u32| (0..64).map(|x| f32::from(image.get_pixel(x, y)[1])).sum::<f32>();
            (20..52).map(|y| sum(&without, y) - sum(image, y)).collect()
        };
        for image in [&with, &in_pieces] {
            let rows = dark(image);
            let mean = rows.iter().sum::<f32>() / rows.len() as f32;
            assert!(mean > 10.0, "{rows:?}");
            // Bark is not of one colour.
            assert!(rows.iter().all(|row| (0.5..2.0).contains(&(row / mean))), "{rows:?}");
        }
    }

    #[test]
    fn a_picture_of_no_size_or_of_nothing_is_drawn_too() {
        let scene = Scene::default();
        let camera = Camera::framing(&Bounds::of(&scene), 0.0, 5.0, 1.0);
        let none = PictureSettings { width: 0, height: 5, samples: 0 };
        let workers = Workers::new(1).unwrap();
        let image = render(&Tracer::build(&scene), &camera, &Palette::default(), none, &workers);
        assert_eq!(image.dimensions(), (0, 5));
        assert_eq!(draw(&scene, &camera, 1).dimensions(), (64, 72));
    }
}
