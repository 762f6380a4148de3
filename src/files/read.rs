//! Reading text files within limits, and writing whole files or none.

use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use super::{FileError, Place};
use crate::limits;

/// Reads a text file of at most [`limits::FILE_BYTES`].
///
/// # Errors
/// If it is not there, cannot be read, is too large or is not text.
pub fn read_text(path: &Path) -> Result<String, FileError> {
    read_up_to(path, limits::FILE_BYTES)
}

/// Reads a text file of at most [`limits::FILE_BYTES`], or [`limits::SKELETON_BYTES`] if it is a skeleton file.
///
/// # Errors
/// As [`read_text`].
pub fn read_plant_text(path: &Path) -> Result<String, FileError> {
    let text = read_up_to(path, limits::SKELETON_BYTES)?;
    if text.len() as u64 > limits::FILE_BYTES && !super::is_skeleton(&text) {
        return Err(FileError::TooLarge { file: path.display().to_string(), limit: limits::FILE_BYTES });
    }
    Ok(text)
}

/// The text of a file of at most so many bytes.
pub(super) fn read_up_to(path: &Path, most: u64) -> Result<String, FileError> {
    let file = path.display().to_string();
    let io = |e: io::Error| match e.kind() {
        io::ErrorKind::NotFound => FileError::NotFound { file: file.clone() },
        _ => FileError::Io { file: file.clone(), reason: format!("cannot be read: {e}") },
    };
    if !fs::metadata(path).map_err(io)?.is_file() {
        return Err(FileError::Io { file, reason: "is not a file".into() });
    }
    let mut bytes = Vec::new();
    File::open(path).and_then(|f| f.take(most + 1).read_to_end(&mut bytes)).map_err(io)?;
    text_within(bytes, file, most)
}

/// The text of a file's bytes, at most [`limits::FILE_BYTES`].
#[cfg(feature = "assets")]
pub(crate) fn text_of(bytes: Vec<u8>, file: String) -> Result<String, FileError> {
    text_within(bytes, file, limits::FILE_BYTES)
}

fn text_within(bytes: Vec<u8>, file: String, limit: u64) -> Result<String, FileError> {
    if bytes.len() as u64 > limit {
        return Err(FileError::TooLarge { file, limit });
    }
    if let Some(byte) = bytes.iter().position(|b| *b == 0) {
        return Err(FileError::NotText { file, byte });
    }
    String::from_utf8(bytes)
        .map_err(|e| FileError::NotText { file: file.clone(), byte: e.utf8_error().valid_up_to() })
}

/// The file that a path in another file names: below `folder` and nowhere else, links included.
///
/// # Errors
/// [`FileError::OutsideFolder`] for an absolute path, one with `..`, or a link that leads out.
pub fn inside(folder: &Path, path: &str, at: &Place) -> Result<PathBuf, FileError> {
    let outside =
        || FileError::OutsideFolder { at: at.clone(), path: crate::species::parameter::shorten(path) };
    if !leads_down(path) {
        return Err(outside());
    }
    let file = folder.join(path);
    let missing = |_| FileError::NotFound { file: file.display().to_string() };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let real = file.canonicalize().map_err(missing)?;
    if !real.starts_with(folder.canonicalize().map_err(missing)?) {
        return Err(outside());
    }
    Ok(file)
}

/// Whether a path leads to a file below where it begins, as far as it alone tells.
pub(crate) fn leads_down(path: &str) -> bool {
    // A backslash or colon means something on one system and nothing on another.
    !path.is_empty()
        && !path.contains(['\\', ':', '\0'])
        && Path::new(path).components().all(|c| matches!(c, Component::Normal(_)))
}

/// Writes a whole file or leaves what was there, as [`replace_file`] does.
///
/// # Errors
/// As [`replace_file`].
pub fn write_whole(path: &Path, bytes: &[&[u8]]) -> io::Result<()> {
    replace_file(path, |file| bytes.iter().try_for_each(|part| file.write_all(part)))
}

/// Has a whole file written or leaves what was there: a temporary file in the same folder, flushed, then renamed.
///
/// # Errors
/// If `write` fails, or the folder does not take the file, or something that is no file stands in its place;
/// what was there is untouched then.
pub fn replace_file<E: From<io::Error>>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), E>,
) -> Result<(), E> {
    // Two writers of one file must not share a temporary one, even within this program.
    static WRITERS: AtomicU32 = AtomicU32::new(0);
    let name = path.file_name().ok_or_else(|| io::Error::other("not a file name"))?;
    // A rename would put a plain file in the place of a device.
    if fs::metadata(path).is_ok_and(|there| !there.is_file()) {
        return Err(io::Error::other("something that is not a file is in its place").into());
    }
    let mut temporary = std::ffi::OsString::from(".");
    temporary.push(name);
    temporary.push(format!(".{}.{}.part", std::process::id(), WRITERS.fetch_add(1, Ordering::Relaxed)));
    let temporary = path.with_file_name(temporary);
    let whole = || {
        let mut file = BufWriter::new(File::create(&temporary)?);
        write(&mut file)?;
        file.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
        Ok(fs::rename(&temporary, path)?)
    };
    let written = whole();
    if written.is_err() {
        // Best effort: the error worth telling is the first one.
        let _ = fs::remove_file(&temporary);
    }
    written
}
