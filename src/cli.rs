//! The commands, what they share, and the exit codes.

mod check;
mod compare;
mod completions;
mod describe;
mod gallery;
mod grow;
mod input;
mod output;
mod probe;
mod reproduce;
mod seeds;
mod stability;
mod vary;
mod watch;
mod why;

use std::process::ExitCode;

use burgeon::environment::workers::WorkersError;
use burgeon::export::ExportError;
use burgeon::export::film::FilmError;
use burgeon::files::{FileError, SaveError};
use burgeon::scenario::{EditError, GardenError};
#[cfg(feature = "viewer")]
use burgeon::viewer::WatchError;
use clap::{Parser, Subcommand};

/// Burgeon grows trees: every bud, internode and leaf looks at the light and space around it before it grows.
#[derive(Parser, Debug)]
#[command(
    version,
    propagate_version = true,
    after_help = "Exit codes: 0 done, 1 bad input or a file that could not be written, 2 wrong usage,\n\
                  3 stopped early by a limit or an edit that could not be made (what has grown is kept),\n\
                  4 a run grown again is not the same tree, 5 no display or graphics adapter for a window,\n\
                  6 the graphics device was lost (what has grown is saved), 7 a figure does not show what its paper says."
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand, Debug)]
enum Command {
    /// Open a window and watch a scenario grow (the default).
    Watch(watch::Watch),
    /// Grow a scenario, or a run again from its run.ron, and write pictures, a model and tables.
    Grow(Box<grow::Grow>),
    /// Grow species from seed and show them at three ages, in leaf and bare, on one sheet.
    Gallery(gallery::Gallery),
    /// Grow the same seed in several scenarios and show them side by side.
    Compare(compare::Compare),
    /// Grow a scenario and show what can be seen from a point in it: light, share and space, as JSON.
    Probe(Box<probe::ProbeAt>),
    /// Grow a scenario and tell in plain sentences why an organ is, or went, as it did.
    Why(Box<why::Why>),
    /// Check species, scenario, run and save files, one line each.
    Check(check::Check),
    /// Show the table of parameters, a species, or what stands where in a scenario.
    Describe(describe::Describe),
    /// Grow a figure of a paper and measure what the paper says of it.
    Reproduce(reproduce::Reproduce),
    /// Grow siblings of a finished plant, none like another.
    Vary(Box<vary::Vary>),
    /// Tell what lag and compensation ratio make of a disturbance.
    Stability(stability::StabilityMeter),
    /// Print the completion script of a shell.
    Completions(completions::Completions),
}

/// Why a command did not end well.
#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Save(#[from] SaveError),
    #[error(transparent)]
    Edit(#[from] EditError),
    #[error(transparent)]
    Reproduce(#[from] burgeon::reproduce::ReproduceError),
    #[error(transparent)]
    Workers(#[from] WorkersError),
    #[error(transparent)]
    Export(#[from] ExportError),
    #[error(transparent)]
    Film(#[from] FilmError),
    #[error(transparent)]
    Harvest(#[from] burgeon::export::harvest::HarvestError),
    #[error(transparent)]
    Vary(#[from] burgeon::tropism::vary::VaryError),
    #[error(transparent)]
    Skeleton(#[from] burgeon::plant::skeleton::SkeletonError),
    #[error(transparent)]
    Setting(#[from] burgeon::tropism::OutOfRange),
    #[error(transparent)]
    Timeline(#[from] burgeon::scenario::TimelineError),
    /// There is no organ of that number.
    #[error("no organ {birth} lives at step {step}, and none is known to have fallen; {organs} live there")]
    NoSuchOrgan { birth: u32, step: u32, organs: usize },
    #[cfg(feature = "viewer")]
    #[error(transparent)]
    Watch(#[from] burgeon::viewer::WatchError),
    #[error("{what}: {source}")]
    Io { what: String, source: std::io::Error },
    /// Files in the way.
    #[error("{} already there; --force replaces, another name keeps", .0.join(", "))]
    InTheWay(Vec<String>),
    /// Options that do not go together.
    #[error("{0}")]
    Usage(String),
    /// Files that did not pass a check; each has had its line.
    #[error("{bad} of {all} files are bad")]
    BadFiles { bad: usize, all: usize },
    /// Growth ended early.
    #[error("{0}; what has grown is kept")]
    Stopped(#[from] GardenError),
    /// An edit of the scenario could not be made.
    #[error("the edit at step {step} could not be made: {why}")]
    Lapsed { step: u32, why: String },
    /// A figure does not show what the paper says of it.
    #[error("{failed} of {all} claims do not hold")]
    Claims { failed: usize, all: usize },
    /// A run grown again differs.
    #[error("not the same tree: it first differs at step {0}")]
    NotTheSame(u32),
}

impl Failure {
    fn code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Stopped(_) | Self::Lapsed { .. } => 3,
            Self::NotTheSame(_) => 4,
            Self::Claims { .. } => 7,
            #[cfg(feature = "viewer")]
            Self::Watch(why) => match why {
                WatchError::NoDisplay | WatchError::NoAdapter => 5,
                WatchError::Lost(_) => 6,
                _ => 1,
            },
            _ => 1,
        }
    }
}

/// Parses the command line and runs what it asks for.
pub fn main() -> ExitCode {
    let result = match Cli::parse().command {
        None => watch::Watch::default().run(),
        Some(Command::Watch(command)) => command.run(),
        Some(Command::Grow(command)) => command.run(),
        Some(Command::Gallery(command)) => command.run(),
        Some(Command::Compare(command)) => command.run(),
        Some(Command::Probe(command)) => command.run(),
        Some(Command::Why(command)) => command.run(),
        Some(Command::Check(command)) => command.run(),
        Some(Command::Describe(command)) => command.run(),
        Some(Command::Reproduce(command)) => command.run(),
        Some(Command::Vary(command)) => command.run(),
        Some(Command::Stability(command)) => command.run(),
        Some(Command::Completions(command)) => command.run(),
    };
    match result {
        Ok(()) => match output::unsaid() {
            Some(why) => {
                eprintln!("burgeon: could not write to standard output: {why}");
                ExitCode::from(1)
            }
            None => ExitCode::SUCCESS,
        },
        Err(failure) => {
            eprintln!("burgeon: {failure}");
            ExitCode::from(failure.code())
        }
    }
}
