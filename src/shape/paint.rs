//! Vertex colours: what tells a twig from a trunk and one leaf from the next, and how wind moves each place.

use bevy::prelude::*;

use super::bark::Bark;
use super::texture::{bark_tint, leaf_tint};
use super::tubes::Axes;
use super::{Place, Surface};
use crate::chance::{mix, share};
use crate::plant::{NO_PARENT, OrganState, Snapshot};

/// What colours of vertices are looked up in, made once a snapshot.
#[derive(Debug, Clone)]
pub struct Paint<'a> {
    snapshot: &'a Snapshot,
    /// Bark of each plant.
    bark: Vec<Option<Bark>>,
    /// Phase of the axis of each internode, 0..1.
    phase: Vec<f32>,
    /// Way from the ground along the wood to the tip of each internode, as a share of the plant's longest, 0..1.
    sway: Vec<f32>,
}

impl<'a> Paint<'a> {
    /// Looks through a snapshot.
    pub fn of(snapshot: &'a Snapshot) -> Self {
        let bark = snapshot.plants.iter().map(|p| p.as_ref().map(|p| Bark::of(&p.species))).collect();
        let axes = Axes::of(snapshot);
        let mut phase = vec![0.0; snapshot.len()];
        for &start in &axes.starts {
            let own = share(mix(snapshot.lineage[start as usize].0));
            for i in axes.walk(start) {
                phase[i as usize] = own;
            }
        }
        let mut sway = vec![0.0; snapshot.len()];
        let mut longest = vec![0.0_f32; snapshot.plants.len()];
        for i in 0..snapshot.len() {
            let OrganState::Internode(internode, _) = &snapshot.state[i] else { continue };
            let below = sway.get(snapshot.parent[i] as usize).copied().unwrap_or(0.0);
            sway[i] = below + internode.length;
            if let Some(longest) = longest.get_mut(snapshot.plant[i] as usize) {
                *longest = longest.max(sway[i]);
            }
        }
        for (sway, plant) in sway.iter_mut().zip(&snapshot.plant) {
            *sway /= longest.get(*plant as usize).map_or(1.0, |longest| longest.max(f32::MIN_POSITIVE));
        }
        Self { snapshot, bark, phase, sway }
    }

    /// What the texture is multiplied with at each vertex of wood or leaves, linear RGB 0..1.
    pub fn tints(&self, surface: &Surface) -> Vec<[f32; 3]> {
        surface.places.iter().map(|place| self.tint(place).to_array()).collect()
    }

    fn tint(&self, place: &Place) -> Vec3 {
        let i = place.organ as usize;
        let radius = |i: usize| match self.snapshot.state.get(i) {
            Some(OrganState::Internode(internode, _)) => Some(internode.radius),
            _ => None,
        };
        let Some(own) = radius(i) else {
            let chance = mix(self.snapshot.lineage.get(i).map_or(0, |lineage| lineage.0) ^ 0x1EAF);
            return leaf_tint(share(chance) - 0.5, share(mix(chance)) - 0.5);
        };
        let below = radius(self.snapshot.parent[i] as usize).unwrap_or(own);
        let bark = self.bark.get(self.snapshot.plant[i] as usize).copied().flatten();
        bark.map_or(Vec3::ONE, |bark| bark_tint(&bark, below + (own - below) * place.along))
    }

    /// How wind moves each vertex, after the custom of games: red the phase of its branch, green how far it sways, blue
    /// how much it flutters, each 0..1.
    ///
    /// - Red is one number for each axis, at random from its descent: branches do not swing in step. A leaf has that of
    ///   its axis.
    /// - Green is the way from the ground along the wood as a share of the longest there is: 0 where the trunk stands,
    ///   1 at the farthest tip. It is continuous where a branch leaves its parent, so nothing comes apart as long as
    ///   what moves a vertex with it depends on the place and on green alone; a shader squares it for a bend.
    /// - Blue is 0 on wood and where a petiole is attached, 1 at the tip of the blade.
    pub fn winds(&self, surface: &Surface) -> Vec<[f32; 3]> {
        surface.places.iter().map(|place| self.wind(place)).collect()
    }

    fn wind(&self, place: &Place) -> [f32; 3] {
        let i = place.organ as usize;
        let below = self.snapshot.parent.get(i).copied().unwrap_or(NO_PARENT) as usize;
        let sway_below = self.sway.get(below).copied().unwrap_or(0.0);
        match self.snapshot.state.get(i) {
            Some(OrganState::Internode(..)) => {
                let phase_below = self.phase.get(below).copied().unwrap_or(self.phase[i]);
                // The first ring of a branch lies in its parent and moves with it.
                let phase = if place.along <= 0.0 { phase_below } else { self.phase[i] };
                [phase, sway_below + (self.sway[i] - sway_below) * place.along, 0.0]
            }
            _ => [self.phase.get(below).copied().unwrap_or(0.0), sway_below, place.along.clamp(0.0, 1.0)],
        }
    }
}
