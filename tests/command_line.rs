//! The program as people run it.
#![cfg(feature = "cli")]

use std::path::Path;
use std::process::{Command, Output};

use burgeon::files::RunFile;
use serde_json::Value;

/// Runs the program in a folder.
fn burgeon(folder: &Path, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_burgeon"))
        .args(arguments.split_whitespace())
        .current_dir(folder)
        // No window, wherever the tests run.
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .unwrap()
}

/// Runs the program; what it printed, if it ended with that exit code.
fn ends(folder: &Path, arguments: &str, code: i32) -> (String, String) {
    let output = burgeon(folder, arguments);
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    let (out, err) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(code), "burgeon {arguments}\n{out}{err}");
    (out, err)
}

/// Runs the program, which ends with that exit code and says this among other things.
fn refuses(folder: &Path, arguments: &str, code: i32, says: &str) {
    let (_, err) = ends(folder, arguments, code);
    assert!(err.contains(says), "{arguments}: {err}");
}

fn json(folder: &Path, arguments: &str) -> Value {
    serde_json::from_str(&ends(folder, arguments, 0).0).unwrap()
}

fn is_empty(folder: &Path) -> bool {
    std::fs::read_dir(folder).unwrap().next().is_none()
}

#[test]
fn grow_leaves_pictures_a_model_tables_and_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let summary = json(at, "grow open --steps 4 --out o --timelapse --json --threads 1");
    assert_eq!(summary["steps"], 4);
    assert!(summary["leaves"].as_u64().unwrap() > 0);
    let begins = |file: &str, magic: &[u8]| {
        let bytes = std::fs::read(at.join("o").join(file)).unwrap();
        assert!(bytes.starts_with(magic), "{file}");
    };
    begins("tree.png", b"\x89PNG");
    begins("growth.gif", b"GIF89a");
    begins("tree.glb", b"glTF");
    begins("organs.csv", b"birth,");
    let steps = std::fs::read_to_string(at.join("o/steps.csv")).unwrap();
    assert_eq!(steps.lines().count(), 1 + 4);
    assert_eq!(summary["files"].as_array().unwrap().len(), std::fs::read_dir(at.join("o")).unwrap().count());

    // Nothing is overwritten unasked.
    let (out, err) = ends(at, "grow open --steps 4 --out o", 1);
    assert!(out.is_empty() && err.contains("--force"), "{err}");
    ends(at, "grow open --steps 4 --out o --force", 0);
}

#[test]
fn frames_are_a_picture_of_every_step_in_a_new_folder() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let (out, _) = ends(at, "grow figure_1d --steps 3 --out o --frames pictures/steps", 0);
    assert!(out.contains("pictures/steps: 4 pictures"), "{out}");
    let picture = |step: u32| image::open(at.join(format!("pictures/steps/step_{step:04}.png"))).unwrap();
    assert_eq!(picture(0).width(), picture(3).width());
    // From one stand: sky and hills beside the plant are where they were, the middle has grown.
    let (first, last) = (picture(0).to_rgb8(), picture(3).to_rgb8());
    let column = |picture: &image::RgbImage, x: u32| -> Vec<_> {
        (0..picture.height() * 7 / 10).map(|y| *picture.get_pixel(x, y)).collect()
    };
    let (edge, middle) = (first.width() - 1, first.width() / 2);
    assert_eq!(column(&first, edge), column(&last, edge));
    assert_ne!(column(&first, middle), column(&last, middle));
    assert_eq!(std::fs::read_dir(at.join("pictures/steps")).unwrap().count(), 4);

    let (_, err) = ends(at, "grow figure_1d --steps 3 --out p --frames pictures/steps", 1);
    assert!(err.contains("pictures") && err.contains("--force") && !at.join("p").exists(), "{err}");
    ends(at, "grow figure_1d --steps 1 --out p --frames pictures/steps --force", 0);
    // A folder cannot lie in a file.
    std::fs::write(at.join("file.txt"), "").unwrap();
    let (_, err) = ends(at, "grow figure_1d --steps 1 --out q --frames file.txt/x", 1);
    assert!(err.contains("file.txt"), "{err}");
    for taken in ["--frames q", "--frames q/tree.png/x", "--save s --frames ./s", "--save s --frames s/x"] {
        ends(at, &format!("grow figure_1d --steps 1 --out q {taken}"), 2);
    }
}

#[test]
fn a_limit_stops_with_a_message_and_keeps_the_result() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (i, limit) in ["organs=40", "probes=10", "steps=3", "memory=100000"].iter().enumerate() {
        let (_, err) = ends(at, &format!("grow figure_1c --limit {limit} --out o{i}"), 3);
        let (what, most) = limit.split_once('=').unwrap();
        assert!(err.contains(what) && err.contains(most), "{err}");
        let run = std::fs::read_to_string(at.join(format!("o{i}/run.ron"))).unwrap();
        let steps = RunFile::from_ron(&run, "run.ron").unwrap().steps;
        assert!((1..9).contains(&steps), "{limit} stopped at {steps}");
        assert!(at.join(format!("o{i}/tree.glb")).exists());
    }
    ends(at, "grow open --limit leaves=3", 2);
    assert!(!at.join("out").exists());

    // A run taken up again stands where it stood: over its limit it grows no further.
    ends(at, "grow figure_1c --steps 4 --save half.burgeon --out half", 0);
    let (_, err) = ends(at, "grow --resume half.burgeon --steps 9 --limit probes=10 --out rest", 3);
    assert!(err.contains("stopped at step 4"), "{err}");
}

#[test]
fn a_scenario_without_a_name_goes_by_its_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("mine.ron"), "()").unwrap();
    let (said, _) = ends(folder.path(), "check mine.ron", 0);
    assert_eq!(said.trim(), "mine.ron: scenario mine with lam_king");
    let (said, _) = ends(folder.path(), "grow mine.ron --steps 1 --out o", 0);
    assert!(said.starts_with("mine at step 1"), "{said}");
}

#[test]
fn a_run_grows_again_as_the_same_tree_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    ends(at, "grow lamp --steps 6 --seed 7 --set species.leaves_per_node=2 --threads 1 --out o", 0);
    let again = json(at, "grow o/run.ron --threads 2 --json");
    assert_eq!((&again["same_tree"], &again["seed"], &again["steps"]), (&true.into(), &7.into(), &6.into()));

    // A run whose tree has a hash of its own at step 3 is told apart there.
    let text = std::fs::read_to_string(at.join("o/run.ron")).unwrap();
    let run = RunFile::from_ron(&text, "run.ron").unwrap();
    let hash = format!("{:016x}", run.hashes.get(3).unwrap());
    std::fs::write(at.join("other.ron"), text.replace(&hash, "00000000deadbeef")).unwrap();
    let (_, err) = ends(at, "grow other.ron --out p", 4);
    assert!(err.contains("step 3"), "{err}");
}

#[test]
fn a_resumed_run_is_the_run_grown_straight() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let straight = json(at, "grow two_oaks --steps 8 --json --out straight");
    ends(at, "grow two_oaks --steps 3 --save half.save --out half", 0);
    let resumed = json(at, "grow --resume half.save --steps 8 --json --out resumed");
    assert_eq!(straight["hash"], resumed["hash"]);
    let run = |name: &str| std::fs::read_to_string(at.join(name).join("run.ron")).unwrap();
    assert_eq!(run("straight"), run("resumed"));

    ends(at, "grow two_oaks --steps 3 --save half.save --out more", 1);
    let mut bytes = std::fs::read(at.join("half.save")).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(at.join("bad.save"), bytes).unwrap();
    let (_, err) = ends(at, "grow --resume bad.save --out bad", 1);
    assert!(err.contains("checksum"), "{err}");
    assert!(!at.join("bad").exists());
}

#[test]
fn bad_input_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (arguments, code, says) in [
        ("grow wal", 1, "wall"),
        ("grow none.ron", 1, "no such file"),
        ("grow open --set species.branching_angle_deg=NaN", 1, "0 to 180"),
        ("grow open --set species.branching_angel_deg=4", 1, "branching_angle_deg"),
        ("grow open --set scenario.sensing.bud_face=0", 1, "1 to 512"),
        ("grow open --assets nowhere", 1, "nowhere"),
        ("grow open --steps -1", 2, "-1"),
        ("grow open --steps 99999999", 2, "--steps"),
        ("grow open --threads 100000", 2, "--threads"),
        ("grow open --seeds 5..1", 2, "--seeds"),
        ("grow --resume none.save", 1, "none.save"),
        ("gallery hazel --steps 3", 2, "--ages"),
        ("gallery hasel", 1, "hazel"),
        ("probe open --at 1,2", 2, "three numbers"),
        ("probe open --at NaN,0,0", 2, "three numbers"),
        ("check none.ron", 1, ""),
        ("describe nothing", 1, "nothing"),
        ("sprout", 2, "sprout"),
    ] {
        refuses(at, arguments, code, says);
        assert!(is_empty(at), "{arguments} wrote something");
    }
}

#[test]
fn replicates_make_one_table_with_mean_and_spread() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let summary = json(at, "grow two_oaks --seeds 1..3 --steps 3 --json --out o");
    assert_eq!(summary["trees"], 3);
    let text = std::fs::read_to_string(at.join("o/seeds.csv")).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.iter().map(|r| r[0]).collect::<Vec<_>>(), ["seed", "1", "2", "3", "mean", "sd"]);
    assert!(rows.iter().all(|row| row.len() == rows[0].len()));
    let column = rows[0].iter().position(|name| *name == "height_m").unwrap();
    let value = |row: usize| rows[row][column].parse::<f64>().unwrap();
    assert!((value(4) - (value(1) + value(2) + value(3)) / 3.0).abs() < 1e-9);
    // A replicate is the tree of that seed.
    let one = json(at, "grow two_oaks --seed 2 --steps 3 --json --out one");
    assert_eq!(rows[2].last(), one["hash"].as_str().as_ref());
}

#[test]
fn probe_reads_light_and_space() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let reading = json(at, "probe wall --steps 1 --at -20,30,0 --face-size 8 --out o");
    // High in the open, half of what is seen is sky.
    assert!((reading["share"].as_f64().unwrap() - 0.5).abs() < 0.02, "{reading}");
    assert_eq!(reading["faces"].as_array().unwrap().len(), 6);
    assert!(at.join("o/probe.png").exists());
    let beside = json(at, "probe wall --steps 1 --at 0.3,1,0 --face-size 8 --out p");
    assert!(beside["light"].as_f64() < reading["light"].as_f64());
    ends(at, "probe wall --steps 1 --at 0,1,0 --out o", 1);
}

#[test]
fn probe_measures_what_comparing_candidates_in_one_map_gives_away() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let given = json(at, "probe open --steps 7 --given-away");
    assert!(given["searches"].as_u64().unwrap() > 20, "{given}");
    let of = |key: &str| given[key].as_f64().unwrap();
    assert!((0.0..of("mean_spread")).contains(&of("mean_fitness_given_away")), "{given}");
    assert!(is_empty(at));
    ends(at, "probe open --steps 7 --given-away --at 0,1,0", 2);
}

#[test]
fn compare_shows_the_same_seed_side_by_side() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let (out, _) = ends(at, "compare figure_1c figure_1d --steps 2 --seed 3 --timelapse --out o", 0);
    assert!(out.contains("figure_1c") && out.contains("figure_1d"), "{out}");
    let png = image::open(at.join("o/compare.png")).unwrap();
    assert!(png.width() > 2 * png.height() * 4 / 5, "two pictures in a row");
    assert!(at.join("o/compare.gif").exists());
    ends(at, "compare figure_1c --out p", 2);
    ends(at, "compare figure_1c figure_1d --steps 2 --out o", 1);
}

#[test]
fn a_gallery_shows_species_in_leaf_above_and_bare_below() {
    const HIGH: u32 = 64;
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let sheet = |file: &str| image::open(at.join(file)).unwrap().into_rgb8();
    let (out, _) = ends(at, "gallery hazel palm --ages 2,5 --height 64 --out o", 0);
    assert!(out.contains("hazel") && out.contains("palm"), "{out}");
    for (name, evergreen) in [("hazel", false), ("palm", true)] {
        let sheet = sheet(&format!("o/{name}.png"));
        let (wide, high) = sheet.dimensions();
        assert!(wide >= 2 * (HIGH * 8 / 9) && high > 2 * HIGH, "{name}: {wide} x {high}");
        let differ = (0..wide)
            .flat_map(|x| (high - HIGH..high).map(move |y| (x, y)))
            .filter(|&(x, y)| sheet.get_pixel(x, y) != sheet.get_pixel(x, y - HIGH - 3))
            .count();
        assert_eq!(differ == 0, evergreen, "{name}: {differ} texels are otherwise in winter");
    }
    let both = sheet("o/gallery.png");
    assert!(both.width() > 4 * (HIGH * 8 / 9), "all on one sheet");
    // A limit keeps what has grown.
    let (_, err) = ends(at, "gallery palm hazel --ages 3,6 --height 64 --limit steps=4 --out short", 3);
    assert!(err.contains("steps"), "{err}");
    assert_eq!(sheet("short/palm.png").dimensions(), sheet("o/palm.png").dimensions());
    assert!(at.join("short/gallery.png").exists() && !at.join("short/hazel.png").exists());
}

#[test]
fn check_and_describe() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("elm.ron"), "(name: \"elm\", max_order: 5)").unwrap();
    std::fs::write(at.join("grove.ron"), "(name: \"grove\", plants: [(species: \"elm.ron\")])").unwrap();
    std::fs::write(at.join("bad.ron"), "(\n  max_order: 5.5,\n)").unwrap();
    let (out, _) = ends(at, "check elm.ron grove.ron", 0);
    assert_eq!(out.lines().count(), 2);
    let (out, _) = ends(at, "check elm.ron bad.ron grove.ron", 1);
    assert!(out.contains("bad.ron:2:14: `max_order` is 5.5"), "{out}");
    assert_eq!(out.lines().count(), 3);

    assert!(ends(at, "describe", 0).0.contains("courtyard"));
    assert!(ends(at, "describe species", 0).0.contains("branching_angle_deg"));
    assert!(ends(at, "describe scenario", 0).0.contains("lamps[].strength"));
    assert!(ends(at, "describe oak", 0).0.contains("ByVigour *"));
    assert!(ends(at, "describe lamp_moved", 0).0.contains("Move"));
    assert!(ends(at, "describe elm.ron", 0).0.contains("5 *"));
    assert!(ends(at, "completions bash", 0).0.contains("burgeon"));
    // Where no window can be opened it is said in a line; the program without its window grows instead.
    if cfg!(not(feature = "viewer")) {
        let (_, err) = ends(at, "watch open --steps 2", 0);
        assert_eq!(err.lines().count(), 1);
        assert!(at.join("out/open/tree.png").exists());
    } else if cfg!(all(unix, not(target_os = "macos"))) {
        let (_, err) = ends(at, "watch open", 5);
        assert_eq!(err.lines().count(), 1, "{err}");
    }
}

#[test]
fn why_tells_what_a_bud_saw_and_chose_and_what_became_of_the_fallen() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let told = json(at, "why lamp --steps 3 --json --picture saw.png");
    assert!(at.join("saw.png").exists());
    assert_eq!(told["faces"].as_array().unwrap().len(), 6);
    let chosen = told["chosen"].as_u64().unwrap() as usize;
    let candidates = told["candidates"].as_array().unwrap();
    let fitness = |i: usize| candidates[i]["fitness"].as_f64().unwrap();
    assert!((1..candidates.len()).all(|i| fitness(i - 1) >= fitness(i)) && chosen < candidates.len());
    assert!(told["grew_m"].as_f64().unwrap() > 0.0);
    // Leaves of an oak live for a step.
    ends(at, "grow open --steps 2 --out two", 0);
    let table = std::fs::read_to_string(at.join("two/organs.csv")).unwrap();
    let row = table.lines().find(|row| row.contains("leaf")).unwrap();
    let birth = row.split(',').next().unwrap();
    let (out, _) = ends(at, &format!("why open --steps 4 --bud {birth}"), 0);
    assert!(out.contains("went at step"), "{out}");
    let (_, err) = ends(at, "why figure_1d --steps 2 --bud 99999", 1);
    assert!(err.contains("no organ 99999"), "{err}");
}

#[test]
fn siblings_of_plants_from_anywhere() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    ends(at, "grow open --steps 5 --mtg --out grown", 0);
    let siblings = |arguments: &str| {
        let (out, _) =
            ends(at, &format!("vary {arguments} --count 3 --sheet-only --force --out siblings"), 0);
        let table = std::fs::read_to_string(at.join("siblings/siblings.csv")).unwrap();
        ends(at, "check siblings/sibling_001.ron", 0);
        let rows: Vec<Vec<f64>> =
            table.lines().skip(1).map(|row| row.split(',').map(|n| n.parse().unwrap()).collect()).collect();
        assert_eq!(rows.len(), 4, "{out}");
        for row in &rows {
            // As many nodes, as long.
            assert_eq!(row[1..3], rows[0][1..3]);
        }
        rows[0].clone()
    };
    let grown = siblings("open --steps 5");
    let read = siblings("grown/tree.mtg --species oak");
    assert_eq!(grown[1..], read[1..]);
    let stem = "(stems: [(points: [(0, 0, 0), (0, 0.5, 0), (0, 1, 0)])])";
    std::fs::write(at.join("stem.ron"), stem).unwrap();
    assert_eq!(siblings("stem.ron")[1..], [2.0, 1.0, 1.0]);
    assert!(siblings("lily --steps 8")[1] > 2.0);
    // What swings wider and wider is grown all the same, and said to be so.
    let unstable = |ratio: &str| {
        ends(at, &format!("vary stem.ron --lag 10 --ratio {ratio} --sheet-only --force --out siblings"), 0).1
    };
    assert!(unstable("0.4").contains("is unstable: ratio 0.400 is below 0.669"), "{}", unstable("0.4"));
    assert_eq!(unstable("0.8"), "");
    // Drawn down, a stem hangs; circling, it coils.
    for other in ["--gravitropism -4", "--nutation 20 --nutation-length 0.1"] {
        siblings(&format!("stem.ron --sensing-error 0 --disturbance 0 {other}"));
        let table = std::fs::read_to_string(at.join("siblings/siblings.csv")).unwrap();
        let heights: Vec<f64> =
            table.lines().skip(1).map(|row| row.rsplit(',').next().unwrap().parse().unwrap()).collect();
        assert!(heights[1] < 0.97 * heights[0], "{other}: {heights:?}");
    }

    // What cannot be is refused, and says why.
    for (arguments, code, told) in [
        ("vary stem.ron --steps 4", 2, "--steps changes nothing in a skeleton file"),
        ("vary grown/tree.mtg --set scenario.ground=false", 2, "--set changes nothing in an MTG"),
        ("vary stem.ron --index 1", 1, "there is no plant 1"),
        ("vary grown/tree.mtg --index 3", 1, "there is no plant 3"),
        ("vary open --species oak", 2, "--species is for"),
        ("vary open --ratio 0", 1, "ratio"),
        ("vary open --disturbance 500", 2, "0 to 114 degrees"),
        ("vary open --gravitropism nan", 1, "gravitropism is NaN"),
        ("vary open --nutation-length 0", 1, "the length of a nutation is 0"),
    ] {
        refuses(at, arguments, code, told);
    }
    let (out, _) = ends(at, "check stem.ron grown/tree.mtg", 0);
    assert!(out.contains("skeleton skeleton with 2 nodes") && out.contains("an MTG of 1 plants"), "{out}");
}

#[test]
fn figures_of_streit_hold_and_the_meter_tells_what_is_stable() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for figure in [3, 4, 7, 8, 9, 10, 11, 12, 13, 14].map(|figure| format!("streit-{figure}")) {
        let claims = json(at, &format!("reproduce {figure} --json --out {figure}"));
        let claims = claims.as_array().unwrap();
        assert!(!claims.is_empty() && claims.iter().all(|claim| claim["holds"] == true), "{claims:?}");
        let left = |kind: &str| {
            let files = std::fs::read_dir(at.join(&figure)).unwrap();
            files.filter(|file| file.as_ref().unwrap().path().extension().is_some_and(|e| e == kind)).count()
        };
        assert!(at.join(&figure).join("figure.png").exists() && left("csv") > 0, "{figure}");
    }
    let meter = |ratio: f32| ends(at, &format!("stability --lag 10 --ratio {ratio}"), 0).0;
    assert!(meter(1.0).contains("stable") && !meter(1.0).contains("unstable"), "{}", meter(1.0));
    assert!(meter(0.5).contains("unstable"), "{}", meter(0.5));
}
