//! What a command grows: scenario, seed, settings, threads.

use std::path::PathBuf;
use std::str::FromStr;

use burgeon::assets::{Library, Opened};
use burgeon::environment::workers::Workers;
use burgeon::files::{ResolvedScenario, RunFile};
use burgeon::limits::{self, GrowthLimits};
use clap::Args;

use super::Failure;

/// The scenario grown when none is named.
const DEFAULT_SCENARIO: &str = "wall";
/// The seed of a run when none is given.
const DEFAULT_SEED: u64 = 1;

/// What to grow.
#[derive(Args, Debug, Clone, Default)]
pub struct Input {
    /// A scenario by name, a scenario file, or the run.ron of an earlier run [default: wall].
    scenario: Option<String>,

    /// Grow one plant of this species alone in an open field instead.
    #[arg(long, value_name = "NAME", conflicts_with = "scenario")]
    species: Option<String>,

    /// Years to grow it.
    #[arg(long, value_name = "YEARS", requires = "species", conflicts_with = "steps")]
    age: Option<u32>,

    #[command(flatten)]
    pub common: Common,
}

/// How it is grown, whatever it is.
#[derive(Args, Debug, Clone, Default)]
pub struct Common {
    /// Steps to grow; of a resumed run, all of them together [default: the scenario's].
    #[arg(long, value_parser = clap::value_parser!(u32).range(0..=i64::from(limits::STEPS)))]
    pub steps: Option<u32>,

    /// Seed of every random draw [default: 1, or the run's].
    #[arg(long)]
    pub seed: Option<u64>,

    /// Threads; 0 takes one for each core. The tree does not depend on it.
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=limits::THREADS as i64))]
    threads: u32,

    /// Change a setting: species.X, species.NAME.X, scenario.X or lamp.NAME.X; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub set: Vec<String>,

    /// Stop when this much is reached and keep what has grown: organs=N, probes=N, steps=N or memory=BYTES.
    #[arg(long = "limit", value_name = "WHAT=N")]
    limits: Vec<Limit>,

    /// A folder whose species/NAME.ron and scenarios/NAME.ron win over those built in.
    #[arg(long, value_name = "DIR")]
    pub assets: Option<PathBuf>,
}

/// A limit set on the command line.
#[derive(Debug, Clone, Copy)]
struct Limit(fn(&mut GrowthLimits) -> &mut usize, usize);

impl FromStr for Limit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "organs=N, probes=N, steps=N or memory=BYTES, N a whole number".to_string();
        let (what, most) = text.split_once('=').ok_or_else(wrong)?;
        let most = most.parse().map_err(|_| wrong())?;
        let field: fn(&mut GrowthLimits) -> &mut usize = match what {
            "organs" => |limits| &mut limits.organs,
            "probes" => |limits| &mut limits.probes,
            "steps" => |limits| &mut limits.steps,
            "memory" => |limits| &mut limits.memory,
            _ => return Err(wrong()),
        };
        Ok(Self(field, most))
    }
}

/// What will be grown.
pub struct Plan {
    /// The scenario and its species, settings made.
    pub resolved: ResolvedScenario,
    /// Steps to grow.
    pub steps: u32,
    /// Seed of the run.
    pub seed: u64,
    /// The run to grow again, if it is one and nothing was changed.
    pub again: Option<Box<RunFile>>,
}

impl Input {
    /// A scenario grown like others.
    pub fn of(scenario: &str, common: &Common) -> Self {
        Self { scenario: Some(scenario.into()), common: common.clone(), ..Self::default() }
    }

    /// A scenario grown like others, or a species alone in the open if there is no scenario of that name.
    pub fn of_either(name: &str, library: &Library, common: &Common) -> Self {
        let is = |names: Vec<String>| names.iter().any(|there| there == name);
        if is(library.species_names()) && !is(library.scenario_names()) {
            return Self { species: Some(name.into()), common: common.clone(), ..Self::default() };
        }
        Self::of(name, common)
    }

    /// Another scenario than the usual, where none is named.
    #[cfg(feature = "viewer")]
    pub fn or(&self, scenario: &str) -> Self {
        Self {
            scenario: self.scenario.clone().or_else(|| self.species.is_none().then(|| scenario.into())),
            ..self.clone()
        }
    }

    /// Species and scenarios to choose from.
    #[cfg(feature = "viewer")]
    pub fn library(&self) -> Result<Library, Failure> {
        library(&self.common.assets)
    }

    /// Reads and checks everything; writes nothing.
    pub fn plan(&self) -> Result<Plan, Failure> {
        let library = library(&self.common.assets)?;
        let opened = match &self.species {
            Some(name) => {
                let (mut resolved, year) = super::gallery::alone(&library, name)?;
                let years = self.age.unwrap_or(resolved.scenario.steps);
                resolved.scenario.steps = years.saturating_mul(year).min(limits::STEPS);
                Opened::Scenario(Box::new(resolved))
            }
            None => library.open(self.scenario.as_deref().unwrap_or(DEFAULT_SCENARIO))?,
        };
        let (mut resolved, steps, seed, run) = match opened {
            Opened::Scenario(resolved) => {
                let steps = resolved.scenario.steps;
                (*resolved, steps, DEFAULT_SEED, None)
            }
            Opened::Run(run) => (run.resolved(), run.steps, run.seed, Some(run)),
        };
        for setting in &self.common.set {
            resolved.apply_set(setting)?;
        }
        // `--set scenario.steps` counts as the scenario's own.
        let steps = if run.is_none() { resolved.scenario.steps } else { steps };
        let Common { set, steps: steps_set, seed: seed_set, .. } = &self.common;
        let changed = !set.is_empty() || seed_set.is_some_and(|s| s != seed);
        Ok(Plan {
            resolved,
            steps: steps_set.unwrap_or(steps),
            seed: seed_set.unwrap_or(seed),
            again: run.filter(|_| !changed),
        })
    }
}

impl Common {
    /// What a garden may take.
    pub fn limits(&self) -> GrowthLimits {
        let mut limits = GrowthLimits::default();
        for Limit(field, most) in &self.limits {
            *field(&mut limits) = *most;
        }
        limits
    }

    /// An option that was given and says how a plant grows.
    pub fn grows_otherwise(&self) -> Option<&'static str> {
        let given = [
            ("--steps", self.steps.is_some()),
            ("--set", !self.set.is_empty()),
            ("--limit", !self.limits.is_empty()),
        ];
        given.into_iter().find(|(_, given)| *given).map(|(option, _)| option)
    }

    /// The threads asked for.
    pub fn workers(&self) -> Result<Workers, Failure> {
        Ok(Workers::new(self.threads as usize)?)
    }
}

/// What is built in, behind a folder if one is given.
pub fn library(folder: &Option<PathBuf>) -> Result<Library, Failure> {
    match folder {
        Some(folder) => Ok(Library::with_folder(folder)?),
        None => Ok(Library::embedded()),
    }
}
