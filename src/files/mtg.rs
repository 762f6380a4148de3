//! MTG files, the Multiscale Tree Graphs of OpenAlea (Godin & Caraglio 1998), read as [`Skeleton`]s.
//!
//! Of the coded graph only the finest scale counts: stems with their leaves (class `L`) and buds (`B`). Features that
//! count, whatever the case of their names: `XX YY ZZ` (place, metres, YY upward), `Length` and `Diameter` (metres),
//! `Size` (a leaf's area as a share of the largest) and `DX DY DZ` (heading). With heading and length a place is where
//! a stem begins, as [`write_mtg`](crate::export::mtg::write_mtg) writes it; without, where it ends, as trees are
//! digitised.

use std::collections::HashMap;
use std::path::Path;

use bevy::prelude::*;

use super::read::read_up_to;
use super::{FARTHEST_M, FileError, Place};
use crate::environment::direct_light::GOLDEN_ANGLE;
use crate::limits;
use crate::plant::skeleton::{Skeleton, StemLeaf, StemSegment};
use crate::plant::{Lineage, NO_PARENT, Pose};
use crate::tropism::turned_to;

/// Most bytes of an MTG file.
const BYTES: u64 = 256 << 20;
/// Most columns of codes: orders of branching.
const COLUMNS: usize = 10_000;
/// Radius of stems whose diameter nobody measured, metres.
const RADIUS_M: f32 = 0.005;

/// Features that are read.
const FEATURES: [&str; 9] = ["XX", "YY", "ZZ", "DX", "DY", "DZ", "Length", "Diameter", "Size"];
const LENGTH: usize = 6;
const DIAMETER: usize = 7;
const SIZE: usize = 8;

/// A vertex of the finest scale.
struct Vertex {
    line: u32,
    class: char,
    parent: Option<usize>,
    /// Whether it goes on with its parent's axis.
    follows: bool,
    plant: usize,
    features: [Option<f32>; FEATURES.len()],
}

impl Vertex {
    fn vector(&self, first: usize) -> Option<Vec3> {
        let [x, y, z] = [0, 1, 2].map(|k| self.features[first + k]);
        Some(Vec3::new(x?, y?, z?))
    }
}

/// Reads the plants of an MTG file, at most 256 MiB, in its order.
///
/// # Errors
/// As [`mtg_skeletons`], and if the file cannot be read.
pub fn read_mtg(path: &Path) -> Result<Vec<Skeleton>, FileError> {
    mtg_skeletons(&read_up_to(path, BYTES)?, &path.display().to_string())
}

/// The plants of an MTG's text, in its order; `file` is its name, for errors. A plant without stems is an empty
/// skeleton; leaves that no stem bears are left out.
///
/// # Errors
/// [`FileError`] with the line: of what is no MTG, a code or number that is none, a stem without place or length.
pub fn mtg_skeletons(text: &str, file: &str) -> Result<Vec<Skeleton>, FileError> {
    let reader = Reader { file };
    let (vertices, plants) = reader.vertices(text)?;
    reader.skeletons(&vertices, plants)
}

struct Reader<'a> {
    file: &'a str,
}

impl Reader<'_> {
    fn at(&self, line: u32) -> Place {
        Place { line: Some(line), ..Place::file(self.file) }
    }

    fn wrong<T>(&self, line: u32, message: impl Into<String>) -> Result<T, FileError> {
        Err(FileError::Syntax { at: self.at(line), message: message.into() })
    }

    /// The vertices of the finest scale, parents first, and how many plants there are.
    fn vertices(&self, text: &str) -> Result<(Vec<Vertex>, usize), FileError> {
        let mut lines = (1_u32..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
        match lines.next() {
            Some((_, line)) if line.split_whitespace().eq(["CODE:", "FORM-A"]) => {}
            Some((n, _)) => return self.wrong(n, "an MTG begins with `CODE: FORM-A`"),
            None => return self.wrong(1, "an empty file"),
        }
        let mut scales: HashMap<char, u32> = HashMap::new();
        let mut section = String::new();
        for (n, line) in lines.by_ref() {
            let word = line.split_whitespace().next().unwrap_or_default();
            if word.ends_with(':') {
                section = word.to_owned();
                if word == "MTG:" {
                    break;
                }
            } else if section == "CLASSES:" && word != "SYMBOL" {
                let mut cells = line.split_whitespace();
                match (cells.next().and_then(single), cells.next().map(str::parse)) {
                    (Some(class), Some(Ok(scale))) => scales.insert(class, scale),
                    _ => return self.wrong(n, "a class is a symbol of one character and a scale"),
                };
            }
        }
        let finest = scales.values().copied().max().unwrap_or(0);
        let coarsest = scales.values().copied().filter(|&scale| scale > 0).min().unwrap_or(0);
        let Some((at, head)) = lines.next() else { return self.wrong(1, "there is no section `MTG:`") };
        let names: Vec<&str> = head.split('\t').map(str::trim).collect();
        let columns = 1 + names.iter().skip(1).take_while(|name| name.is_empty()).count();
        if columns > COLUMNS {
            return self.wrong(at, format!("{columns} columns of codes; at most {COLUMNS} are read"));
        }
        let features: Vec<Option<usize>> = names
            .iter()
            .map(|name| FEATURES.iter().position(|feature| feature.eq_ignore_ascii_case(name)))
            .collect();

        let mut vertices: Vec<Vertex> = Vec::new();
        let mut plants = 0;
        // The last vertex of each column, if its line came down to the finest scale, and its plant.
        let mut last: Vec<Option<(Option<usize>, usize)>> = vec![None; columns];
        for (line, text) in lines {
            let cells: Vec<&str> = text.split('\t').map(str::trim).collect();
            let Some(column) = cells.iter().take(columns).position(|cell| !cell.is_empty()) else {
                return self.wrong(line, "features of nothing: there is no code in this line");
            };
            let (code, base) = match (cells[column].strip_prefix('^'), column.checked_sub(1)) {
                (Some(code), _) => (code, last[column]),
                (None, Some(before)) => (cells[column], last[before]),
                (None, None) => (cells[column], None),
            };
            let (mut fine, mut plant) = base.unwrap_or((None, plants.max(1) - 1));
            let mut bears = false;
            for (relation, class) in entities(code).or_else(|why| self.wrong(line, why))? {
                let Some(&scale) = scales.get(&class) else {
                    return self.wrong(line, format!("there is no class `{class}` among the classes"));
                };
                bears |= relation == '+';
                if scale == coarsest && scale != finest {
                    (fine, plant, bears) = (None, plants, false);
                    plants += 1;
                } else if scale == finest {
                    vertices.push(Vertex {
                        line,
                        class,
                        parent: fine,
                        follows: !bears,
                        plant,
                        features: [None; FEATURES.len()],
                    });
                    (fine, bears) = (Some(vertices.len() - 1), false);
                }
                plants = plants.max(1);
            }
            if vertices.len() > limits::ORGANS {
                return self.wrong(line, format!("more than {} stems, leaves and buds", limits::ORGANS));
            }
            for (cell, feature) in cells.iter().zip(&features).skip(columns) {
                let Some(feature) = feature.filter(|_| !cell.is_empty()) else { continue };
                let number = cell.parse::<f64>().ok().filter(|number| number.abs() <= FARTHEST_M);
                let Some(number) = number else {
                    return Err(FileError::Invalid {
                        at: self.at(line),
                        field: FEATURES[feature].into(),
                        value: (*cell).into(),
                        allowed: format!("a number from -{FARTHEST_M} to {FARTHEST_M}"),
                    });
                };
                if let Some(vertex) = fine.map(|fine| &mut vertices[fine]).filter(|v| v.line == line) {
                    vertex.features[feature] = Some(number as f32);
                }
            }
            last[column] = Some((fine, plant));
            last[column + 1..].fill(None);
        }
        Ok((vertices, plants))
    }

    fn skeletons(&self, vertices: &[Vertex], plants: usize) -> Result<Vec<Skeleton>, FileError> {
        let mut skeletons = vec![Skeleton::default(); plants];
        // Where each vertex ends, and the stem it is or grows from.
        let mut ends: Vec<Option<Vec3>> = vec![None; vertices.len()];
        let mut stems: Vec<Option<u32>> = vec![None; vertices.len()];
        for (i, vertex) in vertices.iter().enumerate() {
            let skeleton = &mut skeletons[vertex.plant];
            let on = vertex.parent.and_then(|parent| stems[parent]);
            let below = on.map(|on| skeleton.segments[on as usize]);
            let from = vertex.parent.and_then(|parent| ends[parent]);
            let place = vertex.vector(0);
            let heading = vertex.vector(3).and_then(Vec3::try_normalize);
            let frame = below.map_or(Quat::IDENTITY, |below| below.pose.rotation);
            (ends[i], stems[i]) = (place.or(from), on);
            if vertex.class == 'L' {
                let (Some(on), Some(at)) = (on, place.or(from)) else { continue };
                let turn = GOLDEN_ANGLE * skeleton.leaves.len() as f32;
                let heading = heading.unwrap_or_else(|| frame * Quat::from_rotation_y(turn) * Vec3::X);
                skeleton.leaves.push(StemLeaf {
                    on,
                    pose: Pose { position: at, rotation: turned_to(frame, heading) },
                    size: vertex.features[SIZE].unwrap_or(1.0).clamp(0.0, 1.0),
                    lineage: Lineage::SEED.child(skeleton.leaves.len() as u32),
                });
                continue;
            }
            if vertex.class == 'B' {
                continue;
            }
            let length = vertex.features[LENGTH];
            if length.is_some_and(|length| length < 0.0) {
                return self.wrong(vertex.line, "a length is 0 m or more");
            }
            if vertex.features[DIAMETER].is_some_and(|diameter| diameter < 0.0) {
                return self.wrong(vertex.line, "a diameter is 0 m or more");
            }
            let along = heading.or_else(|| below.map(|below| below.pose.rotation * Vec3::Y));
            let way = match (heading, length, place) {
                (Some(heading), Some(length), _) => place.or(from).map(|base| (base, heading * length)),
                (_, _, Some(end)) => match (from, length) {
                    (Some(base), _) => Some((base, end - base)),
                    (None, Some(length)) => Some((end - Vec3::Y * length, Vec3::Y * length)),
                    // The first of a plant without a length says where the next begins.
                    (None, None) => continue,
                },
                (_, Some(length), None) => from.zip(along).map(|(base, along)| (base, along * length)),
                (_, None, None) => None,
            };
            let Some((base, way)) = way else {
                return self
                    .wrong(vertex.line, "a stem needs a place, or a length and something it grows from");
            };
            let Some(along) = way.try_normalize() else {
                return self.wrong(vertex.line, "the stem is 0 m long");
            };
            let radius = vertex.features[DIAMETER].map_or(RADIUS_M, |diameter| 0.5 * diameter);
            let pose = Pose { position: base, rotation: turned_to(frame, along) };
            let order = below.map_or(0, |below| below.order + u32::from(!vertex.follows));
            (ends[i], stems[i]) = (Some(base + way), Some(skeleton.segments.len() as u32));
            let (parent, length) = (on.unwrap_or(NO_PARENT), way.length());
            skeleton.segments.push(StemSegment { parent, pose, length, radius, order, node: true });
        }
        Ok(skeletons)
    }
}

/// The only character of a text.
fn single(text: &str) -> Option<char> {
    let mut characters = text.chars();
    characters.next().filter(|_| characters.next().is_none())
}

/// The relations and classes of a code such as `+A2/I7`; an error says what is wrong.
fn entities(code: &str) -> Result<Vec<(char, char)>, String> {
    let mut entities = Vec::new();
    let mut rest = code;
    while let Some(relation) = rest.chars().next() {
        let wrong =
            || format!("`{code}` is no code: a relation (/ < +), a class and a number, again and again");
        if !matches!(relation, '/' | '<' | '+') {
            return Err(wrong());
        }
        // `<<` and `++` lead over vertices that were left out.
        rest = rest.trim_start_matches(relation);
        let class = rest.chars().next().filter(|class| class.is_alphabetic()).ok_or_else(wrong)?;
        rest = rest[class.len_utf8()..].trim_start_matches(|c: char| c.is_ascii_digit());
        entities.push((relation, class));
    }
    Ok(entities)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "CODE:\tFORM-A\n\nCLASSES:\nSYMBOL\tSCALE\tDECOMPOSITION\tINDEXATION\tDEFINITION\n\
        $\t0\tFREE\tFREE\tIMPLICIT\nP\t1\tFREE\tFREE\tIMPLICIT\nS\t2\tFREE\tFREE\tIMPLICIT\n\
        L\t2\tFREE\tFREE\tIMPLICIT\n\nDESCRIPTION:\nLEFT\tRIGHT\tRELTYPE\tMAX\nS\tS\t+\t?\n\n\
        FEATURES:\nNAME\tTYPE\nXX\tREAL\n\nMTG:\n";

    fn read(code: &str) -> Result<Vec<Skeleton>, FileError> {
        mtg_skeletons(&format!("{HEAD}{code}"), "digitised.mtg")
    }

    /// A digitised stem with a branch and a leaf, then a second plant.
    #[test]
    fn a_digitised_plant_is_read() {
        let plants = read(
            "ENTITY-CODE\t\t\tXX\tYY\tZZ\tDiameter\n\
             /P1/S1\t\t\t0\t0\t0\t\n\
             ^<S2<S3\t\t\t0\t1\t0\t0.02\n\
             \t+S1\t\t1\t1\t0\t0.01\n\
             \t\t+L1\n\
             ^<S4\t\t\t0\t3\t0\t\n\
             /P2/S1\t\t\t5\t0\t0\t\n\
             ^<S2\t\t\t5\t0.5\t0\t\n",
        );
        // S2 has neither place nor length.
        assert!(plants.unwrap_err().to_string().contains("digitised.mtg:21"));
        let plants = read(
            "ENTITY-CODE\t\t\tXX\tYY\tZZ\tDiameter\n\
             /P1/S1\t\t\t0\t0\t0\t\n\
             ^<S2\t\t\t0\t1\t0\t0.02\n\
             \t+S1\t\t1\t1\t0\t0.01\n\
             \t\t+L1\n\
             ^<S4\t\t\t0\t3\t0\t\n\
             /P2/S1\t\t\t5\t0\t0\t\n\
             ^<S2\t\t\t5\t0.5\t0\t\n",
        )
        .unwrap();
        let [first, second] = &plants[..] else { panic!("{plants:?}") };
        first.check().unwrap();
        let lengths: Vec<f32> = first.segments.iter().map(|stem| stem.length).collect();
        assert_eq!(lengths, [1.0, 1.0, 2.0]);
        assert_eq!(first.segments.iter().map(|stem| stem.order).collect::<Vec<_>>(), [0, 1, 0]);
        assert_eq!(first.segments.iter().map(|stem| stem.parent).collect::<Vec<_>>(), [NO_PARENT, 0, 0]);
        assert!(first.segments[1].tip().distance(Vec3::new(1.0, 1.0, 0.0)) < 1e-6);
        assert_eq!(first.segments[0].radius, 0.01);
        assert_eq!((first.leaves.len(), first.leaves[0].on), (1, 1));
        assert_eq!((second.nodes(), second.leaves.len()), (1, 0));
    }

    #[test]
    fn what_is_wrong_with_one_is_told_with_its_line() {
        for (code, told) in [
            ("ENTITY-CODE\t\tXX\tYY\tZZ\n/P1/Q1\t\t0\t0\t0\n", "digitised.mtg:20: there is no class `Q`"),
            ("ENTITY-CODE\t\tXX\tYY\tZZ\n/P1/S1\t\t0\tnan\t0\n", "digitised.mtg:20: `YY` is nan"),
            ("ENTITY-CODE\t\tXX\tYY\tZZ\n/P1/S1\t\t0\t1e9\t0\n", "digitised.mtg:20: `YY` is 1e9"),
            ("ENTITY-CODE\t\tXX\tYY\tZZ\nP1S1\t\t0\t0\t0\n", "digitised.mtg:20: `P1S1` is no code"),
            ("ENTITY-CODE\t\tXX\tYY\tZZ\n/P1/S1\t\t0\t0\t0\n^<S2\t\t0\t0\t0\n", "21: the stem is 0 m long"),
            ("ENTITY-CODE\t\tXX\tYY\tZZ\n\t\t0\t0\t0\n", "20: features of nothing"),
        ] {
            let error = read(code).unwrap_err().to_string();
            assert!(error.contains(told), "{error}");
        }
        for (text, told) in
            [("", "an empty file"), ("(name: \"oak\")", "CODE: FORM-A"), ("CODE: FORM-A\n", "MTG:")]
        {
            let error = mtg_skeletons(text, "x.mtg").unwrap_err().to_string();
            assert!(error.contains(told), "{error}");
        }
    }
}
