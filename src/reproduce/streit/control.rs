//! Figures 7 to 10: what the controller makes of disturbances (`ST-6` to `ST-9`).

use bevy::math::{Quat, Vec2, Vec3, ops};

use super::csv;
use crate::export::canvas;
use crate::export::plot::Plot;
use crate::reproduce::{Claim, Findings, ReproduceError};
use crate::tropism::stability::{Verdict, critical_gain, stability};
use crate::tropism::{Control, Influence, Signals, Steering, lean, step, turned_to};

/// A stalk grown sub-step by sub-step from the origin.
struct Stalk {
    /// Its points, one more than sub-steps.
    points: Vec<Vec3>,
    /// Heading of each sub-step.
    headings: Vec<Vec3>,
}

/// Grows a stalk; target and influence are asked before each sub-step.
fn stalk(
    control: Control,
    frame: Quat,
    sub_steps: usize,
    length: f32,
    target: impl Fn(usize) -> Vec3,
    influence: impl Fn(usize) -> Influence,
) -> Stalk {
    let (mut steering, mut signals, mut frame) = (Steering::default(), Signals::default(), frame);
    let mut stalk = Stalk { points: vec![Vec3::ZERO], headings: Vec::new() };
    let mut tip = Vec3::ZERO;
    for k in 0..sub_steps {
        let heading = step(&control, &mut steering, &mut signals, frame, target(k), influence(k));
        frame = turned_to(frame, heading);
        tip += heading * (length / sub_steps as f32);
        stalk.points.push(tip);
        stalk.headings.push(heading);
    }
    stalk
}

fn calm(_: usize) -> Influence {
    Influence::default()
}

/// A direction `angle` radians from up towards x.
fn towards_x(angle: f32) -> Vec3 {
    let (sin, cos) = ops::sin_cos(angle);
    Vec3::new(sin, cos, 0.0)
}

/// Angle from up towards x, degrees.
fn angle_x(heading: &Vec3) -> f32 {
    ops::atan2(heading.x, heading.y).to_degrees()
}

fn shifted(stalk: &Stalk, by: f32) -> impl Iterator<Item = Vec2> + '_ {
    stalk.points.iter().map(move |p| Vec2::new(p.x + by, p.y))
}

/// First sub-step after which the angle has changed its side, and how often it does.
fn crossings(angles: &[f32]) -> (usize, usize) {
    let turns: Vec<usize> = (1..angles.len()).filter(|&k| angles[k - 1] * angles[k] <= 0.0).collect();
    (turns.first().copied().unwrap_or(angles.len()), turns.len())
}

/// Figure 7: lifetime 2, gain 1.
pub fn signals() -> Result<Findings, ReproduceError> {
    let control = Control::new(1.0, 2)?;
    let mut plot = Plot::of_shapes("Pushed by 25 degrees; lifetime 2, gain 1", "sub-steps", "sub-steps");
    let mut rows = Vec::new();
    for (n, pushed) in [2_usize, 4, 6, 8, 10].into_iter().enumerate() {
        let push = |k| Influence {
            disturbance: if k == pushed { lean(25_f32.to_radians(), 0.0) } else { Vec2::ZERO },
            ..Influence::default()
        };
        let grown = stalk(control, Quat::IDENTITY, 14, 14.0, |_| Vec3::Y, push);
        let angles: Vec<f32> = grown.headings.iter().map(angle_x).collect();
        let sensed = pushed + 1;
        let response = (sensed..14).find(|&k| (angles[k] - angles[k - 1]).abs() > 0.1).unwrap_or(14);
        rows.push([pushed, sensed, response, response - sensed]);
        // The response to what is sensed later is the next figure's matter: the stalk is shown up to it.
        plot.line(format!("pushed at {pushed}"), shifted(&grown, 3.0 * n as f32).take(response + 3));
    }
    let distances: Vec<usize> = rows.iter().map(|row| row[3]).collect();
    let claims = vec![Claim {
        row: "ST-7",
        paper: "the response is always the same distance from the tip: the lifetime, 2 growth steps",
        measured: format!("from sensing to response {distances:?} growth steps, pushed at 2, 4, 6, 8, 10"),
        holds: distances.iter().all(|d| *d == 2),
    }];
    let table = csv(["pushed_at", "sensed_at", "response_at", "distance_steps"], rows);
    Ok(Findings {
        claims,
        picture: plot.draw(640, 560)?,
        tables: vec![("signals.csv".into(), table)],
        pictures: Vec::new(),
    })
}

/// Figure 8: a target function in one plane, a disturbance function in the other.
pub fn functions() -> Result<Findings, ReproduceError> {
    const N: usize = 240;
    let control = Control::of_ratio(0.9, 5)?;
    let wave = |k: usize, length: f32| ops::sin(core::f32::consts::TAU * k as f32 / length);
    let targets: [&dyn Fn(usize) -> f32; 2] =
        [&|k| 50.0 * wave(k, 240.0), &|k| 60.0 * (k as f32 / N as f32) * (k as f32 / N as f32)];
    let pushes: [&dyn Fn(usize) -> f32; 2] =
        [&|k| 1.0 * wave(k, 30.0), &|k| 1.2 * wave(k, 60.0) * (1.0 - k as f32 / N as f32)];
    let (mut images, mut rows, mut worst) = (Vec::new(), Vec::new(), [0.0_f32; 2]);
    for (n, (target, push)) in targets.into_iter().zip(pushes).enumerate() {
        let aimed = |k| towards_x(target(k).to_radians());
        let pushed =
            |k| Influence { disturbance: Vec2::new(0.0, push(k).to_radians()), ..Influence::default() };
        let alone = stalk(control, Quat::IDENTITY, N, 10.0, aimed, calm);
        let both = stalk(control, Quat::IDENTITY, N, 10.0, aimed, pushed);
        let mut given = Plot::new(&format!("({}) functions", n + 1), "sub-step", "degrees");
        given.line("target, plane x-y", (0..N).map(|k| Vec2::new(k as f32, target(k))));
        given.line("disturbance, plane z-y", (0..N).map(|k| Vec2::new(k as f32, push(k))));
        let mut seen =
            Plot::of_shapes("left: target alone; right: with disturbance, from both sides", "x or z", "y");
        seen.line("target alone, x", alone.points.iter().map(|p| Vec2::new(p.x, p.y)));
        seen.line("both, x", both.points.iter().map(|p| Vec2::new(p.x + 4.0, p.y)));
        seen.line("both, z", both.points.iter().map(|p| Vec2::new(p.z + 9.0, p.y)));
        images.push(given.draw(460, 420)?);
        images.push(seen.draw(560, 420)?);
        for k in 0..N {
            worst[0] = worst[0].max((both.headings[k].x - alone.headings[k].x).abs());
            worst[1] = worst[1].max(both.headings[k].z.abs());
            let [h, g] = [both.headings[k], alone.headings[k]].map(|h| h.to_array());
            rows.push([(n + 1) as f32, k as f32, target(k), push(k), g[0], h[0], h[1], h[2]]);
        }
    }
    let claims = vec![Claim {
        row: "ST-8",
        paper: "the target defines the overall shape in one plane, the disturbance local variation in the other",
        measured: format!(
            "heading in the target's plane moved by at most {:.3} by the disturbance, which alone moves the other by {:.3}",
            worst[0], worst[1]
        ),
        holds: worst[0] < 0.05 && worst[1] > 0.1,
    }];
    let header = ["case", "sub_step", "target_deg", "disturbance_deg", "x_target_alone", "x", "y", "z"];
    Ok(Findings {
        claims,
        picture: canvas::grid(&images, 2, 4),
        tables: vec![("functions.csv".into(), csv(header, rows))],
        pictures: Vec::new(),
    })
}

/// Figure 9: turned by 90 degrees at 20 % of growth, ratio 0.72.
pub fn turned() -> Result<Findings, ReproduceError> {
    const N: usize = 200;
    const TURN: usize = N / 5;
    let lags = [30_u32, 20, 12, 8, 6, 5, 4];
    let mut shapes =
        Plot::of_shapes("Turned by 90 degrees at 20 % of growth, ratio 0.72, lag falling", "x", "y");
    let mut errors = Plot::new("Error after the turn", "sub-steps", "degrees");
    let (mut rows, mut seen) = (Vec::new(), Vec::new());
    for (n, lag) in lags.into_iter().enumerate() {
        let control = Control::of_ratio(0.72, lag)?;
        // Laid level, the plant's own up is along +x; it then seeks the world's.
        let laid = Quat::from_rotation_z(-core::f32::consts::FRAC_PI_2);
        let grown = stalk(control, laid, N, 10.0, |k| if k < TURN { Vec3::X } else { Vec3::Y }, calm);
        let mut after = vec![90.0];
        after.extend(grown.headings[TURN..].iter().map(angle_x));
        let (first, count) = crossings(&after);
        seen.push((lag, first, count));
        rows.extend(after.iter().enumerate().map(|(k, e)| [lag as f32, k as f32, *e]));
        errors.line(format!("lag {lag}"), after.iter().enumerate().map(|(k, e)| Vec2::new(k as f32, *e)));
        shapes.line(format!("lag {lag}"), shifted(&grown, 4.6 * n as f32));
    }
    let of = |lag: u32| seen.iter().find(|s| s.0 == lag).map_or(0, |s| s.1);
    let told: Vec<String> = seen.iter().map(|(lag, first, _)| format!("{lag}: {first}")).collect();
    let rate: Vec<String> =
        seen.iter().map(|(lag, _, n)| format!("{lag}: {:.3}", *n as f32 / (N - TURN) as f32)).collect();
    let claims = vec![
        Claim {
            row: "ST-9",
            paper: "the smaller the lag, the sooner it is corrected (derived: 52, 11, 9, 7 steps at lag 30, 6, 5, 4)",
            measured: format!("first crossing of the target by lag {}", told.join(", ")),
            holds: seen.windows(2).all(|w| w[1].1 < w[0].1)
                && [of(30), of(6), of(5), of(4)] == [52, 11, 9, 7],
        },
        Claim {
            row: "ST-9",
            paper: "the smaller the lag, the higher the frequency of variation",
            measured: format!("crossings a sub-step by lag {}", rate.join(", ")),
            holds: seen.windows(2).all(|w| w[1].2 > w[0].2),
        },
    ];
    Ok(Findings {
        claims,
        picture: canvas::grid(&[shapes.draw(1100, 460)?, errors.draw(1100, 380)?], 1, 4),
        tables: vec![("error.csv".into(), csv(["lag", "sub_step", "error_deg"], rows))],
        pictures: Vec::new(),
    })
}

/// Figure 10: turned by 20 degrees at the start; two lags, each under-, equally and overcompensated.
pub fn compensation() -> Result<Findings, ReproduceError> {
    let mut shapes = Plot::of_shapes("Turned by 20 degrees at the start; lag 4, then lag 10", "x", "y");
    let mut errors = Plot::new("Error", "sub-steps", "degrees");
    let (mut rows, mut claims) = (Vec::new(), Vec::new());
    let cases = [
        ("undercompensated: the swing widens", 1.0 / 0.95, Verdict::Diverges),
        ("equally compensated: it swings for ever", 1.0, Verdict::Swings),
        ("overcompensated: the swing narrows", 0.85, Verdict::Converges),
    ];
    for (group, lag) in [4_u32, 10].into_iter().enumerate() {
        let swing = 4 * lag as usize + 2;
        for (n, (paper, share, expected)) in cases.into_iter().enumerate() {
            let control = Control::new(share * critical_gain(lag), lag)?;
            let start = 20_f32.to_radians();
            let grown = stalk(control, Quat::from_rotation_z(-start), 6 * swing, 12.0, |_| Vec3::Y, calm);
            let angles: Vec<f32> = grown.headings.iter().map(angle_x).collect();
            let widest = |part: &[f32]| part.iter().fold(0.0_f32, |w, a| w.max(a.abs()));
            let growth = widest(&angles[5 * swing..]) / widest(&angles[swing..2 * swing]);
            let read = stability(&control)?;
            let as_seen = match expected {
                Verdict::Diverges => growth > 1.1,
                Verdict::Swings => (growth - 1.0).abs() < 0.03,
                _ => growth < 0.9,
            };
            claims.push(Claim {
                row: "ST-9",
                paper,
                measured: format!(
                    "lag {lag}, ratio {:.3} (critical {:.3}): over four swings the swing changes by {growth:.2}; meter: {:?}",
                    read.ratio, read.critical_ratio, read.verdict
                ),
                holds: as_seen && read.verdict == expected,
            });
            let name = format!("lag {lag}, ratio {:.2}", read.ratio);
            rows.extend(angles.iter().enumerate().map(|(k, a)| [lag as f32, read.ratio, k as f32, *a]));
            errors.line(&name, angles.iter().enumerate().map(|(k, a)| Vec2::new(k as f32, *a)));
            shapes.line(name, shifted(&grown, 3.2 * (group * 3 + n) as f32 + 2.0 * group as f32));
        }
    }
    Ok(Findings {
        claims,
        picture: canvas::grid(&[shapes.draw(1000, 560)?, errors.draw(1000, 400)?], 1, 4),
        tables: vec![("error.csv".into(), csv(["lag", "ratio", "sub_step", "error_deg"], rows))],
        pictures: Vec::new(),
    })
}
