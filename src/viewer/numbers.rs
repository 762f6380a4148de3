//! The numbers panel: size, organs, energy, light and time by step, and frames a second.

use bevy::prelude::*;
use bevy_egui::egui::{self, Color32, RichText};
use egui_plot::{Line, Plot, PlotPoints, VLine};

use super::panels::bars::frame_rate;
use super::style;
use crate::plant::measure::StepRecord;
use crate::scenario::{News, Order};

/// What can be plotted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Topic {
    /// Height and crown width.
    #[default]
    Size,
    /// Organs by kind.
    Organs,
    /// Income, upkeep, growth and store.
    Energy,
    /// Mean light of leaves, and leaf area.
    Light,
    /// Milliseconds of each stage.
    Time,
}

impl Topic {
    /// All of them, with their names.
    const ALL: [(Self, &'static str); 5] = [
        (Self::Size, "Size"),
        (Self::Organs, "Organs"),
        (Self::Energy, "Energy"),
        (Self::Light, "Light"),
        (Self::Time, "Time"),
    ];

    /// Its lines: name, unit, colour and value.
    fn series(self) -> &'static [Series] {
        match self {
            Self::Size => &[
                ("height", "m", BLUE, |r| f64::from(r.form.height_m)),
                ("crown width", "m", GREEN, |r| f64::from(r.form.crown_width_m)),
                ("crown base", "m", GREY, |r| f64::from(r.form.crown_base_m)),
            ],
            Self::Organs => &[
                ("stem segments", "", BROWN, |r| f64::from(r.form.internodes)),
                ("leaves", "", GREEN, |r| f64::from(r.form.leaves)),
                ("growing tips", "", YELLOW, |r| f64::from(r.form.apical_buds)),
                ("side buds", "", RED, |r| f64::from(r.form.lateral_buds)),
            ],
            Self::Energy => &[
                ("income", "", YELLOW, |r| r.income),
                ("upkeep", "", RED, |r| r.upkeep),
                ("growth", "", GREEN, |r| r.growth),
                ("store", "", BLUE, |r| r.store),
            ],
            Self::Light => &[
                ("mean light of leaves", "", YELLOW, |r| r.form.mean_light),
                ("leaf area", "m²", GREEN, |r| r.form.leaf_area_m2),
            ],
            Self::Time => &[
                ("generate", "ms", GREEN, |r| r.seconds.generate * 1e3),
                ("update", "ms", YELLOW, |r| r.seconds.update * 1e3),
                ("sense", "ms", BLUE, |r| r.seconds.sense * 1e3),
                ("finish", "ms", GREY, |r| r.seconds.finish * 1e3),
            ],
        }
    }
}

type Series = (&'static str, &'static str, Color32, fn(&StepRecord) -> f64);

const BLUE: Color32 = Color32::from_rgb(90, 170, 230);
const GREEN: Color32 = Color32::from_rgb(120, 200, 110);
const YELLOW: Color32 = Color32::from_rgb(240, 190, 60);
const RED: Color32 = Color32::from_rgb(220, 110, 100);
const BROWN: Color32 = Color32::from_rgb(190, 140, 100);
const GREY: Color32 = Color32::from_rgb(150, 150, 150);

/// Every step in numbers, as far as the gardener has told.
#[derive(Default)]
pub struct Numbers {
    records: Vec<StepRecord>,
    topic: Topic,
    /// Whether all steps have been asked for since the course last changed.
    asked: bool,
}

impl Numbers {
    /// What to ask, if steps are missing.
    pub fn ask(&mut self, present: u32) -> Option<Order> {
        let missing = self.records.len() < present as usize;
        (missing && !std::mem::replace(&mut self.asked, true)).then_some(Order::Records)
    }

    /// Takes in what the gardener tells.
    pub fn hear(&mut self, news: &News) {
        match news {
            News::Grown(view, _) => {
                let step = view.step as usize;
                if let Some(record) = view.record
                    && step == self.records.len() + 1
                {
                    self.records.push(record);
                }
            }
            News::Changed { progress, .. } => {
                // What came after belongs to another course; another garden's steps are asked for.
                self.records.clear();
                self.asked = progress.present == 0;
            }
            News::Records(records) => {
                self.records.clone_from(records);
                self.asked = false;
            }
            _ => {}
        }
    }

    /// The panel; `step` is the one shown. Returns the step clicked at, to go there.
    pub fn show(&mut self, ui: &mut egui::Ui, step: u32, frames_a_second: Option<f64>) -> Option<u32> {
        ui.horizontal_wrapped(|ui| {
            for (topic, name) in Topic::ALL {
                ui.selectable_value(&mut self.topic, topic, name);
            }
        });
        if let Some(rate) = frames_a_second {
            ui.label(RichText::new(format!("{} frames a second", frame_rate(rate))).small().weak());
        }
        let now = step.checked_sub(1).and_then(|i| self.records.get(i as usize));
        ui.horizontal_wrapped(|ui| {
            for (name, unit, color, value) in self.topic.series() {
                let value = now.map_or("–".into(), |record| short(value(record)));
                ui.label(
                    RichText::new(format!("● {name} {value} {unit}")).small().color(style::ink(ui, *color)),
                );
            }
        });
        let mut clicked = None;
        let plot = Plot::new(("numbers", self.topic as u8))
            .height(ui.available_height().clamp(120.0, 300.0))
            .allow_drag(false)
            .allow_zoom(false)
            .allow_scroll(false)
            .include_y(0.0)
            .x_axis_label("step");
        let inks: Vec<_> =
            self.topic.series().iter().map(|(_, _, color, _)| style::ink(ui, *color)).collect();
        let faint = ui.visuals().weak_text_color();
        let shown = plot.show(ui, |plot| {
            let at = VLine::new("", f64::from(step)).color(faint);
            plot.vline(at.allow_hover(false));
            for ((name, _, _, value), color) in self.topic.series().iter().zip(inks) {
                let points: PlotPoints =
                    self.records.iter().map(|record| [f64::from(record.step), value(record)]).collect();
                plot.line(Line::new(*name, points).color(color).width(1.8));
            }
            plot.pointer_coordinate()
        });
        if shown.response.clicked()
            && let Some(point) = shown.inner
        {
            let last = self.records.len() as f64;
            clicked = Some(point.x.round().clamp(0.0, last) as u32);
        }
        clicked
    }
}

/// A number in few characters.
fn short(value: f64) -> String {
    match value.abs() {
        v if v >= 1000.0 || v.fract() == 0.0 => format!("{value:.0}"),
        v if v >= 10.0 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_missing_are_asked_for_once() {
        let mut numbers = Numbers::default();
        assert_eq!(numbers.ask(0), None);
        assert_eq!(numbers.ask(2), Some(Order::Records));
        assert_eq!(numbers.ask(2), None);
        let record = |step| StepRecord { step, ..StepRecord::default() };
        numbers.hear(&News::Records(vec![record(1), record(2)]));
        assert_eq!((numbers.records.len(), numbers.ask(2)), (2, None));
        assert_eq!(numbers.ask(3), Some(Order::Records));
    }

    #[test]
    fn every_topic_reads_a_record() {
        let record = StepRecord::default();
        for (topic, _) in Topic::ALL {
            assert!(topic.series().iter().all(|(_, _, _, value)| value(&record) == 0.0));
        }
        assert_eq!(
            (short(1234.5), short(12.34), short(3.0), short(0.123)),
            ("1234".into(), "12.3".into(), "3".into(), "0.12".into())
        );
    }
}
