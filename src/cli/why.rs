//! `burgeon why`: why an organ is as it is.

use burgeon::environment::cube_map::CubeFace;
use burgeon::export::film::save_png;
use burgeon::growth::explain::{Outcome, fate, rows};
use burgeon::plant::{OrganKind, OrganState, Snapshot, Tombstone};
use burgeon::scenario::{Explained, Moment, Timeline, Why as Reason};
use clap::Args;
use serde::Serialize;

use super::Failure;
use super::input::{Input, library};
use super::output::{self, progress, say};

/// Grow a scenario and tell why an organ is, or went, as it did.
#[derive(Args, Debug)]
pub struct Why {
    #[command(flatten)]
    input: Input,

    /// Birth number of the organ; organs.csv lists them [default: the highest bud that will grow].
    #[arg(long, value_name = "BIRTH")]
    bud: Option<u32>,

    /// Print everything as JSON.
    #[arg(long)]
    json: bool,

    /// Also draw what it saw: six faces unfolded.
    #[arg(long, value_name = "FILE.png")]
    picture: Option<std::path::PathBuf>,

    /// Replace the picture if it is already there.
    #[arg(long, requires = "picture")]
    force: bool,
}

#[derive(Serialize)]
struct Told {
    step: u32,
    organ: u32,
    lives: bool,
    sentences: Vec<String>,
    gone: Option<Gone>,
    kind: Option<OrganKind>,
    light: Option<f32>,
    space: Option<f32>,
    energy: Option<f32>,
    /// Heading of the first new segment in the next step.
    grew: Option<[f32; 3]>,
    grew_m: Option<f32>,
    faces: Vec<Face>,
    /// The best first; the one taken is `chosen`.
    candidates: Vec<Candidate>,
    chosen: Option<usize>,
    history: Vec<Moment>,
}

#[derive(Serialize)]
struct Gone {
    step: u32,
    born: u32,
    cause: burgeon::plant::Cause,
}

#[derive(Serialize)]
struct Face {
    face: CubeFace,
    light: f32,
    share: f32,
    space: f32,
    /// Texels by row: s sky, * burning lamp, o lamp that is off, # solid, w wood, l leaf, . ground.
    seen: Vec<String>,
    /// Depth of each texel, metres, row by row; none for the sky.
    depth_m: Vec<Option<f32>>,
}

#[derive(Serialize)]
struct Candidate {
    number: u32,
    heading: [f32; 3],
    light: f32,
    space: f32,
    fitness: f32,
    terms: burgeon::environment::sense::Terms,
    barred: bool,
}

impl Why {
    /// Runs the command.
    pub fn run(&self) -> Result<(), Failure> {
        let plan = self.input.plan()?;
        output::free(self.picture.iter().cloned(), self.force)?;
        output::can_write(self.picture.iter())?;
        let library = library(&self.input.common.assets)?;
        let workers = self.input.common.workers()?;
        let mut timeline = Timeline::new(plan.resolved, plan.seed, library, workers)?;
        timeline.set_limits(self.input.common.limits());
        let bar = progress(u64::from(plan.steps), "step");
        let (mut stopped, mut lapsed) = (None, None);
        while timeline.present() < plan.steps && stopped.is_none() {
            match timeline.advance() {
                Ok(_) => bar.inc(1),
                Err(why) => stopped = Some(why),
            }
            // `grow` stops at an edit that cannot be made; so does this.
            if let Some((edit, why)) = timeline.lapsed().next() {
                lapsed = Some((edit.step, why.to_owned()));
                break;
            }
        }
        bar.finish_and_clear();
        let step = lapsed.as_ref().map_or(timeline.present(), |(step, _)| *step);
        let birth = self.bud.or_else(|| highest_bud(&timeline.now())).unwrap_or_default();
        // What comes of it shows in the step after; a limit that stands in its way hides only that.
        let _ = timeline.advance();
        let Explained { why, picture, tombstone, .. } = Explained::of(&timeline, step, birth)?;
        let Some(told) =
            tell(step, birth, why.as_ref(), tombstone.filter(|t| why.is_none() || t.died <= step))
        else {
            let organs = timeline.shot(step).map_or(0, |shot| shot.len());
            return Err(Failure::NoSuchOrgan { birth, step, organs });
        };
        if let (Some(path), Some(picture)) = (&self.picture, picture) {
            save_png(path, &picture)?;
        }
        if self.json {
            // Numbers and texts always serialise.
            say(serde_json::to_string_pretty(&told).unwrap_or_default());
        } else {
            told.sentences.iter().for_each(say);
        }
        match (stopped, lapsed) {
            (Some(stopped), _) => Err(stopped.into()),
            (None, Some((step, why))) => Err(Failure::Lapsed { step, why }),
            (None, None) => Ok(()),
        }
    }
}

/// The highest apical bud that will grow, or else the highest of all.
fn highest_bud(shot: &Snapshot) -> Option<u32> {
    let buds = (0..shot.len()).filter(|&i| matches!(shot.state[i], OrganState::ApicalBud(..)));
    let rank = |i: &usize| (shot.allotment[*i] > 0.0, shot.pose[*i].position.y);
    let best = buds.max_by(|a, b| rank(a).0.cmp(&rank(b).0).then(rank(a).1.total_cmp(&rank(b).1)))?;
    Some(shot.birth[best])
}

fn tell(step: u32, organ: u32, why: Option<&Reason>, tombstone: Option<Tombstone>) -> Option<Told> {
    let mut sentences: Vec<String> = why.map_or_else(Vec::new, |why| why.explanation.sentences(why.outcome));
    let gone = tombstone.map(|t| Gone { step: t.died, born: t.born, cause: t.cause });
    if let (None, Some(tombstone)) = (why, &tombstone) {
        sentences.push(fate(tombstone));
    }
    if sentences.is_empty() {
        return None;
    }
    let explanation = why.map(|why| &why.explanation);
    let sight = explanation.and_then(|e| e.sight.as_ref());
    let grew = why.and_then(|why| match why.outcome {
        Outcome::Grew { heading, length, .. } => Some((heading.to_array(), length)),
        _ => None,
    });
    let faces = sight.map_or_else(Vec::new, |sight| {
        let map = &sight.look.map;
        let face = |reading: &burgeon::environment::cube_map::FaceReading| Face {
            face: reading.face,
            light: reading.light,
            share: reading.share,
            space: reading.space,
            seen: rows(map, reading.face),
            depth_m: map.face(reading.face).iter().map(|t| Some(t.depth).filter(|d| d.is_finite())).collect(),
        };
        sight.faces.iter().map(face).collect()
    });
    let candidates = sight.map_or_else(Vec::new, |sight| {
        let candidate = |choice: &burgeon::environment::sense::Choice| Candidate {
            number: choice.index,
            heading: choice.heading.to_array(),
            light: choice.light,
            space: choice.space,
            fitness: choice.fitness,
            terms: sight.look.terms[choice.index as usize],
            barred: sight.look.barred[choice.index as usize],
        };
        sight.look.sensed.ranked.iter().map(candidate).collect()
    });
    Some(Told {
        step,
        organ,
        lives: why.is_some(),
        sentences,
        gone,
        kind: explanation.map(|e| e.state.kind()),
        light: explanation.map(|e| e.exposure.light),
        space: explanation.map(|e| e.exposure.space),
        energy: explanation.map(|e| e.allotment),
        grew: grew.map(|(heading, _)| heading),
        grew_m: grew.map(|(_, length)| length),
        faces,
        candidates,
        chosen: sight.and_then(|s| s.chosen),
        history: why.map_or_else(Vec::new, |why| why.history.clone()),
    })
}
