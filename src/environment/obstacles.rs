//! Growth never passes through a solid or the ground: it slides along, or stops.
//!
//! A shoot is a capsule swept from where it starts. All solids are convex, so the distance from a point that
//! moves straight is a convex function of the way: it has one minimum, and up to there it falls. That makes
//! the question how far a shoot gets a search for one crossing, with no steps that could jump over a corner.

use bevy::math::{Vec3, ops};

use super::scene::{Capsule, SolidShape, StandingSolid};
use super::segment;

/// Room left between a shoot and what it grows along, metres.
pub(super) const CLEARANCE: f32 = 1e-4;
/// Distances are reckoned no finer than this, metres.
const ROUNDING: f32 = 1e-6;
/// Cosine of the widest turn a shoot takes to slide along a surface: 80 degrees.
const WIDEST_TURN: f32 = 0.173_648;
/// Least share of the wanted length worth turning for.
const USEFUL: f32 = 0.2;
/// How often a turned shoot may meet the next surface and turn again.
const TURNS: usize = 6;

/// What a shoot can do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Advance {
    /// Where it grows, a unit vector.
    pub direction: Vec3,
    /// How far, metres.
    pub length: f32,
}

/// How far and where a shoot of `radius` grows that wants to grow `length` (metres) along `direction` (a unit
/// vector) from `from`.
///
/// It goes straight if it is free to. Else it turns just enough to pass along the surface it would meet, by
/// less than 80 degrees and if that gains a useful length; else it stops short of it. The capsule from `from`
/// meets no solid and does not enter the ground. Where the start is already nearer than `radius` (a seed on
/// the ground), the shoot comes no nearer than it starts. From inside a solid or underground nothing grows; `wood`
/// in which it begins is what bears it, and no obstacle.
pub fn advance(
    solids: &[StandingSolid],
    wood: &[Capsule],
    ground: Option<f32>,
    from: Vec3,
    direction: Vec3,
    length: f32,
    radius: f32,
) -> Advance {
    let stopped = Advance { direction, length: 0.0 };
    let finite = from.is_finite() && direction.is_finite() && radius.is_finite();
    if !finite || direction == Vec3::ZERO || !(length > 0.0 && length < f32::INFINITY) {
        return stopped;
    }
    let heading = direction.normalize();
    let around = Surroundings::new(solids, wood, ground, from, length, radius.max(0.0));
    let Some(around) = around else {
        return stopped;
    };
    let Some(first) = around.first_contact(heading, length) else {
        return Advance { direction, length };
    };
    let straight = Advance { direction, length: first.way };
    let mut best = straight;
    let mut contact = first;
    let mut previous: Option<Vec3> = None;
    let mut course = heading;
    for _ in 0..TURNS {
        let Some(turned) = contact.along(course, length, previous) else {
            break;
        };
        if turned.dot(heading) < WIDEST_TURN {
            break;
        }
        let next = around.first_contact(turned, length);
        let way = next.map_or(length, |next| next.way);
        // Worth by how far it gets the way it wanted.
        if way >= USEFUL * length && way * turned.dot(heading) > best.length * best.direction.dot(heading) {
            best = Advance { direction: turned, length: way };
        }
        let Some(next) = next else {
            break;
        };
        previous = Some(contact.normal);
        (contact, course) = (next, turned);
    }
    best
}

/// Whether wood of `radius` from `from` to `to` meets a solid; true rather than false within rounding.
pub fn touches(solid: &StandingSolid, from: Vec3, to: Vec3, radius: f32) -> bool {
    let Some(body) = Body::solid(solid, from) else {
        return false;
    };
    let way = to - from;
    let length = way.length();
    if !length.is_finite() || !radius.is_finite() {
        return false;
    }
    let direction = if length > 0.0 { way / length } else { Vec3::Y };
    let nearest = body.nearest(body.inward(direction), length).1;
    nearest <= radius + ROUNDING * (10.0 + length + body.start.length())
}

/// Whether a place lies in a stem or on its bark.
pub fn is_within(stem: &Capsule, place: Vec3) -> bool {
    segment::gap((place, place), (stem.from, stem.to)) <= stem.radius + ROUNDING
}

/// An obstacle seen from where a shoot starts, in its own axes.
#[derive(Debug, Clone, Copy)]
struct Body {
    axes: [Vec3; 3],
    /// Where the shoot starts.
    start: Vec3,
    form: BodyForm,
    /// Distance to keep.
    keep: f32,
}

#[derive(Debug, Clone, Copy)]
enum BodyForm {
    Block(Vec3),
    Ball(f32),
    Pillar {
        radius: f32,
        half: f32,
    },
    /// A stem with round ends.
    Stem {
        radius: f32,
        half: f32,
    },
    /// Everything below y = 0.
    Ground,
}

struct Surroundings {
    bodies: Vec<Body>,
}

/// Where a shoot first comes too near.
#[derive(Debug, Clone, Copy)]
struct Contact {
    /// How far it gets, metres.
    way: f32,
    /// Outward normal of the surface there.
    normal: Vec3,
    /// Room between the start and the surface's plane beyond what must be kept.
    room: f32,
}

impl Surroundings {
    /// Obstacles within reach; `None` if the start lies inside one.
    fn new(
        solids: &[StandingSolid],
        wood: &[Capsule],
        ground: Option<f32>,
        from: Vec3,
        length: f32,
        radius: f32,
    ) -> Option<Self> {
        let ground = ground.map(|ground| Body {
            axes: Vec3::AXES,
            start: Vec3::Y * (from.y - ground),
            form: BodyForm::Ground,
            keep: 0.0,
        });
        let solids = solids.iter().filter_map(|solid| Body::solid(solid, from));
        let wood = wood.iter().filter(|stem| !is_within(stem, from)).map(|stem| Body::stem(stem, from));
        let mut bodies = Vec::new();
        for mut body in solids.chain(wood).chain(ground) {
            let distance = body.distance(body.start);
            // A seed lies on the ground, give or take a rounding.
            let skin = if matches!(body.form, BodyForm::Ground) { 1e-3 } else { 0.0 };
            if distance <= -skin {
                return None;
            }
            if distance <= length + radius + 2.0 * CLEARANCE {
                body.keep = (radius + CLEARANCE).min(distance);
                bodies.push(body);
            }
        }
        Some(Self { bodies })
    }

    fn first_contact(&self, direction: Vec3, length: f32) -> Option<Contact> {
        let contacts = self.bodies.iter().filter_map(|body| body.contact(direction, length));
        contacts.min_by(|a, b| a.way.total_cmp(&b.way))
    }
}

impl Contact {
    /// The unit vector nearest to `course` that, followed for `length`, just passes the surface; after
    /// turning from another surface with normal `previous`, the edge between both.
    fn along(&self, course: Vec3, length: f32, previous: Option<Vec3>) -> Option<Vec3> {
        let n = self.normal;
        if let Some(m) = previous {
            let edge = n.cross(m);
            // Turning from one surface led back into the other: only their edge is left.
            if course.dot(n) < 0.0 && edge.length_squared() > 1e-4 {
                return (edge * edge.dot(course).signum()).try_normalize();
            }
        }
        let tangent = (course - n * course.dot(n)).try_normalize()?;
        let sink = (self.room / length).clamp(0.0, 1.0);
        (tangent * (1.0 - sink * sink).sqrt() - n * sink).try_normalize()
    }
}

impl Body {
    fn solid(solid: &StandingSolid, from: Vec3) -> Option<Self> {
        let form = match solid.shape {
            SolidShape::Box { size } => BodyForm::Block(size.abs() * 0.5),
            SolidShape::Ball { radius } => BodyForm::Ball(radius.abs()),
            SolidShape::Cylinder { radius, height } => {
                BodyForm::Pillar { radius: radius.abs(), half: height.abs() * 0.5 }
            }
        };
        let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| solid.rotation * axis);
        let mut body = Self { axes, start: Vec3::ZERO, form, keep: 0.0 };
        body.start = body.inward(from - solid.position);
        (body.start.is_finite() && body.distance(body.start).is_finite()).then_some(body)
    }

    fn stem(stem: &Capsule, from: Vec3) -> Self {
        let along = stem.to - stem.from;
        let upright = along.normalize_or(Vec3::Y);
        let (across, other) = upright.any_orthonormal_pair();
        let form = BodyForm::Stem { radius: stem.radius, half: 0.5 * along.length() };
        let mut body = Self { axes: [across, upright, other], start: Vec3::ZERO, form, keep: 0.0 };
        body.start = body.inward(from - stem.from.midpoint(stem.to));
        body
    }

    /// A world vector in the body's axes.
    fn inward(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.axes[0]), v.dot(self.axes[1]), v.dot(self.axes[2]))
    }

    fn outward(&self, v: Vec3) -> Vec3 {
        self.axes[0] * v.x + self.axes[1] * v.y + self.axes[2] * v.z
    }

    /// Distance from a point to the surface, negative inside.
    fn distance(&self, p: Vec3) -> f32 {
        match self.form {
            BodyForm::Block(half) => {
                let q = p.abs() - half;
                q.max(Vec3::ZERO).length() + q.max_element().min(0.0)
            }
            BodyForm::Ball(radius) => p.length() - radius,
            BodyForm::Pillar { radius, half } => {
                let (side, end) = (ops::hypot(p.x, p.z) - radius, p.y.abs() - half);
                let (out, up) = (side.max(0.0), end.max(0.0));
                (out * out + up * up).sqrt() + side.max(end).min(0.0)
            }
            BodyForm::Stem { radius, half } => beyond(p, half).length() - radius,
            BodyForm::Ground => p.y,
        }
    }

    /// Outward unit normal at a point outside.
    fn normal(&self, p: Vec3) -> Vec3 {
        let n = match self.form {
            BodyForm::Block(half) => {
                let q = p.abs() - half;
                let out = q.max(Vec3::ZERO);
                if out == Vec3::ZERO {
                    let top = q.max_element();
                    Vec3::from_array(q.to_array().map(|x| if x == top { 1.0 } else { 0.0 })) * p.signum()
                } else {
                    out * p.signum()
                }
            }
            BodyForm::Ball(_) => p,
            BodyForm::Pillar { radius, half } => {
                let across = ops::hypot(p.x, p.z);
                let (side, end) = (across - radius, p.y.abs() - half);
                let round = Vec3::new(p.x, 0.0, p.z).normalize_or_zero();
                let flat = Vec3::Y * p.y.signum();
                if side <= 0.0 && end <= 0.0 {
                    if side > end { round } else { flat }
                } else {
                    round * side.max(0.0) + flat * end.max(0.0)
                }
            }
            BodyForm::Stem { half, .. } => beyond(p, half),
            BodyForm::Ground => Vec3::Y,
        };
        self.outward(n.normalize_or(Vec3::Y))
    }

    /// Way and distance where the straight line from the start comes nearest, up to `length`.
    fn nearest(&self, d: Vec3, length: f32) -> (f32, f32) {
        if let BodyForm::Stem { radius, half } = self.form {
            let (end, top) = (self.start + d * length, Vec3::Y * half);
            let (here, there) = segment::nearest((self.start, end), (-top, top));
            return (here.distance(self.start), here.distance(there) - radius);
        }
        let at = |way: f32| self.distance(self.start + d * way);
        let (mut low, mut high) = (0.0, length);
        for _ in 0..48 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if at(a) <= at(b) {
                high = b;
            } else {
                low = a;
            }
        }
        let nearest = (low + high) * 0.5;
        let ends = [(0.0, at(0.0)), (length, at(length))];
        ends.into_iter().fold((nearest, at(nearest)), |a, b| if b.1 < a.1 { b } else { a })
    }

    /// Where a shoot first comes nearer than it may.
    fn contact(&self, direction: Vec3, length: f32) -> Option<Contact> {
        let d = self.inward(direction);
        let (turning, least) = self.nearest(d, length);
        if least >= self.keep - ROUNDING {
            return None;
        }
        let clear = |way: f32| self.distance(self.start + d * way) >= self.keep;
        let (mut low, mut high) = (0.0, turning);
        for _ in 0..40 {
            let middle = (low + high) * 0.5;
            if clear(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        let at = self.start + d * low;
        let normal = self.normal(at);
        // Distance of the start from the plane that touches the surface, less what must be kept.
        let room = (self.start - at).dot(self.inward(normal)).max(0.0);
        Some(Contact { way: low, normal, room })
    }
}

/// From the nearest point of an upright line about the middle, half as long as `half`, to a point.
fn beyond(p: Vec3, half: f32) -> Vec3 {
    p - Vec3::Y * p.y.clamp(-half, half)
}

#[cfg(test)]
mod tests;
