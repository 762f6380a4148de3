//! `burgeon compare`: the same seed in two or more scenarios, side by side.

use burgeon::environment::workers::Workers;
use burgeon::export::canvas::{side_by_side, titled};
use burgeon::export::film::{FilmSettings, save_gif, save_png};
use burgeon::export::picture::{Bounds, Palette, PictureSettings};
use burgeon::export::reel::{FILM, Reel, camera};
use burgeon::files::{RunFile, StepHashes};
use burgeon::plant::measure::Form;
use burgeon::scenario::Garden;
use clap::Args;

use super::Failure;
use super::grow::Growing;
use super::input::Input;
use super::output::{Output, progress, say};

/// Most scenarios in one row.
const MOST: usize = 4;

/// Grow the same seed in two to four scenarios and show them side by side.
#[derive(Args, Debug)]
pub struct Compare {
    /// The scenarios, as for `grow`.
    #[arg(required = true, num_args = 2..=MOST)]
    scenarios: Vec<String>,

    #[command(flatten)]
    common: super::input::Common,

    #[command(flatten)]
    output: Output,

    /// Also write compare.gif, a frame a step.
    #[arg(long)]
    timelapse: bool,
}

impl Compare {
    /// Runs the command.
    pub fn run(&self) -> Result<(), Failure> {
        let plans: Vec<_> = self
            .scenarios
            .iter()
            .map(|name| Input::of(name, &self.common).plan())
            .collect::<Result<_, _>>()?;
        // As many steps for all, or nothing could be compared.
        let steps = plans.iter().map(|plan| plan.steps).min().unwrap_or(0);
        let names = if self.timelapse { &["compare.png", "compare.gif"][..] } else { &["compare.png"] };
        let mut folder = self.output.folder("compare", names)?;
        let workers = self.common.workers()?;

        folder.create()?;

        let mut stopped = None;
        let mut rows = Vec::new();
        let mut trees = Vec::new();
        for plan in plans {
            let run = RunFile::new(&plan.resolved, plan.seed, 0, StepHashes::default());
            let mut garden = Garden::new(plan.resolved, plan.seed, self.common.workers()?)?;
            garden.set_limits(self.common.limits());
            let mut growing = Growing { garden, run, stopped: None, seconds: 0.0 };
            let mut reel = Reel::default();
            growing.grow(steps, |step, garden| {
                if self.timelapse && reel.wants(step) {
                    reel.add(step, garden.scene());
                }
            });
            reel.end(growing.garden.steps(), growing.garden.scene());
            stopped = stopped.or(growing.stopped);
            let snapshot = growing.garden.snapshot();
            let form = Form::of(&snapshot, None);
            let name = growing.run.scenario.name;
            rows.push(format!(
                "{name:16} {:6.2} m high, crown {:.2} m wide, {} leaves",
                form.height_m, form.crown_width_m, form.leaves
            ));
            trees.push((name, reel, Palette::of_snapshot(&snapshot)));
        }

        let large = PictureSettings { width: 480, height: 540, samples: 4 };
        let stills = draw(&trees, large, true, &workers);
        save_png(&folder.file("compare.png"), &side_by_side(&stills.concat(), 4))?;
        if self.timelapse {
            let films = draw(&trees, FILM, false, &workers);
            let frames = films.iter().map(Vec::len).min().unwrap_or(0);
            let images: Vec<_> = (0..frames)
                .map(|i| {
                    let row: Vec<_> = films.iter().map(|film| film[i].clone()).collect();
                    side_by_side(&row, 4)
                })
                .collect();
            save_gif(&folder.file("compare.gif"), &images, FilmSettings::default())?;
        }
        for row in rows {
            say(row);
        }
        say(folder.line());
        stopped.map_or(Ok(()), |stopped| Err(stopped.into()))
    }
}

/// The frames of every film, or the last of each, all from one stand so that sizes can be compared.
fn draw(
    trees: &[(String, Reel, Palette)],
    settings: PictureSettings,
    last_only: bool,
    workers: &Workers,
) -> Vec<Vec<image::RgbImage>> {
    let bounds = trees.iter().fold(Bounds::default(), |all, (_, reel, _)| all.union(&reel.bounds()));
    // The scenario with the most solids says where to look from.
    let fullest = trees.iter().filter_map(|(_, reel, _)| reel.last()).max_by_key(|scene| scene.solids.len());
    let Some(fullest) = fullest else { return Vec::new() };
    let camera = camera(fullest, &bounds, settings.aspect());
    trees
        .iter()
        .map(|(name, reel, palette)| {
            let bar = progress(if last_only { 1 } else { reel.len() as u64 }, "frame");
            let images = reel.draw(last_only, &camera, palette, settings, workers, || bar.inc(1));
            bar.finish_and_clear();
            images.iter().map(|image| titled(image, name, 1)).collect()
        })
        .collect()
}
