//! What can go wrong when something is written.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Why a model or table was not written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The file or stream did not take it.
    #[error("cannot write{}: {source}", .path.as_ref().map(|p| format!(" {}", p.display())).unwrap_or_default())]
    Write {
        /// The file, where there is one.
        path: Option<PathBuf>,
        /// What the system said.
        source: io::Error,
    },
    /// More than a GLB can hold.
    #[error("cannot write{}: the model takes {bytes} bytes and a GLB holds 4294967295", .path.as_ref().map(|p| format!(" {}", p.display())).unwrap_or_default())]
    TooLarge {
        /// The file, where there is one.
        path: Option<PathBuf>,
        /// What it would take.
        bytes: u64,
    },
}

impl ExportError {
    fn at(mut self, to: &Path) -> Self {
        let (Self::Write { path, .. } | Self::TooLarge { path, .. }) = &mut self;
        path.get_or_insert_with(|| to.to_path_buf());
        self
    }
}

impl From<io::Error> for ExportError {
    fn from(source: io::Error) -> Self {
        Self::Write { path: None, source }
    }
}

impl From<csv::Error> for ExportError {
    fn from(error: csv::Error) -> Self {
        io::Error::from(error).into()
    }
}

impl From<serde_json::Error> for ExportError {
    fn from(error: serde_json::Error) -> Self {
        io::Error::from(error).into()
    }
}

/// Creates or replaces a file and has it written through a buffer.
pub(super) fn to_file(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), ExportError>,
) -> Result<(), ExportError> {
    let whole = || {
        let mut writer = BufWriter::new(File::create(path)?);
        write(&mut writer)?;
        Ok(writer.flush()?)
    };
    whole().map_err(|error: ExportError| error.at(path))
}
