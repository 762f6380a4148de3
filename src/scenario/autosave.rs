//! An autosave: what was growing survives a crash, and no file is ever lost to it.

use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::SavedRun;
use crate::files::SaveError;

/// Where the garden is saved now and then. The file is replaced whole or not at all.
///
/// What an earlier session left is set aside before the first write of this one: a sound save as `NAME.previous`, in
/// the place of one from before it, anything else as `NAME.damaged-1` and so on, of which none is ever replaced.
#[derive(Debug)]
pub struct Autosave {
    path: PathBuf,
    /// What the earlier session left is still in its place.
    left: Left,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Left {
    Nothing,
    Sound,
    Damaged,
}

impl Autosave {
    /// Opens the place of an autosave and reads what an earlier session left there, if anything. A damaged one is
    /// reported and left as it is.
    pub fn open(path: impl Into<PathBuf>) -> (Self, Result<Option<SavedRun>, SaveError>) {
        let path = path.into();
        let found = match SavedRun::read(&path) {
            Err(SaveError::Io { source, .. }) if source.kind() == io::ErrorKind::NotFound => Ok(None),
            read => read.map(Some),
        };
        let left = match found {
            Ok(None) => Left::Nothing,
            Ok(Some(_)) => Left::Sound,
            Err(_) => Left::Damaged,
        };
        (Self { path, left }, found)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes it, whole or not at all, once what was there is safe.
    ///
    /// # Errors
    /// If it cannot be written; whatever was there is still there, or beside it, then.
    pub fn write(&mut self, saved: &SavedRun) -> Result<(), SaveError> {
        self.set_aside().map_err(|source| SaveError::Io { file: self.path.display().to_string(), source })?;
        saved.write(&self.path)
    }

    fn set_aside(&mut self) -> io::Result<()> {
        let beside = |end: &str| {
            let mut name = OsString::from(self.path.file_name().unwrap_or_default());
            name.push(end);
            self.path.with_file_name(name)
        };
        let to = match self.left {
            Left::Nothing => return Ok(()),
            Left::Sound => beside(".previous"),
            // A folder has room for some number of files; the first free name is soon found.
            Left::Damaged => {
                match (1..10_000).map(|i| beside(&format!(".damaged-{i}"))).find(|p| !p.exists()) {
                    Some(free) => free,
                    None => return Err(io::Error::other("too many damaged saves beside it")),
                }
            }
        };
        // Only a file is set aside: a folder in its place is for whoever made it to move.
        if !fs::symlink_metadata(&self.path).is_ok_and(|there| there.is_dir()) {
            match fs::rename(&self.path, to) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => self.left = Left::Nothing,
            }
        }
        Ok(())
    }
}
