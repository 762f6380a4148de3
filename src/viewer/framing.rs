//! Where the camera stands so that plants, and what is near them, lie in the part of the window that is free.

use core::f32::consts::PI;

use bevy::math::{Ray3d, ops};
use bevy::prelude::*;

use super::pick::pick_solid;
use crate::plant::Snapshot;
use crate::scenario::Fixtures;

/// Turn of the camera about a garden in which nothing stands but plants, radians.
const OPEN_YAW: f32 = 0.45;
/// How far the camera turns from straight across the lean towards the open side, so that a wall shows its face.
const ASIDE: f32 = 0.3;
/// What of solids is within the height of the plants, and between these bounds in metres, is part of the picture.
const NEAR: [f32; 2] = [0.9, 2.4];
/// A solid that is, and reaches no farther from its middle than this along any axis, metres, is seen whole.
const WHOLE: f32 = 4.0;
/// A lamp is if its middle is within this of the plants, metres.
const NEAR_LAMP: f32 = 5.0;
/// The camera comes no nearer than this, metres.
const NEAREST: f32 = 2.2;

/// A box along the axes, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extent {
    pub low: Vec3,
    pub high: Vec3,
}

impl Extent {
    fn around(point: Vec3, half: Vec3) -> Self {
        Self { low: point - half, high: point + half }
    }

    fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// What lies in both, if anything does.
    fn common(self, other: Self) -> Option<Self> {
        let (low, high) = (self.low.max(other.low), self.high.min(other.high));
        low.cmple(high).all().then_some(Self { low, high })
    }

    fn middle(self) -> Vec3 {
        0.5 * (self.low + self.high)
    }

    fn corners(self) -> [Vec3; 8] {
        core::array::from_fn(|i| {
            let at = |bit: usize, low: f32, high: f32| if i >> bit & 1 == 1 { high } else { low };
            Vec3::new(
                at(0, self.low.x, self.high.x),
                at(1, self.low.y, self.high.y),
                at(2, self.low.z, self.high.z),
            )
        })
    }
}

/// The box around the plants; a seed's is a metre high.
fn plants(shot: &Snapshot) -> Extent {
    let seed = |at: Vec3| Extent { low: at - Vec3::new(0.4, 0.0, 0.4), high: at + Vec3::new(0.4, 1.0, 0.4) };
    let seeds = shot.plants.iter().flatten().map(|plant| seed(plant.position));
    let all = seeds.reduce(Extent::union).unwrap_or(seed(Vec3::ZERO));
    shot.pose.iter().fold(all, |all, pose| all.union(Extent::around(pose.position, Vec3::ZERO)))
}

/// What is to be seen: the plants, and what of solids and lamps is near them.
pub(super) fn sight(shot: &Snapshot, standing: &Fixtures) -> Vec<Extent> {
    let plants = plants(shot);
    let near =
        |reach: f32| Extent { low: plants.low - Vec3::splat(reach), high: plants.high + Vec3::splat(reach) };
    let solids = standing.solids.iter().filter_map(|solid| {
        let turn = Mat3::from_quat(solid.rotation);
        let half = solid.thing.shape.scaled(solid.scale).half_size();
        let reach = turn.x_axis.abs() * half.x + turn.y_axis.abs() * half.y + turn.z_axis.abs() * half.z;
        let whole = Extent::around(solid.position, reach);
        let part = whole.common(near((plants.high.y - plants.low.y).clamp(NEAR[0], NEAR[1])))?;
        Some(if reach.max_element() <= WHOLE { whole } else { part })
    });
    let lamps = standing.lamps.iter().filter_map(|lamp| {
        let point = Extent::around(lamp.position, Vec3::ZERO);
        point.common(near(NEAR_LAMP)).map(|_| Extent::around(lamp.position, Vec3::splat(lamp.thing.radius)))
    });
    core::iter::once(plants).chain(solids).chain(lamps).collect()
}

/// The turn of the camera, radians, from which it shows how plants lean: away from walls, towards lamps. Straight
/// across the lean, a little to the open side, and where solids hide least.
pub(super) fn yaw(shot: &Snapshot, standing: &Fixtures, pitch: f32) -> f32 {
    let plants = plants(shot);
    let base = plants.middle().with_y(plants.low.y);
    let mut lean = Vec3::ZERO;
    for lamp in &standing.lamps {
        let to = (lamp.position - base).with_y(0.0);
        lean += to / (1.0 + to.length_squared());
    }
    for solid in &standing.solids {
        let half = solid.thing.shape.scaled(solid.scale).half_size();
        let own = solid.rotation.inverse() * (base + Vec3::Y - solid.position);
        let nearest = solid.position + solid.rotation * own.clamp(-half, half);
        let away = (base - nearest).with_y(0.0);
        lean += away / (0.2 + away.length_squared());
    }
    if lean.length() <= 0.05 {
        return OPEN_YAW;
    }
    let across = ops::atan2(lean.x, lean.z);
    // From the front first, should both sides be as good.
    let sides = [across - 0.5 * PI, across + 0.5 * PI];
    let mut stands: Vec<f32> = [ASIDE, 2.0 * ASIDE, 3.0 * ASIDE]
        .into_iter()
        .flat_map(|aside| [sides[0] + aside, sides[1] - aside])
        .collect();
    stands.sort_by(|a, b| ops::cos(*b).total_cmp(&ops::cos(*a)));
    let hidden = |yaw: f32| {
        let toward = turn(yaw, pitch) * Vec3::Z;
        let points = (1..=8).map(|i| base + Vec3::Y * 0.25 * i as f32);
        let rays = points.filter_map(|origin| Some(Ray3d { origin, direction: Dir3::new(toward).ok()? }));
        rays.filter(|ray| {
            standing.solids.iter().any(|solid| {
                let place = solid.transform();
                pick_solid(solid.thing.shape, &place, *ray).is_some()
            })
        })
        .count()
    };
    // In whole turns aside: rounding must not choose between front and back.
    let off = |yaw: f32| {
        let aside = wrapped(yaw - sides[0]).abs().min(wrapped(yaw - sides[1]).abs());
        (aside / ASIDE).round() as u32
    };
    stands.into_iter().min_by_key(|yaw| (hidden(*yaw), off(*yaw))).map_or(OPEN_YAW, wrapped)
}

/// An angle within half a turn of 0.
fn wrapped(angle: f32) -> f32 {
    let turns = ops::round(angle / core::f32::consts::TAU);
    angle - turns * core::f32::consts::TAU
}

/// The turn of a camera that orbits, radians.
fn turn(yaw: f32, pitch: f32) -> Quat {
    Quat::from_rotation_y(yaw) * Quat::from_rotation_x(-pitch)
}

/// A part of a window, as slopes from the middle of the view: metres aside for each metre ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Free {
    pub left: f32,
    pub right: f32,
    pub bottom: f32,
    pub top: f32,
}

impl Free {
    /// The part of a window of some size (logical pixels) that lies within margins `left, right, top, bottom`, less
    /// a little all around; at least a third of the window, so that there always is a picture.
    pub fn of(window: Vec2, [left, right, top, bottom]: [f32; 4], fov: f32) -> Self {
        const INSET: f32 = 0.06;
        let window = window.max(Vec2::ONE);
        let slope = 2.0 * ops::tan(0.5 * fov) / window.y;
        let span = |low: f32, high: f32, whole: f32| {
            let (low, high) = (low - 0.5 * whole, 0.5 * whole - high);
            let (middle, half) = (0.5 * (low + high), 0.5 * (high - low) * (1.0 - 2.0 * INSET));
            let half = half.max(whole / 6.0);
            (slope * (middle - half), slope * (middle + half))
        };
        let (left, right) = span(left, right, window.x);
        let (bottom, top) = span(bottom, top, window.y);
        Self { left, right, bottom, top }
    }
}

/// The point a camera of some turn orbits, and its distance from it, so that boxes just fit into the free part.
pub(super) fn fit(boxes: &[Extent], yaw: f32, pitch: f32, free: Free) -> (Vec3, f32) {
    let turn = turn(yaw, pitch);
    let (right, up, ahead) = (turn * Vec3::X, turn * Vec3::Y, turn * Vec3::NEG_Z);
    let all = boxes.iter().copied().reduce(Extent::union).unwrap_or(Extent::around(Vec3::ZERO, Vec3::ONE));
    let pivot = all.middle();
    let mut most = [f32::NEG_INFINITY; 4];
    for corner in boxes.iter().flat_map(|each| each.corners()) {
        let from = corner - pivot;
        let (x, y, z) = (from.dot(right), from.dot(up), from.dot(ahead));
        // An eye at (e, z_e) sees x within the edges if e - z_e r >= x - z r and e - z_e l <= x - z l.
        let each = [x - z * free.right, z * free.left - x, y - z * free.top, z * free.bottom - y];
        most = core::array::from_fn(|i| most[i].max(each[i]));
    }
    if !most.iter().all(|edge| edge.is_finite()) {
        return (pivot, NEAREST);
    }
    let back =
        ((most[0] + most[1]) / (free.right - free.left)).max((most[2] + most[3]) / (free.top - free.bottom));
    let back = back.max(NEAREST);
    let aside = 0.5 * (most[0] - free.right * back - most[1] - free.left * back);
    let above = 0.5 * (most[2] - free.top * back - most[3] - free.bottom * back);
    (pivot + right * aside + up * above, back)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assets::Library;
    use crate::environment::workers::Workers;
    use crate::scenario::{Timeline, View};

    use crate::viewer::camera::{FOV, PITCH};

    fn begun(scenario: &str) -> View {
        let library = Library::embedded();
        let resolved = library.scenario(scenario).unwrap();
        let timeline = Timeline::new(resolved, 1, library, Workers::new(1).unwrap()).unwrap();
        timeline.view(0).unwrap()
    }

    /// Where points lie in a window, pixels from the upper left.
    fn pixels(boxes: &[Extent], yaw: f32, (focus, radius): (Vec3, f32), window: Vec2) -> Vec<Vec2> {
        let turn = turn(yaw, PITCH);
        let eye = focus + turn * Vec3::Z * radius;
        let scale = 0.5 * window.y / ops::tan(0.5 * FOV);
        let corners = boxes.iter().flat_map(|each| each.corners());
        let seen = corners.map(|corner| turn.inverse() * (corner - eye));
        seen.map(|at| 0.5 * window + Vec2::new(at.x, -at.y) * scale / -at.z).collect()
    }

    #[test]
    fn everything_lies_between_the_panels_and_fills_the_room_one_way() {
        let boxes = [
            Extent { low: Vec3::new(-1.0, 0.0, -2.0), high: Vec3::new(1.5, 5.0, 1.0) },
            Extent { low: Vec3::new(3.0, 2.0, 0.0), high: Vec3::new(3.4, 2.4, 0.4) },
        ];
        let window = Vec2::new(1280.0, 720.0);
        let margins = [252.0, 300.0, 39.0, 43.0];
        for yaw in [0.0, 0.45, 2.0, -1.3] {
            let free = Free::of(window, margins, FOV);
            let stand = fit(&boxes, yaw, PITCH, free);
            let seen = pixels(&boxes, yaw, stand, window);
            let low = seen.iter().copied().reduce(Vec2::min).unwrap();
            let high = seen.iter().copied().reduce(Vec2::max).unwrap();
            assert!(low.x > 252.0 && high.x < 980.0 && low.y > 39.0 && high.y < 677.0, "{low} {high}");
            let (wide, tall) = ((high.x - low.x) / (728.0 * 0.88), (high.y - low.y) / (638.0 * 0.88));
            assert!((wide.max(tall) - 1.0).abs() < 0.01, "{wide} {tall}");
        }
    }

    #[test]
    fn a_window_of_no_size_has_a_stand_all_the_same() {
        for window in [Vec2::ZERO, Vec2::new(1.0, 4000.0), Vec2::new(300.0, 20.0)] {
            let free = Free::of(window, [252.0, 300.0, 39.0, 43.0], FOV);
            let (focus, radius) = fit(&sight(&begun("dusk").shot, &begun("dusk").standing), 0.3, PITCH, free);
            assert!(focus.is_finite() && radius.is_finite() && radius >= NEAREST, "{window}");
        }
        assert_eq!(fit(&[], 0.0, 0.0, Free::of(Vec2::ONE, [0.0; 4], FOV)).1, NEAREST);
    }

    #[test]
    fn the_first_look_is_along_the_wall_and_shows_lamp_and_wall() {
        for scenario in ["dusk", "wall"] {
            let view = begun(scenario);
            let yaw = yaw(&view.shot, &view.standing, PITCH);
            // Both walls run along z and stand at the left of the seed.
            let across = (turn(yaw, 0.0) * Vec3::X).x;
            assert!(across > 0.85, "{scenario}: {yaw}");
            // The face that looks at the seed is seen.
            assert!((turn(yaw, PITCH) * Vec3::Z).x > 0.1, "{scenario}: {yaw}");
        }
        let dusk = begun("dusk");
        let lamp = dusk.standing.lamps[0].position;
        assert!(sight(&dusk.shot, &dusk.standing).iter().any(|each| each.middle().distance(lamp) < 1e-4));
        let open = begun("open");
        assert_eq!(yaw(&open.shot, &open.standing, PITCH), OPEN_YAW);
    }

    #[test]
    fn a_wall_beside_a_seed_is_seen_whole_and_a_long_one_in_part() {
        let view = begun("wall");
        let walls = |standing: &Fixtures| sight(&view.shot, standing)[1];
        let size = walls(&view.standing).high - walls(&view.standing).low;
        assert!(size.distance(Vec3::new(0.3, 3.2, 7.0)) < 1e-4, "{size}");
        let mut long = Fixtures::clone(&view.standing);
        long.solids[0].scale = Vec3::new(1.0, 1.0, 10.0);
        assert!((walls(&long).high - walls(&long).low).z < 7.0);
    }

    #[test]
    fn a_wall_in_front_is_not_looked_through() {
        let view = begun("wall");
        let mut standing = Fixtures::clone(&view.standing);
        // Turned round the seed: the same picture from the other side.
        for (turned, at) in [(0.0, 1.0), (0.5 * PI, 1.0), (PI, 1.0), (1.5 * PI, 1.0), (0.8, 2.0)] {
            let by = Quat::from_rotation_y(turned);
            let wall = &view.standing.solids[0];
            standing.solids[0].position = by * (wall.position * Vec3::new(at, 1.0, at));
            standing.solids[0].rotation = by * wall.rotation;
            let yaw = yaw(&view.shot, &standing, PITCH);
            let ray = Ray3d { origin: Vec3::Y, direction: Dir3::new(turn(yaw, PITCH) * Vec3::Z).unwrap() };
            let wall = &standing.solids[0];
            assert_eq!(pick_solid(wall.thing.shape, &wall.transform(), ray), None, "turned by {turned}");
        }
    }
}
