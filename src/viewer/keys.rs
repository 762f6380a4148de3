//! What keys do.

use bevy::prelude::*;
use bevy_egui::input::EguiWantsInput;

use super::act::Action;
use super::files::{Ask, Files};
use super::panels::Panels;
use super::state::{Chosen, Course, Doomed, Kind, Past, Snapping, Tool, ViewFrom};
use crate::scenario::Order;

/// Keys, for the help: what to press, what it does.
pub(super) const KEYS: &[(&str, &str)] = &[
    ("Space", "grow, or stop"),
    (".", "one step"),
    ("Left, Right", "a step back, a step on"),
    ("End", "back to growth"),
    ("F", "bring the plants into the picture"),
    ("1  3  7", "look from the front, the side, above"),
    ("V  C", "choose and move; cut branches"),
    ("W  B  P  L  T", "set a wall, ball, pillar, lamp or tree: click on the ground"),
    ("O", "the sun: choose it, or have one rise"),
    ("G  R  S", "move, turn or scale the wall or lamp that is chosen"),
    ("M", "set things down on the ground near it, or not; Alt or Ctrl while dragging: not now"),
    ("Shift+click", "choose a whole plant"),
    ("E", "sow the chosen plant again elsewhere, from its seed: what has grown cannot be carried"),
    ("Ctrl+D  Delete", "copy, remove what is chosen; a copy of a plant grows from another seed"),
    ("Ctrl+Z  Ctrl+Shift+Z", "undo, redo"),
    ("Ctrl+S  Ctrl+Shift+S", "save, save elsewhere"),
    ("Ctrl+O", "open; or drop a file on the window"),
    ("H", "show or fold the panels"),
    ("Ctrl +  Ctrl -  Ctrl 0", "larger or smaller words and panels"),
    ("?", "this help"),
    ("Drag, right drag, wheel", "turn, move and bring nearer the camera"),
];

pub(super) fn keys(
    input: Res<ButtonInput<KeyCode>>,
    egui: Res<EguiWantsInput>,
    course: Res<Course>,
    past: Res<Past>,
    files: Res<Files>,
    chosen: Res<Chosen>,
    snapping: Res<Snapping>,
    mut gizmo: ResMut<bevy::gizmos::transform_gizmo::TransformGizmoSettings>,
    mut panels: ResMut<Panels>,
    mut doomed: ResMut<Doomed>,
    mut actions: MessageWriter<Action>,
) {
    use bevy::gizmos::transform_gizmo::TransformGizmoMode as Mode;
    if egui.wants_any_keyboard_input() || files.is_open() {
        return;
    }
    let control = input.any_pressed([
        KeyCode::ControlLeft,
        KeyCode::ControlRight,
        KeyCode::SuperLeft,
        KeyCode::SuperRight,
    ]);
    let shift = input.any_pressed([KeyCode::ShiftLeft, KeyCode::ShiftRight]);
    let step = past.0.unwrap_or(course.progress.present);
    for key in input.get_just_pressed() {
        let action = match (key, control) {
            (KeyCode::KeyZ, true) if shift => Action::Tell(Order::Redo),
            (KeyCode::KeyZ, true) => Action::Tell(Order::Undo),
            (KeyCode::KeyY, true) => Action::Tell(Order::Redo),
            (KeyCode::KeyS, true) if shift => Action::Ask(Ask::Garden),
            (KeyCode::KeyS, true) => files.save(),
            (KeyCode::KeyO, true) => Action::Ask(Ask::Open),
            (KeyCode::KeyD, true) => Action::Duplicate,
            (_, true) => continue,
            (KeyCode::Space, _) => {
                Action::Tell(if course.progress.playing { Order::Pause } else { Order::Play })
            }
            (KeyCode::Period, _) => Action::Tell(Order::Step),
            (KeyCode::ArrowLeft, _) => Action::Look(Some(step.saturating_sub(1))),
            (KeyCode::ArrowRight, _) if past.0.is_some() => {
                Action::Look(Some(step + 1).filter(|next| *next < course.progress.present))
            }
            (KeyCode::ArrowRight, _) => Action::Tell(Order::Step),
            (KeyCode::End, _) => Action::Look(None),
            (KeyCode::Delete | KeyCode::Backspace, _) => Action::Delete,
            (KeyCode::KeyF, _) => Action::Frame,
            (KeyCode::Digit1 | KeyCode::Numpad1, _) => Action::From(ViewFrom::Front),
            (KeyCode::Digit3 | KeyCode::Numpad3, _) => Action::From(ViewFrom::Side),
            (KeyCode::Digit7 | KeyCode::Numpad7, _) => Action::From(ViewFrom::Top),
            (KeyCode::KeyV, _) => Action::Take(Tool::Choose),
            (KeyCode::KeyC, _) => Action::Take(Tool::Prune),
            (KeyCode::KeyW, _) => Action::Take(Tool::Place(Kind::Wall)),
            (KeyCode::KeyB, _) => Action::Take(Tool::Place(Kind::Ball)),
            (KeyCode::KeyP, _) => Action::Take(Tool::Place(Kind::Pillar)),
            (KeyCode::KeyL, _) => Action::Take(Tool::Place(Kind::Lamp)),
            (KeyCode::KeyT, _) => Action::Take(Tool::Place(Kind::Plant(panels.species))),
            (KeyCode::KeyO, _) => Action::Sun,
            (KeyCode::KeyM, _) => Action::Snapping(!snapping.0),
            (KeyCode::KeyE, _) => match *chosen {
                Chosen::Plant(plant) => Action::Take(Tool::Resow(plant)),
                _ => continue,
            },
            (KeyCode::KeyG, _) => {
                gizmo.mode = Mode::Translate;
                continue;
            }
            (KeyCode::KeyR, _) => {
                gizmo.mode = Mode::Rotate;
                continue;
            }
            (KeyCode::KeyS, _) => {
                gizmo.mode = Mode::Scale;
                continue;
            }
            (KeyCode::KeyH, _) => {
                panels.open = !panels.open;
                continue;
            }
            (KeyCode::Slash | KeyCode::F1, _) => {
                panels.help = !panels.help;
                continue;
            }
            (KeyCode::Escape, _) => {
                panels.help = false;
                doomed.0.clear();
                actions.write(Action::Take(Tool::Choose));
                Action::Choose(Chosen::Nothing)
            }
            _ => continue,
        };
        actions.write(action);
    }
}
