//! Models as artists take them: textures, soft crowns and wind, read back from the GLB.

#[path = "../common/mod.rs"]
mod common;
mod film;

use std::collections::HashMap;
use std::sync::OnceLock;

use bevy::prelude::*;
use burgeon::assets::Library;
use burgeon::environment::workers::Workers;
use burgeon::export::ExportError;
use burgeon::export::gltf::{GlbSettings, GrowthFilm, Level, MOST_TRIANGLES, write_glb};
use burgeon::plant::{OrganState, Snapshot};
use burgeon::shape::bark::Bark;
use burgeon::shape::crown::Crown;
use burgeon::shape::levels::{self, Shape};
use burgeon::shape::outline::LeafOutline;
use burgeon::shape::{Surface, texture};
use burgeon::species::Species;
use burgeon::species::parameter::Color;
use common::grown;
use gltf::material::AlphaMode;
use gltf::texture::WrappingMode;

/// A species alone in the open after some steps, with small faces.
fn alone(species: &str, steps: u32) -> Snapshot {
    let mut resolved = Library::embedded().alone(species).unwrap();
    resolved.scenario.sensing.leaf_face = 4;
    resolved.scenario.sensing.bud_face = 6;
    grown(resolved, 1, steps).snapshot()
}

fn birch() -> &'static Snapshot {
    static TREE: OnceLock<Snapshot> = OnceLock::new();
    TREE.get_or_init(|| alone("silver_birch", 9))
}

/// A GLB as it is read.
struct Model {
    document: gltf::Document,
    blob: Vec<u8>,
}

impl Model {
    fn read(bytes: &[u8]) -> Self {
        let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(bytes).unwrap();
        Self { document, blob: blob.unwrap() }
    }

    fn of(snapshot: &Snapshot, settings: GlbSettings) -> Self {
        let mut bytes = Vec::new();
        write_glb(snapshot, settings, &mut bytes).unwrap();
        Self::read(&bytes)
    }

    fn image(&self, texture: &gltf::Texture) -> image::RgbaImage {
        let gltf::image::Source::View { view, mime_type } = texture.source().source() else {
            panic!("outside the file")
        };
        assert_eq!(mime_type, "image/png");
        let bytes = &self.blob[view.offset()..view.offset() + view.length()];
        image::load_from_memory_with_format(bytes, image::ImageFormat::Png).unwrap().to_rgba8()
    }

    /// The material of a kind and its picture of colour.
    fn look(&self, name: &str) -> (gltf::Material<'_>, image::RgbaImage) {
        let material = self.document.materials().find(|m| m.name() == Some(name)).unwrap();
        let color = material.pbr_metallic_roughness().base_color_texture().unwrap();
        let image = self.image(&color.texture());
        (material, image)
    }

    fn primitive(&self, part: &str) -> gltf::Primitive<'_> {
        let node = self.document.nodes().find(|node| node.name() == Some(part)).unwrap();
        node.mesh().unwrap().primitives().next().unwrap()
    }

    fn normals(&self, part: &str) -> Vec<Vec3> {
        let primitive = self.primitive(part);
        primitive.reader(|_| Some(&self.blob)).read_normals().unwrap().map(Vec3::from).collect()
    }

    fn positions(&self, part: &str) -> Vec<Vec3> {
        let primitive = self.primitive(part);
        primitive.reader(|_| Some(&self.blob)).read_positions().unwrap().map(Vec3::from).collect()
    }

    fn colors(&self, part: &str, set: u32) -> Vec<Vec4> {
        let primitive = self.primitive(part);
        let reader = primitive.reader(|_| Some(&self.blob));
        reader.read_colors(set).unwrap().into_rgba_f32().map(Vec4::from).collect()
    }

    /// Least and greatest corner of what a node shows.
    fn node_bounds(&self, node: &gltf::Node) -> (Vec3, Vec3) {
        let boxes = node.mesh().unwrap().primitives().map(|p| p.bounding_box()).collect::<Vec<_>>();
        let corners = boxes.iter().map(|b| (Vec3::from(b.min), Vec3::from(b.max)));
        corners.reduce(|(a, b), (c, d)| (a.min(c), b.max(d))).unwrap()
    }

    /// What a reader may rely on: aligned views inside the file, least and greatest as they are.
    fn check(&self) {
        for view in self.document.views() {
            assert_eq!(view.offset() % 4, 0);
            assert!(view.offset() + view.length() <= self.blob.len());
        }
        for accessor in self.document.accessors() {
            let view = accessor.view().unwrap();
            assert_eq!(accessor.count() * accessor.size(), view.length());
        }
        self.check_meshes();
    }

    fn check_meshes(&self) {
        for mesh in self.document.meshes() {
            for primitive in mesh.primitives() {
                let reader = primitive.reader(|_| Some(&self.blob));
                let positions: Vec<Vec3> = reader.read_positions().unwrap().map(Vec3::from).collect();
                let bounds = primitive.bounding_box();
                assert_eq!(Vec3::from(bounds.min), positions.iter().copied().reduce(Vec3::min).unwrap());
                assert_eq!(Vec3::from(bounds.max), positions.iter().copied().reduce(Vec3::max).unwrap());
                let indices = reader.read_indices().unwrap().into_u32();
                assert!(indices.max().unwrap() < positions.len() as u32);
                let normals: Vec<Vec3> = reader.read_normals().unwrap().map(Vec3::from).collect();
                assert!(normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-4));
                let relief = primitive.material().normal_texture().is_some();
                assert_eq!(relief, reader.read_tangents().is_some());
                for (tangent, normal) in reader.read_tangents().into_iter().flatten().zip(&normals) {
                    let across = Vec4::from(tangent).xyz();
                    assert!((across.length() - 1.0).abs() < 1e-4 && across.dot(*normal).abs() < 1e-3);
                    assert_eq!(tangent[3].abs(), 1.0);
                }
            }
        }
    }
}

/// Mean colour of the texels that show, linear RGB.
fn mean(image: &image::RgbaImage) -> Vec3 {
    let shown: Vec<Vec3> = image
        .pixels()
        .filter(|pixel| pixel[3] >= 128)
        .map(|p| Color([p[0], p[1], p[2]].map(|part| f32::from(part) / 255.0)).linear().into())
        .collect();
    shown.iter().copied().sum::<Vec3>() / shown.len() as f32
}

fn linear(color: Color) -> Vec3 {
    color.linear().into()
}

#[test]
fn textures_have_the_colours_of_their_species() {
    for name in ["oak", "silver_birch", "scots_pine", "japanese_maple", "palm"] {
        let species = Species::named(name).unwrap();
        let tree = alone(name, 3);
        let model = Model::of(&tree, GlbSettings { wind_first: true, ..default() });
        model.check();
        let (bark, image) = model.look(&format!("{name} bark"));
        assert_eq!((image.width(), image.height()), (256, 256));
        let Bark { old, mark, .. } = Bark::of(&species);
        let off = mean(&image) - old;
        // Marks take their share of it.
        let share = off.dot(mark - old) / (mark - old).length_squared().max(1e-9);
        assert!((-0.05..0.4).contains(&share), "{name} bark {share}");
        assert!((off - (mark - old) * share).length() < 0.06 * old.length(), "{name} bark {off}");
        assert_eq!(bark.alpha_mode(), AlphaMode::Opaque);
        let normals = model.image(&bark.normal_texture().unwrap().texture());
        for pixel in normals.pixels() {
            let normal = Vec3::new(pixel[0].into(), pixel[1].into(), pixel[2].into()) / 127.5 - 1.0;
            assert!((normal.length() - 1.0).abs() < 0.02 && normal.z > 0.2, "{normal}");
        }

        let (leaves, image) = model.look(&format!("{name} leaves"));
        let color = linear(species.leaf_color);
        assert!((mean(&image) / color - 1.0).abs().max_element() < 0.05, "{name} leaf");
        assert_eq!(
            (leaves.alpha_mode(), leaves.alpha_cutoff(), leaves.double_sided()),
            (AlphaMode::Mask, Some(0.5), true)
        );
    }
}

/// Tints come first: what a viewer shows is texture times tint, and that is the colour of the species.
#[test]
fn tints_bring_textures_to_their_colours() {
    let species = Species::named("silver_birch").unwrap();
    let model = Model::of(birch(), GlbSettings::default());
    let (_, leaf) = model.look("silver_birch leaves");
    let tints = model.colors("leaves", 0);
    let shown = mean(&leaf) * tints.iter().map(|tint| tint.xyz()).sum::<Vec3>() / tints.len() as f32;
    assert!((shown / linear(species.leaf_color) - 1.0).abs().max_element() < 0.06, "{shown}");
    let leaves: std::collections::HashSet<_> = tints.iter().map(|tint| (tint * 255.0).as_u8vec4()).collect();
    assert!(leaves.len() > 100, "no two leaves are alike");

    let (_, bark) = model.look("silver_birch bark");
    let thinnest = model.colors("wood", 0).iter().map(|tint| tint.xyz()).reduce(Vec3::min).unwrap();
    let twig = linear(species.bark_young_color) / linear(species.bark_color);
    let marks = mean(&bark) / linear(species.bark_color);
    assert!(
        (thinnest - twig).abs().max_element() < 0.05,
        "twigs are brown on a white birch: {thinnest} {twig}"
    );
    assert!(marks.min_element() > 0.6 && marks.max_element() <= 1.01, "{marks}");
}

#[test]
fn alpha_is_the_outline_of_the_leaf() {
    for name in ["oak", "silver_birch", "weeping_willow", "japanese_maple", "scots_pine"] {
        let species = Species::named(name).unwrap();
        let model = Model::of(&alone(name, 3), GlbSettings::default());
        let (material, image) = model.look(&format!("{name} leaves"));
        let sampler = material.pbr_metallic_roughness().base_color_texture().unwrap().texture().sampler();
        assert_eq!(
            (sampler.wrap_s(), sampler.wrap_t()),
            (WrappingMode::ClampToEdge, WrappingMode::ClampToEdge)
        );
        let (width, height) = image.dimensions();
        let stalk = 2.0 / width as f32;
        for (x, y, pixel) in image.enumerate_pixels() {
            let (u, v) = ((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
            let side = (u - 0.5).abs();
            let inside = 2.0 * side <= species.leaf_outline.half_width(v) || side <= stalk;
            assert_eq!(pixel[3], if inside { 255 } else { 0 }, "{name} {u} {v}");
        }
        let share = image.pixels().filter(|p| p[3] > 127).count() as f32 / (width * height) as f32;
        let fill = species.leaf_outline.fill();
        assert!((-0.01..0.1).contains(&(share - fill)), "{name} {share} {fill}");
    }
    assert_ne!(LeafOutline::Lobed.fill(), LeafOutline::Palmate.fill());
}

#[test]
fn crowns_are_round_and_wood_is_not() {
    let tree = birch();
    let model = Model::of(tree, GlbSettings::default());
    model.check();
    let crown = Crown::of(tree)[0];
    let outward = |part: &str| -> f32 {
        let normals = model.normals(part);
        let at = model.positions(part);
        let dots = at.iter().zip(&normals).map(|(at, normal)| normal.dot(crown.outward(*at)));
        dots.sum::<f32>() / normals.len() as f32
    };
    assert!(outward("leaves") > 0.6, "{}", outward("leaves"));
    // A tube has a normal for every side.
    let mean = model.normals("wood").iter().copied().sum::<Vec3>() / model.normals("wood").len() as f32;
    assert!(mean.length() < 0.3 && outward("wood") < 0.4, "{mean} {}", outward("wood"));
}

#[test]
fn wind_colours_rise_from_the_ground_to_the_tips() {
    let tree = birch();
    let plain = Model::of(tree, GlbSettings::default());
    let first = Model::of(tree, GlbSettings { wind_first: true, ..default() });
    for part in ["wood", "leaves"] {
        assert_eq!(plain.colors(part, 1), first.colors(part, 0));
        for color in plain.colors(part, 0).iter().chain(&plain.colors(part, 1)) {
            assert!(color.min_element() >= 0.0 && color.max_element() <= 1.0 && color.w == 1.0);
        }
    }
    let (at, wind) = (plain.positions("wood"), plain.colors("wood", 1));
    for (at, wind) in at.iter().zip(&wind) {
        // The way along the wood is never shorter than the height.
        assert!(at.y < 0.01 || wind.y > 0.0);
        assert_eq!(wind.z, 0.0, "wood does not flutter");
    }
    let ground: Vec<_> = at.iter().zip(&wind).filter(|(at, _)| at.y < 1e-3).collect();
    assert!(!ground.is_empty() && ground.iter().all(|(_, wind)| wind.y == 0.0), "the trunk stands");
    assert!(wind.iter().any(|wind| wind.y == 1.0), "a tip sways most");
    let phases: std::collections::HashSet<_> = wind.iter().map(|wind| (wind.x * 255.0) as u8).collect();
    assert!(phases.len() > 20, "branches have phases of their own");

    let leaves = plain.colors("leaves", 1);
    assert!(leaves.iter().any(|wind| wind.z == 0.0) && leaves.iter().any(|wind| wind.z == 1.0));
    // All of a leaf sways as one.
    let mut by_place: HashMap<_, Vec<f32>> = HashMap::new();
    for (place, wind) in burgeon::shape::leaves::leaves(tree)[0].places.iter().zip(&leaves) {
        by_place.entry(place.organ).or_default().push(wind.y);
    }
    assert!(by_place.values().all(|sways| sways.iter().all(|sway| *sway == sways[0] && *sway > 0.0)));
}

/// Least and greatest corner of all that is drawn.
fn bounds(shapes: &[Shape]) -> (Vec3, Vec3) {
    shapes.iter().filter_map(Shape::bounds).reduce(|(a, b), (c, d)| (a.min(c), b.max(d))).unwrap()
}

/// Height and the two widths.
fn extents(shapes: &[Shape]) -> Vec3 {
    let (low, high) = bounds(shapes);
    high - low
}

/// The same tree after its leaves fell.
fn bare(tree: &Snapshot) -> Snapshot {
    let mut tree = tree.clone();
    for state in &mut tree.state {
        if let OrganState::Leaf(leaf) = state {
            leaf.size = 0.0;
        }
    }
    tree
}

fn area(surface: &Surface) -> f32 {
    let corner = |i: u32| Vec3::from(surface.positions[i as usize]);
    let twice = |t: &[u32]| (corner(t[1]) - corner(t[0])).cross(corner(t[2]) - corner(t[0])).length();
    surface.indices.chunks(3).map(|t| 0.5 * twice(t)).sum()
}

#[test]
fn levels_of_detail_keep_to_their_triangles_and_to_the_silhouette() {
    for (name, steps) in [("silver_birch", 9), ("oak", 8), ("scots_pine", 9), ("palm", 12)] {
        let in_leaf = alone(name, steps);
        for (tree, leafy) in [(bare(&in_leaf), false), (in_leaf, true)] {
            let full = Shape::full(&tree);
            let all: usize = full.iter().map(Shape::triangles).sum();
            for level in Level::three(all / 3) {
                let shapes = levels::within(&tree, level.triangles);
                let triangles: usize = shapes.iter().map(Shape::triangles).sum();
                assert!(triangles <= level.triangles, "{name} {triangles} {level:?}");
                assert!(!leafy || triangles * 5 >= level.triangles, "{name} wastes: {triangles} {level:?}");
                // A bare tree of less has no triangles left for every limb that holds its width.
                let off = (extents(&shapes) / extents(&full) - 1.0).abs();
                assert!(triangles < 300 && !leafy || off.max_element() < 0.05, "{name} {level:?} {off}");
                for surface in shapes.iter().flat_map(|shape| [&shape.wood, &shape.leaves]) {
                    assert!(surface.normals.iter().all(|n| (Vec3::from(*n).length() - 1.0).abs() < 1e-4));
                }
            }
            assert_eq!(levels::within(&tree, all), full, "all detail where it fits");
        }
    }
}

#[test]
fn merged_leaves_keep_their_area() {
    let tree = birch();
    let species = &tree.plants[0].as_ref().unwrap().species;
    let leaves: f32 =
        tree.state.iter().map(|s| if let OrganState::Leaf(leaf) = s { leaf.size } else { 0.0 }).sum();
    let wanted = leaves * species.leaf_area();
    let all: usize = Shape::full(tree).iter().map(Shape::triangles).sum();
    for part in [2, 8, 40] {
        let shape = &levels::within(tree, all / part)[0];
        let covered =
            if shape.sprays { texture::spray(species, false).covered() } else { species.leaf_outline.fill() };
        let shown = area(&shape.leaves) * covered;
        assert!((shown / wanted - 1.0).abs() < 0.02, "1/{part}: {shown} of {wanted}");
        assert_eq!(shape.sprays, part == 40);
    }
}

#[test]
fn a_level_of_nearly_nothing_is_still_within_its_triangles() {
    for triangles in [0, 1, 9, 62, 250] {
        let shapes = levels::within(birch(), triangles);
        assert!(shapes.iter().map(Shape::triangles).sum::<usize>() <= triangles);
    }
}

#[test]
fn a_level_is_named_and_has_the_material_of_its_cards() {
    let level = Level::three(3200)[2];
    let settings = GlbSettings { level: Some(level), ..default() };
    let model = Model::of(birch(), settings);
    model.check();
    let triangles: usize = model
        .document
        .accessors()
        .filter(|a| a.dimensions() == gltf::accessor::Dimensions::Scalar)
        .map(|a| a.count() / 3)
        .sum();
    assert!(triangles <= 200 && triangles > 100, "{triangles}");
    assert!(model.document.nodes().any(|node| node.name() == Some("silver_birch 0_LOD2")));
    let (sprays, image) = model.look("silver_birch sprays");
    assert_eq!(sprays.alpha_mode(), AlphaMode::Mask);
    let color = linear(Species::named("silver_birch").unwrap().leaf_color);
    let tinted = color * burgeon::shape::blade::BRIGHTEST;
    assert!((mean(&image) / tinted - 1.0).abs().max_element() < 0.06, "{} {tinted}", mean(&image));
    let mut again = Vec::new();
    write_glb(birch(), settings, &mut again).unwrap();
    assert_eq!(Model::read(&again).blob, model.blob, "the same input, the same model");
}
