//! What holds after every step, whatever grows.

mod common;

use bevy::prelude::*;
use burgeon::limits::GrowthLimits;
use burgeon::plant::{Fallen, Snapshot};
use burgeon::scenario::{Garden, GardenError};
use burgeon::species::Species;
use burgeon::species::parameter::{Parameter, Range, Value};
use common::check::{check, check_since, check_solids, check_world};
use common::{garden, over_seeds, pot, quick};
use proptest::prelude::*;

/// Grows a garden until it has more organs than `most`, and checks everything after every step.
fn watch(garden: &mut Garden, steps: u32, most: usize) -> Result<(), String> {
    let mut before = Snapshot::default();
    for step in 0..steps {
        let at = |e: String| format!("step {step}: {e}");
        match garden.step() {
            Ok(_) => {}
            Err(GardenError::Limit(_)) if step > 0 => break,
            Err(e) => return Err(at(e.to_string())),
        }
        let shot = garden.snapshot();
        check(&shot).and_then(|()| check_since(&before, &shot)).map_err(at)?;
        check_world(garden.world_mut()).map_err(at)?;
        check_solids(garden.world_mut(), &shot).map_err(at)?;
        if shot.len() > most {
            break;
        }
        before = shot;
    }
    Ok(())
}

#[test]
fn invariants_hold_after_every_step() {
    let runs = [
        ("figure_1a", 7),
        ("figure_1b", 5),
        ("figure_1c", 10),
        ("open", 9),
        ("wall", 10),
        ("lamp", 9),
        ("courtyard", 9),
        ("two_oaks", 9),
    ];
    for (name, steps) in runs {
        over_seeds(1..4, |seed| {
            if let Err(broken) = watch(&mut garden(quick(name), seed), steps, 20_000) {
                panic!("{name}, seed {seed}: {broken}");
            }
        });
    }
}

#[test]
fn tombstones_are_kept_up_to_their_limit() {
    let mut nursery = common::by_hand::Nursery::new(Species::default());
    let trunk = nursery.stem(None, 0.2);
    let birth = nursery.birth(trunk);
    let mut fallen = Fallen::default();
    burgeon::plant::shed(nursery.app.world_mut(), &[(birth, burgeon::plant::Cause::Pruned)]);
    std::mem::swap(&mut fallen, &mut nursery.app.world_mut().resource_mut::<Fallen>());
    let stone = fallen.tombstones[0];
    fallen.tombstones = std::iter::repeat_n(stone, Fallen::LIMIT).collect();
    *nursery.app.world_mut().resource_mut::<Fallen>() = fallen;
    let trunk = nursery.stem(None, 0.2);
    let birth = nursery.birth(trunk);
    burgeon::plant::shed(nursery.app.world_mut(), &[(birth, burgeon::plant::Cause::Crushed)]);
    let fallen = nursery.app.world().resource::<Fallen>();
    assert_eq!((fallen.tombstones.len(), fallen.total), (Fallen::LIMIT, 2));
    assert_eq!(fallen.tombstones.back().unwrap().birth, birth);
}

/// Any value the table allows, small ones as likely as large.
fn value(parameter: &Parameter) -> BoxedStrategy<Value> {
    let real = |range: Range| match range {
        Range::Real { min, max } => {
            let (least, reach) = (min, max - min);
            // A draw over the whole range, or one near its lower end.
            prop_oneof![
                (0.0..=1.0_f64).prop_map(move |t| least + reach * t),
                (0.0..=1.0_f64).prop_map(move |t| least + reach.min(1.0) * t * t),
                Just(min),
                Just(max),
            ]
            .boxed()
        }
        Range::Whole { min, max } => {
            prop_oneof![(min..=max).prop_map(f64::from), (min..=max.min(min + 4)).prop_map(f64::from)].boxed()
        }
        Range::Any => Just(0.0).boxed(),
    };
    if !parameter.choices.is_empty() {
        return prop::sample::select(parameter.choices).prop_map(|c| Value::Choice(c.into())).boxed();
    }
    match &parameter.default {
        Value::Flag(_) => any::<bool>().prop_map(Value::Flag).boxed(),
        Value::Whole(_) => real(parameter.range).prop_map(|x| Value::Whole(x as u32)).boxed(),
        Value::List(_) => prop::collection::vec(real(parameter.range), 1..4).prop_map(Value::List).boxed(),
        _ => real(parameter.range).prop_map(Value::Real).boxed(),
    }
}

/// A species with some of its parameters anywhere in their ranges.
fn any_species() -> impl Strategy<Value = Species> {
    let table = Species::parameters();
    prop::collection::vec((0..table.len()).prop_flat_map(|i| (Just(i), value(&table[i]))), 1..12).prop_map(
        |changes| {
            let mut species = Species::default();
            for (i, value) in changes {
                // Colours alone are lists of a fixed length; what does not fit leaves the default.
                let _ = species.set(Species::parameters()[i].name, &value);
            }
            species
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn invariants_hold_for_any_species(species in any_species(), seed in 0..1000_u64) {
        let mut garden = garden(pot(species), seed);
        // A step may bear a thousandfold.
        garden.set_limits(GrowthLimits { organs: 20_000, ..default() });
        watch(&mut garden, 6, 3_000).map_err(TestCaseError::fail)?;
    }
}
