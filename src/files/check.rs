//! Checking a scenario: every number against the table, every name against what stands there at its step.

use std::collections::{BTreeMap, BTreeSet};

use bevy::prelude::Vec3;

use super::parse_value;
use super::scenario::{ScenarioError, row, words};
use super::source::split_path;
use super::species::{NAME, TEXT, is_name, is_text};
use crate::environment::SolidShape;
use crate::limits;
use crate::scenario::place::{DEEPEST_SEED_M, lies_in};
use crate::scenario::{Edit, PlacedLamp, PlacedSolid, PlacedSun, Planting, Scenario, TimedEdit};
use crate::species::Species;
use crate::species::parameter::{Color, ParameterError, ParameterType};

impl Scenario {
    /// Checks that every number is in range, names are unique, and edits name what stands there at their step.
    ///
    /// # Errors
    /// The first field that is not so.
    pub fn validate(&self) -> Result<(), ScenarioError> {
        let top = Checker::at("");
        top.number("version", &self.version)?;
        top.name("name", &self.name)?;
        if !is_text(&self.description) {
            return top.fail("description", &self.description, TEXT);
        }
        top.number("steps", &self.steps)?;
        top.count("plants", self.plants.len(), limits::PLANTS)?;
        top.count("solids", self.solids.len(), limits::SOLIDS)?;
        top.count("lamps", self.lamps.len(), limits::LAMPS)?;
        top.count("edits", self.edits.len(), limits::EDITS)?;
        let mut inventory = Inventory::default();
        for (i, plant) in self.plants.iter().enumerate() {
            Checker::at(format!("plants[{i}]")).plant(plant)?;
            inventory.plants.push(true);
            inventory.species.insert(plant.species.clone());
        }
        for (i, solid) in self.solids.iter().enumerate() {
            let check = Checker::at(format!("solids[{i}]"));
            check.solid(solid)?;
            inventory.place(&check, "name", &solid.name, false)?;
        }
        for (i, plant) in self.plants.iter().enumerate() {
            self.can_come_up(&Checker::at(format!("plants[{i}]")), plant)?;
        }
        for (i, lamp) in self.lamps.iter().enumerate() {
            let check = Checker::at(format!("lamps[{i}]"));
            check.lamp(lamp)?;
            inventory.place(&check, "name", &lamp.name, true)?;
        }
        Checker::at("sky").number("strength", &self.sky.strength)?;
        if let Some(sun) = &self.sun {
            Checker::at("sun").sun(sun)?;
        }
        if let Some(shore) = &self.shore {
            Checker::at("shore").number("azimuth_deg", &shore.azimuth_deg)?;
            Checker::at("shore").number("distance_m", &shore.distance_m)?;
        }
        Checker::at("sensing").number("leaf_face", &self.sensing.leaf_face)?;
        Checker::at("sensing").number("bud_face", &self.sensing.bud_face)?;
        let mut order: Vec<usize> = (0..self.edits.len()).collect();
        order.sort_by_key(|i| self.edits[*i].step);
        for i in order {
            inventory.timed(i, &self.edits[i])?;
        }
        inventory.count(&top)
    }

    /// Checks that a seed lies neither in a solid nor deep underground.
    fn can_come_up(&self, check: &Checker, plant: &Planting) -> Result<(), ScenarioError> {
        let value = || plant.at.to_string();
        if self.ground && plant.at.y < -DEEPEST_SEED_M {
            return check.fail("at", value(), format!("at most {DEEPEST_SEED_M} m below the ground"));
        }
        match self.solids.iter().find(|solid| lies_in(&solid.standing(), plant.at)) {
            Some(solid) => {
                check.fail("at", value(), format!("a place outside of the solid {:?}", solid.name))
            }
            None => Ok(()),
        }
    }

    /// Leaves out every edit that names what does not stand there at its step, as edits do whose ground an earlier
    /// one took away. Of a scenario whose rest is sound, what is left is sound.
    pub(crate) fn leave_out_unsound_edits(&mut self) {
        let mut inventory = Inventory::of(self);
        self.order_edits();
        self.edits.retain(|edit| inventory.timed(0, edit).is_ok());
    }

    /// Checks an edit that follows others, given in order; of those, what names what is not there counts for
    /// nothing. The scenario's own edits are not looked at.
    pub(crate) fn check_edit<'a>(
        &self,
        before: impl Iterator<Item = &'a TimedEdit>,
        edit: &TimedEdit,
    ) -> Result<(), ScenarioError> {
        let mut inventory = Inventory::of(self);
        let mut count = 0;
        for earlier in before {
            count += 1;
            let _ = inventory.timed(0, earlier);
        }
        inventory.timed(count, edit)?;
        let top = Checker::at("");
        top.count("edits", count + 1, limits::EDITS)?;
        inventory.count(&top)
    }
}

/// Checks values by the table.
struct Checker {
    /// Path of the structure at hand.
    path: String,
    /// The kind of edit it stands in, if any.
    edit: &'static str,
}

impl Checker {
    fn at(path: impl Into<String>) -> Self {
        Self { path: path.into(), edit: "" }
    }

    fn within(index: usize, edit: &'static str) -> Self {
        Self { path: format!("edits[{index}].edit"), edit }
    }

    fn field(&self, name: &str) -> String {
        if self.path.is_empty() { name.into() } else { format!("{}.{name}", self.path) }
    }

    fn fail(
        &self,
        name: &str,
        value: impl ToString,
        allowed: impl Into<String>,
    ) -> Result<(), ScenarioError> {
        Err(ScenarioError { field: self.field(name), value: value.to_string(), allowed: allowed.into() })
    }

    fn number<T: ParameterType>(&self, name: &str, value: &T) -> Result<(), ScenarioError> {
        let row = row(&split_path(&self.field(name)), self.edit);
        match row {
            Some(row) if !value.holds(&row.range) => self.fail(name, value.to_value(), words(row)),
            _ => Ok(()),
        }
    }

    fn vector(&self, name: &str, value: Vec3) -> Result<(), ScenarioError> {
        self.number(name, &Color(value.to_array()))
    }

    fn name(&self, name: &str, value: &str) -> Result<(), ScenarioError> {
        if is_name(value) { Ok(()) } else { self.fail(name, format!("{value:?}"), NAME) }
    }

    fn count(&self, name: &str, count: usize, most: usize) -> Result<(), ScenarioError> {
        if count <= most {
            Ok(())
        } else {
            self.fail(name, format!("{count} long"), format!("at most {most}"))
        }
    }

    fn plant(&self, plant: &Planting) -> Result<(), ScenarioError> {
        self.name("species", &plant.species)?;
        self.vector("at", plant.at)?;
        self.number("turn_deg", &plant.turn_deg)?;
        self.number("tilt_deg", &plant.tilt_deg)
    }

    fn solid(&self, solid: &PlacedSolid) -> Result<(), ScenarioError> {
        self.name("name", &solid.name)?;
        match solid.shape {
            SolidShape::Box { size } => self.vector("shape.size", size)?,
            SolidShape::Ball { radius } => self.number("shape.radius", &radius)?,
            SolidShape::Cylinder { radius, height } => {
                self.number("shape.radius", &radius)?;
                self.number("shape.height", &height)?;
            }
        }
        self.vector("at", solid.at)?;
        self.number("turn_deg", &solid.turn_deg)?;
        self.number("color", &solid.color)
    }

    fn lamp(&self, lamp: &PlacedLamp) -> Result<(), ScenarioError> {
        self.name("name", &lamp.name)?;
        self.vector("at", lamp.at)?;
        self.number("strength", &lamp.strength)?;
        self.number("radius", &lamp.radius)?;
        self.number("color", &lamp.color)
    }

    fn sun(&self, sun: &PlacedSun) -> Result<(), ScenarioError> {
        self.number("elevation_deg", &sun.elevation_deg)?;
        self.number("azimuth_deg", &sun.azimuth_deg)?;
        self.number("strength", &sun.strength)
    }
}

/// What stands there at a step, as far as edits can know before anything grows.
#[derive(Default)]
struct Inventory {
    /// By name, whether it is a lamp.
    named: BTreeMap<String, bool>,
    /// By plant, whether it is still there.
    plants: Vec<bool>,
    species: BTreeSet<String>,
}

impl Inventory {
    /// What stands at the start of a sound scenario.
    fn of(scenario: &Scenario) -> Self {
        let named = scenario.solids.iter().map(|solid| (solid.name.clone(), false));
        Self {
            named: named.chain(scenario.lamps.iter().map(|lamp| (lamp.name.clone(), true))).collect(),
            plants: vec![true; scenario.plants.len()],
            species: scenario.plants.iter().map(|plant| plant.species.clone()).collect(),
        }
    }

    /// Checks that there is not too much of anything.
    fn count(&self, top: &Checker) -> Result<(), ScenarioError> {
        let lamps = self.named.values().filter(|lamp| **lamp).count();
        top.count("lamps", lamps, limits::LAMPS)?;
        top.count("solids", self.named.len() - lamps, limits::SOLIDS)
    }

    fn timed(&mut self, index: usize, timed: &TimedEdit) -> Result<(), ScenarioError> {
        Checker::at(format!("edits[{index}]")).number("step", &timed.step)?;
        self.edit(index, &timed.edit)
    }

    fn edit(&mut self, index: usize, edit: &Edit) -> Result<(), ScenarioError> {
        let check = |kind| Checker::within(index, kind);
        match edit {
            Edit::Plant(plant) => {
                check("Plant").plant(plant)?;
                Checker::at("").count("plants", self.plants.len() + 1, limits::PLANTS)?;
                self.plants.push(true);
                self.species.insert(plant.species.clone());
                Ok(())
            }
            Edit::PlaceSolid(solid) => {
                check("PlaceSolid").solid(solid)?;
                self.place(&check("PlaceSolid"), "name", &solid.name, false)
            }
            Edit::PlaceLamp(lamp) => {
                check("PlaceLamp").lamp(lamp)?;
                self.place(&check("PlaceLamp"), "name", &lamp.name, true)
            }
            Edit::Move { name, to, turn_deg } => {
                self.known(&check(""), name, false)?;
                check("").vector("to", *to)?;
                check("").number("turn_deg", turn_deg)
            }
            Edit::Pose { name, to, rotation_deg, scale } => {
                self.known(&check(""), name, false)?;
                check("").vector("to", *to)?;
                check("").vector("rotation_deg", *rotation_deg)?;
                check("").vector("scale", *scale)
            }
            Edit::Duplicate { name, copy, to } => {
                self.known(&check(""), name, false)?;
                check("").vector("to", *to)?;
                check("").name("copy", copy)?;
                let lamp = self.named.get(name).copied().unwrap_or_default();
                self.place(&check(""), "copy", copy, lamp)
            }
            Edit::Shine { name, strength, radius } => {
                self.known(&check(""), name, true)?;
                check("").number("strength", strength)?;
                check("").number("radius", radius)
            }
            Edit::Switch { name, .. } => self.known(&check(""), name, true),
            Edit::Remove { name } => {
                self.known(&check(""), name, false)?;
                self.named.remove(name);
                Ok(())
            }
            Edit::Prune { plant, .. } => self.plant(&check(""), *plant).map(|_| ()),
            Edit::Shear { from, to } => {
                check("").vector("from", *from)?;
                check("").vector("to", *to)
            }
            Edit::Top { plant, above } => {
                self.plant(&check(""), *plant)?;
                check("").number("above", above)
            }
            Edit::Uproot { plant } => {
                *self.plant(&check(""), *plant)? = false;
                Ok(())
            }
            Edit::Set { species, parameter, value } => self.set(&check(""), species, parameter, value),
            Edit::SetAll { species, values } => {
                check("").count("values", values.len(), Species::parameters().len())?;
                let set =
                    |(parameter, value): &(String, String)| self.set(&check(""), species, parameter, value);
                values.iter().try_for_each(set)
            }
            Edit::Sun(sun) => sun.as_ref().map_or(Ok(()), |sun| check("Sun").sun(sun)),
            Edit::Sky(sky) => check("Sky").number("strength", &sky.strength),
            Edit::Mechanisms(_) => Ok(()),
        }
    }

    /// Changes nothing if the name is taken.
    fn place(&mut self, check: &Checker, field: &str, name: &str, lamp: bool) -> Result<(), ScenarioError> {
        if self.named.contains_key(name) {
            return check.fail(field, format!("{name:?}"), "a name nothing else has");
        }
        self.named.insert(name.into(), lamp);
        Ok(())
    }

    fn known(&self, check: &Checker, name: &str, lamp: bool) -> Result<(), ScenarioError> {
        let fits = self.named.get(name).is_some_and(|is_lamp| *is_lamp || !lamp);
        if fits {
            return Ok(());
        }
        let known: Vec<&str> = self
            .named
            .iter()
            .filter(|(_, is_lamp)| **is_lamp || !lamp)
            .map(|(n, _)| n.as_str())
            .take(20)
            .collect();
        let kind = if lamp { "lamp" } else { "solid or lamp" };
        let allowed = if known.is_empty() {
            format!("the name of a {kind}, of which there is none at that step")
        } else {
            format!("the name of a {kind} at that step: {}", known.join(", "))
        };
        check.fail("name", format!("{name:?}"), allowed)
    }

    fn plant(&mut self, check: &Checker, plant: u32) -> Result<&mut bool, ScenarioError> {
        let count = self.plants.len();
        match self.plants.get_mut(plant as usize) {
            Some(there) if *there => Ok(there),
            Some(_) => Err(ScenarioError {
                field: check.field("plant"),
                value: plant.to_string(),
                allowed: "a plant that was not uprooted before".into(),
            }),
            None => Err(ScenarioError {
                field: check.field("plant"),
                value: plant.to_string(),
                allowed: format!("a plant sown by that step, of which there are {count}, numbered from 0"),
            }),
        }
    }

    fn set(&self, check: &Checker, species: &str, parameter: &str, value: &str) -> Result<(), ScenarioError> {
        if !self.species.contains(species) {
            let known: Vec<&str> = self.species.iter().map(String::as_str).take(20).collect();
            let allowed = format!("a species sown by that step: {}", known.join(", "));
            return check.fail("species", format!("{species:?}"), allowed);
        }
        match Species::default().set(parameter, &parse_value(value)) {
            Ok(()) => Ok(()),
            Err(ParameterError::Invalid { allowed, .. }) => check.fail("value", value, allowed),
            Err(e @ ParameterError::Unknown { .. }) => {
                check.fail("parameter", format!("{parameter:?}"), format!("a parameter of species; {e}"))
            }
        }
    }
}
