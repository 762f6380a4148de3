//! The wood of all plants as shoots find it in their way while they extend.

use bevy::prelude::*;

use super::obstacles::{self, Advance, CLEARANCE, is_within};
use super::segment;
use super::stem_grid::StemGrid;
use super::{Capsule, StandingSolid};

/// How often a shoot that turned aside may meet the next stem and turn again.
const ROUNDS: usize = 6;
/// Cosine of the widest turn aside: 30 degrees.
const WIDEST_TURN: f32 = 0.866;

/// Wood that stands, and what has grown in this step; empty where no species minds it. A resource.
#[derive(Resource, Debug, Default, Reflect)]
#[reflect(Resource, Default)]
pub struct StandingWood(#[reflect(ignore)] Option<StemGrid<Capsule>>);

impl StandingWood {
    /// Forgets all wood; what comes is kept, in cells of that side (metres), if there is one.
    pub fn begin(&mut self, cell: Option<f32>) {
        self.0 = cell.map(StemGrid::new);
    }

    /// Whether wood that is added is kept.
    pub fn minds(&self) -> bool {
        self.0.is_some()
    }

    /// Adds a stem.
    pub fn add(&mut self, stem: Capsule) {
        if let Some(grid) = &mut self.0 {
            grid.add(stem, stem.from, stem.to, stem.radius);
        }
    }

    /// How far and where a shoot of `radius` grows among solids, ground and wood that wants to grow `length` along
    /// `heading` (metres, a unit vector): past wood with the least turn that does, else as along any
    /// [obstacle](obstacles::advance). Wood in which it begins, as at a fork, is in nobody's way.
    pub fn advance(
        &self,
        solids: &[StandingSolid],
        ground: Option<f32>,
        from: Vec3,
        heading: Vec3,
        length: f32,
        radius: f32,
    ) -> Advance {
        if let Some(course) = self.past(from, heading, length, radius) {
            let free = obstacles::advance(solids, &[], ground, from, course, length, radius);
            if free.direction == course {
                return free;
            }
            // Turned by a wall or the ground it may meet other wood.
        }
        let wood = self.reached(from, length, radius);
        obstacles::advance(solids, &wood, ground, from, heading, length, radius)
    }

    /// The course nearest to `heading` on which a shoot passes by all wood in its way, if that takes no wide turn.
    fn past(&self, from: Vec3, heading: Vec3, length: f32, radius: f32) -> Option<Vec3> {
        let mut course = heading;
        for _ in 0..ROUNDS {
            let to = from + course * length;
            let near = self.near(from.min(to), from.max(to), from, radius);
            let met = near.filter_map(|stem| Meeting::with(stem, from, to, radius));
            let Some(deepest) = met.max_by(|a, b| a.deep.total_cmp(&b.deep)) else {
                return Some(course);
            };
            course = (deepest.passes(course) - from).normalize_or(heading);
            if course.dot(heading) < WIDEST_TURN {
                break;
            }
        }
        None
    }

    /// All wood that a shoot could reach, in birth order.
    fn reached(&self, from: Vec3, length: f32, radius: f32) -> Vec<Capsule> {
        let reach = Vec3::splat(length);
        let mut reached: Vec<Capsule> =
            self.near(from - reach, from + reach, from, radius).copied().collect();
        reached.sort_by_key(|stem| stem.organ);
        reached.dedup_by_key(|stem| stem.organ);
        reached
    }

    /// Wood near a box between two corners that a shoot does not begin in.
    fn near(&self, low: Vec3, high: Vec3, from: Vec3, radius: f32) -> impl Iterator<Item = &Capsule> {
        let girth = Vec3::splat(radius + CLEARANCE);
        let stems = self.0.iter().flat_map(move |grid| grid.near(low - girth, high + girth));
        stems.filter(move |stem| !is_within(stem, from))
    }
}

/// Where a shoot would come too near to a stem.
struct Meeting {
    /// By how much, metres.
    deep: f32,
    /// How far apart the axes must be, metres.
    apart: f32,
    /// Nearest place on the shoot's axis.
    here: Vec3,
    /// Nearest place on the stem's.
    there: Vec3,
    along: Vec3,
}

impl Meeting {
    fn with(stem: &Capsule, from: Vec3, to: Vec3, radius: f32) -> Option<Self> {
        let axis = (stem.from, stem.to);
        let (here, there) = segment::nearest((from, to), axis);
        // Where it begins nearer than that, it comes no nearer.
        let apart = (stem.radius + radius + CLEARANCE).min(segment::gap((from, from), axis));
        let deep = apart - here.distance(there);
        (deep > 0.0).then_some(Self { deep, apart, here, there, along: stem.to - stem.from })
    }

    /// A place beside the stem, on the side on which the shoot would pass, to make for instead.
    fn passes(&self, course: Vec3) -> Vec3 {
        // Rounding must not leave it a hair too near.
        const ROOM: f32 = 1.02;
        let level = |v: Vec3| v - course * v.dot(course);
        let (aside, across) = (level(self.here - self.there), course.cross(self.along));
        let aside = if aside.length() > 1e-6 { aside } else { across };
        self.there
            + aside.try_normalize().unwrap_or_else(|| course.any_orthonormal_vector()) * (self.apart * ROOM)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::environment::SolidShape;
    use crate::environment::obstacles::touches;

    fn stem(organ: u32, from: Vec3, to: Vec3, radius: f32) -> Capsule {
        Capsule { from, to, radius, organ, plant: 0 }
    }

    fn standing(stems: &[Capsule]) -> StandingWood {
        let mut wood = StandingWood::default();
        wood.begin(Some(0.2));
        stems.iter().for_each(|stem| wood.add(*stem));
        wood
    }

    /// Where a shoot of 5 mm grows that wants to grow a metre east.
    fn eastwards(wood: &StandingWood) -> (Vec3, f32) {
        let got = wood.advance(&[], None, Vec3::ZERO, Vec3::X, 1.0, 0.005);
        (got.direction, got.length)
    }

    #[test]
    fn a_shoot_grows_round_a_twig_with_the_least_turn() {
        let across = stem(1, Vec3::new(0.5, -1.0, 0.002), Vec3::new(0.5, 1.0, 0.002), 0.005);
        let (direction, length) = eastwards(&standing(&[across]));
        assert_eq!(length, 1.0);
        assert!(direction.x > 0.9998 && direction.z < -0.01, "a degree aside is enough: {direction}");
    }

    #[test]
    fn what_is_beside_its_way_or_bears_it_is_no_obstacle() {
        let beside = stem(1, Vec3::new(0.5, -1.0, 0.02), Vec3::new(0.5, 1.0, 0.02), 0.005);
        let bearing = stem(2, Vec3::NEG_Y, Vec3::ZERO, 0.05);
        assert_eq!(eastwards(&standing(&[beside, bearing])), (Vec3::X, 1.0));
    }

    #[test]
    fn a_trunk_too_stout_to_pass_stops_it_short() {
        let trunk = stem(1, Vec3::new(0.6, -2.0, 0.0), Vec3::new(0.6, 2.0, 0.0), 0.4);
        let (direction, length) = eastwards(&standing(&[trunk]));
        assert!(direction == Vec3::X && (length - 0.195).abs() < 1e-3, "{direction} {length}");
    }

    #[test]
    fn where_no_species_minds_wood_none_is_kept() {
        let mut wood = StandingWood::default();
        wood.begin(None);
        wood.add(stem(1, Vec3::new(0.5, -1.0, 0.0), Vec3::new(0.5, 1.0, 0.0), 0.1));
        assert!(!wood.minds());
        assert_eq!(eastwards(&wood), (Vec3::X, 1.0));
    }

    fn place() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-1.0_f32..1.0).prop_map(Vec3::from_array)
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn growth_enters_neither_wood_nor_a_wall_it_slides_along(
            stems in prop::collection::vec((place(), place(), 0.001_f32..0.1), 1..12),
            from in place(),
            direction in place(),
            length in 0.01_f32..1.0,
            wall in prop::option::of(0.01_f32..0.5),
        ) {
            prop_assume!(direction.length() > 0.01);
            let heading = direction.normalize();
            let stems: Vec<Capsule> =
                stems.iter().enumerate().map(|(i, (a, b, radius))| stem(i as u32, *a, *b, *radius)).collect();
            // A wall aslant in its way, that far from where it begins.
            let facing = (heading + 0.5 * heading.any_orthonormal_vector()).normalize();
            let walls = wall.map(|gap| StandingSolid {
                shape: SolidShape::Box { size: Vec3::new(4.0, 1.0, 4.0) },
                position: from + facing * (gap + 0.5),
                rotation: Quat::from_rotation_arc(Vec3::Y, facing),
                color: [0.5; 3],
            });
            let got = standing(&stems).advance(walls.as_slice(), None, from, heading, length, 0.004);
            let to = from + got.direction * got.length;
            for stem in stems.iter().filter(|stem| !is_within(stem, from)) {
                let start = segment::gap((from, from), (stem.from, stem.to)) - stem.radius;
                let kept = segment::gap((from, to), (stem.from, stem.to)) - stem.radius;
                prop_assert!(kept >= start.min(0.004) - 2e-5, "{} of {}", kept, start.min(0.004));
            }
            prop_assert!(!walls.iter().any(|wall| touches(wall, from, to, 0.0)));
        }
    }
}
