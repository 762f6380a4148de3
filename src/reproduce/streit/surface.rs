//! Figures 3 and 4: roots whose surface grows (`ST-1` to `ST-4`).

use bevy::math::{Quat, Vec2, Vec3};
use image::RgbImage;

use super::csv;
use crate::environment::trace::Tracer;
use crate::environment::workers::Workers;
use crate::environment::{Capsule, Scene, SunLight};
use crate::export::canvas;
use crate::export::picture::{Camera, Palette, PictureSettings, render};
use crate::export::plot::{Plot, Shape};
use crate::reproduce::{Claim, Findings, ReproduceError};
use crate::tropism::relel::{BentRoot, Relel, bend};
use crate::tropism::root::{AuxinRoot, RootSettings};

/// Level, setting out along +x.
fn level() -> Quat {
    Quat::from_rotation_z(-core::f32::consts::FRAC_PI_2)
}

/// Figure 3: (a) the tip angle of a bending root, (b) a kinked one.
pub fn barlow() -> Result<Findings, ReproduceError> {
    let flank = |most, centre, spread| Relel { most, centre, spread };
    let root = |time| bend(flank(2.0, 3.0, 1.0), flank(1.0, 3.0, 1.0), time, 9.0, 1.0, 900);
    let figure = [(0.126, 18.1), (0.380, 54.5), (0.633, 90.8)];
    let angles = figure.map(|(time, _)| root(time).tip_angle.to_degrees());
    let kinked = bend(flank(3.0, 3.0, 0.7), flank(1.0, 5.0, 1.0), 0.5, 9.0, 1.0, 900);
    let bend_near = |distance: f32| kinked.bends[((9.0 - distance) * 100.0) as usize].to_degrees() * 100.0;
    let claims = vec![
        Claim {
            row: "ST-2",
            paper: "(a) t = 0.126, 0.380, 0.633 give tip angles of 18.1, 54.5, 90.8 degrees",
            measured: format!("{:.2}, {:.2}, {:.2} degrees", angles[0], angles[1], angles[2]),
            holds: figure.iter().zip(angles).all(|((_, paper), angle)| (angle - paper).abs() < 0.05),
        },
        Claim {
            row: "ST-3",
            paper: "(b) other zones on either flank: a kinked root",
            measured: format!(
                "degrees a unit of length: {:+.1} at the upper flank's zone, {:+.1} beyond the lower's",
                bend_near(3.0),
                bend_near(5.5)
            ),
            holds: bend_near(3.0) > 1.0 && bend_near(5.5) < -1.0,
        },
    ];
    let mut bent = Plot::of_shapes("(a) (Mu, Ml) = (2, 1), mu = 3, sigma = 1", "x, diameters", "y");
    for (time, _) in figure {
        outline(&mut bent, &format!("t = {time}"), &root(time));
    }
    let mut kink =
        Plot::of_shapes("(b) M = (3, 1), mu = (3, 5), sigma = (0.7, 1.0), t = 0.5", "x, diameters", "y");
    outline(&mut kink, "", &kinked);
    let times = (0..=70).map(|k| {
        let time = k as f32 / 100.0;
        [time, root(time).tip_angle.to_degrees()]
    });
    let table = csv(["t", "tip_angle_deg"], times);
    Ok(Findings {
        claims,
        picture: canvas::side_by_side(&[bent.draw(520, 460)?, kink.draw(520, 460)?], 4),
        tables: vec![("tip_angle.csv".into(), table)],
        pictures: Vec::new(),
    })
}

fn outline(plot: &mut Plot, name: &str, root: &BentRoot) {
    plot.line(name, root.upper.iter().chain(root.lower.iter().rev()).copied());
}

/// Figure 4: a root in a plane, how its shape depends on its settings, and a solid one.
pub fn auxin(size: PictureSettings, workers: &Workers) -> Result<Findings, ReproduceError> {
    let plain = RootSettings::default();
    let variants = [
        ("as it is", plain),
        ("zone further back", RootSettings { zone: 3.5, ..plain }),
        ("wider zone", RootSettings { zone_width: 1.8, ..plain }),
        ("slow transport", RootSettings { transport: 0.8, ..plain }),
        ("weak inhibition", RootSettings { inhibition: 0.8, ..plain }),
        ("strong inhibition", RootSettings { inhibition: 12.0, ..plain }),
    ];
    let mut rows = Vec::new();
    let mut shapes = Vec::new();
    let mut angle = Plot::new("Tip to gravity as roots grow", "hours", "degrees");
    let mut ends = Vec::new();
    for (name, settings) in variants {
        let mut root = AuxinRoot::new(settings, level())?;
        let mut course = vec![(0.0, side_angle(&root))];
        for k in 1..=160 {
            root.grow(0.25);
            course.push((k as f32 * 0.25, side_angle(&root)));
        }
        let least = course.iter().map(|(_, a)| *a).fold(f32::INFINITY, f32::min);
        ends.push((name, course[course.len() - 1].1, least, root.clone()));
        rows.extend(course.iter().map(|(hour, a)| [name.to_string(), hour.to_string(), a.to_string()]));
        angle.line(name, course.iter().map(|(hour, a)| Vec2::new(*hour, *a)));
        shapes.push(flanks(name, &root).draw(330, 300)?);
    }
    let mut hanging = AuxinRoot::new(plain, Quat::from_rotation_z(core::f32::consts::PI))?;
    hanging.grow(20.0);
    let uneven = hanging.segments.iter().map(|s| (s.auxin[0] - s.auxin[1]).abs()).fold(0.0, f32::max);
    let solid = |taper| RootSettings { columns: 16, taper, radius: 0.7, ..plain };
    let solids = [level(), Quat::from_rotation_y(0.7) * Quat::from_rotation_z(-2.3)].map(|base| {
        let mut root = AuxinRoot::new(solid(0.35), base)?;
        let young = root.clone();
        root.grow(8.0);
        let older = root.clone();
        root.grow(32.0);
        Ok::<_, ReproduceError>([young, older, root])
    });
    let [first, second] = solids;
    let (first, second) = (first?, second?);
    let of = |name: &str| ends.iter().find(|e| e.0 == name).map_or((0.0, 0.0), |e| (e.1, e.2));
    let bend = |name: &str| ends.iter().find(|e| e.0 == name).map_or([0.0; 2], |e| bend_of(&e.3));
    let [place, stretch] = bend("as it is");
    let [back, wide, weak, strong] = [
        bend("zone further back")[0],
        bend("wider zone")[1],
        bend("weak inhibition")[1],
        bend("strong inhibition")[1],
    ];
    let claims = vec![
        Claim {
            row: "ST-4",
            paper: "a level root bends until its tip is aligned with gravity",
            measured: format!("tip after 40 hours {:.1} degrees off gravity", of("as it is").0),
            holds: of("as it is").0.abs() < 3.0,
        },
        Claim {
            row: "ST-4",
            paper: "an aligned root has even auxin and grows straight",
            measured: format!(
                "auxin of its flanks differs by {uneven:.1e} of the tip's; {:.4} degrees off after 20 hours, {:.1} mm grown",
                hanging.tip_angle().to_degrees(),
                hanging.length() - plain.length
            ),
            holds: uneven < 1e-3 && hanging.tip_angle() < 1e-3,
        },
        Claim {
            row: "ST-4",
            paper: "(d) place and size of the growth zone change the shape",
            measured: format!(
                "bends {place:.1} mm from its base over {stretch:.1} mm; zone further back: {back:.1} mm from it; wider \
                 zone: over {wide:.1} mm"
            ),
            holds: back < place - 1.0 && wide > stretch + 1.0,
        },
        Claim {
            row: "ST-4",
            paper: "(d) so does the rate of transport: a later signal overshoots further",
            measured: format!(
                "past gravity by {:.1} degrees, slow transport {:.1}",
                -of("as it is").1,
                -of("slow transport").1
            ),
            holds: of("slow transport").1 < of("as it is").1 - 20.0,
        },
        Claim {
            row: "ST-4",
            paper: "(d) so does the inhibition: the weaker, the wider the bend",
            measured: format!("bends over {weak:.1} mm where it is weak, {strong:.1} mm where it is strong"),
            holds: weak > stretch + 1.0 && strong < stretch,
        },
        Claim {
            row: "ST-4",
            paper: "in three dimensions, too",
            measured: format!(
                "two conical roots end {:.1} and {:.1} degrees off gravity",
                first[2].tip_angle().to_degrees(),
                second[2].tip_angle().to_degrees()
            ),
            holds: first[2].tip_angle().to_degrees() < 5.0 && second[2].tip_angle().to_degrees() < 8.0,
        },
    ];
    let picture = canvas::grid(&shapes, 3, 4);
    let solids: Vec<RgbImage> =
        first.iter().chain(&second).map(|root| photograph(root, size, workers)).collect();
    Ok(Findings {
        claims,
        picture,
        tables: vec![("tip_angle.csv".into(), csv(["root", "hours", "tip_to_gravity_deg"], rows))],
        pictures: vec![
            ("tip_angle.png".into(), angle.draw(900, 420)?),
            ("solid.png".into(), canvas::grid(&solids, 3, 4)),
        ],
    })
}

/// Where along a root it bends, millimetres: the middle of its turning from the base, and the length on which the
/// middle four fifths of it lie.
fn bend_of(root: &AuxinRoot) -> [f32; 2] {
    let poses = root.assemble();
    let turns: Vec<f32> = poses.windows(2).map(|p| p[0].heading().angle_between(p[1].heading())).collect();
    let whole: f32 = turns.iter().sum();
    let place = |share: f32| {
        let (mut turned, mut along) = (0.0, 0.0);
        for (turn, segment) in turns.iter().zip(&root.segments) {
            (turned, along) = (turned + turn, along + segment.length());
            if turned >= share * whole {
                break;
            }
        }
        along
    };
    [place(0.5), place(0.9) - place(0.1)]
}

/// Angle of the tip to gravity in its plane, degrees; below 0 beyond it.
fn side_angle(root: &AuxinRoot) -> f32 {
    let heading = root.tip_heading();
    bevy::math::ops::atan2(heading.x, -heading.y).to_degrees()
}

/// The flanks of a root in a plane, shaded by their auxin.
fn flanks(name: &str, root: &AuxinRoot) -> Plot {
    let mut plot = Plot::of_shapes(name, "mm", "mm");
    let poses = root.assemble();
    let flat = |p: Vec3| Vec2::new(p.x, p.y);
    for (k, segment) in root.segments.iter().enumerate() {
        let edge = |pose: &crate::plant::Pose, side: f32| {
            flat(pose.position + pose.rotation * Vec3::X * (side * segment.radius))
        };
        for (side, auxin) in [1.0, -1.0].into_iter().zip(&segment.auxin) {
            let shade = (1.0 - 0.55 * auxin).clamp(0.0, 1.0);
            let color = [230.0 * shade + 20.0, 200.0 * shade, 120.0 * shade + 40.0].map(|c| c as u8);
            let (low, high) = (&poses[k], &poses[k + 1]);
            let corners = vec![flat(low.position), edge(low, side), edge(high, side), flat(high.position)];
            plot.shapes.push(Shape { corners, color });
        }
    }
    plot
}

/// A solid root as wood in the air, a hundred times its size.
fn photograph(root: &AuxinRoot, size: PictureSettings, workers: &Workers) -> RgbImage {
    let scale = 0.1;
    let poses = root.assemble();
    let sun = Some(SunLight { direction: Vec3::new(0.4, 0.7, 0.6).normalize(), strength: 0.6 });
    let mut scene = Scene { sun, ..Scene::default() };
    for (k, segment) in root.segments.iter().enumerate() {
        let [from, to] = [poses[k].position, poses[k + 1].position].map(|p| p * scale);
        let radius = segment.radius * scale;
        scene.capsules.push(Capsule { from, to, radius, organ: k as u32, plant: 0 });
    }
    // A slanting root fills the corners that a crown leaves free: frame the ball about it.
    let [low, high] = poses.iter().fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], pose| {
        [low.min(pose.position * scale), high.max(pose.position * scale)]
    });
    let (middle, reach) =
        ((low + high) * 0.5, 0.5 * low.distance(high) + 2.0 * root.segments[0].radius * scale);
    let camera = Camera::looking(middle + Vec3::new(0.25, 0.14, 0.96) * (reach * 5.0), middle);
    let mut image = render(&Tracer::build(&scene), &camera, &Palette::default(), size, workers);
    canvas::caption(&mut image, &format!("{:.1} mm", root.length()), 1);
    image
}
