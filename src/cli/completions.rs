//! `burgeon completions`: scripts for shells.

use clap::{Args, CommandFactory};
use clap_complete::{Shell, generate};

use super::output::say;
use super::{Cli, Failure};

/// Print the completion script of a shell.
#[derive(Args, Debug)]
pub struct Completions {
    /// The shell.
    shell: Shell,
}

impl Completions {
    /// Runs the command.
    pub fn run(self) -> Result<(), Failure> {
        let mut script = Vec::new();
        generate(self.shell, &mut Cli::command(), "burgeon", &mut script);
        say(String::from_utf8_lossy(&script).trim_end());
        Ok(())
    }
}
