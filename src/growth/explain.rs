//! Why an organ does what it does: what it saw, what it weighed, what it chose and what came of it.
//!
//! [`explain`] looks again from where an organ stands at the end of a step, exactly as the step did, and finds among
//! the candidates the one the step settled on. It reads a snapshot and changes nothing.

mod words;

use bevy::prelude::*;

use super::Mechanisms;
use super::sensing::Lookouts;
use super::shoots::segment_lineage;
use crate::environment::cube_map::{CubeFace, CubeMap, FaceReading};
use crate::environment::probe::Sensing;
use crate::environment::sense::{Look, SenseRequest, look};
use crate::environment::trace::{Seen, Tracer};
use crate::environment::{Scene, add_plants};
use crate::growth::liabilities::Branch;
use crate::plant::{
    Cause, EnergyFlow, Exposure, Lineage, NO_PARENT, OrganKind, OrganState, Snapshot, Tombstone,
};
use crate::species::Species;

pub use words::fate;

/// What plants have around them, and how they look at it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Surroundings {
    /// What stands there, plants left out.
    pub scene: Scene,
    /// Which parts of the model run.
    pub mechanisms: Mechanisms,
    /// How they look.
    pub sensing: Sensing,
}

/// An organ at the end of a step, with all that decides what it does next.
#[derive(Debug, Clone)]
pub struct Explanation {
    /// Steps grown.
    pub step: u32,
    /// Its birth number.
    pub birth: u32,
    /// Its place in the family.
    pub lineage: Lineage,
    /// Index of its plant.
    pub plant: u32,
    /// The species of that.
    pub species: std::sync::Arc<Species>,
    /// Order of its axis.
    pub order: u32,
    /// The step it was born in.
    pub born: u32,
    /// Where it is, metres.
    pub position: Vec3,
    /// Unit vector it points along.
    pub heading: Vec3,
    /// Light and space it found.
    pub exposure: Exposure,
    /// Energy set aside for its growth.
    pub allotment: f32,
    /// What it earned and used in the last step.
    pub flow: EnergyFlow,
    /// What only its kind has.
    pub state: OrganState,
    /// What it bears, itself included.
    pub bears: Branch,
    /// What stands on the model's switchboard.
    pub mechanisms: Mechanisms,
    /// What it saw, if it looks around.
    pub sight: Option<Sight>,
}

/// What an organ saw.
#[derive(Debug, Clone)]
pub struct Sight {
    /// Its cube map, its readings and its candidates.
    pub look: Look,
    /// The birth number of the organ that looked for it: a sleeping bud takes its light from the leaf it sits by, and
    /// organs of some species share a look with others near them.
    pub through: Option<u32>,
    /// Where and how it looked.
    pub request: SenseRequest,
    /// What each face reads.
    pub faces: [FaceReading; 6],
    /// The way the bud will take: an index into its candidates from the best to the worst, 0 if nothing stood in the
    /// way of its first choice. `None` if it does not search.
    pub chosen: Option<usize>,
    /// Whether what it recorded when it looked is one of the candidates, bit for bit. It is, unless something about
    /// the surroundings was told wrong.
    pub agrees: bool,
}

/// What became of an organ in the next step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    /// It grew a shoot.
    Grew {
        /// Way of the first new segment, a unit vector.
        heading: Vec3,
        /// Length, metres.
        length: f32,
        /// Segments.
        segments: u32,
    },
    /// It is there as it was.
    Stayed,
    /// It went.
    Went(Cause),
    /// The next step is not known.
    Unknown,
}

/// What a texel shows, in a letter: `s` sky, `*` a burning lamp, `o` a lamp that is off, `#` a solid, `w` wood,
/// `l` leaf, `.` ground.
pub fn letter(seen: Seen, bright: bool) -> char {
    match seen {
        Seen::Sky => 's',
        Seen::Lamp(_) if bright => '*',
        Seen::Lamp(_) => 'o',
        Seen::Solid(_) => '#',
        Seen::Wood(_) => 'w',
        Seen::Leaf(_) => 'l',
        Seen::Ground => '.',
    }
}

/// The rows of a face from the top, a [`letter`] a texel.
pub fn rows(map: &CubeMap, face: CubeFace) -> Vec<String> {
    let row = |texels: &[crate::environment::trace::Texel]| {
        texels.iter().map(|texel| letter(texel.seen, texel.bright)).collect()
    };
    map.face(face).chunks(map.size().max(1)).map(row).collect()
}

/// Everything there is to see from a snapshot.
pub fn whole(around: &Surroundings, shot: &Snapshot) -> Scene {
    let mut scene = around.scene.clone();
    add_plants(&mut scene, shot);
    scene
}

/// Explains the organ with a birth number, looking again at what stood there when it looked. `None` if it does not
/// live.
pub fn explain(shot: &Snapshot, around: &Surroundings, birth: u32) -> Option<Explanation> {
    explain_in(shot, around, &Tracer::build(&whole(around, shot)), birth)
}

/// As [`explain`], in a scene made ready by the caller: [`whole`].
pub fn explain_in(
    shot: &Snapshot,
    around: &Surroundings,
    tracer: &Tracer,
    birth: u32,
) -> Option<Explanation> {
    let i = shot.index_of(birth)?;
    let species = shot.plants.get(shot.plant[i] as usize)?.as_ref()?.species.clone();
    let looks = around.mechanisms.light || around.mechanisms.space;
    let lookouts = looks.then(|| Lookouts::of(shot, &around.sensing, around.mechanisms));
    let sight = lookouts.and_then(|lookouts| {
        let here = lookouts.read[i]?;
        let host = lookouts.organs[here.request];
        let through = Some(host).filter(|organ| *organ != i).map(|organ| shot.birth[organ]);
        let request = lookouts.requests[here.request].clone();
        Some(Sight { through, ..sight(shot, i, around, tracer, request, here.guest) })
    });
    Some(Explanation {
        step: shot.step,
        birth,
        lineage: shot.lineage[i],
        plant: shot.plant[i],
        species,
        order: shot.order[i],
        born: shot.span[i].born(),
        position: shot.pose[i].position,
        heading: shot.pose[i].heading(),
        exposure: shot.exposure[i],
        allotment: shot.allotment[i],
        flow: shot.flow[i],
        state: shot.state[i],
        bears: bears(shot, i),
        mechanisms: around.mechanisms,
        sight,
    })
}

fn sight(
    shot: &Snapshot,
    i: usize,
    around: &Surroundings,
    tracer: &Tracer,
    request: SenseRequest,
    guest: Option<usize>,
) -> Sight {
    let look = look(tracer, &request, guest, &around.sensing);
    let faces = look.map.faces(&tracer.scene().sky, request.probe.space_range, around.sensing.weight);
    let target = match &shot.state[i] {
        OrganState::ApicalBud(_, _, target) | OrganState::LateralBud(_, target) => Some(*target),
        _ => None,
    };
    let same = |choice: &crate::environment::sense::Choice| {
        target.is_some_and(|t| t.heading == choice.heading && t.fitness == choice.fitness)
    };
    let chosen = look.sensed.ranked.iter().position(same);
    let agrees = request.search.is_none() || chosen.is_some();
    Sight { look, through: None, request, faces, chosen, agrees }
}

/// What an organ bears, itself included.
fn bears(shot: &Snapshot, i: usize) -> Branch {
    let mut within = vec![false; shot.len()];
    let mut sum = Branch::default();
    for k in i..shot.len() {
        let parent = shot.parent[k];
        within[k] = k == i || (parent != NO_PARENT && within[parent as usize]);
        if within[k] {
            let kind = shot.state[k].kind();
            sum.income += f64::from(shot.flow[k].income);
            sum.upkeep += f64::from(shot.flow[k].upkeep);
            sum.organs += 1;
            sum.internodes += u32::from(kind == OrganKind::Internode);
            sum.unsensed += u32::from(kind == OrganKind::Leaf && !shot.exposure[k].sensed);
        }
    }
    sum
}

impl Explanation {
    /// The lineage of the bud that makes the shoot: its own, or that of the axis a lateral bud begins.
    fn axis(&self) -> Lineage {
        match self.state {
            OrganState::LateralBud(..) => self.lineage.child(0),
            _ => self.lineage,
        }
    }

    /// What became of it by the next step, given that and what fell.
    pub fn outcome(&self, next: &Snapshot, fallen: &[Tombstone]) -> Outcome {
        if next.step != self.step + 1 {
            return Outcome::Unknown;
        }
        let ours = |i: &usize| next.plant[*i] == self.plant;
        let mut grown: Option<(Vec3, f32, u32)> = None;
        if !matches!(self.state, OrganState::Internode(..) | OrganState::Leaf(_)) {
            let mut k = 0;
            let mut wanted = segment_lineage(self.axis(), self.step, 0);
            // Segments of a shoot are born in order.
            for i in (0..next.len()).filter(ours) {
                if next.lineage[i] == wanted {
                    let (heading, length, _) = grown.unwrap_or((next.pose[i].heading(), 0.0, 0));
                    k += 1;
                    grown = Some((heading, length + next.length(i), k));
                    wanted = segment_lineage(self.axis(), self.step, k);
                }
            }
        }
        if let Some((heading, length, segments)) = grown {
            return Outcome::Grew { heading, length, segments };
        }
        if (0..next.len()).filter(ours).any(|i| next.lineage[i] == self.lineage) {
            return Outcome::Stayed;
        }
        let grave = |t: &&Tombstone| t.plant == self.plant && t.lineage == self.lineage;
        fallen.iter().rev().find(grave).map_or(Outcome::Unknown, |tombstone| Outcome::Went(tombstone.cause))
    }
}
