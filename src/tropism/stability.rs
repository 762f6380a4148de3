//! The stability meter: what gain and lag make of a single disturbance (`ST-6`).
//!
//! Without noise the error obeys E(n) = E(n-1) - kappa E(n-1-lag), and so goes as the powers of the roots of
//! z^(lag+1) - z^lag + kappa. The largest of them has a closed form along its path: with angle phi its size is
//! r = sin(lag phi) / sin((lag+1) phi), at kappa = r^(lag+1) sin(phi) / sin(lag phi), rising with phi.

use bevy::math::ops;
use core::f32::consts::PI;

use super::OutOfRange;
use super::controller::Control;

/// What becomes of an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub enum Verdict {
    /// It fades without swinging.
    Fades,
    /// It swings and fades (overcompensated).
    Converges,
    /// It swings by the same amount for ever, to within 0.1 % of the limit.
    Swings,
    /// It swings ever wider (undercompensated).
    Diverges,
}

/// What the meter shows.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Stability {
    /// Lag, sub-steps.
    pub lag: u32,
    /// Gain (kappa).
    pub gain: f32,
    /// Compensation ratio, `1 / (gain lag)`; without lag, `1 / gain`.
    pub ratio: f32,
    /// The ratio below which an error grows.
    pub critical_ratio: f32,
    /// Whether an error fades.
    pub stable: bool,
    /// What becomes of an error.
    pub verdict: Verdict,
    /// Factor by which the error changes in a sub-step.
    pub factor: f32,
    /// Sub-steps of a whole swing; `None` where nothing swings.
    pub period: Option<f32>,
    /// Damping ratio: 1 fades without swinging, 0 swings for ever, below 0 grows.
    pub damping: f32,
}

/// The gain from which on an error does not fade: 2 cos(lag pi / (2 lag + 1)).
pub fn critical_gain(lag: u32) -> f32 {
    // The cosine near a right angle, as a sine, which keeps its digits.
    2.0 * ops::sin(0.5 * PI / (2 * lag + 1) as f32)
}

/// Reads the meter for proportional control.
///
/// # Errors
/// A gain or lag out of range, or a gain of 0, with which nothing is ever corrected.
pub fn stability(control: &Control) -> Result<Stability, OutOfRange> {
    let Control { gain, lag, .. } = control.checked()?;
    if gain <= 0.0 {
        return Err(OutOfRange { what: "the gain", value: gain, allowed: "above 0" });
    }
    let critical = critical_gain(lag);
    let (factor, angle) = dominant_root(gain, lag);
    let log = ops::ln(factor.max(f32::MIN_POSITIVE));
    let near = (gain / critical - 1.0).abs() < 1e-3;
    Ok(Stability {
        lag,
        gain,
        ratio: control.ratio(),
        critical_ratio: 1.0 / (critical * lag.max(1) as f32),
        stable: gain < critical,
        verdict: match angle > 0.0 {
            _ if near => Verdict::Swings,
            _ if gain > critical => Verdict::Diverges,
            true => Verdict::Converges,
            false => Verdict::Fades,
        },
        factor,
        period: (angle > 0.0).then(|| 2.0 * PI / angle),
        damping: if angle == 0.0 { 1.0 } else { -log / (log * log + angle * angle).sqrt() },
    })
}

/// The error at each of some sub-steps after a disturbance by 1, the disturbance first: E(n) = E(n-1) - A(n-1-lag),
/// A being the answer to an error, integral and derivative control in it. Small errors are meant, which do not turn
/// over backwards.
pub fn response(control: &Control, substeps: u32) -> Vec<f32> {
    let lag = control.lag as usize;
    let (mut error, mut sum, mut last) = (1.0, 0.0, 1.0);
    let mut answers = Vec::with_capacity(substeps as usize);
    let mut errors = vec![error];
    for n in 0..substeps as usize {
        sum += error;
        answers.push(control.gain * (error + control.integral * sum + control.derivative * (error - last)));
        last = error;
        error -= n.checked_sub(lag).map_or(0.0, |then| answers[then]);
        errors.push(error);
    }
    errors
}

/// Size and angle of the root that decides.
fn dominant_root(gain: f32, lag: u32) -> (f32, f32) {
    if lag == 0 {
        return ((1.0 - gain).abs(), if gain > 1.0 { PI } else { 0.0 });
    }
    let n = lag as f32;
    let size = |angle: f32| ops::sin(n * angle) / ops::sin((n + 1.0) * angle);
    let gain_at = |angle: f32| ops::powf(size(angle), n + 1.0) * ops::sin(angle) / ops::sin(n * angle);
    let double = n / (n + 1.0);
    if gain <= ops::powf(double, n + 1.0) / n {
        // Two real roots; the larger lies between the double one and 1.
        let z = bisect(double, 1.0, |z| ops::powf(z, n) * (1.0 - z) > gain);
        return (z, 0.0);
    }
    let angle = bisect(1e-4 / n, PI / (n + 1.0) * (1.0 - 1e-6), |angle| gain_at(angle) < gain);
    (size(angle), angle)
}

/// Where `below` changes from true to false.
fn bisect(mut low: f32, mut high: f32, below: impl Fn(f32) -> bool) -> f32 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if below(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn st_06_critical_ratios_are_those_derived() {
        for (lag, ratio) in [(1, 1.0), (2, 0.809), (3, 0.749), (4, 0.7198), (5, 0.703), (10, 0.669)] {
            let critical = 1.0 / (critical_gain(lag) * lag as f32);
            assert!((critical - ratio).abs() < 6e-4, "lag {lag}: {critical}");
        }
        assert!((1.0 / (critical_gain(100_000) * 1e5) - 2.0 / PI).abs() < 1e-4);
    }

    #[test]
    fn st_06_at_the_limit_the_root_has_size_one_and_swings_in_four_lags_and_two() {
        for lag in 1..=30 {
            let read = stability(&Control::new(critical_gain(lag), lag).unwrap()).unwrap();
            assert!((read.factor - 1.0).abs() < 1e-3, "lag {lag}: {}", read.factor);
            assert_eq!(read.verdict, Verdict::Swings);
            assert!(
                (read.period.unwrap() - (4 * lag + 2) as f32).abs() < 0.05 * lag as f32 + 0.1,
                "lag {lag}"
            );
        }
    }

    #[test]
    fn st_06_the_response_is_that_of_the_controller() {
        use crate::tropism::controller::{Influence, Steering, step, turned_to};
        use crate::tropism::signals::Signals;
        use bevy::math::{Quat, Vec3};
        const SMALL: f32 = 0.01;
        for (gain, lag, integral, derivative) in
            [(0.6, 0, 0.0, 0.0), (0.3, 3, 0.0, 0.0), (0.2, 2, 0.1, 0.5), (1.1, 1, 0.0, 0.0)]
        {
            let control = Control { gain, lag, integral, derivative };
            let told = response(&control, 40);
            let (mut steering, mut signals) = (Steering::default(), Signals::default());
            let mut frame = Quat::from_rotation_z(-SMALL);
            for (n, expected) in told.iter().enumerate() {
                let heading = frame * Vec3::Y;
                let error = bevy::math::ops::atan2(heading.x, heading.y) / SMALL;
                assert!(
                    (error - expected).abs() < 2e-3 * (1.0 + expected.abs()),
                    "{control:?} at {n}: {error}"
                );
                let next = step(&control, &mut steering, &mut signals, frame, Vec3::Y, Influence::default());
                frame = turned_to(frame, next);
            }
        }
    }

    #[test]
    fn st_06_the_response_fades_where_the_meter_says_so() {
        for lag in 0..8 {
            for share in [0.3, 0.9, 1.1] {
                let control = Control::new(share * critical_gain(lag), lag).unwrap();
                let errors = response(&control, 400);
                let late = errors[300..].iter().fold(0.0_f32, |most, e| most.max(e.abs()));
                assert_eq!(late < 1.0, stability(&control).unwrap().stable, "lag {lag}, {share}");
            }
        }
    }

    #[test]
    fn st_06_what_cannot_be_is_a_typed_error() {
        assert!(Control::new(-0.1, 3).is_err() && Control::new(f32::NAN, 3).is_err());
        assert!(Control::new(0.5, 31).is_err() && Control::of_ratio(0.0, 3).is_err());
        assert!(Control::of_ratio(f32::INFINITY, 3).is_err());
        let told = stability(&Control { gain: 0.0, ..Control::DIRECT }).unwrap_err().to_string();
        assert_eq!(told, "the gain is 0; allowed: above 0");
    }
}
