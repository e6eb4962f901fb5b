//! LuGre's canonical stick-slip against a solution of its differential equation to tight tolerance.
//!
//! A mass on a spring whose end is pulled steadily; problem and solution are
//! `desktop/oracle/friction/lugre_stick_slip.toml`. The mass is stepped semi-implicitly, velocity first;
//! friction by its own exact step.

use serde::Deserialize;
use strainwave::friction::lugre::LuGreState;
use strainwave::friction::{
    FrictionModel, FrictionParams, LuGre, LuGreParams, LubricatedContactParams, Slip,
};

use crate::io::figure::Figure;
use crate::verify::bounds;

const STORED: &str = include_str!("../../../oracle/friction/lugre_stick_slip.toml");
/// Time step (s).
const STEP: f64 = 1e-5;

/// The problem and its solution.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StickSlip {
    /// sigma0 (N/m).
    pub sigma0_n_per_m: f64,
    sigma1_n_s_per_m: f64,
    sigma2_n_s_per_m: f64,
    fc_n: f64,
    /// Fs (N).
    pub fs_n: f64,
    vs_m_per_s: f64,
    mass_kg: f64,
    stiffness_n_per_m: f64,
    pull_m_per_s: f64,
    end_s: f64,
    settled_s: f64,
    period_s: f64,
    peak_friction_n: f64,
    peak_spring_n: f64,
}

/// Errors against the solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Relative error of the period.
    pub period: f64,
    /// Larger relative error of the peak forces of friction and spring.
    pub peak: f64,
}

pub(super) fn measure() -> Vec<Figure> {
    let errors = StickSlip::stored().errors();
    vec![
        bounds::figure("friction.lugre.period", errors.period),
        bounds::figure("friction.lugre.peak", errors.peak),
    ]
}

impl StickSlip {
    /// # Panics
    /// When the embedded file is not the problem, which is a mistake in the program.
    pub fn stored() -> Self {
        toml::from_str(STORED).expect("lugre_stick_slip.toml is a problem")
    }

    fn model(&self) -> LuGre<f64> {
        let contact = LubricatedContactParams {
            coulomb: self.fc_n,
            static_level: self.fs_n,
            stribeck_velocity: self.vs_m_per_s,
            stribeck_exponent: 2.0,
            viscous: self.sigma2_n_s_per_m,
        };
        let params = LuGreParams { contact, stiffness: self.sigma0_n_per_m, damping: self.sigma1_n_s_per_m };
        params.build().expect("the levels are in range")
    }

    /// Relative errors of the settled motion.
    ///
    /// # Panics
    /// When the model cannot be built.
    pub fn errors(&self) -> Errors {
        let model = self.model();
        let mut state = LuGreState::default();
        let (mut position, mut velocity) = (0.0, 0.0);
        let (mut breaks, mut peak_friction, mut peak_spring) = (Vec::new(), 0.0f64, 0.0f64);
        for k in 0..(self.end_s / STEP) as u32 {
            let time = f64::from(k) * STEP;
            let spring = self.stiffness_n_per_m * (self.pull_m_per_s * time - position);
            let friction = model.step(&mut state, &Slip::new(velocity, STEP)).force;
            let before = velocity;
            velocity += STEP * (spring - friction) / self.mass_kg;
            position += STEP * velocity;
            let half = 0.5 * self.pull_m_per_s;
            if time > self.settled_s {
                peak_friction = peak_friction.max(friction);
                peak_spring = peak_spring.max(spring);
                if before < half && velocity >= half {
                    breaks.push(time);
                }
            }
        }
        let difference = |ours: f64, theirs: f64| (ours / theirs - 1.0).abs();
        Errors {
            period: difference(mean_interval(&breaks), self.period_s),
            peak: difference(peak_friction, self.peak_friction_n)
                .max(difference(peak_spring, self.peak_spring_n)),
        }
    }
}

/// NaN for less than two times.
fn mean_interval(times: &[f64]) -> f64 {
    match times {
        [first, .., last] => (last - first) / (times.len() - 1) as f64,
        _ => f64::NAN,
    }
}
