//! The application.

pub mod leave;
pub mod numbers;
pub mod species_editor;
pub mod why;
