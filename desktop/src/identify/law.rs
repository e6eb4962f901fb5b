//! The gear's quasi-static law, and its inverse: the torsion for a torque.
//!
//! ```text
//! tau = line(phi/s) + tau_hyst[phi]
//! ```
//!
//! Torsion phi (rad), torque tau (N m); s > 0 stretches the line. The law rises with phi: its inverse is found by
//! bisection.

use strainwave::flexspline::stiffness_line::StiffnessLine;
use strainwave::friction::FrictionParams;
use strainwave::gear::GearParams;
use strainwave::hysteresis::{TorsionHysteresis, TorsionHysteresisState, Weights};

use crate::identify::torque_loop::{Sample, TorqueLoop};
use crate::plant::MEMORY;

/// Halvings of the bracket: to the last bit of a torsion in it.
const HALVINGS: usize = 60;

/// Samples of a path for each 1 of its length.
const SAMPLES: f64 = 500.0;

/// The law.
#[derive(Clone, Debug)]
pub(crate) struct Law<const L: usize> {
    pub line: StiffnessLine<f64>,
    /// s
    pub factor: f64,
    pub hysteresis: TorsionHysteresis<f64, L, MEMORY>,
}

/// A torsion on the law, and the slopes there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnLaw {
    /// phi (rad).
    pub torsion: f64,
    /// tau_hyst (N m).
    pub hysteresis: f64,
    /// dline/dphi (N m/rad).
    pub line_stiffness: f64,
    /// dtau/dphi along the branch (N m/rad).
    pub stiffness: f64,
}

impl<const L: usize> Law<L> {
    /// From the line, s, and weights (N m) over torsions of +-`half_range` (rad).
    ///
    /// # Errors
    /// As [`TorsionHysteresis::from_weights`].
    pub fn build(
        line: StiffnessLine<f64>,
        factor: f64,
        half_range: f64,
        weights: &Weights<f64, L>,
    ) -> Result<Self, strainwave::Error> {
        let hysteresis = TorsionHysteresis::from_weights(half_range, weights)?;
        Ok(Self { line, factor, hysteresis })
    }

    /// That of a gear.
    ///
    /// # Errors
    /// As [`GearParams::hysteresis`].
    pub fn of<P: FrictionParams<f64>>(gear: &GearParams<f64, P>) -> Result<Self, strainwave::Error> {
        Ok(Self { line: gear.flexspline.line.build()?, factor: 1.0, hysteresis: gear.hysteresis()? })
    }

    /// The torsions of a sequence of torques from the demagnetised state.
    pub fn torsions(&self, torques: &[f64]) -> Vec<OnLaw> {
        self.torsions_after(0.0, torques)
    }

    /// The same after one torque `before` from the demagnetised state (N m).
    pub fn torsions_after(&self, before: f64, torques: &[f64]) -> Vec<OnLaw> {
        let mut state = TorsionHysteresisState::default();
        self.step(&mut state, before);
        torques.iter().map(|torque| self.step(&mut state, *torque)).collect()
    }

    /// Full width of the loop at zero torque after +-`torque` (rad); 0 of none.
    pub fn width(&self, torque: f64) -> f64 {
        let torques: Vec<_> =
            torques(&[0.0, 1.0, -1.0, 1.0, 0.0]).map(|fraction| fraction * torque).collect();
        let on = self.torsions(&torques).into_iter().zip(torques);
        let samples: Vec<_> = on.map(|(on, torque)| Sample { torsion: on.torsion, torque }).collect();
        // The branches of a law without hysteresis differ by rounding.
        TorqueLoop::of(&samples).map_or(0.0, |found| found.width.max(0.0))
    }

    fn step(&self, state: &mut TorsionHysteresisState<f64, MEMORY>, torque: f64) -> OnLaw {
        let torque_at = |torsion: f64| {
            self.line.torque(torsion / self.factor) + self.hysteresis.peek(state, torsion).torque
        };
        let mut high = self.factor * self.line.torsion(torque.abs() + 1.0);
        // The hysteresis torque is bounded, the line's is not.
        while torque_at(high) < torque || torque_at(-high) > torque {
            high *= 2.0;
        }
        let mut low = -high;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            (low, high) = if torque_at(middle) < torque { (middle, high) } else { (low, middle) };
        }
        let torsion = 0.5 * (low + high);
        let hysteresis = self.hysteresis.step(state, torsion);
        let on_line = self.line.torque(torsion / self.factor);
        let line_stiffness = 1.0 / (self.factor * self.line.compliance(on_line));
        OnLaw {
            torsion,
            hysteresis: hysteresis.torque,
            line_stiffness,
            stiffness: line_stiffness + hysteresis.slope,
        }
    }
}

/// From corner to corner.
pub fn torques(corners: &[f64]) -> impl Iterator<Item = f64> {
    corners.windows(2).flat_map(|pair| {
        let (from, to) = (pair[0], pair[1]);
        let count = ((to - from).abs() * SAMPLES).ceil().max(1.0);
        (1..=count as usize).map(move |k| from + (to - from) * k as f64 / count)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::joint::gear_params;
    use crate::io::gear_file::GearFile;

    #[test]
    fn the_torsion_carries_the_torque_and_the_slope_is_the_law_s() {
        let params = gear_params::<f64>(&GearFile::default_gear());
        let mut law = Law::<24>::of(&params).unwrap();
        law.factor = 1.2;
        let torques: Vec<_> = torques(&[0.0, 60.0, -20.0, 30.0]).collect();
        let on = law.torsions(&torques);
        for (on, torque) in on.iter().zip(&torques) {
            let line = law.line.torque(on.torsion / law.factor);
            assert!((line + on.hysteresis - torque).abs() < 1e-9);
        }
        // Between the knees and within a cell.
        let (before, now) = (&on[on.len() / 4], &on[on.len() / 4 + 1]);
        let step = torques[on.len() / 4 + 1] - torques[on.len() / 4];
        assert!((step / (now.torsion - before.torsion) / now.stiffness - 1.0).abs() < 1e-3);
    }

    #[test]
    fn the_width_of_the_default_gear_is_the_catalogue_s() {
        let gear = GearFile::default_gear();
        let width = Law::<24>::of(&gear_params(&gear)).unwrap().width(gear.gear.rated_torque);
        assert!((width / gear.hysteresis.width() - 1.0).abs() < 5e-3);
    }
}
