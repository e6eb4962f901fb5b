//! The gear's quasi-static law, and its inverse: the torsion that carries a torque.
//!
//! ```text
//! tau = line(phi/s) + tau_hyst[phi]
//! ```
//!
//! Torsion phi (rad), torque tau (N m); s > 0 stretches the line. The law rises with phi: its inverse is found by
//! bisection.

use strainwave::flexspline::stiffness_line::StiffnessLine;
use strainwave::gear::GearParams;
use strainwave::hysteresis::{TorsionHysteresis, TorsionHysteresisState, Weights};

use crate::plant::MEMORY;

/// Halvings of the bracket: to the last bit of a torsion in it.
const HALVINGS: usize = 60;

/// The law.
#[derive(Clone, Debug)]
pub(super) struct Law<const L: usize> {
    pub line: StiffnessLine<f64>,
    /// s
    pub factor: f64,
    pub hysteresis: TorsionHysteresis<f64, L, MEMORY>,
}

/// A torsion on the law, and the slopes there.
#[derive(Clone, Copy, Debug)]
pub(super) struct OnLaw {
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
    pub fn of(gear: &GearParams<f64>) -> Result<Self, strainwave::Error> {
        Ok(Self { line: gear.flexspline.line.build()?, factor: 1.0, hysteresis: gear.hysteresis()? })
    }

    /// The torsions of a course of torques from the demagnetised state.
    pub fn torsions(&self, torques: &[f64]) -> Vec<OnLaw> {
        let mut state = TorsionHysteresisState::default();
        torques.iter().map(|torque| self.step(&mut state, *torque)).collect()
    }

    fn step(&self, state: &mut TorsionHysteresisState<f64, MEMORY>, torque: f64) -> OnLaw {
        let carried = |torsion: f64| {
            self.line.torque(torsion / self.factor) + self.hysteresis.peek(state, torsion).torque
        };
        let mut high = self.factor * self.line.torsion(torque.abs() + 1.0);
        // The hysteresis torque is bounded, the line's is not.
        while carried(high) < torque || carried(-high) > torque {
            high *= 2.0;
        }
        let mut low = -high;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            (low, high) = if carried(middle) < torque { (middle, high) } else { (low, middle) };
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
