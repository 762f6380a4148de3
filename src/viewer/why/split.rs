//! The split view: the same seed under another setting, beside the garden, seen from the same side.
//!
//! The twin's plants stand far away on the same meadow, out of the haze of the first; a second camera looks at them
//! just as the first looks at its own.

use std::sync::Arc;
use std::time::{Duration, Instant};

use bevy::anti_alias::fxaa::Fxaa;
use bevy::camera::Viewport;
use bevy::math::ops;
use bevy::prelude::*;
use bevy_egui::egui::{self, RichText};

use super::other::{Other, Part};
use super::twin::Twin;
use crate::assets::Library;
use crate::files::SharedTree;
use crate::plant::Snapshot;
use crate::render::{Drawn, Look, OutdoorCamera, StepFraction, Tufts};
use crate::scenario::{Fixtures, Gardener, News, Order, View};
use crate::species::Species;
use crate::species::parameter::{Parameter, Value};
use crate::viewer::scene::{beat, between, fill};
use crate::viewer::species_editor::editor;
use crate::viewer::{Course, Shown};

/// How far away the twin stands, metres.
const APART: Vec3 = Vec3::new(170.0, 0.0, 0.0);

/// Marks what belongs to the twin on screen.
#[derive(Component)]
pub struct OfTwin;

/// How long nothing more is edited before the twin is grown anew with it.
const SETTLED: Duration = Duration::from_millis(600);

/// The second garden and what it is to be.
#[derive(Resource, Default)]
pub struct Split {
    /// Whether the copy it begins from has been asked for.
    wanted: bool,
    twin: Option<Twin>,
    /// What differs, while there is a twin or one is wanted.
    other: Option<Other>,
    /// What the twin before this one showed last, until this one shows something.
    last: Option<View>,
    /// When the first garden was edited and the twin was not yet.
    edited: Option<Instant>,
    /// The parameter that may differ, and its value there.
    choice: Choice,
    error: Option<String>,
    /// What stands on screen.
    standing: Option<Arc<Fixtures>>,
    /// Seconds since the twin's last step came on screen.
    passed: f32,
    /// The part of the window that panels leave free, in physical pixels: left, top, width, height.
    pub free: Option<[u32; 4]>,
}

impl Split {
    /// Whether there is a second garden.
    pub fn is_open(&self) -> bool {
        self.twin.is_some()
    }

    /// What it shows.
    pub fn view(&self) -> Option<&View> {
        self.twin.as_ref()?.view().or(self.last.as_ref())
    }

    /// What differs there, in words; `None` if there is no second garden.
    pub fn title(&self) -> Option<String> {
        self.twin.as_ref().and(self.other.as_ref()).map(Other::title)
    }

    /// Grows a second garden beside the first, or, with `None`, ends it. Returns what to ask the first's gardener.
    pub fn set(&mut self, other: Option<Other>) -> Option<Order> {
        self.close();
        self.wanted = other.is_some();
        self.other = other;
        self.wanted.then_some(Order::Copy)
    }

    /// Takes in what the first garden's gardener tells.
    pub fn hear(&mut self, news: &News) {
        match news {
            News::Copied(copy) if self.wanted => self.begin(SharedTree::clone(copy)),
            // Another course, or another garden: the twin would no longer be one.
            News::Began { .. } => self.close(),
            News::Changed { progress, .. } if self.twin.is_some() && progress.present == 0 => self.close(),
            News::Changed { .. } if self.twin.is_some() => self.edited = Some(Instant::now()),
            _ => {}
        }
    }

    fn begin(&mut self, copy: SharedTree) {
        self.wanted = false;
        let Some(other) = &self.other else { return };
        match Twin::begin(copy, other, Library::embedded()) {
            Ok(twin) => {
                self.last = self.view().cloned();
                (self.twin, self.error) = (Some(twin), None);
            }
            Err(why) => self.error = Some(why.to_string()),
        }
    }

    /// Ends it.
    pub fn close(&mut self) {
        (self.twin, self.last, self.standing, self.edited) = (None, None, None, None);
        (self.wanted, self.other, self.error) = (false, None, None);
    }

    /// The choice of what differs.
    pub fn choose(&mut self, ui: &mut egui::Ui, now: &View, orders: &mut Vec<Order>) {
        let mut chosen = None;
        let mut offer = |ui: &mut egui::Ui, name: &str, help: &str, other: Other| {
            let open = self.other.as_ref() == Some(&other);
            if ui.selectable_label(open, name).on_hover_text(help).clicked() {
                chosen = Some((!open).then_some(other));
            }
        };
        ui.label(RichText::new("The same seed beside it, without").weak());
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            for (part, name) in Part::ALL {
                let help = "The same seed with this switch turned over, grown beside it";
                offer(ui, name, help, Other::Part(part, !part.runs(now.standing.mechanisms)));
            }
            offer(ui, "walls", "The same seed where no wall, ball or pillar stands", Other::WithoutSolids);
            offer(ui, "lamps", "The same seed where no lamp stands", Other::WithoutLamps);
        });
        ui.label(RichText::new("or with another").weak());
        ui.horizontal_wrapped(|ui| {
            if let Some(other) = self.choice.show(ui, &now.shot) {
                let help = "The same seed with this value from the beginning, grown beside it";
                offer(ui, "Grow beside", help, other);
            }
        });
        if let Some(chosen) = chosen {
            orders.extend(self.set(chosen));
        }
        if let Some(error) = &self.error {
            ui.colored_label(ui.visuals().error_fg_color, error);
        }
    }
}

/// A parameter of a species and a value that it might have.
#[derive(Default)]
struct Choice {
    species: String,
    parameter: Option<&'static Parameter>,
    value: Option<Value>,
}

impl Choice {
    /// Lets one choose; gives what was chosen, if it is another value than the plants have.
    fn show(&mut self, ui: &mut egui::Ui, shot: &Snapshot) -> Option<Other> {
        let mut kinds: Vec<&Arc<Species>> = Vec::new();
        for plant in shot.plants.iter().flatten() {
            if !kinds.iter().any(|kind| kind.name == plant.species.name) {
                kinds.push(&plant.species);
            }
        }
        let species = *kinds.iter().find(|kind| kind.name == self.species).or(kinds.first())?;
        if self.species != species.name {
            (self.species, self.value) = (species.name.clone(), None);
        }
        if kinds.len() > 1 {
            egui::ComboBox::from_id_salt("other species").selected_text(&self.species).show_ui(ui, |ui| {
                for kind in &kinds {
                    ui.selectable_value(&mut self.species, kind.name.clone(), &kind.name);
                }
            });
        }
        let words = |row: &Parameter| row.name.replace('_', " ");
        let text = self.parameter.map_or("parameter …".into(), words);
        egui::ComboBox::from_id_salt("other parameter").width(150.0).selected_text(text).show_ui(ui, |ui| {
            for row in Species::parameters() {
                let is = self.parameter.is_some_and(|chosen| chosen.name == row.name);
                if ui.selectable_label(is, words(row)).on_hover_text(row.help).clicked() {
                    (self.parameter, self.value) = (Some(row), None);
                }
            }
        });
        let row = self.parameter?;
        let now = species.get(row.name)?;
        let value = self.value.get_or_insert_with(|| now.clone());
        editor(ui, row, value);
        let other =
            Other::Parameter { species: self.species.clone(), parameter: row.name, value: value.clone() };
        (*value != now).then_some(other)
    }
}

/// Has the twin keep step, and grows it anew when the first was edited.
pub fn follow_twin(
    mut split: ResMut<Split>,
    shown: Res<Shown>,
    course: Res<Course>,
    gardener: Option<Res<Gardener>>,
) {
    let split = split.bypass_change_detection();
    let (Some(twin), Some(view)) = (&mut split.twin, &shown.view) else { return };
    let mut there = twin.follow(view.step, course.progress.present).is_ok();
    if split.edited.is_some_and(|edited| edited.elapsed() > SETTLED) {
        (split.edited, split.wanted) = (None, true);
        there &= gardener.is_some_and(|gardener| gardener.order(Order::Copy).is_ok());
    }
    if !there {
        split.close();
        split.error = Some(format!("beside it: {}", crate::scenario::Gone));
    }
}

/// Shows the twin, or takes it away.
pub fn show_twin(
    mut commands: Commands,
    mut split: ResMut<Split>,
    shown: Res<Shown>,
    course: Res<Course>,
    time: Res<Time<Real>>,
    windows: Query<&Window>,
    first: Query<(&Transform, &Projection), (With<OutdoorCamera>, Without<OfTwin>)>,
    mut camera: Query<(&mut Camera, &mut Transform, &mut Projection), (With<OutdoorCamera>, With<OfTwin>)>,
    mut drawn: Query<(&mut Drawn, &mut StepFraction, &mut Look), With<OfTwin>>,
    tufts: Query<(), (With<OfTwin>, With<Tufts>)>,
    all: Query<Entity, With<OfTwin>>,
) {
    let split = split.bypass_change_detection();
    let Some(view) = split.view().cloned() else {
        all.iter().for_each(|entity| commands.entity(entity).despawn());
        return;
    };
    match drawn.single_mut() {
        Ok((mut drawn, mut fraction, mut look)) => {
            if !Arc::ptr_eq(&drawn.now, &view.shot) {
                let grew = view.step == drawn.now.step + 1;
                split.passed = if grew { 0.0 } else { f32::INFINITY };
                match grew {
                    true => drawn.step_to(view.shot.clone()),
                    false => *drawn = Drawn::still(view.shot.clone()),
                }
            }
            split.passed += time.delta_secs();
            fraction.set_if_neq(between(split.passed, time.delta_secs(), beat(&course)));
            look.set_if_neq(Look { overlay: shown.overlay, ghost: None, fill: fill(&view) });
        }
        Err(_) => {
            let plants = Drawn::still(view.shot.clone());
            commands.spawn((OfTwin, plants, StepFraction(1.0), Transform::from_translation(APART)));
            commands.spawn((OfTwin, Tufts, Transform::from_translation(APART)));
        }
    }
    if !split.standing.as_ref().is_some_and(|there| Arc::ptr_eq(there, &view.standing)) {
        let stays =
            |entity: Entity| camera.contains(entity) || drawn.contains(entity) || tufts.contains(entity);
        for entity in all.iter().filter(|entity| !stays(*entity)) {
            commands.entity(entity).despawn();
        }
        let moved = |at: Transform| at.with_translation(at.translation + APART);
        for solid in &view.standing.solids {
            commands.spawn((OfTwin, solid.thing, moved(solid.transform())));
        }
        for lamp in &view.standing.lamps {
            commands.spawn((OfTwin, lamp.thing, moved(lamp.transform())));
        }
        split.standing = Some(view.standing.clone());
    }
    let (Ok(window), Ok((from, lens))) = (windows.single(), first.single()) else { return };
    let whole = UVec2::new(window.physical_width().max(2), window.physical_height().max(2));
    let [left, top, width, height] = split.free.unwrap_or([0, 0, whole.x, whole.y]);
    let half = UVec2::new((width / 2).max(1), height.max(1));
    let corner = UVec2::new((left + width).saturating_sub(half.x), top);
    if (corner + half).cmpgt(whole).any() {
        return;
    }
    let viewport = Viewport { physical_position: corner, physical_size: half, ..default() };
    let Projection::Perspective(lens) = lens else { return };
    // As large as the first sees its own: the same metres a pixel.
    let tan = ops::tan(0.5 * lens.fov);
    let fov = 2.0 * ops::atan(tan * half.y as f32 / whole.y as f32);
    let lens = Projection::Perspective(PerspectiveProjection { fov, ..lens.clone() });
    // What the first shows in the middle of its half is in the middle here.
    let middle = Vec2::new(left as f32 + 0.25 * width as f32, top as f32 + 0.5 * height as f32);
    let off = (middle - 0.5 * whole.as_vec2()) * 2.0 * tan / whole.y as f32;
    let toward = (*from.forward() + *from.right() * off.x - *from.up() * off.y).normalize_or(*from.forward());
    let stand = Transform::from_translation(from.translation + APART).looking_to(toward, from.up());
    match camera.single_mut() {
        Ok((mut camera, mut at, mut projection)) => {
            camera.viewport = Some(viewport);
            *at = stand;
            *projection = lens;
        }
        Err(_) => {
            let camera = Camera { order: 3, viewport: Some(viewport), ..default() };
            commands.spawn((OfTwin, OutdoorCamera, camera, lens, stand, Msaa::Off, Fxaa::default()));
        }
    }
}
