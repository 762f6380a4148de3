//! All rays of a cube-map face at once.
//!
//! Rays of a face share their origin, so a box covers a rectangle of texels: the tree of boxes is walked once
//! a face instead of once a texel, front to back. A box whose rectangle falls between texels or is already
//! covered by nearer things is passed over. Each item is tested against the texels of its rectangle with the
//! very arithmetic of a single ray: the answers are the same, bit for bit.

use bevy::math::Vec3;

use super::{Item, Node, Seen, Tracer, usable};

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
}

impl FaceRays {
    pub(crate) fn new(frame: Frame, size: usize) -> Self {
        let axis = |(axis, sign): (usize, f32)| Vec3::AXES[axis] * sign;
        let (right, up, forward) = (axis(frame.right), axis(frame.up), axis(frame.forward));
        let at = |i: usize| (2 * i + 1) as f32 / size as f32 - 1.0;
        let directions: Vec<Vec3> =
            (0..size * size).map(|i| forward + right * at(i % size) - up * at(i / size)).collect();
        let squares = directions.iter().map(|d| d.length_squared()).collect();
        Self { frame, size, directions, squares }
    }
}

/// Texels a box may cover: columns and rows, ends included.
#[derive(Clone, Copy)]
struct Rect {
    columns: (u32, u32),
    rows: (u32, u32),
}

struct Entry {
    node: u32,
    near: f32,
    rect: Rect,
}

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
        let view = View { rays, origin };
        let mut stack: Vec<Entry> = Vec::with_capacity(64);
        if let Some(root) = self.nodes.first() {
            stack.extend(view.entry(0, root));
        }
        while let Some(Entry { node, near, rect }) = stack.pop() {
            if view.is_covered(&found, rect, near) {
                continue;
            }
            let Node { first, count, .. } = self.nodes[node as usize];
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
                let item = &self.items[index as usize];
                if !item.is_unseen_from(origin, blind) {
                    self.draw(item, index, &view, rect, &mut found);
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

    /// Enters an item into the texels that see it.
    #[inline]
    fn draw(&self, item: &Item, index: u32, view: &View, rect: Rect, found: &mut [(f32, u32)]) {
        for row in rect.rows.0..=rect.rows.1 {
            for column in rect.columns.0..=rect.columns.1 {
                let i = row as usize * view.rays.size + column as usize;
                let (d, dd) = (view.rays.directions[i], view.rays.squares[i]);
                let Some(t) = item.distance(view.origin, d, dd) else {
                    continue;
                };
                let (depth, other) = found[i];
                let nearer = t < depth || (t == depth && self.outranks(item, other));
                if nearer {
                    found[i] = (t, index);
                }
            }
        }
    }

    fn outranks(&self, item: &Item, other: u32) -> bool {
        self.items.get(other as usize).is_none_or(|other| item.rank() < other.rank())
    }
}

struct View<'a> {
    rays: &'a FaceRays,
    origin: Vec3,
}

impl View<'_> {
    /// The texels a box may cover and its least depth; `None` if it shows in no texel.
    #[inline]
    fn entry(&self, index: u32, node: &Node) -> Option<Entry> {
        let Frame { right, up, forward } = self.rays.frame;
        let (near, far) = self.span(node, forward);
        if far < 0.0 {
            return None;
        }
        let size = self.rays.size as f32;
        let limits = |(low, high): (f32, f32)| {
            // A box reaching behind the face may cover it up to its edge on the side it lies on.
            let low = if low >= 0.0 {
                low / far
            } else if near > 0.0 {
                low / near
            } else {
                -2.0
            };
            let high = if high <= 0.0 {
                high / far
            } else if near > 0.0 {
                high / near
            } else {
                2.0
            };
            (low, high)
        };
        // Texel i lies at (2 i + 1) / size - 1; a thousandth of a texel outweighs rounding.
        let texel = |x: f32| (x + 1.0) * 0.5 * size - 0.5;
        let range = |(low, high): (f32, f32)| {
            let first = (texel(low) - 1e-3).ceil().max(0.0);
            let last = (texel(high) + 1e-3).floor().min(size - 1.0);
            (first <= last).then_some((first as u32, last as u32))
        };
        let columns = range(limits(self.span(node, right)))?;
        let (low, high) = limits(self.span(node, up));
        let rows = range((-high, -low))?;
        Some(Entry { node: index, near: near.max(0.0), rect: Rect { columns, rows } })
    }

    /// Extent of a box along a signed axis, seen from the origin.
    #[inline]
    fn span(&self, node: &Node, (axis, sign): (usize, f32)) -> (f32, f32) {
        let origin = self.origin[axis];
        let (low, high) = (node.min[axis] - origin, node.max[axis] - origin);
        if sign > 0.0 { (low, high) } else { (-high, -low) }
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
