//! `burgeon watch`: the window.

use clap::Args;

use super::Failure;
use super::grow::Grow;
use super::input::Input;

/// Watch a scenario grow.
#[derive(Args, Debug, Default)]
pub struct Watch {
    #[command(flatten)]
    input: Input,
}

impl Watch {
    /// Runs the command.
    pub fn run(self) -> Result<(), Failure> {
        eprintln!("burgeon: this version has no window yet; growing without one, as `burgeon grow` does");
        Grow::plain(self.input).run()
    }
}
