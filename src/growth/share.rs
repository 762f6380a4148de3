//! Sharing the surplus: to leaves, to buds, the rest to the root (`LK-12`).

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;

use super::vigour::{self, Sink, SinkKind};
use super::{Mechanisms, StepCount};
use crate::chance::{self, Purpose};
use crate::plant::{
    Allotment, BranchOrder, EnergyFlow, EnergyLedger, EnergyStore, Exposure, Identity, Internode, LateralBud,
    LateralBudState, Leaf, LeafState, NO_PARENT, OrganKind, Plant, Pose, Roster,
};
use crate::species::{Allocation, Species};

/// An organ that asks for energy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Claim {
    /// Its light.
    pub light: f32,
    /// What it can use.
    pub need: f32,
    /// Less than this is of no use to it.
    pub least: f32,
}

/// Serves claims in order of light, highest first, ties in the order given, until the energy is gone: winner
/// takes all. Returns what each gets, and takes it off `energy`.
pub fn by_exposure(claims: &[Claim], energy: &mut f64) -> Vec<f32> {
    let mut order: Vec<usize> = (0..claims.len()).collect();
    order.sort_by(|&a, &b| claims[b].light.total_cmp(&claims[a].light).then(a.cmp(&b)));
    let mut shares = vec![0.0; claims.len()];
    for i in order {
        let share = claims[i].need.min(*energy as f32);
        if share > 0.0 && share >= claims[i].least {
            shares[i] = share;
            *energy = (*energy - f64::from(share)).max(0.0);
        }
    }
    shares
}

/// Least part of a full shoot worth growing.
const LEAST_SHOOT: f32 = 0.1;

/// What an organ is to the sharing.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Standing {
    /// A stem passes energy on; it gives out what its last leaves earned.
    Stem { income: f32 },
    /// A leaf, with what it earned and what it lacks to full size.
    Leaf { income: f32, lacks: f32 },
    /// A growing tip.
    Apical,
    /// A lateral bud that can break, with its place in its growth unit.
    Dormant { rank: f32, favour: f32 },
    /// A lateral bud that has broken or died, or an organ that is gone.
    Spent,
}

/// An organ as it asks for energy.
#[derive(Debug, Clone, Copy)]
struct Member {
    /// Index in the roster.
    organ: u32,
    order: u32,
    light: f32,
    /// Height above the foot of its plant, metres.
    height: f32,
    standing: Standing,
}

/// What the organs of all plants ask for, a resource. A step in parts may leave off between asking and getting.
#[derive(Resource, Debug, Default, Reflect)]
#[reflect(Resource, Default)]
pub struct Claims {
    /// Of every organ that was asked, its birth number.
    birth: Vec<u32>,
    /// By plant, its organs.
    #[reflect(ignore)]
    members: Vec<Vec<Member>>,
    /// Where in its plant's list each organ stands.
    place: Vec<u32>,
    /// By plant, energy taken back from organs that had not used it.
    reclaimed: Vec<f64>,
}

/// What sharing reads and writes of organs.
#[derive(SystemParam)]
pub struct Asked<'w, 's> {
    stems: Query<'w, 's, (&'static BranchOrder, &'static EnergyFlow, &'static Pose), With<Internode>>,
    organs: Query<
        'w,
        's,
        (
            &'static BranchOrder,
            &'static EnergyFlow,
            &'static Exposure,
            &'static mut Allotment,
            Option<&'static Leaf>,
            Option<&'static LateralBud>,
            &'static Pose,
        ),
    >,
}

impl Claims {
    /// Asks every organ, and takes back what it had not used; what was taken back before and not shared stays.
    fn gather(&mut self, roster: &Roster, asked: &mut Asked) {
        self.birth.clone_from(&roster.birth);
        self.place.clear();
        self.members.iter_mut().for_each(Vec::clear);
        self.members.resize(roster.plants.len(), Vec::new());
        self.reclaimed.resize(roster.plants.len(), 0.0);
        let mut foot = vec![None; roster.plants.len()];
        for i in 0..roster.len() {
            let (entity, plant) = (roster.entity[i], roster.plant[i] as usize);
            let organ = i as u32;
            let gone = Member { organ, order: 0, light: 0.0, height: 0.0, standing: Standing::Spent };
            let member = if roster.kind[i] == OrganKind::Internode {
                asked.stems.get(entity).map_or(gone, |(order, flow, pose)| {
                    foot[plant].get_or_insert(pose.position.y);
                    Member { order: order.0, standing: Standing::Stem { income: flow.income }, ..gone }
                })
            } else if let Ok((order, flow, exposure, mut allotment, leaf, lateral, pose)) =
                asked.organs.get_mut(entity)
            {
                self.reclaimed[plant] += f64::from(allotment.0);
                allotment.0 = 0.0;
                let standing = match (leaf, lateral) {
                    (Some(leaf), _) => {
                        let lacks = if leaf.state == LeafState::Growing { 1.0 - leaf.size } else { 0.0 };
                        Standing::Leaf { income: flow.income, lacks }
                    }
                    (None, Some(bud)) if bud.state == LateralBudState::Dormant => {
                        Standing::Dormant { rank: bud.rank, favour: bud.favour }
                    }
                    (None, Some(_)) => Standing::Spent,
                    (None, None) => Standing::Apical,
                };
                let height = pose.position.y - *foot[plant].get_or_insert(pose.position.y);
                Member { organ, order: order.0, light: exposure.light, height, standing }
            } else {
                gone
            };
            self.place.push(self.members[plant].len() as u32);
            self.members[plant].push(member);
        }
    }
}

/// Asks organs what they can use.
pub fn gather_claims(
    mechanisms: Res<Mechanisms>,
    roster: Res<Roster>,
    mut claims: ResMut<Claims>,
    mut asked: Asked,
) {
    if mechanisms.energy {
        claims.gather(&roster, &mut asked);
    }
}

/// Shares each plant's surplus, and what its store releases, among its organs.
pub fn share_surplus(
    step: Res<StepCount>,
    mechanisms: Res<Mechanisms>,
    roster: Res<Roster>,
    mut claims: ResMut<Claims>,
    plants: Query<&Plant>,
    mut books: Query<(&mut EnergyStore, &mut EnergyLedger)>,
    mut asked: Asked,
    identities: Query<&Identity>,
) {
    if !mechanisms.energy {
        return;
    }
    // What the host took away since is not asked any more.
    if claims.birth != roster.birth || claims.members.len() != roster.plants.len() {
        claims.gather(&roster, &mut asked);
    }
    let Claims { birth, members, place, reclaimed } = &mut *claims;
    for (index, entity) in roster.plants.iter().enumerate() {
        let reclaimed = core::mem::take(&mut reclaimed[index]);
        let Some(entity) = *entity else { continue };
        let (Ok(plant), Ok((mut store, ledger))) = (plants.get(entity), books.get_mut(entity)) else {
            continue;
        };
        let species = &*plant.species;
        let surplus = (ledger.income - ledger.upkeep - ledger.unpaid).max(0.0).min(store.stored);
        let reserve = store.stored - surplus;
        store.stored += reclaimed;
        let energy = surplus + reclaimed + f64::from(species.store_release) * reserve.max(0.0);
        let energy = energy.min(store.stored);
        let mine = &members[index];
        let age = store.age(step.0);
        // What is shared now is used in the next step.
        let rests = species.rests(age + 1);
        let shares = match species.allocation {
            Allocation::ByExposure => share_by_exposure(mine, energy, species, mechanisms.light, rests),
            Allocation::ByVigour if rests => Vec::new(),
            Allocation::ByVigour => {
                let parents = mine.iter().map(|member| match roster.parent[member.organ as usize] {
                    NO_PARENT => NO_PARENT,
                    parent => place[parent as usize],
                });
                let vigours = vigours(mine, parents, energy, age, species);
                let chance = |member: &Member| {
                    let lineage = identities.get(roster.entity[member.organ as usize]).ok()?.lineage;
                    let mut stream = chance::stream(plant.seed, lineage, step.0, Purpose::Rounding);
                    Some(chance::unit(&mut stream))
                };
                share_by_vigour(mine, &vigours, store.stored, age, species, chance)
            }
        };
        for (organ, share) in shares {
            if let Ok((_, _, _, mut allotment, ..)) = asked.organs.get_mut(roster.entity[organ as usize]) {
                allotment.0 = share;
                store.stored -= f64::from(share);
            }
        }
        store.stored = store.stored.max(0.0);
    }
    // In the next step all are asked again, though none be born or gone.
    birth.clear();
    members.clear();
}

/// What each organ gets: leaves first, then apical buds unless the plant rests, the best lit first.
fn share_by_exposure(
    mine: &[Member],
    mut energy: f64,
    species: &Species,
    light_matters: bool,
    rests: bool,
) -> Vec<(u32, f32)> {
    let light = |member: &Member| if light_matters { member.light } else { 1.0 };
    let leaves = |member: &Member| match member.standing {
        Standing::Leaf { lacks, .. } if lacks > 0.0 => {
            let need = lacks.min(species.leaf_growth) * species.leaf_cost;
            Some(Claim { light: light(member), need, least: 0.0 })
        }
        _ => None,
    };
    let buds = |member: &Member| {
        let need = species.extension_m * species.shoot_cost;
        let claim = Claim { light: light(member), need, least: need * LEAST_SHOOT };
        (member.standing == Standing::Apical && !rests).then_some(claim)
    };
    let mut serve = |claim: &dyn Fn(&Member) -> Option<Claim>| {
        let (organs, claims): (Vec<u32>, Vec<Claim>) =
            mine.iter().filter_map(|member| Some((member.organ, claim(member)?))).unzip();
        let shares = by_exposure(&claims, &mut energy);
        organs.into_iter().zip(shares).filter(|(_, share)| *share > 0.0).collect::<Vec<_>>()
    };
    let mut shares = serve(&leaves);
    shares.extend(serve(&buds));
    shares
}

/// Vigour of each organ of a plant, in internodes.
fn vigours(
    mine: &[Member],
    parents: impl Iterator<Item = u32>,
    energy: f64,
    age: u32,
    species: &Species,
) -> Vec<f32> {
    let rises = |member: &Member| vigour::height_factor(species, member.height);
    let sinks: Vec<Sink> = mine
        .iter()
        .zip(parents)
        .map(|(member, parent)| {
            let as_light = |income: f32| income / species.leaf_income.max(f32::MIN_POSITIVE);
            let (kind, demand) = match member.standing {
                Standing::Stem { income } => (SinkKind::Stem, as_light(income)),
                Standing::Leaf { income, .. } => (SinkKind::Spent, as_light(income)),
                Standing::Apical => (SinkKind::Bud, member.light * rises(member)),
                Standing::Dormant { rank, favour } => {
                    let place = favour * vigour::acrotony(species, rank);
                    (SinkKind::Bud, member.light * place * rises(member))
                }
                Standing::Spent => (SinkKind::Spent, 0.0),
            };
            Sink { parent, order: member.order, kind, demand }
        })
        .collect();
    let unit = f64::from(vigour::internode_cost(species));
    let budget = energy * f64::from(1.0 - species.wood_share) / unit;
    let control = |order: u32| {
        let young = species.apical_control.get(order);
        let least = species.apical_control_least.min(young);
        (young + species.apical_control_ageing * age as f32).clamp(least, 0.99)
    };
    vigour::settle(sinks, budget as f32, species.vigour_short, control)
}

/// What each bud gets for its vigour; `chance` (0..1) rounds it to whole internodes.
fn share_by_vigour(
    mine: &[Member],
    vigours: &[f32],
    stored: f64,
    age: u32,
    species: &Species,
    chance: impl Fn(&Member) -> Option<f32>,
) -> Vec<(u32, f32)> {
    let maturity = species.maturity(age);
    let mut wishes: Vec<(u32, f32, f32)> = Vec::new();
    for (member, &vigour) in mine.iter().zip(vigours) {
        let is_bud = matches!(member.standing, Standing::Apical | Standing::Dormant { .. });
        if !is_bud || vigour <= 0.0 {
            continue;
        }
        let Some(chance) = chance(member) else { continue };
        let rises = vigour::height_factor(species, member.height);
        let most = species.flush(member.order, maturity) * rises;
        let cost = vigour::shoot_cost(species, vigour, most, chance);
        if cost > 0.0 {
            wishes.push((member.organ, vigour, cost));
        }
    }
    // Chance may round the sum above what there is: the most vigorous are served first.
    wishes.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let mut left = stored;
    wishes.retain(|&(_, _, cost)| {
        let served = f64::from(cost) <= left;
        if served {
            left -= f64::from(cost);
        }
        served
    });
    wishes.into_iter().map(|(organ, _, cost)| (organ, cost)).collect()
}
