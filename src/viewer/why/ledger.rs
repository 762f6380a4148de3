//! The ledger of organs that went, and why.

use bevy::prelude::*;
use bevy_egui::egui::{self, RichText};

use crate::growth::explain::fate;
use crate::plant::{Cause, OrganKind, Tombstone};
use crate::scenario::{News, Order};

/// Every cause, as people call it.
pub const CAUSES: [(Cause, &str); 9] = [
    (Cause::Liability, "cost more than it earned"),
    (Cause::SelfPruned, "poor branch"),
    (Cause::Starved, "starved"),
    (Cause::Senescence, "old leaf"),
    (Cause::Branched, "branched"),
    (Cause::Aborted, "tip died"),
    (Cause::Pruned, "cut"),
    (Cause::Crushed, "crushed"),
    (Cause::Uprooted, "uprooted"),
];

/// The name of a kind of organ.
fn kind(kind: OrganKind) -> &'static str {
    match kind {
        OrganKind::Internode => "stem",
        OrganKind::ApicalBud => "tip",
        OrganKind::LateralBud => "side bud",
        OrganKind::Leaf => "leaf",
    }
}

/// The ledger and what of it is shown.
#[derive(Default)]
pub struct Ledger {
    graves: Vec<Tombstone>,
    /// Of each cause.
    counts: [usize; CAUSES.len()],
    /// How far the timeline had come when it was asked for.
    asked: Option<u32>,
    /// Only this cause is shown.
    cause: Option<usize>,
    /// Only this kind is shown.
    only: Option<OrganKind>,
    /// Those shown, by index, the newest first.
    shown: Vec<u32>,
}

impl Ledger {
    /// What to ask, if the ledger is out of date.
    pub fn ask(&mut self, present: u32) -> Option<Order> {
        let old = self.asked.replace(present) != Some(present);
        old.then_some(Order::Fallen)
    }

    /// Takes in what the gardener tells.
    pub fn hear(&mut self, news: &News) {
        match news {
            News::Fallen(graves) => {
                self.graves.clone_from(graves);
                self.counts = CAUSES.map(|(cause, _)| graves.iter().filter(|g| g.cause == cause).count());
                self.sift();
            }
            News::Changed { .. } => self.asked = None,
            _ => {}
        }
    }

    fn sift(&mut self) {
        let wanted = |grave: &Tombstone| {
            self.cause.is_none_or(|cause| CAUSES[cause].0 == grave.cause)
                && self.only.is_none_or(|only| only == grave.kind)
        };
        let kept = self.graves.iter().enumerate().rev().filter(|(_, grave)| wanted(grave));
        self.shown = kept.map(|(i, _)| i as u32).collect();
    }

    /// The ledger. Returns the organ whose story was clicked, and the step before it went.
    pub fn show(&mut self, ui: &mut egui::Ui) -> Option<(u32, u32)> {
        let (cause, only) = (self.cause, self.only);
        ui.horizontal(|ui| {
            egui::ComboBox::from_id_salt("cause")
                .width(190.0)
                .selected_text(cause.map_or("every cause", |cause| CAUSES[cause].1))
                .show_ui(ui, |ui| {
                    ui.selectable_value(
                        &mut self.cause,
                        None,
                        format!("every cause ({})", self.graves.len()),
                    );
                    for (i, (_, name)) in CAUSES.iter().enumerate().filter(|(i, _)| self.counts[*i] > 0) {
                        let text = format!("{name} ({})", self.counts[i]);
                        ui.selectable_value(&mut self.cause, Some(i), text);
                    }
                });
            egui::ComboBox::from_id_salt("kind")
                .width(90.0)
                .selected_text(only.map_or("any organ", kind))
                .show_ui(ui, |ui| {
                    ui.selectable_value(&mut self.only, None, "any organ");
                    for of in
                        [OrganKind::Internode, OrganKind::ApicalBud, OrganKind::LateralBud, OrganKind::Leaf]
                    {
                        ui.selectable_value(&mut self.only, Some(of), kind(of));
                    }
                });
        });
        if (cause, only) != (self.cause, self.only) {
            self.sift();
        }
        if self.shown.is_empty() {
            ui.label(RichText::new("Nothing has gone that way.").weak());
            return None;
        }
        let mut picked = None;
        let height = ui.text_style_height(&egui::TextStyle::Body);
        egui::ScrollArea::vertical()
            .id_salt("graves")
            .max_height(240.0)
            .auto_shrink([false, true])
            .show_rows(ui, height, self.shown.len(), |ui, rows| {
                for grave in self.shown[rows].iter().filter_map(|&i| self.graves.get(i as usize)) {
                    let name = CAUSES.iter().find(|(cause, _)| *cause == grave.cause).map_or("", |(_, n)| n);
                    let text = format!("step {:<4} {} {}: {name}", grave.died, kind(grave.kind), grave.birth);
                    let line = ui.add(egui::Label::new(text).sense(egui::Sense::click()).truncate());
                    if line.on_hover_text(fate(grave)).clicked() {
                        picked = Some((grave.birth, grave.died));
                    }
                }
            });
        picked
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::Lineage;

    #[test]
    fn the_ledger_filters_by_cause_and_kind_the_newest_first() {
        let grave = |birth, kind, cause| Tombstone {
            birth,
            lineage: Lineage(u64::from(birth)),
            plant: 0,
            kind,
            born: 0,
            died: birth,
            cause,
        };
        let mut ledger = Ledger::default();
        assert_eq!(ledger.ask(3), Some(Order::Fallen));
        assert_eq!(ledger.ask(3), None);
        ledger.hear(&News::Fallen(vec![
            grave(1, OrganKind::Leaf, Cause::Senescence),
            grave(2, OrganKind::Leaf, Cause::Pruned),
            grave(3, OrganKind::Internode, Cause::Pruned),
        ]));
        assert_eq!(ledger.shown, [2, 1, 0]);
        ledger.cause = CAUSES.iter().position(|(cause, _)| *cause == Cause::Pruned);
        ledger.sift();
        assert_eq!(ledger.shown, [2, 1]);
        ledger.only = Some(OrganKind::Leaf);
        ledger.sift();
        assert_eq!(ledger.shown, [1]);
    }
}
