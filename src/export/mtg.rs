//! MTG, the Multiscale Tree Graph of OpenAlea (Godin & Caraglio 1998), as text: plants, axes and stem segments with
//! their leaves and buds.
//!
//! Scales: `P` plant, `A` axis, `I` internode, and at the finest scale beside it `L` leaf, `B` bud. `/` is the first
//! part of the coarser one before it, `<` goes on with the axis, `+` bears. Columns of the code section show the depth
//! of branching; features are place (metres), heading, length, diameter and birth.

use std::io::{self, Write};
use std::path::Path;

use bevy::math::Vec3;

use super::ExportError;
use super::error::to_file;
use crate::plant::{NO_PARENT, OrganKind, OrganState, Snapshot};

/// The names of the features, in order, with their types.
const FEATURES: [(&str, &str); 10] = [
    ("XX", "REAL"),
    ("YY", "REAL"),
    ("ZZ", "REAL"),
    ("DX", "REAL"),
    ("DY", "REAL"),
    ("DZ", "REAL"),
    ("Length", "REAL"),
    ("Diameter", "REAL"),
    ("Size", "REAL"),
    ("Birth", "INT"),
];

/// A line of the code section.
struct Line {
    column: usize,
    code: String,
    /// The organ whose features it tells; `None` for a plant.
    organ: Option<usize>,
}

/// Writes all plants of a snapshot.
///
/// # Errors
/// If the stream does not take it.
pub fn write_mtg(snapshot: &Snapshot, mut writer: impl Write) -> io::Result<()> {
    let lines = lines(snapshot);
    let columns = lines.iter().map(|line| line.column + 1).max().unwrap_or(1);
    write!(writer, "CODE:\tFORM-A\n\nCLASSES:\nSYMBOL\tSCALE\tDECOMPOSITION\tINDEXATION\tDEFINITION\n")?;
    for (symbol, scale) in [("$", 0), ("P", 1), ("A", 2), ("I", 3), ("L", 3), ("B", 3)] {
        writeln!(writer, "{symbol}\t{scale}\tFREE\tFREE\tIMPLICIT")?;
    }
    write!(writer, "\nDESCRIPTION:\nLEFT\tRIGHT\tRELTYPE\tMAX\n")?;
    for (left, right, relation) in
        [("I", "I", "<"), ("I", "I", "+"), ("I", "L", "+"), ("I", "B", "<"), ("I", "B", "+"), ("A", "A", "+")]
    {
        writeln!(writer, "{left}\t{right}\t{relation}\t?")?;
    }
    write!(writer, "\nFEATURES:\nNAME\tTYPE\n")?;
    for (name, kind) in FEATURES {
        writeln!(writer, "{name}\t{kind}")?;
    }
    writeln!(writer, "\nMTG:")?;
    write!(writer, "ENTITY-CODE{}", "\t".repeat(columns))?;
    writeln!(writer, "{}", FEATURES.map(|(name, _)| name).join("\t"))?;
    for line in lines {
        write!(writer, "{}{}", "\t".repeat(line.column), line.code)?;
        if let Some(i) = line.organ {
            write!(writer, "{}", "\t".repeat(columns - line.column))?;
            let (at, heading) = (snapshot.pose[i].position, snapshot.pose[i].rotation * Vec3::Y);
            let (diameter, size) = match &snapshot.state[i] {
                OrganState::Internode(wood, _) => (2.0 * wood.radius, 1.0),
                OrganState::Leaf(leaf) => (0.0, leaf.size),
                _ => (0.0, 1.0),
            };
            let length = snapshot.length(i);
            write!(
                writer,
                "{}\t{}\t{}\t{}\t{}\t{}\t{length}\t{diameter}\t{size}\t{}",
                at.x, at.y, at.z, heading.x, heading.y, heading.z, snapshot.birth[i]
            )?;
        }
        writeln!(writer)?;
    }
    writer.flush()
}

/// Writes an MTG file, replacing what is there.
///
/// # Errors
/// As [`write_mtg`], with the path.
pub fn save_mtg(snapshot: &Snapshot, path: &Path) -> Result<(), ExportError> {
    to_file(path, |writer| Ok(write_mtg(snapshot, writer)?))
}

/// Every plant and organ in the order of the file: an organ, what it bears one column to the right, then the axis goes
/// on below it.
fn lines(snapshot: &Snapshot) -> Vec<Line> {
    // What goes on with the axis of each organ, and what else it bears.
    let mut next = vec![None; snapshot.len()];
    let mut borne: Vec<Vec<usize>> = vec![Vec::new(); snapshot.len()];
    let mut roots: Vec<Vec<usize>> = vec![Vec::new(); snapshot.plants.len()];
    for i in 0..snapshot.len() {
        let kind = snapshot.state[i].kind();
        let is_axis = matches!(kind, OrganKind::Internode | OrganKind::ApicalBud);
        match snapshot.parent[i] {
            NO_PARENT => roots[snapshot.plant[i] as usize].push(i),
            parent => {
                let below = parent as usize;
                if is_axis && snapshot.order[i] == snapshot.order[below] && next[below].is_none() {
                    next[below] = Some(i);
                } else {
                    borne[below].push(i);
                }
            }
        }
    }
    let mut lines = Vec::new();
    let (mut axes, mut stems, mut leaves, mut buds) = (0_u32, 0_u32, 0_u32, 0_u32);
    for (plant, roots) in roots.iter().enumerate().filter(|(_, roots)| !roots.is_empty()) {
        lines.push(Line { column: 0, code: format!("/P{}", plant + 1), organ: None });
        // Without recursion: a stem may be thousands of segments long.
        let mut waiting: Vec<(usize, usize, &str)> =
            roots.iter().rev().map(|&root| (root, 0, "^/")).collect();
        while let Some((i, column, link)) = waiting.pop() {
            let count = |number: &mut u32| {
                *number += 1;
                *number
            };
            let own = match snapshot.state[i].kind() {
                OrganKind::Internode => format!("I{}", count(&mut stems)),
                OrganKind::Leaf => format!("L{}", count(&mut leaves)),
                OrganKind::ApicalBud | OrganKind::LateralBud => format!("B{}", count(&mut buds)),
            };
            let begins_axis =
                link == "^/" || (link == "+" && snapshot.state[i].kind() == OrganKind::Internode);
            let code = match begins_axis {
                true => format!("{link}A{}/{own}", count(&mut axes)),
                false => format!("{link}{own}"),
            };
            lines.push(Line { column, code, organ: Some(i) });
            waiting.extend(next[i].map(|next| (next, column, "^<")));
            waiting.extend(borne[i].iter().rev().map(|&organ| (organ, column + 1, "+")));
        }
    }
    lines
}
