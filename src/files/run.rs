//! `run.ron`: all that is needed to grow the same tree again, and the hashes to tell whether it is the same.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::ron_text::{invalid, parse, whole};
use super::scenario::{ResolvedScenario, allowed as allowed_in_scenario};
use super::source::Source;
use super::{FileError, VERSION, species};
use crate::limits;
use crate::scenario::Scenario;
use crate::species::Species;

/// Hashes of the garden by step, thinned so that a long run keeps few.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct StepHashes(BTreeMap<u32, Hash>);

/// A hash, written as sixteen hexadecimal digits: RON's numbers would lose their look, not their value.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Hash(u64);

impl Serialize for Hash {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&format_args!("{:016x}", self.0))
    }
}

impl<'de> Deserialize<'de> for Hash {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let digits = text.len() == 16 && text.bytes().all(|b| b.is_ascii_hexdigit());
        let hash = digits.then(|| u64::from_str_radix(&text, 16).ok()).flatten();
        hash.map(Hash).ok_or_else(|| serde::de::Error::custom("a hash is sixteen hexadecimal digits"))
    }
}

impl StepHashes {
    /// The most hashes kept.
    pub const MOST: usize = 1000;

    /// Adds the hash after a step; every other one goes when there are too many, the newest stays.
    pub fn push(&mut self, step: u32, hash: u64) {
        if self.0.len() >= Self::MOST {
            let mut keep = false;
            self.0.retain(|_, _| {
                keep = !keep;
                keep
            });
        }
        self.0.insert(step, Hash(hash));
    }

    /// The hash after a step, if it was kept.
    pub fn get(&self, step: u32) -> Option<u64> {
        self.0.get(&step).map(|h| h.0)
    }

    /// Every step kept and its hash, in order.
    pub fn iter(&self) -> impl Iterator<Item = (u32, u64)> {
        self.0.iter().map(|(step, hash)| (*step, hash.0))
    }

    /// The last step kept and its hash.
    pub fn last(&self) -> Option<(u32, u64)> {
        self.0.last_key_value().map(|(step, hash)| (*step, hash.0))
    }

    /// Compares the steps that both keep.
    pub fn compare(&self, other: &Self) -> Likeness {
        let mut last = None;
        for (&step, hash) in &self.0 {
            match other.0.get(&step) {
                Some(found) if found != hash => return Likeness::Differs { at: step },
                Some(_) => last = Some(step),
                None => {}
            }
        }
        last.map_or(Likeness::Unknown, |upto| Likeness::Same { upto })
    }
}

/// Whether two runs grew the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Likeness {
    /// The same at every step that both keep.
    Same {
        /// The last such step.
        upto: u32,
    },
    /// Different.
    Differs {
        /// The first step at which they differ.
        at: u32,
    },
    /// They keep no step in common.
    Unknown,
}

/// What `run.ron` holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunFile {
    /// Version of the file format.
    pub version: u32,
    /// The program that grew it.
    pub program: String,
    /// Seed of the run.
    pub seed: u64,
    /// Steps grown.
    pub steps: u32,
    /// The garden at the start, with the edits of the run.
    pub scenario: Scenario,
    /// Every species in it, by the name plants give.
    pub species: BTreeMap<String, Species>,
    /// Hashes of the garden after its steps.
    pub hashes: StepHashes,
}

impl RunFile {
    /// The file of a run that has grown so far.
    pub fn new(resolved: &ResolvedScenario, seed: u64, steps: u32, hashes: StepHashes) -> Self {
        Self {
            version: VERSION,
            program: concat!("burgeon ", env!("CARGO_PKG_VERSION")).into(),
            seed,
            steps,
            scenario: resolved.scenario.clone(),
            species: resolved.species.clone(),
            hashes,
        }
    }

    /// Reads a run from the text of a file; `file` is its name, for errors.
    ///
    /// # Errors
    /// [`FileError`] with line, column, field, value and range, as far as each is known.
    pub fn from_ron(text: &str, file: &str) -> Result<Self, FileError> {
        let mut run: Self = parse(text, file, &|path| match path {
            [field] => allowed(field),
            [map, _, field] if map == "species" => species::allowed(field),
            [map, rest @ ..] if map == "scenario" => allowed_in_scenario(rest),
            _ => None,
        })?;
        let source = Source::new(text, file);
        let wrong = |field: &str, value: String| {
            Err(invalid(&source, &[field.to_string()], value, allowed(field).unwrap_or_default()))
        };
        if run.version != VERSION {
            return wrong("version", run.version.to_string());
        }
        if !species::is_name(&run.program) {
            return wrong("program", run.program);
        }
        if run.steps > limits::STEPS {
            return wrong("steps", run.steps.to_string());
        }
        for (name, species) in &run.species {
            let path = ["species".to_string(), name.clone()];
            species.check(&source, &path)?;
            if species.name != *name {
                let [map, entry] = path;
                let allowed = format!("{name:?}, as plants call it");
                let path = [map, entry, "name".into()];
                return Err(invalid(&source, &path, format!("{:?}", species.name), allowed));
            }
        }
        run.scenario.check(&source, &["scenario".to_string()])?;
        for (name, path) in run.scenario.species_named() {
            if !run.species.contains_key(name) {
                let path: Vec<String> = core::iter::once("scenario".to_string()).chain(path).collect();
                let known = run.species.keys().cloned().collect();
                return Err(FileError::no_such_species(source.place_of(&path), name, known));
            }
        }
        run.scenario.order_edits();
        Ok(run)
    }

    /// As RON, everything listed, so that later defaults change nothing in it.
    pub fn to_ron(&self) -> String {
        whole(self)
    }

    /// Its garden.
    pub fn resolved(&self) -> ResolvedScenario {
        ResolvedScenario { scenario: self.scenario.clone(), species: self.species.clone() }
    }
}

fn allowed(field: &str) -> Option<String> {
    match field {
        "version" => Some(VERSION.to_string()),
        "program" => Some(species::NAME.into()),
        "seed" => Some("a whole number below 2^64".into()),
        "steps" => Some(format!("a whole number, 0 to {}", limits::STEPS)),
        "hashes" => Some("a map of steps to hashes of sixteen hexadecimal digits".into()),
        _ => None,
    }
}
