//! A film of growth, and what the command line writes.

use super::*;

/// What scale a node has at a time, by the channel that moves it.
fn scale_at(channel: &gltf::animation::Channel, blob: &[u8], time: f32) -> f32 {
    let reader = channel.reader(|_| Some(blob));
    let times: Vec<f32> = reader.read_inputs().unwrap().collect();
    let gltf::animation::util::ReadOutputs::Scales(scales) = reader.read_outputs().unwrap() else {
        panic!("not a scale")
    };
    let scales: Vec<[f32; 3]> = scales.collect();
    assert_eq!(times.len(), scales.len());
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
    let key = times.iter().rposition(|at| *at <= time).unwrap_or(0);
    assert!(scales[key].iter().all(|part| *part == scales[key][0]));
    scales[key][0]
}

fn film(steps: u32) -> (GrowthFilm, Snapshot) {
    let mut resolved = Library::embedded().alone("silver_birch").unwrap();
    resolved.scenario.sensing.leaf_face = 4;
    resolved.scenario.sensing.bud_face = 6;
    let mut garden = common::garden(resolved, 1);
    let mut film = GrowthFilm::default();
    film.add(garden.snapshot());
    for _ in 0..steps {
        garden.step().unwrap();
        film.add(garden.snapshot());
    }
    film.end(garden.snapshot());
    (film, garden.snapshot())
}

#[test]
fn a_film_of_growth_shows_one_step_at_a_time_and_ends_as_the_tree() {
    let workers = Workers::new(1).unwrap();
    let (film, tree) = film(9);
    for triangles in [None, Some(5000)] {
        let mut bytes = Vec::new();
        film.write(triangles, &workers, &mut bytes).unwrap();
        let model = Model::read(&bytes);
        model.check();
        let animations: Vec<_> = model.document.animations().collect();
        assert_eq!(animations.len(), 1);
        let channels: Vec<_> = animations[0].channels().collect();
        let frames = model.document.nodes().count();
        assert!(frames >= 9 && channels.len() == frames, "{frames}");
        let targets: std::collections::HashSet<_> =
            channels.iter().map(|c| c.target().node().index()).collect();
        assert_eq!(targets.len(), frames, "one set of channels");
        for channel in &channels {
            assert_eq!(channel.target().property(), gltf::animation::Property::Scale);
            assert_eq!(channel.sampler().interpolation(), gltf::animation::Interpolation::Step);
        }
        let end = channels
            .iter()
            .flat_map(|c| c.reader(|_| Some(&model.blob)).read_inputs().unwrap())
            .fold(0.0, f32::max);
        assert!(end > 2.0);
        let mut heights = Vec::new();
        for tick in 0..=100 {
            let time = end * tick as f32 / 100.0;
            let shown: Vec<_> = channels.iter().filter(|c| scale_at(c, &model.blob, time) == 1.0).collect();
            assert!(shown.len() <= 1, "{} at {time}", shown.len());
            heights.extend(shown.first().map(|c| model.node_bounds(&c.target().node()).1.y));
        }
        assert!(heights.len() > 80 && heights.windows(2).all(|pair| pair[1] >= pair[0] - 0.05));

        let last: Vec<_> = channels.iter().filter(|c| scale_at(c, &model.blob, end) == 1.0).collect();
        assert_eq!(last.len(), 1);
        let resting: Vec<_> =
            model.document.nodes().filter(|n| n.transform().decomposed().2 == [1.0; 3]).collect();
        assert_eq!(resting.len(), 1, "a viewer that plays nothing shows the end");
        assert_eq!(resting[0].index(), last[0].target().node().index());
        let (low, high) = model.node_bounds(&resting[0]);
        let whole = bounds(&Shape::full(&tree));
        let off = ((high - low) / (whole.1 - whole.0) - 1.0).abs();
        assert!(off.max_element() < if triangles.is_none() { 1e-4 } else { 0.03 }, "{off}");
        if let Some(most) = triangles {
            let count = |node: gltf::Node| -> usize {
                node.mesh().unwrap().primitives().map(|p| p.indices().unwrap().count() / 3).sum()
            };
            assert!(model.document.nodes().all(|node| count(node) <= most));
        }
    }
}

#[test]
fn a_film_too_large_is_refused() {
    let tree = alone("oak", 11);
    let mut film = GrowthFilm::default();
    let whole: usize = Shape::full(&tree).iter().map(Shape::triangles).sum();
    let frames = MOST_TRIANGLES / whole + 2;
    assert!(frames <= 120, "more would be thinned out: {frames}");
    for step in 0..frames as u32 {
        film.add(Snapshot { step, ..tree.clone() });
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("growth.glb");
    let error = film.save(Some(usize::MAX), &Workers::new(2).unwrap(), &path).unwrap_err();
    assert!(
        matches!(error, ExportError::TooDetailed { triangles, most: MOST_TRIANGLES, .. } if triangles > MOST_TRIANGLES)
    );
    assert!(error.to_string().contains("growth.glb") && !path.exists());
}

#[cfg(feature = "cli")]
#[test]
fn grow_writes_levels_and_a_film_and_overwrites_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let burgeon = |arguments: &str| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_burgeon"));
        command.args(arguments.split_whitespace()).current_dir(folder.path()).output().unwrap()
    };
    let grow = "grow --species silver_birch --age 6 --out o --triangles 2000 --animate --wind";
    let output = burgeon(grow);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| Model::read(&std::fs::read(folder.path().join("o").join(name)).unwrap());
    for (name, most) in [("tree.glb", 2000), ("tree_1.glb", 500), ("tree_2.glb", 125)] {
        let model = read(name);
        let count =
            |mesh: gltf::Mesh| -> usize { mesh.primitives().map(|p| p.indices().unwrap().count() / 3).sum() };
        let triangles: usize = model.document.meshes().map(count).sum();
        assert!(triangles <= most && triangles > most / 4, "{name} {triangles}");
        assert!(model.colors("wood", 0).iter().any(|wind| wind.y > 0.9), "wind comes first");
    }
    assert_eq!(read("growth.glb").document.animations().count(), 1);
    // Anything in the way stops the run before it grows.
    for name in ["tree.glb", "tree_1.glb", "tree_2.glb", "growth.glb"] {
        let other = folder.path().join(format!("only_{name}"));
        std::fs::create_dir(&other).unwrap();
        std::fs::write(other.join(name), "mine").unwrap();
        let output = burgeon(&grow.replace("--out o", &format!("--out only_{name}")));
        assert_eq!(output.status.code(), Some(1));
        assert!(String::from_utf8_lossy(&output.stderr).contains("--force"));
        assert_eq!(std::fs::read(other.join(name)).unwrap(), b"mine");
        assert_eq!(std::fs::read_dir(&other).unwrap().count(), 1);
    }
    assert_eq!(burgeon("grow open --triangles 10 --out p").status.code(), Some(2));
    assert_eq!(burgeon("grow open --seeds 1..2 --animate --out p").status.code(), Some(2));
    assert!(!folder.path().join("p").exists());
}
