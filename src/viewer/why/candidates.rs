//! The ways a bud compared, drawn where it stands, coloured by their fitness.

use bevy::prelude::*;
use bevy_egui::egui;

use super::inspector::{Answers, Tab};
use super::span;
use crate::environment::sense::Choice;
use crate::render::Overlay;

/// The colour of a fitness among its candidates: dark is worst, yellow best.
fn shade(ranked: &[Choice], fitness: f32) -> LinearRgba {
    let (low, high) = span(ranked);
    let at = if high > low { (fitness - low) / (high - low) } else { 1.0 };
    // The darkest end of the ramp cannot be told from a shadow.
    Overlay::color(0.25 + 0.75 * at)
}

/// The same for a panel.
pub fn color(ranked: &[Choice], fitness: f32) -> egui::Color32 {
    let [r, g, b, _] = Srgba::from(shade(ranked, fitness)).to_u8_array();
    // On a dark panel the dark end needs some light.
    let lift = |part: u8| part.max(70);
    egui::Color32::from_rgb(lift(r), lift(g), lift(b))
}

/// Draws the candidates of the selected bud and the way it takes.
pub fn draw_candidates(answers: Res<Answers>, mut gizmos: Gizmos) {
    if !matches!(answers.tab, Tab::Why | Tab::Ledger) {
        return;
    }
    let Some(explanation) = answers.why.explanation() else { return };
    let from = explanation.position;
    gizmos.sphere(from, 0.015, Color::WHITE);
    let Some(sight) = &explanation.sight else { return };
    let Some(search) = &sight.request.search else { return };
    let ranked = &sight.look.sensed.ranked;
    // Short shoots are drawn longer, so that the fan can be seen.
    let reach = search.reach.max(0.15);
    for choice in ranked {
        let to = from + choice.heading * reach;
        if sight.look.barred.get(choice.index as usize) == Some(&true) {
            gizmos.line(from, to, Color::srgba(0.8, 0.1, 0.1, 0.5));
        } else {
            gizmos.line(from, to, Color::from(shade(ranked, choice.fitness)));
            gizmos.sphere(to, 0.012, Color::from(shade(ranked, choice.fitness)));
        }
    }
    if let Some(choice) = sight.chosen.and_then(|rank| ranked.get(rank)) {
        gizmos.arrow(from, from + choice.heading * reach * 1.3, Color::WHITE).with_tip_length(0.25 * reach);
    }
}
