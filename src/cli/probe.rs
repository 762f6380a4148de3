//! `burgeon probe`: what can be seen from a point of a grown scenario.

use std::str::FromStr;

use bevy::math::Vec3;
use burgeon::environment::cube_map::{CubeFace, CubeMap};
use burgeon::environment::sense::fitness_given_away;
use burgeon::environment::trace::Tracer;
use burgeon::environment::workers::Workers;
use burgeon::export::film::save_png;
use burgeon::export::picture::{CubeMapView, Palette, cube_map_picture};
use burgeon::files::{FARTHEST_M, RunFile, StepHashes};
use burgeon::growth::sensing::{SensingJob, gather_probes};
use burgeon::limits;
use burgeon::scenario::Garden;
use clap::Args;
use serde::Serialize;

use super::Failure;
use super::grow::Growing;
use super::input::Input;
use super::output::{Output, say};

/// Grow a scenario and look around from a point of it.
#[derive(Args, Debug)]
pub struct ProbeAt {
    #[command(flatten)]
    input: Input,

    #[command(flatten)]
    output: Output,

    /// From where: metres, y up.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, required_unless_present = "given_away")]
    at: Option<Point>,

    /// Instead, measure over all buds that will grow how much fitness is given away by comparing their candidates
    /// in one re-projected map against a map at each.
    #[arg(long, conflicts_with = "at")]
    given_away: bool,

    /// Texels along the side of a face.
    #[arg(long, default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=i64::from(limits::FACE)))]
    face_size: u32,
}

#[derive(Debug, Clone, Copy)]
struct Point(Vec3);

impl FromStr for Point {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<f32>, _> = text.split(',').map(|x| x.trim().parse()).collect();
        match numbers.as_deref() {
            Ok([x, y, z]) if [x, y, z].iter().all(|c| f64::from(c.abs()) <= FARTHEST_M) => {
                Ok(Self(Vec3::new(*x, *y, *z)))
            }
            _ => Err(format!("three numbers such as 0.5,2,-1, each within {FARTHEST_M} m")),
        }
    }
}

#[derive(Serialize)]
struct Reading<'a> {
    scenario: &'a str,
    seed: u64,
    steps: u32,
    at: [f32; 3],
    face_size: u32,
    /// Distance at which space is full.
    space_range_m: f32,
    light: f32,
    share: f32,
    space: f32,
    faces: Vec<Face>,
    picture: String,
}

#[derive(Serialize)]
struct Face {
    face: CubeFace,
    direction: [f32; 3],
    light: f32,
    share: f32,
    mean_depth_m: f32,
}

/// What comparing candidates the fast way gives away, in a grown garden.
#[derive(Serialize)]
struct GivenAwayBy {
    scenario: String,
    seed: u64,
    steps: u32,
    /// Buds that will grow.
    searches: usize,
    /// By the slow way's own measure.
    mean_fitness_given_away: f32,
    worst_fitness_given_away: f32,
    /// From the best to the worst candidate.
    mean_spread: f32,
    same_candidate: f32,
}

impl GivenAwayBy {
    fn measure(garden: &mut Garden) -> Self {
        let (scenario, seed, steps) = (garden.scenario().name.clone(), garden.seed(), garden.steps());
        let world = garden.world_mut();
        gather_probes(world);
        let (job, workers) = (world.resource::<SensingJob>(), world.resource::<Workers>());
        let given = fitness_given_away(&Tracer::build(&job.scene), &job.requests, &job.settings, workers);
        Self {
            scenario,
            seed,
            steps,
            searches: given.searches,
            mean_fitness_given_away: given.mean_loss,
            worst_fitness_given_away: given.worst_loss,
            mean_spread: given.mean_spread,
            same_candidate: given.agreement,
        }
    }
}

impl ProbeAt {
    /// Runs the command.
    pub fn run(&self) -> Result<(), Failure> {
        let plan = self.input.plan()?;
        let name = plan.resolved.scenario.name.clone();
        let files: &[&str] = if self.given_away { &[] } else { &["probe.png"] };
        let mut folder = self.output.folder(&format!("{name}_probe"), files)?;
        let mut garden = Garden::new(plan.resolved.clone(), plan.seed, self.input.common.workers()?)?;
        garden.set_limits(self.input.common.limits());
        let run = RunFile::new(&plan.resolved, plan.seed, 0, StepHashes::default());
        let mut growing = Growing { garden, run, stopped: None, seconds: 0.0 };
        growing.grow(plan.steps, |_, _| {});

        let Some(Point(at)) = self.at else {
            say(serde_json::to_string_pretty(&GivenAwayBy::measure(&mut growing.garden)).unwrap_or_default());
            return growing.stopped.map_or(Ok(()), |stopped| Err(stopped.into()));
        };
        let snapshot = growing.garden.snapshot();
        let range = snapshot.plants.iter().flatten().next().map_or(1.0, |p| p.species.space_range_m);
        let scene = growing.garden.scene();
        let tracer = Tracer::build(&scene);
        let weight = plan.resolved.scenario.sensing.weight;
        let map = CubeMap::render(&tracer, at, self.face_size, &[]);
        let view = CubeMapView { range, weight, ..CubeMapView::default() };
        let picture = cube_map_picture(&map, &tracer, &Palette::of_snapshot(&snapshot), view);
        folder.create()?;
        let path = folder.file("probe.png");
        save_png(&path, &picture)?;

        let faces = map.faces(&scene.sky, range, weight).map(|f| Face {
            face: f.face,
            direction: f.face.direction().into(),
            // No light is plain 0, not -0.
            light: f.light + 0.0,
            share: f.share,
            mean_depth_m: f.depth,
        });
        let reading = Reading {
            scenario: &name,
            seed: plan.seed,
            steps: growing.garden.steps(),
            at: at.into(),
            face_size: self.face_size,
            space_range_m: range,
            light: map.light(&tracer, &[]),
            share: map.share(weight),
            space: map.space(range, weight),
            faces: faces.into(),
            picture: path.display().to_string(),
        };
        // Numbers and texts always serialise.
        say(serde_json::to_string_pretty(&reading).unwrap_or_default());
        growing.stopped.map_or(Ok(()), |stopped| Err(stopped.into()))
    }
}
