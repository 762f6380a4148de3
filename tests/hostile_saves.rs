//! A save whose checksum is right but whose garden is not: a typed error, or it grows on; never a panic.

mod common;

use std::path::Path;
use std::sync::Arc;

use bevy::prelude::*;
use burgeon::environment::workers::Workers;
use burgeon::export::tables::{save_organs, save_steps};
use burgeon::export::{ExportError, film, gltf};
use burgeon::files::{RunFile, SaveError, StepHashes, read_save, write_save};
use burgeon::plant::{OrganState, Snapshot, SnapshotError, restore};
use burgeon::scenario::{Garden, GardenSave, GardenSaveError, SavedRun};
use common::{coarse, garden, grown, quick, shipped};
use proptest::prelude::*;

/// A lam_king tree of a few steps beside a wall, looking around through the smallest faces.
fn small() -> Garden {
    grown(coarse(shipped("figure_1d")), 1, 5)
}

fn saved() -> SavedRun {
    let resolved = quick("figure_1d");
    let mut garden = small();
    SavedRun::new(RunFile::new(&resolved, 1, 5, StepHashes::default()), garden.save())
}

/// Restores a snapshot into a bare world and grows a step from it.
fn grow_from(shot: &Snapshot) {
    let mut app = App::new();
    app.insert_resource(Workers::new(1).unwrap()).add_plugins((MinimalPlugins, burgeon::BurgeonPlugins));
    app.insert_resource(burgeon::prelude::Sensing { leaf_face: 2, bud_face: 4, ..default() });
    restore(app.world_mut(), shot);
    burgeon::grow(app.world_mut(), 1);
}

const NUMBERS: [f32; 9] = [f32::NAN, f32::INFINITY, -1.0, 0.0, 1.0e-30, 0.5, 2.0, 1.0e9, -1.0e30];
const COUNTS: [u32; 8] = [0, 1, 3, 40, 1 << 20, 1 << 31, u32::MAX - 1, u32::MAX];

/// Makes one column wrong at one place, or of another length.
fn corrupt(shot: &mut Snapshot, column: usize, at: usize, how: usize) {
    let (x, n) = (NUMBERS[how % NUMBERS.len()], COUNTS[how % COUNTS.len()]);
    let i = at % shot.len();
    let turn = Quat::from_xyzw(x, 0.1, 0.2, 0.3);
    match column {
        0 => shot.birth[i] = n,
        1 => shot.parent[i] = n,
        2 => shot.plant[i] = n,
        3 => shot.span[i].start = x,
        4 => shot.order[i] = n,
        5 => shot.attachment[i] = turn,
        6 => shot.pose[i].position.y = x,
        7 => shot.pose[i].rotation = turn,
        8 => shot.exposure[i].light = x,
        9 => shot.exposure[i].space = x,
        10 => shot.allotment[i] = x,
        11 => shot.flow[i].income = x,
        12 => shot.state[i] = shot.state[how % shot.len()],
        13 => match &mut shot.state[i] {
            OrganState::Internode(wood, _) if how.is_multiple_of(2) => wood.length = x,
            OrganState::Internode(wood, _) => wood.radius = x,
            OrganState::ApicalBud(bud, ..) => bud.height_in_branch = x,
            OrganState::LateralBud(bud, _) => bud.rank = x,
            OrganState::Leaf(leaf) => leaf.size = x,
        },
        14 => match &mut shot.state[i] {
            OrganState::Internode(wood, _) => wood.poor_steps = n,
            OrganState::ApicalBud(bud, ..) => bud.starved = n,
            OrganState::LateralBud(bud, _) => bud.dormancy = n,
            OrganState::Leaf(leaf) => leaf.size = x,
        },
        15 => shot.next_birth = n,
        16 => shot.step = n,
        17 => shot.plants.truncate(how % 2),
        18 => shot.plants[0] = None,
        19 => shot.plants[0].as_mut().unwrap().store.stored = x.into(),
        20 => shot.plants[0].as_mut().unwrap().store.germinated = Some(n),
        21 => Arc::make_mut(&mut shot.plants[0].as_mut().unwrap().species).extension_m = x,
        22 => shot.birth.truncate(i),
        23 => shot.parent.truncate(i),
        24 => shot.plant.truncate(i),
        25 => shot.lineage.truncate(i),
        26 => shot.span.truncate(i),
        27 => shot.order.truncate(i),
        28 => shot.attachment.truncate(i),
        29 => shot.pose.truncate(i),
        30 => shot.exposure.push(default()),
        31 => shot.allotment.clear(),
        32 => shot.flow.truncate(i),
        _ => shot.state.truncate(i),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn a_snapshot_with_one_wrong_column_is_told_or_grows(
        column in 0usize..34, at in any::<usize>(), how in any::<usize>(),
    ) {
        static SOUND: std::sync::LazyLock<Snapshot> = std::sync::LazyLock::new(|| small().snapshot());
        let mut shot = SOUND.clone();
        prop_assert_eq!(shot.check(), Ok(()));
        corrupt(&mut shot, column, at, how);
        if shot.check().is_ok() {
            grow_from(&shot);
        }
    }

    #[test]
    fn a_save_with_changed_bytes_and_a_right_checksum_is_told_or_resumes(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
    ) {
        static SOUND: std::sync::LazyLock<Vec<u8>> =
            std::sync::LazyLock::new(|| postcard::to_stdvec(&small().save()).unwrap());
        let mut bytes = SOUND.clone();
        for (at, byte) in changes {
            *at.get_mut(&mut bytes) = byte;
        }
        if let Ok(save) = postcard::from_bytes::<GardenSave>(&bytes) {
            let _ = Garden::resume(save, Workers::new(1).unwrap()).map_err(|e| e.to_string());
        }
    }
}

#[test]
fn what_is_wrong_with_a_snapshot_is_named() {
    let sound = small().snapshot();
    let broken = |change: fn(&mut Snapshot)| {
        let mut shot = sound.clone();
        change(&mut shot);
        shot.check().unwrap_err()
    };
    assert!(matches!(
        broken(|s| s.flow.truncate(1)),
        SnapshotError::Column { column: "flow", length: 1, .. }
    ));
    assert!(matches!(broken(|s| s.birth[3] = s.birth[2]), SnapshotError::Birth { organ: 3, .. }));
    assert!(matches!(broken(|s| s.next_birth = 1), SnapshotError::Birth { .. }));
    assert!(matches!(broken(|s| s.parent[2] = 2), SnapshotError::Parent { organ: 2, parent: 2 }));
    assert!(matches!(broken(|s| s.plant[0] = 7), SnapshotError::Plant { organ: 0, plant: 7 }));
    assert!(matches!(broken(|s| s.plants[0] = None), SnapshotError::Plant { organ: 0, plant: 0 }));
    assert!(matches!(
        broken(|s| s.allotment[1] = f32::NAN),
        SnapshotError::Organ { organ: 1, field: "allotment", .. }
    ));
    assert!(matches!(
        broken(|s| Arc::make_mut(&mut s.plants[0].as_mut().unwrap().species).candidates = 0),
        SnapshotError::Species { plant: 0, .. }
    ));
    let leaf = sound.state.iter().position(|s| matches!(s, OrganState::Leaf(_))).unwrap();
    let mut on_a_leaf = sound.clone();
    *on_a_leaf.parent.last_mut().unwrap() = leaf as u32;
    assert!(matches!(on_a_leaf.check(), Err(SnapshotError::Parent { .. })));
}

#[test]
fn a_save_that_is_whole_but_unsound_is_refused_with_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tree.save");
    let good = saved();
    good.write(&path).unwrap();
    assert_eq!(SavedRun::read(&path).unwrap(), good);

    let mut bad = good.clone();
    bad.run.steps = 4;
    write_save(&path, &bad).unwrap();
    assert!(matches!(
        SavedRun::read(&path),
        Err(SaveError::Unsound { source: GardenSaveError::Differ("steps"), .. })
    ));

    // A garden that says it has made an edit its scenario does not have: another scenario spliced in.
    let mut edited = quick("lamp_moved");
    edited.scenario.edits[0].step = 1;
    let begin = postcard::to_stdvec(&edited.scenario).unwrap();
    let whole = postcard::to_stdvec(&grown(edited.clone(), 1, 2).save()).unwrap();
    edited.scenario.edits.clear();
    let head = postcard::to_stdvec(&edited.scenario).unwrap();
    let spliced: GardenSave = postcard::from_bytes(&[&head, &whole[begin.len()..]].concat()).unwrap();
    assert!(matches!(spliced.check(), Err(GardenSaveError::Edits { made: 1, due: 0, .. })));
    assert!(Garden::resume(spliced, Workers::new(1).unwrap()).is_err());
}

/// Every writer of a file leaves what was there if it fails, and leaves nothing of its own.
#[test]
fn no_writer_leaves_half_a_file() {
    let tree = small().snapshot();
    let records = small().records().to_vec();
    let picture = image::RgbImage::new(4, 4);
    let write = |path: &Path| -> [bool; 6] {
        [
            gltf::save_glb(&tree, default(), path).is_ok(),
            save_organs(&tree, path).is_ok(),
            save_steps(&records, path).is_ok(),
            film::save_png(path, &picture).is_ok(),
            film::save_gif(path, std::slice::from_ref(&picture), default()).is_ok(),
            write_save(path, &7_u32).is_ok(),
        ]
    };
    let folder = tempfile::tempdir().unwrap();
    let taken = folder.path().join("taken");
    std::fs::create_dir(&taken).unwrap();
    assert_eq!(write(&taken), [false; 6]);
    assert_eq!(write(&folder.path().join("none").join("file")), [false; 6]);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "only the folder that was there");
    assert_eq!(std::fs::read_dir(&taken).unwrap().count(), 0);
    assert!(
        matches!(gltf::save_glb(&tree, default(), &taken), Err(ExportError::Write { path: Some(p), .. }) if p == taken)
    );

    let file = folder.path().join("file");
    std::fs::write(&file, "old").unwrap();
    assert_eq!(write(&file), [true; 6]);
    assert_eq!(read_save::<u32>(&file).unwrap(), 7);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn a_sound_garden_resumes() {
    let mut first = garden(quick("figure_1d"), 3);
    first.step().unwrap();
    let mut again = Garden::resume(first.save(), Workers::new(1).unwrap()).unwrap();
    first.step().unwrap();
    again.step().unwrap();
    assert_eq!(first.snapshot(), again.snapshot());
}
