//! Species as files.

use super::ron_text::{differing, file_of, invalid, parse};
use super::source::Source;
use super::{FileError, VERSION};
use crate::species::Species;
use crate::species::parameter::ParameterError;

/// What the texts of a file may be.
pub(crate) const NAME: &str = "a name of 1 to 80 characters on one line";
/// What a longer text may be.
pub(crate) const TEXT: &str = "at most 4000 characters";

/// Whether a text may be a name.
pub(crate) fn is_name(text: &str) -> bool {
    !text.trim().is_empty() && text.chars().count() <= 80 && !text.chars().any(char::is_control)
}

/// Whether a text may be a description.
pub(crate) fn is_text(text: &str) -> bool {
    text.chars().count() <= 4000
}

/// What a species' field may be, `None` if there is none of that name.
pub(crate) fn allowed(field: &str) -> Option<String> {
    match field {
        "version" => Some(VERSION.to_string()),
        "name" => Some(NAME.into()),
        "description" | "source" => Some(TEXT.into()),
        _ => Species::parameters().iter().find(|p| p.name == field).map(|p| p.allowed()),
    }
}

impl Species {
    /// Reads a species from the text of a file; `file` is its name, for errors.
    ///
    /// # Errors
    /// [`FileError`] with line, column, field, value and range, as far as each is known.
    pub fn from_ron(text: &str, file: &str) -> Result<Self, FileError> {
        let species: Self = parse(text, file, &|path| match path {
            [field] => allowed(field),
            _ => None,
        })?;
        species.check(&Source::new(text, file), &[])?;
        Ok(species)
    }

    /// As RON that lists only what differs from the defaults; reads back as exactly this species.
    pub fn to_ron(&self) -> String {
        file_of(&differing(self, &Self::default(), &["version", "name"]))
    }

    /// Checks all of it; `path` is where it stands in the source.
    pub(crate) fn check(&self, source: &Source, path: &[String]) -> Result<(), FileError> {
        let wrong = |field: &str, value: &str| {
            let path: Vec<String> = path.iter().cloned().chain([field.to_string()]).collect();
            let allowed = allowed(field).unwrap_or_default();
            Err(invalid(source, &path, value.to_string(), allowed))
        };
        if self.version != VERSION {
            return wrong("version", &self.version.to_string());
        }
        if !is_name(&self.name) {
            return wrong("name", &format!("{:?}", self.name));
        }
        for (field, text) in [("description", &self.description), ("source", &self.source)] {
            if !is_text(text) {
                return wrong(field, text);
            }
        }
        match self.validate() {
            Ok(()) => Ok(()),
            Err(ParameterError::Invalid { name, value, .. }) => wrong(name, &value),
            // Validation only ever meets parameters of the table.
            Err(ParameterError::Unknown { name, .. }) => wrong(&name, ""),
        }
    }
}
