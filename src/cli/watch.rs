//! `burgeon watch`: the window.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::Failure;
use super::input::Input;

/// The scenario watched when none is named.
#[cfg(feature = "viewer")]
const DEFAULT_SCENARIO: &str = "dusk";

/// Watch a scenario grow.
#[derive(Args, Debug)]
pub struct Watch {
    #[command(flatten)]
    input: Input,

    /// Steps a second; 0 grows as fast as can be.
    #[arg(long, default_value_t = 1.0)]
    pace: f32,

    /// Size of the window in logical pixels.
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1280x720", value_parser = size)]
    size: (u32, u32),

    /// Whether the panels at the sides are open.
    #[arg(long, value_enum, default_value_t = Side::Open)]
    panels: Side,

    /// Save a picture of the window to this PNG and close it; needs --exit-after.
    #[arg(long, value_name = "FILE", requires = "exit_after")]
    screenshot: Option<PathBuf>,

    /// Grow to this step and no further, draw it, and close the window.
    #[arg(long, value_name = "STEP")]
    exit_after: Option<u32>,

    /// Fail if no plant is to be seen in the picture, as the same scene without plants tells.
    #[arg(long, requires = "screenshot")]
    must_show_plants: bool,

    /// Replace a picture that is already there.
    #[arg(long)]
    force: bool,
}

#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Open,
    Closed,
}

impl Default for Watch {
    fn default() -> Self {
        Self {
            input: Input::default(),
            pace: 1.0,
            size: (1280, 720),
            panels: Side::Open,
            screenshot: None,
            exit_after: None,
            must_show_plants: false,
            force: false,
        }
    }
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    match sides {
        Some((width, height)) if (64..=16_384).contains(&width) && (64..=16_384).contains(&height) => {
            Ok((width, height))
        }
        _ => Err("WIDTHxHEIGHT, each 64 to 16384".into()),
    }
}

impl Watch {
    /// Runs the command.
    #[cfg(feature = "viewer")]
    pub fn run(self) -> Result<(), Failure> {
        use super::output::{can_write, free};
        use burgeon::viewer::{WatchSettings, watch};

        let plan = self.input.or(DEFAULT_SCENARIO).plan()?;
        free(self.screenshot.iter().cloned(), self.force)?;
        can_write(self.screenshot.iter())?;
        watch(WatchSettings {
            resolved: plan.resolved,
            seed: plan.seed,
            library: self.input.library()?,
            workers: self.input.common.workers()?,
            limits: self.input.common.limits(),
            pace: (self.pace > 0.0).then_some(self.pace),
            size: self.size,
            panels: self.panels == Side::Open,
            screenshot: self.screenshot,
            exit_after: self.exit_after,
            must_show_plants: self.must_show_plants,
        })?;
        Ok(())
    }

    /// Runs the command.
    #[cfg(not(feature = "viewer"))]
    pub fn run(self) -> Result<(), Failure> {
        eprintln!("burgeon: built without its window (feature `viewer`); growing as `burgeon grow` does");
        super::grow::Grow::plain(self.input).run()
    }
}
