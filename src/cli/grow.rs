//! `burgeon grow`: a scenario, or a run again, with all it leaves.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use burgeon::export::gltf::{GlbSettings, GrowthFilm, Level, save_glb};
use burgeon::export::harvest::{self, Harvest, export_with};
use burgeon::export::mtg::save_mtg;
use burgeon::export::obj::save_obj;
use burgeon::export::picture::{Palette, PictureSettings};
use burgeon::export::reel::Reel;
use burgeon::files::{Likeness, RunFile, SaveError, StepHashes};
use burgeon::scenario::{Garden, GardenError, SavedRun};
use clap::Args;
use serde::Serialize;

use super::input::Input;
use super::output::{Output, grouped, progress, say};
use super::seeds::{self, SeedRange};
use super::{Failure, output};

/// Levels of detail beside tree.glb.
const LEVELS: [&str; 2] = ["tree_1.glb", "tree_2.glb"];

/// Grow a scenario and write what has grown.
#[derive(Args, Debug, Default)]
pub struct Grow {
    #[command(flatten)]
    input: Input,

    #[command(flatten)]
    output: Output,

    /// Also write growth.gif, a frame a step.
    #[arg(long)]
    timelapse: bool,

    /// Also draw a picture of every step, step_0000.png and so on, into a new folder; of long runs or large gardens
    /// only every second, fourth and so on.
    #[arg(long, value_name = "DIR")]
    frames: Option<PathBuf>,

    /// Write three levels of detail of the model: tree.glb with at most N triangles, tree_1.glb with a quarter of them,
    /// tree_2.glb with a sixteenth.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1000..=100_000_000))]
    triangles: Option<u32>,

    /// Also write growth.glb: the tree as it grew, as one animation that any glTF viewer plays. All frames share half a
    /// million triangles; with --triangles each has up to N, and all together up to four million.
    #[arg(long)]
    animate: bool,

    /// Put the weights for wind into the first vertex colours of the model (COLOR_0: phase, sway, flutter), where game
    /// engines look for them. Otherwise they are the second, since viewers tint the tree with the first.
    #[arg(long)]
    wind: bool,

    /// Also write tree.obj and tree.mtl.
    #[arg(long)]
    obj: bool,

    /// Also write tree.mtg, OpenAlea's Multiscale Tree Graph.
    #[arg(long)]
    mtg: bool,

    /// Print the summary as JSON.
    #[arg(long)]
    json: bool,

    /// Save the garden at the end, to be resumed.
    #[arg(long, value_name = "FILE")]
    save: Option<PathBuf>,

    /// Go on from a save instead of a scenario.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scenario", "seed", "set", "seeds"])]
    resume: Option<PathBuf>,

    /// Grow one tree for each seed, such as 1..100, into one table seeds.csv with mean and spread.
    #[arg(long, value_name = "FIRST..LAST", conflicts_with_all = [
        "seed", "timelapse", "frames", "animate", "triangles", "wind", "save", "obj", "mtg",
    ])]
    seeds: Option<SeedRange>,
}

#[derive(Serialize)]
struct Summary<'a> {
    scenario: &'a str,
    seed: u64,
    steps: u32,
    steps_wanted: u32,
    stopped: Option<String>,
    height_m: f32,
    crown_width_m: f32,
    trunk_diameter_m: f32,
    breast_diameter_m: f32,
    live_crown_base_m: f32,
    widest_height_m: f32,
    drooping_share: f32,
    by_order: [u32; 5],
    strahler_order: u32,
    bifurcation_ratio: f32,
    organs: u32,
    internodes: u32,
    leaves: u32,
    apical_buds: u32,
    lateral_buds: u32,
    leaf_area_m2: f64,
    mean_light: f64,
    energy_stored: f64,
    seconds: f64,
    threads: usize,
    hash: String,
    /// Of a run grown again: whether it is the same tree, as far as both have grown.
    same_tree: Option<bool>,
    first_difference: Option<u32>,
    files: Vec<String>,
}

/// A garden on its way.
pub struct Growing {
    /// The garden.
    pub garden: Garden,
    /// Its run so far.
    pub run: RunFile,
    /// Why it stopped early, if it did.
    pub stopped: Option<GardenError>,
    /// Time spent growing.
    pub seconds: f64,
}

impl Growing {
    /// Grows to a number of steps; `each` sees the garden before the first step and after every one.
    pub fn grow(&mut self, steps: u32, mut each: impl FnMut(u32, &mut Garden)) {
        let bar = progress(u64::from(steps), "step");
        bar.set_position(u64::from(self.garden.steps()));
        bar.reset_eta();
        each(self.garden.steps(), &mut self.garden);
        while self.garden.steps() < steps {
            let began = Instant::now();
            if let Err(error) = self.garden.step() {
                self.stopped = Some(error);
                break;
            }
            let step = self.garden.steps();
            self.run.hashes.push(step, self.garden.snapshot().hash());
            self.run.steps = step;
            self.seconds += began.elapsed().as_secs_f64();
            each(step, &mut self.garden);
            bar.set_message(format!("{} organs", grouped(self.garden.organs() as u32)));
            bar.set_position(u64::from(step));
        }
        bar.finish_and_clear();
    }
}

impl Grow {
    /// Grows a scenario as `burgeon grow` without options does.
    #[cfg(not(feature = "viewer"))]
    pub fn plain(input: Input) -> Self {
        Self { input, ..Self::default() }
    }

    /// Runs the command.
    pub fn run(&self) -> Result<(), Failure> {
        match &self.seeds {
            Some(seeds) => seeds::run(&self.input, &self.output, *seeds, self.json),
            None => self.grow(),
        }
    }

    fn grow(&self) -> Result<(), Failure> {
        let (mut growing, steps, again) = self.begin()?;
        growing.garden.set_limits(self.input.common.limits());
        let mut names = harvest::FILES.to_vec();
        if self.timelapse {
            names.push("growth.gif");
        }
        if self.animate {
            names.push("growth.glb");
        }
        if self.triangles.is_some() {
            names.extend(LEVELS);
        }
        if self.obj {
            names.extend(["tree.obj", "tree.mtl"]);
        }
        if self.mtg {
            names.push("tree.mtg");
        }
        let scenario = growing.run.scenario.name.clone();
        let mut folder = self.output.folder(&scenario, &names)?;
        output::free(self.save.iter().cloned(), self.output.force)?;
        if let Some(save) = self.save.as_deref().filter(|save| folder.holds(save, &names)) {
            return Err(Failure::Usage(format!(
                "{} is one of the run's own files; choose another --save",
                save.display()
            )));
        }
        if let Some(frames) = &self.frames {
            let under_save =
                self.save.as_ref().is_some_and(|save| output::whole(frames).starts_with(output::whole(save)));
            if folder.holds(frames, &names) || under_save {
                return Err(Failure::Usage(format!(
                    "{} is taken by the run's own files; choose another --frames",
                    frames.display()
                )));
            }
            output::free_folder(frames, self.output.force)?;
        }
        let (inside, outside): (Vec<_>, Vec<_>) =
            self.save.iter().partition(|save| save.parent() == Some(folder.path()));
        output::can_write(outside.into_iter())?;
        folder.create()?;
        output::can_write(inside.into_iter())?;
        if let Some(frames) = &self.frames {
            output::create_folder(frames)?;
        }

        let filmed = self.timelapse || self.frames.is_some();
        let (mut reel, mut film) = (Reel::default(), GrowthFilm::default());
        growing.grow(steps, |step, garden| {
            if filmed && reel.wants(step) {
                reel.add(step, garden.scene());
            }
            if self.animate && film.wants(step) {
                film.add(garden.snapshot());
            }
        });

        let harvest = Harvest {
            snapshot: Arc::new(growing.garden.snapshot()),
            scene: growing.garden.scene(),
            records: growing.garden.records().to_vec(),
            run: growing.run.clone(),
        };
        let workers = self.input.common.workers()?;
        let mut pictures = Vec::new();
        let levels = self.triangles.map(|triangles| Level::three(triangles as usize));
        let settings = GlbSettings { wind_first: self.wind, level: levels.map(|levels| levels[0]) };
        folder.written.extend(export_with(&harvest, folder.path(), &workers, settings)?);
        for (level, name) in levels.iter().flat_map(|levels| levels[1..].iter().zip(LEVELS)) {
            let settings = GlbSettings { level: Some(*level), ..settings };
            save_glb(&harvest.snapshot, settings, &folder.file(name))?;
        }
        if self.obj {
            save_obj(&harvest.snapshot, &folder.file("tree.obj"))?;
            folder.file("tree.mtl");
        }
        if self.mtg {
            save_mtg(&harvest.snapshot, &folder.file("tree.mtg"))?;
        }
        if filmed {
            let palette = Palette::of_snapshot(&harvest.snapshot);
            reel.end(growing.garden.steps(), harvest.scene);
            let ways = u64::from(self.timelapse) + u64::from(self.frames.is_some());
            let bar = progress(ways * reel.len() as u64, "frame");
            if self.timelapse {
                reel.save(&palette, &workers, &folder.file("growth.gif"), || bar.inc(1))?;
            }
            if let Some(to) = &self.frames {
                let settings = PictureSettings::default();
                pictures = reel.save_pictures(&palette, settings, &workers, to, || bar.inc(1))?;
            }
            bar.finish_and_clear();
        }
        if let Some(path) = &self.save {
            SavedRun::new(growing.run.clone(), growing.garden.save()).write(path)?;
        }
        // Last, for it may be too detailed.
        if self.animate {
            film.end(growing.garden.snapshot());
            film.save(self.triangles.map(|n| n as usize), &workers, &folder.file("growth.glb"))?;
        }

        let likeness = again.as_ref().map(|hashes| hashes.compare(&growing.run.hashes));
        self.tell(&growing, steps, likeness, &workers, &folder, &pictures);
        match (growing.stopped, likeness) {
            (_, Some(Likeness::Differs { at })) => Err(Failure::NotTheSame(at)),
            (Some(stopped), _) => Err(stopped.into()),
            (None, _) => Ok(()),
        }
    }

    /// The garden as it begins, the steps it shall have, and the hashes it shall meet.
    fn begin(&self) -> Result<(Growing, u32, Option<StepHashes>), Failure> {
        let workers = self.input.common.workers()?;
        let new = |garden, run| Growing { garden, run, stopped: None, seconds: 0.0 };
        if let Some(path) = &self.resume {
            let SavedRun { run, garden, .. } = SavedRun::read(path)?;
            let garden = Garden::resume(garden, workers)
                .map_err(|source| SaveError::Unsound { file: path.display().to_string(), source })?;
            let steps = self.input.common.steps.unwrap_or(run.scenario.steps);
            if steps < garden.steps() {
                return Err(Failure::Usage(format!(
                    "{} has grown {} steps already; --steps counts them all",
                    path.display(),
                    garden.steps()
                )));
            }
            return Ok((new(garden, run), steps, None));
        }
        let plan = self.input.plan()?;
        let garden = Garden::new(plan.resolved.clone(), plan.seed, workers)?;
        let run = RunFile::new(&plan.resolved, plan.seed, 0, StepHashes::default());
        Ok((new(garden, run), plan.steps, plan.again.map(|run| run.hashes)))
    }

    fn tell(
        &self,
        growing: &Growing,
        steps_wanted: u32,
        likeness: Option<Likeness>,
        workers: &burgeon::environment::workers::Workers,
        folder: &output::Folder,
        pictures: &[PathBuf],
    ) {
        let record = growing.garden.records().last().copied().unwrap_or_default();
        let form = record.form;
        let run = &growing.run;
        if self.json {
            let summary = Summary {
                scenario: &run.scenario.name,
                seed: run.seed,
                steps: run.steps,
                steps_wanted,
                stopped: growing.stopped.as_ref().map(ToString::to_string),
                height_m: form.height_m,
                crown_width_m: form.crown_width_m,
                trunk_diameter_m: form.trunk_diameter_m,
                breast_diameter_m: form.breast_diameter_m,
                live_crown_base_m: form.live_crown_base_m,
                widest_height_m: form.widest_height_m,
                drooping_share: form.drooping_share,
                by_order: form.by_order,
                strahler_order: form.strahler_order,
                bifurcation_ratio: form.bifurcation_ratio,
                organs: form.organs,
                internodes: form.internodes,
                leaves: form.leaves,
                apical_buds: form.apical_buds,
                lateral_buds: form.lateral_buds,
                leaf_area_m2: form.leaf_area_m2,
                mean_light: form.mean_light,
                energy_stored: record.store,
                seconds: growing.seconds,
                threads: workers.threads(),
                hash: format!("{:016x}", growing.garden.snapshot().hash()),
                same_tree: match likeness {
                    Some(Likeness::Same { .. }) => Some(true),
                    Some(Likeness::Differs { .. }) => Some(false),
                    Some(Likeness::Unknown) | None => None,
                },
                first_difference: match likeness {
                    Some(Likeness::Differs { at }) => Some(at),
                    _ => None,
                },
                files: folder.written.iter().chain(pictures).map(|p| p.display().to_string()).collect(),
            };
            // A summary of numbers and texts always serialises.
            say(serde_json::to_string_pretty(&summary).unwrap_or_default());
            return;
        }
        let time = indicatif::HumanDuration(Duration::from_secs_f64(growing.seconds));
        let time = match growing.seconds {
            s if s < 60.0 => format!("{s:.1} s"),
            _ => time.to_string(),
        };
        say(format_args!(
            "{} at step {}, seed {}: {:.2} m high, crown {:.2} m wide, {} leaves, {} organs; {time}",
            run.scenario.name,
            run.steps,
            run.seed,
            form.height_m,
            form.crown_width_m,
            grouped(form.leaves),
            grouped(form.organs),
        ));
        say(format_args!(
            "Trunk {:.2} m thick at breast height, live crown from {:.1} m, widest at {:.1} m; {:.1} m2 of leaves, \
             {:.0} % of side axes droop; internodes of order 0 to 4 and above: {}; {} orders of Strahler, {:.1} \
             branches to each of the next.",
            form.breast_diameter_m,
            form.live_crown_base_m,
            form.widest_height_m,
            form.leaf_area_m2,
            100.0 * form.drooping_share,
            form.by_order.map(grouped).join(" "),
            form.strahler_order,
            form.bifurcation_ratio,
        ));
        match likeness {
            Some(Likeness::Same { upto }) if upto == run.steps => say("The same tree, bit for bit."),
            Some(Likeness::Same { upto }) => {
                say(format_args!(
                    "The same tree up to step {upto}, bit for bit; the run holds nothing of later ones."
                ));
            }
            Some(Likeness::Unknown) => say("The run holds no hash of these steps: nothing to compare."),
            Some(Likeness::Differs { .. }) | None => {}
        }
        say(folder.line());
        if let Some(frames) = &self.frames {
            say(format_args!("{}: {} pictures", frames.display(), pictures.len()));
        }
    }
}
