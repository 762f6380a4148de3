//! Scenarios as files: what every field may be, reading, checking and writing.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use bevy::prelude::{TypePath, Vec3};

use super::ron_text::{differing, file_of, invalid, line_of, list_of, parse, short};
use super::source::{Source, split_path};
use super::species::{NAME, TEXT};
use super::{FileError, VERSION};
use crate::environment::Shore;
use crate::limits;
use crate::scenario::{Edit, PlacedLamp, PlacedSolid, PlacedSun, Planting, Scenario, TimedEdit};
use crate::species::Species;
use crate::species::parameter::{Color, Parameter, ParameterType, Range, Value};

/// Farthest anything may stand from the middle, metres.
pub const FARTHEST_M: f64 = 10_000.0;
/// Largest side, radius or height of a solid, metres.
pub const LARGEST_M: f64 = 20_000.0;

/// A scenario with every species it names.
#[derive(Debug, Clone, PartialEq, TypePath)]
pub struct ResolvedScenario {
    /// What stands where.
    pub scenario: Scenario,
    /// The species, by the name plants give.
    pub species: BTreeMap<String, Species>,
}

/// A value in a scenario that is out of range or does not fit the rest.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("`{field}` is {value}; allowed: {allowed}")]
pub struct ScenarioError {
    /// Path of the field, such as `lamps[0].strength`.
    pub field: String,
    /// Its value.
    pub value: String,
    /// What is allowed.
    pub allowed: String,
}

static TABLE: LazyLock<Vec<Parameter>> = LazyLock::new(|| {
    let row = |name, default, unit, range, help| Parameter { name, unit, range, choices: &[], default, help };
    let text = |name, default: &str, help| row(name, Value::Choice(default.into()), "", Range::any(), help);
    let flag = |name, default, help| row(name, Value::Flag(default), "", Range::any(), help);
    let choice = |name, choices, default: &str, help| Parameter {
        choices,
        ..row(name, Value::Choice(default.into()), "", Range::any(), help)
    };
    let place = |name, at: Vec3, help| {
        let at = Value::List(at.to_array().map(f64::from).to_vec());
        row(name, at, "m", Range::real(-FARTHEST_M, FARTHEST_M), help)
    };
    let real = |name, default: f32, unit, range, help| row(name, default.to_value(), unit, range, help);
    let whole = |name, default, unit, range, help| row(name, Value::Whole(default), unit, range, help);
    let color = |name, color: Color, help| row(name, color.to_value(), "", Range::real(0.0, 1.0), help);
    let turn = |name| real(name, 0.0, "deg", Range::real(-360.0, 360.0), "Turn about the vertical.");
    let (all, solid, lamp, sun) =
        (Scenario::default(), PlacedSolid::default(), PlacedLamp::default(), PlacedSun::default());
    let shore = Shore::default();
    let face = Range::whole(1, limits::FACE);
    let size = Range::real(0.001, LARGEST_M);
    vec![
        whole("version", VERSION, "", Range::whole(VERSION, VERSION), "Version of the file format."),
        text("name", &all.name, "Its name."),
        text("description", "", "What it shows, for people."),
        whole("steps", all.steps, "steps", Range::whole(0, limits::STEPS), "Steps that show it well."),
        text("plants[].species", "lam_king", "A shipped species, or a file beside this one: `my.ron`."),
        place("plants[].at", Vec3::ZERO, "Where its seed lies."),
        turn("plants[].turn_deg"),
        real("plants[].tilt_deg", 0.0, "deg", Range::real(-80.0, 80.0), "Lean of its seedling."),
        whole("plants[].seed", 0, "", Range::any(), "Added to the seed of the run."),
        text("solids[].name", &solid.name, "Name by which edits find it."),
        text(
            "solids[].shape",
            "Box(size: (4.0, 2.0, 0.2))",
            "Box(size: (x, y, z)), Ball(radius: r) or Cylinder(radius: r, height: h).",
        ),
        row("solids[].shape.size", Value::List(vec![4.0, 2.0, 0.2]), "m", size, "Full size of a box."),
        real("solids[].shape.radius", 1.0, "m", size, "Radius of a ball or cylinder."),
        real("solids[].shape.height", 1.0, "m", size, "Full height of a cylinder."),
        place("solids[].at", solid.at, "Its centre."),
        turn("solids[].turn_deg"),
        color("solids[].color", solid.color, "Colour in pictures, sRGB."),
        text("lamps[].name", &lamp.name, "Name by which edits find it."),
        place("lamps[].at", lamp.at, "Its centre."),
        real("lamps[].strength", lamp.strength, "", Range::real(0.0, 1.0e6), "Radiance, in full skies."),
        real("lamps[].radius", lamp.radius, "m", Range::real(0.001, 100.0), "Radius of the ball."),
        flag("lamps[].on", true, "Whether it burns."),
        color("lamps[].color", lamp.color, "Colour in pictures, sRGB."),
        real("sky.strength", all.sky.strength, "", Range::real(0.0, 100.0), "1 is full daylight."),
        choice("sky.gradient", &["Uniform", "Overcast"], "Uniform", "How its light is spread."),
        real("sun.elevation_deg", sun.elevation_deg, "deg", Range::real(-90.0, 90.0), "Above the horizon."),
        real("sun.azimuth_deg", sun.azimuth_deg, "deg", Range::real(-360.0, 360.0), "From +z to +x."),
        real("sun.strength", sun.strength, "", Range::real(0.0, 10.0), "1 alone saturates an exposure."),
        flag("ground", all.ground, "Whether there is a ground at height 0."),
        real("shore.azimuth_deg", shore.azimuth_deg, "deg", Range::real(-360.0, 360.0), "From +z to +x."),
        real(
            "shore.distance_m",
            shore.distance_m,
            "m",
            Range::real(-FARTHEST_M, FARTHEST_M),
            "From the middle to the sea. Only drawn.",
        ),
        flag("mechanisms.light", true, "Buds grow towards light, leaves earn by it."),
        flag("mechanisms.space", true, "Buds grow towards space."),
        flag("mechanisms.energy", true, "Growth needs energy."),
        whole("sensing.leaf_face", all.sensing.leaf_face, "texels", face, "Side of a leaf's cube-map face."),
        whole("sensing.bud_face", all.sensing.bud_face, "texels", face, "Side of a bud's cube-map face."),
        choice("sensing.mode", &["MapPerCandidate", "Reprojected"], "Reprojected", "How positions compare."),
        choice("sensing.weight", &["Alike", "SolidAngle"], "Alike", "How texels count."),
        whole("edits[].step", 0, "steps", Range::whole(0, limits::STEPS), "Made when this many are grown."),
        text("edits[].edit.name", "", "What is moved, copied, changed, switched or removed."),
        place("edits[].edit.from", Vec3::ZERO, "A corner of the block that shears leave."),
        place("edits[].edit.to", Vec3::ZERO, "Its new centre; of shears, the opposite corner."),
        turn("edits[].edit.turn_deg"),
        row(
            "edits[].edit.rotation_deg",
            Value::List(vec![0.0; 3]),
            "deg",
            Range::real(-360.0, 360.0),
            "Its new turn about x, y and z.",
        ),
        row("edits[].edit.scale", Value::List(vec![1.0; 3]), "", Range::real(0.01, 100.0), "Its new scale."),
        text("edits[].edit.copy", "", "The name of the copy."),
        real("edits[].edit.strength", lamp.strength, "", Range::real(0.0, 1.0e6), "Radiance, in full skies."),
        real("edits[].edit.radius", lamp.radius, "m", Range::real(0.001, 100.0), "Radius of the lamp."),
        flag("edits[].edit.on", true, "On or off."),
        whole("edits[].edit.plant", 0, "", Range::any(), "The plant, in the order of planting, from 0."),
        whole("edits[].edit.lineage", 0, "", Range::any(), "Lineage of the organ to cut."),
        real("edits[].edit.above", 0.0, "m", Range::real(-FARTHEST_M, FARTHEST_M), "Height of the cut."),
        text("edits[].edit.species", "", "The species that is changed."),
        text("edits[].edit.parameter", "", "The parameter."),
        text("edits[].edit.value", "", "Its value, as after `=` in `--set`."),
    ]
});

/// The row of a path: `lamps[3].strength` is `lamps[].strength`, and so is that field of a `PlaceLamp`.
pub(crate) fn row(path: &[String], edit: &str) -> Option<&'static Parameter> {
    let (head, rest) = match path {
        [edits, _, field, rest @ ..] if edits == "edits" && field == "edit" => {
            let head = match edit.split('(').next().unwrap_or_default().trim() {
                "Plant" => "plants[]",
                "PlaceSolid" => "solids[]",
                "PlaceLamp" => "lamps[]",
                "Sun" => "sun",
                "Sky" => "sky",
                "Mechanisms" => "mechanisms",
                _ => "edits[].edit",
            };
            (head.to_string(), rest)
        }
        [first, rest @ ..] => (first.clone(), rest),
        [] => return None,
    };
    let mut name = head;
    for part in rest {
        match part.starts_with('[') {
            true => name.push_str("[]"),
            false => {
                name.push('.');
                name.push_str(part);
            }
        }
    }
    TABLE.iter().find(|p| p.name == name)
}

pub(crate) fn words(parameter: &Parameter) -> String {
    match parameter.name.rsplit('.').next().unwrap_or_default() {
        "name" | "copy" | "species" | "parameter" | "value" => NAME.into(),
        "description" => TEXT.into(),
        "seed" | "lineage" => "a whole number below 2^64".into(),
        "plant" => "a whole number below 2^32".into(),
        "shape" => "Box(size: (x, y, z)) | Ball(radius: r) | Cylinder(radius: r, height: h)".into(),
        "at" | "from" | "to" | "size" | "rotation_deg" | "scale" | "color" => {
            format!("three numbers, each {}", parameter.range)
        }
        _ => parameter.allowed(),
    }
}

/// What the value at a path may be, `None` where it is a structure or a list.
///
/// The kind of an edit is not known from its path; fields of the same name are told apart by trying each.
pub(crate) fn allowed(path: &[String]) -> Option<String> {
    if let [edits, _, edit, ..] = path
        && edits == "edits"
        && edit == "edit"
    {
        let kinds = ["", "Plant", "PlaceSolid", "PlaceLamp", "Sun", "Sky", "Mechanisms"];
        let mut found: Vec<String> = kinds.iter().filter_map(|kind| row(path, kind)).map(words).collect();
        found.dedup();
        return (!found.is_empty()).then(|| found.join(", or "));
    }
    row(path, "").map(words)
}

impl Scenario {
    /// The table of a scenario's fields; `[]` stands for any element of a list.
    pub fn parameters() -> &'static [Parameter] {
        &TABLE
    }

    /// Reads a scenario from the text of a file; `file` is its name, for errors. Edits come out in the order
    /// of their steps, those of one step in the order of the file.
    ///
    /// # Errors
    /// [`FileError`] with line, column, field, value and range, as far as each is known.
    pub fn from_ron(text: &str, file: &str) -> Result<Self, FileError> {
        let mut scenario = Self::in_file_order(text, file)?;
        scenario.order_edits();
        Ok(scenario)
    }

    /// Reads a scenario with edits as they stand in the file.
    pub(crate) fn in_file_order(text: &str, file: &str) -> Result<Self, FileError> {
        let scenario: Self = parse(text, file, &allowed)?;
        scenario.check(&Source::new(text, file), &[])?;
        Ok(scenario)
    }

    /// As RON that lists only what differs from the defaults; reads back as exactly this scenario.
    pub fn to_ron(&self) -> String {
        let mut fields = differing(self, &Self::default(), &["version", "name"]);
        for (name, value) in &mut fields {
            match name.as_str() {
                "plants" => {
                    let from = Planting::default();
                    *value = list_of(self.plants.iter().map(|p| short(p, &from, &["species"])));
                }
                "solids" => {
                    let from = PlacedSolid::default();
                    *value = list_of(self.solids.iter().map(|s| short(s, &from, &["name", "shape", "at"])));
                }
                "lamps" => {
                    let from = PlacedLamp::default();
                    *value = list_of(self.lamps.iter().map(|l| short(l, &from, &["name", "at"])));
                }
                "edits" => *value = list_of(self.edits.iter().map(line_of::<TimedEdit>)),
                "sky" => *value = short(&self.sky, &Default::default(), &[]),
                "mechanisms" => *value = short(&self.mechanisms, &Default::default(), &[]),
                "sensing" => *value = short(&self.sensing, &Default::default(), &[]),
                _ => {}
            }
        }
        file_of(&fields)
    }

    /// Puts edits in the order of their steps; those of one step keep theirs.
    pub fn order_edits(&mut self) {
        self.edits.sort_by_key(|e| e.step);
    }

    /// Checks all of it; `path` is where it stands in the source.
    pub(crate) fn check(&self, source: &Source, path: &[String]) -> Result<(), FileError> {
        self.validate().map_err(|e| {
            let path: Vec<String> = path.iter().cloned().chain(split_path(&e.field)).collect();
            invalid(source, &path, e.value, e.allowed)
        })
    }

    /// Every species that plants name, now or by an edit, and where.
    pub(crate) fn species_named(&self) -> Vec<(&str, Vec<String>)> {
        let path = |list: &str, i: usize, field: &str| split_path(&format!("{list}[{i}].{field}"));
        let sown =
            self.plants.iter().enumerate().map(|(i, p)| (p.species.as_str(), path("plants", i, "species")));
        let edits = self.edits.iter().enumerate().filter_map(|(i, e)| match &e.edit {
            Edit::Plant(p) => Some((p.species.as_str(), path("edits", i, "edit.species"))),
            _ => None,
        });
        sown.chain(edits).collect()
    }
}

impl ScenarioError {
    pub(crate) fn in_file(self, file: &str) -> FileError {
        FileError::Invalid {
            at: super::Place::file(file),
            field: self.field,
            value: crate::species::parameter::shorten(&self.value),
            allowed: self.allowed,
        }
    }
}
