//! Tables: a row an organ, a row a step, as CSV. Numbers are written so that they read back exactly.

use std::io::Write;
use std::path::Path;

use serde::Serialize;

use super::ExportError;
use super::error::to_file;
use crate::plant::measure::StepRecord;
use crate::plant::{LateralBudState, LeafState, NO_PARENT, OrganKind, OrganState, Snapshot};

/// A row of `organs.csv`; what an organ's kind does not have is left empty.
#[derive(Serialize)]
struct OrganRow {
    birth: u32,
    parent: Option<u32>,
    plant: u32,
    kind: &'static str,
    state: &'static str,
    lineage: String,
    born: u32,
    age: u32,
    order: u32,
    x: f32,
    y: f32,
    z: f32,
    qx: f32,
    qy: f32,
    qz: f32,
    qw: f32,
    length: Option<f32>,
    radius: Option<f32>,
    size: Option<f32>,
    light: Option<f32>,
    space: Option<f32>,
    allotment: Option<f32>,
    energy_in: f32,
    energy_out: f32,
}

/// Columns of `organs.csv`, in order.
///
/// `parent` is a birth number, empty for what grows straight from its plant. `x`, `y`, `z` is the organ's base in
/// metres and `qx` to `qw` its turn, heading along its +y. `length` and `radius` (m) are an internode's, `size`
/// (0..1 of the largest) a leaf's; `state` is `node` for an internode that ends in one.
pub const ORGAN_COLUMNS: [&str; 24] = [
    "birth",
    "parent",
    "plant",
    "kind",
    "state",
    "lineage",
    "born",
    "age",
    "order",
    "x",
    "y",
    "z",
    "qx",
    "qy",
    "qz",
    "qw",
    "length",
    "radius",
    "size",
    "light",
    "space",
    "allotment",
    "energy_in",
    "energy_out",
];

/// Writes a row an organ, in birth order.
///
/// # Errors
/// If the stream does not take it.
pub fn write_organs(snapshot: &Snapshot, writer: impl Write) -> Result<(), ExportError> {
    let mut table = csv::WriterBuilder::new().has_headers(false).from_writer(writer);
    table.write_record(ORGAN_COLUMNS)?;
    for i in 0..snapshot.len() {
        table.serialize(organ_row(snapshot, i))?;
    }
    Ok(table.flush()?)
}

/// Writes `organs.csv`, replacing what is there.
///
/// # Errors
/// As [`write_organs`], with the path.
pub fn save_organs(snapshot: &Snapshot, path: &Path) -> Result<(), ExportError> {
    to_file(path, |writer| write_organs(snapshot, writer))
}

fn organ_row(snapshot: &Snapshot, i: usize) -> OrganRow {
    let (mut length, mut radius, mut size) = (None, None, None);
    let (kind, state) = match &snapshot.state[i] {
        OrganState::Internode(internode, node) => {
            length = Some(internode.length);
            radius = Some(internode.radius);
            ("internode", if node.is_some() { "node" } else { "" })
        }
        OrganState::ApicalBud(..) => ("apical_bud", "growing"),
        OrganState::LateralBud(bud, _) => (
            "lateral_bud",
            match bud.state {
                LateralBudState::Dormant => "dormant",
                LateralBudState::Growing => "growing",
                LateralBudState::Dead => "dead",
            },
        ),
        OrganState::Leaf(leaf) => {
            size = Some(leaf.size);
            (
                "leaf",
                match leaf.state {
                    LeafState::Growing => "growing",
                    LeafState::Terminated => "terminated",
                },
            )
        }
    };
    let parent = snapshot.parent[i];
    let born = snapshot.span[i].born();
    let pose = &snapshot.pose[i];
    // Wood looks nowhere, and nothing is set aside for it.
    let looks = snapshot.state[i].kind() != OrganKind::Internode;
    OrganRow {
        birth: snapshot.birth[i],
        parent: (parent != NO_PARENT).then(|| snapshot.birth[parent as usize]),
        plant: snapshot.plant[i],
        kind,
        state,
        lineage: format!("{:016x}", snapshot.lineage[i].0),
        born,
        age: snapshot.step.saturating_sub(born),
        order: snapshot.order[i],
        x: pose.position.x,
        y: pose.position.y,
        z: pose.position.z,
        qx: pose.rotation.x,
        qy: pose.rotation.y,
        qz: pose.rotation.z,
        qw: pose.rotation.w,
        length,
        radius,
        size,
        light: looks.then_some(snapshot.exposure[i].light),
        space: looks.then_some(snapshot.exposure[i].space),
        allotment: looks.then_some(snapshot.allotment[i]),
        energy_in: snapshot.flow[i].income,
        energy_out: snapshot.flow[i].upkeep,
    }
}

/// Columns of `steps.csv`, in order: the fields of [`StepRecord`], stages in seconds.
pub const STEP_COLUMNS: [&str; 36] = [
    "step",
    "organs",
    "internodes",
    "nodes",
    "leaves",
    "apical_buds",
    "lateral_buds",
    "height_m",
    "crown_width_m",
    "crown_base_m",
    "trunk_diameter_m",
    "breast_diameter_m",
    "live_crown_base_m",
    "widest_height_m",
    "drooping_share",
    "order_0",
    "order_1",
    "order_2",
    "order_3",
    "order_4_and_above",
    "max_order",
    "strahler_order",
    "bifurcation_ratio",
    "leaf_area_m2",
    "mean_light",
    "income",
    "upkeep",
    "growth",
    "wood",
    "lost",
    "store",
    "allotted",
    "generate_s",
    "update_s",
    "sense_s",
    "finish_s",
];

/// Writes a row a step.
///
/// # Errors
/// If the stream does not take it.
pub fn write_steps(steps: &[StepRecord], writer: impl Write) -> Result<(), ExportError> {
    let mut table = csv::WriterBuilder::new().has_headers(false).from_writer(writer);
    table.write_record(STEP_COLUMNS)?;
    for step in steps {
        let form = &step.form;
        let counts = [
            step.step,
            form.organs,
            form.internodes,
            form.nodes,
            form.leaves,
            form.apical_buds,
            form.lateral_buds,
        ];
        let lengths = [form.height_m, form.crown_width_m, form.crown_base_m, form.trunk_diameter_m];
        let shape =
            [form.breast_diameter_m, form.live_crown_base_m, form.widest_height_m, form.drooping_share];
        let energy = [step.income, step.upkeep, step.growth, step.wood, step.lost, step.store, step.allotted];
        let seconds = &step.seconds;
        let seconds = [seconds.generate, seconds.update, seconds.sense, seconds.finish];
        let foliage = [form.leaf_area_m2, form.mean_light];
        let orders = (form.by_order, form.max_order, form.strahler_order, form.bifurcation_ratio);
        table.serialize((counts, lengths, shape, orders, foliage, energy, seconds))?;
    }
    Ok(table.flush()?)
}

/// Writes `steps.csv`, replacing what is there.
///
/// # Errors
/// As [`write_steps`], with the path.
pub fn save_steps(steps: &[StepRecord], path: &Path) -> Result<(), ExportError> {
    to_file(path, |writer| write_steps(steps, writer))
}
