//! An organ over the steps, as small plots.

use bevy_egui::egui::{self, Color32};
use egui_plot::{Corner, Legend, Line, Plot, PlotPoints, VLine};

use crate::scenario::Moment;

/// A line of a plot: its name, its colour and its value.
type Series = (&'static str, Color32, fn(&Moment) -> f32);

const LIGHT: Color32 = Color32::from_rgb(240, 190, 60);
const SPACE: Color32 = Color32::from_rgb(90, 170, 230);
const ENERGY: Color32 = Color32::from_rgb(120, 200, 110);
const UPKEEP: Color32 = Color32::from_rgb(220, 110, 100);
const WOOD: Color32 = Color32::from_rgb(190, 140, 100);

/// Draws light and space, energy, and radius by step, as far as there is anything to see.
pub fn show(ui: &mut egui::Ui, history: &[Moment], step: u32) {
    let exposure: [Series; 2] = [("light", LIGHT, |m| m.light), ("space", SPACE, |m| m.space)];
    let energy: [Series; 3] =
        [("given", ENERGY, |m| m.energy), ("income", LIGHT, |m| m.income), ("upkeep", UPKEEP, |m| m.upkeep)];
    let radius: [Series; 1] = [("radius, mm", WOOD, |m| m.radius * 1000.0)];
    for (name, series) in [("exposure", &exposure[..]), ("energy", &energy[..]), ("radius", &radius[..])] {
        let something = series.iter().any(|(_, _, value)| history.iter().any(|m| value(m) != 0.0));
        if something {
            plot(ui, name, series, history, step);
        }
    }
}

fn plot(ui: &mut egui::Ui, id: &str, series: &[Series], history: &[Moment], step: u32) {
    Plot::new(("moments", id))
        .height(84.0)
        .legend(Legend::default().position(Corner::LeftTop))
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .show_x(false)
        .show(ui, |plot| {
            plot.vline(
                VLine::new("", f64::from(step)).color(Color32::from_white_alpha(60)).allow_hover(false),
            );
            for (name, color, value) in series {
                let points: PlotPoints =
                    history.iter().map(|moment| [f64::from(moment.step), f64::from(value(moment))]).collect();
                plot.line(Line::new(*name, points).color(*color));
            }
        });
}
