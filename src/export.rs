//! What leaves a run: pictures, films, models and tables.

pub mod canvas;
mod error;
pub mod film;
pub mod gltf;
pub mod harvest;
pub mod mtg;
pub mod obj;
pub mod picture;
pub mod plot;
pub mod reel;
mod strip;
pub mod tables;

pub use error::ExportError;
