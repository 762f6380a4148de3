//! Form at ten years, and in release at thirty: ranges over five seeds, and what is measured of real trees.

use burgeon::growth::vigour::height_factor;
use burgeon::reproduce::measure::tangles;

use super::*;
use crate::common::measure::median;

/// A measure of form.
type Measure = (&'static str, fn(&Form) -> f64);

/// What is measured, in the order of the ranges and figures below.
const MEASURES: [Measure; 10] = [
    ("height, m", |form| form.height_m.into()),
    ("crown width, m", |form| form.crown_width_m.into()),
    ("live crown base over height", |form| (form.live_crown_base_m / form.height_m).into()),
    ("widest height over height", |form| (form.widest_height_m / form.height_m).into()),
    ("share of side axes that droops", |form| form.drooping_share.into()),
    ("diameter at breast height, m", |form| form.breast_diameter_m.into()),
    ("leaf area, m2", |form| form.leaf_area_m2),
    ("leaf area over that of the crown on the ground", |form| {
        let radius = 0.5 * f64::from(form.crown_width_m);
        form.leaf_area_m2 / (std::f64::consts::PI * radius * radius)
    }),
    ("share of internodes of order 2 and above", |form| {
        1.0 - f64::from(form.by_order[0] + form.by_order[1]) / f64::from(form.internodes)
    }),
    ("branches to each of the next order of Strahler", |form| form.bifurcation_ratio.into()),
];

/// What five seeds of a species measure at an age, each of [`MEASURES`].
struct Known {
    name: &'static str,
    ranges: [(f64, f64); MEASURES.len()],
}

/// What is known of open-grown ones at an age, each of [`MEASURES`]: the middle of five seeds lies in it.
struct Figures {
    name: &'static str,
    bands: [Option<(f64, f64)>; MEASURES.len()],
}

include!("ranges.rs");
include!("figures.rs");

fn forms(name: &str, years: u32) -> Vec<Form> {
    let resolved = alone(name);
    let steps = years * resolved.species[name].steps_per_year;
    over_seeds(1..6, |seed| Form::of(&last(resolved.clone(), seed, steps), None))
}

/// Measures every species and holds it against its ranges and against real ones; all that does not fit is told at once.
fn measured(years: u32, known: &[Known], figures: &[Figures]) {
    let mut wrong = Vec::new();
    for species in known {
        let forms = forms(species.name, years);
        let bands = figures.iter().find(|figures| figures.name == species.name).unwrap().bands;
        let mut row = format!("{:16}", species.name);
        for (((what, of), (low, high)), band) in MEASURES.iter().zip(species.ranges).zip(bands) {
            let values: Vec<f64> = forms.iter().map(of).collect();
            let (least, most) = values.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
            let middle = median(values);
            row += &format!(" {least:.3} {middle:.3} {most:.3},");
            if least < low || most > high {
                wrong.push(format!("{} {what}: {least:.3} to {most:.3}, not {low} to {high}", species.name));
            }
            if let Some((low, high)) = band.filter(|(low, high)| !(*low..=*high).contains(&middle)) {
                wrong.push(format!("{} {what}: {middle:.3}, real ones {low:.3} to {high:.3}", species.name));
            }
        }
        println!("{row}");
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn at_ten_years_every_species_has_its_form() {
    measured(10, &AT_TEN, &figures_at_ten());
}

/// Sixty-five trees of thirty years take a quarter of an hour.
#[cfg(not(debug_assertions))]
#[test]
fn at_thirty_years_every_species_has_its_form() {
    measured(30, &AT_THIRTY, &figures_at_thirty());
}

#[test]
fn every_species_has_ranges_and_figures_at_both_ages() {
    let known = |known: &[Known]| known.iter().map(|species| species.name).collect::<Vec<_>>();
    let figures = |figures: &[Figures]| figures.iter().map(|species| species.name).collect::<Vec<_>>();
    for mut names in
        [known(&AT_TEN), known(&AT_THIRTY), figures(&figures_at_ten()), figures(&figures_at_thirty())]
    {
        names.sort_unstable();
        let mut trees = trees();
        trees.sort_unstable();
        assert_eq!(names, trees);
    }
}

/// What five seeds measure and what is known of real ones meet, at thirty years too, where the trees themselves are grown
/// in release alone.
#[test]
fn ranges_meet_what_real_trees_measure() {
    for (known, figures) in [(&AT_TEN, figures_at_ten()), (&AT_THIRTY, figures_at_thirty())] {
        for (species, figures) in known.iter().zip(figures) {
            assert_eq!(species.name, figures.name);
            for (((what, _), (low, high)), band) in MEASURES.iter().zip(species.ranges).zip(figures.bands) {
                let Some((least, most)) = band else { continue };
                let middle = 0.5 * (low + high);
                assert!(
                    (least..=most).contains(&middle),
                    "{} {what}: {low} to {high}, real ones {least:.2} to {most:.2}",
                    species.name
                );
            }
        }
    }
}

#[test]
fn no_two_species_share_all_ranges() {
    for (i, a) in AT_THIRTY.iter().enumerate() {
        for b in &AT_THIRTY[i + 1..] {
            let apart = a.ranges.iter().zip(&b.ranges).any(|(a, b)| a.1 < b.0 || b.1 < a.0);
            assert!(apart, "{} and {} share all ranges", a.name, b.name);
        }
    }
}

/// Asserts that no more pairs than `most` of a thousand internodes run through each other, nor as twigs alone more than
/// `of_twigs`, in three seeds of any species.
fn untangled(years: u32, of_twigs: f64, most: f64) {
    let mut tangled = Vec::new();
    for name in trees() {
        let resolved = alone(&name);
        let steps = years * resolved.species[&name].steps_per_year;
        let each_thousand = over_seeds(1..4, |seed| {
            let shot = last(resolved.clone(), seed, steps);
            let (tangles, stems) = (tangles(&shot), Form::of(&shot, None).internodes.max(1));
            [tangles.of_twigs, tangles.all()].map(|pairs| 1000.0 * pairs as f64 / f64::from(stems))
        });
        println!("{name}, of twigs and all, a thousand internodes: {each_thousand:.1?}");
        if each_thousand.iter().any(|[twigs, all]| *twigs > of_twigs || *all > most) {
            tangled.push((name, each_thousand));
        }
    }
    assert!(tangled.is_empty(), "{tangled:?}");
}

#[test]
fn branches_of_one_tree_do_not_run_through_each_other() {
    untangled(11, 1.0, 4.0);
}

#[cfg(not(debug_assertions))]
#[test]
fn nor_do_those_of_old_trees_but_for_a_few_in_a_thousand() {
    untangled(30, 4.0, 6.0);
}

/// Height (m) and leaf area (m2) of a species at 17 years on ground of some richness, with what wood costs and without.
fn held_and_free(name: &str, richness: f32) -> Vec<[(f64, f64); 2]> {
    let grown = |costs: bool, seed: u64| {
        let mut resolved = coarse(alone(name));
        let species = resolved.species.get_mut(name).unwrap();
        species.leaf_income *= richness;
        if !costs {
            (species.wood_cost, species.wood_share) = (0.0, 0.0);
        }
        let form = Form::of(&last(resolved, seed, 17), None);
        (f64::from(form.height_m), form.leaf_area_m2)
    };
    let both = over_seeds(1..4, |seed| [grown(true, seed), grown(false, seed)]);
    println!("{name} x {richness} at 17 years, held back by wood and free: {both:.1?}");
    both
}

#[test]
fn what_wood_costs_holds_a_tree_back() {
    // On rich ground the leader of a poplar or a birch grows its whole flush with or without it; a maple's height is that
    // of its forks.
    for (name, held_on) in [
        ("oak", Some(1.0)),
        ("lombardy_poplar", Some(0.7)),
        ("silver_birch", Some(0.7)),
        ("japanese_maple", None),
    ] {
        let rich = held_and_free(name, 1.0);
        assert!(rich.iter().all(|[held, free]| 1.2 * held.1 < free.1), "{name}: leaf area {rich:?}");
        let all = match held_on {
            Some(1.0) => rich,
            Some(poor) => held_and_free(name, poor),
            None => continue,
        };
        assert!(all.iter().all(|[held, free]| 1.08 * held.0 < free.0), "{name}: height {all:?}");
    }
}

/// A leader that grows its whole flush whatever wood costs stops by height, near that of real trees of eighty years.
#[test]
fn leaders_that_wood_does_not_hold_back_stop_where_real_trees_do() {
    for (name, real) in [("silver_birch", 21.0), ("lombardy_poplar", 28.0_f32)] {
        let species = Species::named(name).unwrap();
        let grown_in = |years: u32| {
            let summer = species.flush_internodes.get(0) * species.node_spacing_m;
            (0..years).fold(0.0, |height, _| height + summer * height_factor(&species, height))
        };
        let [at_thirty, at_eighty, at_hundred] = [30, 80, 100].map(grown_in);
        println!("{name}, fed as well as can be: {at_thirty:.1}, {at_eighty:.1}, {at_hundred:.1} m");
        assert!((0.9..1.15).contains(&(at_eighty / real)), "{name}: {at_eighty} m at eighty years");
        assert!(at_hundred - at_eighty < 0.1 * at_thirty, "{name}: {at_eighty} and {at_hundred} m");
    }
}

#[test]
fn trees_that_do_not_avoid_wood_tangle() {
    let mut heedless = alone("umbrella_acacia");
    heedless.species.values_mut().for_each(|species| species.avoids_wood = false);
    let of = |resolved| tangles(&last(resolved, 1, 17));
    let (heedless, heeding) = (of(heedless), of(alone("umbrella_acacia")));
    assert!(heeding.of_twigs == 0 && heedless.of_twigs > 10, "{heeding:?} and {heedless:?}");
}

/// Crown width of an open-grown tree by its diameter at breast height (cm): `ln CW = a + b ln D`, Hasenauer 1997; and
/// height of a dominant tree in a stand by diameter and age (A): `H = exp(c - p / x + q / x2 + r A - s A2) / 10` with
/// `x = 10 D + 50`, Soderberg 1992 for southern Sweden, of which trees in the open fall short.
#[test]
fn crown_width_and_height_follow_trunk_diameter_as_measured() {
    const AGE: f64 = 30.0;
    let exp = |power: f64| f64::from(ops::exp(power as f32));
    for (name, [a, b], [c, p, q, r, s]) in [
        ("oak", [-0.397, 0.733], [5.78, 258.0, 6310.0, 0.0, 0.0]),
        ("silver_birch", [0.178, 0.567], [5.80, 226.0, 3917.0, 0.0017, 1.2e-5]),
        ("norway_spruce", [-0.323, 0.644], [6.02, 274.0, 3801.0, 0.0031, 2.1e-5]),
        ("scots_pine", [-0.180, 0.627], [5.71, 303.0, 8843.0, 0.0069, 3.9e-5]),
        ("beech", [0.266, 0.607_f64], [5.093, 144.0, 0.0, 0.0072, 2.7e-5]),
    ] {
        let resolved = coarse(alone(name));
        for form in over_seeds(1..3, |seed| Form::of(&last(resolved.clone(), seed, 30), None)) {
            let diameter_cm = 100.0 * f64::from(form.breast_diameter_m);
            let wide = f64::from(form.crown_width_m) / exp(a + b * f64::from(ops::ln(diameter_cm as f32)));
            let x = 10.0 * diameter_cm + 50.0;
            let stand = 0.1 * exp(c - p / x + q / (x * x) + r * AGE - s * AGE * AGE);
            let high = f64::from(form.height_m) / stand;
            println!(
                "{name}: {diameter_cm:.0} cm, crown {wide:.2} of Hasenauer's, height {high:.2} of Soderberg's"
            );
            assert!((0.6..1.75).contains(&wide), "{name}: {wide}");
            assert!((0.5..1.25).contains(&high), "{name}: {high}");
        }
    }
}
