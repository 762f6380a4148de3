//! An explanation in plain sentences.

use bevy::math::{Vec3, Vec3Swizzles, ops};

use super::{Explanation, Outcome, Sight};
use crate::environment::cube_map::CubeFace;
use crate::environment::sense::{Choice, Search, Terms};
use crate::environment::trace::Seen;
use crate::growth::shoots::plan;
use crate::plant::{Cause, LateralBudState, OrganKind, OrganState, Tombstone};
use crate::tropism;

/// A number of steps in words.
fn steps(n: u32) -> String {
    if n == 1 { "1 step".into() } else { format!("{n} steps") }
}

/// The name of a kind of organ in a sentence.
fn kind(kind: OrganKind) -> &'static str {
    match kind {
        OrganKind::Internode => "piece of stem",
        OrganKind::ApicalBud => "growing tip",
        OrganKind::LateralBud => "side bud",
        OrganKind::Leaf => "leaf",
    }
}

/// Why an organ that is gone went, in a sentence.
pub fn fate(tombstone: &Tombstone) -> String {
    let Tombstone { birth, died, born, cause, .. } = tombstone;
    let why = match cause {
        Cause::Liability => "it cost more than it earned while there was not enough for all",
        Cause::SelfPruned => "its branch had earned too little for its wood for too long",
        Cause::Starved => "it had been without light or energy for longer than its species waits",
        Cause::Senescence => "it had come to the end of a leaf's life",
        Cause::Branched => "it turned into the buds of its node, which grow in its place",
        Cause::Aborted => "it died at the end of its shoot, so that the buds beside it go on",
        Cause::Pruned => "it was cut, or borne by what was cut",
        Cause::Crushed => "a solid was set on it, or on what bore it",
        Cause::Uprooted => "its plant was taken away",
    };
    let age = died.saturating_sub(*born);
    let name = kind(tombstone.kind);
    format!("Organ {birth}, a {name}, went at step {died}, {} old: {why}.", steps(age))
}

/// A way in words.
fn way(to: Vec3) -> String {
    let steep = 90.0 - ops::acos(to.y.clamp(-1.0, 1.0)).to_degrees();
    let side = match to.xz().normalize_or_zero() {
        flat if flat.length() < 0.5 || steep.abs() > 80.0 => "",
        flat => {
            const SIDES: [&str; 8] =
                ["south", "southeast", "east", "northeast", "north", "northwest", "west", "southwest"];
            let turn = ops::atan2(flat.x, flat.y) / core::f32::consts::FRAC_PI_4;
            SIDES[(turn.round() as i32).rem_euclid(8) as usize]
        }
    };
    match (steep, side) {
        (s, "") if s > 0.0 => "straight up".into(),
        (_, "") => "straight down".into(),
        (s, side) if s.abs() < 5.0 => format!("level to the {side}"),
        (s, side) if s > 0.0 => format!("{s:.0}° up to the {side}"),
        (s, side) => format!("{:.0}° down to the {side}", -s),
    }
}

impl Explanation {
    /// All of it in plain sentences; `outcome` is what became of it in the next step.
    pub fn sentences(&self, outcome: Outcome) -> Vec<String> {
        let mut told = vec![self.who()];
        match &self.state {
            OrganState::Internode(wood, _) => told.push(format!(
                "It is {:.2} m long and {:.1} mm thick, and bears {} organs, which earned {:.3} and used {:.3} energy in the last step.",
                wood.length, wood.radius * 2000.0, self.bears.organs - 1, self.bears.income, self.bears.upkeep
            )),
            OrganState::Leaf(leaf) => told.push(format!(
                "It has {:.0} % of its full size, and earned {:.3} and used {:.3} energy in the last step.",
                leaf.size * 100.0, self.flow.income, self.flow.upkeep
            )),
            OrganState::ApicalBud(..) | OrganState::LateralBud(..) => told.push(self.means()),
        }
        if let Some(sight) = &self.sight {
            told.push(self.seen(sight));
            if let Some(search) = &sight.request.search {
                told.extend(chosen(sight, search));
            }
        }
        told.extend(self.told_outcome(outcome));
        told
    }

    fn who(&self) -> String {
        let age = self.step.saturating_sub(self.born);
        format!(
            "Organ {} is a {} of {}, {} old, on an axis of order {}, at {:.2}, {:.2}, {:.2} m; it points {}.",
            self.birth,
            kind(self.state.kind()),
            self.species.name,
            steps(age),
            self.order,
            self.position.x,
            self.position.y,
            self.position.z,
            way(self.heading),
        )
    }

    /// What a bud has to grow with.
    fn means(&self) -> String {
        let given = format!("It was given {:.2} energy", self.allotment);
        match &self.state {
            OrganState::LateralBud(bud, _) => match bud.state {
                LateralBudState::Growing => "It has broken: its axis grows, the bud itself is spent.".into(),
                LateralBudState::Dead => "It is dead.".into(),
                LateralBudState::Dormant if bud.dormancy > 0 => {
                    format!("It sleeps for {} more steps in enough light.", bud.dormancy)
                }
                LateralBudState::Dormant if self.allotment > 0.0 => format!("{given}: it will break."),
                LateralBudState::Dormant => "It could break, but was given no energy, so it waits.".into(),
            },
            _ if !self.mechanisms.energy => "Energy is switched off: it has all it can use.".into(),
            OrganState::ApicalBud(bud, ..) if self.allotment <= 0.0 => format!(
                "It was given no energy, so it neither looks for a way nor grows; this is step {} without.",
                bud.starved + 1
            ),
            _ => format!("{given}, enough for {:.2} m of shoot.", plan(&self.species, self.allotment).length),
        }
    }

    fn seen(&self, sight: &Sight) -> String {
        let mut counts = [0_usize; 6];
        let mut all = 0_usize;
        for texel in CubeFace::ALL.iter().flat_map(|face| sight.look.map.face(*face)) {
            all += 1;
            let at = match texel.seen {
                Seen::Sky => 0,
                Seen::Lamp(_) => 1,
                Seen::Solid(_) => 2,
                Seen::Wood(_) => 3,
                Seen::Leaf(_) => 4,
                Seen::Ground => 5,
            };
            counts[at] += 1;
        }
        let names = ["sky", "lamps", "solids", "wood", "leaves", "ground"];
        let parts: Vec<String> = names
            .iter()
            .zip(counts)
            .filter(|(_, count)| *count > 0)
            .map(|(name, count)| format!("{:.0} % {name}", 100.0 * count as f32 / all.max(1) as f32))
            .collect();
        let who = match sight.through {
            Some(organ) => format!("Organ {organ} beside it looks around for it and"),
            None => "Looking around it".into(),
        };
        format!(
            "{who} sees {}: light {:.3}, space {:.3}.",
            parts.join(", "),
            sight.look.sensed.light,
            sight.look.sensed.space
        )
    }

    fn told_outcome(&self, outcome: Outcome) -> Option<String> {
        let bud = !matches!(self.state, OrganState::Internode(..) | OrganState::Leaf(_));
        Some(match outcome {
            Outcome::Grew { heading, length, segments } => {
                let target = match &self.state {
                    OrganState::ApicalBud(_, _, target) | OrganState::LateralBud(_, target) => target.heading,
                    _ => Vec3::ZERO,
                };
                let off = target.angle_between(heading).to_degrees();
                let kept = match off {
                    off if target == Vec3::ZERO || !off.is_finite() => String::new(),
                    off if off < 0.5 => ", just the way it had chosen".into(),
                    off if tropism::wavers(&self.species) => {
                        format!(", {off:.0}° off the way it had chosen: no shoot is quite straight")
                    }
                    off => format!(", {off:.0}° off the way it had chosen: something stood in it"),
                };
                let pieces = if segments == 1 { "1 piece".into() } else { format!("{segments} pieces") };
                format!("In the next step it grew {length:.2} m in {pieces}, {}{kept}.", way(heading))
            }
            Outcome::Stayed if bud => "In the next step it did not grow.".into(),
            Outcome::Stayed => return None,
            Outcome::Went(cause) => {
                let grave = Tombstone {
                    birth: self.birth,
                    lineage: self.lineage,
                    plant: self.plant,
                    kind: self.state.kind(),
                    born: self.born,
                    died: self.step,
                    cause,
                };
                fate(&grave)
            }
            Outcome::Unknown => return None,
        })
    }
}

/// What was chosen, and why that.
fn chosen(sight: &Sight, search: &Search) -> Vec<String> {
    let ranked = &sight.look.sensed.ranked;
    let barred = sight.look.barred.iter().filter(|barred| **barred).count();
    let mut told = vec![format!(
        "It compared {} ways within {:.0}° of its heading, {:.2} m far; {}.",
        ranked.len(),
        search.cone.to_degrees(),
        search.reach,
        match barred {
            0 => "all are open".to_string(),
            n => format!("{n} of them lead underground, into wood, or in or behind a solid"),
        }
    )];
    let Some(rank) = sight.chosen else {
        told.push("Which of them it took cannot be told from here.".into());
        return told;
    };
    let Some(choice) = ranked.get(rank) else { return told };
    let turn = search.direction(0).angle_between(choice.heading).to_degrees();
    let turned = match choice.index {
        0 => format!("It goes straight on, {}", way(choice.heading)),
        _ => format!("It turns by {turn:.0}°, {}", way(choice.heading)),
    };
    told.push(format!(
        "{turned}: fitness {:.3}, light {:.3}, space {:.3} there.",
        choice.fitness, choice.light, choice.space
    ));
    if let Some(reason) = reason(sight, choice) {
        told.push(reason);
    }
    if rank > 0 {
        told.push(format!(
            "{rank} better {} would have run into wood or another bud's new shoot.",
            if rank == 1 { "way" } else { "ways" }
        ));
    }
    told
}

/// Which terms of the fitness speak for the chosen way rather than for going straight on, or against turning.
fn reason(sight: &Sight, choice: &Choice) -> Option<String> {
    let terms = &sight.look.terms;
    let (own, straight) = (terms.get(choice.index as usize)?, terms.first()?);
    if choice.index == 0 {
        let second = sight.look.sensed.ranked.iter().find(|other| other.index != 0)?;
        let gap = choice.fitness - second.fitness;
        return Some(format!("No other way is better; the next best is {gap:.3} behind."));
    }
    let gains: [(&str, f32); 4] = [
        ("light", own.light - straight.light),
        ("space", own.space - straight.space),
        ("heading", own.heading - straight.heading),
        ("set point", own.set_point - straight.set_point),
    ];
    let told: Vec<String> = gains
        .iter()
        .filter(|(_, gain)| gain.abs() >= 0.0005)
        .map(|(name, gain)| format!("{gain:+.3} for {name}"))
        .collect();
    let sum = Terms::fitness(own) - Terms::fitness(straight);
    (!told.is_empty()).then(|| format!("Against going straight on that is {sum:+.3}: {}.", told.join(", ")))
}
