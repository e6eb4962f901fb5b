//! The drive: how a torque command becomes a torque on the motor's shaft.
//!
//! ```text
//! u(t)       = limited command, late by T_d                        piecewise constant
//! d tau_i/dt = omega_c*(u - tau_i)                                 current loop of first order, omega_c = 2*pi*f_c
//! tau_shaft  = c*tau_i + tau_0                                     c: torque constant over the nominal one
//! ```
//!
//! tau_i is what the drive measures, in torque of the nominal constant. Units: N m, s, Hz.
//!
//! Discretisation: exact. Over a micro-step the shaft has the mean of tau_i under the mean of u, so that a command that
//! comes within a micro-step acts for the rest of it. Without delay and with an infinite f_c that is the command, bit for
//! bit.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Drive: from torque command to torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveParams {
    /// T_d (control periods).
    pub delay: f64,
    /// f_c (Hz); infinite for none.
    pub bandwidth: f64,
    /// Largest torque that it gives, by the nominal constant (N m).
    pub limit: f64,
    /// c.
    pub torque_constant: f64,
    /// tau_0 (N m).
    pub offset: f64,
}

impl DriveParams {
    /// Command is torque.
    pub const IDEAL: Self = Self {
        delay: 0.0,
        bandwidth: f64::INFINITY,
        limit: f64::INFINITY,
        torque_constant: 1.0,
        offset: 0.0,
    };
}

/// A drive that is stepped by micro-steps.
#[derive(Clone, Debug)]
pub(super) struct Drive {
    params: DriveParams,
    /// T_d in micro-steps.
    delay: f64,
    /// e^(-omega_c*dt), and the mean of that decay over a micro-step.
    kept: f64,
    kept_mean: f64,
    /// Delayed commands: in how many micro-steps, how much (N m).
    coming: VecDeque<(f64, f64)>,
    /// u (N m).
    command: f64,
    /// tau_i at the end of the micro-step (N m).
    torque: f64,
}

impl Drive {
    /// In micro-steps of `dt` (s).
    pub(super) fn new(params: &DriveParams, dt: f64) -> Self {
        let decay = TAU * params.bandwidth * dt;
        Self {
            params: *params,
            delay: params.delay * CONTROL_PERIOD / dt,
            kept: (-decay).exp(),
            kept_mean: -(-decay).exp_m1() / decay,
            coming: VecDeque::with_capacity(8),
            command: 0.0,
            torque: 0.0,
        }
    }

    /// A command (N m), given `after` so many micro-steps, less than 1.
    pub(super) fn command(&mut self, torque: f64, after: f64) {
        let limit = self.params.limit;
        self.coming.push_back((self.delay + after, torque.clamp(-limit, limit)));
    }

    /// All commands are forgotten: a brake holds, and no current flows.
    pub(super) fn rest(&mut self) {
        self.coming.clear();
        (self.command, self.torque) = (0.0, 0.0);
    }

    /// Mean torque on the shaft over the next micro-step (N m).
    pub(super) fn step(&mut self) -> f64 {
        let target = self.mean_command();
        let difference = self.torque - target;
        self.torque = target + self.kept * difference;
        self.params.torque_constant * (target + self.kept_mean * difference) + self.params.offset
    }

    /// Mean of u over the next micro-step (N m).
    fn mean_command(&mut self) -> f64 {
        let (mut sum, mut from) = (0.0, 0.0);
        while let Some(&(due, torque)) = self.coming.front().filter(|(due, _)| *due < 1.0) {
            sum += self.command * (due - from);
            (self.command, from) = (torque, due);
            self.coming.pop_front();
        }
        for (due, _) in &mut self.coming {
            *due -= 1.0;
        }
        sum + self.command * (1.0 - from)
    }

    /// tau_i (N m).
    pub(super) fn measured(&self) -> f64 {
        self.torque
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = CONTROL_PERIOD / 4.0;

    #[test]
    fn an_ideal_drive_gives_the_command_bit_for_bit() {
        let mut drive = Drive::new(&DriveParams::IDEAL, DT);
        for torque in [0.1, -2.3e-7, 1.0 / 3.0, 2.4] {
            drive.command(torque, 0.0);
            assert_eq!([drive.step(), drive.step(), drive.measured()], [torque; 3]);
        }
    }

    #[test]
    fn a_late_drive_gives_it_late_to_a_part_of_a_micro_step() {
        let mut drive = Drive::new(&DriveParams { delay: 0.6, ..DriveParams::IDEAL }, DT);
        drive.command(1.0, 0.0);
        let torques = [(); 4].map(|()| drive.step());
        let target = [0.0, 0.0, 0.6, 1.0];
        assert!(torques.iter().zip(target).all(|(a, b)| (a - b).abs() < 1e-12), "{torques:?}");
        let mut drive = Drive::new(&DriveParams::IDEAL, DT);
        drive.command(1.0, 0.25);
        assert_eq!([drive.step(), drive.step()], [0.75, 1.0]);
    }

    /// Of a step the shaft has 1 - e^-1 after 1/omega_c.
    #[test]
    fn a_current_loop_is_a_lag_of_first_order() {
        let mut drive = Drive::new(&DriveParams { bandwidth: 1000.0, ..DriveParams::IDEAL }, DT);
        drive.command(1.0, 0.0);
        let mut impulse = 0.0;
        for k in 1..40 {
            impulse += drive.step() * DT;
            let (time, corner) = (f64::from(k) * DT, TAU * 1000.0);
            assert!((drive.measured() - (1.0 - (-corner * time).exp())).abs() < 1e-12);
            assert!((impulse - (time - drive.measured() / corner)).abs() < 1e-12);
        }
    }

    #[test]
    fn constant_offset_and_limit_are_where_the_drive_does_not_see_them_and_does() {
        let params = DriveParams { limit: 1.0, torque_constant: 1.1, offset: 0.01, ..DriveParams::IDEAL };
        let mut drive = Drive::new(&params, DT);
        drive.command(-3.0, 0.0);
        assert!((drive.step() + 1.09).abs() < 1e-15);
        assert_eq!(drive.measured(), -1.0);
        drive.rest();
        assert_eq!((drive.measured(), drive.step()), (0.0, 0.01));
    }
}
