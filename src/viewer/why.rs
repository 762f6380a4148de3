//! Seeing why: what the selected organ saw, weighed and chose, what it was over time, and what became of the fallen.
//!
//! The panel asks the gardener and shows what comes back; it computes nothing itself.

pub mod candidates;
pub mod inspector;
pub mod ledger;
pub mod legend;
mod moments;
pub mod other;
pub mod split;
pub mod twin;

use bevy::prelude::*;
use bevy_egui::egui::{self, RichText, TextureHandle, TextureOptions};

use crate::environment::sense::Choice;
use crate::growth::explain::{Explanation, Outcome, Sight, fate};
use crate::plant::OrganState;
use crate::scenario::{Explained, News, Order};

/// What is known of the selected organ.
#[derive(Default)]
pub struct WhyPanel {
    /// What was asked last: step and birth, and how far the timeline had come.
    asked: Option<(u32, u32, u32)>,
    told: Option<Box<Explained>>,
    faces: Option<TextureHandle>,
}

impl WhyPanel {
    /// What to ask so that the panel tells of an organ at a step; nothing if it has been asked.
    pub fn ask(&mut self, selected: Option<u32>, step: u32, present: u32) -> Option<Order> {
        let Some(birth) = selected else {
            *self = Self::default();
            return None;
        };
        // What came of it is known only once the next step has grown.
        let known = present.min(step.saturating_add(1));
        let ask = (step, birth, known);
        if self.asked == Some(ask) {
            return None;
        }
        self.asked = Some(ask);
        Some(Order::Explain { step, birth })
    }

    /// Takes in what the gardener tells.
    pub fn hear(&mut self, news: &News) {
        match news {
            News::Explained(told) if self.asked.is_some_and(|(_, birth, _)| birth == told.birth) => {
                self.told = Some(told.clone());
                self.faces = None;
            }
            // The course has changed: what was told may no longer be so.
            News::Changed { .. } => self.asked = None,
            _ => {}
        }
    }

    /// What is known, if anything is.
    pub fn explanation(&self) -> Option<&Explanation> {
        self.told.as_ref()?.why.as_ref().map(|why| &why.explanation)
    }

    /// The panel.
    pub fn show(&mut self, ui: &mut egui::Ui) {
        let Some(told) = &self.told else {
            let hint = match self.asked {
                Some(_) => "Looking …",
                None => "Click a bud, a leaf or a branch to see why it is as it is.",
            };
            ui.label(RichText::new(hint).weak());
            return;
        };
        let told_below = told.why.as_ref().is_some_and(|why| matches!(why.outcome, Outcome::Went(_)));
        if let Some(tombstone) = told.tombstone.as_ref().filter(|_| !told_below) {
            ui.label(RichText::new(fate(tombstone)).color(ui.visuals().warn_fg_color));
        }
        let Some(why) = &told.why else {
            if told.tombstone.is_none() {
                ui.label(RichText::new("It does not live at this step.").weak());
            }
            return;
        };
        let explanation = &why.explanation;
        figures(ui, explanation);
        ui.separator();
        for sentence in explanation.sentences(why.outcome).iter().skip(1) {
            ui.label(sentence);
        }
        if let Some(sight) = &explanation.sight {
            ui.separator();
            if let Some(picture) = &told.picture {
                let faces = self.faces.get_or_insert_with(|| {
                    let size = [picture.width() as usize, picture.height() as usize];
                    let image = egui::ColorImage::from_rgb(size, picture.as_raw());
                    ui.ctx().load_texture("six faces", image, TextureOptions::LINEAR)
                });
                ui.label(RichText::new("What it sees").strong());
                let width = ui.available_width();
                let height = width * picture.height() as f32 / picture.width().max(1) as f32;
                ui.image((faces.id(), egui::vec2(width, height)));
                ui.label(
                    RichText::new(
                        "Six faces unfolded; the darker a thing, the nearer it is. Sky and lamps are light.",
                    )
                    .small()
                    .weak(),
                );
            }
            if sight.request.search.is_some() {
                egui::CollapsingHeader::new("Ways it compared")
                    .default_open(true)
                    .show(ui, |ui| ways(ui, sight));
            }
        }
        if why.history.len() > 1 {
            ui.separator();
            moments::show(ui, &why.history, explanation.step);
        }
    }
}

/// What can be told in numbers.
fn figures(ui: &mut egui::Ui, organ: &Explanation) {
    let (title, own): (&str, Vec<(&str, String)>) = match &organ.state {
        OrganState::Internode(wood, node) => (
            if node.is_some() { "Stem segment, ending in a node" } else { "Stem segment" },
            vec![
                ("Length", format!("{:.3} m", wood.length)),
                ("Radius", format!("{:.1} mm", wood.radius * 1000.0)),
                ("Bears", super::panels::bars::organs(organ.bears.organs.saturating_sub(1) as usize)),
                ("Income of all it bears", format!("{:.3}", organ.bears.income)),
                ("Upkeep of all it bears", format!("{:.3}", organ.bears.upkeep)),
            ],
        ),
        OrganState::Leaf(leaf) => (
            "Leaf",
            vec![
                ("Size", format!("{:.0} %", leaf.size * 100.0)),
                ("Income", format!("{:.3}", organ.flow.income)),
                ("Upkeep", format!("{:.3}", organ.flow.upkeep)),
            ],
        ),
        OrganState::ApicalBud(bud, ..) => (
            "Growing tip",
            vec![
                ("Energy given", format!("{:.2}", organ.allotment)),
                ("Nodes of its axis", bud.nodes.to_string()),
                ("Length of its axis", format!("{:.2} m", bud.height_in_branch)),
            ],
        ),
        OrganState::LateralBud(bud, _) => (
            "Side bud",
            vec![
                ("State", format!("{:?}", bud.state)),
                ("Sleeps for", format!("{} steps", bud.dormancy)),
                ("Energy given", format!("{:.2}", organ.allotment)),
            ],
        ),
    };
    ui.horizontal(|ui| {
        ui.label(RichText::new(title).strong());
        ui.label(RichText::new(format!("no. {} of {}", organ.birth, organ.species.name)).weak());
    });
    egui::Grid::new("figures").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
        let age = organ.step.saturating_sub(organ.born);
        let mut row = |name: &str, value: String| {
            ui.label(RichText::new(name).weak());
            ui.label(value);
            ui.end_row();
        };
        row("Age", if age == 1 { "1 step".into() } else { format!("{age} steps") });
        row("Order of its axis", organ.order.to_string());
        if organ.exposure.sensed {
            row("Light, space", format!("{:.3}, {:.3}", organ.exposure.light, organ.exposure.space));
        }
        own.into_iter().for_each(|(name, value)| row(name, value));
    });
}

/// The candidates, best first, with what their fitness is made of.
fn ways(ui: &mut egui::Ui, sight: &Sight) {
    const SHOWN: usize = 12;
    let ranked = &sight.look.sensed.ranked;
    egui::Grid::new("ways").striped(true).num_columns(6).spacing([8.0, 2.0]).show(ui, |ui| {
        for name in ["", "fitness", "light", "space", "straight", "set point"] {
            ui.label(RichText::new(name).small().weak());
        }
        ui.end_row();
        for (rank, choice) in ranked.iter().enumerate() {
            let chosen = sight.chosen == Some(rank);
            if rank >= SHOWN && !chosen {
                continue;
            }
            let barred = sight.look.barred.get(choice.index as usize) == Some(&true);
            let mark = match (chosen, barred) {
                (true, _) => "▶",
                (_, true) => "×",
                _ => "",
            };
            let color = candidates::color(ranked, choice.fitness);
            ui.label(RichText::new(format!("{mark} {}", choice.index)).color(color).strong());
            let Some(terms) = sight.look.terms.get(choice.index as usize) else { continue };
            for value in [choice.fitness, terms.light, terms.space, terms.heading, terms.set_point] {
                let text = RichText::new(format!("{value:.3}")).small();
                ui.label(if chosen { text.strong() } else { text });
            }
            ui.end_row();
        }
    });
    if ranked.len() > SHOWN {
        ui.label(RichText::new(format!("and {} worse ones", ranked.len() - SHOWN)).small().weak());
    }
}

/// The lowest and highest fitness of some candidates.
fn span(ranked: &[Choice]) -> (f32, f32) {
    let low = ranked.iter().map(|choice| choice.fitness).fold(f32::INFINITY, f32::min);
    let high = ranked.iter().map(|choice| choice.fitness).fold(f32::NEG_INFINITY, f32::max);
    (low, high)
}
