//! Figures 11 to 13: plants varied (`ST-12`).

use core::ops::RangeInclusive;

use bevy::math::{Vec2, Vec3, ops};
use image::RgbImage;

use super::csv;
use super::models::{self, Model};
use crate::assets::Library;
use crate::environment::trace::Tracer;
use crate::environment::workers::Workers;
use crate::environment::{Scene, SunLight};
use crate::export::canvas;
use crate::export::picture::{Bounds, Camera, Palette, PictureSettings, PlantLook, render};
use crate::plant::NO_PARENT;
use crate::plant::skeleton::Skeleton;
use crate::reproduce::{Claim, Findings, ReproduceError};
use crate::shape::bark::Bark;
use crate::species::Species;
use crate::species::parameter::Color;
use crate::tropism::Control;
use crate::tropism::vary::{Variation, vary};

/// How far a sibling strays from the course it tries to keep.
#[derive(Debug, Clone, Copy, Default)]
struct Straying {
    /// Root mean square of the angle between heading and course, degrees.
    angle: f32,
    /// How often it swings from one side of its course to the other, by [`SWING`] and more, for every hundred
    /// sub-steps.
    crossings: f32,
    /// Mean angle between the straight lines from base to end of its axes and those of the course, degrees.
    chord: f32,
}

/// Least lean to one side that counts as a swing, not as a tremor: the sine of two degrees.
const SWING: f32 = 0.035;

/// Compares piece by piece with the same plant grown without error, disturbance or lag.
fn straying(sibling: &Skeleton, course: &Skeleton, orders: RangeInclusive<u32>) -> Straying {
    let (mut squares, mut pieces, mut crossings, mut last) = (0.0, 0.0_f32, 0.0, Vec2::ZERO);
    let (mut chords, mut axes) = (0.0, 0.0_f32);
    let mut begins = 0;
    for (i, (piece, kept)) in sibling.segments.iter().zip(&course.segments).enumerate() {
        if !orders.contains(&piece.order) {
            continue;
        }
        let goes_on = piece.parent != NO_PARENT
            && piece.parent + 1 == i as u32
            && sibling.segments[piece.parent as usize].order == piece.order;
        let local = kept.pose.rotation.inverse() * piece.pose.heading();
        let lean = Vec2::new(local.x, local.z);
        let angle = piece.pose.heading().angle_between(kept.pose.heading()).to_degrees();
        squares += angle * angle;
        pieces += 1.0;
        if goes_on {
            let crossed = |now: f32, before: f32| u8::from(now.abs() >= SWING && now * before < 0.0);
            crossings += 0.5 * f32::from(crossed(lean.x, last.x) + crossed(lean.y, last.y));
        } else {
            begins = i;
        }
        // A side is left only when the other is reached.
        let swung = |now: f32, before: f32| if goes_on && now.abs() < SWING { before } else { now };
        last = Vec2::new(swung(lean.x, last.x), swung(lean.y, last.y));
        let ends = sibling
            .segments
            .get(i + 1)
            .is_none_or(|next| next.parent != i as u32 || next.order != piece.order);
        if ends {
            let chord = |s: &Skeleton| s.segments[i].tip() - s.segments[begins].pose.position;
            chords += chord(sibling).angle_between(chord(course)).to_degrees();
            axes += 1.0;
        }
    }
    Straying {
        angle: (squares / pieces.max(1.0)).sqrt(),
        crossings: 100.0 * crossings / pieces.max(1.0),
        chord: chords / axes.max(1.0),
    }
}

/// What every sibling tries to keep to.
fn course(base: &Skeleton, variation: &Variation) -> Result<Skeleton, ReproduceError> {
    let still = Variation { control: Control::DIRECT, sensing_error: 0.0, disturbance: 0.0, ..*variation };
    Ok(vary(base, &still, 0)?)
}

/// The mean over siblings of each seed.
fn mean_straying(
    base: &Skeleton,
    variation: &Variation,
    seeds: RangeInclusive<u64>,
    orders: RangeInclusive<u32>,
) -> Result<Straying, ReproduceError> {
    let course = course(base, variation)?;
    let (mut sum, mut n) = (Straying::default(), 0.0);
    for seed in seeds {
        let one = straying(&vary(base, variation, seed)?, &course, orders.clone());
        sum.angle += one.angle;
        sum.crossings += one.crossings;
        sum.chord += one.chord;
        n += 1.0;
    }
    Ok(Straying { angle: sum.angle / n, crossings: sum.crossings / n, chord: sum.chord / n })
}

/// Plants side by side, all from one stand, each under its caption.
pub(super) fn row(
    plants: &[(&Model, &Skeleton, String)],
    looks: Palette,
    azimuth_deg: f32,
    size: PictureSettings,
    workers: &Workers,
) -> Vec<RgbImage> {
    let scenes: Vec<Scene> = plants
        .iter()
        .map(|(model, skeleton, _)| {
            let mut scene = daylight();
            model.add_to(skeleton, &mut scene, 0);
            scene
        })
        .collect();
    let bounds = scenes.iter().fold(Bounds::default(), |all, scene| all.union(&Bounds::of(scene)));
    let camera = Camera::framing(&bounds, azimuth_deg, 8.0, size.aspect());
    scenes
        .iter()
        .zip(plants)
        .map(|(scene, (_, _, caption))| {
            let mut image = render(&Tracer::build(scene), &camera, &looks, size, workers);
            canvas::caption(&mut image, caption, 1);
            image
        })
        .collect()
}

pub(super) fn daylight() -> Scene {
    let sun = SunLight { direction: Vec3::new(0.45, 0.7, 0.55).normalize(), strength: 0.6 };
    Scene { ground: Some(0.0), sun: Some(sun), ..Scene::default() }
}

pub(super) fn looks(species: &Species, petals: u32) -> Palette {
    let petal = Vec3::from(Color::hex(petals).linear());
    Palette {
        plants: vec![PlantLook::of(species), PlantLook { bark: Bark::plain(petal), leaf: petal }],
        ..Palette::default()
    }
}

pub(super) fn ratio(ratio: f32, lag: u32) -> Result<Control, ReproduceError> {
    Ok(Control::of_ratio(ratio, lag)?)
}

/// That siblings are of their species, and as high, to a share, as their base model.
pub(super) fn same_species(base: &Skeleton, siblings: &[&Skeleton], lower: f32) -> Claim {
    let lengths = siblings.iter().map(|one| (one.total_length() / base.total_length() - 1.0).abs());
    let off = lengths.fold(0.0, f64::max);
    let heights = siblings.iter().map(|one| one.height() / base.height());
    let [low, high] = heights.fold([9.0_f32, 0.0_f32], |[l, h], it| [l.min(it), h.max(it)]);
    let alike = siblings.iter().filter(|one| one.nodes() == base.nodes()).count();
    Claim {
        row: "ST-10",
        paper: "a varied model keeps the base model's structure",
        measured: format!(
            "{alike} of {} with its {} nodes, length off by {off:.1e} at most, heights {low:.2} to {high:.2} of the base's",
            siblings.len(),
            base.nodes()
        ),
        holds: alike == siblings.len() && off < 1e-4 && low > 1.0 - lower && high < 1.1,
    }
}

/// Figure 11: a lily and a varied one.
pub fn lily(
    seeds: RangeInclusive<u64>,
    library: &Library,
    size: PictureSettings,
    workers: &Workers,
) -> Result<Findings, ReproduceError> {
    let model = models::lily();
    let variation = Variation {
        control: ratio(0.72, 12)?,
        sensing_error: 3_f32.to_radians(),
        disturbance: 2.2_f32.to_radians(),
        ..Variation::default()
    };
    let varied = vary(&model.skeleton, &variation, *seeds.start())?;
    let other = vary(&model.skeleton, &variation, seeds.start() + 1)?;
    // The same noise answered at once: what is more than that is the work of the lag.
    let prompt = Variation { control: Control::DIRECT, ..variation };
    let kinds = [("stem", 0..=0), ("leaves and pedicels", 1..=1), ("tepals", 2..=2)];
    let mut rows = Vec::new();
    let mut claims = Vec::new();
    for (kind, orders) in kinds {
        let strays = mean_straying(&model.skeleton, &variation, seeds.clone(), orders.clone())?;
        let without = mean_straying(&model.skeleton, &prompt, seeds.clone(), orders)?;
        for (lag, strays) in [(12, strays), (0, without)] {
            let [angle, crossings, chord] =
                [strays.angle, strays.crossings, strays.chord].map(|v| v.to_string());
            rows.push([kind.to_string(), lag.to_string(), angle, crossings, chord]);
        }
        claims.push(Claim {
            row: "ST-12",
            paper: "ratio about 0.7 and a large lag show as curvature of stem, branches and leaves",
            measured: format!(
                "{kind}: {:.1} degrees off their course (root mean square), {:.1} without lag; swings a 100 sub-steps {:.1}, \
                 {:.1} without",
                strays.angle, without.angle, strays.crossings, without.crossings
            ),
            holds: strays.angle > 1.5 * without.angle && strays.crossings < 0.5 * without.crossings,
        });
    }
    claims.push(same_species(&model.skeleton, &[&varied, &other], 0.15));
    let palette = looks(&library.species("lily")?, 0xF2E3D0);
    let plants = [
        (&model, &model.skeleton, "base model".to_string()),
        (&model, &varied, "varied".into()),
        (&model, &other, "varied, another seed".into()),
    ];
    let images = row(&plants, palette, 20.0, larger(size), workers);
    Ok(Findings {
        claims,
        picture: canvas::side_by_side(&images, 4),
        tables: vec![(
            "straying.csv".into(),
            csv(["part", "lag", "rms_deg", "crossings_per_100", "chord_deg"], rows),
        )],
        pictures: Vec::new(),
    })
}

/// Half as large again: plants with fine parts.
fn larger(size: PictureSettings) -> PictureSettings {
    PictureSettings { width: size.width * 3 / 2, height: size.height * 3 / 2, ..size }
}

/// Figure 12: Horneophyton, (b) base, (c) random angles, (d) small lag, (e) large lag, disturbance rising.
pub fn horneophyton(
    seeds: RangeInclusive<u64>,
    library: &Library,
    size: PictureSettings,
    workers: &Workers,
) -> Result<Findings, ReproduceError> {
    let model = models::horneophyton();
    let base = &model.skeleton;
    let seed = *seeds.start();
    let strengths = [1.0_f32, 2.0, 3.0];
    let variation = |lag, strength: f32| {
        Ok::<_, ReproduceError>(Variation {
            control: ratio(0.85, lag)?,
            sensing_error: 0.0,
            disturbance: strength.to_radians(),
            ..Variation::default()
        })
    };
    let still = variation(3, 0.0)?;
    let cut = course(base, &still)?;
    let random = |seed| vary(&models::random_angles(base, 17.5_f32.to_radians(), seed), &still, 0);
    let mut chord = 0.0;
    for seed in seeds.clone() {
        chord += straying(&random(seed)?, &cut, 0..=9).chord;
    }
    let chord = chord / seeds.clone().count().max(1) as f32;
    let shown = random(seed)?;
    let mut plants = vec![
        (&model, base.clone(), "(b) base model".to_string()),
        (&model, shown, "(c) angles by up to 17.5 degrees".into()),
    ];
    let mut rows =
        vec![["c".to_string(), "0".into(), "0".into(), String::new(), String::new(), chord.to_string()]];
    let mut table = Vec::new();
    for (group, lag) in [("d", 3_u32), ("e", 12)] {
        for strength in strengths {
            // Errors grow with lag at one ratio: as strong a wave needs a weaker push.
            let push = strength * if lag == 3 { 1.6 } else { 0.8 };
            let variation = variation(lag, push)?;
            let strays = mean_straying(base, &variation, seeds.clone(), 0..=9)?;
            table.push(strays);
            rows.push([
                group.into(),
                lag.to_string(),
                push.to_string(),
                strays.angle.to_string(),
                strays.crossings.to_string(),
                strays.chord.to_string(),
            ]);
            let caption = format!("({group}) lag {lag}, disturbance {push:.1} degrees");
            plants.push((&model, vary(base, &variation, seed)?, caption));
        }
    }
    let of = |what: &dyn Fn(&Straying) -> f32| table.iter().map(what).collect::<Vec<f32>>();
    let (angles, crosses, chords) = (of(&|s| s.angle), of(&|s| s.crossings), of(&|s| s.chord));
    let rising = |part: &[f32]| part.windows(2).all(|w| w[1] > w[0]);
    let claims = vec![
        Claim {
            row: "ST-12",
            paper: "altering the lag varies the frequency (d against e)",
            measured: format!(
                "crossings of the course a 100 sub-steps: d {:.1?}, e {:.1?}",
                &crosses[..3],
                &crosses[3..]
            ),
            holds: (0..3).all(|k| crosses[k] > 1.5 * crosses[k + 3]),
        },
        Claim {
            row: "ST-12",
            paper: "altering the influence varies the magnitude (within d and within e)",
            measured: format!("degrees off the course: d {:.1?}, e {:.1?}", &angles[..3], &angles[3..]),
            holds: rising(&angles[..3]) && rising(&angles[3..]),
        },
        Claim {
            row: "ST-12",
            paper: "d and e preserve the branch shape better than random angles (c)",
            measured: format!(
                "whole branches turned by, degrees: c {chord:.1}, d {:.1?}, e {:.1?}",
                &chords[..3],
                &chords[3..]
            ),
            holds: chords.iter().all(|c| *c < chord),
        },
        same_species(base, &plants[2..].iter().map(|plant| &plant.1).collect::<Vec<_>>(), 0.15),
    ];
    let palette = looks(&library.species("horneophyton")?, 0x6E6A3A);
    let views: Vec<_> =
        plants.iter().map(|(model, skeleton, caption)| (*model, skeleton, caption.clone())).collect();
    let images = row(&views, palette, 20.0, size, workers);
    let sheet = [
        canvas::side_by_side(&images[..2], 4),
        canvas::side_by_side(&images[2..5], 4),
        canvas::side_by_side(&images[5..], 4),
    ];
    let header = ["group", "lag", "disturbance_deg", "rms_deg", "crossings_per_100", "chord_deg"];
    Ok(Findings {
        claims,
        picture: canvas::grid(&sheet, 1, 4),
        tables: vec![("straying.csv".into(), csv(header, rows))],
        pictures: Vec::new(),
    })
}

/// Figure 13: branches that set out outward and turn upward, ratio rising.
pub fn upward(
    seeds: RangeInclusive<u64>,
    library: &Library,
    size: PictureSettings,
    workers: &Workers,
) -> Result<Findings, ReproduceError> {
    let ratios = [0.7_f32, 0.85, 1.1];
    let first = models::outward(*seeds.start());
    let variation = |r: f32| {
        let plain = Variation::default();
        let tropisms = crate::tropism::Tropisms { ortho: 2.2, reach: 0.8, ..plain.tropisms };
        Ok::<_, ReproduceError>(Variation {
            control: ratio(r, 7)?,
            sensing_error: 2_f32.to_radians(),
            disturbance: 2.0_f32.to_radians(),
            sub_step: Some(0.01),
            tropisms,
            ..plain
        })
    };
    let mut strays = Vec::new();
    let mut ends_up = f32::INFINITY;
    let mut models = vec![first.clone()];
    for r in ratios {
        let variation = variation(r)?;
        let (mut angle, mut crossings, mut n) = (0.0, 0.0, 0.0);
        for seed in seeds.clone() {
            let model = models::outward(seed);
            let one = vary(&model.skeleton, &variation, seed)?;
            let seen = straying(&one, &course(&model.skeleton, &variation)?, 1..=1);
            (angle, crossings, n) = (angle + seen.angle, crossings + seen.crossings, n + 1.0);
            let rise = |at: f32| rise_of_branches(&one, at);
            ends_up = ends_up.min(rise(1.0) - rise(0.0));
        }
        strays.push((angle / n, crossings / n));
        models.push(models::outward(seeds.start() + models.len() as u64));
    }
    let claims = vec![
        Claim {
            row: "ST-12",
            paper: "branches initially grow outward, then bend upward",
            measured: format!(
                "their ends rise steeper than their bases by {ends_up:.0} degrees at least, on average of a plant"
            ),
            holds: ends_up > 25.0,
        },
        Claim {
            row: "ST-12",
            paper: "with a higher compensation ratio, less divergence from the base model",
            measured: format!(
                "degrees off the course at ratio {ratios:?}: {:.1}, {:.1}, {:.1}",
                strays[0].0, strays[1].0, strays[2].0
            ),
            holds: strays.windows(2).all(|w| w[1].0 < w[0].0),
        },
        Claim {
            row: "ST-12",
            paper: "and variation of lower frequency",
            measured: format!(
                "crossings of the course a 100 sub-steps: {:.2}, {:.2}, {:.2}",
                strays[0].1, strays[1].1, strays[2].1
            ),
            holds: strays.windows(2).all(|w| w[1].1 < w[0].1),
        },
    ];
    let mut plants = vec![(&models[0], models[0].skeleton.clone(), "base model".to_string())];
    for (model, r) in models[1..].iter().zip(ratios) {
        plants.push((model, vary(&model.skeleton, &variation(r)?, *seeds.start())?, format!("ratio {r}")));
    }
    let views: Vec<_> =
        plants.iter().map(|(model, skeleton, caption)| (*model, skeleton, caption.clone())).collect();
    let images = row(&views, looks(&library.species("oak")?, 0xFFFFFF), 20.0, size, workers);
    let rows = ratios.iter().zip(&strays).map(|(r, s)| [*r, s.0, s.1]);
    Ok(Findings {
        claims,
        picture: canvas::side_by_side(&images, 4),
        tables: vec![("straying.csv".into(), csv(["ratio", "rms_deg", "crossings_per_100"], rows))],
        pictures: Vec::new(),
    })
}

/// Mean elevation of branches of order 1 at their base (0) or end (1), degrees.
fn rise_of_branches(plant: &Skeleton, at: f32) -> f32 {
    let (mut sum, mut n) = (0.0, 0.0_f32);
    let stems = &plant.segments;
    for (i, piece) in stems.iter().enumerate().filter(|(_, s)| s.order == 1) {
        let edge = match at > 0.5 {
            false => stems[piece.parent as usize].order == 0,
            true => !stems[i + 1..].iter().any(|s| s.parent == i as u32 && s.order == 1),
        };
        if edge {
            sum += ops::asin(piece.pose.heading().y.clamp(-1.0, 1.0)).to_degrees();
            n += 1.0;
        }
    }
    sum / n.max(1.0)
}
