//! The picture and the film of a run, as the command line and the window write them.

use std::path::{Path, PathBuf};

use bevy::math::Vec3;
use image::RgbImage;

use super::canvas::caption;
use super::film::{FilmError, FilmSettings, save_gif, save_png};
use super::picture::{Bounds, Camera, Palette, PictureSettings, render};
use super::strip::Strip;
use crate::environment::Scene;
use crate::environment::trace::Tracer;
use crate::environment::workers::Workers;

/// Where the camera may stand, azimuth and elevation in degrees: the first is taken unless walls hide the plants.
const VIEWS: [(f32, f32); 12] = [
    (25.0, 5.0),
    (-25.0, 5.0),
    (0.0, 5.0),
    (60.0, 5.0),
    (-60.0, 5.0),
    (120.0, 5.0),
    (-120.0, 5.0),
    (180.0, 5.0),
    (25.0, 30.0),
    (-25.0, 30.0),
    (25.0, 55.0),
    (-25.0, 55.0),
];
/// Points of the plants looked for from each of them.
const LOOKED_FOR: usize = 200;
/// Most pieces of wood and leaf kept for a film, about a gigabyte of them.
const PIECES: usize = 16_000_000;

/// Size and grain of a film's frames.
pub const FILM: PictureSettings = PictureSettings { width: 360, height: 405, samples: 3 };

/// Scenes of a film, as a run leaves them.
#[derive(Debug, Clone, Default)]
pub struct Reel(Strip<Scene>);

impl Reel {
    /// Whether a step will be a frame.
    pub fn wants(&self, step: u32) -> bool {
        self.0.wants(step)
    }

    /// Adds a step; when there are too many, every other one goes.
    pub fn add(&mut self, step: u32, scene: Scene) {
        self.0.add(step, scene, PIECES, |scene| scene.capsules.len() + scene.leaves.len());
    }

    /// Adds the end of the run, if it is not there yet.
    pub fn end(&mut self, step: u32, scene: Scene) {
        self.0.end(step, scene);
    }

    /// Frames in it.
    pub fn len(&self) -> usize {
        self.0.frames().len()
    }

    /// Whether there is nothing to show.
    pub fn is_empty(&self) -> bool {
        self.0.frames().is_empty()
    }

    /// Room for every frame.
    pub fn bounds(&self) -> Bounds {
        self.0.frames().iter().fold(Bounds::default(), |all, (_, scene)| all.union(&Bounds::of(scene)))
    }

    /// The last scene.
    pub fn last(&self) -> Option<&Scene> {
        self.0.frames().last().map(|(_, scene)| scene)
    }

    /// Draws the frames, or only the last; `drawn` is called after each.
    pub fn draw(
        &self,
        last_only: bool,
        camera: &Camera,
        palette: &Palette,
        settings: PictureSettings,
        workers: &Workers,
        mut drawn: impl FnMut(),
    ) -> Vec<RgbImage> {
        let first = if last_only { self.0.frames().len().saturating_sub(1) } else { 0 };
        let frame = |(step, scene): &(u32, Scene)| {
            let mut image = render(&Tracer::build(scene), camera, palette, settings, workers);
            caption(&mut image, &format!("step {step}"), 1);
            drawn();
            image
        };
        self.0.frames()[first..].iter().map(frame).collect()
    }

    /// Draws and writes the film; `drawn` is called after each frame.
    ///
    /// # Errors
    /// As [`save_gif`].
    pub fn save(
        &self,
        palette: &Palette,
        workers: &Workers,
        path: &Path,
        drawn: impl FnMut(),
    ) -> Result<(), FilmError> {
        let camera = self.camera(FILM)?;
        save_gif(path, &self.draw(false, &camera, palette, FILM, workers, drawn), FilmSettings::default())
    }

    /// Draws the frames and writes each as `step_0000.png` into a folder that is there; `drawn` is called after each.
    ///
    /// # Errors
    /// As [`save_png`]; what was written before stays.
    pub fn save_pictures(
        &self,
        palette: &Palette,
        settings: PictureSettings,
        workers: &Workers,
        folder: &Path,
        mut drawn: impl FnMut(),
    ) -> Result<Vec<PathBuf>, FilmError> {
        let camera = self.camera(settings)?;
        let write = |(step, scene): &(u32, Scene)| {
            let path = folder.join(format!("step_{step:04}.png"));
            save_png(&path, &render(&Tracer::build(scene), &camera, palette, settings, workers))?;
            drawn();
            Ok(path)
        };
        self.0.frames().iter().map(write).collect()
    }

    /// One stand for the whole film.
    fn camera(&self, settings: PictureSettings) -> Result<Camera, FilmError> {
        let last = self.last().ok_or(FilmError::NoFrames)?;
        Ok(camera(last, &self.bounds(), settings.aspect()))
    }
}

/// Draws and writes the picture of a scene.
///
/// # Errors
/// As [`save_png`].
pub fn save_picture(
    scene: &Scene,
    palette: &Palette,
    workers: &Workers,
    path: &Path,
) -> Result<(), FilmError> {
    let settings = PictureSettings::default();
    let camera = camera(scene, &Bounds::of(scene), settings.aspect());
    save_png(path, &render(&Tracer::build(scene), &camera, palette, settings, workers))
}

/// The first of the views from which walls hide hardly any of the plants, or else the one from which they hide least.
pub fn camera(scene: &Scene, bounds: &Bounds, aspect: f32) -> Camera {
    let walls = Scene { solids: scene.solids.clone(), ground: scene.ground, ..Scene::default() };
    let tracer = Tracer::build(&walls);
    let every = scene.capsules.len().div_ceil(LOOKED_FOR).max(1);
    let mut best: Option<(usize, Camera)> = None;
    for (azimuth, elevation) in VIEWS {
        let camera = Camera::framing(bounds, azimuth, elevation, aspect);
        let points = scene.capsules.iter().step_by(every).map(|wood| wood.to);
        let hidden = points.filter(|p| tracer.occluded(camera.eye, *p - camera.eye, 0.99, &[])).count();
        if hidden <= LOOKED_FOR / 20 {
            return camera;
        }
        if best.as_ref().is_none_or(|(fewest, _)| hidden < *fewest) {
            best = Some((hidden, camera));
        }
    }
    // There is always a first view.
    best.map_or(Camera::looking(Vec3::ONE, Vec3::ZERO), |(_, camera)| camera)
}
