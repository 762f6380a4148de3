//! What a forester would measure: a plant's size and what it is made of, and the record of a step.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::{NO_PARENT, OrganState, Snapshot, strahler};

/// Size and parts of one plant, or of all plants together.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Form {
    /// Organs.
    pub organs: u32,
    /// Stem segments.
    pub internodes: u32,
    /// Internodes that end in a node.
    pub nodes: u32,
    /// Leaves.
    pub leaves: u32,
    /// Apical buds.
    pub apical_buds: u32,
    /// Lateral buds.
    pub lateral_buds: u32,
    /// Highest point above the plant's base, metres; of several plants, the tallest's.
    pub height_m: f32,
    /// Mean of the extents of wood and leaves along x and z, metres.
    pub crown_width_m: f32,
    /// Height of the lowest leaf above the plant's base, metres; 0 without leaves.
    pub crown_base_m: f32,
    /// Diameter of the thickest stem that grows straight from the ground, metres.
    pub trunk_diameter_m: f32,
    /// Diameter at breast height, 1.3 m above the plant's base, of the thickest stem there, metres; 0 if none reaches
    /// it.
    pub breast_diameter_m: f32,
    /// Height above which 95 % of the leaf area is, metres, each leaf where its middle is: the base of the live crown.
    pub live_crown_base_m: f32,
    /// Height at which the crown is widest, metres: the mean of the tenth of its leaf area that is farthest from its
    /// middle.
    pub widest_height_m: f32,
    /// Share of the length of side axes that points below the level, 0..1.
    pub drooping_share: f32,
    /// Internodes by branch order, 0 to 3, and 4 and above.
    pub by_order: [u32; 5],
    /// Highest branch order of an internode.
    pub max_order: u32,
    /// Order of Strahler of the whole plant: 1 of one stem, one more wherever two of the highest meet.
    pub strahler_order: u32,
    /// How many branches there are to each of the next order of Strahler; 0 without branches.
    pub bifurcation_ratio: f32,
    /// Leaf area, one side, square metres.
    pub leaf_area_m2: f64,
    /// Mean light of leaves (0..1); 0 without leaves.
    pub mean_light: f64,
}

impl Form {
    /// Measures one plant by its index in [`Snapshot::plants`], or with `None` all plants together.
    pub fn of(snapshot: &Snapshot, plant: Option<u32>) -> Self {
        let mut form = Self::default();
        let mut low = Vec3::splat(f32::INFINITY);
        let mut high = Vec3::splat(f32::NEG_INFINITY);
        let mut lowest_leaf = f32::INFINITY;
        let mut light = 0.0;
        let mut crown = Vec::new();
        let (mut side, mut drooping) = (0.0_f32, 0.0_f32);
        for (i, state) in snapshot.state.iter().enumerate() {
            let owner = snapshot.plant[i];
            if plant.is_some_and(|wanted| wanted != owner) {
                continue;
            }
            let Some(Some(record)) = snapshot.plants.get(owner as usize) else { continue };
            let pose = &snapshot.pose[i];
            form.organs += 1;
            let (end, girth) = match state {
                OrganState::Internode(internode, node) => {
                    form.internodes += 1;
                    form.nodes += u32::from(node.is_some());
                    form.max_order = form.max_order.max(snapshot.order[i]);
                    form.by_order[snapshot.order[i].min(4) as usize] += 1;
                    let end = pose.tip(internode.length);
                    if snapshot.order[i] > 0 {
                        side += internode.length;
                        drooping += if end.y < pose.position.y { internode.length } else { 0.0 };
                    }
                    let breast = record.position.y + BREAST_M;
                    if (pose.position.y.min(end.y)..pose.position.y.max(end.y)).contains(&breast) {
                        form.breast_diameter_m = form.breast_diameter_m.max(2.0 * internode.radius);
                    }
                    if snapshot.parent[i] == NO_PARENT {
                        form.trunk_diameter_m = form.trunk_diameter_m.max(2.0 * internode.radius);
                    }
                    (pose.tip(internode.length), internode.radius)
                }
                OrganState::ApicalBud(..) => {
                    form.apical_buds += 1;
                    continue;
                }
                OrganState::LateralBud(..) => {
                    form.lateral_buds += 1;
                    continue;
                }
                OrganState::Leaf(leaf) => {
                    form.leaves += 1;
                    form.leaf_area_m2 += f64::from(leaf.size * record.species.leaf_area());
                    light += f64::from(snapshot.exposure[i].light);
                    let reach = record.species.leaf_reach_m() * leaf.size.max(0.0).sqrt();
                    lowest_leaf = lowest_leaf.min(pose.position.y - record.position.y);
                    let middle = pose.tip(0.5 * reach) - record.position;
                    crown.push((middle, leaf.size * record.species.leaf_area()));
                    (pose.tip(reach), 0.0)
                }
            };
            let girth = Vec3::new(girth, 0.0, girth);
            low = low.min(pose.position - girth).min(end - girth);
            high = high.max(pose.position + girth).max(end + girth);
            form.height_m = form.height_m.max(pose.position.y.max(end.y) - record.position.y);
        }
        if low.x <= high.x {
            form.crown_width_m = 0.5 * ((high.x - low.x) + (high.z - low.z));
        }
        let branches = strahler::branches(snapshot, plant);
        form.strahler_order = branches.len() as u32;
        form.bifurcation_ratio = strahler::bifurcation_ratio(&branches);
        form.drooping_share = if side > 0.0 { drooping / side } else { 0.0 };
        if form.leaves > 0 {
            crown.sort_by(|a, b| a.0.y.total_cmp(&b.0.y));
            form.live_crown_base_m = live_crown_base(&crown);
            form.widest_height_m = widest_height(&crown);
            form.crown_base_m = lowest_leaf;
            form.mean_light = light / f64::from(form.leaves);
        }
        form
    }
}

/// Height at which foresters measure trunks, metres.
pub const BREAST_M: f32 = 1.3;

/// Height above which 95 % of the area of leaves is; of places and areas, lowest first.
fn live_crown_base(crown: &[(Vec3, f32)]) -> f32 {
    let whole: f32 = crown.iter().map(|(_, area)| area).sum();
    let mut below = 0.0;
    let base = crown.iter().find(|(_, area)| {
        below += area;
        below >= 0.05 * whole
    });
    base.map_or(0.0, |(at, _)| at.y)
}

/// Mean height of the outermost tenth of the area of leaves, by the distance from the crown's middle; of places and areas.
fn widest_height(crown: &[(Vec3, f32)]) -> f32 {
    let whole: f32 = crown.iter().map(|(_, area)| area).sum();
    let middle = crown.iter().map(|(at, area)| at.xz() * *area).sum::<Vec2>() / whole.max(f32::MIN_POSITIVE);
    let mut outward: Vec<(f32, f32, f32)> =
        crown.iter().map(|(at, area)| (at.xz().distance(middle), at.y, *area)).collect();
    outward.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (mut area, mut heights) = (0.0, 0.0);
    for (_, height, here) in outward {
        area += here;
        heights += here * height;
        if area >= 0.1 * whole {
            break;
        }
    }
    heights / area.max(f32::MIN_POSITIVE)
}

/// Wall-clock seconds a step spent in each stage.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct StageSeconds {
    /// New organs.
    pub generate: f64,
    /// Energy.
    pub update: f64,
    /// Light and space.
    pub sense: f64,
    /// Counting and publishing.
    pub finish: f64,
}

/// A step in numbers, all plants together.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct StepRecord {
    /// Steps grown.
    pub step: u32,
    /// Size and parts at its end.
    pub form: Form,
    /// Energy photosynthesised in it.
    pub income: f64,
    /// Energy paid to stay alive.
    pub upkeep: f64,
    /// Energy turned into organs and wood.
    pub growth: f64,
    /// Of `growth`, what thickened wood.
    pub wood: f64,
    /// Energy gone with shed organs.
    pub lost: f64,
    /// Energy in the stores at its end.
    pub store: f64,
    /// Energy set aside for organs at its end: with it the books balance, `income` is `upkeep` + `growth` + `lost`
    /// and what `store` and this have gained.
    pub allotted: f64,
    /// How long it took.
    pub seconds: StageSeconds,
}

impl StepRecord {
    /// The record of the step a snapshot was taken after.
    pub fn of(snapshot: &Snapshot, seconds: StageSeconds) -> Self {
        let mut record =
            Self { step: snapshot.step, form: Form::of(snapshot, None), seconds, ..Self::default() };
        for plant in snapshot.plants.iter().flatten() {
            record.income += plant.ledger.income;
            record.upkeep += plant.ledger.upkeep;
            record.growth += plant.ledger.growth;
            record.wood += plant.ledger.wood;
            record.lost += plant.ledger.lost;
            record.store += plant.store.stored;
            record.allotted += plant.ledger.closed - plant.store.stored;
        }
        record
    }
}
