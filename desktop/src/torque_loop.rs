//! What a torque loop with blocked wave generator shows of a gear: lost motion and stiffness (Fig. 5).
//!
//! ```text
//! width = phi(tau = 0, falling) - phi(tau = 0, rising)
//! chord = (tau_max - tau_min) / (phi(tau_max) - phi(tau_min))
//! ```
//!
//! Torsion phi (rad), transmitted torque tau (N m). Hysteresis takes energy from every loop: the falling
//! branch lies at the greater torsion, and the width is positive. Between two samples the torsion is taken
//! to be linear in the torque. The first rise from rest is the virgin curve and no part of the loop: the branches
//! judged are the last one that falls to the lower tip and the one that rises from it.

use strainwave::flexspline::stiffness_line::StiffnessLine;

/// A sample of a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// (rad)
    pub torsion: f64,
    /// (N m)
    pub torque: f64,
}

/// A closed loop between its tips.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueLoop {
    /// Full width in torsion at zero torque (rad).
    pub width: f64,
    lower: Sample,
    upper: Sample,
}

impl TorqueLoop {
    /// The loop in a course of samples; `None` when the torque does not pass through zero on the way to its
    /// minimum and again on the way back.
    pub fn of(samples: &[Sample]) -> Option<Self> {
        let lowest = (0..samples.len()).min_by(|a, b| samples[*a].torque.total_cmp(&samples[*b].torque))?;
        let (before, after) = (&samples[..=lowest], &samples[lowest..]);
        let falling = before.windows(2).filter_map(|pair| at_zero_torque(pair[1], pair[0])).next_back()?;
        let rising = after.windows(2).find_map(|pair| at_zero_torque(pair[0], pair[1]))?;
        let upper = after.iter().max_by(|a, b| a.torque.total_cmp(&b.torque))?;
        Some(Self { width: falling - rising, lower: samples[lowest], upper: *upper })
    }

    /// Stiffness from tip to tip (N m/rad).
    pub fn chord_stiffness(&self) -> f64 {
        (self.upper.torque - self.lower.torque) / (self.upper.torsion - self.lower.torsion)
    }

    /// What a stiffness line has between the torques of the tips (N m/rad).
    pub fn chord_stiffness_of(&self, line: &StiffnessLine<f64>) -> f64 {
        let torsion = line.torsion(self.upper.torque) - line.torsion(self.lower.torque);
        (self.upper.torque - self.lower.torque) / torsion
    }
}

/// The torsion where the torque passes through zero, from negative to not negative.
fn at_zero_torque(negative: Sample, other: Sample) -> Option<f64> {
    let crosses = negative.torque < 0.0 && other.torque >= 0.0;
    let share = negative.torque / (negative.torque - other.torque);
    crosses.then_some(negative.torsion + share * (other.torsion - negative.torsion))
}

#[cfg(test)]
mod tests {
    use super::*;
    use strainwave::flexspline::stiffness_line::StiffnessLineParams;

    const WIDTH: f64 = 3e-4;
    const TIP: f64 = 67.0;
    const LINE: StiffnessLineParams<f64> =
        StiffnessLineParams { stiffness: [3.1e4, 5.0e4, 5.7e4], knee_torque: [14.0, 48.0] };

    /// Virgin curve to the upper tip, down, up and back to zero: branches that meet on the line at the tips.
    fn course(steps: i32) -> Vec<Sample> {
        let line = LINE.build().unwrap();
        let leg = |from: f64, to: f64, bulge: f64| {
            (0..=steps).map(move |k| {
                let torque = from + (to - from) * f64::from(k) / f64::from(steps);
                let inside = 1.0 - (torque / TIP).powi(2);
                Sample { torsion: line.torsion(torque) + bulge * inside, torque }
            })
        };
        let there = leg(0.0, TIP, 0.0).chain(leg(TIP, -TIP, WIDTH / 2.0));
        there.chain(leg(-TIP, TIP, -WIDTH / 2.0)).chain(leg(TIP, 0.0, WIDTH / 2.0)).collect()
    }

    #[test]
    fn width_and_chord_of_a_known_loop_are_found_between_its_samples() {
        // An odd number of steps: no sample stands at zero torque.
        let found = TorqueLoop::of(&course(1001)).unwrap();
        assert!((found.width - WIDTH).abs() < 1e-5 * WIDTH, "{}", found.width);
        let line = LINE.build().unwrap();
        let chord = TIP / line.torsion(TIP);
        for stiffness in [found.chord_stiffness(), found.chord_stiffness_of(&line)] {
            assert!((stiffness - chord).abs() < 1e-9 * chord, "{stiffness}");
        }
    }

    #[test]
    fn half_a_loop_is_none() {
        assert_eq!(TorqueLoop::of(&course(101)[..200]), None);
        assert_eq!(TorqueLoop::of(&[]), None);
    }
}
