//! All rays of a cube-map face at once.
//!
//! Rays of a face share their origin, so a box covers a rectangle of texels: the tree of boxes is walked once
//! a face instead of once a texel, front to back. A box whose rectangle falls between texels or is already
//! covered by nearer things is passed over; what is in a box of very few texels is left to their single rays,
//! which have less to reckon. Each item is tested with the very arithmetic of a single ray: the answers are
//! the same, bit for bit.

use bevy::math::Vec3;

use super::{Item, Node, Seen, Tracer, inverse, larger, smaller, usable};

/// The orientation of a face: signed world axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frame {
    /// Across the face, to growing columns: axis and sign.
    pub(crate) right: (usize, f32),
    /// Up the face, to falling rows: axis and sign.
    pub(crate) up: (usize, f32),
    /// The way it looks: axis and sign.
    pub(crate) forward: (usize, f32),
}

/// What one texel shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Texel {
    /// Planar depth, metres; infinite for the sky.
    pub depth: f32,
    /// What was seen.
    pub seen: Seen,
    /// Whether it shows light: sky or a burning lamp.
    pub bright: bool,
}

/// Rays of one face: `forward + a right + b up` with a and b at texel centres.
#[derive(Debug, Clone)]
pub(crate) struct FaceRays {
    pub(crate) frame: Frame,
    pub(crate) size: usize,
    /// World directions with a planar part of 1, row by row from the top.
    pub(crate) directions: Vec<Vec3>,
    /// Their squared lengths.
    pub(crate) squares: Vec<f32>,
    /// One over their parts.
    inverses: Vec<[f32; 3]>,
}

impl FaceRays {
    pub(crate) fn new(frame: Frame, size: usize) -> Self {
        let axis = |(axis, sign): (usize, f32)| Vec3::AXES[axis] * sign;
        let (right, up, forward) = (axis(frame.right), axis(frame.up), axis(frame.forward));
        let at = |i: usize| (2 * i + 1) as f32 / size as f32 - 1.0;
        let directions: Vec<Vec3> =
            (0..size * size).map(|i| forward + right * at(i % size) - up * at(i / size)).collect();
        let squares = directions.iter().map(|d| d.length_squared()).collect();
        let inverses = directions.iter().map(|&d| inverse(d)).collect();
        Self { frame, size, directions, squares, inverses }
    }
}

/// Texels a box may cover: columns and rows, ends included.
#[derive(Clone, Copy)]
struct Rect {
    columns: (u32, u32),
    rows: (u32, u32),
}

impl Rect {
    fn texels(self) -> u32 {
        (self.columns.1 - self.columns.0 + 1) * (self.rows.1 - self.rows.0 + 1)
    }

    fn indices(self, size: usize) -> impl Iterator<Item = usize> {
        let Self { columns, rows } = self;
        (rows.0..=rows.1).flat_map(move |row| {
            (columns.0..=columns.1).map(move |column| row as usize * size + column as usize)
        })
    }
}

struct Entry {
    node: u32,
    near: f32,
    rect: Rect,
}

/// A box of no more texels is left to single rays.
const FEW: u32 = 4;
const SKY: u32 = u32::MAX;
const GROUND: u32 = u32::MAX - 1;

impl Tracer<'_> {
    /// Renders one face at `origin` and appends its texels.
    pub(crate) fn face(&self, rays: &FaceRays, origin: Vec3, blind: &[u32], texels: &mut Vec<Texel>) {
        if !usable(origin, 1.0) {
            let sky = Texel { depth: f32::INFINITY, seen: Seen::Sky, bright: true };
            texels.extend(std::iter::repeat_n(sky, rays.directions.len()));
            return;
        }
        let mut found: Vec<(f32, u32)> = rays
            .directions
            .iter()
            .map(|&d| self.ground(origin, d).map_or((f32::INFINITY, SKY), |t| (t, GROUND)))
            .collect();
        let view = View::new(rays, origin);
        let mut stack: Vec<Entry> = Vec::with_capacity(64);
        if let Some(root) = self.nodes.first() {
            stack.extend(view.entry(0, root));
        }
        while let Some(Entry { node, near, rect }) = stack.pop() {
            if view.is_covered(&found, rect, near) {
                continue;
            }
            let Node { first, count, .. } = self.nodes[node as usize];
            if count == 0 && rect.texels() <= FEW {
                for i in rect.indices(rays.size) {
                    let reach = found[i].0;
                    self.visit_below(node, &origin.to_array(), &rays.inverses[i], reach, |index, reach| {
                        self.draw(index, &view, i, blind, &mut found);
                        *reach = found[i].0;
                        false
                    });
                }
                continue;
            }
            if count == 0 {
                let left = view.entry(first, &self.nodes[first as usize]);
                let right = view.entry(first + 1, &self.nodes[first as usize + 1]);
                match (left, right) {
                    (Some(a), Some(b)) if a.near <= b.near => stack.extend([b, a]),
                    (Some(a), Some(b)) => stack.extend([a, b]),
                    (one, other) => stack.extend(one.or(other)),
                }
                continue;
            }
            for index in first..first + count {
                for i in rect.indices(rays.size) {
                    self.draw(index, &view, i, blind, &mut found);
                }
            }
        }
        texels.extend(found.iter().map(|&(depth, item)| {
            let seen = match item {
                SKY => Seen::Sky,
                GROUND => Seen::Ground,
                _ => self.items[item as usize].seen,
            };
            Texel { depth, seen, bright: self.is_light(seen) }
        }));
    }

    /// Enters an item into texel `i` if it is seen there.
    #[inline]
    fn draw(&self, index: u32, view: &View, i: usize, blind: &[u32], found: &mut [(f32, u32)]) {
        let item = &self.items[index as usize];
        let (d, dd) = (view.rays.directions[i], view.rays.squares[i]);
        if let Some(t) = item.distance(view.origin, d, dd) {
            let (depth, other) = found[i];
            let nearer = t < depth || (t == depth && self.outranks(item, other));
            if nearer && !item.is_unseen_from(view.origin, blind) {
                found[i] = (t, index);
            }
        }
    }

    fn outranks(&self, item: &Item, other: u32) -> bool {
        self.items.get(other as usize).is_none_or(|other| item.rank() < other.rank())
    }
}

/// A face seen from its origin, with what every box test needs.
struct View<'a> {
    rays: &'a FaceRays,
    origin: Vec3,
    right: Axis,
    up: Axis,
    forward: Axis,
    /// Texels from the middle of the face to its edge.
    half: f32,
    last: i32,
}

/// A signed world axis, and the origin along it.
#[derive(Clone, Copy)]
struct Axis {
    axis: usize,
    sign: f32,
    origin: f32,
}

impl Axis {
    fn new((axis, sign): (usize, f32), origin: Vec3) -> Self {
        Self { axis, sign, origin: origin[axis] }
    }

    /// Extent of a box along the axis, seen from the origin.
    #[inline]
    fn span(self, node: &Node) -> (f32, f32) {
        let a = (node.min[self.axis] - self.origin) * self.sign;
        let b = (node.max[self.axis] - self.origin) * self.sign;
        (smaller(a, b), larger(a, b))
    }
}

impl<'a> View<'a> {
    fn new(rays: &'a FaceRays, origin: Vec3) -> Self {
        let Frame { right, up, forward } = rays.frame;
        Self {
            rays,
            origin,
            right: Axis::new(right, origin),
            // Rows count down.
            up: Axis::new((up.0, -up.1), origin),
            forward: Axis::new(forward, origin),
            half: rays.size as f32 * 0.5,
            last: rays.size as i32 - 1,
        }
    }

    /// The texels a box may cover and its least depth; `None` if it shows in no texel.
    #[inline]
    fn entry(&self, index: u32, node: &Node) -> Option<Entry> {
        let (near, far) = self.forward.span(node);
        if far <= 0.0 {
            return None;
        }
        // A box reaching behind the face may cover it up to its edge on the side it lies on.
        let nearest = if near > 0.0 { 1.0 / near } else { 1e30 };
        let farthest = 1.0 / far;
        let columns = self.range(self.right.span(node), nearest, farthest)?;
        let rows = self.range(self.up.span(node), nearest, farthest)?;
        Some(Entry { node: index, near: near.max(0.0), rect: Rect { columns, rows } })
    }

    /// The texels between the two sides of a box along an axis, its depths given by their reciprocals.
    #[inline]
    fn range(&self, (low, high): (f32, f32), nearest: f32, farthest: f32) -> Option<(u32, u32)> {
        let low = (low * if low < 0.0 { nearest } else { farthest }).clamp(-2.0, 2.0);
        let high = (high * if high > 0.0 { nearest } else { farthest }).clamp(-2.0, 2.0);
        // Texel i lies at (i + 1/2) / half - 1. A thousandth of a texel outweighs rounding.
        let first = round((low + 1.0) * self.half - 1e-3).max(0);
        let last = round((high + 1.0) * self.half - (1.0 - 1e-3)).min(self.last);
        (first <= last).then_some((first as u32, last as u32))
    }

    /// Whether every texel of the rectangle already sees something nearer.
    #[inline]
    fn is_covered(&self, found: &[(f32, u32)], rect: Rect, near: f32) -> bool {
        (rect.rows.0..=rect.rows.1).all(|row| {
            let row = row as usize * self.rays.size;
            found[row + rect.columns.0 as usize..=row + rect.columns.1 as usize]
                .iter()
                .all(|&(depth, _)| depth < near)
        })
    }
}

/// The nearest whole number, for numbers well below 2^22: adding 1.5 x 2^23 leaves it in the lowest bits.
/// Without the instructions of newer processors `f32::round` is a function call.
#[inline]
fn round(x: f32) -> i32 {
    const SHIFT: f32 = 12_582_912.0;
    (x + SHIFT).to_bits() as i32 - SHIFT.to_bits() as i32
}
