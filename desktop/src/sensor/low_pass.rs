//! Bandwidth of a sensor: one pole.
//!
//! ```text
//! dy/dt = omega_c*(x - y),   omega_c = 2*pi*f_c
//! y1 = x1 - m/omega_c*(1 - a) + a*(y0 - x0),   m = (x1 - x0)/dt,   a = e^(-omega_c*dt)
//! ```
//!
//! At f_c a sine has 1/sqrt(2) of its amplitude. Exact over the step for a true value that is linear between two samples; without a
//! bandwidth y = x, bit for bit. The first sample finds it settled. Units: Hz, s; x and y alike.

use std::f64::consts::TAU;

use strainwave::Error;

use super::require;

/// Built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LowPass {
    /// a, and the mean of the decay over the step, (1 - a)/(omega_c*dt); none without a bandwidth.
    pole: Option<[f64; 2]>,
}

/// x and y of the last sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LowPassState(Option<[f64; 2]>);

impl LowPass {
    /// `bandwidth` positive (Hz); none for a sensor that follows at once.
    pub fn build(bandwidth: Option<f64>, dt: f64) -> Result<Self, Error> {
        let pole = bandwidth.map(|frequency| {
            let decay = TAU * frequency * dt;
            [(-decay).exp(), -(-decay).exp_m1() / decay]
        });
        require(bandwidth.is_none_or(|frequency| frequency.is_finite() && frequency > 0.0), "bandwidth")?;
        Ok(Self { pole })
    }

    /// y after dt; of an x that is no number the last one counts.
    pub fn step(&self, LowPassState(state): &mut LowPassState, x: f64) -> f64 {
        let last = state.map_or(0.0, |[x, _]| x);
        let x = if x.is_finite() { x } else { last };
        let y = match (self.pole, *state) {
            (Some([kept, mean]), Some([x0, y0])) => x - (x - x0) * mean + kept * (y0 - x0),
            _ => x,
        };
        *state = Some([x, y]);
        y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a ramp it lags by 1/omega_c, from the first sample on as the equation says.
    #[test]
    fn a_ramp_is_followed_exactly_whatever_the_step() {
        for dt in [1e-5, 1e-3, 0.1] {
            let (slope, corner) = (3.0, TAU * 40.0);
            let (low_pass, mut state) = (LowPass::build(Some(40.0), dt).unwrap(), LowPassState::default());
            low_pass.step(&mut state, 0.0);
            for k in 1..50 {
                let time = f64::from(k) * dt;
                let exact = slope * (time - (1.0 - (-corner * time).exp()) / corner);
                let found = low_pass.step(&mut state, slope * time);
                assert!((found - exact).abs() < 1e-13 * (1.0 + exact.abs()), "{dt}: {found} {exact}");
            }
        }
    }

    #[test]
    fn without_a_bandwidth_nothing_changes_and_nan_is_the_last_value() {
        let (low_pass, mut state) = (LowPass::build(None, 1e-4).unwrap(), LowPassState::default());
        assert_eq!(
            [f64::NAN, 0.3, -7.0, f64::INFINITY].map(|x| low_pass.step(&mut state, x)),
            [0.0, 0.3, -7.0, -7.0]
        );
        assert!([0.0, -1.0, f64::NAN, f64::INFINITY].iter().all(|f| LowPass::build(Some(*f), 1e-4).is_err()));
    }
}
