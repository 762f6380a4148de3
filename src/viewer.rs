//! The application.

mod act;
pub mod leave;
pub mod numbers;
pub mod species_editor;
mod state;
pub mod why;

pub use act::Action;
pub use state::{Chosen, Course, Kind, Past, Shown, Toasts, Tool, ViewFrom};
