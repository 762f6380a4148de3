//! What is exported agrees with the plant it was made from.

use std::sync::Arc;

use bevy::math::ops;
use bevy::prelude::*;
use burgeon::environment::{Scene, add_plants};
use burgeon::export::{ExportError, gltf as model, tables};
use burgeon::plant::measure::{Form, StageSeconds, StepRecord};
use burgeon::plant::pose::Stem;
use burgeon::plant::*;
use burgeon::shape::foliage::Foliage;
use burgeon::shape::outline::LeafOutline;
use burgeon::shape::tubes::Axes;
use burgeon::shape::{Surface, leaves::leaves, tubes::wood};
use burgeon::species::Species;
use proptest::prelude::*;

/// Builds a plant organ by organ, parents first.
struct Sketch {
    snapshot: Snapshot,
    stems: Vec<Stem>,
    root: Stem,
}

impl Sketch {
    fn new(species: Species, position: Vec3) -> Self {
        let record = PlantRecord {
            species: Arc::new(species),
            seed: 1,
            position,
            rotation: Quat::IDENTITY,
            store: EnergyStore { stored: 3.5, germinated: Some(0) },
            ledger: EnergyLedger { income: 0.1 + 0.2, ..EnergyLedger::default() },
        };
        Self {
            snapshot: Snapshot { step: 7, plants: vec![None, Some(record)], ..Snapshot::default() },
            stems: Vec::new(),
            root: Stem { pose: Pose { position, rotation: Quat::IDENTITY }, ..Stem::default() },
        }
    }

    fn organ(&mut self, parent: u32, order: u32, turn: Quat, state: OrganState) -> u32 {
        let i = self.stems.len() as u32;
        let length = if let OrganState::Internode(internode, _) = &state { internode.length } else { 0.0 };
        let below = if parent == NO_PARENT { self.root } else { self.stems[parent as usize] };
        let pose = below.bear(turn, false);
        self.stems.push(Stem { pose, length, radius: 0.0 });
        let s = &mut self.snapshot;
        s.pose.push(pose);
        s.birth.push(3 * i + 5);
        s.parent.push(parent);
        s.plant.push(1);
        s.lineage.push(Lineage::SEED.child(i));
        s.span.push(GrowthSpan::step(i % 5));
        s.order.push(order);
        s.attachment.push(turn);
        s.exposure.push(Exposure { light: 1.0 / (i + 3) as f32, space: 0.25, sensed: true });
        s.allotment.push(0.1);
        s.flow.push(EnergyFlow { income: 0.7, upkeep: 1e-9 });
        s.state.push(state);
        i
    }

    fn stem(&mut self, parent: u32, order: u32, turn: Quat, length: f32, radius: f32, height: f32) -> u32 {
        let internode = Internode { length, radius, height_in_branch: height, ..Internode::default() };
        self.organ(parent, order, turn, OrganState::Internode(internode, Some(Node { ordinal: 0 })))
    }

    fn finish(self) -> Snapshot {
        self.snapshot
    }
}

fn oak() -> Species {
    Species { name: "oak".into(), leaf_outline: LeafOutline::Lobed, leaf_cluster: 5, ..Species::default() }
}

/// A trunk of five internodes and two branches of three, each internode with a leaf.
fn tree() -> Snapshot {
    let mut sketch = Sketch::new(oak(), Vec3::new(10.0, 1.0, -4.0));
    let mut axis = |from: u32, order: u32, first_turn: Quat, count: u32, radius: f32| {
        let mut stems = Vec::new();
        let mut parent = from;
        for k in 0..count {
            let turn = if k == 0 { first_turn } else { Quat::from_rotation_x(0.1) };
            let taper = 1.0 - 0.1 * k as f32;
            parent = sketch.stem(parent, order, turn, 0.3, radius * taper, 0.3 * (k + 1) as f32);
            stems.push(parent);
            let leaf = Leaf { size: 0.5 + 0.1 * k as f32, state: LeafState::Terminated };
            sketch.organ(parent, order, Quat::from_rotation_z(-1.0), OrganState::Leaf(leaf));
        }
        let bud = OrganState::ApicalBud(ApicalBud::default(), Default::default(), Default::default());
        sketch.organ(parent, order, Quat::IDENTITY, bud);
        stems
    };
    let trunk = axis(NO_PARENT, 0, Quat::IDENTITY, 5, 0.05);
    axis(trunk[1], 1, Quat::from_rotation_z(0.9), 3, 0.02);
    axis(trunk[3], 1, Quat::from_rotation_z(-0.9), 3, 0.015);
    let dormant = LateralBud { state: LateralBudState::Dormant, ..LateralBud::default() };
    sketch.organ(
        trunk[4],
        1,
        Quat::from_rotation_z(0.9),
        OrganState::LateralBud(dormant, GrowthTarget::default()),
    );
    sketch.finish()
}

fn check_sound(surface: &Surface) {
    assert_eq!(surface.positions.len(), surface.normals.len());
    assert_eq!(surface.positions.len(), surface.uvs.len());
    assert!(surface.positions.iter().flatten().all(|x| x.is_finite()));
    assert!(surface.uvs.iter().flatten().all(|x| x.is_finite()));
    assert!(surface.normals.iter().all(|&n| (Vec3::from(n).length() - 1.0).abs() < 1e-4));
    assert!(surface.indices.iter().all(|&i| (i as usize) < surface.positions.len()));
}

#[test]
fn axes_follow_the_internodes() {
    let snapshot = tree();
    let axes = Axes::of(&snapshot);
    let lengths: Vec<usize> = axes.starts.iter().map(|&start| axes.walk(start).count()).collect();
    assert_eq!(lengths, [5, 3, 3]);
}

#[test]
fn tubes_have_no_gap() {
    let snapshot = tree();
    let surface = &wood(&snapshot)[1];
    check_sound(surface);
    // Every edge but those around the open bases is shared by two triangles, seams welded.
    let weld = |i: u32| surface.positions[i as usize].map(|x| x.to_bits());
    let mut edges = std::collections::HashMap::new();
    for t in surface.indices.chunks(3) {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            let (a, b) = (weld(a), weld(b));
            *edges.entry((a.min(b), a.max(b))).or_insert(0) += 1;
        }
    }
    let open: Vec<_> = edges.iter().filter(|(_, count)| **count != 2).collect();
    let bases: Vec<Vec3> =
        Axes::of(&snapshot).starts.iter().map(|&i| snapshot.pose[i as usize].position).collect();
    for ((a, _), count) in &open {
        assert_eq!(**count, 1);
        let point = Vec3::from(a.map(f32::from_bits));
        // The trunk of 5 cm stands on a base swollen to 9.
        assert!(bases.iter().any(|base| base.distance(point) < 0.091), "open at {point}");
    }
    assert!((9..=36).contains(&open.len()), "three open rings, {} edges", open.len());
}

#[test]
fn wood_and_leaves_of_the_scene_are_those_drawn() {
    let snapshot = tree();
    let mut scene = Scene::default();
    add_plants(&mut scene, &snapshot);
    assert_eq!(scene.capsules.len(), 11);
    assert_eq!(scene.leaves.len(), 11 * 5);
    assert!(scene.capsules.windows(2).all(|c| c[0].organ < c[1].organ));
    assert!(scene.capsules.iter().all(|c| c.plant == 1));
    let (low, high) = leaves(&snapshot)[1].bounds().unwrap();
    for leaf in &scene.leaves {
        let tip = leaf.base + leaf.midrib;
        assert!(tip.cmpge(low - 0.01).all() && tip.cmple(high + 0.01).all());
    }
}

#[test]
fn glb_reads_back_as_the_plant() {
    let snapshot = tree();
    let mut bytes = Vec::new();
    model::write_glb(&snapshot, default(), &mut bytes).unwrap();
    assert_eq!(bytes.len() % 4, 0);
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&bytes).unwrap();
    let blob = blob.unwrap();
    let materials: Vec<_> =
        document.materials().map(|m| (m.name().unwrap().to_owned(), m.double_sided())).collect();
    assert_eq!(materials, [("oak bark".to_owned(), false), ("oak leaves".to_owned(), true)]);
    assert!(document.views().all(|view| view.offset() % 4 == 0));

    let roots: Vec<_> = document.default_scene().unwrap().nodes().collect();
    assert_eq!(roots.len(), 1, "a node for each plant that lives");
    let origin = Vec3::from(roots[0].transform().decomposed().0);
    assert_eq!(origin, Vec3::new(10.0, 1.0, -4.0));
    let parts: Vec<_> = roots[0].children().collect();
    assert_eq!(parts.iter().map(|n| n.name().unwrap()).collect::<Vec<_>>(), ["wood", "leaves"]);
    for (part, surface) in parts.iter().zip([&wood(&snapshot)[1], &leaves(&snapshot)[1]]) {
        let primitive = part.mesh().unwrap().primitives().next().unwrap();
        let reader = primitive.reader(|_| Some(&blob));
        let positions: Vec<Vec3> = reader.read_positions().unwrap().map(Vec3::from).collect();
        assert_eq!(positions.len(), surface.positions.len());
        for (read, &drawn) in positions.iter().zip(&surface.positions) {
            assert!((*read + origin).distance(Vec3::from(drawn)) < 1e-5);
        }
        assert_eq!(reader.read_normals().unwrap().collect::<Vec<_>>(), surface.normals);
        assert_eq!(reader.read_tex_coords(0).unwrap().into_f32().collect::<Vec<_>>(), surface.uvs);
        assert_eq!(reader.read_indices().unwrap().into_u32().collect::<Vec<_>>(), surface.indices);
        let bounds = primitive.bounding_box();
        let low = positions.iter().copied().reduce(Vec3::min).unwrap();
        let high = positions.iter().copied().reduce(Vec3::max).unwrap();
        assert_eq!((Vec3::from(bounds.min), Vec3::from(bounds.max)), (low, high));
    }

    let wood_bounds = parts[0].mesh().unwrap().primitives().next().unwrap().bounding_box();
    let tallest = snapshot
        .state
        .iter()
        .zip(&snapshot.pose)
        .filter_map(|(state, pose)| match state {
            OrganState::Internode(internode, _) => Some(pose.tip(internode.length).y),
            _ => None,
        })
        .fold(0.0, f32::max);
    assert!((wood_bounds.max[1] + origin.y - tallest).abs() < 0.03);
}

#[test]
fn a_model_of_nothing_is_still_a_model() {
    let mut bytes = Vec::new();
    model::write_glb(&Snapshot::default(), default(), &mut bytes).unwrap();
    assert_eq!(gltf::Gltf::from_slice(&bytes).unwrap().meshes().count(), 0);
}

#[test]
fn organs_csv_reads_back_exactly() {
    let snapshot = tree();
    let mut bytes = Vec::new();
    tables::write_organs(&snapshot, &mut bytes).unwrap();
    let mut table = csv::Reader::from_reader(&bytes[..]);
    let headers = table.headers().unwrap().clone();
    assert_eq!(headers, tables::ORGAN_COLUMNS.to_vec());
    let rows: Vec<_> = table.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), snapshot.len());
    for (i, row) in rows.iter().enumerate() {
        let cell = |name: &str| &row[headers.iter().position(|h| h == name).unwrap()];
        let number = |name: &str| cell(name).parse::<f32>().unwrap();
        assert_eq!(cell("birth"), snapshot.birth[i].to_string());
        let parent = snapshot.parent[i];
        let parent =
            if parent == NO_PARENT { String::new() } else { snapshot.birth[parent as usize].to_string() };
        assert_eq!(cell("parent"), parent);
        assert_eq!(u64::from_str_radix(cell("lineage"), 16).unwrap(), snapshot.lineage[i].0);
        assert_eq!(cell("age"), (7 - snapshot.span[i].born()).to_string());
        assert_eq!(Vec3::new(number("x"), number("y"), number("z")), snapshot.pose[i].position);
        let turn = Quat::from_xyzw(number("qx"), number("qy"), number("qz"), number("qw"));
        assert_eq!(turn, snapshot.pose[i].rotation);
        if snapshot.state[i].kind() == OrganKind::Internode {
            assert_eq!((cell("light"), cell("space"), cell("allotment")), ("", "", ""), "wood looks nowhere");
        } else {
            assert_eq!(number("light"), snapshot.exposure[i].light);
            assert_eq!(number("space"), snapshot.exposure[i].space);
        }
        assert_eq!(number("energy_out"), 1e-9);
        match &snapshot.state[i] {
            OrganState::Internode(internode, _) => {
                assert_eq!((cell("kind"), cell("state"), cell("size")), ("internode", "node", ""));
                assert_eq!((number("length"), number("radius")), (internode.length, internode.radius));
            }
            OrganState::Leaf(leaf) => {
                assert_eq!((cell("kind"), cell("state"), cell("length")), ("leaf", "terminated", ""));
                assert_eq!(number("size"), leaf.size);
            }
            OrganState::ApicalBud(..) => assert_eq!((cell("kind"), cell("state")), ("apical_bud", "growing")),
            OrganState::LateralBud(..) => {
                assert_eq!((cell("kind"), cell("state")), ("lateral_bud", "dormant"));
            }
        }
    }
}

#[test]
fn steps_csv_reads_back_exactly() {
    let seconds = StageSeconds { generate: 0.001, update: 1e-7, sense: 1.0 / 3.0, finish: 0.0 };
    let record = StepRecord::of(&tree(), seconds);
    // Each another, so that no two columns can change places.
    let form = Form {
        crown_width_m: 2.0,
        crown_base_m: 3.0,
        trunk_diameter_m: 4.0,
        breast_diameter_m: 5.0,
        live_crown_base_m: 6.0,
        widest_height_m: 7.0,
        drooping_share: 0.75,
        by_order: [9, 10, 11, 12, 13],
        strahler_order: 15,
        bifurcation_ratio: 4.5,
        leaf_area_m2: 14.0,
        ..record.form
    };
    let record = StepRecord { form, ..record };
    let mut bytes = Vec::new();
    tables::write_steps(&[record, record], &mut bytes).unwrap();
    let mut table = csv::Reader::from_reader(&bytes[..]);
    let headers = table.headers().unwrap().clone();
    assert_eq!(headers, tables::STEP_COLUMNS.to_vec());
    let rows: Vec<_> = table.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 2);
    let number =
        |name: &str| -> f64 { rows[1][headers.iter().position(|h| h == name).unwrap()].parse().unwrap() };
    assert_eq!(number("step"), 7.0);
    assert_eq!(number("organs"), f64::from(record.form.organs));
    assert_eq!(number("max_order"), 1.0);
    assert_eq!(number("height_m") as f32, record.form.height_m);
    assert_eq!(number("mean_light"), record.form.mean_light);
    let by_name = [
        ("crown_width_m", 2.0),
        ("crown_base_m", 3.0),
        ("trunk_diameter_m", 4.0),
        ("breast_diameter_m", 5.0),
        ("live_crown_base_m", 6.0),
        ("widest_height_m", 7.0),
        ("drooping_share", 0.75),
        ("order_0", 9.0),
        ("order_2", 11.0),
        ("order_4_and_above", 13.0),
        ("strahler_order", 15.0),
        ("bifurcation_ratio", 4.5),
        ("leaf_area_m2", 14.0),
    ];
    for (name, value) in by_name {
        assert_eq!(number(name), value, "{name}");
    }
    assert_eq!(number("income"), 0.1 + 0.2);
    assert_eq!(number("store"), 3.5);
    assert_eq!(number("sense_s"), 1.0 / 3.0);
}

#[test]
fn form_measures_the_plant() {
    let mut sketch = Sketch::new(Species::default(), Vec3::new(0.0, 2.0, 0.0));
    let trunk = sketch.stem(NO_PARENT, 0, Quat::IDENTITY, 1.5, 0.1, 1.5);
    let quarter = Quat::from_rotation_z(-std::f32::consts::FRAC_PI_2);
    let branch = sketch.stem(trunk, 1, quarter, 1.0, 0.02, 1.0);
    let leaf = Leaf { size: 0.25, state: LeafState::Growing };
    sketch.organ(branch, 1, Quat::IDENTITY, OrganState::Leaf(leaf));
    let snapshot = sketch.finish();
    let form = Form::of(&snapshot, Some(1));
    assert_eq!(form, Form::of(&snapshot, None));
    assert_eq!((form.organs, form.internodes, form.nodes, form.leaves), (3, 2, 2, 1));
    assert_eq!(form.max_order, 1);
    let close = |a: f32, b: f32| assert!((a - b).abs() < 1e-5, "{a} {b}");
    close(form.height_m, 1.5);
    close(form.crown_base_m, 1.5);
    close(form.trunk_diameter_m, 0.2);
    // x: from the trunk's bark at -0.1 to the tip of a leaf of half length at 1.06; z: the trunk's 0.2.
    close(form.crown_width_m, 0.5 * (1.16 + 0.2));
    close(form.leaf_area_m2 as f32, 0.25 * Species::default().leaf_area());
    close(form.mean_light as f32, snapshot.exposure[2].light);
    assert_eq!(Form::of(&snapshot, Some(0)), Form::default());
}

#[test]
fn form_measures_the_crown_as_a_forester_would() {
    let mut sketch = Sketch::new(Species::default(), Vec3::new(3.0, 2.0, 0.0));
    let out = |degrees: f32| Quat::from_rotation_z(-degrees.to_radians());
    let foot = sketch.stem(NO_PARENT, 0, Quat::IDENTITY, 1.0, 0.1, 1.0);
    let trunk = sketch.stem(foot, 0, Quat::IDENTITY, 3.0, 0.05, 4.0);
    let hangs = sketch.stem(trunk, 1, out(150.0), 1.0, 0.01, 1.0);
    let limbs = [80.0, -80.0].map(|degrees| sketch.stem(foot, 1, out(degrees), 3.0, 0.01, 3.0));
    sketch.stem(limbs[0], 2, out(-80.0), 0.5, 0.005, 0.5);
    for (stem, size) in [(foot, 0.01), (trunk, 1.0), (hangs, 1.0), (limbs[0], 1.0), (limbs[1], 1.0)] {
        let leaf = Leaf { size, state: LeafState::Terminated };
        sketch.organ(stem, 1, Quat::IDENTITY, OrganState::Leaf(leaf));
    }
    let shot = sketch.finish();
    let form = Form::of(&shot, None);
    let close = |a: f32, b: f32| assert!((a - b).abs() < 1e-4, "{a} {b}");
    close(form.trunk_diameter_m, 0.2);
    // Limbs cross 1.3 m too; the trunk is thicker there.
    close(form.breast_diameter_m, 0.1);
    // The leaf at 1 m is the lowest, and a four-hundredth of all: the live crown begins with the limbs'. A leaf is where
    // its middle is.
    let along = |degrees: f32| ops::cos(degrees.to_radians());
    let half = 0.5 * Species::default().leaf_reach_m();
    close(form.crown_base_m, 1.0);
    close(form.live_crown_base_m, 1.0 + (3.0 + half) * along(80.0));
    // One of the limbs' two leaves is a quarter of all, and the outermost.
    close(form.widest_height_m, 1.0 + (3.0 + half) * along(80.0));
    close(form.drooping_share, 1.0 / 7.5);
    assert_eq!(form.by_order, [2, 3, 1, 0, 0]);
    // What hangs from the trunk goes on as it, a twig as its limb, and the other limb bears none: three meet at the foot.
    assert_eq!((form.strahler_order, strahler::branches(&shot, None)), (2, vec![3, 1]));
    close(form.bifurcation_ratio, 3.0);
}

#[test]
fn orders_of_strahler_rise_where_two_of_the_highest_meet() {
    let mut sketch = Sketch::new(Species::default(), Vec3::ZERO);
    let mut stem = |parent, order| sketch.stem(parent, order, Quat::IDENTITY, 1.0, 0.1, 1.0);
    let trunk = stem(NO_PARENT, 0);
    for _ in 0..2 {
        // A limb of two pieces is one branch; the twig it bears half way is of a lower order and leaves it as it is.
        let limb = stem(trunk, 1);
        stem(limb, 2);
        let end = stem(limb, 1);
        for _ in 0..2 {
            stem(end, 2);
        }
    }
    stem(trunk, 1);
    let shot = sketch.finish();
    assert_eq!(strahler::branches(&shot, Some(1)), [7, 2, 1]);
    assert_eq!(strahler::branches(&shot, None), [7, 2, 1]);
    assert!(strahler::branches(&shot, Some(0)).is_empty());
}

#[test]
fn an_unwritable_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("missing").join("tree.glb");
    let error = model::save_glb(&tree(), default(), &path).unwrap_err();
    assert!(matches!(&error, ExportError::Write { path: Some(p), .. } if *p == path));
    assert!(error.to_string().contains("tree.glb"));

    let path = folder.path().join("organs.csv");
    tables::save_organs(&tree(), &path).unwrap();
    assert_eq!(csv::Reader::from_path(&path).unwrap().records().count(), tree().len());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn degenerate_organs_make_sound_surfaces(
        organs in prop::collection::vec(
            (
                prop_oneof![Just(0.0_f32), 1e-6_f32..1.0],
                prop_oneof![Just(0.0_f32), 1e-6_f32..0.3],
                prop_oneof![Just(0.0_f32), 1e-6_f32..1.0],
                0_u32..3,
                -3.2_f32..3.2,
                any::<bool>(),
            ),
            1..40,
        ),
        cluster in 1_u32..9,
        outline in 0..LeafOutline::ALL.len(),
    ) {
        let species =
            Species { leaf_cluster: cluster, leaf_outline: LeafOutline::ALL[outline], ..Species::default() };
        let mut sketch = Sketch::new(species.clone(), Vec3::ZERO);
        let (mut parent, mut height) = (NO_PARENT, 0.0);
        for (length, radius, size, order, angle, flat) in organs {
            height += length;
            let turn = if flat { Quat::from_rotation_x(std::f32::consts::PI) } else { Quat::from_rotation_z(angle) };
            parent = sketch.stem(parent, order / 2, turn, length, radius, height);
            let leaf = Leaf { size, state: LeafState::Growing };
            sketch.organ(parent, order, turn, OrganState::Leaf(leaf));
        }
        let snapshot = sketch.finish();
        for surface in wood(&snapshot).iter().chain(&leaves(&snapshot)) {
            check_sound(surface);
        }
        let mut bytes = Vec::new();
        model::write_glb(&snapshot, default(), &mut bytes).unwrap();
        gltf::Gltf::from_slice(&bytes).unwrap();
        let foliage = Foliage::of(&species);
        for blade in foliage.blades(&snapshot.pose[0], 0.0, Lineage::SEED) {
            prop_assert!(blade.base.is_finite() && blade.across.is_finite() && blade.normal().is_finite());
        }
    }
}

#[test]
fn wood_does_not_pinch_where_an_axis_forks() {
    let mut sketch = Sketch::new(Species::default(), Vec3::ZERO);
    let trunk = sketch.stem(NO_PARENT, 0, Quat::IDENTITY, 1.0, 0.1, 1.0);
    for side in [-0.5, 0.5] {
        sketch.stem(trunk, 1, Quat::from_rotation_z(side), 1.0, 0.08, 1.0);
    }
    let surface = &wood(&sketch.finish())[1];
    let at_fork = surface.positions.iter().filter(|p| p[1] == 1.0).map(|p| ops::hypot(p[0], p[2]));
    assert!((at_fork.fold(0.0, f32::max) - 0.1).abs() < 1e-6);
}
