//! The figures of the papers, grown and measured: what the paper claims, what Burgeon finds, and a picture.
//!
//! Nothing here is told what to find: a claim that does not hold is reported as such.

mod lam_king_1;
mod lam_king_2;
pub mod measure;
mod streit;

use core::fmt;
use core::ops::RangeInclusive;
use core::str::FromStr;

use image::RgbImage;

use crate::assets::Library;
use crate::environment::workers::{Workers, WorkersError};
use crate::export::canvas;
use crate::export::picture::{Bounds, Camera, Palette, PictureSettings, render};
use crate::export::plot::PlotError;
use crate::files::FileError;
use crate::scenario::{EditError, Garden, GardenError};
use crate::tropism::OutOfRange;
use crate::tropism::vary::VaryError;
use crate::{environment::Scene, environment::trace::Tracer, plant::Snapshot};

/// A figure that can be grown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Figure {
    /// Figure 1 of Lam & King: the four parts of the model, one after another (`LK-17`).
    LamKing1,
    /// Figure 2 of Lam & King: a tree through its life, leaves before branches (`LK-18`).
    LamKing2,
    /// Figure 3 of Streit: Barlow's root (`ST-2`, `ST-3`).
    Streit3,
    /// Figure 4 of Streit: the auxin root (`ST-4`).
    Streit4,
    /// Figure 7 of Streit: signals and their response (`ST-7`).
    Streit7,
    /// Figure 8 of Streit: target and disturbance functions (`ST-8`).
    Streit8,
    /// Figure 9 of Streit: a plant turned by 90 degrees (`ST-9`).
    Streit9,
    /// Figure 10 of Streit: under-, equal and overcompensation (`ST-9`).
    Streit10,
    /// Figure 11 of Streit: a lily (`ST-12`).
    Streit11,
    /// Figure 12 of Streit: Horneophyton (`ST-12`).
    Streit12,
    /// Figure 13 of Streit: branches outward, then upward (`ST-12`).
    Streit13,
    /// Figure 14 of Streit: palms on a beach (`ST-12`).
    Streit14,
}

impl Figure {
    /// All of them.
    pub const ALL: [Self; 12] = [
        Self::LamKing1,
        Self::LamKing2,
        Self::Streit3,
        Self::Streit4,
        Self::Streit7,
        Self::Streit8,
        Self::Streit9,
        Self::Streit10,
        Self::Streit11,
        Self::Streit12,
        Self::Streit13,
        Self::Streit14,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::LamKing1 => "lam-king-1",
            Self::LamKing2 => "lam-king-2",
            Self::Streit3 => "streit-3",
            Self::Streit4 => "streit-4",
            Self::Streit7 => "streit-7",
            Self::Streit8 => "streit-8",
            Self::Streit9 => "streit-9",
            Self::Streit10 => "streit-10",
            Self::Streit11 => "streit-11",
            Self::Streit12 => "streit-12",
            Self::Streit13 => "streit-13",
            Self::Streit14 => "streit-14",
        }
    }
}

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Figure {
    type Err = UnknownFigure;

    fn from_str(name: &str) -> Result<Self, UnknownFigure> {
        Self::ALL.into_iter().find(|f| f.name() == name).ok_or_else(|| UnknownFigure(name.into()))
    }
}

/// There is no such figure.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no figure `{0}`; there are {known}", known = Figure::ALL.map(Figure::name).join(", "))]
pub struct UnknownFigure(pub String);

/// What a paper says, and what was found.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Claim {
    /// Row of the table of sources, such as `LK-17`.
    pub row: &'static str,
    /// What the paper says.
    pub paper: &'static str,
    /// What was measured, in words and numbers.
    pub measured: String,
    /// Whether it holds.
    pub holds: bool,
}

/// A figure grown and measured.
#[derive(Debug, Clone)]
pub struct Reproduction {
    /// Which.
    pub figure: Figure,
    /// Seeds it was grown from.
    pub seeds: RangeInclusive<u64>,
    /// Claim by claim.
    pub claims: Vec<Claim>,
    /// The figure, grown from the first seed.
    pub picture: RgbImage,
    /// Curves behind it: name of the file, and CSV.
    pub tables: Vec<(String, String)>,
    /// More pictures and plots: name of the file, and picture.
    pub pictures: Vec<(String, RgbImage)>,
}

/// What came of growing a figure.
struct Findings {
    claims: Vec<Claim>,
    picture: RgbImage,
    tables: Vec<(String, String)>,
    pictures: Vec<(String, RgbImage)>,
}

impl From<(Vec<Claim>, RgbImage)> for Findings {
    fn from((claims, picture): (Vec<Claim>, RgbImage)) -> Self {
        Self { claims, picture, tables: Vec::new(), pictures: Vec::new() }
    }
}

/// Why a figure could not be grown.
#[derive(Debug, thiserror::Error)]
pub enum ReproduceError {
    /// A scenario of the figure is bad; only a folder's own can be.
    #[error(transparent)]
    File(#[from] FileError),
    /// It could not be set out.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// It stopped growing.
    #[error(transparent)]
    Garden(#[from] GardenError),
    /// There are no threads.
    #[error(transparent)]
    Workers(#[from] WorkersError),
    /// A base model could not be varied.
    #[error(transparent)]
    Vary(#[from] VaryError),
    /// There is no such controller or root.
    #[error(transparent)]
    Setting(#[from] OutOfRange),
    /// A plot of it could not be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// No seeds were given.
    #[error("a figure needs at least one seed")]
    NoSeeds,
}

/// Grows a figure from each seed and measures what the paper says about it; `size` is that of one picture in it.
///
/// # Errors
/// A scenario of the library that is bad or cannot be grown, or no seeds.
pub fn reproduce(
    figure: Figure,
    seeds: RangeInclusive<u64>,
    library: &Library,
    size: PictureSettings,
    workers: &Workers,
) -> Result<Reproduction, ReproduceError> {
    if seeds.is_empty() {
        return Err(ReproduceError::NoSeeds);
    }
    let Findings { claims, picture, tables, pictures } = match figure {
        Figure::LamKing1 => lam_king_1::grow(seeds.clone(), library, size, workers)?.into(),
        Figure::LamKing2 => lam_king_2::grow(seeds.clone(), library, size, workers)?.into(),
        Figure::Streit3 => streit::surface::barlow()?,
        Figure::Streit4 => streit::surface::auxin(size, workers)?,
        Figure::Streit7 => streit::control::signals()?,
        Figure::Streit8 => streit::control::functions()?,
        Figure::Streit9 => streit::control::turned()?,
        Figure::Streit10 => streit::control::compensation()?,
        Figure::Streit11 => streit::plants::lily(seeds.clone(), library, size, workers)?,
        Figure::Streit12 => streit::plants::horneophyton(seeds.clone(), library, size, workers)?,
        Figure::Streit13 => streit::plants::upward(seeds.clone(), library, size, workers)?,
        Figure::Streit14 => streit::palms::palms(seeds.clone(), library, size, workers)?,
    };
    Ok(Reproduction { figure, seeds, claims, picture, tables, pictures })
}

/// A scenario grown to its end from one seed, with what `each` makes of every step.
fn grown<T>(
    library: &Library,
    scenario: &str,
    seed: u64,
    mut each: impl FnMut(&mut Garden) -> T,
) -> Result<(Garden, Vec<T>), ReproduceError> {
    let mut garden = Garden::new(library.scenario(scenario)?, seed, Workers::new(1)?)?;
    let mut seen = Vec::new();
    for _ in 0..garden.scenario().steps {
        garden.step()?;
        seen.push(each(&mut garden));
    }
    Ok((garden, seen))
}

/// `task` for each seed, seeds shared among workers.
fn for_seeds<T: Send>(
    seeds: RangeInclusive<u64>,
    workers: &Workers,
    task: impl Fn(u64) -> Result<T, ReproduceError> + Sync,
) -> Result<Vec<T>, ReproduceError> {
    let seeds: Vec<u64> = seeds.collect();
    workers.map(seeds.len(), |i| task(seeds[i])).into_iter().collect()
}

/// Pictures of scenes with one camera, each under its caption.
fn pictures(
    scenes: &[(Scene, Snapshot, String)],
    azimuth_deg: f32,
    size: PictureSettings,
    workers: &Workers,
) -> Vec<RgbImage> {
    let bounds = scenes.iter().map(|(scene, ..)| Bounds::of(scene)).reduce(|a, b| a.union(&b));
    let camera = Camera::framing(&bounds.unwrap_or_default(), azimuth_deg, 5.0, size.aspect());
    let picture = |(scene, shot, caption): &(Scene, Snapshot, String)| {
        let tracer = Tracer::build(scene);
        let mut image = render(&tracer, &camera, &Palette::of_snapshot(shot), size, workers);
        canvas::caption(&mut image, caption, 2);
        image
    };
    scenes.iter().map(picture).collect()
}
