//! What users can do, and how it is done.

use std::path::PathBuf;

use bevy::prelude::*;

use super::files::Ask;
use super::state::{Chosen, Course, Kind, Past, Shown, Toasts, Tool, ViewFrom};
use crate::assets::Library;
use crate::environment::SolidShape;
use crate::growth::Mechanisms;
use crate::render::Overlay;
use crate::scenario::{Edit, Gardener, Order, PlacedLamp, PlacedSolid, Planting};

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
    /// Set a copy of what is chosen beside it.
    Duplicate,
    /// Take away what is chosen: a thing, or a branch with all it bears.
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
                if let Some(name) = name {
                    *chosen = Chosen::Thing(name);
                }
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
            Action::Duplicate => match (&*chosen, &standing) {
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
            // The camera's, the window's and the dialog's.
            Action::Frame | Action::From(_) | Action::Picture(_) | Action::Ask(_) => true,
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
            let sown = shown.head.as_ref().map_or(0, |head| head.shot.plants.len());
            (None, Edit::Plant(Planting { species, at, seed: sown as u64, ..default() }))
        }
    }
}

fn cut(shown: &Shown, birth: u32) -> Option<Edit> {
    let shot = &shown.view.as_ref()?.shot;
    let i = shot.index_of(birth)?;
    Some(Edit::Prune { plant: shot.plant[i], lineage: shot.lineage[i].0 })
}
