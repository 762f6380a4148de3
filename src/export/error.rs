//! What can go wrong when something is written.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use crate::files::replace_file;

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
    /// More than viewers can hold at once.
    #[error("cannot write{}: its frames have {triangles} triangles together, {most} at most; allow each frame fewer", .path.as_ref().map(|p| format!(" {}", p.display())).unwrap_or_default())]
    TooDetailed {
        /// The file, where there is one.
        path: Option<PathBuf>,
        /// What they have.
        triangles: usize,
        /// What they may have.
        most: usize,
    },
}

impl ExportError {
    fn at(mut self, to: &Path) -> Self {
        let (Self::Write { path, .. } | Self::TooLarge { path, .. } | Self::TooDetailed { path, .. }) =
            &mut self;
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

/// Has a whole file written, or leaves what was there.
pub(super) fn to_file(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), ExportError>,
) -> Result<(), ExportError> {
    replace_file(path, write).map_err(|error: ExportError| error.at(path))
}
