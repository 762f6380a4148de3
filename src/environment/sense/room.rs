//! Room: buds choose at the same time, each as if the others stood still. Of shoots that would grow into each
//! other, or into wood that stands, the first-born keeps its choice and the others take their next best.

use bevy::math::Vec3;

use super::Choice;
use crate::environment::Capsule;
use crate::environment::segment;
use crate::environment::stem_grid::StemGrid;

/// A bud that will grow, and where it could grow to.
#[derive(Debug, Clone, Copy)]
pub struct Wish<'a> {
    /// Where it is, metres.
    pub from: Vec3,
    /// How far it will grow, metres.
    pub reach: f32,
    /// Radius of its shoot, metres.
    pub radius: f32,
    /// Its candidates, the best first.
    pub ranked: &'a [Choice],
}

/// Share of its reach that shoots of one node keep between them.
const BETWEEN_SIBLINGS: f32 = 0.3;
/// Share of a shoot near its base that is not looked at: shoots of one node meet there.
const BASE: f32 = 0.35;

/// Which candidate each bud takes, as an index into its `ranked`; wishes in birth order.
///
/// When none of its candidates is clear, a bud takes the one with the most room.
pub fn settle(wood: &[Capsule], wishes: &[Wish]) -> Vec<usize> {
    let cell = wishes.iter().map(|w| w.reach).fold(0.05, f32::max);
    let mut room = Room(StemGrid::new(cell));
    for capsule in wood {
        room.add(Stem { from: capsule.from, to: capsule.to, radius: capsule.radius, planned: false });
    }
    wishes
        .iter()
        .map(|wish| {
            let mut roomiest = (0, f32::NEG_INFINITY);
            for (i, choice) in wish.ranked.iter().enumerate() {
                let spare = room.spare(wish, choice.heading, roomiest.1);
                if spare > roomiest.1 {
                    roomiest = (i, spare);
                }
                if spare >= 0.0 {
                    break;
                }
            }
            if let Some(choice) = wish.ranked.get(roomiest.0) {
                let to = wish.from + choice.heading * wish.reach;
                room.add(Stem { from: wish.from, to, radius: wish.radius, planned: true });
            }
            roomiest.0
        })
        .collect()
}

#[derive(Debug, Clone, Copy)]
struct Stem {
    from: Vec3,
    to: Vec3,
    radius: f32,
    planned: bool,
}

/// Stems that stand or are planned.
struct Room(StemGrid<Stem>);

impl Room {
    fn add(&mut self, stem: Stem) {
        self.0.add(stem, stem.from, stem.to, stem.radius);
    }

    /// Room left around a shoot, metres; negative where it would run into a stem. Stops looking below `enough`.
    fn spare(&self, wish: &Wish, heading: Vec3, enough: f32) -> f32 {
        let way = heading * wish.reach;
        let (from, to) = (wish.from + way * BASE, wish.from + way);
        let margin = Vec3::splat(wish.reach * BETWEEN_SIBLINGS);
        let mut spare = f32::INFINITY;
        for stem in self.0.near(from.min(to) - margin, from.max(to) + margin) {
            let sibling = stem.planned && stem.from.distance_squared(wish.from) < 1e-8;
            let (start, needed) = if sibling {
                (stem.from.lerp(stem.to, BASE), wish.reach * BETWEEN_SIBLINGS)
            } else {
                (stem.from, stem.radius + 2.0 * wish.radius)
            };
            // Wood that the bud sits on is no obstacle to it, unless the shoot turns back along it.
            let seat =
                !stem.planned && segment::gap((wish.from, wish.from), (start, stem.to)) <= stem.radius + 1e-4;
            let needed = if seat { wish.radius } else { needed };
            spare = spare.min(segment::gap((from, to), (start, stem.to)) - needed);
            if spare <= enough {
                return spare;
            }
        }
        spare
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ranked(headings: &[Vec3]) -> Vec<Choice> {
        headings
            .iter()
            .enumerate()
            .map(|(i, h)| Choice {
                heading: *h,
                fitness: -(i as f32),
                light: 1.0,
                space: 1.0,
                index: i as u32,
            })
            .collect()
    }

    #[test]
    fn lk_15_of_two_buds_that_would_meet_the_first_born_keeps_its_way() {
        let left = ranked(&[Vec3::X, Vec3::Y]);
        let right = ranked(&[Vec3::NEG_X, Vec3::Y]);
        let wish = |from: Vec3, ranked| Wish { from, reach: 1.0, radius: 0.01, ranked };
        let taken = settle(&[], &[wish(Vec3::ZERO, &left), wish(Vec3::X, &right)]);
        assert_eq!(taken, [0, 1]);
    }

    #[test]
    fn lk_15_a_shoot_does_not_grow_into_standing_wood() {
        let trunk = Capsule {
            from: Vec3::new(0.5, -1.0, 0.0),
            to: Vec3::new(0.5, 1.0, 0.0),
            radius: 0.1,
            organ: 0,
            plant: 0,
        };
        let bud = ranked(&[Vec3::X, Vec3::Z]);
        let wish = Wish { from: Vec3::ZERO, reach: 1.0, radius: 0.01, ranked: &bud };
        assert_eq!(settle(&[trunk], &[wish]), [1]);
        assert_eq!(settle(&[], &[wish]), [0]);
    }

    #[test]
    fn buds_of_one_node_part() {
        let same = ranked(&[Vec3::Y, Vec3::X]);
        let wish = Wish { from: Vec3::ZERO, reach: 0.2, radius: 0.01, ranked: &same };
        assert_eq!(settle(&[], &[wish, wish]), [0, 1]);
    }
}
