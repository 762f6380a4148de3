//! Sensing: what every probe reads, and where every growing bud would best grow to.
//!
//! Plain data in, plain data out, one result a request by index, the same on any number of threads.
//!
//! # Choosing a heading (`LK-15`)
//!
//! Candidates are spread evenly over the cap of directions a bud can turn to, at full reach, by a sunflower
//! pattern that turns with the bud's own frame; the first is its heading. Each gets
//!
//! f = w_light L + w_space S + w_heading cos(angle to the heading) + w_set cos(angle to the vertical − set
//! point)
//!
//! and the highest is chosen. Readings that differ from the heading's by less than one texel count as the
//! heading's, and of equal fitness the lowest candidate wins: in the open the bud grows straight on. A
//! candidate underground, in wood, or in or behind a solid reads no light and no space.

mod reproject;
pub mod room;
mod search;

use bevy::math::{Quat, Vec3};

use super::cube_map::CubeMap;
use super::direct_light::{LightRays, direct_light};
use super::probe::{Probe, Sensing, SensingMode};
use super::trace::Tracer;
use super::workers::Workers;
use crate::species::LightReading;
use reproject::Reprojection;
pub use search::{Choice, Reading, Search, Terms, cap_direction};
use search::{fitness, rank, terms};

/// One organ's wish to look around.
#[derive(Debug, Clone, PartialEq)]
pub struct SenseRequest {
    /// From where.
    pub probe: Probe,
    /// What counts as light.
    pub reading: LightReading,
    /// Where to grow, for a growing bud; it searches from the probe's position.
    pub search: Option<Search>,
    /// Others who read the same map, each by the births of the organs it does not see either: itself and the internode
    /// it sits on.
    pub guests: Vec<[u32; 2]>,
}

/// What it read.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensed {
    /// Light at the probe, 0..1.
    pub light: f32,
    /// Free space at the probe, 0..1.
    pub space: f32,
    /// The best candidate, if there was a search.
    pub choice: Option<Choice>,
    /// All candidates of the search, the best first.
    pub ranked: Vec<Choice>,
    /// What the guests read, in their order.
    pub guests: Vec<Reading>,
}

/// How much fitness the fast way of comparing candidates gives away against a map at each of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GivenAway {
    /// Searches compared.
    pub searches: usize,
    /// Mean fitness lost, by the slow way's own measure.
    pub mean_loss: f32,
    /// Largest fitness lost.
    pub worst_loss: f32,
    /// Mean distance between the best and the worst candidate, to judge the loss by.
    pub mean_spread: f32,
    /// Share of searches in which both choose the same candidate.
    pub agreement: f32,
}

/// Looks around from every probe. Results by index.
pub fn sense(
    tracer: &Tracer,
    requests: &[SenseRequest],
    sensing: &Sensing,
    workers: &Workers,
) -> Vec<Sensed> {
    workers.map(requests.len(), |i| sense_one(tracer, &requests[i], sensing))
}

/// Measures what [`SensingMode::Reprojected`] gives away against [`SensingMode::MapPerCandidate`], over the
/// requests that search.
pub fn fitness_given_away(
    tracer: &Tracer,
    requests: &[SenseRequest],
    sensing: &Sensing,
    workers: &Workers,
) -> GivenAway {
    let searches: Vec<_> =
        requests.iter().filter_map(|request| Some((request, request.search.as_ref()?))).collect();
    let compared = workers.map(searches.len(), |i| {
        let (request, search) = searches[i];
        let map = CubeMap::at(tracer, &request.probe);
        let readings = |mode| candidates(tracer, request, search, &Sensing { mode, ..*sensing }, &map);
        let fast = rank(search, &readings(SensingMode::Reprojected), map.size())[0];
        let slow = fitness(search, &readings(SensingMode::MapPerCandidate), map.size());
        let best = slow.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let worst = slow.iter().copied().fold(f32::INFINITY, f32::min);
        (best - slow[fast.index as usize], best - worst)
    });
    let count = compared.len().max(1) as f32;
    GivenAway {
        searches: compared.len(),
        mean_loss: compared.iter().map(|&(loss, _)| loss).sum::<f32>() / count,
        worst_loss: compared.iter().map(|&(loss, _)| loss).fold(0.0, f32::max),
        mean_spread: compared.iter().map(|&(_, spread)| spread).sum::<f32>() / count,
        agreement: compared.iter().filter(|&&(loss, _)| loss == 0.0).count() as f32 / count,
    }
}

fn sense_one(tracer: &Tracer, request: &SenseRequest, sensing: &Sensing) -> Sensed {
    let map = CubeMap::at(tracer, &request.probe);
    let Reading { light, space } = read(tracer, &map, request, &request.probe.blind_to, sensing);
    let ranked = request.search.as_ref().map_or_else(Vec::new, |search| {
        let readings = candidates(tracer, request, search, sensing, &map);
        rank(search, &readings, map.size())
    });
    let guests = request.guests.iter().map(|&guest| read_as(tracer, &map, request, guest, sensing)).collect();
    Sensed { light, space, choice: ranked.first().copied(), ranked, guests }
}

/// What a guest reads in a map: it sees neither what the map is blind to nor its own.
fn read_as(
    tracer: &Tracer,
    map: &CubeMap,
    request: &SenseRequest,
    guest: [u32; 2],
    sensing: &Sensing,
) -> Reading {
    let ([a, b], [c, d]) = (request.probe.blind_to, guest);
    let blind = [a, b, c, d];
    match map.without(tracer, &guest, &blind) {
        Some(own) => read(tracer, &own, request, &blind, sensing),
        None => read(tracer, map, request, &blind, sensing),
    }
}

/// What one organ sees, read again with all that went into it.
#[derive(Debug, Clone)]
pub struct Look {
    /// What it sees.
    pub map: CubeMap,
    /// What it reads.
    pub sensed: Sensed,
    /// What the fitness of each candidate is made of, by [`Choice::index`].
    pub terms: Vec<Terms>,
    /// Whether each candidate is out of reach: underground, in wood, in a solid or behind one; by
    /// [`Choice::index`].
    pub barred: Vec<bool>,
}

/// Looks around from one probe as [`sense`] does, and keeps what it saw; of a guest's, if one is named by its index.
pub fn look(tracer: &Tracer, request: &SenseRequest, guest: Option<usize>, sensing: &Sensing) -> Look {
    let mut sensed = sense_one(tracer, request, sensing);
    let mut map = CubeMap::at(tracer, &request.probe);
    if let Some(guest) = guest.filter(|guest| *guest < request.guests.len()) {
        Reading { light: sensed.light, space: sensed.space } = sensed.guests[guest];
        let ([a, b], [c, d]) = (request.probe.blind_to, request.guests[guest]);
        map = map.without(tracer, &[c, d], &[a, b, c, d]).unwrap_or(map);
    }
    let Probe { position, ref blind_to, .. } = request.probe;
    let (terms, barred) = request.search.as_ref().map_or_else(Default::default, |search| {
        let readings = candidates(tracer, request, search, sensing, &map);
        let barred = (0..search.count())
            .map(|i| tracer.is_barred(position, position + search.direction(i) * search.reach, blind_to));
        (terms(search, &readings, map.size()), barred.collect())
    });
    Look { map, sensed, terms, barred }
}

fn read(tracer: &Tracer, map: &CubeMap, request: &SenseRequest, blind: &[u32], sensing: &Sensing) -> Reading {
    let light = match request.reading {
        LightReading::Share => map.share(sensing.weight),
        LightReading::Radiance => map.light(tracer, blind),
    };
    Reading { light, space: map.space(request.probe.space_range, sensing.weight) }
}

/// Light and space at every candidate.
fn candidates(
    tracer: &Tracer,
    request: &SenseRequest,
    search: &Search,
    sensing: &Sensing,
    map: &CubeMap,
) -> Vec<Reading> {
    let Probe { position, ref blind_to, face, space_range } = request.probe;
    if !search.looks() {
        return vec![Reading { light: 1.0, space: 1.0 }; search.count() as usize];
    }
    let reprojection = match sensing.mode {
        SensingMode::Reprojected => {
            let sky = tracer.scene().sky;
            Some(Reprojection::new(
                tracer,
                map,
                request.reading,
                sensing.weight,
                &sky,
                search.reach,
                space_range,
            ))
        }
        SensingMode::MapPerCandidate => None,
    };
    (0..search.count())
        .map(|i| {
            let offset = search.direction(i) * search.reach;
            let point = position + offset;
            if tracer.is_barred(position, point, blind_to) {
                return Reading { light: 0.0, space: 0.0 };
            }
            match &reprojection {
                None => {
                    let map = CubeMap::render(tracer, point, face, blind_to);
                    read(tracer, &map, request, blind_to, sensing)
                }
                Some(reprojection) => {
                    let Reading { light, space } = reprojection.at(offset);
                    let lamps = match request.reading {
                        LightReading::Share => 0.0,
                        LightReading::Radiance if search.light_on => {
                            direct_light(tracer, point, blind_to, LightRays::COARSE)
                        }
                        LightReading::Radiance => 0.0,
                    };
                    Reading { light: (light + lamps).clamp(0.0, 1.0), space }
                }
            }
        })
        .collect()
}

/// A request for a bud's light, space and next heading.
impl SenseRequest {
    /// A bud that searches a cone about its heading, with the weights of the paper's kind of plant.
    pub fn bud(probe: Probe, rotation: Quat, cone: f32, reach: f32) -> Self {
        Self {
            probe,
            reading: LightReading::Share,
            search: Some(Search { rotation, cone, reach, ..Search::default() }),
            guests: Vec::new(),
        }
    }

    /// A leaf that only reads.
    pub fn leaf(
        position: Vec3,
        blind_to: [u32; 2],
        face: u32,
        space_range: f32,
        reading: LightReading,
    ) -> Self {
        Self {
            probe: Probe { position, blind_to, face, space_range },
            reading,
            search: None,
            guests: Vec::new(),
        }
    }
}
