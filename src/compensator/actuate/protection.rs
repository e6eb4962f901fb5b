//! Protection of the gear: bounds of the motor's torque by which the torque through the gear approaches its own bound
//! without overshoot.
//!
//! ```text
//! Q = n*tau - n*tau_fric,   J = n^2*J_wg,   c = 1 + J/J_fs,   omega^2 = c*K/J
//! |Q + (c-1)*T + 2*c/omega*dT/dt| <= c*L,      L = 1 - m*d_kt of the peak rating
//! ```
//!
//! T is the torque through the gear by the balance of the rotor ([`crate::compensator::sense::rotor`]): it depends on
//! neither the observer nor a sensor at the output. With an output that is held, K*(Q - T)/J is T's second derivative, so that at
//! the bound `T'' = omega^2*(L - T) - 2*omega*T'`: T approaches L critically damped and never passes it, whatever is
//! commanded. An output that is free accelerates and T stays further below; so it does with a J_fs that counts as larger than it
//! is, because its mode is too fast for the round ([`output_inertia`]). K is the stiffest slope of the line, so that
//! omega is not below that of the gear. The margin of L covers the tolerance d_kt of the torque constant and, with m*d_kt
//! ([`Tolerances::of_peak`]), the time from T to the command. Units: N m at the motor's shaft.

use crate::branch::seldom;
use crate::compensator::sense::rotor::output_inertia;
use crate::compensator::{Faults, Limits, Tolerances};
use crate::constants::constants;
use crate::gear::GearParams;
use crate::real::Real;

/// The built protection.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Protection<R> {
    /// L, and c*L/|n| (N m).
    torque: R,
    half: R,
    /// (c-1)/n and 2*c/(omega*n).
    by_torque: R,
    by_rate: R,
    /// Peak torque of the motor (N m).
    peak: R,
}

/// Torques that the motor may have (N m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProtectionState<R> {
    lowest: R,
    highest: R,
}

impl<R: Real> ProtectionState<R> {
    /// A torque (N m) limited to these, which is said; the lowest in the place of one that is no number.
    #[inline(always)]
    pub fn limit(&self, torque: R, faults: &mut Faults) -> R {
        if torque >= self.lowest && torque <= self.highest {
            return torque;
        }
        seldom();
        *faults = faults.with(Faults::TORQUE_LIMITED);
        if torque > self.highest { self.highest } else { self.lowest }
    }
}

impl<R: Real> Protection<R> {
    /// For a gear that was checked, and the control period dt (s).
    pub fn build(gear: &GearParams<R>, limits: &Limits<R>, tolerances: &Tolerances<R>, dt: R) -> Self {
        let n = R::from_i32(gear.ratio);
        let rotor = n * n * gear.wave_generator_inertia;
        let c = R::ONE + rotor / output_inertia(gear, dt);
        let omega = (c * gear.flexspline.line.stiffness[2] / rotor).sqrt();
        let torque = tolerances.of_peak() * limits.output_torque;
        Self {
            torque,
            half: c * torque / n.abs(),
            by_torque: (c - R::ONE) / n,
            by_rate: R::lit(2.0) * c / (omega * n),
            peak: limits.motor_torque,
        }
    }

    /// Before the first torque through the gear: those of the motor.
    pub fn rest(&self) -> ProtectionState<R> {
        ProtectionState { lowest: -self.peak, highest: self.peak }
    }

    /// Constant acceleration of the output (rad/s^2) that the bounds admit where no load and no friction act:
    /// `(n^2*J_wg + c*J_fs)*a = c*L`.
    pub fn acceleration(&self, gear: &GearParams<R>) -> R {
        let n = R::from_i32(gear.ratio);
        let output = (R::ONE + n * self.by_torque) * gear.flexspline_inertia;
        self.half * n.abs() / (n * n * gear.wave_generator_inertia + output)
    }

    /// L (N m).
    pub fn torque(&self) -> R {
        self.torque
    }

    /// With a new torque through the gear (N m), its rate (N m/s) and the rotor's friction (N m).
    #[inline(always)]
    pub fn follow(&self, state: &mut ProtectionState<R>, torque: R, rate: R, friction: R) {
        let middle = friction - self.by_torque * torque - self.by_rate * rate;
        let bound = |torque: R| torque.limit(self.peak);
        *state = ProtectionState { lowest: bound(middle - self.half), highest: bound(middle + self.half) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INERTIA: [f64; 2] = [6e-5, 1.2];
    const STIFFNESS: f64 = 5.7e4;
    const PEAK: f64 = 157.0;
    const ALLOWED: f64 = 0.85;
    const MOTOR: f64 = 2.4;

    fn protection() -> Protection<f64> {
        let [rotor, output] = INERTIA;
        let rotor = 1e4 * rotor;
        let c = 1.0 + rotor / output;
        Protection {
            torque: ALLOWED * PEAK,
            half: c * ALLOWED * PEAK / 100.0,
            by_torque: (c - 1.0) / -100.0,
            by_rate: 2.0 * c / ((c * STIFFNESS / rotor).sqrt() * -100.0),
            peak: MOTOR,
        }
    }

    /// Largest torque through the gear with full torque in alternating directions, the output held or free.
    fn largest(held: bool, protected: bool) -> f64 {
        let protection = protection();
        let mut state = protection.rest();
        let (mut rotor, mut output) = ([0.0f64; 2], [0.0f64; 2]);
        let (dt, mut largest, mut last) = (1e-4, 0.0f64, 0.0);
        for k in 0..4000 {
            let torque = STIFFNESS * (rotor[0] / -100.0 - output[0]);
            if k % 4 == 0 {
                protection.follow(&mut state, torque, (torque - last) / 4e-4, 0.0);
                last = torque;
            }
            let commanded = if (k / 100) % 2 == 0 { MOTOR } else { -MOTOR };
            let motor = if protected { state.limit(commanded, &mut Faults::default()) } else { commanded };
            rotor[1] += dt * (motor - torque / -100.0) / INERTIA[0];
            output[1] += if held { 0.0 } else { dt * torque / INERTIA[1] };
            rotor[0] += dt * rotor[1];
            output[0] += dt * output[1];
            largest = largest.max(torque.abs());
        }
        largest
    }

    #[test]
    fn no_command_takes_the_gear_beyond_its_rating() {
        for held in [true, false] {
            assert!(largest(held, false) > 1.5 * PEAK, "{held}: {}", largest(held, false));
            assert!(largest(held, true) <= PEAK, "{held}: {}", largest(held, true));
        }
        assert!(largest(true, true) > 0.7 * PEAK, "{}", largest(true, true));
    }

    #[test]
    fn a_torque_within_the_bounds_passes_unchanged_and_another_is_named() {
        let mut faults = Faults::NONE;
        for torque in [0.0, 0.1234567, -1.5] {
            assert_eq!(protection().rest().limit(torque, &mut faults), torque);
        }
        assert_eq!(faults, Faults::NONE);
        assert_eq!(protection().rest().limit(1.01 * MOTOR, &mut faults), MOTOR);
        assert_eq!(faults, Faults::TORQUE_LIMITED);
    }

    /// However far the bounds are: within the motor's peak torque.
    #[test]
    fn the_motors_peak_torque_bounds_every_torque() {
        let (protection, mut state) = (protection(), protection().rest());
        for torque in [0.0, 1e3, -1e3, 1e30, f64::NAN] {
            protection.follow(&mut state, torque, 0.0, 0.0);
            for commanded in [0.0, 1e9, -1e9, f64::NAN] {
                assert!(
                    state.limit(commanded, &mut Faults::default()).abs() <= MOTOR,
                    "{torque} {commanded}"
                );
            }
        }
    }
}
