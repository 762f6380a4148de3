//! Settings from the command line: `species.branching_angle_deg=45`, `scenario.ground=false`,
//! `lamp.east.strength=20`.

use super::{FileError, Place, ResolvedScenario};
use crate::environment::SkyGradient;
use crate::environment::probe::{SensingMode, TexelWeight};
use crate::scenario::{PlacedSun, Scenario};
use crate::species::Species;
use crate::species::parameter::{ParameterError, ParameterType, Value, nearest, shorten};

/// A value as people write it: `4`, `0.5`, `true`, `[60, 55]`, `(0.4, 0.3, 0.2)` or a name.
///
/// What is none of these comes out as a name, which no number or list takes.
pub fn parse_value(text: &str) -> Value {
    let text = text.trim();
    if let Ok(n) = text.parse::<u32>() {
        return Value::Whole(n);
    }
    if let Ok(x) = text.parse::<f64>() {
        return Value::Real(x);
    }
    if let Ok(flag) = text.parse::<bool>() {
        return Value::Flag(flag);
    }
    let list = text
        .strip_prefix('[')
        .and_then(|t| t.strip_suffix(']'))
        .or_else(|| text.strip_prefix('(').and_then(|t| t.strip_suffix(')')));
    if let Some(inner) = list {
        let inner = inner.trim().trim_end_matches(',');
        if inner.is_empty() {
            return Value::List(Vec::new());
        }
        let numbers: Result<Vec<f64>, _> = inner.split(',').map(|x| x.trim().parse()).collect();
        if let Ok(numbers) = numbers {
            return Value::List(numbers);
        }
    }
    Value::Choice(text.into())
}

const SCENARIO: [&str; 15] = [
    "steps",
    "ground",
    "sky.strength",
    "sky.gradient",
    "sun.elevation_deg",
    "sun.azimuth_deg",
    "sun.strength",
    "mechanisms.light",
    "mechanisms.space",
    "mechanisms.energy",
    "sensing.leaf_face",
    "sensing.bud_face",
    "sensing.mode",
    "sensing.weight",
    "name",
];

impl ResolvedScenario {
    /// Makes one setting, `key=value`. Keys are `species.X` (every species of the scenario), `species.NAME.X`,
    /// `scenario.X` and `lamp.NAME.strength`, `.radius` or `.on`.
    ///
    /// # Errors
    /// [`FileError`] whose file is the setting itself; nothing is changed then.
    pub fn apply_set(&mut self, setting: &str) -> Result<(), FileError> {
        let at = Place::file(format!("--set {}", shorten(setting)));
        let Some((key, value)) = setting.split_once('=') else {
            let message = "write it as key=value, such as species.branching_angle_deg=45".into();
            return Err(FileError::Syntax { at, message });
        };
        let (key, value) = (key.trim(), value.trim());
        let (group, rest) = key.split_once('.').unwrap_or((key, ""));
        match group {
            "species" => self.set_species(at, rest, value),
            "scenario" => self.set_scenario(at, rest, value),
            "lamp" => self.set_lamp(at, rest, value),
            _ => Err(unknown(at, key, ["species", "scenario", "lamp"])),
        }
    }

    fn set_species(&mut self, at: Place, key: &str, value: &str) -> Result<(), FileError> {
        // Names may hold dots (`my.ron`), parameters do not.
        let (only, parameter) = match key.rsplit_once('.') {
            Some((name, parameter)) => (Some(name), parameter),
            None => (None, key),
        };
        if let Some(name) = only
            && !self.species.contains_key(name)
        {
            return Err(FileError::no_such_species(at, name, self.species.keys().cloned().collect()));
        }
        let parsed = parse_value(value);
        let wrong = |e: ParameterError| match e {
            ParameterError::Invalid { name, allowed, .. } => FileError::Invalid {
                at: at.clone(),
                field: format!("species.{name}"),
                value: shorten(value),
                allowed,
            },
            ParameterError::Unknown { name, nearest } => FileError::UnknownField {
                at: at.clone(),
                field: format!("species.{name}"),
                nearest: nearest.map(|n| format!("species.{n}")),
            },
        };
        // One trial first, so that a bad value leaves every species as it was.
        Species::default().set(parameter, &parsed).map_err(wrong)?;
        for (name, species) in &mut self.species {
            if only.is_none_or(|only| only == name) {
                species.set(parameter, &parsed).map_err(wrong)?;
            }
        }
        Ok(())
    }

    fn set_scenario(&mut self, at: Place, key: &str, value: &str) -> Result<(), FileError> {
        let mut next = self.scenario.clone();
        let parsed = parse_value(value);
        let taken = match key {
            "name" => {
                next.name = value.into();
                true
            }
            "steps" => take(&mut next.steps, &parsed),
            "ground" => take(&mut next.ground, &parsed),
            "sky.strength" => take(&mut next.sky.strength, &parsed),
            "sky.gradient" => match value {
                "Uniform" => put(&mut next.sky.gradient, SkyGradient::Uniform),
                "Overcast" => put(&mut next.sky.gradient, SkyGradient::Overcast),
                _ => false,
            },
            "sun.elevation_deg" => take(&mut sun(&mut next).elevation_deg, &parsed),
            "sun.azimuth_deg" => take(&mut sun(&mut next).azimuth_deg, &parsed),
            "sun.strength" => take(&mut sun(&mut next).strength, &parsed),
            "mechanisms.light" => take(&mut next.mechanisms.light, &parsed),
            "mechanisms.space" => take(&mut next.mechanisms.space, &parsed),
            "mechanisms.energy" => take(&mut next.mechanisms.energy, &parsed),
            "sensing.leaf_face" => take(&mut next.sensing.leaf_face, &parsed),
            "sensing.bud_face" => take(&mut next.sensing.bud_face, &parsed),
            "sensing.mode" => match value {
                "MapPerCandidate" => put(&mut next.sensing.mode, SensingMode::MapPerCandidate),
                "Reprojected" => put(&mut next.sensing.mode, SensingMode::Reprojected),
                _ => false,
            },
            "sensing.weight" => match value {
                "Alike" => put(&mut next.sensing.weight, TexelWeight::Alike),
                "SolidAngle" => put(&mut next.sensing.weight, TexelWeight::SolidAngle),
                _ => false,
            },
            _ => {
                return Err(unknown(
                    at,
                    &format!("scenario.{key}"),
                    SCENARIO.map(|k| format!("scenario.{k}")),
                ));
            }
        };
        self.finish(at, taken, next, &format!("scenario.{key}"), key, value)
    }

    fn set_lamp(&mut self, at: Place, key: &str, value: &str) -> Result<(), FileError> {
        let (name, field) = key.rsplit_once('.').unwrap_or(("", key));
        let mut next = self.scenario.clone();
        let parsed = parse_value(value);
        let names: Vec<String> = next.lamps.iter().map(|l| format!("lamp.{}", l.name)).collect();
        let Some(lamp) = next.lamps.iter_mut().find(|l| l.name == name) else {
            return Err(unknown(at, &format!("lamp.{name}"), names));
        };
        let taken = match field {
            "strength" => take(&mut lamp.strength, &parsed),
            "radius" => take(&mut lamp.radius, &parsed),
            "on" => take(&mut lamp.on, &parsed),
            _ => {
                let known = ["strength", "radius", "on"].map(|f| format!("lamp.{name}.{f}"));
                return Err(unknown(at, &format!("lamp.{key}"), known));
            }
        };
        self.finish(at, taken, next, &format!("lamp.{key}"), &format!("lamps[].{field}"), value)
    }

    /// Takes over a changed scenario, if its value was of the right type and all is in range.
    fn finish(
        &mut self,
        at: Place,
        taken: bool,
        next: Scenario,
        field: &str,
        row: &str,
        value: &str,
    ) -> Result<(), FileError> {
        let problem = next.validate().err();
        if taken && problem.is_none() {
            self.scenario = next;
            return Ok(());
        }
        let allowed = super::scenario::allowed(&super::source::split_path(row))
            .or(problem.map(|p| p.allowed))
            .unwrap_or_default();
        Err(FileError::Invalid { at, field: field.into(), value: shorten(value), allowed })
    }
}

fn take<T: ParameterType>(slot: &mut T, value: &Value) -> bool {
    match T::from_value(value) {
        Some(new) => put(slot, new),
        None => false,
    }
}

fn put<T>(slot: &mut T, value: T) -> bool {
    *slot = value;
    true
}

fn sun(scenario: &mut Scenario) -> &mut PlacedSun {
    scenario.sun.get_or_insert_default()
}

fn unknown<S: AsRef<str>>(at: Place, key: &str, known: impl IntoIterator<Item = S>) -> FileError {
    let known: Vec<S> = known.into_iter().collect();
    let nearest = nearest(key, known.iter().map(AsRef::as_ref)).map(Into::into);
    FileError::UnknownField { at, field: shorten(key), nearest }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_as_people_write_them() {
        assert_eq!(parse_value("4"), Value::Whole(4));
        assert_eq!(parse_value("-4"), Value::Real(-4.0));
        assert_eq!(parse_value(" 0.5"), Value::Real(0.5));
        assert_eq!(parse_value("true"), Value::Flag(true));
        assert_eq!(parse_value("[60, 55.5,]"), Value::List(vec![60.0, 55.5]));
        assert_eq!(parse_value("(1,0,0)"), Value::List(vec![1.0, 0.0, 0.0]));
        assert_eq!(parse_value("[]"), Value::List(vec![]));
        assert_eq!(parse_value("[1"), Value::Choice("[1".into()));
        assert_eq!(parse_value("ByVigour"), Value::Choice("ByVigour".into()));
    }
}
