//! Candidates and their fitness (`LK-15`).

use bevy::math::{Quat, Vec3, ops};

use crate::environment::direct_light::GOLDEN_ANGLE;

/// How a growing bud searches for its next heading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Search {
    /// The bud's frame: its heading is `rotation * Y`.
    pub rotation: Quat,
    /// Widest turn, radians.
    pub cone: f32,
    /// Distance it would grow, metres.
    pub reach: f32,
    /// Radius of the shoot, metres.
    pub radius: f32,
    /// Candidates, the heading among them; at least 1 is taken.
    pub candidates: u32,
    /// Weight of light.
    pub weight_light: f32,
    /// Weight of free space.
    pub weight_space: f32,
    /// Weight of growing straight on.
    pub weight_heading: f32,
    /// Weight of growing at the set point.
    pub weight_set_point: f32,
    /// Preferred angle to the vertical, radians.
    pub set_point: f32,
    /// Whether light and space are stretched to 0..1 over the candidates.
    pub rescale: bool,
    /// Whether light counts.
    pub light_on: bool,
    /// Whether space counts.
    pub space_on: bool,
}

impl Default for Search {
    fn default() -> Self {
        Self {
            rotation: Quat::IDENTITY,
            cone: 0.7,
            reach: 0.2,
            radius: 0.006,
            candidates: 17,
            weight_light: 1.0,
            weight_space: 1.0,
            weight_heading: 0.05,
            weight_set_point: 0.0,
            set_point: 0.0,
            rescale: true,
            light_on: true,
            space_on: true,
        }
    }
}

/// The best candidate of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// Where to grow, a unit vector.
    pub heading: Vec3,
    /// Its fitness.
    pub fitness: f32,
    /// Light there, 0..1.
    pub light: f32,
    /// Free space there, 0..1.
    pub space: f32,
    /// Which candidate it is; 0 is the bud's heading.
    pub index: u32,
}

/// What each term of the fitness adds for a candidate, weights and switches applied; their sum is its fitness.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Terms {
    /// For light, as graded among the candidates.
    pub light: f32,
    /// For free space, as graded among the candidates.
    pub space: f32,
    /// For growing straight on.
    pub heading: f32,
    /// For growing at the set point.
    pub set_point: f32,
}

impl Terms {
    /// Their sum.
    pub fn fitness(&self) -> f32 {
        self.light + self.space + self.heading + self.set_point
    }
}

/// Light and space at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Light, 0..1.
    pub light: f32,
    /// Free space, 0..1.
    pub space: f32,
}

/// Direction `i` of `count` spread evenly over the spherical cap of half angle `cone` (radians) about +Y.
///
/// Direction i lies i / (count - 1/2) of the cap's area from the middle, turned by i golden angles.
pub fn cap_direction(i: u32, count: u32, cone: f32) -> Vec3 {
    let down = (1.0 - ops::cos(cone)) * i as f32 / (count.max(1) as f32 - 0.5);
    let sine = (down * (2.0 - down)).max(0.0).sqrt();
    let (y, x) = ops::sin_cos(i as f32 * GOLDEN_ANGLE);
    Vec3::new(sine * x, 1.0 - down, sine * y)
}

impl Search {
    /// Candidates to compare.
    pub(super) fn count(&self) -> u32 {
        self.candidates.max(1)
    }

    /// Whether anything around matters.
    pub(super) fn looks(&self) -> bool {
        (self.light_on && self.weight_light != 0.0) || (self.space_on && self.weight_space != 0.0)
    }

    /// Unit vector to candidate `i`.
    pub fn direction(&self, i: u32) -> Vec3 {
        (self.rotation * cap_direction(i, self.candidates, self.cone)).normalize_or(Vec3::Y)
    }
}

/// Fitness of every candidate.
pub(super) fn fitness(search: &Search, readings: &[Reading], face: usize) -> Vec<f32> {
    terms(search, readings, face).iter().map(Terms::fitness).collect()
}

/// What the fitness of every candidate is made of.
pub(super) fn terms(search: &Search, readings: &[Reading], face: usize) -> Vec<Terms> {
    let weight = |on: bool, weight: f32| if on { weight } else { 0.0 };
    let light = graded(readings.iter().map(|reading| reading.light), face, search.rescale);
    let space = graded(readings.iter().map(|reading| reading.space), face, search.rescale);
    let heading = search.direction(0);
    light
        .iter()
        .zip(&space)
        .enumerate()
        .map(|(i, (light, space))| {
            let direction = search.direction(i as u32);
            let to_vertical = ops::acos(direction.y.clamp(-1.0, 1.0));
            Terms {
                light: weight(search.light_on, search.weight_light) * light,
                space: weight(search.space_on, search.weight_space) * space,
                heading: search.weight_heading * direction.dot(heading),
                set_point: search.weight_set_point * ops::cos(to_vertical - search.set_point),
            }
        })
        .collect()
}

/// All candidates, the best first; of equal ones the lowest.
pub(super) fn rank(search: &Search, readings: &[Reading], face: usize) -> Vec<Choice> {
    let mut ranked: Vec<Choice> = fitness(search, readings, face)
        .into_iter()
        .zip(readings)
        .enumerate()
        .map(|(i, (fitness, &Reading { light, space }))| Choice {
            heading: search.direction(i as u32),
            fitness,
            light,
            space,
            index: i as u32,
        })
        .collect();
    ranked.sort_by(|a, b| b.fitness.total_cmp(&a.fitness).then(a.index.cmp(&b.index)));
    ranked
}

/// Readings in whole texels from the heading's, so that less than one texel is no difference; stretched to
/// 0..1 if wanted and if there is a difference.
fn graded(values: impl Iterator<Item = f32>, face: usize, rescale: bool) -> Vec<f32> {
    let texel = 1.0 / (6 * face * face) as f32;
    let mut values: Vec<f32> = values.collect();
    let heading = values.first().copied().unwrap_or(0.0);
    for value in &mut values {
        // A hair more than a texel's worth of rounding still is a whole texel.
        let difference = (*value - heading) / texel;
        *value = heading + (difference * 1.001).trunc() * texel;
    }
    let low = values.iter().copied().fold(f32::INFINITY, f32::min);
    let high = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    if rescale && high > low {
        values.iter_mut().for_each(|value| *value = (*value - low) / (high - low));
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    fn search() -> Search {
        Search { rotation: Quat::from_xyzw(0.2, 0.1, -0.4, 0.9).normalize(), ..Search::default() }
    }

    fn even(count: usize) -> Vec<Reading> {
        vec![Reading { light: 0.5, space: 0.25 }; count]
    }

    #[test]
    fn lk_15_candidates_are_spread_evenly_over_the_cone_and_the_first_is_the_heading() {
        let search = Search { candidates: 400, ..search() };
        let heading = search.rotation * Vec3::Y;
        assert!(search.direction(0).distance(heading) < 1e-6);
        let directions: Vec<Vec3> = (0..400).map(|i| search.direction(i)).collect();
        assert!(directions.iter().all(|d| d.angle_between(heading) <= search.cone + 1e-3));
        // The mean of a full cap lies (1 + cos) / 2 along its axis.
        let mean = directions.iter().sum::<Vec3>() / 400.0;
        assert!(mean.distance(heading * (1.0 + ops::cos(search.cone)) / 2.0) < 0.005);
        // Half the area holds half the candidates, on either side and within the inner cone.
        let right = search.rotation * Vec3::X;
        let half = directions.iter().filter(|d| d.dot(right) > 0.0).count();
        assert!((195..=205).contains(&half));
        let inner = (1.0 + ops::cos(search.cone)) / 2.0;
        let half = directions.iter().filter(|d| d.dot(heading) > inner).count();
        assert!((195..=205).contains(&half));
    }

    #[test]
    fn lk_15_in_the_open_the_heading_wins() {
        for rescale in [true, false] {
            for weight_heading in [0.0, 0.05] {
                let search = Search { rescale, weight_heading, ..search() };
                let mut readings = even(17);
                for (i, reading) in readings.iter_mut().enumerate().skip(1) {
                    // Noise of less than a texel.
                    reading.light += 0.9 / (6.0 * 64.0) * (i % 3) as f32 / 2.0;
                }
                assert_eq!(rank(&search, &readings, 8)[0].index, 0);
            }
        }
    }

    #[test]
    fn lk_15_the_formula_as_it_stands() {
        let search = Search {
            rotation: Quat::IDENTITY,
            rescale: false,
            weight_light: 0.7,
            weight_space: 0.2,
            weight_heading: 0.3,
            weight_set_point: 0.4,
            set_point: 1.0,
            ..Search::default()
        };
        let mut readings = even(17);
        readings[5] = Reading { light: 0.75, space: 0.5 };
        let got = fitness(&search, &readings, 16)[5];
        let angle = search.direction(5).angle_between(Vec3::Y);
        let want = 0.7 * 0.75 + 0.2 * 0.5 + 0.3 * ops::cos(angle) + 0.4 * ops::cos(angle - 1.0);
        assert!((got - want).abs() < 1e-3, "{got} {want}");
        let rescaled = fitness(&Search { rescale: true, ..search }, &readings, 16)[5];
        assert!((rescaled - got - 0.7 * 0.25 - 0.2 * 0.5).abs() < 1e-3);
    }

    #[test]
    fn lk_15_weights_steer_and_switches_silence_them() {
        let search = search();
        let mut readings = even(17);
        readings[5].light = 1.0;
        readings[9].space = 1.0;
        let with = |light_on, space_on| rank(&Search { light_on, space_on, ..search }, &readings, 8)[0].index;
        assert_eq!(with(true, false), 5);
        assert_eq!(with(false, true), 9);
        assert_eq!(with(false, false), 0);
    }
}
