//! Torque loop of a gear with blocked wave generator: lost motion and stiffness (Fig. 5).
//!
//! ```text
//! width = phi(tau = 0, falling) - phi(tau = 0, rising)
//! chord = (tau_max - tau_min) / (phi(tau_max) - phi(tau_min))
//! ```
//!
//! Torsion phi (rad), transmitted torque tau (N m). Hysteresis takes energy from every loop: the falling
//! branch lies at the greater torsion, and the width is positive. Between two samples the torsion is taken
//! to be linear in the torque. A branch leads from beyond half of one tip's torque to beyond half of the other's:
//! the first rise from rest, which is the virgin curve, and the way back to rest are none.

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
    /// The loop in a sequence of samples; `None` when it lacks a falling or a rising branch.
    pub fn of(samples: &[Sample]) -> Option<Self> {
        let lower = *samples.iter().min_by(|a, b| a.torque.total_cmp(&b.torque))?;
        let upper = *samples.iter().max_by(|a, b| a.torque.total_cmp(&b.torque))?;
        let mut branches = Branches::default();
        for pair in samples.windows(2) {
            branches.follow(pair[0], pair[1], lower.torque / 2.0, upper.torque / 2.0);
        }
        Some(Self { width: branches.falling? - branches.rising?, lower, upper })
    }

    /// Stiffness from tip to tip (N m/rad).
    pub fn chord_stiffness(&self) -> f64 {
        (self.upper.torque - self.lower.torque) / (self.upper.torsion - self.lower.torsion)
    }

    /// Chord stiffness of a stiffness line between the torques of the tips (N m/rad).
    pub fn chord_stiffness_of(&self, line: &StiffnessLine<f64>) -> f64 {
        let torsion = line.torsion(self.upper.torque) - line.torsion(self.lower.torque);
        (self.upper.torque - self.lower.torque) / torsion
    }
}

/// A sequence of samples, branch by branch.
#[derive(Default)]
struct Branches {
    /// The sign of the tip that was left last.
    from: Option<f64>,
    /// Torsion at the last passage through zero torque.
    crossing: Option<f64>,
    /// The same of the last falling branch that is complete.
    falling: Option<f64>,
    /// The same of the last rising one.
    rising: Option<f64>,
}

impl Branches {
    /// The next sample: beyond `low` or `high` (N m) a branch is complete.
    fn follow(&mut self, before: Sample, now: Sample, low: f64, high: f64) {
        self.crossing = at_zero_torque(before, now).or(self.crossing);
        if low < now.torque && now.torque < high {
            return;
        }
        let tip = now.torque.signum();
        match self.from.replace(tip) {
            Some(from) if from > tip => self.falling = self.crossing,
            Some(from) if from < tip => self.rising = self.crossing,
            _ => {}
        }
    }
}

/// The torsion where the torque passes through zero between two samples.
fn at_zero_torque(before: Sample, now: Sample) -> Option<f64> {
    let crosses = (before.torque < 0.0) != (now.torque < 0.0);
    let fraction = before.torque / (before.torque - now.torque);
    crosses.then_some(before.torsion + fraction * (now.torsion - before.torsion))
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
    fn samples(steps: i32) -> Vec<Sample> {
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
        let samples = samples(1001);
        let line = LINE.build().unwrap();
        let chord = TIP / line.torsion(TIP);
        // Whichever way it sets out.
        let mirrored = samples.iter().map(|s| Sample { torsion: -s.torsion, torque: -s.torque }).collect();
        for samples in [samples, mirrored] {
            let found = TorqueLoop::of(&samples).unwrap();
            assert!((found.width - WIDTH).abs() < 1e-5 * WIDTH, "{}", found.width);
            for stiffness in [found.chord_stiffness(), found.chord_stiffness_of(&line)] {
                assert!((stiffness - chord).abs() < 1e-9 * chord, "{stiffness}");
            }
        }
    }

    #[test]
    fn half_a_loop_is_none() {
        assert_eq!(TorqueLoop::of(&samples(101)[..200]), None);
        assert_eq!(TorqueLoop::of(&[]), None);
    }
}
