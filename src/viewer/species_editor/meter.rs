//! The stability meter: what steering lag and compensation ratio make of an error, while they are set.

use bevy_egui::egui::{self, RichText};
use egui_plot::{HLine, Line, Plot, PlotPoints};

use super::draft::Draft;
use crate::species::parameter::{ParameterError, Value};
use crate::tropism::stability::{Stability, Verdict, response, stability};
use crate::tropism::{Control, LONGEST_LAG};
use crate::viewer::style;

/// Errors larger than this, of the one disturbed by, are off the plot.
const OFF: f32 = 4.0;

/// What becomes of an error, in words.
fn words(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Fades => "Stable: an error fades without swinging.",
        Verdict::Converges => "Stable: an error swings and fades.",
        Verdict::Swings => "At the edge: an error swings by the same amount for ever.",
        Verdict::Diverges => "Unstable: an error swings ever wider.",
    }
}

/// Sub-steps after which the curve has shown what it does.
fn long_enough(read: &Stability) -> u32 {
    let swings = read.period.map_or(0.0, |period| 5.0 * period);
    // Until a hundredth is left.
    let fades = if read.factor < 1.0 { -4.6 / bevy::math::ops::ln(read.factor.max(1e-6)) } else { 0.0 };
    (swings.max(fades) as u32 + read.lag).clamp(12, 400)
}

/// Sliders, verdict, numbers and curve of the species that is edited; what came of setting a value, an error if it is not
/// allowed.
pub(super) fn show(ui: &mut egui::Ui, draft: &mut Draft) -> Option<Result<(), ParameterError>> {
    let mut set = None;
    ui.spacing_mut().slider_width = 150.0;
    let mut lag = draft.species().steering_lag;
    let slider = egui::Slider::new(&mut lag, 0..=LONGEST_LAG).text("lag, sub-steps");
    if ui.add(slider).on_hover_text("Sub-steps until a correction takes effect").changed() {
        set = Some(draft.set("steering_lag", &Value::Whole(lag)));
    }
    let mut ratio = draft.species().compensation_ratio;
    let slider = egui::Slider::new(&mut ratio, 0.1..=10.0).logarithmic(true).max_decimals(3);
    let slider = slider.clamping(egui::SliderClamping::Edits).text("ratio");
    if ui.add(slider).on_hover_text("Compensation ratio, 1 / (gain × lag); without lag 1 / gain").changed() {
        set = Some(draft.set("compensation_ratio", &Value::Real(f64::from(ratio))));
    }
    let control = Control::of(draft.species());
    let read = match stability(&control) {
        Ok(read) => read,
        Err(why) => {
            ui.colored_label(style::ink(ui, style::RUST), why.to_string());
            return set;
        }
    };
    ui.add_space(4.0);
    let color = match read.verdict {
        Verdict::Fades | Verdict::Converges => style::LEAF,
        Verdict::Swings => style::AMBER,
        Verdict::Diverges => style::RUST,
    };
    let color = style::ink(ui, color);
    ui.label(RichText::new(words(read.verdict)).color(color).strong());
    egui::Grid::new("meter").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
        let mut row = |name: &str, value: String| {
            ui.label(RichText::new(name).weak());
            ui.label(value);
            ui.end_row();
        };
        row("Ratio", format!("{:.3}, critical {:.3}", read.ratio, read.critical_ratio));
        row("Gain", format!("{:.3} a sub-step", read.gain));
        row("Period", read.period.map_or("none".into(), |period| format!("{period:.1} sub-steps")));
        row("Damping ratio", format!("{:.3}", read.damping));
        row("Error changes by", format!("× {:.3} a sub-step", read.factor));
    });
    ui.add_space(4.0);
    ui.label(RichText::new("An error of 1, by sub-step").small().weak());
    let errors = response(&control, long_enough(&read));
    let shown = errors.iter().take_while(|error| error.abs() <= OFF).count();
    let points: PlotPoints =
        errors[..shown].iter().enumerate().map(|(n, error)| [n as f64, f64::from(*error)]).collect();
    Plot::new("response")
        .height(130.0)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .include_y(-1.0)
        .include_y(1.0)
        .y_axis_min_width(24.0)
        .show(ui, |plot| {
            plot.hline(HLine::new("", 0.0).color(egui::Color32::GRAY).allow_hover(false));
            plot.line(Line::new("error", points).color(color).width(1.8));
        });
    if control.integral != 0.0 || control.derivative != 0.0 {
        let note = "The curve has integral and derivative control in it, the verdict and numbers have not.";
        ui.label(RichText::new(note).small().weak());
    }
    set
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_is_long_enough_to_show_what_becomes_of_an_error() {
        for (lag, ratio) in [(0, 1.0), (0, 30.0), (1, 0.9), (4, 0.75), (4, 3.0), (10, 1.0), (30, 0.7)] {
            let control = Control::of_ratio(ratio, lag).unwrap();
            let read = stability(&control).unwrap();
            let errors = response(&control, long_enough(&read));
            let late = errors[errors.len() * 3 / 4..].iter().fold(0.0_f32, |most, e| most.max(e.abs()));
            match read.verdict {
                Verdict::Fades => assert!(late < 0.1, "lag {lag}, ratio {ratio}: {late}"),
                Verdict::Converges => assert!(late < 1.0, "lag {lag}, ratio {ratio}: {late}"),
                Verdict::Swings | Verdict::Diverges => {
                    assert!(late > 1.0, "lag {lag}, ratio {ratio}: {late}");
                }
            }
        }
    }
}
