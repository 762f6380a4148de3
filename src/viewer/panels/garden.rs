//! The panel at the left: what grows and stands here, and how the tree does.

use bevy_egui::egui::{self, Ui};
use egui_plot::{Line, Plot, PlotPoints, VLine};

use super::things::standing;
use super::{Panels, Seen};
use crate::plant::measure::StepRecord;
use crate::scenario::Order;
use crate::viewer::act::Action;
use crate::viewer::state::Toasts;
use crate::viewer::style;

pub(super) fn garden(
    ui: &mut Ui,
    seen: &Seen,
    panels: &mut Panels,
    toasts: &mut Toasts,
    act: &mut impl FnMut(Action),
) {
    ui.heading("Garden");
    egui::ComboBox::from_id_salt("scenario").selected_text(&seen.course.scenario).width(150.0).show_ui(
        ui,
        |ui| {
            for name in seen.scenarios {
                if ui.selectable_label(*name == seen.course.scenario, name).clicked() {
                    act(Action::Begin(name.clone()));
                }
            }
        },
    );
    ui.horizontal(|ui| {
        ui.label("seed");
        if panels.seed.is_empty() {
            panels.seed = seen.course.progress.seed.to_string();
        }
        let field = ui.add(egui::TextEdit::singleline(&mut panels.seed).desired_width(70.0));
        if field.lost_focus() {
            match panels.seed.trim().parse() {
                Ok(seed) if seed != seen.course.progress.seed => act(Action::Tell(Order::Seed(seed))),
                Ok(_) => {}
                Err(_) => toasts.warn("a seed is a whole number"),
            }
            panels.seed.clear();
        }
        egui::ComboBox::from_id_salt("species")
            .selected_text(seen.species.get(panels.species).map_or("", String::as_str))
            .width(80.0)
            .show_ui(ui, |ui| {
                for (i, name) in seen.species.iter().enumerate() {
                    ui.selectable_value(&mut panels.species, i, name);
                }
            })
            .response
            .on_hover_text("Species that the tool Tree sows");
    });
    ui.add_space(4.0);
    standing(ui, seen, act);
    ui.add_space(8.0);
    numbers(ui, &seen.course.records, seen.past.0);
}

/// The course in numbers, and the step looked at if it is a past one.
fn numbers(ui: &mut Ui, records: &[StepRecord], past: Option<u32>) {
    let of_past = past.and_then(|step| records.iter().find(|record| record.step == step));
    let Some(shown) = of_past.or(records.last()) else { return };
    ui.heading("The tree by step");
    let form = &shown.form;
    egui::Grid::new("form").num_columns(4).spacing([10.0, 2.0]).show(ui, |ui| {
        let cell = |ui: &mut Ui, name: &str, value: String| {
            ui.weak(name);
            ui.label(value);
        };
        cell(ui, "height", format!("{:.2} m", form.height_m));
        cell(ui, "crown", format!("{:.2} m", form.crown_width_m));
        ui.end_row();
        cell(ui, "leaves", super::bars::thousands(form.leaves as usize));
        cell(ui, "buds", super::bars::thousands((form.apical_buds + form.lateral_buds) as usize));
        ui.end_row();
    });
    plot(
        ui,
        "metres",
        (records, past),
        &[
            ("height", style::LEAF, &|r| f64::from(r.form.height_m)),
            ("crown width", style::SKY, &|r| f64::from(r.form.crown_width_m)),
        ],
    );
    plot(
        ui,
        "energy",
        (records, past),
        &[
            ("income", style::AMBER, &|r| r.income),
            ("growth", style::LEAF, &|r| r.growth),
            ("upkeep", style::RUST, &|r| r.upkeep),
        ],
    );
    plot(ui, "light of leaves", (records, past), &[("light", style::AMBER, &|r| r.form.mean_light)]);
    let seconds = &shown.seconds;
    ui.weak(format!(
        "step {} took {:.0} ms: generate {:.1}, update {:.1}, sense {:.0}",
        shown.step,
        1e3 * (seconds.generate + seconds.update + seconds.sense + seconds.finish),
        1e3 * seconds.generate,
        1e3 * seconds.update,
        1e3 * seconds.sense,
    ));
}

type Value<'a> = (&'a str, egui::Color32, &'a dyn Fn(&StepRecord) -> f64);

fn plot(ui: &mut Ui, name: &str, (records, past): (&[StepRecord], Option<u32>), values: &[Value]) {
    ui.horizontal(|ui| {
        ui.weak(name);
        for (name, color, _) in values {
            ui.colored_label(style::ink(ui, *color), egui::RichText::new(*name).small());
        }
    });
    let ink = ui.visuals().weak_text_color();
    let inks: Vec<_> = values.iter().map(|(_, color, _)| style::ink(ui, *color)).collect();
    Plot::new(name)
        .height(64.0)
        .show_axes([false, true])
        .show_grid([false, true])
        .y_axis_min_width(30.0)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .include_y(0.0)
        .show(ui, |plot| {
            if let Some(step) = past {
                plot.vline(VLine::new("", f64::from(step)).color(ink).allow_hover(false));
            }
            for ((name, _, value), color) in values.iter().zip(inks) {
                let points: PlotPoints = records.iter().map(|r| [f64::from(r.step), value(r)]).collect();
                plot.line(Line::new(*name, points).color(color).width(1.6));
            }
        });
}
