//! Rays through a [`Scene`]: what they meet first, and whether they meet anything.
//!
//! A [`Tracer`] is built afresh from a scene (about 8 ms for 5,000 occluders) and never edited. The tree of
//! boxes under it is built by obvhs; no other file knows obvhs or its vector types. The infinite ground needs
//! no box: it is tested by itself.
//!
//! # What hides what
//!
//! *An organ never hides itself nor its own bud.* A ray does not see the organs it is told to be `blind` to
//! (the prober and the internode it sits on), nor any wood that encloses its own origin (the joint a bud or
//! leaf grows from). Nothing else is skipped; an organ that reads another's map does so [without] its own. In
//! particular a solid hides everything from a point inside it,
//! and underground it is dark.
//!
//! [without]: super::cube_map::CubeMap::without
//!
//! Of equal depths the lowest birth is seen; then lamps, solids and the ground, in this order (`LK-13`). The
//! answers are those of testing every occluder in turn: they do not depend on the tree of boxes.

mod form;
mod packet;
#[cfg(test)]
mod tests;

use bevy::math::Vec3;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use smallvec::SmallVec;

use super::scene::Scene;
use form::Form;
pub use packet::Texel;
pub(crate) use packet::{FaceRays, Frame};

/// A point this little below the ground still counts as on it, metres.
const GROUND_SKIN: f32 = 1e-3;
/// Farther than this from the origin nothing is seen, metres: squares of distances stay finite.
const FARTHEST: f32 = 1e12;
/// Birth of things that were never born.
const UNBORN: u32 = u32::MAX;

/// What a ray met.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Seen {
    /// Nothing.
    Sky,
    /// The infinite ground.
    Ground,
    /// A solid, by its index in the scene.
    Solid(u32),
    /// A lamp, burning or not, by its index in the scene.
    Lamp(u32),
    /// Wood, by its index in the scene's capsules.
    Wood(u32),
    /// A leaf, by its index in the scene's leaves.
    Leaf(u32),
}

/// Where a ray met something.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance in units of the ray direction's length; infinite for the sky.
    pub t: f32,
    /// What was met.
    pub seen: Seen,
    /// Unit normal of the surface, turned to the ray's origin; zero for the sky.
    pub normal: Vec3,
}

impl Hit {
    const SKY: Self = Self { t: f32::INFINITY, seen: Seen::Sky, normal: Vec3::ZERO };
}

/// An occluder in the order of the boxes.
#[derive(Debug, Clone, Copy)]
struct Item {
    form: Form,
    seen: Seen,
    /// Birth of the organ, or [`UNBORN`].
    birth: u32,
}

impl Item {
    /// Of equal depths the lowest is seen.
    fn rank(&self) -> (u32, u8, u32) {
        match self.seen {
            Seen::Wood(i) => (self.birth, 0, i),
            Seen::Leaf(i) => (self.birth, 1, i),
            Seen::Lamp(i) => (self.birth, 2, i),
            Seen::Solid(i) => (self.birth, 3, i),
            Seen::Ground | Seen::Sky => (self.birth, 4, 0),
        }
    }

    fn is_wood(&self) -> bool {
        matches!(self.seen, Seen::Wood(_))
    }

    /// Whether a ray from `origin` passes as if this were not there.
    fn is_unseen_from(&self, origin: Vec3, blind: &[u32]) -> bool {
        (self.birth != UNBORN && blind.contains(&self.birth))
            || (self.is_wood() && self.form.encloses(origin))
    }

    /// Distance to the surface; 0 inside solids and lamps. The origin is not in wood.
    #[inline]
    fn distance(&self, origin: Vec3, d: Vec3, dd: f32) -> Option<f32> {
        match self.form.entry(origin, d, dd) {
            None if !self.is_wood() && self.form.encloses(origin) => Some(0.0),
            t => t,
        }
    }
}

/// A box of the tree: `count` items from `first`, or if `count` is 0 the two boxes at `first`.
#[derive(Debug, Clone, Copy)]
struct Node {
    min: [f32; 3],
    first: u32,
    max: [f32; 3],
    count: u32,
}

type Stack = SmallVec<[(u32, f32); 64]>;

/// A scene made ready for rays.
#[derive(Debug, Clone)]
pub struct Tracer<'a> {
    scene: &'a Scene,
    nodes: Vec<Node>,
    items: Vec<Item>,
}

impl<'a> Tracer<'a> {
    /// Makes a scene ready. Occluders without extent or with numbers that are not finite are left out.
    pub fn build(scene: &'a Scene) -> Self {
        let items = gather(scene);
        let boxes: Vec<Aabb> = items.iter().map(|item| padded(&item.form)).collect();
        let mut took = std::time::Duration::ZERO;
        let params = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::slow_build() };
        let bvh = build_bvh2(&boxes, params, &mut took);
        let nodes = bvh
            .nodes
            .iter()
            .map(|node| Node {
                min: node.aabb().min.into(),
                first: node.first_index,
                max: node.aabb().max.into(),
                count: node.prim_count,
            })
            .collect();
        let items = bvh.primitive_indices.iter().map(|&i| items[i as usize]).collect();
        Self { scene, nodes, items }
    }

    /// The scene it was built from.
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// Birth number of what was seen, if it is an organ.
    pub fn birth(&self, seen: Seen) -> Option<u32> {
        match seen {
            Seen::Wood(i) => self.scene.capsules.get(i as usize).map(|capsule| capsule.organ),
            Seen::Leaf(i) => self.scene.leaves.get(i as usize).map(|leaf| leaf.organ),
            Seen::Sky | Seen::Ground | Seen::Solid(_) | Seen::Lamp(_) => None,
        }
    }

    /// Whether what was seen is a light: sky, or a burning lamp.
    pub fn is_light(&self, seen: Seen) -> bool {
        match seen {
            Seen::Sky => true,
            Seen::Lamp(i) => self.scene.lamps.get(i as usize).is_some_and(|standing| standing.lamp.on),
            Seen::Ground | Seen::Solid(_) | Seen::Wood(_) | Seen::Leaf(_) => false,
        }
    }

    /// The first thing met within `tmax`, in units of `direction`'s length; the sky if there is none or if
    /// the ray is not finite.
    pub fn closest(&self, origin: Vec3, direction: Vec3, tmax: f32, blind: &[u32]) -> Hit {
        let dd = direction.length_squared();
        if !usable(origin, dd) {
            return Hit::SKY;
        }
        let mut best = self.ground(origin, direction).filter(|&t| t <= tmax);
        let mut found: Option<&Item> = None;
        self.visit(origin, direction, best.unwrap_or(tmax), |item, reach| {
            if let Some(t) = item.distance(origin, direction, dd)
                && (t < *reach || (t == *reach && found.is_none_or(|other| item.rank() < other.rank())))
                && !item.is_unseen_from(origin, blind)
            {
                (best, found, *reach) = (Some(t), Some(item), t);
            }
            false
        });
        let Some(t) = best else {
            return Hit::SKY;
        };
        let (seen, normal) = match found {
            None => (Seen::Ground, Vec3::Y),
            Some(item) => (item.seen, item.form.normal(origin + direction * t)),
        };
        let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
        Hit { t, seen, normal }
    }

    /// Whether wood, leaf, solid, ground or a lamp that is off stands within `tmax`, in units of
    /// `direction`'s length. Burning lamps hide nothing.
    pub fn occluded(&self, origin: Vec3, direction: Vec3, tmax: f32, blind: &[u32]) -> bool {
        let dd = direction.length_squared();
        if !usable(origin, dd) {
            return false;
        }
        if self.ground(origin, direction).is_some_and(|t| t <= tmax) {
            return true;
        }
        self.visit(origin, direction, tmax, |item, reach| {
            let burning = matches!(item.seen, Seen::Lamp(_)) && self.is_light(item.seen);
            !burning
                && item.distance(origin, direction, dd).is_some_and(|t| t <= *reach)
                && !item.is_unseen_from(origin, blind)
        })
    }

    /// Whether a point is underground or inside a solid: dark, and no place to grow to.
    pub fn is_buried(&self, point: Vec3) -> bool {
        self.scene.ground.is_some_and(|ground| point.y < ground - GROUND_SKIN)
            || self.around(point, |item| matches!(item.seen, Seen::Solid(_)))
    }

    /// Whether a shoot from `origin` could not end at `point`: it would be underground, behind or in a
    /// solid, or in wood that it neither starts in nor is blind to.
    pub(crate) fn is_barred(&self, origin: Vec3, point: Vec3, blind: &[u32]) -> bool {
        let way = point - origin;
        let dd = way.length_squared();
        self.is_buried(point)
            || self.around(point, |item| item.is_wood() && !item.is_unseen_from(origin, blind))
            || (usable(origin, dd)
                && self.visit(origin, way, 1.0, |item, reach| {
                    matches!(item.seen, Seen::Solid(_))
                        && item.distance(origin, way, dd).is_some_and(|t| t <= *reach)
                }))
    }

    /// Unit normal of a flat thing at a point of its surface; `None` for wood, lamps and the sky.
    pub(crate) fn flat_normal(&self, seen: Seen, point: Vec3) -> Option<Vec3> {
        match seen {
            Seen::Ground => Some(Vec3::Y),
            Seen::Leaf(i) => {
                let leaf = self.scene.leaves.get(i as usize)?;
                leaf.midrib.cross(leaf.across).try_normalize()
            }
            Seen::Solid(i) => Form::solid(self.scene.solids.get(i as usize)?)?.normal(point).try_normalize(),
            Seen::Wood(_) | Seen::Lamp(_) | Seen::Sky => None,
        }
    }

    /// Whether a form that encloses the point meets a condition.
    fn around(&self, point: Vec3, condition: impl Fn(&Item) -> bool) -> bool {
        let mut stack: SmallVec<[u32; 64]> = SmallVec::new();
        stack.extend((!self.nodes.is_empty()).then_some(0));
        while let Some(index) = stack.pop() {
            let node = &self.nodes[index as usize];
            if !(0..3).all(|k| (node.min[k]..=node.max[k]).contains(&point[k])) {
                continue;
            }
            if node.count == 0 {
                stack.extend([node.first, node.first + 1]);
                continue;
            }
            let items = &self.items[node.first as usize..(node.first + node.count) as usize];
            if items.iter().any(|item| condition(item) && item.form.encloses(point)) {
                return true;
            }
        }
        false
    }

    /// Distance to the ground.
    fn ground(&self, origin: Vec3, d: Vec3) -> Option<f32> {
        let height = origin.y - self.scene.ground?;
        if height < -GROUND_SKIN {
            Some(0.0)
        } else if d.y < 0.0 {
            Some((height.max(0.0) / -d.y).min(FARTHEST))
        } else {
            None
        }
    }

    /// Shows every item whose box the ray meets within `reach`, nearer boxes first, until told to stop.
    fn visit<'b>(
        &'b self,
        o: Vec3,
        d: Vec3,
        reach: f32,
        mut test: impl FnMut(&'b Item, &mut f32) -> bool,
    ) -> bool {
        let inverse = inverse(d);
        !self.nodes.is_empty()
            && self.visit_below(0, &o.to_array(), &inverse, reach, |index, reach| {
                test(&self.items[index as usize], reach)
            })
    }

    /// The same for the boxes in one box, which is not tested itself, with the indices of the items.
    #[inline]
    fn visit_below(
        &self,
        top: u32,
        o: &[f32; 3],
        inverse: &[f32; 3],
        mut reach: f32,
        mut test: impl FnMut(u32, &mut f32) -> bool,
    ) -> bool {
        let mut stack = Stack::new();
        let mut index = top;
        loop {
            let node = &self.nodes[index as usize];
            if node.count > 0 {
                for item in node.first..node.first + node.count {
                    if test(item, &mut reach) {
                        return true;
                    }
                }
            } else {
                let (left, right) = (node.first, node.first + 1);
                let a = self.nodes[left as usize].enter(o, inverse, reach);
                let b = self.nodes[right as usize].enter(o, inverse, reach);
                match (a, b) {
                    (Some(a), Some(b)) => {
                        let (near, far) = if a <= b { (left, (right, b)) } else { (right, (left, a)) };
                        stack.push(far);
                        index = near;
                        continue;
                    }
                    (Some(_), None) => {
                        index = left;
                        continue;
                    }
                    (None, Some(_)) => {
                        index = right;
                        continue;
                    }
                    (None, None) => {}
                }
            }
            loop {
                let Some((next, t)) = stack.pop() else {
                    return false;
                };
                if t <= reach {
                    index = next;
                    break;
                }
            }
        }
    }
}

impl Node {
    /// Where a ray enters the box, if it does so within `reach`.
    #[inline]
    fn enter(&self, o: &[f32; 3], inverse: &[f32; 3], reach: f32) -> Option<f32> {
        let (mut near, mut far) = (0.0_f32, reach);
        for k in 0..3 {
            let a = (self.min[k] - o[k]) * inverse[k];
            let b = (self.max[k] - o[k]) * inverse[k];
            near = larger(near, smaller(a, b));
            // The factor outweighs the rounding of both ends.
            far = smaller(far, larger(a, b) * 1.000_001);
        }
        (near <= far).then_some(near)
    }
}

/// Numbers here are never NaN, which `f32::min` and `max` take pains to treat.
#[inline]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// One over each part of a direction; very large instead of infinite.
fn inverse(d: Vec3) -> [f32; 3] {
    d.to_array().map(|x| if x.abs() < 1e-18 { 1e18_f32.copysign(x) } else { 1.0 / x })
}

fn usable(origin: Vec3, dd: f32) -> bool {
    origin.is_finite() && dd.is_finite() && dd > 0.0
}

fn gather(scene: &Scene) -> Vec<Item> {
    let wood = scene
        .capsules
        .iter()
        .enumerate()
        .map(|(i, capsule)| (Form::wood(capsule), Seen::Wood(i as u32), capsule.organ));
    let leaves =
        scene.leaves.iter().enumerate().map(|(i, leaf)| (Form::leaf(leaf), Seen::Leaf(i as u32), leaf.organ));
    let lamps = scene.lamps.iter().enumerate().map(|(i, standing)| {
        (Form::ball(standing.position, standing.lamp.radius), Seen::Lamp(i as u32), UNBORN)
    });
    let solids =
        scene.solids.iter().enumerate().map(|(i, solid)| (Form::solid(solid), Seen::Solid(i as u32), UNBORN));
    wood.chain(leaves)
        .chain(lamps)
        .chain(solids)
        .filter_map(|(form, seen, birth)| Some(Item { form: form?, seen, birth }))
        .collect()
}

/// A form's box, a little larger: flat leaves get a thickness, and rounding never loses a hit.
fn padded(form: &Form) -> Aabb {
    let (min, max) = form.bounds();
    let pad = 1e-6 + 1e-6 * min.abs().max(max.abs()).max_element();
    let limit = Vec3::splat(FARTHEST);
    let (min, max) = ((min - pad).clamp(-limit, limit), (max + pad).clamp(-limit, limit));
    Aabb::new(min.to_array().into(), max.to_array().into())
}
