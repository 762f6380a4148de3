//! Growth as a model that moves: one animation, which any glTF viewer plays.
//!
//! Each step is a node with the plants as they were then; the animation shows one after the other by setting their
//! scales to 1 and back to 0, all with the interpolation `STEP`. So radii, sag and shed branches are those of their step.
//! Morph targets could not: organs come and go, and every one of them would be in every step. Viewers that play nothing
//! show the end.

use std::io::Write;
use std::path::Path;

use gltf_json::accessor::Type;
use gltf_json::animation::{Channel, Interpolation, Property, Sampler, Target};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Animation, Index, Node};

use super::materials::Part;
use super::model::Model;
use crate::environment::workers::Workers;
use crate::export::ExportError;
use crate::export::error::to_file;
use crate::export::strip::Strip;
use crate::plant::Snapshot;
use crate::shape::levels::{self, Shape};
use crate::shape::paint::Paint;

/// Time from frame to frame, seconds.
const SECONDS: f32 = 0.2;
/// How long the end is shown, seconds.
const HOLD: f32 = 1.0;
/// Triangles of all frames together unless a number for each is asked for, about 40 megabytes.
const USUAL: usize = 500_000;
/// Most triangles of all frames together, about 300 megabytes: viewers hold them all at once.
pub const MOST_TRIANGLES: usize = 4_000_000;
/// Most bytes of snapshots kept for a film.
const BYTES: usize = 1 << 30;

/// Steps of a run for a film of growth.
#[derive(Debug, Clone, Default)]
pub struct GrowthFilm(Strip<Snapshot>);

impl GrowthFilm {
    /// Whether a step will be a frame.
    pub fn wants(&self, step: u32) -> bool {
        self.0.wants(step)
    }

    /// Adds a step; of more than 120, or of more than a gigabyte, every other one goes.
    pub fn add(&mut self, snapshot: Snapshot) {
        self.0.add(snapshot.step, snapshot, BYTES, Snapshot::bytes);
    }

    /// Adds the end of the run, if it is not there yet.
    pub fn end(&mut self, snapshot: Snapshot) {
        self.0.end(snapshot.step, snapshot);
    }

    /// Writes the film as one GLB. A frame has at most `triangles`; without a number frames have as many as 500,000
    /// together allow, early ones all they need.
    ///
    /// # Errors
    /// If frames have more than [`MOST_TRIANGLES`] together, or the stream does not take it.
    pub fn write(
        &self,
        triangles: Option<usize>,
        workers: &Workers,
        mut writer: impl Write,
    ) -> Result<(), ExportError> {
        let frames = self.0.frames();
        let whole = |k: usize| Shape::full(&frames[k].1).iter().map(Shape::triangles).sum::<usize>();
        let whole = workers.map(frames.len(), whole);
        let each = triangles.unwrap_or_else(|| even(&whole, USUAL));
        let together = whole.iter().map(|&n| n.min(each)).sum();
        if together > MOST_TRIANGLES {
            return Err(ExportError::TooDetailed { path: None, triangles: together, most: MOST_TRIANGLES });
        }
        let shapes = workers.map(frames.len(), |k| levels::within(&frames[k].1, each));
        let mut model = Model::default();
        let mut shown = Vec::new();
        let first = frames.first().map_or(0, |frame| frame.0);
        let stride = frames.windows(2).map(|pair| pair[1].0 - pair[0].0).max().unwrap_or(1);
        let times: Vec<f32> =
            frames.iter().map(|frame| SECONDS * (frame.0 - first) as f32 / stride as f32).collect();
        for (k, ((step, snapshot), shapes)) in frames.iter().zip(&shapes).enumerate() {
            let last = k + 1 == frames.len();
            let Some(node) = frame(&mut model, *step, snapshot, shapes, last)? else { continue };
            shown.push((node, times[k], times.get(k + 1).copied()));
        }
        let nodes: Vec<_> = shown.iter().map(|frame| frame.0).collect();
        animate(&mut model, &shown);
        model.scene(nodes);
        model.write(&mut writer)
    }

    /// Writes the film as one GLB file, replacing what is there.
    ///
    /// # Errors
    /// As [`write`](Self::write), with the path.
    pub fn save(&self, triangles: Option<usize>, workers: &Workers, path: &Path) -> Result<(), ExportError> {
        to_file(path, |writer| self.write(triangles, workers, writer))
    }
}

/// The most each of these numbers may count so that they are at most `all` together.
fn even(numbers: &[usize], all: usize) -> usize {
    let mut rising = numbers.to_vec();
    rising.sort_unstable();
    let mut left = all;
    for (k, &number) in rising.iter().enumerate() {
        let share = left / (rising.len() - k);
        if number > share {
            return share;
        }
        left -= number;
    }
    usize::MAX
}

/// Adds the plants of a step as a node, where there is anything to see.
fn frame(
    model: &mut Model,
    step: u32,
    snapshot: &Snapshot,
    shapes: &[Shape],
    last: bool,
) -> Result<Option<Index<Node>>, ExportError> {
    let paint = Paint::of(snapshot);
    let mut primitives = Vec::new();
    for (plant, shape) in snapshot.plants.iter().zip(shapes) {
        let Some(plant) = plant else { continue };
        let leaves = if shape.sprays { Part::Sprays } else { Part::Leaves };
        for (surface, part) in [(&shape.wood, Part::Bark), (&shape.leaves, leaves)] {
            if !surface.is_empty() {
                let material = model.material(&plant.species, part, true)?;
                let tints = paint.tints(surface);
                primitives.push(model.primitive(surface, Default::default(), &[&tints], material)?);
            }
        }
    }
    if primitives.is_empty() {
        return Ok(None);
    }
    let mesh = model.mesh(format!("step {step}"), primitives);
    Ok(Some(model.root.push(Node {
        name: Some(format!("step {step}")),
        mesh: Some(mesh),
        scale: Some([if last { 1.0 } else { 0.0 }; 3]),
        ..Node::default()
    })))
}

/// Adds the animation that shows nodes from a time to a time, the last to the end.
fn animate(model: &mut Model, shown: &[(Index<Node>, f32, Option<f32>)]) {
    let (mut samplers, mut channels) = (Vec::new(), Vec::new());
    for &(node, from, until) in shown {
        let mut keys = vec![(from, 1.0), until.map_or((from + HOLD, 1.0), |until| (until, 0.0))];
        if from > 0.0 {
            keys.insert(0, (0.0, 0.0));
        }
        let times = keys.iter().map(|key| [key.0]).collect::<Vec<_>>();
        let input = model.floats(times.into_iter(), Type::Scalar, None);
        let accessor = &mut model.root.accessors[input.value()];
        accessor.min = Some(vec![keys[0].0].into());
        accessor.max = Some(vec![keys[keys.len() - 1].0].into());
        let scales = keys.iter().map(|key| [key.1; 3]).collect::<Vec<_>>();
        let output = model.floats(scales.into_iter(), Type::Vec3, None);
        channels.push(Channel {
            sampler: Index::new(samplers.len() as u32),
            target: Target {
                node,
                path: Valid(Property::Scale),
                extensions: None,
                extras: Default::default(),
            },
            extensions: None,
            extras: Default::default(),
        });
        samplers.push(Sampler {
            input,
            output,
            interpolation: Valid(Interpolation::Step),
            extensions: None,
            extras: Default::default(),
        });
    }
    if !channels.is_empty() {
        model.root.push(Animation {
            name: Some("growth".into()),
            channels,
            samplers,
            extensions: None,
            extras: Default::default(),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn early_frames_leave_what_they_do_not_need() {
        assert_eq!(even(&[10, 100, 1000, 1000], 1110), 500);
        assert_eq!(even(&[10, 20], 100), usize::MAX);
        assert_eq!(even(&[100, 100], 100), 50);
    }
}
