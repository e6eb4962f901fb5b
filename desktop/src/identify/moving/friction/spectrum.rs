//! Spectrum of the residual torque over the motor's angle: waves of any order that no parameter of the block explains.
//!
//! The residual is averaged over [`BINS`] of the angle, for either direction f and b; orders of (f + b)/2 are a torque that does not
//! care about the direction, such as cogging, those of (f - b)/2 reverse with it, as friction does. With one direction
//! alone both are one. A revolution must be seen in every bin.

use std::f64::consts::TAU;

use super::motion::Step;
use crate::identify::ripple_fit;

/// Bins of a revolution.
const BINS: usize = 64;
/// Largest order.
const ORDERS: usize = 24;
/// Most waves.
const MOST: usize = 3;
/// Amplitude over its standard deviation from which on an order counts.
const SIGNIFICANT: f64 = 4.0;
/// Speed from which on the contact slides (rad/s).
const SLIDING: f64 = 0.3;
/// Orders that the block has a place for.
const OF_BLOCK: u32 = 2;

/// A torque over the motor's angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wave {
    /// Periods a revolution.
    pub order: u32,
    /// It changes its sign with the direction of motion.
    pub reverses: bool,
}

/// Direction of motion, 0 at rest.
pub(super) fn direction(step: &Step) -> f64 {
    (step.speed / SLIDING).tanh()
}

/// The largest waves of the residual (N m) of rows, whose mean has the standard deviation `deviation` (N m); largest first.
pub(super) fn waves<'a>(
    rows: impl Iterator<Item = (&'a Step, f64)> + Clone,
    deviation: f64,
    [forward, backward]: [bool; 2],
) -> Vec<Wave> {
    let over = |backwards: bool| {
        let sign = if backwards { -1.0 } else { 1.0 };
        map(rows.clone().filter(move |(step, _)| sign * step.speed > SLIDING))
    };
    let combined = |a: &[f64], b: &[f64], sign: f64| -> Vec<f64> {
        a.iter().zip(b).map(|(a, b)| 0.5 * (a + sign * b)).collect()
    };
    let maps = match (forward.then(|| over(false)).flatten(), backward.then(|| over(true)).flatten()) {
        (Some(f), Some(b)) => vec![(combined(&f, &b, 1.0), false), (combined(&f, &b, -1.0), true)],
        (Some(one), None) | (None, Some(one)) => vec![(one, false)],
        (None, None) => Vec::new(),
    };
    let both = forward && backward;
    let mut found: Vec<_> = maps.iter().flat_map(|(map, reverses)| amplitudes(map, *reverses)).collect();
    found.retain(|(wave, amplitude)| {
        let of_block = wave.order <= OF_BLOCK && (wave.reverses || !both);
        !of_block && *amplitude > SIGNIFICANT * deviation
    });
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    found.into_iter().take(MOST).map(|(wave, _)| wave).collect()
}

fn amplitudes(map: &[f64], reverses: bool) -> impl Iterator<Item = (Wave, f64)> + use<> {
    let found = ripple_fit::fit::<ORDERS>(map);
    (0..ORDERS).map(move |k| (Wave { order: k as u32 + 1, reverses }, found.cosines[k].hypot(found.sines[k])))
}

/// Mean residual of every bin; `None` when one is empty.
fn map<'a>(rows: impl Iterator<Item = (&'a Step, f64)>) -> Option<Vec<f64>> {
    let mut bins = vec![(0.0, 0usize); BINS];
    for (step, left) in rows {
        let bin = &mut bins[(step.angle.rem_euclid(TAU) / TAU * BINS as f64) as usize % BINS];
        *bin = (bin.0 + left, bin.1 + 1);
    }
    bins.iter().map(|(sum, count)| (*count > 0).then(|| sum / *count as f64)).collect()
}

#[cfg(test)]
mod tests {
    use strainwave::Angle;

    use super::*;

    fn step(angle: f64, speed: f64) -> Step {
        Step {
            angle,
            heading: Angle::<f64>::from_radians_f64(angle).heading(),
            speed,
            acceleration: 0.0,
            output: 0.0,
            torque: 0.0,
            reflected: f64::NAN,
            output_friction: 0.0,
        }
    }

    #[test]
    fn waves_are_found_with_what_reverses_them() {
        let angle = |k: u32| f64::from(k) * 0.013;
        let there: Vec<_> = (0..2000).map(|k| step(angle(k), 2.0)).collect();
        let back: Vec<_> = (0..2000).rev().map(|k| step(angle(k), -2.0)).collect();
        let left = |step: &Step| {
            2e-3 * (4.0 * step.angle + 0.3).sin() + 1e-3 * step.speed.signum() * (12.0 * step.angle).cos()
        };
        let rows: Vec<_> = there.iter().chain(&back).map(|step| (step, left(step))).collect();
        let found = waves(rows.iter().copied(), 1e-5, [true; 2]);
        assert_eq!(found, [Wave { order: 4, reverses: false }, Wave { order: 12, reverses: true }]);
        assert_eq!(waves(rows.iter().copied(), 1e-3, [true; 2]), []);
        let one: Vec<_> = there.iter().map(|step| (step, left(step))).collect();
        assert_eq!(waves(one.iter().copied(), 1e-5, [true, false]).len(), 2);
        assert_eq!(waves(one[..200].iter().copied(), 1e-5, [true, false]), []);
    }
}
