//! A species file on disk, read again whenever it changes.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

use crate::files::{FileError, read_text, write_whole};
use crate::species::Species;

/// How often the file is looked at.
const EVERY: Duration = Duration::from_millis(500);

/// A file that is watched.
#[derive(Debug, Clone)]
pub struct SpeciesFile {
    path: PathBuf,
    /// Its time and length when it was read last.
    read: Option<(SystemTime, u64)>,
    /// What was wrong with it last, so that it is told once.
    wrong: Option<FileError>,
    looked: Option<Instant>,
}

impl SpeciesFile {
    /// Watches a file; it is read when first asked.
    pub fn watch(path: PathBuf) -> Self {
        Self { path, read: None, wrong: None, looked: None }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The species in the file if that has changed since it was last asked; an error is told once.
    pub fn changed(&mut self, now: Instant) -> Option<Result<Species, FileError>> {
        if self.looked.is_some_and(|last| now.saturating_duration_since(last) < EVERY) {
            return None;
        }
        self.looked = Some(now);
        let stamp = std::fs::metadata(&self.path).ok().and_then(|m| Some((m.modified().ok()?, m.len())));
        if stamp.is_some() && stamp == self.read {
            return None;
        }
        let found =
            read_text(&self.path).and_then(|text| Species::from_ron(&text, &self.path.display().to_string()));
        self.read = stamp;
        match found {
            Err(wrong) if self.wrong.as_ref() == Some(&wrong) => None,
            Err(wrong) => {
                self.wrong = Some(wrong.clone());
                Some(Err(wrong))
            }
            Ok(species) => {
                self.wrong = None;
                Some(Ok(species))
            }
        }
    }
}

/// Writes a species, whole or not at all.
///
/// # Errors
/// If the file cannot be written; what was there is untouched.
pub fn write(path: &Path, species: &Species) -> Result<(), FileError> {
    write_whole(path, &[species.to_ron().as_bytes()])
        .map_err(|why| FileError::Io { file: path.display().to_string(), reason: why.to_string() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_changed_file_is_read_again_and_a_bad_one_is_told_once_with_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.ron");
        let mut file = SpeciesFile::watch(path.clone());
        let mut now = Instant::now();
        let mut look = |file: &mut SpeciesFile| {
            now += EVERY;
            file.changed(now)
        };
        assert!(matches!(look(&mut file), Some(Err(FileError::NotFound { .. }))));
        assert!(look(&mut file).is_none());
        let species = Species { name: "mine".into(), candidates: 9, ..Species::default() };
        write(&path, &species).unwrap();
        assert_eq!(look(&mut file), Some(Ok(species)));
        assert!(look(&mut file).is_none());
        std::fs::write(&path, "(\n    version: 1,\n    candidates: 1000,\n)").unwrap();
        let wrong = look(&mut file).unwrap().unwrap_err().to_string();
        assert!(wrong.contains("mine.ron:3") && wrong.contains("1000") && wrong.contains("256"), "{wrong}");
        assert!(look(&mut file).is_none());
        assert!(write(&folder.path().join("no/such/folder.ron"), &Species::default()).is_err());
    }
}
