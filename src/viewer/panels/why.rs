//! The panel at the right: what colours mean, which parts of the model run, why an organ is as it is.

use bevy::color::ColorToPacked;
use bevy_egui::egui::{self, Ui};

use super::Seen;
use crate::plant::{LateralBudState, LeafState, OrganState, Snapshot};
use crate::render::Overlay;
use crate::viewer::act::Action;
use crate::viewer::state::Chosen;
use crate::viewer::style;

pub(super) fn why(ui: &mut Ui, seen: &Seen, act: &mut impl FnMut(Action)) {
    ui.heading("Colours");
    ui.horizontal_wrapped(|ui| {
        if ui.selectable_label(seen.shown.overlay.is_none(), "own").clicked() {
            act(Action::Colour(None));
        }
        for overlay in Overlay::ALL {
            let name = format!("{overlay:?}").to_lowercase();
            if ui.selectable_label(seen.shown.overlay == Some(overlay), name).clicked() {
                act(Action::Colour(Some(overlay)));
            }
        }
    });
    if let Some(overlay) = seen.shown.overlay {
        legend(ui, overlay);
    }
    ui.add_space(8.0);
    mechanisms(ui, seen, act);
    ui.add_space(8.0);
    ui.heading("Why");
    let (Chosen::Organ(birth), Some(view)) = (seen.chosen, &seen.shown.view) else {
        ui.weak("Click a bud, a leaf or a branch.");
        return;
    };
    match view.shot.index_of(*birth) {
        Some(i) => organ(ui, &view.shot, i),
        None => {
            ui.colored_label(style::RUST, format!("Organ {birth} is not there at this step."));
        }
    }
}

/// Which parts of the model run.
fn mechanisms(ui: &mut Ui, seen: &Seen, act: &mut impl FnMut(Action)) {
    let Some(view) = &seen.shown.view else { return };
    ui.heading("The tree feels");
    let mut mechanisms = view.standing.mechanisms;
    let mut changed = false;
    ui.horizontal(|ui| {
        changed |=
            ui.checkbox(&mut mechanisms.light, "light").on_hover_text("Light steers and feeds").changed();
        changed |=
            ui.checkbox(&mut mechanisms.space, "space").on_hover_text("Buds keep out of the way").changed();
        changed |=
            ui.checkbox(&mut mechanisms.energy, "energy").on_hover_text("Growth has to be earned").changed();
    });
    if changed {
        act(Action::Mechanisms(mechanisms));
    }
}

/// The colours of an overlay, low to high.
fn legend(ui: &mut Ui, overlay: Overlay) {
    let (rect, _) = ui.allocate_exact_size(egui::vec2(ui.available_width(), 10.0), egui::Sense::hover());
    let steps = 48;
    for i in 0..steps {
        let at = |k: i32| rect.left() + rect.width() * k as f32 / steps as f32;
        let color = bevy::prelude::Srgba::from(Overlay::color(i as f32 / (steps - 1) as f32)).to_u8_array();
        let cell = egui::Rect::from_x_y_ranges(at(i)..=at(i + 1) + 0.5, rect.y_range());
        ui.painter().rect_filled(cell, 0.0, egui::Color32::from_rgb(color[0], color[1], color[2]));
    }
    let (low, high) = match overlay {
        Overlay::Light => ("dark", "full light"),
        Overlay::Space => ("crowded", "free"),
        Overlay::Energy => ("nothing", "most of all"),
        Overlay::Radius => ("1 mm", "1 m"),
        Overlay::Age => ("new", "64 steps"),
        Overlay::Order => ("trunk", "order 7"),
    };
    ui.horizontal(|ui| {
        ui.weak(low);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| ui.weak(high));
    });
}

/// What is known of an organ.
fn organ(ui: &mut Ui, shot: &Snapshot, i: usize) {
    let exposure = &shot.exposure[i];
    let flow = &shot.flow[i];
    let mut rows: Vec<(&str, String)> = Vec::new();
    let (name, word) = match &shot.state[i] {
        OrganState::Internode(wood, node) => {
            rows.push(("length", format!("{:.1} cm", 100.0 * wood.length)));
            rows.push(("diameter", format!("{:.1} mm", 2000.0 * wood.radius)));
            let word = match node {
                Some(_) => "Ends in a node: leaves and side buds sit here.",
                None => "Not long enough for a node yet.",
            };
            ("Internode", word.to_string())
        }
        OrganState::ApicalBud(bud, _, target) => {
            rows.push(("nodes on its axis", bud.nodes.to_string()));
            rows.push(("fitness of its aim", format!("{:.2}", target.fitness)));
            let word = if bud.starved > 0 {
                format!("Has had no energy for {} steps.", bud.starved)
            } else if exposure.light < 0.15 {
                "Stands in deep shade.".into()
            } else {
                "Grows towards the best light and room it found.".into()
            };
            ("Apical bud", word)
        }
        OrganState::LateralBud(bud, _) => {
            rows.push(("dormancy left", format!("{} steps", bud.dormancy)));
            let word = match bud.state {
                LateralBudState::Dormant if bud.dormancy > 0 => {
                    "Rests until its dormancy has passed in light."
                }
                LateralBudState::Dormant => "Could break, if it is given energy.",
                LateralBudState::Growing => "Has broken and become a shoot.",
                LateralBudState::Dead => "Died.",
            };
            ("Lateral bud", word.into())
        }
        OrganState::Leaf(leaf) => {
            rows.push(("unfolded", format!("{:.0} %", 100.0 * leaf.size)));
            let word = match leaf.state {
                LeafState::Growing => "Still unfolding.",
                LeafState::Terminated => "Full grown.",
            };
            ("Leaf", word.into())
        }
    };
    ui.strong(format!("{name} {}", shot.birth[i]));
    ui.label(word);
    let wood = matches!(shot.state[i], OrganState::Internode(..));
    if !wood {
        bar(ui, "light", exposure.light, style::AMBER);
        bar(ui, "space", exposure.space, style::SKY);
    }
    rows.push(("born in step", shot.span[i].born().to_string()));
    rows.push(("order", shot.order[i].to_string()));
    if !wood {
        rows.push(("energy for the next step", format!("{:.2}", shot.allotment[i])));
    }
    if flow.income > 0.0 {
        rows.push(("earned", format!("{:.2}", flow.income)));
    }
    rows.push(("upkeep", format!("{:.3}", flow.upkeep)));
    let heading = shot.pose[i].heading();
    rows.push(("from upright", format!("{:.0}°", heading.y.clamp(-1.0, 1.0).acos().to_degrees())));
    egui::Grid::new("organ").num_columns(2).spacing([14.0, 3.0]).show(ui, |ui| {
        for (name, value) in rows {
            ui.weak(name);
            ui.label(value);
            ui.end_row();
        }
    });
}

fn bar(ui: &mut Ui, name: &str, value: f32, color: egui::Color32) {
    ui.horizontal(|ui| {
        ui.add_sized([40.0, 14.0], egui::Label::new(name));
        ui.add(
            egui::ProgressBar::new(value.clamp(0.0, 1.0))
                .desired_height(12.0)
                .fill(color.gamma_multiply(0.8))
                .text(egui::RichText::new(format!("{value:.2}")).small()),
        );
    });
}
