//! Forms a ray can meet, and where it does.
//!
//! Directions need not be unit vectors: distances are in units of the direction's length, so a ray
//! `forward + a right + b up` meets things at their planar depth along `forward`.
//!
//! Thin wood far away would drown in rounding, so round forms are tested from the point of the ray nearest
//! to their centre, where all numbers are small.

use std::sync::OnceLock;

use bevy::math::Vec3;

use crate::environment::scene::{Capsule, LeafPatch, SolidShape, StandingSolid};
use crate::shape::outline::LeafOutline;

/// Steps of the outline tables.
const OUTLINE_STEPS: usize = 128;

/// Half widths of an outline at even steps from base to tip.
type OutlineTable = [f32; OUTLINE_STEPS + 1];

/// A form, ready to be tested.
#[derive(Debug, Clone, Copy)]
pub(super) enum Form {
    /// All points within `radius` of a segment.
    Rod { middle: Vec3, axis: Vec3, half: f32, radius: f32 },
    /// A flat blade; `along` and `across` map a point to 0..1 and -1..1.
    Blade { base: Vec3, along: Vec3, across: Vec3, normal: Vec3, outline: &'static OutlineTable },
    /// A turned box.
    Block { center: Vec3, axes: [Vec3; 3], half: Vec3 },
    /// A turned cylinder about its second axis.
    Pillar { center: Vec3, axes: [Vec3; 3], radius: f32, half: f32 },
}

fn outline_table(outline: LeafOutline) -> &'static OutlineTable {
    static TABLES: OnceLock<Vec<OutlineTable>> = OnceLock::new();
    let tables = TABLES.get_or_init(|| {
        LeafOutline::ALL
            .iter()
            .map(|outline| std::array::from_fn(|i| outline.half_width(i as f32 / OUTLINE_STEPS as f32)))
            .collect()
    });
    let index = LeafOutline::ALL.iter().position(|&known| known == outline).unwrap_or(0);
    &tables[index]
}

fn half_width(table: &OutlineTable, s: f32) -> f32 {
    let x = s.clamp(0.0, 1.0) * OUTLINE_STEPS as f32;
    let i = (x as usize).min(OUTLINE_STEPS - 1);
    table[i] + (table[i + 1] - table[i]) * (x - i as f32)
}

impl Form {
    /// Wood; `None` if it has no thickness or is not finite.
    pub(super) fn wood(capsule: &Capsule) -> Option<Form> {
        let &Capsule { from, to, radius, .. } = capsule;
        let usable = from.is_finite() && to.is_finite() && radius.is_finite() && radius > 0.0;
        let length = (to - from).length();
        let axis = if length > 0.0 { (to - from) / length } else { Vec3::Y };
        usable.then_some(Form::Rod { middle: (from + to) * 0.5, axis, half: length * 0.5, radius })
    }

    /// A leaf; `None` if it has no area or is not finite.
    pub(super) fn leaf(leaf: &LeafPatch) -> Option<Form> {
        let &LeafPatch { base, midrib, across, outline, .. } = leaf;
        let (length, width) = (midrib.length_squared(), across.length_squared());
        let (along, across) = (midrib / length, across / width);
        let normal = leaf.midrib.cross(leaf.across).normalize_or_zero();
        let usable = base.is_finite() && along.is_finite() && across.is_finite() && normal != Vec3::ZERO;
        usable.then(|| Form::Blade { base, along, across, normal, outline: outline_table(outline) })
    }

    /// A ball; `None` if it has no size or is not finite.
    pub(super) fn ball(center: Vec3, radius: f32) -> Option<Form> {
        let usable = center.is_finite() && radius.is_finite() && radius > 0.0;
        usable.then_some(Form::Rod { middle: center, axis: Vec3::Y, half: 0.0, radius })
    }

    /// A solid; `None` if it has no size or is not finite.
    pub(super) fn solid(solid: &StandingSolid) -> Option<Form> {
        let center = solid.position;
        let turn = solid.rotation;
        let axes = [turn * Vec3::X, turn * Vec3::Y, turn * Vec3::Z];
        if !center.is_finite() || !turn.is_finite() {
            return None;
        }
        match solid.shape {
            SolidShape::Box { size } => {
                let half = size.abs() * 0.5;
                (half.is_finite() && half.min_element() > 0.0).then_some(Form::Block { center, axes, half })
            }
            SolidShape::Ball { radius } => Form::ball(center, radius.abs()),
            SolidShape::Cylinder { radius, height } => {
                let (radius, half) = (radius.abs(), height.abs() * 0.5);
                let usable = radius.is_finite() && half.is_finite() && radius > 0.0 && half > 0.0;
                usable.then_some(Form::Pillar { center, axes, radius, half })
            }
        }
    }

    /// Corners of the box about the form, aligned with the world.
    pub(super) fn bounds(&self) -> (Vec3, Vec3) {
        match *self {
            Form::Rod { middle, axis, half, radius } => {
                let reach = (axis * half).abs() + radius;
                (middle - reach, middle + reach)
            }
            Form::Blade { base, along, across, .. } => {
                // `along` is midrib / length², so dividing by its own square gives the midrib back.
                let midrib = along / along.length_squared();
                let across = (across / across.length_squared()).abs();
                let (a, b) = (base, base + midrib);
                (a.min(b) - across, a.max(b) + across)
            }
            Form::Block { center, axes: [x, y, z], half } => {
                let reach = (x * half.x).abs() + (y * half.y).abs() + (z * half.z).abs();
                (center - reach, center + reach)
            }
            Form::Pillar { center, axes: [x, y, z], radius, half } => {
                let reach = (x * radius).abs() + (y * half).abs() + (z * radius).abs();
                (center - reach, center + reach)
            }
        }
    }

    /// Whether the form has an inside and `point` lies in it (or on its surface, but for rounding).
    pub(super) fn encloses(&self, point: Vec3) -> bool {
        match *self {
            Form::Rod { middle, axis, half, radius } => {
                let q = point - middle;
                let on_axis = axis * q.dot(axis).clamp(-half, half);
                (q - on_axis).length_squared() <= radius * radius * 1.0001
            }
            Form::Blade { .. } => false,
            Form::Block { center, axes, half } => {
                let q = local(point - center, &axes).abs();
                q.cmple(half).all()
            }
            Form::Pillar { center, axes, radius, half } => {
                let q = local(point - center, &axes);
                q.y.abs() <= half && q.x * q.x + q.z * q.z <= radius * radius
            }
        }
    }

    /// Where a ray from outside enters the form, if it does; `dd` is the squared length of `d`.
    #[inline]
    pub(super) fn entry(&self, origin: Vec3, d: Vec3, dd: f32) -> Option<f32> {
        match *self {
            Form::Rod { middle, axis, half, radius } => {
                let to_middle = middle - origin;
                let t0 = to_middle.dot(d) / dd;
                let q = d * t0 - to_middle;
                let reach = half + radius;
                if q.length_squared() > reach * reach {
                    return None;
                }
                rod(q, d, dd, axis, half, radius).map(|t| t0 + t).filter(|&t| t >= 0.0)
            }
            Form::Blade { base, along, across, normal, outline } => {
                let towards = normal.dot(d);
                if towards == 0.0 {
                    return None;
                }
                let to_base = base - origin;
                let t = normal.dot(to_base) / towards;
                if !(0.0..f32::INFINITY).contains(&t) {
                    return None;
                }
                let p = d * t - to_base;
                let s = p.dot(along);
                if !(0.0..=1.0).contains(&s) {
                    return None;
                }
                (p.dot(across).abs() <= half_width(outline, s)).then_some(t)
            }
            Form::Block { center, axes, half } => {
                let (o, d) = (local(origin - center, &axes), local(d, &axes));
                let (mut enter, mut leave) = (0.0_f32, f32::INFINITY);
                for k in 0..3 {
                    if d[k].abs() < 1e-12 {
                        if o[k].abs() > half[k] {
                            return None;
                        }
                        continue;
                    }
                    let (a, b) = ((-half[k] - o[k]) / d[k], (half[k] - o[k]) / d[k]);
                    enter = enter.max(a.min(b));
                    leave = leave.min(a.max(b));
                }
                (enter <= leave).then_some(enter)
            }
            Form::Pillar { center, axes, radius, half } => {
                let (o, d) = (local(origin - center, &axes), local(d, &axes));
                let t0 = -o.dot(d) / dd;
                pillar(o + d * t0, d, radius, half).filter(|&(_, leave)| t0 + leave >= 0.0).map(
                    // Inside, the wall begins at once.
                    |(enter, _)| (t0 + enter).max(0.0),
                )
            }
        }
    }

    /// Outward unit normal at a point of the surface; of a blade, either side's.
    pub(super) fn normal(&self, point: Vec3) -> Vec3 {
        match *self {
            Form::Rod { middle, axis, half, .. } => {
                let q = point - middle;
                (q - axis * q.dot(axis).clamp(-half, half)).normalize_or_zero()
            }
            Form::Blade { normal, .. } => normal,
            Form::Block { center, axes, half } => {
                let q = local(point - center, &axes);
                let depth = q.abs() - half;
                let k = if depth.x >= depth.y && depth.x >= depth.z {
                    0
                } else if depth.y >= depth.z {
                    1
                } else {
                    2
                };
                axes[k] * q[k].signum()
            }
            Form::Pillar { center, axes, radius, half } => {
                let q = local(point - center, &axes);
                let side = (q.x * q.x + q.z * q.z).sqrt();
                if q.y.abs() - half > side - radius {
                    axes[1] * q.y.signum()
                } else {
                    ((axes[0] * q.x + axes[2] * q.z) / side).normalize_or_zero()
                }
            }
        }
    }
}

fn local(v: Vec3, axes: &[Vec3; 3]) -> Vec3 {
    Vec3::new(v.dot(axes[0]), v.dot(axes[1]), v.dot(axes[2]))
}

/// Entry into the rod about the origin, from point `q` along `d`; may be negative.
#[inline]
fn rod(q: Vec3, d: Vec3, dd: f32, axis: Vec3, half: f32, radius: f32) -> Option<f32> {
    let (du, qu) = (d.dot(axis), q.dot(axis));
    let along = if half > 0.0 {
        let a = dd - du * du;
        let b = q.dot(d) - qu * du;
        let c = q.length_squared() - qu * qu - radius * radius;
        let h = b * b - a * c;
        if h < 0.0 {
            return None;
        }
        if a > 1e-7 * dd {
            let t = (-b - h.sqrt()) / a;
            let y = qu + t * du;
            if y.abs() <= half {
                return Some(t);
            }
            y
        } else {
            -du
        }
    } else {
        0.0
    };
    let e = q - axis * half.copysign(along);
    let b = e.dot(d);
    let h = b * b - dd * (e.length_squared() - radius * radius);
    (h >= 0.0).then(|| (-b - h.sqrt()) / dd)
}

/// Where a line through `q` along `d` enters and leaves a cylinder about the second axis.
fn pillar(q: Vec3, d: Vec3, radius: f32, half: f32) -> Option<(f32, f32)> {
    let (mut enter, mut leave) = (f32::NEG_INFINITY, f32::INFINITY);
    let a = d.x * d.x + d.z * d.z;
    let c = q.x * q.x + q.z * q.z - radius * radius;
    if a > 1e-14 {
        let b = q.x * d.x + q.z * d.z;
        let h = b * b - a * c;
        if h < 0.0 {
            return None;
        }
        let root = h.sqrt();
        (enter, leave) = ((-b - root) / a, (-b + root) / a);
    } else if c > 0.0 {
        return None;
    }
    if d.y.abs() > 1e-12 {
        let (bottom, top) = ((-half - q.y) / d.y, (half - q.y) / d.y);
        enter = enter.max(bottom.min(top));
        leave = leave.min(bottom.max(top));
    } else if q.y.abs() > half {
        return None;
    }
    (enter <= leave).then_some((enter, leave))
}
