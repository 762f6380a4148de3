//! What stands and grows here: choose it, change it, take it away.

use bevy::prelude::{Quat, Vec3};
use bevy_egui::egui::{self, Response, Ui};

use super::{Seen, bars};
use crate::environment::{Lamp, Sky};
use crate::plant::{PlantRecord, Snapshot};
use crate::scenario::{Edit, Fixture, Fixtures, PlacedSun};
use crate::viewer::act::Action;
use crate::viewer::state::{Chosen, Tool};

/// Height the list of things may take before it scrolls, points.
const LIST: f32 = 132.0;

/// What stands here; what is chosen can be changed.
pub(super) fn standing(ui: &mut Ui, seen: &Seen, act: &mut impl FnMut(Action)) {
    let Some(view) = &seen.shown.view else { return };
    let standing = &view.standing;
    ui.spacing_mut().slider_width = 120.0;
    let mut sky = standing.sky.strength;
    let field = ui.add(egui::Slider::new(&mut sky, 0.0..=1.0).text("sky"));
    let field = field.on_hover_text("How bright the sky is; 1 is a bright day");
    pull(ui, &field, Edit::Sky(Sky { strength: sky, ..standing.sky }), act);
    egui::ScrollArea::vertical().id_salt("things").max_height(LIST).show(ui, |ui| list(ui, seen, act));
    let mut snapping = seen.snapping;
    let help =
        "What is let go of near the ground, or in it, is set down on it (M); hold Alt or Ctrl for not now";
    if ui.checkbox(&mut snapping, "stand on the ground").on_hover_text(help).changed() {
        act(Action::Snapping(snapping));
    }
    match seen.chosen {
        Chosen::Thing(name) => thing(ui, standing, name, act),
        Chosen::Sun => {
            if let Some((rotation, strength)) = standing.sun {
                sun(ui, rotation, strength, act);
            }
        }
        Chosen::Plant(number) => {
            if let Some(plant) = plant_of(&view.shot, *number) {
                grown(ui, &view.shot, *number, plant, act);
            }
        }
        Chosen::Organ(birth) => {
            let number = view.shot.index_of(*birth).map(|i| view.shot.plant[i]);
            let named = number.and_then(|number| Some((number, plant_of(&view.shot, number)?)));
            if let Some((number, plant)) = named {
                ui.horizontal(|ui| {
                    ui.weak("an organ of");
                    let help = "Choose the whole plant (Shift+click)";
                    if ui.button(name_of(plant, number)).on_hover_text(help).clicked() {
                        act(Action::Choose(Chosen::Plant(number)));
                    }
                });
            }
        }
        Chosen::Nothing => {}
    }
}

/// All that can be chosen, by name.
fn list(ui: &mut Ui, seen: &Seen, act: &mut impl FnMut(Action)) {
    let Some(view) = &seen.shown.view else { return };
    let standing = &view.standing;
    let solids = standing.solids.iter().map(|solid| &solid.name);
    let things = solids.chain(standing.lamps.iter().map(|lamp| &lamp.name));
    let things = things.map(|name| (name.clone(), Chosen::Thing(name.clone())));
    let sun = standing.sun.map(|_| ("sun".to_owned(), Chosen::Sun));
    let plants = view.shot.plants.iter().enumerate().filter_map(|(number, plant)| {
        let number = number as u32;
        Some((name_of(plant.as_ref()?, number), Chosen::Plant(number)))
    });
    ui.horizontal_wrapped(|ui| {
        for (name, choice) in things.chain(sun).chain(plants) {
            let is = *seen.chosen == choice;
            if ui.selectable_label(is, name).clicked() {
                act(Action::Choose(if is { Chosen::Nothing } else { choice }));
            }
        }
    });
}

fn plant_of(shot: &Snapshot, number: u32) -> Option<&PlantRecord> {
    shot.plants.get(number as usize)?.as_ref()
}

/// A plant by its species and number, counted from 1.
fn name_of(plant: &PlantRecord, number: u32) -> String {
    format!("{} {}", plant.species.name.replace('_', " "), number + 1)
}

/// A field that was changed: the first change of a pull stands for itself, the others go on with it.
fn pull(ui: &Ui, field: &Response, edit: Edit, act: &mut impl FnMut(Action)) {
    let begun = field.id.with("pulled");
    if field.drag_started() {
        ui.data_mut(|data| data.insert_temp(begun, false));
    }
    if field.changed() {
        let goes_on = field.dragged() && ui.data(|data| data.get_temp(begun)).unwrap_or(false);
        ui.data_mut(|data| data.insert_temp(begun, true));
        act(if goes_on { Action::Drag(edit) } else { Action::Edit(edit) });
    }
}

/// A wall or a lamp.
fn thing(ui: &mut Ui, standing: &Fixtures, name: &str, act: &mut impl FnMut(Action)) {
    let lamp = standing.lamps.iter().find(|lamp| lamp.name == name);
    if let Some(lamp) = lamp {
        shine(ui, lamp, act);
    }
    let place = standing.solids.iter().find(|solid| solid.name == name).map(|solid| solid.position);
    let Some(Vec3 { x, y, z }) = place.or(lamp.map(|lamp| lamp.position)) else { return };
    ui.weak(format!("at {x:.2}, {y:.2}, {z:.2} m   G moves, R turns, S scales"));
    ui.horizontal(|ui| {
        if ui.button("Copy").on_hover_text("Set a copy beside it (Ctrl+D)").clicked() {
            act(Action::Duplicate);
        }
        if ui.button("Remove").on_hover_text("Take it away (Delete)").clicked() {
            act(Action::Delete);
        }
    });
}

fn shine(ui: &mut Ui, lamp: &Fixture<Lamp>, act: &mut impl FnMut(Action)) {
    let (mut strength, mut radius, mut on) = (lamp.thing.strength, lamp.thing.radius, lamp.thing.on);
    let name = || lamp.name.clone();
    if ui.checkbox(&mut on, "burns").changed() {
        act(Action::Edit(Edit::Switch { name: name(), on }));
    }
    let field = ui.add(egui::Slider::new(&mut strength, 1.0..=5000.0).logarithmic(true).text("strength"));
    let field = field.on_hover_text("As a multiple of a full sky's radiance");
    pull(ui, &field, Edit::Shine { name: name(), strength, radius }, act);
    let field = ui.add(egui::Slider::new(&mut radius, 0.02..=1.0).logarithmic(true).text("radius, m"));
    pull(ui, &field, Edit::Shine { name: name(), strength, radius }, act);
}

/// Where the sun stands, and how strong it is.
fn sun(ui: &mut Ui, rotation: Quat, strength: f32, act: &mut impl FnMut(Action)) {
    let mut sun = PlacedSun::of(rotation, strength);
    let slider = |value| egui::Slider::new(value, -180.0..=180.0).suffix("°").max_decimals(1);
    let field = ui.add(slider(&mut sun.azimuth_deg).text("direction"));
    let field = field.on_hover_text("Where it stands: 0 south, 90 east, -90 west, 180 north");
    pull(ui, &field, Edit::Sun(Some(sun)), act);
    let field = egui::Slider::new(&mut sun.elevation_deg, 0.0..=90.0).suffix("°").max_decimals(1);
    // A scenario may have it below the horizon.
    let field = ui.add(field.clamping(egui::SliderClamping::Edits).text("height"));
    let field = field.on_hover_text("Degrees above the horizon");
    pull(ui, &field, Edit::Sun(Some(sun)), act);
    let field = ui.add(egui::Slider::new(&mut sun.strength, 0.0..=2.0).max_decimals(2).text("strength"));
    let field = field.on_hover_text("Light it gives a leaf it reaches; 1 alone is all a leaf can use");
    pull(ui, &field, Edit::Sun(Some(sun)), act);
    if ui.button("Remove").on_hover_text("Have it set (Delete)").clicked() {
        act(Action::Delete);
    }
}

/// A plant: what it is, a sibling beside it, another place, away with it.
fn grown(ui: &mut Ui, shot: &Snapshot, number: u32, plant: &PlantRecord, act: &mut impl FnMut(Action)) {
    let organs = bars::organs(shot.plant.iter().filter(|of| **of == number).count());
    let Vec3 { x, z, .. } = plant.position;
    ui.weak(format!("{organs}, at {x:.2}, {z:.2} m, seed {}", plant.seed));
    ui.horizontal_wrapped(|ui| {
        let help = "Sow another seed of its species beside it (Ctrl+D)";
        if ui.button("Sow beside").on_hover_text(help).clicked() {
            act(Action::Duplicate);
        }
        let help = "Take it out and sow its seed where you click (E). What has grown cannot be carried: it grows \
                    anew from now on. Two edits to undo.";
        if ui.button("Sow elsewhere").on_hover_text(help).clicked() {
            act(Action::Take(Tool::Resow(number)));
        }
        let help = format!("Uproot it: {organs} go (Delete)");
        if ui.button("Uproot").on_hover_text(help).clicked() {
            act(Action::Delete);
        }
    });
}
