//! Skeletons as files: stems as lines of points, leaves at points of them.
//!
//! ```ron
//! (
//!     version: 1,
//!     species: "lily",
//!     stems: [
//!         (points: [(0, 0, 0), (0, 0.4, 0), (0, 0.9, 0)], radii: (0.008, 0.004)),
//!         (on: (0, 2), points: [(0, 0.9, 0), (0.2, 1, 0)], radii: (0.002, 0.001)),
//!     ],
//!     leaves: [(on: (0, 1), heading: (1, 0.3, 0))],
//! )
//! ```

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::ron_text::{differing, file_of, invalid, list_of, parse, short};
use super::source::Source;
use super::{FARTHEST_M, FileError, VERSION, species, top_fields};
use crate::limits;
use crate::plant::NO_PARENT;
use crate::plant::skeleton::Skeleton;
use crate::species::parameter::Range;

/// What a skeleton file holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SkeletonFile {
    /// Version of the file format.
    pub version: u32,
    /// Its name.
    pub name: String,
    /// Species whose leaves and colours it has.
    pub species: String,
    /// Its stems, each after the one it grows from.
    pub stems: Vec<Stem>,
    /// Its leaves.
    pub leaves: Vec<StemLeafAt>,
}

impl Default for SkeletonFile {
    fn default() -> Self {
        let (name, species) = ("skeleton".into(), "lam_king".into());
        Self { version: VERSION, name, species, stems: Vec::new(), leaves: Vec::new() }
    }
}

/// A stem of a skeleton file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Stem {
    /// The stem it grows from and which point of it, both from 0; none: from the ground.
    pub on: Option<(u32, u32)>,
    /// Where it leads, metres; its first point lies where it begins.
    pub points: Vec<Vec3>,
    /// Radius at its base and its tip, metres.
    pub radii: (f32, f32),
    /// Which of its points are nodes, from 0, ascending; none named: all after the first. At the others one piece of a
    /// segment follows another.
    pub nodes: Vec<u32>,
}

impl Default for Stem {
    fn default() -> Self {
        Self { on: None, points: Vec::new(), radii: (0.01, 0.005), nodes: Vec::new() }
    }
}

/// A leaf of a skeleton file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StemLeafAt {
    /// The stem it grows from and which point of it, both from 0.
    pub on: (u32, u32),
    /// Where it points; any length.
    pub heading: Vec3,
    /// Area as a share of the species' largest.
    pub size: f32,
}

impl Default for StemLeafAt {
    fn default() -> Self {
        Self { on: (0, 1), heading: Vec3::X, size: 1.0 }
    }
}

/// Whether a text is a skeleton file's, by the fields it has.
pub fn is_skeleton(text: &str) -> bool {
    top_fields(text).iter().any(|field| field == "stems")
}

const METRES: Range = Range::Real { min: -FARTHEST_M, max: FARTHEST_M };

impl SkeletonFile {
    /// Reads a skeleton from the text of a file; `file` is its name, for errors.
    ///
    /// # Errors
    /// [`FileError`] with line, column, field, value and range, as far as each is known.
    pub fn from_ron(text: &str, file: &str) -> Result<(Self, Skeleton), FileError> {
        let read: Self = parse(text, file, &|path| allowed(path))?;
        let source = Source::new(text, file);
        let skeleton = read.skeleton().map_err(|(path, value, allowed)| {
            let path: Vec<String> = super::source::split_path(&path);
            invalid(&source, &path, value, allowed)
        })?;
        Ok((read, skeleton))
    }

    /// The file of a skeleton whose plant has the leaves and colours of a species. A stem's radii are those of its two
    /// ends.
    pub fn of(skeleton: &Skeleton, name: &str, species: &str) -> Self {
        let mut file = Self { name: name.into(), species: species.into(), ..Self::default() };
        // Stem and point at which each segment ends.
        let mut ends: Vec<(u32, u32)> = Vec::with_capacity(skeleton.segments.len());
        for segment in &skeleton.segments {
            let below = (segment.parent != NO_PARENT).then_some(segment.parent as usize);
            let goes_on = below.filter(|&below| {
                let (stem, point) = ends[below];
                let is_end = file.stems[stem as usize].points.len() == point as usize + 1;
                is_end && skeleton.segments[below].order == segment.order
            });
            match goes_on {
                Some(below) => {
                    let (stem, point) = ends[below];
                    file.stems[stem as usize].points.push(segment.tip());
                    file.stems[stem as usize].radii.1 = segment.radius;
                    ends.push((stem, point + 1));
                }
                None => {
                    ends.push((file.stems.len() as u32, 1));
                    file.stems.push(Stem {
                        on: below.map(|below| ends[below]),
                        points: vec![segment.pose.position, segment.tip()],
                        radii: (segment.radius, segment.radius),
                        nodes: Vec::new(),
                    });
                }
            }
            if segment.node {
                let (stem, point) = ends[ends.len() - 1];
                file.stems[stem as usize].nodes.push(point);
            }
        }
        for stem in file.stems.iter_mut().filter(|stem| stem.nodes.len() + 1 == stem.points.len()) {
            stem.nodes.clear();
        }
        let leaves = skeleton.leaves.iter();
        file.leaves = leaves
            .map(|leaf| StemLeafAt {
                on: ends[leaf.on as usize],
                heading: leaf.pose.heading(),
                size: leaf.size,
            })
            .collect();
        file
    }

    /// As RON that lists only what differs from the defaults; reads back as exactly this.
    pub fn to_ron(&self) -> String {
        let mut fields = differing(self, &Self::default(), &["version", "name", "species", "stems"]);
        for (name, value) in &mut fields {
            match name.as_str() {
                "stems" => {
                    let from = Stem::default();
                    *value = list_of(self.stems.iter().map(|stem| short(stem, &from, &["points"])));
                }
                "leaves" => {
                    let from = StemLeafAt::default();
                    *value = list_of(self.leaves.iter().map(|leaf| short(leaf, &from, &["on", "heading"])));
                }
                _ => {}
            }
        }
        file_of(&fields)
    }

    /// The skeleton, or the path of the first field that is wrong, its value and what is allowed.
    fn skeleton(&self) -> Result<Skeleton, (String, String, String)> {
        let wrong = |path: String, value: String, allowed: &str| Err((path, value, allowed.to_string()));
        if !species::is_name(&self.name) {
            return wrong("name".into(), self.name.clone(), species::NAME);
        }
        let all: usize = self.stems.iter().map(|stem| stem.points.len()).sum();
        if self.stems.is_empty() || all > limits::ORGANS {
            return wrong("stems".into(), format!("{} stems", self.stems.len()), "at least one stem");
        }
        let mut skeleton = Skeleton::default();
        let mut made: Vec<Vec<u32>> = Vec::new();
        for (i, stem) in self.stems.iter().enumerate() {
            let at = |field: &str| format!("stems[{i}].{field}");
            let on = match stem.on {
                None => None,
                Some((below, point)) => match segment_at(&made, below, point) {
                    Some(segment) => Some(segment),
                    None => return wrong(at("on"), format!("{:?}", (below, point)), ON),
                },
            };
            if let Some(point) =
                stem.points.iter().find(|p| !p.to_array().iter().all(|x| METRES.holds((*x).into())))
            {
                return wrong(at("points"), point.to_string(), "numbers from -10000 to 10000");
            }
            if stem.points.windows(2).any(|ends| ends[0].distance(ends[1]) <= 0.0) || stem.points.len() < 2 {
                let value = format!("{} points", stem.points.len());
                return wrong(at("points"), value, "two or more points, no two in a row the same");
            }
            let radii = [stem.radii.0, stem.radii.1];
            if radii.iter().any(|r| !(*r > 0.0 && *r <= 10.0)) {
                return wrong(at("radii"), format!("{radii:?}"), "above 0 to 10 m");
            }
            // Its wood begins in that of the other.
            if let Some((below, point)) = stem.on {
                let below = &self.stems[below as usize];
                let (from, reach) =
                    (below.points[point as usize], below.radii.0.max(below.radii.1).max(0.01));
                if stem.points[0].distance(from) > reach {
                    let allowed = format!("a first point within {reach} m of {from}, from which it grows");
                    return wrong(at("points"), stem.points[0].to_string(), &allowed);
                }
            }
            let last = stem.points.len() as u32 - 1;
            let ascend = stem.nodes.windows(2).all(|two| two[0] < two[1]);
            if !ascend || stem.nodes.iter().any(|node| !(1..=last).contains(node)) {
                let allowed = format!("numbers of points from 1 to {last}, ascending");
                return wrong(at("nodes"), format!("{:?}", stem.nodes), &allowed);
            }
            let segments = skeleton.add_stem(on, &stem.points, radii);
            for (point, segment) in (1..).zip(&segments) {
                skeleton.segments[*segment as usize].node =
                    stem.nodes.is_empty() || stem.nodes.binary_search(&point).is_ok();
            }
            made.push(segments);
        }
        for (i, leaf) in self.leaves.iter().enumerate() {
            let at = |field: &str| format!("leaves[{i}].{field}");
            let Some(segment) = segment_at(&made, leaf.on.0, leaf.on.1) else {
                return wrong(at("on"), format!("{:?}", leaf.on), ON);
            };
            let Some(heading) = leaf.heading.try_normalize() else {
                return wrong(at("heading"), leaf.heading.to_string(), "a direction, not zero");
            };
            if !(0.0..=1.0).contains(&leaf.size) {
                return wrong(at("size"), leaf.size.to_string(), "0 to 1");
            }
            skeleton.add_leaf(segment, heading, leaf.size);
        }
        Ok(skeleton)
    }
}

const ON: &str = "an earlier stem and one of its points after the first";

/// The segment that ends at a point of a stem.
fn segment_at(made: &[Vec<u32>], stem: u32, point: u32) -> Option<u32> {
    made.get(stem as usize)?.get(point.checked_sub(1)? as usize).copied()
}

fn allowed(path: &[String]) -> Option<String> {
    let field = path.last()?;
    Some(match field.as_str() {
        "version" => VERSION.to_string(),
        "name" | "species" => species::NAME.into(),
        "size" => "0 to 1".into(),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::skeleton::StemSegment;
    use crate::tropism::vary::{Variation, vary};

    const LILY: &str = "(stems: [(points: [(0, 0, 0), (0, 0.5, 0), (0, 1, 0)]),
        (on: (0, 1), points: [(0, 0.5, 0), (0.3, 0.6, 0)], radii: (0.002, 0.001))],
        leaves: [(on: (1, 1), heading: (1, 0, 0))])";

    #[test]
    fn a_skeleton_file_is_read() {
        assert!(is_skeleton(LILY) && !is_skeleton("(name: \"oak\")"));
        let (_, skeleton) = SkeletonFile::from_ron(LILY, "lily.ron").unwrap();
        assert_eq!((skeleton.nodes(), skeleton.leaves.len()), (3, 1));
        assert_eq!(skeleton.segments.iter().map(|s| s.order).collect::<Vec<_>>(), [0, 0, 1]);
        assert_eq!(skeleton.segments[2].parent, 0);
        assert!(skeleton.check().is_ok() && (skeleton.height() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_skeleton_is_written_and_read_back() {
        let (file, skeleton) = SkeletonFile::from_ron(LILY, "lily.ron").unwrap();
        let written = SkeletonFile::of(&skeleton, &file.name, &file.species);
        let (again, read) = SkeletonFile::from_ron(&written.to_ron(), "again.ron").unwrap();
        assert_eq!(again, written);
        assert_eq!((&again.stems[1].on, again.stems.len()), (&Some((0, 1)), 2));
        let near = |(a, b): (&StemSegment, &StemSegment)| {
            let turned = a.pose.heading().distance(b.pose.heading()) < 1e-6;
            turned && a.tip().distance(b.tip()) < 1e-6 && (a.parent, a.radius) == (b.parent, b.radius)
        };
        assert!(read.segments.iter().zip(&skeleton.segments).all(near) && read.nodes() == skeleton.nodes());
        assert!(read.leaves[0].pose.heading().distance(Vec3::X) < 1e-6);
    }

    #[test]
    fn a_sibling_is_read_back_with_the_nodes_it_has() {
        let (_, lily) = SkeletonFile::from_ron(LILY, "lily.ron").unwrap();
        let sibling = vary(&lily, &Variation::default(), 1).unwrap();
        let text = SkeletonFile::of(&sibling, "sibling", "lily").to_ron();
        let (_, read) = SkeletonFile::from_ron(&text, "sibling.ron").unwrap();
        assert_eq!((read.nodes(), read.segments.len()), (3, sibling.segments.len()));
        let nodes = |skeleton: &Skeleton| skeleton.segments.iter().map(|s| s.node).collect::<Vec<_>>();
        assert_eq!(nodes(&read), nodes(&sibling));
        assert!((read.total_length() / lily.total_length() - 1.0).abs() < 1e-5);
    }

    #[test]
    fn what_is_wrong_with_one_is_told() {
        for (bad, told) in [
            ("(stems: [])", "stems"),
            ("(stems: [(points: [(0, 0, 0)])])", "stems[0].points"),
            ("(stems: [(points: [(0, 0, 0), (0, 0, 0)])])", "stems[0].points"),
            ("(stems: [(points: [(0, 0, 0), (0, inf, 0)])])", "stems[0].points"),
            ("(stems: [(on: (0, 1), points: [(0, 0, 0), (0, 1, 0)])])", "stems[0].on"),
            ("(stems: [(points: [(0, 0, 0), (0, 1, 0)], radii: (0, 0))])", "stems[0].radii"),
            ("(stems: [(points: [(0, 0, 0), (0, 1, 0)], nodes: [0])])", "stems[0].nodes"),
            ("(stems: [(points: [(0, 0, 0), (0, 1, 0), (0, 2, 0)], nodes: [2, 1])])", "stems[0].nodes"),
            (
                "(stems: [(points: [(0, 0, 0), (0, 1, 0)]), (on: (0, 1), points: [(1, 1, 0), (2, 1, 0)])])",
                "stems[1].points",
            ),
            ("(stems: [(points: [(0, 0, 0), (0, 1, 0)])], leaves: [(on: (0, 2))])", "leaves[0].on"),
            (
                "(stems: [(points: [(0, 0, 0), (0, 1, 0)])], leaves: [(heading: (0, 0, 0))])",
                "leaves[0].heading",
            ),
        ] {
            let error = SkeletonFile::from_ron(bad, "bad.ron").unwrap_err().to_string();
            assert!(error.contains(told), "{bad}: {error}");
        }
    }
}
