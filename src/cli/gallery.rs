//! `burgeon gallery`: species at three ages, in leaf and bare, on one sheet.

use burgeon::assets::Library;
use burgeon::environment::Scene;
use burgeon::environment::trace::Tracer;
use burgeon::environment::workers::Workers;
use burgeon::export::canvas::{PAPER, framed, grid, side_by_side, titled};
use burgeon::export::film::save_png;
use burgeon::export::picture::{Bounds, Camera, Palette, PictureSettings, render};
use burgeon::files::ResolvedScenario;
use burgeon::plant::measure::Form;
use burgeon::scenario::{Garden, GardenError};
use burgeon::species::Allocation;
use clap::Args;
use image::RgbImage;

use super::Failure;
use super::output::{Output, progress, say};

/// Where the camera stands, degrees from +z towards +x and above the foot.
const STAND: (f32, f32) = (25.0, 3.0);

/// Grow every species from seed in the open and show it young, grown and old, in leaf and bare, on one sheet.
#[derive(Args, Debug)]
pub struct Gallery {
    /// The species [default: all that grow into trees and shrubs].
    species: Vec<String>,

    /// Ages in years.
    #[arg(long, value_delimiter = ',', default_values_t = [6, 15, 30])]
    ages: Vec<u32>,

    /// Height of each picture, pixels.
    #[arg(long, default_value_t = 360, value_parser = clap::value_parser!(u32).range(32..=4096))]
    height: u32,

    #[command(flatten)]
    common: super::input::Common,

    #[command(flatten)]
    output: Output,
}

/// A species grown.
struct Grown {
    name: String,
    /// A picture of each age, in leaf.
    leafy: Vec<RgbImage>,
    /// And bare; as in leaf where it is evergreen.
    bare: Vec<RgbImage>,
    seconds: f64,
    form: Form,
}

impl Gallery {
    /// Runs the command.
    pub fn run(&self) -> Result<(), Failure> {
        if self.common.steps.is_some() {
            return Err(Failure::Usage(
                "a gallery has no --steps: --ages says how many years it grows".into(),
            ));
        }
        let library = super::input::library(&self.common.assets)?;
        let names = match &self.species[..] {
            [] => all(&library)?,
            names => names.to_vec(),
        };
        let mut ages = self.ages.clone();
        ages.sort_unstable();
        ages.dedup();
        let files: Vec<String> = names.iter().map(|name| format!("{name}.png")).collect();
        let mut wanted: Vec<&str> = files.iter().map(String::as_str).collect();
        wanted.push("gallery.png");
        let mut folder = self.output.folder("gallery", &wanted)?;
        let workers = self.common.workers()?;
        let plans: Vec<(ResolvedScenario, u32)> =
            names.iter().map(|name| alone(&library, name)).collect::<Result<_, _>>()?;
        folder.create()?;

        let years = u64::from(ages.last().copied().unwrap_or(0));
        let bar = progress(names.len() as u64 * years, "year");
        let mut rows = Vec::new();
        let mut stopped = Ok(());
        for ((name, file), (mut resolved, year)) in names.iter().zip(&files).zip(plans) {
            for setting in &self.common.set {
                resolved.apply_set(setting)?;
            }
            bar.set_message(name.clone());
            let grown;
            (grown, stopped) = self.grow(name, resolved, year, &ages, &workers, || bar.inc(1))?;
            let form = &grown.form;
            bar.suspend(|| {
                say(format_args!(
                    "{name:18} {:5.1} m high, {:5.1} m wide, trunk {:.2} m, {} leaves, {} internodes; {:.1} s",
                    form.height_m,
                    form.crown_width_m,
                    form.trunk_diameter_m,
                    form.leaves,
                    form.internodes,
                    grown.seconds
                ));
            });
            let both = [side_by_side(&grown.leafy, 3), side_by_side(&grown.bare, 3)];
            save_png(&folder.file(file), &titled(&grid(&both, 1, 3), &grown.name, 2))?;
            rows.push(grown);
            if stopped.is_err() {
                break;
            }
        }
        bar.finish_and_clear();
        let cells: Vec<RgbImage> = rows
            .iter()
            .map(|grown| {
                let all = [&grown.leafy[..], &grown.bare[..]].concat();
                titled(&framed(&side_by_side(&all, 3), 2, PAPER), &grown.name.replace('_', " "), 2)
            })
            .collect();
        save_png(&folder.file("gallery.png"), &grid(&cells, 2, 6))?;
        say(folder.line());
        Ok(stopped?)
    }

    /// Grows a species to all ages, or to a limit; what there is of it then is the last picture.
    fn grow(
        &self,
        name: &str,
        resolved: ResolvedScenario,
        year: u32,
        ages: &[u32],
        workers: &Workers,
        mut each_year: impl FnMut(),
    ) -> Result<(Grown, Result<(), GardenError>), Failure> {
        let evergreen = resolved.species.values().all(|species| species.evergreen);
        let mut garden = Garden::new(resolved, self.common.seed.unwrap_or(1), self.common.workers()?)?;
        garden.set_limits(self.common.limits());
        let mut seconds = 0.0;
        let (mut leafy, mut bare) = (Vec::new(), Vec::new());
        let mut stopped = Ok(());
        for &age in ages {
            if stopped.is_err() {
                break;
            }
            let began = std::time::Instant::now();
            while stopped.is_ok() && garden.steps() < age * year {
                stopped = garden.step().map(|_| ());
                if stopped.is_ok() && garden.steps().is_multiple_of(year) {
                    each_year();
                }
            }
            seconds += began.elapsed().as_secs_f64();
            let scene = garden.scene();
            let palette = Palette::of_snapshot(&garden.snapshot());
            let picture = self.picture(&scene, &palette, workers);
            if evergreen {
                bare.push(picture.clone());
            } else {
                let mut winter = scene;
                winter.leaves.clear();
                bare.push(self.picture(&winter, &palette, workers));
            }
            leafy.push(picture);
        }
        let form = Form::of(&garden.snapshot(), None);
        Ok((Grown { name: name.into(), leafy, bare, seconds, form }, stopped))
    }

    fn picture(&self, scene: &Scene, palette: &Palette, workers: &Workers) -> RgbImage {
        let settings = PictureSettings { width: self.height * 8 / 9, height: self.height, samples: 5 };
        let camera = Camera::framing(&Bounds::of(scene), STAND.0, STAND.1, settings.aspect());
        render(&Tracer::build(scene), &camera, palette, settings, workers)
    }
}

/// The species that share their energy by vigour and live by years and seasons: of the others no crown comes.
fn all(library: &Library) -> Result<Vec<String>, Failure> {
    let mut names = Vec::new();
    for name in library.species_names() {
        let species = library.species(&name)?;
        if species.allocation == Allocation::ByVigour && species.steps_per_year <= 4 {
            names.push(name);
        }
    }
    Ok(names)
}

/// One plant of a species in an open field, and its steps a year.
pub fn alone(library: &Library, name: &str) -> Result<(ResolvedScenario, u32), Failure> {
    let resolved = library.alone(name)?;
    let year = resolved.species.values().map(|species| species.steps_per_year).next().unwrap_or(1);
    Ok((resolved, year))
}
