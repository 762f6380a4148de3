//! `burgeon vary`: siblings of a finished plant.

use std::path::Path;

use bevy::math::Quat;
use burgeon::environment::trace::Tracer;
use burgeon::environment::workers::Workers;
use burgeon::environment::{Scene, SunLight};
use burgeon::export::canvas::{caption, grid};
use burgeon::export::film::save_png;
use burgeon::export::picture::{Bounds, Camera, Palette, PictureSettings, render};
use burgeon::files::{RunFile, SkeletonFile, StepHashes, is_save, is_skeleton, read_mtg, read_plant_text};
use burgeon::limits::SKELETON_BYTES;
use burgeon::plant::Snapshot;
use burgeon::plant::skeleton::{Skeleton, SkeletonError};
use burgeon::scenario::{Garden, SavedRun};
use burgeon::species::Species;
use burgeon::tropism::stability::stability;
use burgeon::tropism::vary::{Variation, siblings};
use burgeon::tropism::{Control, LONGEST_LAG, Spread, Tropisms};
use clap::Args;
use image::RgbImage;

use super::Failure;
use super::grow::Growing;
use super::input::{Common, Input, library};
use super::output::{Output, progress, say};

/// Most siblings on one sheet.
const SHEET: usize = 24;
/// Most siblings of one run.
const MOST: i64 = 100_000;

/// Grow siblings of a finished plant: as many nodes, as long, none like another, each as a picture and a skeleton file. They know neither walls nor ground.
#[derive(Args, Debug)]
pub struct Vary {
    /// A scenario or species by name, a scenario file, a run.ron, a save, a skeleton file or an MTG.
    plant: String,

    #[command(flatten)]
    common: Common,

    #[command(flatten)]
    output: Output,

    /// Siblings.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=MOST))]
    count: u32,

    /// The species whose leaves and colours the plant of an MTG or skeleton file has.
    #[arg(long, value_name = "NAME")]
    species: Option<String>,

    /// Which plant of a garden or MTG, in the order of planting, from 0.
    #[arg(long, default_value_t = 0)]
    index: u32,

    /// Sub-steps until a correction takes effect.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(0..=i64::from(LONGEST_LAG)))]
    lag: u32,

    /// Compensation ratio: about 0.7 is the edge of stability, 0.5 to 1.2 is useful.
    #[arg(long, default_value_t = 0.8)]
    ratio: f32,

    /// Error with which a tip senses its heading, standard deviation, degrees.
    #[arg(long, default_value_t = 5.0, value_name = "DEG", value_parser = degrees)]
    sensing_error: f32,

    /// Random disturbance of each sub-step, standard deviation, degrees.
    #[arg(long, default_value_t = 2.5, value_name = "DEG", value_parser = degrees)]
    disturbance: f32,

    /// Steady disturbance of each sub-step that circles about the stem, degrees.
    #[arg(long, default_value_t = 0.0, value_name = "DEG", value_parser = degrees)]
    nutation: f32,

    /// Length of stem over which nutation circles once.
    #[arg(long, default_value_t = 1.0, value_name = "METRES")]
    nutation_length: f32,

    /// Weight of up in the target, beside 1 of the plant's own course; below 0, of down.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    gravitropism: f32,

    /// Weight of up in the target that an axis reaches only with length: its end turns upright.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    orthotropism: f32,

    /// Length of an axis over which its orthotropism rises.
    #[arg(long, default_value_t = 1.0, value_name = "METRES")]
    orthotropism_m: f32,

    /// Weight of the level in the target.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    plagiotropism: f32,

    /// Weight in the target of the heading in which an axis left its parent.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    autotropism: f32,

    /// Integral control, times the gain: takes away a steady lean.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    integral: f32,

    /// Derivative control, times the gain: damps swings.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    derivative: f32,

    /// Disturbances of any size up to --disturbance alike, instead of Gaussian ones.
    #[arg(long)]
    uniform: bool,

    /// How far the target leans over from the plant's own course, towards +x, degrees.
    #[arg(long, default_value_t = 0.0, value_name = "DEG", value_parser = lean, allow_negative_numbers = true)]
    lean: f32,

    /// How far the target turns with the parent stem: 0 keeps to gravity, 1 to the parent.
    #[arg(long, default_value_t = 0.0, value_name = "SHARE")]
    parent_share: f32,

    /// Length of a sub-step, at most an internode's [default: a sixtieth of the longest axis]. Axes of fewer sub-steps than the lag end before they are corrected.
    #[arg(long, value_name = "METRES")]
    sub_step: Option<f32>,

    /// Write no picture of each sibling, only the sheet, the table and the skeletons.
    #[arg(long)]
    sheet_only: bool,
}

/// An angle of up to 114 degrees, two radians.
fn degrees(text: &str) -> Result<f32, String> {
    let angle = text.parse::<f32>().ok().filter(|angle| (0.0..=114.0).contains(angle));
    angle.ok_or_else(|| "allowed: 0 to 114 degrees".into())
}

/// An angle to either side.
fn lean(text: &str) -> Result<f32, String> {
    let angle = text.parse::<f32>().ok().filter(|angle| angle.abs() <= 180.0);
    angle.ok_or_else(|| "allowed: -180 to 180 degrees".into())
}

impl Vary {
    /// Runs the command.
    pub fn run(&self) -> Result<(), Failure> {
        let variation = Variation {
            control: Control {
                integral: self.integral,
                derivative: self.derivative,
                ..Control::of_ratio(self.ratio, self.lag)?
            },
            spread: if self.uniform { Spread::Uniform } else { Spread::Gaussian },
            sensing_error: self.sensing_error.to_radians(),
            disturbance: self.disturbance.to_radians(),
            nutation: self.nutation.to_radians(),
            nutation_length: self.nutation_length,
            tropisms: Tropisms {
                gravi: self.gravitropism,
                ortho: self.orthotropism,
                reach: self.orthotropism_m,
                plagio: self.plagiotropism,
                auto: self.autotropism,
                ..Variation::default().tropisms
            },
            relative_to_parent: self.parent_share,
            lean: Quat::from_rotation_z(-self.lean.to_radians()),
            sub_step: self.sub_step,
        };
        variation.check()?;
        let meter = stability(&variation.control)?;
        if !meter.stable {
            eprintln!(
                "burgeon: this control is unstable: ratio {:.3} is below {:.3}, the least for lag {}; the siblings will swing wider \
                 and wider",
                meter.ratio, meter.critical_ratio, meter.lag
            );
        }
        let name = Path::new(&self.plant).file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let mut files = vec!["siblings.png".to_string(), "siblings.csv".into()];
        let single = |n: usize| if n == 0 { "base.png".into() } else { format!("sibling_{n:03}.png") };
        let pictures = if self.sheet_only { 0 } else { self.count as usize + 1 };
        files.extend((0..pictures).map(single));
        let plant = |n: usize| format!("sibling_{n:03}.ron");
        files.extend((1..=self.count as usize).map(plant));
        let names: Vec<&str> = files.iter().map(String::as_str).collect();
        let mut folder = self.output.folder(&format!("{name}-siblings"), &names)?;

        let workers = self.common.workers()?;
        let (base, species) = self.base()?;
        let seed = self.common.seed.unwrap_or(1);
        let grown = siblings(&base, &variation, seed, self.count as usize, &workers)?;

        folder.create()?;
        let all: Vec<&Skeleton> = core::iter::once(&base).chain(&grown).collect();
        folder.text("siblings.csv", &table(&all))?;
        for (n, sibling) in (1..).zip(&grown) {
            let name = format!("sibling_{n:03}");
            let text = SkeletonFile::of(sibling, &name, &species.name).to_ron();
            if text.len() as u64 > SKELETON_BYTES {
                eprintln!(
                    "burgeon: a file of {name} would be larger than is read: none is written; longer sub-steps make fewer pieces"
                );
                break;
            }
            folder.text(&plant(n), &text)?;
        }
        let shown = if self.sheet_only { all.len().min(SHEET + 1) } else { all.len() };
        let images = draw(&all[..shown], &species, &workers);
        for (n, image) in images.iter().enumerate().take(pictures) {
            save_png(&folder.file(&single(n)), image)?;
        }
        let mut sheet = images[..images.len().min(SHEET + 1)].to_vec();
        for (n, image) in sheet.iter_mut().enumerate() {
            caption(image, &if n == 0 { "base".into() } else { format!("{n}") }, 1);
        }
        save_png(&folder.file("siblings.png"), &grid(&sheet, 5, 3))?;

        let range = |of: &dyn Fn(&Skeleton) -> f64, digits: usize| {
            let [low, high] = grown.iter().map(of).fold([f64::MAX, 0.0], |[l, h], it| [it.min(l), it.max(h)]);
            let [low, high] = [low, high].map(|it| format!("{it:.digits$}"));
            if low == high { low } else { format!("{low} to {high}") }
        };
        say(format_args!(
            "{} siblings of {name}: {} nodes and {} m of stem each, {} m high; base {:.2} m",
            grown.len(),
            range(&|sibling| sibling.nodes() as f64, 0),
            range(&Skeleton::total_length, 2),
            range(&|sibling| sibling.height().into(), 2),
            base.height(),
        ));
        say(format_args!("{}: {} files", folder.path().display(), folder.written.len()));
        Ok(())
    }

    /// The plant to vary, and the species whose leaves and colours it has.
    fn base(&self) -> Result<(Skeleton, Species), Failure> {
        let path = Path::new(&self.plant);
        let library = library(&self.common.assets)?;
        let extension = path.extension().filter(|_| path.is_file()).unwrap_or_default();
        if path.is_file() && is_save(path) {
            self.is_finished("a save")?;
            return self.of(SavedRun::read(path)?.garden.snapshot());
        }
        if extension == "mtg" {
            self.is_finished("an MTG")?;
            let plants = read_mtg(path)?;
            let plant = plants.into_iter().nth(self.index as usize).filter(|p| !p.segments.is_empty());
            let skeleton = plant.ok_or(SkeletonError::NoPlant(self.index))?;
            return Ok((skeleton, library.species(self.species.as_deref().unwrap_or("lam_king"))?));
        }
        if extension == "ron" {
            let text = read_plant_text(path)?;
            if is_skeleton(&text) {
                self.is_finished("a skeleton file")?;
                let (file, skeleton) = SkeletonFile::from_ron(&text, &self.plant)?;
                if self.index > 0 {
                    return Err(SkeletonError::NoPlant(self.index).into());
                }
                return Ok((skeleton, library.species(self.species.as_ref().unwrap_or(&file.species))?));
            }
        }
        if self.species.is_some() {
            return Err(Failure::Usage("--species is for an MTG or a skeleton file".into()));
        }
        let plan = Input::of_either(&self.plant, &library, &self.common).plan()?;
        let run = RunFile::new(&plan.resolved, plan.seed, 0, StepHashes::default());
        let mut garden = Garden::new(plan.resolved, plan.seed, self.common.workers()?)?;
        garden.set_limits(self.common.limits());
        let mut growing = Growing { garden, run, stopped: None, seconds: 0.0 };
        growing.grow(plan.steps, |_, _| ());
        match growing.stopped {
            Some(stopped) => Err(stopped.into()),
            None => self.of(&growing.garden.snapshot()),
        }
    }

    /// Refuses options that say how a plant grows that is finished.
    fn is_finished(&self, what: &str) -> Result<(), Failure> {
        match self.common.grows_otherwise() {
            Some(option) => Err(Failure::Usage(format!("{option} changes nothing in {what}: it has grown"))),
            None => Ok(()),
        }
    }

    fn of(&self, snapshot: &Snapshot) -> Result<(Skeleton, Species), Failure> {
        let skeleton = Skeleton::of(snapshot, self.index)?;
        let record = snapshot.plants.get(self.index as usize).and_then(Option::as_ref);
        Ok((skeleton, record.map(|record| (*record.species).clone()).unwrap_or_default()))
    }
}

/// Size of every sibling, the base model first.
fn table(all: &[&Skeleton]) -> String {
    let mut text = String::from("sibling,nodes,length_m,height_m\n");
    for (n, skeleton) in all.iter().enumerate() {
        let (nodes, length, height) = (skeleton.nodes(), skeleton.total_length(), skeleton.height());
        text.push_str(&format!("{n},{nodes},{length:.4},{height:.4}\n"));
    }
    text
}

/// A picture of each, all from one stand.
fn draw(all: &[&Skeleton], species: &Species, workers: &Workers) -> Vec<RgbImage> {
    let size = PictureSettings { width: 260, height: 320, samples: 3 };
    let scene = |skeleton: &Skeleton| {
        let sun =
            Some(SunLight { direction: bevy::math::Vec3::new(0.4, 0.7, 0.6).normalize(), strength: 0.6 });
        let mut scene = Scene { ground: Some(0.0), sun, ..Scene::default() };
        skeleton.add_to(&mut scene, species, 0);
        scene
    };
    let bounds = all.iter().fold(Bounds::default(), |all, one| all.union(&Bounds::of(&scene(one))));
    let camera = Camera::framing(&bounds, 25.0, 5.0, size.aspect());
    let palette = Palette::of([species]);
    let bar = progress(all.len() as u64, "picture");
    let images = all
        .iter()
        .map(|skeleton| {
            bar.inc(1);
            render(&Tracer::build(&scene(skeleton)), &camera, &palette, size, workers)
        })
        .collect();
    bar.finish_and_clear();
    images
}
