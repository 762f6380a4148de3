//! False colours: what is known of an organ as a number in 0..1, and the colour of each number.

use bevy::math::ops;
use bevy::prelude::*;

use super::record::Values;
use crate::plant::{NO_PARENT, OrganState, Snapshot};

/// What organs are coloured by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Reflect)]
pub enum Overlay {
    /// Light found at leaves and buds, 0 to 1; wood shows the mean of what it bears.
    Light,
    /// Space found, 0 to 1; wood shows the mean of what it bears.
    Space,
    /// What leaves earned and buds were given, as the square root of its share of the most of any organ; wood
    /// shows the mean of what it bears.
    Energy,
    /// Radius of wood from 1 mm to 1 m, logarithmic; leaves and buds show that of their stem.
    Radius,
    /// Age from 0 to 64 steps, logarithmic.
    Age,
    /// Branch order from 0 to 7.
    Order,
}

impl Overlay {
    /// All of them.
    pub const ALL: [Overlay; 6] =
        [Self::Light, Self::Space, Self::Energy, Self::Radius, Self::Age, Self::Order];

    /// The colour of a value in 0..1, linear: dark blue through green to yellow.
    pub fn color(value: f32) -> LinearRgba {
        let at = value.clamp(0.0, 1.0) * (RAMP.len() - 1) as f32;
        let low = (at as usize).min(RAMP.len() - 2);
        let mix = |part: usize| {
            let [a, b] = [RAMP[low][part], RAMP[low + 1][part]];
            a + (b - a) * (at - low as f32)
        };
        LinearRgba::rgb(mix(0), mix(1), mix(2))
    }

    /// The number the shader knows it by.
    pub(super) fn number(self) -> f32 {
        match self {
            Self::Light => 0.0,
            Self::Space => 1.0,
            Self::Energy => 2.0,
            Self::Radius => 3.0,
            Self::Age => 4.0,
            Self::Order => 5.0,
        }
    }

    /// The value shown for organ `i` of a snapshot, 0..1, by the same rule as in the scene.
    pub fn value(self, snapshot: &Snapshot, i: usize) -> f32 {
        match self {
            Self::Age => age(snapshot, i),
            Self::Order => snapshot.order[i] as f32 / 7.0,
            _ => values(snapshot, most_energy(snapshot))[i][self.number() as usize],
        }
    }
}

/// Colours from 0 to 1, linear: even steps of lightness, told apart by the colour-blind too.
pub(super) const RAMP: [[f32; 3]; 16] = [
    [0.058, 0.000, 0.089],
    [0.065, 0.008, 0.140],
    [0.064, 0.025, 0.190],
    [0.056, 0.048, 0.228],
    [0.045, 0.078, 0.250],
    [0.033, 0.112, 0.261],
    [0.025, 0.151, 0.267],
    [0.018, 0.195, 0.269],
    [0.014, 0.245, 0.266],
    [0.013, 0.301, 0.251],
    [0.022, 0.364, 0.222],
    [0.053, 0.431, 0.177],
    [0.122, 0.503, 0.121],
    [0.254, 0.573, 0.064],
    [0.480, 0.635, 0.020],
    [0.984, 0.799, 0.019],
];

/// Age of an organ on the scale of [`Overlay::Age`].
pub(super) fn age(snapshot: &Snapshot, i: usize) -> f32 {
    let steps = snapshot.step.saturating_sub(snapshot.span[i].born());
    (ops::ln(1.0 + steps as f32) / ops::ln(65.0)).min(1.0)
}

/// Largest income or allotment of any organ.
pub(super) fn most_energy(snapshot: &Snapshot) -> f32 {
    (0..snapshot.len()).map(|i| snapshot.allotment[i].max(snapshot.flow[i].income)).fold(0.0, f32::max)
}

/// Light, space, energy and radius of every organ, each 0..1.
pub(super) fn values(snapshot: &Snapshot, most_energy: f32) -> Vec<Values> {
    let n = snapshot.len();
    let mut sums = vec![([0.0_f32; 3], 0.0_f32); n];
    let mut all = vec![[0.0; 4]; n];
    // Tips come after what bears them.
    for i in (0..n).rev() {
        let (sum, count) = sums[i];
        let own = match &snapshot.state[i] {
            OrganState::Internode(internode, _) => {
                all[i][3] = (ops::ln(internode.radius.max(1e-6) * 1000.0) / ops::ln(1000.0)).clamp(0.0, 1.0);
                sum.map(|sum| sum / count.max(1.0))
            }
            _ => {
                let energy = snapshot.allotment[i].max(snapshot.flow[i].income);
                let share = if most_energy > 0.0 { (energy / most_energy).max(0.0).sqrt() } else { 0.0 };
                [snapshot.exposure[i].light, snapshot.exposure[i].space, share]
            }
        };
        all[i][..3].copy_from_slice(&own);
        let weight = if count > 0.0 { count } else { 1.0 };
        if let Some((above, total)) = sums.get_mut(parent(snapshot, i)) {
            for (above, own) in above.iter_mut().zip(own) {
                *above += own * weight;
            }
            *total += weight;
        }
    }
    for i in 0..n {
        if !matches!(snapshot.state[i], OrganState::Internode(..))
            && let Some(&[.., radius]) = all.get(parent(snapshot, i))
        {
            all[i][3] = radius;
        }
    }
    all
}

fn parent(snapshot: &Snapshot, i: usize) -> usize {
    match snapshot.parent[i] {
        NO_PARENT => usize::MAX,
        p => p as usize,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ramp_gets_lighter() {
        let light = |x: f32| {
            let c = Overlay::color(x);
            0.2126 * c.red + 0.7152 * c.green + 0.0722 * c.blue
        };
        for k in 1..=30 {
            assert!(light(k as f32 / 30.0) > light((k - 1) as f32 / 30.0), "{k}");
        }
    }
}
