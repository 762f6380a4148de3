//! Reading text files within limits, and writing whole files or none.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Component, Path, PathBuf};

use super::{FileError, Place};
use crate::limits;

/// Reads a text file of at most [`limits::FILE_BYTES`].
///
/// # Errors
/// If it is not there, cannot be read, is too large or is not text.
pub fn read_text(path: &Path) -> Result<String, FileError> {
    let file = path.display().to_string();
    let io = |e: io::Error| match e.kind() {
        io::ErrorKind::NotFound => FileError::NotFound { file: file.clone() },
        _ => FileError::Io { file: file.clone(), reason: format!("cannot be read: {e}") },
    };
    if !fs::metadata(path).map_err(io)?.is_file() {
        return Err(FileError::Io { file, reason: "is not a file".into() });
    }
    let mut bytes = Vec::new();
    File::open(path).and_then(|f| f.take(limits::FILE_BYTES + 1).read_to_end(&mut bytes)).map_err(io)?;
    if bytes.len() as u64 > limits::FILE_BYTES {
        return Err(FileError::TooLarge { file, limit: limits::FILE_BYTES });
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
    // A backslash or colon means something on one system and nothing on another.
    let plain = !path.is_empty()
        && !path.contains(['\\', ':', '\0'])
        && Path::new(path).components().all(|c| matches!(c, Component::Normal(_)));
    if !plain {
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

/// Writes a whole file or leaves what was there: a temporary file in the same folder, flushed, then renamed.
///
/// # Errors
/// If any of that fails; the old file is untouched then.
pub fn write_whole(path: &Path, bytes: &[&[u8]]) -> io::Result<()> {
    let name = path.file_name().ok_or_else(|| io::Error::other("not a file name"))?;
    let mut temporary = std::ffi::OsString::from(".");
    temporary.push(name);
    temporary.push(format!(".{}.part", std::process::id()));
    let temporary = path.with_file_name(temporary);
    let written = (|| {
        let mut file = File::create(&temporary)?;
        for part in bytes {
            file.write_all(part)?;
        }
        file.sync_all()?;
        fs::rename(&temporary, path)
    })();
    if written.is_err() {
        // Best effort: the error worth telling is the first one.
        let _ = fs::remove_file(&temporary);
    }
    written
}
