//! Files people write and files a run leaves behind: species, scenarios, `run.ron`, saves.
//!
//! Whatever is wrong with a file is one [`FileError`]: where it is, what is there and what is allowed. Nothing
//! is clamped silently and nothing is half loaded.

mod check;
mod mtg;
mod read;
mod ron_text;
mod run;
mod save;
mod scenario;
mod set;
mod share;
mod skeleton;
mod source;
mod species;

pub use mtg::{mtg_skeletons, read_mtg};
pub use read::{inside, read_plant_text, read_text, replace_file, write_whole};
#[cfg(feature = "assets")]
pub(crate) use read::{leads_down, text_of};
pub use run::{Likeness, RunFile, StepHashes};
pub use save::{SaveError, is_save, read_save, write_save};
pub use scenario::{FARTHEST_M, LARGEST_M, ResolvedScenario, ScenarioError};
pub use set::parse_value;
pub use share::{ShareError, SharedTree};
pub use skeleton::{SkeletonFile, Stem, StemLeafAt, is_skeleton};

use crate::species::parameter::nearest;
use source::Source;

/// Version of the species, scenario and run files this program reads and writes.
pub const VERSION: u32 = 1;

/// A spot in a file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Place {
    /// The file.
    pub file: String,
    /// Line, from 1, where known.
    pub line: Option<u32>,
    /// Column in characters, from 1, where known.
    pub column: Option<u32>,
}

impl Place {
    /// Somewhere in a file.
    pub fn file(file: impl Into<String>) -> Self {
        Self { file: file.into(), line: None, column: None }
    }
}

impl core::fmt::Display for Place {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(&self.file)?;
        for n in [self.line, self.column].into_iter().flatten() {
            write!(f, ":{n}")?;
        }
        Ok(())
    }
}

/// What is wrong with a file; nothing of it was used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FileError {
    /// It is not there.
    #[error("{file}: there is no such file")]
    NotFound {
        /// The file.
        file: String,
    },
    /// It could not be read or written.
    #[error("{file}: {reason}")]
    Io {
        /// The file.
        file: String,
        /// What the system says.
        reason: String,
    },
    /// It is not text.
    #[error("{file}: not a text file (byte {byte}); species, scenarios and runs are RON text in UTF-8")]
    NotText {
        /// The file.
        file: String,
        /// The first byte that is no text, from 0.
        byte: usize,
    },
    /// It is larger than [`limits::FILE_BYTES`](crate::limits::FILE_BYTES).
    #[error("{file}: larger than {limit} bytes, the most such a file may have")]
    TooLarge {
        /// The file.
        file: String,
        /// The most bytes allowed.
        limit: u64,
    },
    /// Its brackets are nested deeper than [`limits::NESTING`](crate::limits::NESTING).
    #[error("{at}: brackets nested more than {limit} deep")]
    TooDeep {
        /// The bracket that is too deep.
        at: Place,
        /// The deepest allowed.
        limit: usize,
    },
    /// It is not well-formed RON, or not of this kind.
    #[error("{at}: {message}")]
    Syntax {
        /// Where.
        at: Place,
        /// What is wrong.
        message: String,
    },
    /// It has a field that does not exist.
    #[error("{at}: there is no field `{field}`{}", did_you_mean(.nearest))]
    UnknownField {
        /// Where.
        at: Place,
        /// The field.
        field: String,
        /// The most similar field there is.
        nearest: Option<String>,
    },
    /// A value is of the wrong type or out of range.
    #[error("{at}: `{field}` is {value}; allowed: {allowed}")]
    Invalid {
        /// Where.
        at: Place,
        /// The field.
        field: String,
        /// The value.
        value: String,
        /// What is allowed.
        allowed: String,
    },
    /// It was written for another version of the format.
    #[error("{at}: file version {version}; this program reads version {VERSION}")]
    Version {
        /// Where.
        at: Place,
        /// The version it names.
        version: String,
    },
    /// A path in it leads out of its folder.
    #[error("{at}: `{path}` leads out of the folder; use a relative path to a file beside this one")]
    OutsideFolder {
        /// Where.
        at: Place,
        /// The path.
        path: String,
    },
    /// There is no species of that name.
    #[error("{at}: there is no species `{name}`{}; there are {}", did_you_mean(.nearest), .known.join(", "))]
    NoSuchSpecies {
        /// Where it is named.
        at: Place,
        /// The name.
        name: String,
        /// The most similar name there is.
        nearest: Option<String>,
        /// All names there are.
        known: Vec<String>,
    },
    /// There is no scenario of that name.
    #[error("{at}: there is no scenario `{name}`{}; there are {}", did_you_mean(.nearest), .known.join(", "))]
    NoSuchScenario {
        /// Where it is named.
        at: Place,
        /// The name.
        name: String,
        /// The most similar name there is.
        nearest: Option<String>,
        /// All names there are.
        known: Vec<String>,
    },
}

impl FileError {
    pub(crate) fn no_such_species(at: Place, name: &str, known: Vec<String>) -> Self {
        let nearest = nearest(name, known.iter().map(String::as_str)).map(Into::into);
        Self::NoSuchSpecies { at, name: crate::species::parameter::shorten(name), nearest, known }
    }

    /// The same error about a name, but where that name was used.
    pub(crate) fn moved_to(self, place: Place) -> Self {
        match self {
            Self::NoSuchSpecies { name, nearest, known, .. } => {
                Self::NoSuchSpecies { at: place, name, nearest, known }
            }
            other => other,
        }
    }

    pub(crate) fn no_such_scenario(at: Place, name: &str, known: Vec<String>) -> Self {
        let nearest = nearest(name, known.iter().map(String::as_str)).map(Into::into);
        Self::NoSuchScenario { at, name: crate::species::parameter::shorten(name), nearest, known }
    }
}

/// Names of a file's outermost fields.
pub(crate) fn top_fields(text: &str) -> Vec<String> {
    let entries = Source::new(text, "").entries(1);
    (0..entries.len()).map(|i| Source::path(&entries, i).swap_remove(0)).collect()
}

/// Where the value at the end of a path stands in a text.
pub(crate) fn place_in(text: &str, file: &str, path: &[String]) -> Place {
    Source::new(text, file).place_of(path)
}

fn did_you_mean(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|n| format!("; did you mean `{n}`?")).unwrap_or_default()
}
