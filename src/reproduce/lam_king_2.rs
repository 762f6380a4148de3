//! Figure 2: a tree through its life. In a shortage it grows leaves first, then branches, by differing amounts
//! (`LK-18`).

use core::ops::RangeInclusive;

use image::RgbImage;

use super::measure::{mean, spread};
use super::{Claim, ReproduceError, for_seeds, grown, pictures};
use crate::assets::Library;
use crate::environment::workers::Workers;
use crate::export::canvas;
use crate::export::picture::PictureSettings;
use crate::plant::{LeafState, OrganState, Snapshot};
use crate::scenario::Garden;

const SCENARIO: &str = "figure_1c";
/// The same tree without a shortage.
const RICH: &str = "figure_1b";
const FRAMES: usize = 4;

/// What was asked for and given in a step.
#[derive(Debug, Clone, Copy, Default)]
struct Fed {
    leaves_asked: f64,
    leaves_given: f64,
    buds_asked: f64,
    buds_given: f64,
}

impl Fed {
    /// Whether there was not enough for all.
    fn is_short(&self) -> bool {
        self.leaves_given + self.buds_given < 0.999 * (self.leaves_asked + self.buds_asked)
    }

    /// Whether branches were fed while leaves went without.
    fn breaks_order(&self) -> bool {
        self.buds_given > 0.0 && self.leaves_given < 0.999 * self.leaves_asked
    }
}

pub(super) fn grow(
    seeds: RangeInclusive<u64>,
    library: &Library,
    size: PictureSettings,
    workers: &Workers,
) -> Result<(Vec<Claim>, RgbImage), ReproduceError> {
    let trees = for_seeds(seeds.clone(), workers, |seed| {
        let (poor, fed) = grown(library, SCENARIO, seed, fed)?;
        let (rich, _) = grown(library, RICH, seed, |_| ())?;
        Ok((fed, [poor, rich].map(|garden| spread(&lengths(&garden.snapshot())))))
    })?;
    let short: Vec<Fed> = trees.iter().flat_map(|(fed, _)| fed).filter(|f| f.is_short()).copied().collect();
    let steps = trees.iter().map(|(fed, _)| fed.len()).sum::<usize>();
    let broken = short.iter().filter(|f| f.breaks_order()).count();
    let met = |given: &dyn Fn(&Fed) -> f64, asked: &dyn Fn(&Fed) -> f64| {
        100.0 * short.iter().map(given).sum::<f64>() / short.iter().map(asked).sum::<f64>().max(1e-9)
    };
    let leaves = met(&|f| f.leaves_given, &|f| f.leaves_asked);
    let buds = met(&|f| f.buds_given, &|f| f.buds_asked);
    let [poor, rich] = [0, 1].map(|k| mean(&trees.iter().map(|(_, s)| s[k]).collect::<Vec<_>>()));
    let claims = vec![
        Claim {
            row: "LK-18",
            paper: "energy is short at times",
            measured: format!("in {} of {steps} steps of {} trees", short.len(), trees.len()),
            holds: !short.is_empty(),
        },
        Claim {
            row: "LK-18",
            paper: "in a shortage leaves grow first",
            measured: format!(
                "then leaves get {leaves:.0} % of what they ask for, branches {buds:.0} %; \
                 branches fed before a leaf in {broken} steps"
            ),
            holds: broken == 0 && leaves > buds,
        },
        Claim {
            row: "LK-18",
            paper: "then branches, by differing amounts",
            measured: format!(
                "spread of internode lengths (deviation over mean): {:.1} %, without a shortage {:.1} %",
                100.0 * poor,
                100.0 * rich
            ),
            holds: poor > rich,
        },
    ];
    let (_, mut scenes) = grown(library, SCENARIO, *seeds.start(), |garden| {
        let caption = format!("step {}", garden.steps());
        (garden.scene(), garden.snapshot(), caption)
    })?;
    let last = scenes.len();
    let mut step = 0;
    scenes.retain(|_| {
        step += 1;
        // Evenly spread, the last one among them.
        (1..=FRAMES).any(|k| step == (last * k).div_ceil(FRAMES))
    });
    Ok((claims, canvas::side_by_side(&pictures(&scenes, 0.0, size, workers), 4)))
}

/// What leaves and apical buds could use after a step, and were given.
fn fed(garden: &mut Garden) -> Fed {
    let shot = garden.snapshot();
    let mut fed = Fed::default();
    for (i, state) in shot.state.iter().enumerate() {
        let Some(plant) = &shot.plants[shot.plant[i] as usize] else { continue };
        let (species, given) = (&plant.species, f64::from(shot.allotment[i]));
        match state {
            OrganState::Leaf(leaf) if leaf.state == LeafState::Growing => {
                fed.leaves_asked += f64::from((1.0 - leaf.size).min(species.leaf_growth) * species.leaf_cost);
                fed.leaves_given += given;
            }
            OrganState::ApicalBud(..) => {
                fed.buds_asked += f64::from(species.extension_m * species.shoot_cost);
                fed.buds_given += given;
            }
            _ => {}
        }
    }
    fed
}

fn lengths(shot: &Snapshot) -> Vec<f64> {
    let length = |state: &OrganState| match state {
        OrganState::Internode(internode, _) => Some(f64::from(internode.length)),
        _ => None,
    };
    shot.state.iter().filter_map(length).collect()
}
