//! `burgeon reproduce`: a figure of a paper, grown and measured.

use std::path::PathBuf;

use burgeon::environment::workers::Workers;
use burgeon::export::film::save_png;
use burgeon::export::picture::PictureSettings;
use burgeon::limits;
use burgeon::reproduce::{Claim, Figure, reproduce};
use clap::Args;

use super::Failure;
use super::input::library;
use super::output::{self, Output, say};
use super::seeds::SeedRange;

/// Grow a figure of a paper and measure what the paper says of it.
#[derive(Args, Debug)]
pub struct Reproduce {
    /// The figure: lam-king-1 or 2, or streit-3, 4, 7, 8, 9, 10, 11, 12, 13 or 14.
    figure: Figure,

    /// Seeds to grow it from.
    #[arg(long, value_name = "FIRST..LAST", default_value = "1..10")]
    seeds: SeedRange,

    /// Threads; 0 takes one for each core.
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=limits::THREADS as i64))]
    threads: u32,

    /// A folder whose species/NAME.ron and scenarios/NAME.ron win over those built in.
    #[arg(long, value_name = "DIR")]
    assets: Option<PathBuf>,

    #[command(flatten)]
    output: Output,

    /// Print the table as JSON.
    #[arg(long)]
    json: bool,
}

impl Reproduce {
    /// Runs the command.
    pub fn run(self) -> Result<(), Failure> {
        let workers = Workers::new(self.threads as usize)?;
        let mut folder = self.output.folder(self.figure.name(), &["figure.png", "claims.json"])?;
        let size = PictureSettings { width: 260, height: 346, samples: 4 };
        let library = library(&self.assets)?;
        let done = reproduce(self.figure, self.seeds.range(), &library, size, &workers)?;
        let more = done.tables.iter().map(|t| &t.0).chain(done.pictures.iter().map(|p| &p.0));
        output::free(more.map(|name| folder.path().join(name)), self.output.force)?;
        folder.create()?;
        save_png(&folder.file("figure.png"), &done.picture)?;
        for (name, picture) in &done.pictures {
            save_png(&folder.file(name), picture)?;
        }
        for (name, table) in &done.tables {
            folder.text(name, table)?;
        }
        let json = serde_json::to_string_pretty(&done.claims).unwrap_or_default();
        folder.text("claims.json", &json)?;
        let failed = done.claims.iter().filter(|claim| !claim.holds).count();
        let end = match failed {
            0 => Ok(()),
            failed => Err(Failure::Claims { failed, all: done.claims.len() }),
        };
        if self.json {
            say(json);
            return end;
        }
        say(format_args!("{} over seeds {} to {}", done.figure, done.seeds.start(), done.seeds.end()));
        for Claim { row, paper, measured, holds } in &done.claims {
            let holds = if *holds { "holds" } else { "DOES NOT HOLD" };
            say(format_args!("\n{row}  paper     {paper}\n       measured  {measured}\n       {holds}"));
        }
        say(format_args!("\n{}", folder.line()));
        end
    }
}
