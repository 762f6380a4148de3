//! A species while it is edited: what it is now, what it shall be.

use std::sync::Arc;

use crate::scenario::{Edit, Order};
use crate::species::Species;
use crate::species::parameter::{ParameterError, Value};

/// From when on a change counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum When {
    /// What has grown stays, and grows on changed.
    #[default]
    GoOn,
    /// The tree grows again from its seed.
    Regrow,
}

impl When {
    /// What it does, in a sentence.
    pub fn help(self) -> &'static str {
        match self {
            Self::GoOn => "What has grown stays; the plants grow on as changed.",
            Self::Regrow => {
                "The plants grow again from their seeds, as if they had always been so; undo brings the old ones back."
            }
        }
    }
}

/// A species with changes that are not applied yet.
#[derive(Debug, Clone, PartialEq)]
pub struct Draft {
    now: Arc<Species>,
    wanted: Species,
}

impl Draft {
    /// Nothing changed yet.
    pub fn of(now: &Arc<Species>) -> Self {
        Self { now: now.clone(), wanted: Species::clone(now) }
    }

    /// The species' name.
    pub fn name(&self) -> &str {
        &self.now.name
    }

    /// The species as it is.
    pub fn now(&self) -> &Species {
        &self.now
    }

    /// The species as it shall be.
    pub fn species(&self) -> &Species {
        &self.wanted
    }

    /// The species is another now: by an edit, an undo, or at another step. Changes made here stay.
    pub fn follow(&mut self, now: &Arc<Species>) {
        if Arc::ptr_eq(&self.now, now) || self.now == *now {
            return;
        }
        let changes = self.changes();
        self.now = now.clone();
        self.wanted = Species::clone(now);
        for (name, value) in changes {
            // It was allowed before, and ranges do not move.
            self.set(name, &value).ok();
        }
    }

    /// Takes over the parameters of another species; the name stays that by which plants go.
    pub fn take_over(&mut self, other: &Species) {
        self.wanted = Species { name: self.now.name.clone(), ..other.clone() };
    }

    /// Sets a parameter.
    ///
    /// # Errors
    /// A value that is not allowed, which changes nothing.
    pub fn set(&mut self, name: &str, value: &Value) -> Result<(), ParameterError> {
        self.wanted.set(name, value)
    }

    /// Whether a parameter is changed.
    pub fn is_changed(&self, name: &str) -> bool {
        self.now.get(name) != self.wanted.get(name)
    }

    /// Makes a parameter what it is.
    pub fn reset(&mut self, name: &str) {
        if let Some(value) = self.now.get(name) {
            // What the species has is allowed.
            self.set(name, &value).ok();
        }
    }

    /// Forgets all changes.
    pub fn discard(&mut self) {
        self.wanted = Species::clone(&self.now);
    }

    /// What is changed.
    pub fn changes(&self) -> Vec<(&'static str, Value)> {
        let changed = Species::parameters().iter().filter(|row| self.is_changed(row.name));
        changed.filter_map(|row| Some((row.name, self.wanted.get(row.name)?))).collect()
    }

    /// The order that makes the changes; `None` if there are none.
    pub fn order(&self, when: When) -> Option<Order> {
        let changes = self.changes();
        let values = changes.into_iter().map(|(name, value)| (name.to_string(), value.to_string()));
        let edit = Edit::SetAll { species: self.name().to_string(), values: values.collect() };
        let step = match when {
            When::GoOn => None,
            When::Regrow => Some(0),
        };
        let Edit::SetAll { values, .. } = &edit else { return None };
        (!values.is_empty()).then_some(Order::Edit { step, edit, drag: false })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_become_one_edit_from_now_or_from_the_beginning() {
        let now = Arc::new(Species::default());
        let mut draft = Draft::of(&now);
        assert_eq!(draft.order(When::GoOn), None);
        draft.set("candidates", &Value::Whole(33)).unwrap();
        assert!(
            draft
                .set("leaf_length_m", &Value::Real(1.0e9))
                .unwrap_err()
                .to_string()
                .contains("leaf_length_m")
        );
        assert!(draft.is_changed("candidates") && !draft.is_changed("leaf_length_m"));
        let Some(Order::Edit { step: Some(0), edit: Edit::SetAll { species, values }, .. }) =
            draft.order(When::Regrow)
        else {
            panic!("no edit")
        };
        assert_eq!((species.as_str(), values), ("lam_king", vec![("candidates".into(), "33".into())]));
        assert!(matches!(draft.order(When::GoOn), Some(Order::Edit { step: None, .. })));
    }

    #[test]
    fn changes_stay_when_the_species_changes_underneath() {
        let now = Arc::new(Species::default());
        let mut draft = Draft::of(&now);
        draft.set("candidates", &Value::Whole(33)).unwrap();
        let later = Arc::new(Species { leaf_cost: 2.0, ..Species::default() });
        draft.follow(&later);
        assert_eq!((draft.species().candidates, draft.species().leaf_cost), (33, 2.0));
        draft.reset("candidates");
        assert_eq!(draft.changes(), []);
        draft.take_over(&Species { name: "other".into(), leaf_life_steps: 3, ..Species::default() });
        assert_eq!(draft.name(), "lam_king");
        assert_eq!(draft.changes().len(), 2);
        draft.discard();
        assert_eq!(draft.changes(), []);
    }
}
