//! Everything that explains, measures, edits species and exports, in one panel with tabs.

use std::path::PathBuf;

use bevy::diagnostic::{DiagnosticsStore, FrameTimeDiagnosticsPlugin};
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_egui::egui::{self, RichText};

use super::split::{self, Split};
use super::{WhyPanel, candidates, ledger::Ledger, legend};
use crate::scenario::{News, Order};
use crate::viewer::files::{Ask, Files};
use crate::viewer::leave::{Leave, take_screenshot};
use crate::viewer::numbers::Numbers;
use crate::viewer::species_editor::SpeciesEditor;
use crate::viewer::{Action, Chosen, Course, Shown, Toasts};

/// Adds what the panel needs; its host calls [`Answers::hear`] with all news and [`Inspector::show`] where there is
/// room.
pub struct InspectorPlugin;

impl Plugin for InspectorPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<FrameTimeDiagnosticsPlugin>() {
            app.add_plugins(FrameTimeDiagnosticsPlugin::default());
        }
        app.init_resource::<Answers>().init_resource::<Split>().add_systems(
            Update,
            (ask, candidates::draw_candidates, take_screenshot, split::follow_twin, split::show_twin).chain(),
        );
    }
}

/// What the panel can show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tab {
    /// Why the chosen organ is as it is, what organs are coloured by, which parts of the model run.
    Why,
    /// What went, and why.
    Ledger,
    /// Every step in numbers.
    Numbers,
    /// The species' parameters.
    Species,
    /// Pictures, films, files, codes.
    Leave,
}

impl Tab {
    /// All of them, with their names and what they are for.
    pub const ALL: [(Self, &'static str, &'static str); 5] = [
        (Self::Why, "Why", "Why an organ is as it is, and what it sees"),
        (Self::Ledger, "Gone", "Which organs went, and why"),
        (Self::Numbers, "Numbers", "Size, organs, energy, light and time by step"),
        (Self::Species, "Species", "Every parameter of the plants' species"),
        (Self::Leave, "Export", "Pictures, films, models, tables, codes"),
    ];
}

/// What the gardener has told for the panels, and how they stand. One resource, so that news have one place to go.
#[derive(Resource)]
pub struct Answers {
    /// Of the chosen organ.
    pub why: WhyPanel,
    /// Of those that went.
    pub ledger: Ledger,
    /// Of every step.
    pub numbers: Numbers,
    /// Of what was written.
    pub leave: Leave,
    /// The species editor.
    pub species: SpeciesEditor,
    /// What is open.
    pub tab: Tab,
    /// What was done on the panel, to be passed on.
    actions: Vec<Action>,
    /// Whether a switch of the model counts from the beginning.
    regrow: bool,
    /// An organ of the ledger that is looked at: its birth, and the last step it lived through.
    buried: Option<(u32, u32)>,
}

impl Default for Answers {
    fn default() -> Self {
        Self {
            why: default(),
            ledger: default(),
            numbers: default(),
            leave: default(),
            species: default(),
            tab: Tab::Why,
            actions: Vec::new(),
            regrow: false,
            buried: None,
        }
    }
}

impl Answers {
    /// Takes in what the gardener tells.
    pub fn hear(&mut self, news: &News) {
        self.why.hear(news);
        self.ledger.hear(news);
        self.numbers.hear(news);
        self.leave.hear(news);
    }
}

/// Asks the gardener for what is on the open tab and not yet known.
pub fn ask(
    mut answers: ResMut<Answers>,
    shown: Res<Shown>,
    course: Res<Course>,
    chosen: Res<Chosen>,
    mut actions: MessageWriter<Action>,
) {
    let present = course.progress.present;
    let mut orders = Vec::new();
    let answers = answers.bypass_change_detection();
    if chosen.is_changed()
        && let Chosen::Organ(_) = *chosen
    {
        // Whoever clicks an organ wants to know.
        answers.tab = Tab::Why;
        answers.buried = None;
    }
    let organ = match (&*chosen, answers.buried) {
        (Chosen::Organ(birth), _) => Some((*birth, shown.view.as_ref().map_or(present, |view| view.step))),
        (_, buried) => buried,
    };
    match answers.tab {
        Tab::Why | Tab::Ledger => {
            let step = organ.map_or(present, |(_, step)| step);
            orders.extend(answers.why.ask(organ.map(|(birth, _)| birth), step, present));
            if answers.tab == Tab::Ledger {
                orders.extend(answers.ledger.ask(present));
            }
        }
        Tab::Numbers => orders.extend(answers.numbers.ask(present)),
        _ => {}
    }
    answers.species.watch(std::time::Instant::now(), &mut orders);
    give(orders, &mut answers.actions);
    actions.write_batch(answers.actions.drain(..));
}

/// Passes orders on; an edit without a step goes the way of all edits, to the step on screen.
fn give(orders: Vec<Order>, actions: &mut Vec<Action>) {
    actions.extend(orders.into_iter().map(|order| match order {
        Order::Edit { step: None, edit, drag: false } => Action::Edit(edit),
        Order::Edit { step: None, edit, drag: true } => Action::Drag(edit),
        order => Action::Tell(order),
    }));
}

/// All that the panel reads and writes.
#[derive(SystemParam)]
pub struct Inspector<'w> {
    answers: ResMut<'w, Answers>,
    split: ResMut<'w, Split>,
    diagnostics: Option<Res<'w, DiagnosticsStore>>,
}

impl Inspector<'_> {
    /// Frames a second, over the last two seconds or so.
    pub fn frames_a_second(&self) -> Option<f64> {
        let frame = self.diagnostics.as_ref()?.get(&FrameTimeDiagnosticsPlugin::FRAME_TIME)?;
        frame.average().filter(|ms| *ms > 0.0).map(|ms| 1000.0 / ms)
    }

    /// Tabs, and what is on the open one.
    pub fn show(&mut self, ui: &mut egui::Ui, shown: &Shown, course: &Course) {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            for (tab, name, help) in Tab::ALL {
                let open = self.answers.tab == tab;
                if ui.selectable_label(open, name).on_hover_text(help).clicked() {
                    self.answers.tab = tab;
                }
            }
        });
        ui.separator();
        self.contents(ui, self.answers.tab, shown, course);
    }

    /// Does with a file what it was asked for.
    pub(in crate::viewer) fn chosen(
        &mut self,
        files: &mut Files,
        ask: Ask,
        path: PathBuf,
        toasts: &mut Toasts,
    ) -> Option<Action> {
        files.chosen(ask, path, &mut self.answers, toasts)
    }

    /// Tells the twin where it may be seen, beside panels of these sizes, logical pixels. Returns the width it takes.
    pub fn make_room(
        &mut self,
        context: &egui::Context,
        left: f32,
        right: f32,
        top: f32,
        bottom: f32,
    ) -> f32 {
        let whole = context.viewport_rect();
        let (width, height) = (whole.width() - left - right, whole.height() - top - bottom);
        let scale = context.pixels_per_point();
        let pixels = |x: f32| (x.max(0.0) * scale) as u32;
        self.split.free = Some([pixels(left), pixels(top), pixels(width), pixels(height)]);
        let half = 0.5 * width.max(0.0);
        if let Some(title) = self.split.title() {
            // Beside the seam: the twin's half lies over all that is drawn there.
            let at = egui::pos2(left + half - 6.0, top + 46.0);
            let area = egui::Area::new("twin".into()).fixed_pos(at).pivot(egui::Align2::RIGHT_TOP);
            area.interactable(false).show(context, |ui| {
                egui::Frame::window(&context.global_style())
                    .inner_margin(egui::Margin::symmetric(10, 5))
                    .show(ui, |ui| ui.weak(format!("{title} ▶")));
            });
        }
        if self.split.is_open() { half } else { 0.0 }
    }

    fn contents(&mut self, ui: &mut egui::Ui, tab: Tab, shown: &Shown, course: &Course) {
        let Some(view) = &shown.view else {
            ui.spinner();
            return;
        };
        let rate = self.frames_a_second();
        let mut orders = Vec::new();
        let answers = &mut *self.answers;
        let scroll = egui::ScrollArea::vertical().auto_shrink([false, false]);
        match tab {
            Tab::Why => {
                scroll.show(ui, |ui| {
                    colours(ui, shown, &mut answers.actions);
                    ui.add_space(4.0);
                    ui.label(RichText::new("What the model reckons with").strong());
                    legend::switches(ui, view.standing.mechanisms, &mut answers.regrow, &mut orders);
                    self.split.choose(ui, view, &mut orders);
                    ui.separator();
                    answers.why.show(ui);
                });
            }
            Tab::Ledger => {
                if let Some((birth, died)) = answers.ledger.show(ui) {
                    answers.buried = Some((birth, died));
                    answers.actions.push(Action::Choose(Chosen::Nothing));
                }
                ui.separator();
                scroll.show(ui, |ui| answers.why.show(ui));
            }
            Tab::Numbers => {
                if let Some(step) = answers.numbers.show(ui, view.step, rate) {
                    answers.actions.push(Action::Look(Some(step)));
                }
            }
            Tab::Species => answers.species.show(ui, &view.shot, &mut orders, &mut answers.actions),
            Tab::Leave => {
                let (leave, actions) = (&mut answers.leave, &mut answers.actions);
                scroll.show(ui, |ui| leave.show(ui, &course.scenario, view.step, &mut orders, actions));
            }
        }
        give(orders, &mut self.answers.actions);
    }
}

/// What organs are coloured by.
fn colours(ui: &mut egui::Ui, shown: &Shown, actions: &mut Vec<Action>) {
    ui.label(RichText::new("Colour organs by").strong());
    let mut overlay = shown.overlay;
    legend::choose(ui, &mut overlay);
    if overlay != shown.overlay {
        actions.push(Action::Colour(overlay));
    }
}
