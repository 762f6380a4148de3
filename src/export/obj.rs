//! A plant as a Wavefront model: `.obj` with its `.mtl` beside it.
//!
//! An object a part of a plant, with normals and texture coordinates; metres, y up. Materials carry the colours of
//! bark and leaves, sRGB as the format has them.

use std::io::Write;
use std::path::Path;

use super::ExportError;
use super::error::to_file;
use crate::plant::Snapshot;
use crate::shape::{Surface, leaves::leaves, tubes::wood};
use crate::species::parameter::Color;

/// Writes all plants; `materials` is the name of the file that [`write_mtl`] writes.
///
/// # Errors
/// If the stream does not take it.
pub fn write_obj(snapshot: &Snapshot, materials: &str, mut writer: impl Write) -> Result<(), ExportError> {
    writeln!(writer, "mtllib {materials}")?;
    // Vertices are numbered through the file, from 1.
    let mut first = 1;
    for ((i, plant), (wood, leaves)) in
        snapshot.plants.iter().enumerate().zip(wood(snapshot).into_iter().zip(leaves(snapshot)))
    {
        let Some(plant) = plant else { continue };
        for (surface, what) in [(wood, "bark"), (leaves, "leaves")] {
            if !surface.is_empty() {
                let name = &plant.species.name;
                writeln!(writer, "o {name}_{i}_{what}\nusemtl {name}_{what}")?;
                first = part(&surface, first, &mut writer)?;
            }
        }
    }
    Ok(writer.flush()?)
}

/// Writes a surface whose first vertex has that number; returns the number of the next.
fn part(surface: &Surface, first: usize, writer: &mut impl Write) -> Result<usize, ExportError> {
    for [x, y, z] in &surface.positions {
        writeln!(writer, "v {x} {y} {z}")?;
    }
    for [u, v] in &surface.uvs {
        writeln!(writer, "vt {u} {v}")?;
    }
    for [x, y, z] in &surface.normals {
        writeln!(writer, "vn {x} {y} {z}")?;
    }
    for corners in surface.indices.chunks_exact(3) {
        let [a, b, c] = [corners[0], corners[1], corners[2]].map(|corner| first + corner as usize);
        writeln!(writer, "f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}")?;
    }
    Ok(first + surface.positions.len())
}

/// Writes the materials of all species of a snapshot.
///
/// # Errors
/// If the stream does not take it.
pub fn write_mtl(snapshot: &Snapshot, mut writer: impl Write) -> Result<(), ExportError> {
    let mut written: Vec<&str> = Vec::new();
    for plant in snapshot.plants.iter().flatten() {
        let species = &plant.species;
        if written.contains(&species.name.as_str()) {
            continue;
        }
        written.push(&species.name);
        for (what, Color([r, g, b])) in [("bark", species.bark_color), ("leaves", species.leaf_color)] {
            writeln!(writer, "newmtl {}_{what}\nKd {r} {g} {b}\nillum 1\n", species.name)?;
        }
    }
    Ok(writer.flush()?)
}

/// Writes an OBJ file and the MTL file of the same name beside it, replacing what is there.
///
/// # Errors
/// As [`write_obj`], with the path.
pub fn save_obj(snapshot: &Snapshot, path: &Path) -> Result<(), ExportError> {
    let beside = path.with_extension("mtl");
    let name = beside.file_name().unwrap_or_default().to_string_lossy().into_owned();
    to_file(&beside, |writer| write_mtl(snapshot, writer))?;
    to_file(path, |writer| write_obj(snapshot, &name, writer))
}
