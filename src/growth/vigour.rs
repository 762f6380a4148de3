//! Vigour: growth shared from the base up, at every fork between the main axis and its laterals
//! (Borchert & Honda 1984, as extended by Palubicki et al. 2009).

use bevy::math::ops;

use crate::plant::NO_PARENT;
use crate::species::Species;

/// What an organ is to the flow of vigour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SinkKind {
    /// A stem: passes vigour on.
    Stem,
    /// A bud that can grow.
    Bud,
    /// A leaf, or a bud that is spent: adds to demand, takes nothing.
    Spent,
}

/// An organ in the flow of vigour; parents come before what they bear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sink {
    /// Index of the organ it grows from, or [`NO_PARENT`].
    pub parent: u32,
    /// Order of its axis.
    pub order: u32,
    /// What it is.
    pub kind: SinkKind,
    /// Light it gathers.
    pub demand: f32,
}

/// Energy of one internode with its leaves.
pub fn internode_cost(species: &Species) -> f32 {
    species.node_spacing_m * species.shoot_cost + species.leaves_per_node as f32 * species.leaf_cost
}

/// Energy of a short shoot: one node on a short internode.
pub fn short_shoot_cost(species: &Species) -> f32 {
    species.short_internode * species.node_spacing_m * species.shoot_cost
        + species.leaves_per_node as f32 * species.leaf_cost
}

/// Demand of a lateral bud by its place in the growth unit (0 base, 1 tip): acrotony.
pub fn acrotony(species: &Species, rank: f32) -> f32 {
    species.acrotony_base + (1.0 - species.acrotony_base) * ops::powf(rank, species.acrotony_power)
}

/// Energy a bud is given for its vigour (in internodes): 1 and more makes a long shoot of a whole number of
/// internodes, rounded by `chance` (0..1); less, a short shoot; below the species' least, nothing.
pub fn shoot_cost(species: &Species, vigour: f32, order: u32, chance: f32) -> f32 {
    let vigour = vigour.min(species.flush_internodes.get(order));
    if vigour >= 1.0 {
        let whole = vigour.floor();
        let whole = if chance < vigour - whole { whole + 1.0 } else { whole };
        whole * internode_cost(species)
    } else if vigour >= species.vigour_short && vigour > 0.0 {
        short_shoot_cost(species)
    } else {
        0.0
    }
}

/// Passes in which the part of buds too weak to grow is shared again.
const SHARED_AGAIN: u32 = 3;

/// [`flow`], with the part of buds that stay below `least` shared again among the others.
pub fn settle(mut sinks: Vec<Sink>, total: f32, least: f32, control: impl Fn(u32) -> f32) -> Vec<f32> {
    let mut vigour = flow(&sinks, total, &control);
    for _ in 0..SHARED_AGAIN {
        let mut weak = false;
        for (sink, v) in sinks.iter_mut().zip(&vigour) {
            if sink.kind == SinkKind::Bud && *v < least && sink.demand > 0.0 {
                sink.kind = SinkKind::Spent;
                weak = true;
            }
        }
        if !weak {
            break;
        }
        let again = flow(&sinks, total, &control);
        if again.iter().zip(&sinks).all(|(v, s)| s.kind != SinkKind::Bud || *v < least) {
            break;
        }
        vigour = again;
    }
    vigour
}

/// Vigour that reaches every organ when `total` enters at the base.
///
/// At a fork the main axis (children of the stem's own order) gets `c W_m / (c W_m + (1 - c) W_l)` of it, with
/// W the demand of all each side bears and c the apical control of the order; within a side by demand.
pub fn flow(sinks: &[Sink], total: f32, control: impl Fn(u32) -> f32) -> Vec<f32> {
    let mut demand: Vec<f32> = sinks.iter().map(|s| s.demand).collect();
    // Demand of the children of each stem, main axis and laterals apart.
    let mut main = vec![0.0_f32; sinks.len()];
    let mut lateral = vec![0.0_f32; sinks.len()];
    let mut root_main = 0.0;
    for i in (0..sinks.len()).rev() {
        if sinks[i].kind == SinkKind::Stem {
            demand[i] += main[i] + lateral[i];
        }
        match sinks[i].parent {
            NO_PARENT if sinks[i].kind == SinkKind::Spent => {}
            NO_PARENT => root_main += demand[i],
            p => {
                let p = p as usize;
                if sinks[i].kind == SinkKind::Spent {
                    demand[p] += demand[i];
                } else if sinks[i].order == sinks[p].order {
                    main[p] += demand[i];
                } else {
                    lateral[p] += demand[i];
                }
            }
        }
    }
    let mut vigour = vec![0.0_f32; sinks.len()];
    for i in 0..sinks.len() {
        if sinks[i].kind == SinkKind::Spent {
            continue;
        }
        vigour[i] = match sinks[i].parent {
            NO_PARENT => {
                if root_main > 0.0 {
                    total * demand[i] / root_main
                } else {
                    0.0
                }
            }
            p => {
                let p = p as usize;
                let c = control(sinks[p].order);
                let (weight, side) =
                    if sinks[i].order == sinks[p].order { (c, main[p]) } else { (1.0 - c, lateral[p]) };
                let both = c * main[p] + (1.0 - c) * lateral[p];
                if both > 0.0 && side > 0.0 { vigour[p] * weight * demand[i] / both } else { 0.0 }
            }
        };
    }
    vigour
}
