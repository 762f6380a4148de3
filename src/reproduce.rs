//! The figures of the papers, grown and measured: what the paper claims, what Burgeon finds, and a picture.
//!
//! Nothing here is told what to find: a claim that does not hold is reported as such.

mod lam_king_1;
mod lam_king_2;
pub mod measure;

use core::fmt;
use core::ops::RangeInclusive;
use core::str::FromStr;

use image::RgbImage;

use crate::assets::Library;
use crate::environment::workers::{Workers, WorkersError};
use crate::export::canvas;
use crate::export::picture::{Bounds, Camera, Palette, PictureSettings, render};
use crate::files::FileError;
use crate::scenario::{EditError, Garden, GardenError};
use crate::{environment::Scene, environment::trace::Tracer, plant::Snapshot};

/// A figure that can be grown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Figure {
    /// Figure 1 of Lam & King: the four parts of the model, one after another (`LK-17`).
    LamKing1,
    /// Figure 2 of Lam & King: a tree through its life, leaves before branches (`LK-18`).
    LamKing2,
}

impl Figure {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::LamKing1, Self::LamKing2];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::LamKing1 => "lam-king-1",
            Self::LamKing2 => "lam-king-2",
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
#[error("there is no figure `{0}`; there are lam-king-1 and lam-king-2")]
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
    let (claims, picture) = match figure {
        Figure::LamKing1 => lam_king_1::grow(seeds.clone(), library, size, workers)?,
        Figure::LamKing2 => lam_king_2::grow(seeds.clone(), library, size, workers)?,
    };
    Ok(Reproduction { figure, seeds, claims, picture })
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
