//! What users can do, and how it is done.

use std::path::PathBuf;

use bevy::prelude::*;

use super::files::Ask;
use super::ground::settled;
use super::state::{Chosen, Course, Kind, Past, Shown, Snapping, Toasts, Tool, ViewFrom};
use crate::assets::Library;
use crate::environment::{Ground, SolidShape};
use crate::growth::Mechanisms;
use crate::render::Overlay;
use crate::scenario::{
    Edit, Fixtures, Gardener, Order, PlacedLamp, PlacedSolid, PlacedSun, Planting, is_covered,
};

/// Something a user does.
#[derive(Message, Debug, Clone, PartialEq)]
pub enum Action {
    /// Tell the gardener something as it is.
    Tell(Order),
    /// Begin another scenario.
    Begin(String),
    /// Look at a step of the past, or at growth again.
    Look(Option<u32>),
    /// Draw the course before the last edit of the past beside the new one, or not.
    Ghost(bool),
    /// Set a thing on a point of the ground.
    Place(Kind, Vec3),
    /// Make an edit.
    Edit(Edit),
    /// Make an edit that goes on with the last, as a drag does.
    Drag(Edit),
    /// Cut an organ and all it bears, by birth number.
    Prune(u32),
    /// Let go of a solid or lamp at a place; near the ground it is set down on it, if that is wanted.
    Drop {
        /// Its name.
        name: String,
        /// Where it is let go of.
        place: Transform,
        /// Whether it is set down.
        snap: bool,
    },
    /// Set things down on the ground when they are let go of near it, or do not.
    Snapping(bool),
    /// Choose the sun; one rises if there is none.
    Sun,
    /// Take out a plant and sow it again on a point of the ground: the same seed, grown anew.
    Resow(u32, Vec3),
    /// Set a copy of what is chosen beside it; of a plant, sow another seed of its species there.
    Duplicate,
    /// Take away what is chosen: a thing, the sun, a plant, or a branch with all it bears.
    Delete,
    /// Choose.
    Choose(Chosen),
    /// Take a tool.
    Take(Tool),
    /// Switch parts of the model.
    Mechanisms(Mechanisms),
    /// Colour organs by something.
    Colour(Option<Overlay>),
    /// Bring the plants into the picture.
    Frame,
    /// Look from somewhere.
    From(ViewFrom),
    /// Save a picture of the window.
    Picture(PathBuf),
    /// Ask for a file, and do with it what it is asked for.
    Ask(Ask),
    /// No longer offer a session that was cut short, by its save.
    Dismiss(PathBuf),
}

/// What is said when the gardener takes no more orders.
pub(super) const GONE: &str = "growth has ended; start the program again";

impl Action {
    /// Whether another course of growth begins with it.
    pub(super) fn begins_anew(&self) -> bool {
        use Order::{Begin, Load, LoadCode, Restart, Seed};
        let anew = |order: &Order| matches!(order, Restart | Seed(_) | Load(_) | LoadCode(_) | Begin(..));
        match self {
            Self::Begin(_) => true,
            Self::Tell(order) => anew(order),
            _ => false,
        }
    }
}

/// Numbers given to things that users set, so that names are unique.
#[derive(Resource, Debug, Default)]
pub struct Names(u32);

impl Names {
    fn free(&mut self, kind: &str, shown: &Shown) -> String {
        let taken = |name: &str| {
            let standing = [&shown.head, &shown.view].into_iter().flatten().map(|view| &view.standing);
            standing.into_iter().any(|standing| {
                standing.solids.iter().any(|s| s.name == name)
                    || standing.lamps.iter().any(|l| l.name == name)
            })
        };
        loop {
            self.0 += 1;
            let name = format!("{kind} {}", self.0);
            if !taken(&name) {
                return name;
            }
        }
    }
}

/// Does what users did.
pub(super) fn act(
    mut actions: MessageReader<Action>,
    gardener: Option<Res<Gardener>>,
    library: Option<Res<OwnLibrary>>,
    mut shown: ResMut<Shown>,
    course: Res<Course>,
    mut past: ResMut<Past>,
    mut chosen: ResMut<Chosen>,
    mut tool: ResMut<Tool>,
    mut toasts: ResMut<Toasts>,
    mut names: ResMut<Names>,
    mut snapping: ResMut<Snapping>,
    ground: Option<Res<Ground>>,
) {
    let Some(gardener) = gardener else { return };
    for action in actions.read() {
        let order = |order: Order| gardener.order(order).is_ok();
        // An edit while the past is on screen belongs to the step that is seen.
        let edit = |edit: Edit, drag: bool, past: &mut Past| {
            let step = past.0.take();
            order(Order::Edit { step, edit, drag })
        };
        let standing = shown.view.as_ref().map(|view| view.standing.clone());
        let sent = match action.clone() {
            Action::Tell(told) => {
                // What is loaded may be refused: then all stays as it is.
                if action.begins_anew() && !matches!(told, Order::Load(_) | Order::LoadCode(_)) {
                    (past.0, *chosen) = (None, Chosen::Nothing);
                }
                order(told)
            }
            Action::Begin(name) => {
                let library = library.as_ref().map_or_else(Library::embedded, |own| own.0.clone());
                match library.scenario(&name) {
                    Ok(resolved) => {
                        (past.0, *chosen) = (None, Chosen::Nothing);
                        order(Order::Begin(Box::new(resolved), course.progress.seed))
                    }
                    Err(why) => {
                        toasts.warn(why);
                        true
                    }
                }
            }
            Action::Look(step) => {
                past.0 = step.filter(|step| *step != course.progress.present);
                shown.live = past.0.is_none();
                match past.0 {
                    Some(step) => order(Order::Seek(step)),
                    None => {
                        if let Some(head) = shown.head.clone() {
                            show(&mut shown, head, false);
                        }
                        true
                    }
                }
            }
            Action::Ghost(on) => {
                shown.with_ghost = on;
                if !on {
                    shown.ghost = None;
                }
                true
            }
            Action::Place(kind, at) => {
                let (name, made) = thing(kind, at, &mut names, &shown, library.as_deref());
                *chosen = match name {
                    Some(name) => Chosen::Thing(name),
                    None => next_plant(&shown),
                };
                *tool = Tool::Choose;
                edit(made, false, &mut past)
            }
            Action::Edit(change) => edit(change, false, &mut past),
            Action::Drag(change) => edit(change, true, &mut past),
            Action::Prune(birth) => match cut(&shown, birth) {
                Some(cut) => {
                    *chosen = Chosen::Nothing;
                    edit(cut, false, &mut past)
                }
                None => true,
            },
            Action::Drop { name, place, snap } => {
                let shape = standing.as_ref().and_then(|standing| shape_of(standing, &name));
                let ground = ground.as_ref().map_or(Ground::default().0, |ground| ground.0).filter(|_| snap);
                let mut place = place;
                if let (Some(shape), Some(ground)) = (shape, ground) {
                    place.translation.y = settled(shape, &place, ground);
                }
                edit(Edit::posing(name, &place), false, &mut past)
            }
            Action::Snapping(on) => {
                snapping.0 = on;
                true
            }
            Action::Sun => {
                *chosen = Chosen::Sun;
                let up = standing.is_none_or(|standing| standing.sun.is_some());
                up || edit(Edit::Sun(Some(PlacedSun::default())), false, &mut past)
            }
            Action::Resow(plant, at) => {
                *tool = Tool::Choose;
                match planted(&shown, plant, course.progress.seed) {
                    Some(was) => {
                        *chosen = next_plant(&shown);
                        let step = past.0.take();
                        let makes = |edit| order(Order::Edit { step, edit, drag: false });
                        // As the gardener counts, numbers of plants are never given again.
                        makes(Edit::Uproot { plant }) && makes(Edit::Plant(Planting { at, ..was }))
                    }
                    None => true,
                }
            }
            Action::Duplicate => match (&*chosen, &standing) {
                (Chosen::Plant(plant), Some(standing)) => {
                    match planted(&shown, *plant, course.progress.seed) {
                        Some(was) => {
                            let at = beside(was.at, &shown, standing);
                            *chosen = next_plant(&shown);
                            let seed = fresh_seed(&shown);
                            edit(Edit::Plant(Planting { at, seed, ..was }), false, &mut past)
                        }
                        None => true,
                    }
                }
                (Chosen::Thing(name), Some(standing)) => {
                    let lamp = standing.lamps.iter().find(|l| l.name == *name).map(|l| l.position);
                    let solid = standing.solids.iter().find(|s| s.name == *name).map(|s| s.position);
                    match lamp.or(solid) {
                        Some(at) => {
                            let copy = names.free(base(name), &shown);
                            let made = Edit::Duplicate {
                                name: name.clone(),
                                copy: copy.clone(),
                                to: at + Vec3::new(1.0, 0.0, 1.0),
                            };
                            *chosen = Chosen::Thing(copy);
                            edit(made, false, &mut past)
                        }
                        None => true,
                    }
                }
                _ => true,
            },
            Action::Delete => {
                let made = match &*chosen {
                    Chosen::Thing(name) => Some(Edit::Remove { name: name.clone() }),
                    Chosen::Organ(birth) => cut(&shown, *birth),
                    Chosen::Plant(plant) => {
                        planted(&shown, *plant, 0).map(|_| Edit::Uproot { plant: *plant })
                    }
                    Chosen::Sun => standing.and_then(|there| there.sun).map(|_| Edit::Sun(None)),
                    Chosen::Nothing => None,
                };
                *chosen = Chosen::Nothing;
                made.is_none_or(|made| edit(made, false, &mut past))
            }
            Action::Choose(new) => {
                *chosen = new;
                true
            }
            Action::Take(new) => {
                *tool = new;
                true
            }
            Action::Mechanisms(mechanisms) => edit(Edit::Mechanisms(mechanisms), false, &mut past),
            Action::Colour(overlay) => {
                shown.overlay = overlay;
                true
            }
            // The camera's, the window's, the dialog's and the sessions'.
            Action::Frame | Action::From(_) | Action::Picture(_) | Action::Ask(_) | Action::Dismiss(_) => {
                true
            }
        };
        if !sent {
            toasts.warn(GONE);
        }
    }
}

/// The species and scenarios of the session.
#[derive(Resource, Debug, Clone)]
pub struct OwnLibrary(pub Library);

/// Brings a view on screen.
pub(super) fn show(shown: &mut Shown, view: crate::scenario::View, grew: bool) {
    shown.view = Some(view);
    shown.grew = grew;
    shown.arrival += 1;
}

/// A name without its number.
fn base(name: &str) -> &str {
    name.trim_end_matches(|c: char| c.is_ascii_digit() || c == ' ')
}

fn thing(
    kind: Kind,
    at: Vec3,
    names: &mut Names,
    shown: &Shown,
    library: Option<&OwnLibrary>,
) -> (Option<String>, Edit) {
    let mut solid = |kind: &str, shape: SolidShape, high: f32| {
        let name = names.free(kind, shown);
        let placed = PlacedSolid { name: name.clone(), shape, at: at + Vec3::Y * high, ..default() };
        (Some(name), Edit::PlaceSolid(placed))
    };
    match kind {
        Kind::Wall => solid("wall", SolidShape::Box { size: Vec3::new(3.0, 2.0, 0.3) }, 1.0),
        Kind::Ball => solid("ball", SolidShape::Ball { radius: 0.6 }, 0.6),
        Kind::Pillar => solid("pillar", SolidShape::Cylinder { radius: 0.3, height: 2.5 }, 1.25),
        Kind::Lamp => {
            let name = names.free("lamp", shown);
            let lamp = PlacedLamp {
                name: name.clone(),
                at: at + Vec3::Y * 2.0,
                strength: 300.0,
                radius: 0.2,
                ..default()
            };
            (Some(name), Edit::PlaceLamp(lamp))
        }
        Kind::Plant(which) => {
            let library = library.map_or_else(Library::embedded, |own| own.0.clone());
            let species = library.species_names().get(which).cloned().unwrap_or_default();
            (None, Edit::Plant(Planting { species, at, seed: fresh_seed(shown), ..default() }))
        }
    }
}

fn cut(shown: &Shown, birth: u32) -> Option<Edit> {
    let shot = &shown.view.as_ref()?.shot;
    let i = shot.index_of(birth)?;
    Some(Edit::Prune { plant: shot.plant[i], lineage: shot.lineage[i].0 })
}

/// The form of a solid or lamp, not yet scaled.
pub(super) fn shape_of(standing: &Fixtures, name: &str) -> Option<SolidShape> {
    let solid = standing.solids.iter().find(|solid| solid.name == name).map(|solid| solid.thing.shape);
    let lamp = standing.lamps.iter().find(|lamp| lamp.name == name);
    solid.or(lamp.map(|lamp| SolidShape::Ball { radius: lamp.thing.radius }))
}

/// How a plant that is on screen was sown, in a run with a seed; `None` if it is gone.
fn planted(shown: &Shown, plant: u32, seed: u64) -> Option<Planting> {
    let record = shown.view.as_ref()?.shot.plants.get(plant as usize)?.as_ref()?;
    Some(Planting::of(record, seed))
}

/// The plant that is sown next.
fn next_plant(shown: &Shown) -> Chosen {
    shown.view.as_ref().map_or(Chosen::Nothing, |view| Chosen::Plant(view.shot.plants.len() as u32))
}

/// A seed that no plant sown here has.
fn fresh_seed(shown: &Shown) -> u64 {
    shown.head.as_ref().map_or(0, |head| head.shot.plants.len() as u64)
}

/// A place on the ground a step beside another where nothing stands, as far as there is one.
fn beside(at: Vec3, shown: &Shown, standing: &Fixtures) -> Vec3 {
    const APART: f32 = 1.5;
    let plants = shown.view.iter().flat_map(|view| view.shot.plants.iter().flatten());
    let roots: Vec<Vec3> = plants.map(|plant| plant.position).collect();
    let places = (1..=3).flat_map(|ring| {
        (0..8).map(move |k| {
            let (sin, cos) = bevy::math::ops::sin_cos(k as f32 * core::f32::consts::FRAC_PI_4);
            at + APART * ring as f32 * Vec3::new(cos, 0.0, sin)
        })
    });
    let free = |place: &Vec3| {
        let lonely = roots.iter().all(|root| root.distance(*place) > 0.5 * APART);
        lonely && !standing.solids.iter().any(|solid| is_covered(&solid.standing(), *place, 0.3))
    };
    let mut places = places.peekable();
    let first = places.peek().copied().unwrap_or(at);
    places.find(free).unwrap_or(first)
}
