//! The window (feature `viewer`): a garden grows, people watch it, put walls and lamps in its way and prune it.
//!
//! ```text
//!   keys, panels, pointer ──▶ Action ──▶ act ──▶ Order ──▶ Gardener (its own thread: grows, keeps the past)
//!                                                             │
//!   picture, panels ◀── Shown, Course ◀── follow ◀── News ◀───┘
//! ```
//!
//! Whatever a user can do is an [`Action`], so that a key, a button and a test go the same way. [`ViewerLogic`] is
//! all of it without a window; [`watch`] opens one.

mod act;
mod camera;
mod files;
mod follow;
mod framing;
pub mod ground;
mod keys;
pub mod leave;
pub mod numbers;
mod open;
mod panels;
mod pick;
mod picture;
mod pointer;
mod scene;
mod sessions;
mod size;
pub mod species_editor;
mod state;
mod style;
pub mod why;

use bevy::prelude::*;

pub use act::Action;
pub use files::{Ask, Files};
pub use open::{Grown, ViewerWindow, WatchError, WatchSettings, watch};
pub use pick::{pick_organ, pick_solid};
pub use sessions::Recent;
pub use size::InterfaceSize;
pub use state::{Chosen, Course, Kind, Past, Shown, Snapping, Toasts, Tool, ViewFrom};

/// Everything but the window: takes [`Action`]s, orders the [`Gardener`](crate::scenario::Gardener) and follows
/// its news. The host inserts the gardener.
pub struct ViewerLogic;

impl Plugin for ViewerLogic {
    fn build(&self, app: &mut App) {
        app.add_message::<Action>()
            .init_resource::<Shown>()
            .init_resource::<Course>()
            .init_resource::<Past>()
            .init_resource::<Chosen>()
            .init_resource::<Tool>()
            .init_resource::<Snapping>()
            .init_resource::<Toasts>()
            .init_resource::<act::Names>()
            .init_resource::<state::Doomed>()
            .init_resource::<Recent>()
            .add_systems(Update, (act::act, sessions::follow, follow::follow).chain());
    }
}
