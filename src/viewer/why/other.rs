//! What a second garden differs in from the first.

use std::collections::BTreeSet;

use crate::files::SharedTree;
use crate::growth::Mechanisms;
use crate::scenario::{Edit, TimedEdit};
use crate::species::parameter::{ParameterError, Value};

/// A part of the model that can be switched off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Light.
    Light,
    /// Space.
    Space,
    /// Energy.
    Energy,
}

impl Part {
    /// All of them, with their names.
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::Light, "light"), (Self::Space, "space"), (Self::Energy, "energy")];

    fn of(self, mechanisms: &mut Mechanisms) -> &mut bool {
        match self {
            Self::Light => &mut mechanisms.light,
            Self::Space => &mut mechanisms.space,
            Self::Energy => &mut mechanisms.energy,
        }
    }

    /// Whether it runs.
    pub fn runs(self, mut mechanisms: Mechanisms) -> bool {
        *self.of(&mut mechanisms)
    }
}

/// The one thing that differs; it does from the seed on, whatever was edited later.
#[derive(Debug, Clone, PartialEq)]
pub enum Other {
    /// A part of the model runs, or does not.
    Part(Part, bool),
    /// A parameter of a species has another value.
    Parameter {
        /// Name of the species.
        species: String,
        /// The parameter.
        parameter: &'static str,
        /// Its value.
        value: Value,
    },
    /// No wall, ball or pillar stands there.
    WithoutSolids,
    /// No lamp does.
    WithoutLamps,
}

impl Other {
    /// What it is called in a picture.
    pub fn title(&self) -> String {
        match self {
            Self::Part(part, on) => {
                let name = Part::ALL.iter().find(|(each, _)| each == part).map_or("", |(_, name)| name);
                format!("{} {name}", if *on { "with" } else { "without" })
            }
            Self::Parameter { species, parameter, value } => {
                format!("{species}: {} {value}", parameter.replace('_', " "))
            }
            Self::WithoutSolids => "without walls".into(),
            Self::WithoutLamps => "without lamps".into(),
        }
    }

    /// Makes all that is needed to grow a garden differ in this, and in nothing else.
    ///
    /// # Errors
    /// A value the species does not allow; nothing is changed then.
    pub fn apply(&self, copy: &mut SharedTree) -> Result<(), ParameterError> {
        match self {
            Self::Part(part, on) => {
                *part.of(&mut copy.resolved.scenario.mechanisms) = *on;
                for timed in copy.resolved.scenario.edits.iter_mut().chain(&mut copy.edits) {
                    if let Edit::Mechanisms(mechanisms) = &mut timed.edit {
                        *part.of(mechanisms) = *on;
                    }
                }
            }
            Self::Parameter { species, parameter, value } => {
                if let Some(species) = copy.resolved.species.get_mut(species) {
                    species.set(parameter, value)?;
                }
                for timed in copy.resolved.scenario.edits.iter_mut().chain(&mut copy.edits) {
                    if let Edit::SetAll { species: of, values } = &mut timed.edit
                        && of == species
                    {
                        values.retain(|(name, _)| name != parameter);
                    }
                }
                retain(copy, |edit| match edit {
                    Edit::Set { species: of, parameter: name, .. } => of != species || name != parameter,
                    Edit::SetAll { values, .. } => !values.is_empty(),
                    _ => true,
                });
            }
            Self::WithoutSolids => {
                let scenario = &mut copy.resolved.scenario;
                let names = scenario.solids.drain(..).map(|solid| solid.name).collect();
                without(copy, names, |edit| match edit {
                    Edit::PlaceSolid(solid) => Some(&solid.name),
                    _ => None,
                });
            }
            Self::WithoutLamps => {
                let scenario = &mut copy.resolved.scenario;
                let names = scenario.lamps.drain(..).map(|lamp| lamp.name).collect();
                without(copy, names, |edit| match edit {
                    Edit::PlaceLamp(lamp) => Some(&lamp.name),
                    _ => None,
                });
            }
        }
        Ok(())
    }
}

/// Takes out the edits that are not wanted.
fn retain(copy: &mut SharedTree, wanted: impl Fn(&Edit) -> bool) {
    copy.resolved.scenario.edits.retain(|timed| wanted(&timed.edit));
    copy.edits.retain(|timed| wanted(&timed.edit));
}

/// Takes out all edits of things of a kind: of those with these names, and those that edits set.
fn without(copy: &mut SharedTree, mut names: BTreeSet<String>, sets: impl Fn(&Edit) -> Option<&String>) {
    let all = || copy.resolved.scenario.edits.iter().chain(&copy.edits).map(|timed: &TimedEdit| &timed.edit);
    names.extend(all().filter_map(&sets).cloned());
    // A copy of a copy may stand before it in the list.
    loop {
        let copies = all().filter_map(|edit| match edit {
            Edit::Duplicate { name, copy, .. } if names.contains(name) => Some(copy.clone()),
            _ => None,
        });
        let more: Vec<String> = copies.filter(|copy| !names.contains(copy)).collect();
        if more.is_empty() {
            break;
        }
        names.extend(more);
    }
    retain(copy, |edit| match edit {
        Edit::Move { name, .. }
        | Edit::Pose { name, .. }
        | Edit::Duplicate { name, .. }
        | Edit::Shine { name, .. }
        | Edit::Switch { name, .. }
        | Edit::Remove { name } => !names.contains(name),
        edit => sets(edit).is_none(),
    });
}

#[cfg(test)]
mod tests {
    use bevy::prelude::*;

    use super::*;
    use crate::assets::Library;
    use crate::environment::workers::Workers;
    use crate::scenario::{PlacedLamp, PlacedSolid, Timeline};

    /// Dusk as someone has edited it.
    fn edited() -> SharedTree {
        let wall = |name: &str| PlacedSolid { name: name.into(), ..default() };
        let name = || "second".to_owned();
        let edits = [
            Edit::PlaceSolid(wall("second")),
            Edit::Move { name: "wall".into(), to: Vec3::new(-2.0, 1.1, 0.0), turn_deg: 90.0 },
            Edit::Duplicate { name: name(), copy: "third".into(), to: Vec3::new(3.0, 1.0, 3.0) },
            Edit::Duplicate { name: "third".into(), copy: "fourth".into(), to: Vec3::new(4.0, 1.0, 3.0) },
            Edit::PlaceLamp(PlacedLamp { name: "torch".into(), ..default() }),
            Edit::Switch { name: "lamp".into(), on: false },
            Edit::Remove { name: "fourth".into() },
            Edit::Set { species: "oak".into(), parameter: "candidates".into(), value: "9".into() },
            Edit::SetAll {
                species: "oak".into(),
                values: vec![("candidates".into(), "11".into()), ("leaf_cost".into(), "0.2".into())],
            },
            Edit::Mechanisms(Mechanisms { space: false, ..default() }),
        ];
        let library = Library::embedded();
        let edits = edits.into_iter().map(|edit| TimedEdit { step: 2, edit }).collect();
        SharedTree { resolved: library.scenario("dusk").unwrap(), edits, seed: 3, steps: 3 }
    }

    fn differing(other: &Other) -> SharedTree {
        let mut copy = edited();
        other.apply(&mut copy).unwrap();
        copy
    }

    /// Names of solids and lamps at its last step, none of its edits having lapsed.
    fn standing(copy: SharedTree) -> (Vec<String>, Vec<String>) {
        let steps = copy.steps;
        let mut timeline =
            Timeline::from_shared(copy, Library::embedded(), Workers::new(1).unwrap()).unwrap();
        while timeline.present() < steps {
            timeline.advance().unwrap();
        }
        assert_eq!(timeline.lapsed().count(), 0);
        let standing = timeline.standing(steps).unwrap();
        let solids = standing.solids.iter().map(|solid| solid.name.clone()).collect();
        (solids, standing.lamps.iter().map(|lamp| lamp.name.clone()).collect())
    }

    #[test]
    fn no_wall_stands_without_walls_and_no_lamp_without_lamps() {
        let (walls, lamps) = standing(edited());
        assert_eq!((walls.len(), lamps.len()), (3, 2));
        assert_eq!(standing(differing(&Other::WithoutSolids)), (vec![], lamps));
        assert_eq!(standing(differing(&Other::WithoutLamps)), (walls, vec![]));
    }

    #[test]
    fn a_parameter_differs_from_the_seed_on_whatever_was_set_later() {
        let parameter = "candidates";
        let other = Other::Parameter { species: "oak".into(), parameter, value: Value::Whole(21) };
        let copy = differing(&other);
        assert_eq!(copy.resolved.species["oak"].candidates, 21);
        let sets: Vec<&Edit> = copy.edits.iter().map(|timed| &timed.edit).collect();
        assert!(!sets.iter().any(|edit| matches!(edit, Edit::Set { .. })));
        let values = vec![("leaf_cost".to_owned(), "0.2".to_owned())];
        assert!(sets.contains(&&Edit::SetAll { species: "oak".into(), values }), "the rest stays");
        assert_eq!(copy.edits.len(), edited().edits.len() - 1);
        let much = Other::Parameter { species: "oak".into(), parameter, value: Value::Whole(1_000_000) };
        let mut copy = edited();
        assert!(much.apply(&mut copy).unwrap_err().to_string().contains(parameter));
        assert_eq!(copy, edited(), "nothing is changed");
    }

    #[test]
    fn a_part_differs_however_often_it_was_switched() {
        for (part, _) in Part::ALL {
            for on in [false, true] {
                let copy = differing(&Other::Part(part, on));
                assert_eq!(part.runs(copy.resolved.scenario.mechanisms), on);
                let Some(Edit::Mechanisms(late)) = copy.edits.last().map(|timed| &timed.edit) else {
                    panic!("the edit stays")
                };
                assert_eq!(part.runs(*late), on);
                assert_eq!(Part::Space.runs(*late), part == Part::Space && on, "the others are as they were");
            }
        }
    }
}
