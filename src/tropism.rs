//! How shoots steer: a shoot does not jump to its target. It senses it with error, answers late and overshoots.
//!
//! ```text
//!  set point ──▶ sensor ──▶ transfer function ──▶ signals on their way ──▶ response ──▶ heading
//!               (error)     (P, and I, D)         (lag)                    (+ disturbance) │
//!                  ▲                                                                       │
//!                  └───────────────────────────────────────────────────────────────────────┘
//! ```
//!
//! That is the control system of L. Streit, P. Federl and M. C. Sousa, *Modelling Plant Variation Through Growth*
//! (rows `ST-5` to `ST-13`). [`step`] is one sub-step of it. Growth calls it for every new stem segment with the
//! target that light and space chose; [`vary`](vary::vary) grows a finished
//! skeleton again through it.

mod controller;
mod out_of_range;
pub mod relel;
pub mod root;
mod set_point;
mod signals;
pub mod stability;
pub mod vary;

pub use controller::{Control, Influence, Spread, Steering, lean, step, turned_to, wavers};
pub use out_of_range::OutOfRange;
pub use set_point::Tropisms;
pub use signals::{LONGEST_LAG, Signals};
