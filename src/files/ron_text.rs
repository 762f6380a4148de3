//! RON in and out: parsing with errors that name field, value and range, and writing only what differs.

use ron::Error as Ron;
use ron::extensions::Extensions;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::source::{Source, join_path};
use super::{FileError, VERSION};
use crate::limits;
use crate::species::parameter::{nearest, shorten};

/// `sun: (…)` stands for `sun: Some((…))`, and `PlaceLamp(name: …)` for `PlaceLamp((name: …))`.
fn options() -> ron::Options {
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME | Extensions::UNWRAP_VARIANT_NEWTYPES)
}

/// Parses a file. `allowed` says what the value at a path may be, `None` where it is a structure.
pub(crate) fn parse<T: DeserializeOwned>(
    text: &str,
    file: &str,
    allowed: &dyn Fn(&[String]) -> Option<String>,
) -> Result<T, FileError> {
    if text.len() as u64 > limits::FILE_BYTES {
        return Err(FileError::TooLarge { file: file.into(), limit: limits::FILE_BYTES });
    }
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let source = Source::new(text, file);
    source.check()?;
    let top = source.entries(1);
    if let Some(i) = Source::find(&top, &["version".to_string()])
        && let Ok(version) = source.value(&top[i]).parse::<u64>()
        && version != u64::from(VERSION)
    {
        return Err(FileError::Version { at: source.place(top[i].span.start), version: version.to_string() });
    }
    options().from_str(text).map_err(|e| explain(&source, &e, allowed))
}

fn explain(
    source: &Source,
    error: &ron::error::SpannedError,
    allowed: &dyn Fn(&[String]) -> Option<String>,
) -> FileError {
    // RON's position may be that of the white space before a value.
    let offset = source.skip_space(source.offset(error.span.start.line, error.span.start.col));
    let at = source.place(offset);
    let entries = source.entries(limits::NESTING);
    let found = Source::at(&entries, offset);
    let path = found.map(|i| Source::path(&entries, i)).unwrap_or_default();
    match &error.code {
        Ron::NoSuchStructField { expected, found, .. } => FileError::UnknownField {
            at,
            field: shorten(found),
            nearest: nearest(found, expected.iter().copied()).map(Into::into),
        },
        Ron::NoSuchEnumVariant { expected, found, .. } => FileError::Invalid {
            at,
            field: shorten(&join_path(&path)),
            value: shorten(found),
            allowed: expected.join(" | "),
        },
        Ron::MissingStructField { field, .. } => {
            FileError::Syntax { at, message: format!("the field `{field}` is missing") }
        }
        code => {
            let value = found.filter(|i| entries[*i].is_single());
            // These are about what comes after a value, unless they strike in its midst (`3.5` for a whole number).
            let after = matches!(
                code,
                Ron::ExpectedComma | Ron::Eof | Ron::ExpectedStructLikeEnd | Ron::ExpectedArrayEnd
            );
            if let Some(i) = value
                && !matches!(code, Ron::DuplicateStructField { .. })
                && !(after && source.offset(error.span.end.line, error.span.end.col) >= entries[i].span.end)
                && let Some(allowed) = allowed(&path)
            {
                return FileError::Invalid {
                    at: source.place(entries[i].span.start),
                    field: join_path(&path),
                    value: shorten(source.value(&entries[i])),
                    allowed,
                };
            }
            let mut message = shorten_message(&code.to_string());
            if !path.is_empty() {
                message.push_str(&format!(" (in `{}`)", shorten(&join_path(&path))));
            }
            FileError::Syntax { at, message }
        }
    }
}

fn shorten_message(message: &str) -> String {
    const LONGEST: usize = 300;
    match message.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &message[..end]),
        None => message.into(),
    }
}

/// The fields of a structure, each with its value as RON on one line.
pub(crate) fn fields<T: Serialize>(value: &T) -> Vec<(String, String)> {
    let layout = ron::ser::PrettyConfig::new().depth_limit(1).new_line("\n").indentor("");
    // Plain structures of numbers, names and lists always serialise.
    let text = options().to_string_pretty(value, layout).unwrap_or_default();
    text.lines()
        .filter_map(|line| line.strip_suffix(',')?.split_once(": "))
        .map(|(name, value)| (name.into(), value.into()))
        .collect()
}

/// The fields that differ from those of another, and `always` these.
pub(crate) fn differing<T: Serialize>(value: &T, from: &T, always: &[&str]) -> Vec<(String, String)> {
    fields(value)
        .into_iter()
        .zip(fields(from))
        .filter(|(new, old)| new.1 != old.1 || always.contains(&new.0.as_str()))
        .map(|(new, _)| new)
        .collect()
}

/// A structure on one line, of the fields that differ.
pub(crate) fn short<T: Serialize>(value: &T, from: &T, always: &[&str]) -> String {
    let fields: Vec<String> =
        differing(value, from, always).iter().map(|(name, value)| format!("{name}: {value}")).collect();
    format!("({})", fields.join(", "))
}

/// A file of fields, one a line.
pub(crate) fn file_of(fields: &[(String, String)]) -> String {
    let mut text = String::from("(\n");
    for (name, value) in fields {
        text.push_str(&format!("    {name}: {value},\n"));
    }
    text.push_str(")\n");
    text
}

/// A list, an element a line.
pub(crate) fn list_of(elements: impl Iterator<Item = String>) -> String {
    let lines: String = elements.map(|e| format!("        {e},\n")).collect();
    if lines.is_empty() { "[]".into() } else { format!("[\n{lines}    ]") }
}

/// A value on one line.
pub(crate) fn line_of<T: Serialize>(value: &T) -> String {
    // As in `fields`: what is written here always serialises.
    options().to_string(value).unwrap_or_default()
}

/// A whole structure, everything listed.
pub(crate) fn whole<T: Serialize>(value: &T) -> String {
    let layout = ron::ser::PrettyConfig::new().depth_limit(3).new_line("\n");
    let mut text = options().to_string_pretty(value, layout).unwrap_or_default();
    text.push('\n');
    text
}

/// The error of a value found wrong after parsing: as it was written, and where.
pub(crate) fn invalid(source: &Source, path: &[String], value: String, allowed: String) -> FileError {
    let value = source.written(path).map_or(value, shorten);
    FileError::Invalid { at: source.place_of(path), field: join_path(path), value: shorten(&value), allowed }
}
