//! `burgeon describe`: parameters, species, scenarios.

use std::path::{Path, PathBuf};

use burgeon::assets::{FileKind, Library};
use burgeon::environment::SolidShape;
use burgeon::files::{ResolvedScenario, read_text};
use burgeon::scenario::Scenario;
use burgeon::species::Species;
use burgeon::species::parameter::Parameter;
use clap::Args;

use super::Failure;
use super::input::library;
use super::output::say;

/// Show what there is, or one thing of it.
#[derive(Args, Debug)]
pub struct Describe {
    /// `species` or `scenario` for the table of all fields; a name or a file for that one; nothing for all names.
    name: Option<String>,

    /// A folder whose species/NAME.ron and scenarios/NAME.ron win over those built in.
    #[arg(long, value_name = "DIR")]
    assets: Option<PathBuf>,
}

impl Describe {
    /// Runs the command.
    pub fn run(&self) -> Result<(), Failure> {
        let library = library(&self.assets)?;
        match self.name.as_deref() {
            None => {
                names(&library);
                Ok(())
            }
            Some("species") => {
                table(Species::parameters(), None);
                Ok(())
            }
            Some("scenario") => {
                table(Scenario::parameters(), None);
                Ok(())
            }
            Some(name) if library.species_names().iter().any(|n| n == name) => {
                species(&library.species(name)?);
                Ok(())
            }
            Some(name) if name.ends_with(".ron") => file(&library, name),
            Some(name) => {
                scenario(&library.scenario(name)?);
                Ok(())
            }
        }
    }
}

fn file(library: &Library, name: &str) -> Result<(), Failure> {
    let path = Path::new(name);
    let text = read_text(path)?;
    match FileKind::of(&text, path) {
        FileKind::Species => species(&Species::from_ron(&text, name)?),
        FileKind::Scenario => scenario(&library.read(&text, name, path.parent())?),
        FileKind::Run => scenario(&burgeon::files::RunFile::from_ron(&text, name)?.resolved()),
    }
    Ok(())
}

fn names(library: &Library) {
    say("Species");
    for name in library.species_names() {
        match library.species(&name) {
            Ok(species) => say(format_args!("  {name:16} {}", species.description)),
            Err(why) => say(format_args!("  {name:16} {why}")),
        }
    }
    say("\nScenarios");
    for name in library.scenario_names() {
        match library.scenario(&name) {
            Ok(found) => say(format_args!("  {name:16} {}", found.scenario.description)),
            Err(why) => say(format_args!("  {name:16} {why}")),
        }
    }
    say(
        "\n`burgeon describe NAME` shows one, `describe species` and `describe scenario` all that can be set.",
    );
}

fn species(species: &Species) {
    say(format_args!("{}: {}", species.name, species.description));
    if !species.source.is_empty() {
        say(format_args!("Source: {}", species.source));
    }
    say("");
    table(Species::parameters(), Some(species));
}

/// A row a parameter; of a species, its values, those that differ from the default marked.
fn table(parameters: &[Parameter], species: Option<&Species>) {
    let rows: Vec<[String; 4]> = parameters
        .iter()
        .map(|p| {
            let value = species.and_then(|s| s.get(p.name));
            let differs = value.as_ref().is_some_and(|v| *v != p.default);
            let shown = value.unwrap_or_else(|| p.default.clone()).to_string();
            let mark = if differs { format!("{shown} *") } else { shown };
            [p.name.into(), mark, p.unit.into(), p.allowed()]
        })
        .collect();
    let value = if species.is_some() { "value" } else { "default" };
    let heads = ["name", value, "unit", "allowed"];
    // The width of each column but the last, unless a value is far longer than the rest.
    let width = |i: usize| {
        rows.iter().map(|r| r[i].chars().count()).chain([heads[i].len()]).max().unwrap_or(0).min(30)
    };
    let (a, b, c, d) = (width(0), width(1), width(2), width(3));
    say(format_args!("{:a$}  {:b$}  {:c$}  {:d$}  help", heads[0], heads[1], heads[2], heads[3]));
    for (row, p) in rows.iter().zip(parameters) {
        say(format_args!("{:a$}  {:b$}  {:c$}  {:d$}  {}", row[0], row[1], row[2], row[3], p.help));
    }
    if species.is_some() {
        say("\n* differs from the default");
    }
}

fn scenario(resolved: &ResolvedScenario) {
    let Scenario { name, description, steps, plants, solids, lamps, sky, sun, ground, shore, .. } =
        &resolved.scenario;
    say(format_args!("{name}: {description}"));
    say(format_args!("  steps   {steps}"));
    for p in plants {
        say(format_args!("  plant   {} at {}", p.species, p.at));
    }
    for s in solids {
        let shape = match s.shape {
            SolidShape::Box { size } => format!("box {} x {} x {} m", size.x, size.y, size.z),
            SolidShape::Ball { radius } => format!("ball of {radius} m radius"),
            SolidShape::Cylinder { radius, height } => format!("cylinder {height} m high, {radius} m radius"),
        };
        say(format_args!("  solid   {}: {shape} at {}, turned {} deg", s.name, s.at, s.turn_deg));
    }
    for l in lamps {
        let off = if l.on { "" } else { ", off" };
        say(format_args!(
            "  lamp    {}: strength {}, radius {} m, at {}{off}",
            l.name, l.strength, l.radius, l.at
        ));
    }
    say(format_args!("  sky     {:?}, strength {}", sky.gradient, sky.strength));
    match sun {
        Some(s) => say(format_args!(
            "  sun     strength {}, {} deg high, {} deg from south to east",
            s.strength, s.elevation_deg, s.azimuth_deg
        )),
        None => say("  sun     none"),
    }
    say(format_args!("  ground  {}", if *ground { "at height 0" } else { "none" }));
    if let Some(shore) = shore {
        say(format_args!(
            "  sea     {} m off, {} deg from south to east",
            shore.distance_m, shore.azimuth_deg
        ));
    }
    let m = resolved.scenario.mechanisms;
    let on = |b: bool| if b { "on" } else { "off" };
    say(format_args!("  light {}, space {}, energy {}", on(m.light), on(m.space), on(m.energy)));
    for edit in &resolved.scenario.edits {
        say(format_args!("  step {:4} {:?}", edit.step, edit.edit));
    }
}
