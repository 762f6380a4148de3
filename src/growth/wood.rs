//! Wood: stems thicken as pipes for all they bear, and pay for it.

use bevy::math::ops;
use bevy::prelude::*;

use super::Mechanisms;
use crate::plant::{EnergyLedger, EnergyStore, Internode, NO_PARENT, OrganKind, Plant, Roster};

/// Pipe (radius to the power of the pipe exponent) every stem should have, tips to base in one pass: the sum of
/// the pipes it bears, at least its own. `pipes` holds `None` for what is no stem.
pub fn pipes(parents: &[u32], pipes: &[Option<f32>]) -> Vec<f32> {
    let mut wanted: Vec<f32> = pipes.iter().map(|p| p.unwrap_or(0.0)).collect();
    let mut borne = vec![0.0_f32; pipes.len()];
    for i in (0..parents.len()).rev() {
        wanted[i] = wanted[i].max(borne[i]);
        if parents[i] != NO_PARENT && pipes[i].is_some() {
            borne[parents[i] as usize] += wanted[i];
        }
    }
    wanted
}

/// Thickens stems. Wood costs energy: when what the store releases cannot pay for all of it, every stem gets the
/// same share.
/// Radii never shrink.
pub fn thicken_wood(
    mechanisms: Res<Mechanisms>,
    roster: Res<Roster>,
    plants: Query<&Plant>,
    mut books: Query<(&mut EnergyStore, &mut EnergyLedger)>,
    mut stems: Query<&mut Internode>,
) {
    let wood: Vec<Option<Internode>> = (0..roster.len())
        .map(|i| {
            let stem = (roster.kind[i] == OrganKind::Internode).then(|| stems.get(roster.entity[i]).ok());
            stem.flatten().copied()
        })
        .collect();
    let have: Vec<Option<f32>> = wood.iter().map(|stem| stem.map(|stem| stem.pipe)).collect();
    let want = pipes(&roster.parent, &have);
    let mut thicker: Vec<(usize, f32, f32)> = Vec::new();
    let mut volume = vec![0.0_f64; roster.plants.len()];
    let exponent: Vec<f32> = roster
        .plants
        .iter()
        .map(|p| p.and_then(|p| plants.get(p).ok()).map_or(2.0, |p| p.species.pipe_exponent))
        .collect();
    for (i, stem) in wood.iter().enumerate() {
        let Some(stem) = stem.filter(|stem| want[i] > stem.pipe) else { continue };
        let plant = roster.plant[i] as usize;
        let radius = ops::powf(want[i], 1.0 / exponent[plant]).max(stem.radius);
        volume[plant] += f64::from(core::f32::consts::PI * (radius * radius - stem.radius * stem.radius))
            * f64::from(stem.length);
        thicker.push((i, radius, want[i]));
    }
    let mut share = vec![1.0_f32; roster.plants.len()];
    for (plant, entity) in roster.plants.iter().enumerate() {
        let Some(entity) = *entity else { continue };
        let (Ok(Plant { species, .. }), Ok((mut store, mut ledger))) =
            (plants.get(entity), books.get_mut(entity))
        else {
            continue;
        };
        let cost = volume[plant] * f64::from(species.wood_cost);
        if cost > 0.0 && mechanisms.energy {
            let paid = cost.min(store.stored * f64::from(species.wood_draw));
            share[plant] = (paid / cost) as f32;
            store.stored -= paid;
            ledger.growth += paid;
            ledger.wood += paid;
        }
    }
    for (i, radius, pipe) in thicker {
        let plant = roster.plant[i] as usize;
        let Ok(mut stem) = stems.get_mut(roster.entity[i]) else { continue };
        if share[plant] >= 1.0 {
            stem.radius = radius;
            stem.pipe = pipe;
        } else {
            let square = stem.radius * stem.radius;
            stem.radius = (square + share[plant] * (radius * radius - square)).sqrt();
            stem.pipe = ops::powf(stem.radius, exponent[plant]);
        }
    }
}
