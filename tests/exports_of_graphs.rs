//! OBJ and MTG are read back, by others' rules, and agree with the plant.

mod common;

use std::collections::HashMap;

use burgeon::export::{mtg::write_mtg, obj};
use burgeon::files::mtg_skeletons;
use burgeon::plant::skeleton::{Skeleton, StemSegment};
use burgeon::plant::{NO_PARENT, OrganKind, OrganState, Snapshot};
use burgeon::shape::{leaves::leaves, tubes::wood};
use common::{grown, quick};

/// A vertex of the finest scale as an MTG tells it.
#[derive(Debug)]
struct Vertex {
    class: char,
    /// `/` first of its plant, `<` goes on, `+` is borne.
    relation: char,
    parent: Option<usize>,
    axis: u32,
    features: HashMap<String, f64>,
}

/// Reads the text form of an MTG: a code stands in the column of its depth; `^` refers to what stands above in that
/// column, all else to the last in the column before it.
fn read_mtg(text: &str) -> Vec<Vertex> {
    let (header, code) = text.split_once("\nMTG:\n").expect("a code section");
    assert!(header.starts_with("CODE:\tFORM-A\n"));
    for section in ["CLASSES:", "DESCRIPTION:", "FEATURES:"] {
        assert!(header.contains(section), "{section}");
    }
    let mut lines = code.lines();
    let head: Vec<&str> = lines.next().unwrap().split('\t').collect();
    assert_eq!(head[0], "ENTITY-CODE");
    let first = head.iter().skip(1).position(|name| !name.is_empty()).unwrap() + 1;
    let features = &head[first..];
    let mut vertices: Vec<Vertex> = Vec::new();
    // The last vertex of each column, `None` for a plant, and the axis it is on.
    let mut last: Vec<Option<(Option<usize>, u32)>> = vec![None; first];
    for line in lines {
        let cells: Vec<&str> = line.split('\t').collect();
        let column = cells.iter().position(|cell| !cell.is_empty()).unwrap();
        assert!(column < first, "{line}");
        let code = cells[column];
        let (code, base) = match code.strip_prefix('^') {
            Some(code) => (code, last[column]),
            None if column > 0 => (code, last[column - 1]),
            None => (code, None),
        };
        let relation = code.chars().next().unwrap();
        let entities: Vec<(char, u32)> = code[1..]
            .split(['/', '<', '+'])
            .map(|entity| (entity.chars().next().unwrap(), entity[1..].parse().unwrap()))
            .collect();
        last[column + 1..].fill(None);
        if entities[0].0 == 'P' {
            assert_eq!((relation, column), ('/', 0));
            last[0] = Some((None, 0));
            continue;
        }
        let (parent, axis) = base.unwrap_or_else(|| panic!("{line:?} refers to nothing"));
        let axis = if entities[0].0 == 'A' { entities[0].1 } else { axis };
        let numbers = &cells[first..];
        let features =
            features.iter().zip(numbers).map(|(name, n)| ((*name).to_string(), n.parse().unwrap())).collect();
        last[column] = Some((Some(vertices.len()), axis));
        vertices.push(Vertex { class: entities.last().unwrap().0, relation, parent, axis, features });
    }
    vertices
}

fn trees() -> Vec<Snapshot> {
    [("two_oaks", 8), ("figure_1c", 6)].map(|(name, steps)| grown(quick(name), 2, steps).snapshot()).into()
}

#[test]
fn an_mtg_tells_what_grows_from_what_and_where() {
    for shot in trees() {
        let mut text = Vec::new();
        write_mtg(&shot, &mut text).unwrap();
        let vertices = read_mtg(std::str::from_utf8(&text).unwrap());
        assert_eq!(vertices.len(), shot.len());
        for vertex in &vertices {
            let i = shot.index_of(vertex.features["Birth"] as u32).unwrap();
            let class = match shot.state[i].kind() {
                OrganKind::Internode => 'I',
                OrganKind::Leaf => 'L',
                OrganKind::ApicalBud | OrganKind::LateralBud => 'B',
            };
            assert_eq!(vertex.class, class);
            assert!((vertex.features["YY"] - f64::from(shot.pose[i].position.y)).abs() < 1e-6);
            assert!((vertex.features["Length"] - f64::from(shot.length(i))).abs() < 1e-6);
            let parent = vertex.parent.map(|p| vertices[p].features["Birth"] as u32);
            let known = (shot.parent[i] != NO_PARENT).then(|| shot.birth[shot.parent[i] as usize]);
            assert_eq!(parent, known, "organ {i}");
            if vertex.relation == '<' {
                let below = &vertices[vertex.parent.unwrap()];
                assert_eq!(below.axis, vertex.axis);
                assert_eq!(shot.order[i], shot.order[shot.parent[i] as usize]);
            }
        }
        // An internode has at most one that goes on with its axis.
        let mut followed = vec![0; vertices.len()];
        for vertex in vertices.iter().filter(|vertex| vertex.relation == '<') {
            followed[vertex.parent.unwrap()] += 1;
        }
        assert!(followed.iter().all(|&n| n <= 1));
    }
}

#[test]
fn an_mtg_is_read_as_the_skeleton_it_was_written_from() {
    for shot in trees() {
        let mut text = Vec::new();
        write_mtg(&shot, &mut text).unwrap();
        let read = mtg_skeletons(std::str::from_utf8(&text).unwrap(), "tree.mtg").unwrap();
        assert_eq!(read.len(), shot.plants.len());
        for (plant, read) in (0..).zip(read) {
            let known = Skeleton::of(&shot, plant).unwrap();
            read.check().unwrap();
            assert_eq!((read.nodes(), read.leaves.len()), (known.nodes(), known.leaves.len()));
            assert!((read.total_length() - known.total_length()).abs() < 1e-3);
            // The file goes along the axes, the plant by birth: compared by where things are.
            let sorted = |skeleton: &Skeleton| {
                let mut stems: Vec<_> = skeleton.segments.iter().map(|stem| (stem.tip(), *stem)).collect();
                stems.sort_by(|a, b| a.0.to_array().partial_cmp(&b.0.to_array()).unwrap());
                stems
            };
            for ((tip, stem), (known_tip, known_stem)) in sorted(&read).into_iter().zip(sorted(&known)) {
                assert!(tip.distance(known_tip) < 1e-4, "{tip} {known_tip}");
                assert_eq!(stem.radius, known_stem.radius);
                // Of two shoots that go on with an axis, an MTG has one as borne.
                assert!(stem.order >= known_stem.order);
                let base = |of: &Skeleton, stem: StemSegment| {
                    (stem.parent != NO_PARENT).then(|| of.segments[stem.parent as usize].tip())
                };
                match (base(&read, stem), base(&known, known_stem)) {
                    (Some(base), Some(known)) => assert!(base.distance(known) < 1e-4),
                    (base, known) => assert_eq!(base, known),
                }
            }
        }
    }
}

#[test]
fn a_long_stem_needs_no_deep_call_stack() {
    let mut shot = grown(quick("figure_1c"), 1, 1).snapshot();
    // Twenty thousand segments on top of each other.
    let stem = (0..shot.len()).find(|&i| shot.state[i].kind() == OrganKind::Internode).unwrap();
    let OrganState::Internode(..) = shot.state[stem] else { unreachable!() };
    let mut below = stem as u32;
    for _ in 0..20_000 {
        let at = shot.len() as u32;
        shot.birth.push(shot.next_birth);
        shot.next_birth += 1;
        shot.parent.push(below);
        shot.plant.push(shot.plant[stem]);
        shot.lineage.push(shot.lineage[stem].child(at));
        shot.span.push(shot.span[stem]);
        shot.order.push(shot.order[stem]);
        shot.attachment.push(shot.attachment[stem]);
        shot.pose.push(shot.pose[stem]);
        shot.exposure.push(shot.exposure[stem]);
        shot.allotment.push(0.0);
        shot.flow.push(shot.flow[stem]);
        shot.state.push(shot.state[stem]);
        below = at;
    }
    let write = move || {
        let mut text = Vec::new();
        write_mtg(&shot, &mut text).unwrap();
        read_mtg(std::str::from_utf8(&text).unwrap()).len()
    };
    let small = std::thread::Builder::new().stack_size(512 * 1024).spawn(write).unwrap();
    assert!(small.join().unwrap() > 20_000);
}

#[test]
fn an_obj_has_the_surfaces_of_its_plants_and_their_materials() {
    for shot in trees() {
        let (mut text, mut materials) = (Vec::new(), Vec::new());
        obj::write_obj(&shot, "tree.mtl", &mut text).unwrap();
        obj::write_mtl(&shot, &mut materials).unwrap();
        let options = tobj::LoadOptions { single_index: true, ..Default::default() };
        let (models, found) = tobj::load_obj_buf(&mut &text[..], &options, |path| {
            assert_eq!(path, std::path::Path::new("tree.mtl"));
            tobj::load_mtl_buf(&mut &materials[..])
        })
        .unwrap();
        let materials = found.unwrap();
        let surfaces: Vec<_> =
            wood(&shot).into_iter().zip(leaves(&shot)).flat_map(|(wood, leaves)| [wood, leaves]).collect();
        let surfaces: Vec<_> = surfaces.iter().filter(|surface| !surface.is_empty()).collect();
        assert_eq!(models.len(), surfaces.len());
        for (model, surface) in models.iter().zip(surfaces) {
            assert_eq!(model.mesh.indices.len(), surface.indices.len());
            for (read, &index) in model.mesh.indices.iter().zip(&surface.indices) {
                let at = &model.mesh.positions[3 * *read as usize..][..3];
                assert_eq!(at, surface.positions[index as usize]);
                let normal = &model.mesh.normals[3 * *read as usize..][..3];
                assert_eq!(normal, surface.normals[index as usize]);
            }
            let material = &materials[model.mesh.material_id.unwrap()];
            assert!(model.name.ends_with(material.name.rsplit('_').next().unwrap()));
            assert!(material.diffuse.unwrap().iter().all(|part| (0.0..=1.0).contains(part)));
        }
    }
}
