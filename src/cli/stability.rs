//! `burgeon stability`: what lag and gain make of a disturbance.

use burgeon::tropism::stability::{Verdict, stability};
use burgeon::tropism::{Control, LONGEST_LAG};
use clap::Args;

use super::Failure;
use super::output::say;

/// Tell whether a shoot of some lag and compensation ratio steadies or swings ever wider.
#[derive(Args, Debug)]
pub struct StabilityMeter {
    /// Sub-steps until a correction takes effect.
    #[arg(long, value_parser = clap::value_parser!(u32).range(0..=i64::from(LONGEST_LAG)))]
    lag: u32,

    /// Compensation ratio, 1 / (gain x lag).
    #[arg(long, required_unless_present = "gain", conflicts_with = "gain")]
    ratio: Option<f32>,

    /// Gain: the share of the sensed error corrected at each sub-step.
    #[arg(long)]
    gain: Option<f32>,

    /// Print it as JSON.
    #[arg(long)]
    json: bool,
}

impl StabilityMeter {
    /// Runs the command.
    pub fn run(&self) -> Result<(), Failure> {
        let control = match (self.ratio, self.gain) {
            (Some(ratio), _) => Control::of_ratio(ratio, self.lag)?,
            (None, gain) => Control::new(gain.unwrap_or(1.0), self.lag)?,
        };
        let read = stability(&control)?;
        if self.json {
            // Numbers and a name always serialise.
            say(serde_json::to_string_pretty(&read).unwrap_or_default());
            return Ok(());
        }
        say(format_args!(
            "lag {}, gain {:.4}: compensation ratio {:.3}, critical ratio {:.4}",
            read.lag, read.gain, read.ratio, read.critical_ratio
        ));
        say(match read.verdict {
            Verdict::Fades => "stable: an error fades without swinging",
            Verdict::Converges => "stable: an error swings and fades",
            Verdict::Swings if read.stable => "stable, at the edge: an error swings and hardly fades",
            Verdict::Swings => "unstable, at the edge: an error swings hardly wider each time",
            Verdict::Diverges => "unstable: an error swings ever wider",
        });
        let period = read.period.map_or("none".into(), |period| format!("{period:.1} sub-steps"));
        say(format_args!(
            "period {period}, damping ratio {:.3}, factor a sub-step {:.4}",
            read.damping, read.factor
        ));
        Ok(())
    }
}
