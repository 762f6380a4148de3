//! Figure 1: (a) no environment, (b) light and space, (c) and energy, (d) and a wall (`LK-17`).

use core::ops::RangeInclusive;

use image::RgbImage;

use super::measure::{Favour, collisions, crown_to_wall, growth, mean, passing_through};
use super::{Claim, ReproduceError, for_seeds, grown, pictures};
use crate::assets::Library;
use crate::environment::workers::Workers;
use crate::environment::{Solid, StandingSolid};
use crate::export::canvas;
use crate::export::picture::PictureSettings;
use crate::plant::measure::Form;
use crate::plant::{OrganKind, Snapshot};
use crate::scenario::Garden;

const PARTS: [(&str, &str); 4] = [
    ("figure_1a", "a  no environment"),
    ("figure_1b", "b  light and space"),
    ("figure_1c", "c  and energy"),
    ("figure_1d", "d  and a wall"),
];

/// Pairs a 1000 internodes that still count as hardly colliding.
const HARDLY: f64 = 15.0;

/// What the claims are about, of one seed.
struct Tree {
    collisions: [usize; 4],
    /// Pairs that collide, for every 1000 internodes.
    collision_rate: [f64; 4],
    /// Correlation of a bud's height with what it grows, in (b) and (c).
    favour: [f64; 2],
    /// Distance of the crown from the wall's face, metres, in (c) and (d).
    distance: [f64; 2],
    through_wall: usize,
}

pub(super) fn grow(
    seeds: RangeInclusive<u64>,
    library: &Library,
    size: PictureSettings,
    workers: &Workers,
) -> Result<(Vec<Claim>, RgbImage), ReproduceError> {
    let trees = for_seeds(seeds.clone(), workers, |seed| measured(library, seed))?;
    let of = |what: &dyn Fn(&Tree) -> f64| mean(&trees.iter().map(what).collect::<Vec<_>>());
    let all = |what: &dyn Fn(&Tree) -> bool| trees.iter().filter(|t| what(t)).count();
    let n = trees.len();

    let (in_a, in_b) = (of(&|t| t.collision_rate[0]), of(&|t| t.collision_rate[1]));
    let fewer = all(&|t| t.collisions[0] > t.collisions[1]);
    let (even, favoured) = (of(&|t| t.favour[0]), of(&|t| t.favour[1]));
    let higher = all(&|t| t.favour[1] > 0.0);
    let (near, far) = (of(&|t| t.distance[0]), of(&|t| t.distance[1]));
    let turned = all(&|t| t.distance[1] > t.distance[0]);
    let through = trees.iter().map(|t| t.through_wall).sum::<usize>();
    let claims = vec![
        Claim {
            row: "LK-17",
            paper: "(a) branches collide, in (b) fewer do",
            measured: format!(
                "pairs that collide: a {:.0}, b {:.0} a tree; a > b for {fewer} of {n} seeds",
                of(&|t| t.collisions[0] as f64),
                of(&|t| t.collisions[1] as f64),
            ),
            holds: fewer == n,
        },
        Claim {
            row: "LK-17",
            paper: "(b) branches do not collide, or hardly",
            measured: format!("pairs a 1000 internodes: b {in_b:.0}, a {in_a:.0}"),
            holds: in_b < HARDLY,
        },
        Claim {
            row: "LK-17",
            paper: "(c) higher buds are favoured over lower ones; in (b) all are alike",
            measured: format!(
                "rank correlation of height and growth: c {favoured:+.2}, b {even:+.2}; c > 0 for {higher} of {n}"
            ),
            holds: higher == n && even.abs() < 0.05,
        },
        Claim {
            row: "LK-17",
            paper: "(d) branches turn away from the wall",
            measured: format!(
                "leaves' mean distance to it: d {far:.2} m, c {near:.2} m; d > c for {turned} of {n}"
            ),
            holds: turned == n,
        },
        Claim {
            row: "LK-17",
            paper: "(d) no branch passes through the wall",
            measured: format!("{through} internodes in {n} trees"),
            holds: through == 0,
        },
    ];
    let mut scenes = Vec::new();
    for (name, caption) in PARTS {
        let (mut garden, _) = grown(library, name, *seeds.start(), |_| ())?;
        let shot = garden.snapshot();
        let caption = format!("{caption}\n   {:.1} m", Form::of(&shot, None).height_m);
        scenes.push((garden.scene(), shot, caption));
    }
    // Without energy trees are many times the size: each pair has a camera of its own.
    let (rich, fed) = scenes.split_at(2);
    let images = [rich, fed].map(|pair| pictures(pair, 0.0, size, workers)).concat();
    let sheet = canvas::side_by_side(&images, 4);
    Ok((claims, sheet))
}

fn measured(library: &Library, seed: u64) -> Result<Tree, ReproduceError> {
    let mut tree = Tree {
        collisions: [0; 4],
        collision_rate: [0.0; 4],
        favour: [0.0; 2],
        distance: [0.0; 2],
        through_wall: 0,
    };
    let mut shots = Vec::new();
    let mut walls = Vec::new();
    for (part, (name, _)) in PARTS.into_iter().enumerate() {
        let (mut before, mut favour) = (Snapshot::default(), Favour::default());
        let (mut garden, _) = grown(library, name, seed, |garden| {
            let after = garden.snapshot();
            favour.add(&growth(&before, &after));
            before = after;
        })?;
        let shot = garden.snapshot();
        tree.collisions[part] = collisions(&shot);
        let stems = shot.state.iter().filter(|s| s.kind() == OrganKind::Internode).count();
        tree.collision_rate[part] = 1000.0 * tree.collisions[part] as f64 / stems.max(1) as f64;
        if part == 1 || part == 2 {
            tree.favour[part - 1] = favour.mean();
        }
        if part == 3 {
            walls = walls_of(&mut garden);
        }
        shots.push(shot);
    }
    tree.distance = [2, 3].map(|part| crown_to_wall(&shots[part], &walls));
    tree.through_wall = passing_through(&shots[3], &walls);
    Ok(tree)
}

fn walls_of(garden: &mut Garden) -> Vec<StandingSolid> {
    let world = garden.world_mut();
    let mut solids = world.query::<(&Solid, &bevy::prelude::Transform)>();
    crate::environment::standing_solids(solids.iter(world))
}
