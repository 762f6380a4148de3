//! Bad files give a typed error that names file, field, value and range; never a panic, never half a load.

use std::path::Path;

use burgeon::assets::{FileKind, Library, Opened};
use burgeon::files::{FileError, Likeness, ResolvedScenario, RunFile, StepHashes, parse_value, read_text};
use burgeon::limits;
use burgeon::scenario::Scenario;
use burgeon::species::Species;
use burgeon::species::parameter::{Parameter, ParameterError, Range, Value};
use proptest::prelude::*;

/// Values no careful person writes, among them some that are fine for some parameters.
const HOSTILE: [&str; 18] = [
    "NaN",
    "inf",
    "-inf",
    "-1",
    "-1e-30",
    "0",
    "1",
    "0.5",
    "1e30",
    "1e300",
    "4294967296",
    "true",
    "\"text\"",
    "nothing",
    "()",
    "[1, 2]",
    "[NaN]",
    "(0.1, inf, 0.2)",
];

/// Whether the table itself says that a value fits.
fn fits(p: &Parameter, value: &Value) -> bool {
    let each = |xs: &[f64]| xs.iter().all(|x| p.range.holds(*x));
    match (&p.default, value) {
        (Value::Real(_), Value::Real(x)) => p.range.holds(*x),
        (Value::Real(_) | Value::Whole(_), Value::Whole(n)) => p.range.holds(f64::from(*n)),
        (Value::Flag(_), Value::Flag(_)) => true,
        (Value::List(_), Value::List(xs)) if p.name.ends_with("_color") => xs.len() == 3 && each(xs),
        (Value::List(_), Value::List(xs)) => each(xs),
        (Value::List(_), Value::Real(x)) => !p.name.ends_with("_color") && each(&[*x]),
        (Value::List(_), Value::Whole(n)) => !p.name.ends_with("_color") && each(&[f64::from(*n)]),
        (Value::Choice(_), Value::Choice(name)) => p.choices.contains(&name.as_str()),
        _ => false,
    }
}

#[test]
fn every_parameter_takes_what_its_range_allows_and_names_what_it_refuses() {
    for p in Species::parameters() {
        let (below, above) = match p.range {
            Range::Real { min, max } => (min - 1.0, max + max.abs() + 1.0),
            Range::Whole { min, max } => (f64::from(min) - 1.0, f64::from(max) + 1.0),
            Range::Any => (f64::NAN, f64::NAN),
        };
        let edges = [below.to_string(), above.to_string()];
        for text in HOSTILE.iter().copied().chain(edges.iter().map(String::as_str)) {
            let value = parse_value(text);

            let mut species = Species::default();
            match species.set(p.name, &value) {
                Ok(()) => assert_eq!(species.validate(), Ok(()), "{} = {text}", p.name),
                Err(ParameterError::Invalid { name, allowed, .. }) => {
                    assert_eq!((name, allowed), (p.name, p.allowed()));
                    assert_eq!(species, Species::default(), "nothing half set");
                }
                Err(e) => panic!("{e}"),
            }

            let file = format!("(\n    version: 1,\n    {}: {text},\n)", p.name);
            match Species::from_ron(&file, "hostile.ron") {
                Ok(species) => {
                    assert_eq!(species.validate(), Ok(()));
                    assert!(fits(p, &value), "{} took {text}", p.name);
                }
                Err(FileError::Invalid { at, field, value, allowed }) => {
                    assert_eq!((at.file.as_str(), at.line), ("hostile.ron", Some(3)));
                    assert_eq!(at.column, Some(7 + p.name.len() as u32));
                    assert_eq!((field.as_str(), value.as_str(), allowed), (p.name, text, p.allowed()));
                }
                Err(e) => panic!("{} = {text}: {e:?}", p.name),
            }
        }
    }
}

/// A scenario with one of everything; `FIELD` is where a test puts what it likes.
fn scenario_with(field: &str, value: &str) -> String {
    let mut text = String::from("(\n");
    let mut group = |name: &str, open: &str, close: &str| {
        let prefix = format!("{name}.");
        let inner = field.strip_prefix(&prefix).map(|f| nested(f, value)).unwrap_or_default();
        text.push_str(&format!(
            "    {name_only}: {open}{inner}{close},\n",
            name_only = name.trim_end_matches("[]")
        ));
    };
    group("plants[]", "[(", ")]");
    group("solids[]", "[(", ")]");
    group("lamps[]", "[(", ")]");
    group("sky", "(", ")");
    group("sun", "(", ")");
    group("mechanisms", "(", ")");
    group("sensing", "(", ")");
    if !field.contains('.') {
        text.push_str(&format!("    {field}: {value},\n"));
    }
    text + ")"
}

fn nested(field: &str, value: &str) -> String {
    match field {
        "shape.size" => format!("shape: Box(size: {value})"),
        "shape.radius" => format!("shape: Ball(radius: {value})"),
        "shape.height" => format!("shape: Cylinder(radius: 1, height: {value})"),
        _ => format!("{field}: {value}"),
    }
}

#[test]
fn every_field_of_a_scenario_takes_what_is_allowed_and_names_what_it_refuses() {
    for p in Scenario::parameters().iter().filter(|p| !p.name.starts_with("edits")) {
        for text in HOSTILE.iter().copied().chain(["\"\"", "(1e9, 0, 0)", "(1, 2)", "(-1, 1, 1)"]) {
            let file = scenario_with(p.name, text);
            match Scenario::from_ron(&file, "hostile.ron") {
                Ok(scenario) => assert_eq!(scenario.validate(), Ok(())),
                Err(FileError::Invalid { at, field, value, allowed }) => {
                    assert_eq!(at.file, "hostile.ron");
                    assert!(at.line.is_some(), "{file}");
                    assert_eq!(field.replace("[0]", "[]"), p.name, "{file}");
                    assert_eq!(value, text, "{file}");
                    assert!(!allowed.is_empty(), "{file}");
                }
                Err(FileError::Version { .. }) => assert_eq!(p.name, "version"),
                Err(e) => panic!("{file}\n{e:?}"),
            }
        }
    }
}

#[test]
fn a_seed_lies_where_it_can_come_up() {
    let sown = |at: &str, ground: bool| {
        let wall = "(name: \"bank\", shape: Box(size: (2, 1, 2)), at: (5, 0.5, 0))";
        let text = format!("(ground: {ground}, solids: [{wall}], plants: [(), (at: {at})])");
        match Scenario::from_ron(&text, "sown.ron") {
            Ok(_) => None,
            Err(FileError::Invalid { field, allowed, .. }) => Some((field, allowed)),
            Err(other) => panic!("{text}: {other:?}"),
        }
    };
    let (field, allowed) = sown("(4.5, 0, 0.2)", true).expect("it lies in the bank");
    assert!(field == "plants[1].at" && allowed.contains("\"bank\""), "{field}: {allowed}");
    let (field, _) = sown("(0, -3, 0)", true).expect("it lies deep underground");
    assert_eq!(field, "plants[1].at");
    for (at, ground) in [("(0, -3, 0)", false), ("(4.5, 1, 0.2)", true), ("(3.9, 0, 0)", true)] {
        assert_eq!(sown(at, ground), None, "{at}");
    }
}

#[test]
fn edits_name_what_stands_there_at_their_step() {
    let wrong = |edits: &str| {
        let text = format!("(lamps: [(name: \"lamp\")],\nedits: [\n{edits}\n])");
        match Scenario::from_ron(&text, "edits.ron") {
            Err(FileError::Invalid { field, at, .. }) => {
                assert!(at.line.is_some());
                field
            }
            other => panic!("{text}: {other:?}"),
        }
    };
    assert_eq!(wrong("(step: 1, edit: Switch(name: \"lmap\", on: false))"), "edits[0].edit.name");
    assert_eq!(wrong("(step: 1, edit: PlaceSolid(name: \"lamp\"))"), "edits[0].edit.name");
    assert_eq!(wrong("(step: 1, edit: PlaceLamp(name: \"b\", strength: -1))"), "edits[0].edit.strength");
    assert_eq!(wrong("(step: 1, edit: PlaceLamp(name: \"b\", strength: \"x\"))"), "edits[0].edit.strength");
    assert_eq!(wrong("(step: 1, edit: Uproot(plant: 1))"), "edits[0].edit.plant");
    assert_eq!(
        wrong("(step: 1, edit: Move(name: \"lamp\", to: (0, inf, 0), turn_deg: 0))"),
        "edits[0].edit.to"
    );
    assert_eq!(wrong("(step: 1, edit: Sun(strength: 99))"), "edits[0].edit.strength");
    assert_eq!(wrong("(step: 9999999, edit: Sun(None))"), "edits[0].step");
    assert_eq!(
        wrong("(step: 1, edit: Set(species: \"lam_king\", parameter: \"seed_energy\", value: \"NaN\"))"),
        "edits[0].edit.value"
    );
    assert_eq!(
        wrong("(step: 1, edit: Set(species: \"lam_king\", parameter: \"seed_enrgy\", value: \"1\"))"),
        "edits[0].edit.parameter"
    );
    // What counts is the step, not the place in the file.
    assert_eq!(
        wrong("(step: 9, edit: Switch(name: \"lamp\", on: false)), (step: 3, edit: Remove(name: \"lamp\"))"),
        "edits[0].edit.name"
    );
    let sorted = Scenario::from_ron(
        "(edits: [(step: 9, edit: Remove(name: \"a\")), (step: 3, edit: PlaceLamp(name: \"a\"))])",
        "edits.ron",
    );
    assert_eq!(sorted.unwrap().edits.iter().map(|e| e.step).collect::<Vec<_>>(), [3, 9]);
}

#[test]
fn what_is_no_species_or_scenario_at_all() {
    let both = |text: &str, expect: fn(&FileError) -> bool| {
        let (species, scenario) = (Species::from_ron(text, "f.ron"), Scenario::from_ron(text, "f.ron"));
        assert!(expect(species.as_ref().unwrap_err()), "{species:?}");
        assert!(expect(scenario.as_ref().unwrap_err()), "{scenario:?}");
    };
    let syntax = |e: &FileError| matches!(e, FileError::Syntax { .. });
    both("", syntax);
    both("// only a comment\n", syntax);
    both("()()", syntax);
    both("(name: \"a\"", syntax);
    both("(name: \"a\" name: \"b\")", syntax);
    both("[1, 2]", syntax);
    both("(name: \"a\", name: \"b\")", syntax);
    both("(brunch_angle_deg: 3)", |e| matches!(e, FileError::UnknownField { .. }));
    both("(version: 2, from_the_future: ())", |e| matches!(e, FileError::Version { .. }));
    both(&"(".repeat(10_000), |e| matches!(e, FileError::TooDeep { .. }));
    both(&"[".repeat(10_000), |e| matches!(e, FileError::TooDeep { .. }));
    both(&format!("(name: {})", "[{".repeat(5_000)), |e| matches!(e, FileError::TooDeep { .. }));
    both(&format!("({})", " ".repeat(limits::FILE_BYTES as usize)), |e| {
        matches!(e, FileError::TooLarge { .. })
    });
    both(&format!("(name: \"{}\")", "x".repeat(1000)), |e| matches!(e, FileError::Invalid { .. }));

    let Err(FileError::UnknownField { at, field, nearest }) =
        Species::from_ron("(\n  branch_angle_deg: 3,\n)", "f.ron")
    else {
        panic!()
    };
    assert_eq!(at.to_string(), "f.ron:2:3");
    assert_eq!((field.as_str(), nearest.as_deref()), ("branch_angle_deg", Some("branching_angle_deg")));
}

#[test]
fn files_that_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("f.ron");
    assert!(matches!(read_text(&path), Err(FileError::NotFound { .. })));
    assert!(matches!(read_text(folder.path()), Err(FileError::Io { .. })));
    std::fs::write(&path, b"(name: \"\xff\xfe\")").unwrap();
    assert!(matches!(read_text(&path), Err(FileError::NotText { byte: 8, .. })));
    std::fs::write(&path, b"\x89PNG\r\n\x1a\n\0\0").unwrap();
    assert!(matches!(read_text(&path), Err(FileError::NotText { .. })));
    std::fs::write(&path, vec![b' '; limits::FILE_BYTES as usize + 1]).unwrap();
    assert!(matches!(read_text(&path), Err(FileError::TooLarge { .. })));
}

#[test]
fn a_scenario_reads_species_beside_it_and_nowhere_else() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("outside.ron"), "()").unwrap();
    let inside = folder.path().join("in");
    std::fs::create_dir_all(inside.join("deeper")).unwrap();
    std::fs::write(inside.join("elm.ron"), "(name: \"elm\")").unwrap();
    std::fs::write(inside.join("deeper/ash.ron"), "(name: \"ash\")").unwrap();
    let open = |species: &str| {
        let path = inside.join("scene.ron");
        std::fs::write(&path, format!("(\n  plants: [(species: {species:?})],\n)")).unwrap();
        Library::embedded().open(path.to_str().unwrap())
    };
    for good in ["elm.ron", "deeper/ash.ron", "oak"] {
        let Ok(Opened::Scenario(resolved)) = open(good) else { panic!("{good}") };
        assert!(resolved.species.contains_key(good));
    }
    let absolute = folder.path().join("outside.ron").display().to_string();
    for bad in
        ["../outside.ron", "deeper/../../outside.ron", "./../outside.ron", &absolute, "..\\outside.ron"]
    {
        match open(bad) {
            Err(FileError::OutsideFolder { at, .. }) => assert_eq!(at.line, Some(2), "{bad}"),
            other => panic!("{bad}: {other:?}"),
        }
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(folder.path().join("outside.ron"), inside.join("link.ron")).unwrap();
        assert!(matches!(open("link.ron"), Err(FileError::OutsideFolder { .. })));
    }
    assert!(matches!(open("none.ron"), Err(FileError::NotFound { .. })));
    match open("oaks") {
        Err(FileError::NoSuchSpecies { at, nearest, known, .. }) => {
            assert_eq!((at.line, nearest.as_deref()), (Some(2), Some("oak")));
            assert!(known.contains(&"lam_king".to_string()));
        }
        other => panic!("{other:?}"),
    }
    assert!(
        matches!(Library::embedded().open("wal"), Err(FileError::NoSuchScenario { nearest: Some(n), .. }) if n == "wall")
    );
}

#[test]
fn settings_change_one_thing_or_nothing() {
    let start: ResolvedScenario = Library::embedded().scenario("lamp").unwrap();
    let good = |setting: &str| {
        let mut garden = start.clone();
        garden.apply_set(setting).unwrap_or_else(|e| panic!("{e}"));
        assert_ne!(garden, start, "{setting}");
        garden
    };
    assert_eq!(good("species.branching_angle_deg=45").species["oak"].branching_angle_deg, [45.0].into());
    assert_eq!(good("species.oak.allocation = ByExposure").species["oak"].allocation, Default::default());
    assert_eq!(good("species.terminal_death=[0.1, 0.2]").species["oak"].terminal_death, [0.1, 0.2].into());
    assert!(!good("scenario.ground=false").scenario.ground);
    assert_eq!(good("scenario.sun.elevation_deg=10").scenario.sun.unwrap().elevation_deg, 10.0);
    assert!(!good("lamp.lamp.on=false").scenario.lamps[0].on);
    good("scenario.sensing.mode=MapPerCandidate");
    good("scenario.mechanisms.energy=false");

    for (setting, field) in [
        ("species.branching_angle_deg=NaN", "species.branching_angle_deg"),
        ("species.leaves_per_node=2.5", "species.leaves_per_node"),
        ("scenario.sensing.bud_face=0", "scenario.sensing.bud_face"),
        ("scenario.sensing.bud_face=100000", "scenario.sensing.bud_face"),
        ("scenario.sky.strength=-1", "scenario.sky.strength"),
        ("scenario.sensing.mode=Fast", "scenario.sensing.mode"),
        ("scenario.ground=1", "scenario.ground"),
        ("lamp.lamp.radius=0", "lamp.lamp.radius"),
    ] {
        let mut garden = start.clone();
        match garden.apply_set(setting) {
            Err(FileError::Invalid { at, field: named, allowed, .. }) => {
                assert_eq!((at.file, named.as_str()), (format!("--set {setting}"), field));
                assert!(!allowed.is_empty());
            }
            other => panic!("{setting}: {other:?}"),
        }
        assert_eq!(garden, start);
    }
    for setting in ["species.seed_enrgy=1", "scenario.foo=1", "lamp.other.on=true", "wind=1", "lamp.lamp.x=1"]
    {
        assert!(matches!(start.clone().apply_set(setting), Err(FileError::UnknownField { .. })), "{setting}");
    }
    assert!(matches!(
        start.clone().apply_set("species.elm.seed_energy=1"),
        Err(FileError::NoSuchSpecies { .. })
    ));
    assert!(matches!(start.clone().apply_set("sag"), Err(FileError::Syntax { .. })));
}

fn run_file() -> RunFile {
    let resolved = Library::embedded().scenario("lamp_moved").unwrap();
    let mut hashes = StepHashes::default();
    for step in 0..40 {
        hashes.push(step, u64::from(step).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    }
    RunFile::new(&resolved, u64::MAX, 39, hashes)
}

#[test]
fn a_run_reads_back_as_itself_and_names_what_is_wrong() {
    let run = run_file();
    let text = run.to_ron();
    assert_eq!(RunFile::from_ron(&text, "run.ron").unwrap(), run);
    assert_eq!(FileKind::of(&text, Path::new("run.ron")), FileKind::Run);

    let bad = text.replace("shed_share: 0.2", "shed_share: -3.0");
    match RunFile::from_ron(&bad, "run.ron") {
        Err(FileError::Invalid { at, field, .. }) => {
            assert_eq!(field, "species.oak.shed_share");
            assert!(bad.lines().nth(at.line.unwrap() as usize - 1).unwrap().contains("shed_share: -3.0"));
        }
        other => panic!("{other:?}"),
    }
    let misnamed = text.replace("name: \"oak\"", "name: \"elm\"");
    assert!(matches!(RunFile::from_ron(&misnamed, "run.ron"), Err(FileError::Invalid { .. })));
    let missing = text.replace("species: \"oak\"", "species: \"elm\"");
    assert!(matches!(RunFile::from_ron(&missing, "run.ron"), Err(FileError::NoSuchSpecies { .. })));
    let seedless = text.replace("    seed: 18446744073709551615,\n", "");
    assert!(matches!(RunFile::from_ron(&seedless, "run.ron"), Err(FileError::Syntax { .. })));
}

#[test]
fn step_hashes_stay_few_and_keep_the_newest() {
    let mut hashes = StepHashes::default();
    for step in 0..100_000 {
        hashes.push(step, u64::from(step));
        assert_eq!(hashes.last(), Some((step, u64::from(step))));
    }
    let mut other = hashes.clone();
    assert_eq!(hashes.compare(&other), Likeness::Same { upto: 99_999 });
    assert_eq!(hashes.compare(&StepHashes::default()), Likeness::Unknown);
    other.push(99_999, 0);
    assert_eq!(hashes.compare(&other), Likeness::Differs { at: 99_999 });
}

/// Every shipped text and a run.
fn texts() -> Vec<String> {
    let library = Library::embedded();
    let species = library.species_names().into_iter().map(|n| library.species(&n).unwrap().to_ron());
    let scenarios =
        library.scenario_names().into_iter().map(|n| library.scenario(&n).unwrap().scenario.to_ron());
    species.chain(scenarios).chain([run_file().to_ron()]).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn mutated_files_never_panic(
        which in any::<prop::sample::Index>(),
        cuts in prop::collection::vec((any::<prop::sample::Index>(), 0usize..6, "[-()\\[\\]{},:\"/*r#'a-z0-9.é]{0,4}"), 1..5),
    ) {
        let texts = texts();
        let mut text = which.get(&texts).clone();
        for (at, gone, new) in cuts {
            let start = text.floor_char_boundary(at.index(text.len() + 1));
            let end = text.ceil_char_boundary((start + gone).min(text.len()));
            text.replace_range(start..end, &new);
        }
        let species = Species::from_ron(&text, "f.ron");
        prop_assert!(species.is_err() || species.unwrap().validate().is_ok());
        let scenario = Scenario::from_ron(&text, "f.ron");
        prop_assert!(scenario.is_err() || scenario.unwrap().validate().is_ok());
        let _ = RunFile::from_ron(&text, "f.ron").map_err(|e| e.to_string());
        let _ = FileKind::of(&text, Path::new("f.ron"));
    }

    #[test]
    fn settings_of_any_text_never_panic(text in "\\PC{0,40}") {
        let mut garden = Library::embedded().scenario("lamp").unwrap();
        for key in ["species.seed_energy", "scenario.steps", "lamp.lamp.on", ""] {
            let _ = garden.apply_set(&format!("{key}={text}"));
        }
        let _ = garden.apply_set(&text);
    }
}

#[test]
fn a_file_without_a_value_says_why() {
    for (text, why) in [
        ("", "the file is empty"),
        ("  \n", "the file is empty"),
        ("// a species", "nothing but comments"),
        ("/* a species */", "nothing but comments"),
        ("// all of species/*", "nothing but comments"),
        ("/* (version: 1)", "never closed"),
        ("/* a /* b */", "never closed"),
    ] {
        let told = Scenario::from_ron(text, "here.ron").unwrap_err().to_string();
        assert!(told.contains("here.ron") && told.contains(why), "{text:?}: {told}");
    }
}
