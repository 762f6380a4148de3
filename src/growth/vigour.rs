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

/// Demand of a lateral bud by its place in the growth unit (0 base, 1 tip): acrotony, mesotony or basitony.
pub fn acrotony(species: &Species, rank: f32) -> f32 {
    let favoured = species.favoured_rank;
    let nearness = 1.0 - (rank - favoured).abs() / favoured.max(1.0 - favoured);
    species.acrotony_base + (1.0 - species.acrotony_base) * ops::powf(nearness, species.acrotony_power)
}

/// What height leaves of a bud's growth: 1 on the ground, 0 where water no longer rises.
pub fn height_factor(species: &Species, height: f32) -> f32 {
    if species.height_limit_m <= 0.0 {
        return 1.0;
    }
    let share = (height / species.height_limit_m).clamp(0.0, 1.0);
    1.0 - ops::powf(share, species.height_limit_power)
}

/// Energy a bud is given for its vigour (in internodes): 1 and more makes a long shoot of a whole number of
/// internodes and at most `most`, rounded by `chance` (0..1); less, a short shoot; below the species' least, nothing.
/// Where height leaves `most` of less than one internode, short shoots take the place of long ones, of all below a half:
/// near its height a tree renews its leaves and hardly grows.
pub fn shoot_cost(species: &Species, vigour: f32, most: f32, chance: f32) -> f32 {
    if most <= 0.0 || vigour <= 0.0 || vigour < species.vigour_short {
        return 0.0;
    }
    let long = vigour.min(most);
    let (least, more) = match vigour {
        weak if weak < 1.0 => (0.0, 0.0),
        _ if long < 1.0 => (0.0, 2.0 * long - 1.0),
        _ => (long.floor(), long.fract()),
    };
    let whole = if chance < more { least + 1.0 } else { least };
    match whole {
        whole if whole > 0.0 => whole * internode_cost(species),
        _ if species.vigour_short < 1.0 => short_shoot_cost(species),
        _ => 0.0,
    }
}

/// Passes in which the part of buds too weak to grow is shared again, at most.
const SHARED_AGAIN: u32 = 24;

/// [`flow`], with the part of buds that stay below `least` shared again among the others, until every bud that
/// gets a part can grow with it. In a poor year few buds grow, the most vigorous, and not all of them too little.
pub fn settle(mut sinks: Vec<Sink>, total: f32, least: f32, control: impl Fn(u32) -> f32) -> Vec<f32> {
    let mut vigour = flow(&sinks, total, &control);
    for _ in 0..SHARED_AGAIN {
        let mut weak: Vec<(usize, f32)> = Vec::new();
        let mut strong = 0;
        for (i, (sink, &v)) in sinks.iter().zip(&vigour).enumerate() {
            if sink.kind == SinkKind::Bud && sink.demand > 0.0 {
                if v < least {
                    weak.push((i, v));
                } else {
                    strong += 1;
                }
            }
        }
        if strong == 0 {
            // Too little for each of them: the stronger half goes on.
            weak.sort_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
            weak.truncate(weak.len() / 2);
        }
        if weak.is_empty() {
            break;
        }
        for (i, _) in weak {
            sinks[i].kind = SinkKind::Spent;
        }
        vigour = flow(&sinks, total, &control);
    }
    vigour
}

/// Vigour that reaches every organ when `total` enters at the base.
///
/// At a fork the main axis (children of the stem's own order) gets `(1 + c) W_m / ((1 + c) W_m + (1 - c) W_l)` of it,
/// with W the demand of all each side bears and c the apical control of the order, within -1 and 1 (`2 lambda - 1` of
/// Palubicki); within a side by demand. What bears no bud that can grow draws nothing to itself, though what it gathers
/// counts for the branch it is on: all that enters comes to buds.
pub fn flow(sinks: &[Sink], total: f32, control: impl Fn(u32) -> f32) -> Vec<f32> {
    let mut demand: Vec<f32> = sinks.iter().map(|s| s.demand).collect();
    let mut grows: Vec<bool> = sinks.iter().map(|s| s.kind == SinkKind::Bud && s.demand > 0.0).collect();
    // Demand of the growing children of each stem, main axis and laterals apart.
    let mut main = vec![0.0_f32; sinks.len()];
    let mut lateral = vec![0.0_f32; sinks.len()];
    let mut root_main = 0.0;
    for i in (0..sinks.len()).rev() {
        demand[i] += main[i] + lateral[i];
        match sinks[i].parent {
            NO_PARENT if grows[i] => root_main += demand[i],
            NO_PARENT => {}
            p => {
                let p = p as usize;
                if !grows[i] {
                    demand[p] += demand[i];
                    continue;
                }
                grows[p] = true;
                let side = if sinks[i].order == sinks[p].order { &mut main } else { &mut lateral };
                side[p] += demand[i];
            }
        }
    }
    let mut vigour = vec![0.0_f32; sinks.len()];
    for i in (0..sinks.len()).filter(|&i| grows[i]) {
        vigour[i] = match sinks[i].parent {
            NO_PARENT => total * demand[i] / root_main,
            p => {
                let p = p as usize;
                let c = control(sinks[p].order);
                let (weight, side) =
                    if sinks[i].order == sinks[p].order { (1.0 + c, main[p]) } else { (1.0 - c, lateral[p]) };
                let both = (1.0 + c) * main[p] + (1.0 - c) * lateral[p];
                if both > 0.0 && side > 0.0 { vigour[p] * weight * demand[i] / both } else { 0.0 }
            }
        };
    }
    vigour
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn sink(parent: u32, order: u32, kind: SinkKind, demand: f32) -> Sink {
        Sink { parent, order, kind, demand }
    }

    /// A stem that bears a tip, and a side twig with a leaf and one bud.
    fn fork(side: SinkKind) -> Vec<Sink> {
        vec![
            sink(NO_PARENT, 0, SinkKind::Stem, 0.0),
            sink(0, 0, SinkKind::Bud, 0.5),
            sink(0, 1, SinkKind::Stem, 0.0),
            sink(2, 1, SinkKind::Spent, 3.0),
            sink(2, 1, side, 0.5),
        ]
    }

    #[test]
    fn apical_control_weighs_the_main_axis_against_its_laterals() {
        let vigour = flow(&fork(SinkKind::Bud), 10.0, |_| 0.2);
        let main = 1.2 * 0.5;
        let side = 0.8 * 3.5;
        assert!((vigour[1] - 10.0 * main / (main + side)).abs() < 1e-4);
        assert!((vigour[4] - 10.0 * side / (main + side)).abs() < 1e-4);
    }

    #[test]
    fn each_order_has_its_own_apical_control() {
        // The side twig forks once more.
        let mut sinks = fork(SinkKind::Bud);
        sinks.extend([sink(2, 2, SinkKind::Stem, 0.0), sink(5, 2, SinkKind::Bud, 0.5)]);
        sinks[3].demand = 0.0;
        let by_order = |order: u32| [0.6, -0.6, 0.0][order as usize];
        let vigour = flow(&sinks, 10.0, by_order);
        let trunk = 1.6 * 0.5 / (1.6 * 0.5 + 0.4 * 1.0);
        assert!((vigour[1] - 10.0 * trunk).abs() < 1e-4, "the trunk's holds its laterals back: {vigour:?}");
        assert!((vigour[4] - vigour[2] * 0.4 / 2.0).abs() < 1e-4, "the twig's favours its own: {vigour:?}");
    }

    #[test]
    fn a_twig_whose_buds_rest_leaves_its_part_to_others() {
        let vigour = flow(&fork(SinkKind::Spent), 10.0, |_| 0.2);
        assert_eq!(vigour[1], 10.0);
        assert_eq!(vigour[2], 0.0);
    }

    #[test]
    fn a_shoot_is_as_long_as_its_vigour_and_its_flush_allow() {
        let species = Species { vigour_short: 0.25, ..Species::default() };
        let long = |whole: f32| whole * internode_cost(&species);
        let short = short_shoot_cost(&species);
        for (vigour, most, chance, cost) in [
            (3.4, 9.0, 0.3, long(4.0)),
            (3.4, 9.0, 0.5, long(3.0)),
            (3.4, 2.0, 0.3, long(2.0)),
            (0.9, 9.0, 0.0, short),
            (0.2, 9.0, 0.0, 0.0),
            // Near the height at which water ends, a flush of one internode is now and then a short shoot.
            (3.4, 0.9, 0.7, long(1.0)),
            (3.4, 0.9, 0.9, short),
            (3.4, 0.5, 0.0, short),
            (3.4, 0.1, 0.0, short),
            (3.4, 0.0, 0.0, 0.0),
        ] {
            let got = shoot_cost(&species, vigour, most, chance);
            assert_eq!(got, cost, "vigour {vigour}, at most {most}, chance {chance}");
        }
        // Without short shoots every shoot is long.
        let species = Species { vigour_short: 1.0, ..Species::default() };
        for (vigour, most, cost) in [(0.9, 9.0, 0.0), (1.0, 9.0, long(1.0)), (3.4, 0.9, 0.0)] {
            assert_eq!(shoot_cost(&species, vigour, most, 0.9), cost, "vigour {vigour}, at most {most}");
        }
    }

    #[test]
    fn in_a_poor_year_a_few_buds_grow_and_not_all_too_little() {
        let mut sinks = vec![sink(NO_PARENT, 0, SinkKind::Stem, 0.0)];
        sinks.extend((0..100).map(|i| sink(0, 1, SinkKind::Bud, 0.3 + 0.002 * i as f32)));
        let vigour = settle(sinks, 5.0, 0.25, |_| 0.0);
        let grow = vigour[1..].iter().filter(|v| **v > 0.0).count();
        assert!((5..=20).contains(&grow), "{grow} of 100 buds share enough for 20");
        assert!(vigour[1..].iter().all(|v| *v == 0.0 || *v >= 0.25));
        assert!(vigour[100] > 0.0 && vigour[1] == 0.0, "the best lit");
    }

    prop_compose! {
        /// Any plant: every organ but the first grows from a stem before it.
        fn plants()(
            organs in prop::collection::vec((any::<prop::sample::Index>(), 0..2_u32, 0..4_u8, 0.0..1.0_f32), 1..120)
        ) -> Vec<Sink> {
            let mut sinks = vec![sink(NO_PARENT, 0, SinkKind::Stem, 0.0)];
            let mut stems = vec![0];
            for (below, order, kind, demand) in organs {
                let below = stems[below.index(stems.len())];
                let kind = match kind {
                    0 | 1 => SinkKind::Stem,
                    2 => SinkKind::Bud,
                    _ => SinkKind::Spent,
                };
                if kind == SinkKind::Stem {
                    stems.push(sinks.len());
                }
                sinks.push(sink(below as u32, sinks[below].order + order, kind, demand));
            }
            sinks
        }
    }

    proptest! {
        #[test]
        fn all_that_enters_comes_to_buds(sinks in plants(), least in 0.0..0.5_f32) {
            let some_bud = sinks.iter().any(|s| s.kind == SinkKind::Bud && s.demand > 0.0);
            for vigour in [flow(&sinks, 10.0, |_| 0.2), settle(sinks.clone(), 10.0, least, |_| 0.2)] {
                let buds = sinks.iter().zip(&vigour).filter(|(s, _)| s.kind == SinkKind::Bud);
                let arrives: f32 = buds.map(|(_, v)| v).sum();
                prop_assert!((arrives - if some_bud { 10.0 } else { 0.0 }).abs() < 1e-3, "{}", arrives);
            }
        }
    }
}
