//! One mode as an oscillator, stepped exactly for a load that is linear between two samples.
//!
//! ```text
//! d2q + 2*zeta*omega*dq + omega^2*q = Q(t),     Q from Q0 to Q1 within dt
//! q1 = q_s(1) + T*(q0 - q_s(0))                 q_s = Q/omega^2 - 2*zeta/omega^3*dQ,  dQ = (Q1 - Q0)/dt
//! T = e^(-zeta*omega*dt)*[cos + zeta/r*sin,  sin/(r*omega); -omega/r*sin,  cos - zeta/r*sin](r*omega*dt),  r = sqrt(1 - zeta^2)
//! ```
//!
//! q_s is the particular solution, T the transition of the free motion: no dt makes it unstable, and without damping and
//! load det T = 1 conserves the energy. Coefficients are computed in f64, and T less the unit matrix is what is kept: in f32 the ones
//! would leave few digits of a slow mode's frequency. Units: q (m kg^1/2), Q (N kg^-1/2).

use crate::elementary::double;
use crate::real::Real;

/// Built mode.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Oscillator<R> {
    /// omega (rad/s).
    pub omega: R,
    /// omega^2.
    pub stiffness: R,
    /// 2*zeta*omega.
    pub damping: R,
    /// T less the unit matrix.
    change: [[R; 2]; 2],
    /// Of q1 and its rate, for Q0 and Q1.
    load: [[R; 2]; 2],
}

impl<R: Real> Oscillator<R> {
    /// `omega` and `dt` positive, `zeta` 0..1.
    pub fn build(omega: f64, zeta: f64, dt: f64) -> Self {
        let root = Real::sqrt(1.0 - zeta * zeta);
        let (sin, cos) = double::sin_cos(root * omega * dt);
        let decay = double::exp(-zeta * omega * dt);
        let (sin, cos) = (decay * sin / root, decay * cos);
        let transition = [[cos + zeta * sin, sin / omega], [-omega * sin, cos - zeta * sin]];
        let stiffness = omega * omega;
        let settled = 1.0 / stiffness;
        // Of a load that rises by 1 within dt: lag and rate of q_s.
        let (lag, rate) = (2.0 * zeta / (stiffness * omega * dt), settled / dt);
        let load = |row: usize, settled_here: f64, rate_here: f64| {
            let [position, velocity] = transition[row];
            let before = rate_here - position * (settled + lag) + velocity * rate;
            let now = settled_here + position * lag - velocity * rate;
            [before, now]
        };
        let load = [load(0, settled - lag, lag), load(1, rate, -rate)];
        let number = |rows: [[f64; 2]; 2]| rows.map(|row| row.map(R::lit));
        let [[stays, moves], [pulls, keeps]] = transition;
        Self {
            omega: R::lit(omega),
            stiffness: R::lit(stiffness),
            damping: R::lit(2.0 * zeta * omega),
            change: number([[stays - 1.0, moves], [pulls, keeps - 1.0]]),
            load: number(load),
        }
    }

    /// q and its rate after dt, the load going from `before` to `now`.
    pub fn step(&self, [position, velocity]: [R; 2], before: R, now: R) -> [R; 2] {
        let row = |k: usize| {
            let ([of_position, of_velocity], [of_before, of_now]) = (self.change[k], self.load[k]);
            of_position * position + of_velocity * velocity + of_before * before + of_now * now
        };
        [position + row(0), velocity + row(1)]
    }

    /// d2q.
    pub fn acceleration(&self, [position, velocity]: [R; 2], load: R) -> R {
        load - self.damping * velocity - self.stiffness * position
    }

    /// Change of d2q at the end of a step by the load there.
    pub fn response(&self) -> R {
        let [[_, position], [_, velocity]] = self.load;
        R::ONE - self.damping * velocity - self.stiffness * position
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A polynomial of first degree that solves the equation is followed to rounding, whatever the step.
    #[test]
    fn what_moves_steadily_under_a_steady_rise_is_exact() {
        for (omega, zeta, dt) in [(20.0, 0.0, 1e-3), (300.0, 0.05, 4e-3), (5.0, 0.7, 0.3)] {
            let mode = Oscillator::<f64>::build(omega, zeta, dt);
            let (offset, slope) = (0.3, -2.0);
            let load = |t: f64| omega * omega * (offset + slope * t) + 2.0 * zeta * omega * slope;
            let mut state = [offset, slope];
            for k in 0..1000 {
                let t = f64::from(k) * dt;
                state = mode.step(state, load(t), load(t + dt));
            }
            let expected = offset + slope * 1000.0 * dt;
            assert!(
                (state[0] / expected - 1.0).abs() < 1e-9 && (state[1] / slope - 1.0).abs() < 1e-9,
                "{state:?}"
            );
        }
    }

    /// Two steps are one of twice the length.
    #[test]
    fn steps_compose() {
        let (omega, zeta) = (90.0, 0.03);
        let [short, long] = [1e-3, 2e-3].map(|dt| Oscillator::<f64>::build(omega, zeta, dt));
        let (start, [a, b]) = ([0.01, -1.0], [3.0, -5.0]);
        let twice = short.step(short.step(start, a, 0.5 * (a + b)), 0.5 * (a + b), b);
        let once = long.step(start, a, b);
        assert!(twice.iter().zip(&once).all(|(x, y)| (x - y).abs() < 1e-14), "{twice:?} {once:?}");
    }
}
