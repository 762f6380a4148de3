//! What leaves a run: pictures, films, models and tables.

mod error;
pub mod gltf;
pub mod tables;

pub use error::ExportError;
