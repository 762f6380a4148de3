//! What leaves a run: pictures, films, models and tables.

pub mod canvas;
pub mod film;
pub mod picture;
