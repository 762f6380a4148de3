//! `burgeon grow --seeds`: many trees into one table.

use std::str::FromStr;

use burgeon::environment::workers::Workers;
use burgeon::plant::measure::Form;
use burgeon::scenario::{Garden, GardenError};
use serde::Serialize;

use super::Failure;
use super::input::Input;
use super::output::{Output, progress, say};

/// Seeds from one to another, both included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeedRange {
    first: u64,
    last: u64,
}

impl SeedRange {
    /// The most seeds of one table.
    const MOST: u64 = 100_000;

    /// As a range.
    pub fn range(self) -> core::ops::RangeInclusive<u64> {
        self.first..=self.last
    }
}

impl FromStr for SeedRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (first, last) = text.split_once("..").unwrap_or((text, text));
        let number = |t: &str| {
            t.trim().parse::<u64>().map_err(|_| "write it as FIRST..LAST, such as 1..100".to_string())
        };
        let (first, last) = (number(first)?, number(last.trim_start_matches('='))?);
        if last < first || last - first >= Self::MOST {
            return Err(format!("from first to last, at most {} seeds", Self::MOST));
        }
        Ok(Self { first, last })
    }
}

/// A tree of the table.
struct Tree {
    seed: u64,
    steps: u32,
    form: Form,
    hash: u64,
    stopped: Option<GardenError>,
}

/// Columns that have a mean and a spread, and how to read them.
const COLUMNS: [(&str, fn(&Form) -> f64); 20] = [
    ("height_m", |f| f64::from(f.height_m)),
    ("crown_width_m", |f| f64::from(f.crown_width_m)),
    ("crown_base_m", |f| f64::from(f.crown_base_m)),
    ("trunk_diameter_m", |f| f64::from(f.trunk_diameter_m)),
    ("breast_diameter_m", |f| f64::from(f.breast_diameter_m)),
    ("live_crown_base_m", |f| f64::from(f.live_crown_base_m)),
    ("widest_height_m", |f| f64::from(f.widest_height_m)),
    ("drooping_share", |f| f64::from(f.drooping_share)),
    ("leaves", |f| f64::from(f.leaves)),
    ("internodes", |f| f64::from(f.internodes)),
    ("organs", |f| f64::from(f.organs)),
    ("order_0", |f| f64::from(f.by_order[0])),
    ("order_1", |f| f64::from(f.by_order[1])),
    ("order_2", |f| f64::from(f.by_order[2])),
    ("order_3", |f| f64::from(f.by_order[3])),
    ("order_4_and_above", |f| f64::from(f.by_order[4])),
    ("strahler_order", |f| f64::from(f.strahler_order)),
    ("bifurcation_ratio", |f| f64::from(f.bifurcation_ratio)),
    ("leaf_area_m2", |f| f.leaf_area_m2),
    ("mean_light", |f| f.mean_light),
];

#[derive(Serialize)]
struct Statistic {
    name: &'static str,
    mean: f64,
    sd: f64,
}

#[derive(Serialize)]
struct Summary<'a> {
    scenario: &'a str,
    trees: usize,
    steps: u32,
    stopped: usize,
    statistics: &'a [Statistic],
    files: Vec<String>,
}

/// Grows a tree for each seed, one on each thread, and writes the table.
pub fn run(input: &Input, output: &Output, seeds: SeedRange, json: bool) -> Result<(), Failure> {
    let plan = input.plan()?;
    let mut folder = output.folder(&format!("{}_seeds", plan.resolved.scenario.name), &["seeds.csv"])?;
    folder.create()?;
    let count = (seeds.last - seeds.first + 1) as usize;
    let bar = progress(count as u64, "tree");
    let trees = input.common.workers()?.map(count, |i| {
        let seed = seeds.first + i as u64;
        let mut garden = Garden::new(plan.resolved.clone(), seed, Workers::new(1)?)?;
        garden.set_limits(input.common.limits());
        let mut stopped = None;
        while garden.steps() < plan.steps && stopped.is_none() {
            stopped = garden.step().err();
        }
        bar.inc(1);
        Ok(Tree {
            seed,
            steps: garden.steps(),
            form: garden.records().last().map(|r| r.form).unwrap_or_default(),
            hash: garden.snapshot().hash(),
            stopped,
        })
    });
    bar.finish_and_clear();
    let trees: Vec<Tree> = trees.into_iter().collect::<Result<_, Failure>>()?;

    // Trees of different ages have no mean: those that stopped early are in the table only.
    let stopped = trees.iter().filter(|t| t.stopped.is_some()).count();
    let statistics = COLUMNS.map(|(name, read)| {
        let grown = trees.iter().filter(|t| t.stopped.is_none() || stopped == count);
        let (mean, sd) = mean_and_sd(grown.map(|t| read(&t.form)));
        Statistic { name, mean, sd }
    });
    folder.text("seeds.csv", &table(&trees, &statistics))?;

    let name = &plan.resolved.scenario.name;
    if json {
        let files = folder.written.iter().map(|p| p.display().to_string()).collect();
        let summary = Summary {
            scenario: name,
            trees: count,
            steps: plan.steps,
            stopped,
            statistics: &statistics,
            files,
        };
        // A summary of numbers and texts always serialises.
        say(serde_json::to_string_pretty(&summary).unwrap_or_default());
    } else {
        let grown = if stopped < count { count - stopped } else { count };
        let steps = if stopped < count { plan.steps.to_string() } else { "fewer than all".into() };
        say(format_args!("{name}, {grown} trees of {steps} steps, mean and standard deviation:"));
        for Statistic { name, mean, sd } in &statistics {
            say(format_args!("  {name:17} {mean:10.3} ± {sd:.3}"));
        }
        say(folder.line());
    }
    for tree in &trees {
        if let Some(reason) = &tree.stopped {
            eprintln!("burgeon: seed {}: {reason}", tree.seed);
        }
    }
    trees.into_iter().find_map(|tree| tree.stopped).map_or(Ok(()), |stopped| Err(stopped.into()))
}

fn table(trees: &[Tree], statistics: &[Statistic]) -> String {
    let mut text = String::from("seed,steps");
    for (name, _) in COLUMNS {
        text.push_str(&format!(",{name}"));
    }
    text.push_str(",hash\n");
    for tree in trees {
        text.push_str(&format!("{},{}", tree.seed, tree.steps));
        for (_, read) in COLUMNS {
            text.push_str(&format!(",{}", read(&tree.form)));
        }
        text.push_str(&format!(",{:016x}\n", tree.hash));
    }
    for (name, read) in [("mean", (|s| s.mean) as fn(&Statistic) -> f64), ("sd", |s| s.sd)] {
        text.push_str(&format!("{name},"));
        for statistic in statistics {
            text.push_str(&format!(",{}", read(statistic)));
        }
        text.push_str(",\n");
    }
    text
}

/// Mean and standard deviation of a sample (over n - 1); the deviation of one value is 0.
fn mean_and_sd(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let n = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / n;
    let squares = values.map(|x| (x - mean) * (x - mean)).sum::<f64>();
    (mean, (squares / (n - 1.0).max(1.0)).sqrt())
}
