//! The joint that a corner of the box is, linear.
//!
//! ```text
//! J_wg*dw_m  = c*tau_i - B_in*w_m - S_in*theta_m - r*tau_t           tau_t = K*phi + C*dphi,  phi = r*theta_m - theta_fs
//! J_r*dw_fs  = tau_t - B_out*w_fs - S_out*theta_fs + k*delta + e*ddelta            delta = theta_l - theta_fs
//! J_l*dw_l   = -k*delta - e*ddelta
//! dtau_i     = w_c*(u(t - T_d) - tau_i)
//! ```
//!
//! c: torque constant over the file's; S: friction about rest as springs, 0 where it slides; J_l, k, e: a part of the
//! load behind a mode. Frequency response: analytic, times the hold of a control period, (1 - e^(-s dt))/(s dt); poles: exact
//! discretisation of the held input (matrix exponential), T_d in whole periods. Units: rad, N m, s.

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix};

use super::controller::bristle_stiffness;
use super::corners::Corner;
use crate::io::gear_file::GearFile;
use strainwave::compensator::schedule::CONTROL_PERIOD;

type C64 = Complex<f64>;

/// theta_m, theta_o, tau_measured, tau_t.
pub const OUTPUTS: usize = 4;

/// A linear joint.
#[derive(Clone, Copy, Debug)]
pub struct Plant {
    ratio: f64,
    motor_inertia: f64,
    /// Rigid with the flange, and behind the mode.
    load_inertias: [f64; 2],
    stiffness: f64,
    damping: f64,
    viscous: [f64; 2],
    springs: [f64; 2],
    /// k and e.
    link: [f64; 2],
    constant: f64,
    lag: f64,
    delay: usize,
}

impl Plant {
    /// The joint of a gear file in a corner.
    pub fn new(file: &GearFile, corner: &Corner) -> Self {
        let sides = [&file.friction.input, &file.friction.output];
        let load = corner.load * file.inertia.flexspline;
        let (fraction, link) = corner.link.map_or((0.0, [0.0; 2]), |(fraction, frequency)| {
            let (inertia, omega) = (fraction * load, TAU * frequency);
            (fraction, [inertia * omega * omega, 2.0 * super::corners::LINK_DAMPING * omega * inertia])
        });
        Self {
            ratio: file.gear.signed_ratio().value(),
            motor_inertia: corner.rotor * file.inertia.wave_generator,
            load_inertias: [(1.0 - fraction) * load, fraction * load],
            stiffness: corner.stiffness * corner.point.stiffness(file),
            damping: 2.0
                * file.damping.torsion_mode_ratio
                * (file.stiffness.k1 * file.inertia.flexspline).sqrt(),
            viscous: sides.map(|side| side.viscous.unwrap_or_default()),
            springs: sides
                .map(|side| corner.presliding.map_or(0.0, |factor| bristle_stiffness(side) / factor)),
            link,
            constant: corner.constant,
            lag: TAU * corner.bandwidth,
            delay: corner.delay,
        }
    }

    /// Of the torque command, at w (rad/s).
    pub fn at(&self, omega: f64) -> [C64; OUTPUTS] {
        let (s, dt, r) = (C64::new(0.0, omega), CONTROL_PERIOD, self.ratio);
        let lag = if self.lag.is_finite() { self.lag / (s + self.lag) } else { C64::new(1.0, 0.0) };
        let hold = (1.0 - (-s * dt).exp()) / (s * dt);
        let torque = hold * lag * (-s * dt * self.delay as f64).exp();
        let spring = self.stiffness + self.damping * s;
        let [rigid, behind] = self.load_inertias;
        let mut flange = rigid * s * s + self.viscous[1] * s + self.springs[1];
        if behind > 0.0 {
            let link = self.link[0] + self.link[1] * s;
            flange += link - link * link / (behind * s * s + link);
        }
        let motor = self.motor_inertia * s * s + self.viscous[0] * s + self.springs[0];
        // The flange's angle over the motor's.
        let follows = r * spring / (flange + spring);
        let angle = self.constant * torque / (motor + r * spring * (r - follows));
        [angle, follows * angle, torque, spring * (r - follows) * angle]
    }

    /// States: both angles and speeds, link, drive, and the delayed commands.
    pub fn states(&self) -> usize {
        7 + self.delay
    }

    /// One control period: x, u to the next x.
    pub fn discrete(&self) -> DMatrix<f64> {
        let (r, [rigid, behind]) = (self.ratio, self.load_inertias);
        let mut a = DMatrix::zeros(8, 8);
        a[(0, 1)] = 1.0;
        a[(2, 3)] = 1.0;
        a[(4, 5)] = 1.0;
        let tau = self.transmitted();
        for (column, tau) in tau.into_iter().enumerate() {
            a[(1, column)] -= r * tau / self.motor_inertia;
            a[(3, column)] += tau / rigid;
        }
        a[(1, 0)] -= self.springs[0] / self.motor_inertia;
        a[(1, 1)] -= self.viscous[0] / self.motor_inertia;
        a[(3, 2)] -= self.springs[1] / rigid;
        a[(3, 3)] -= self.viscous[1] / rigid;
        if behind > 0.0 {
            for (row, by) in [(3, 1.0 / rigid), (5, -1.0 / behind)] {
                for (column, gain) in
                    [(4, self.link[0]), (2, -self.link[0]), (5, self.link[1]), (3, -self.link[1])]
                {
                    a[(row, column)] += by * gain;
                }
            }
        } else {
            // No link: its states fade.
            a[(4, 5)] = 0.0;
            (a[(4, 4)], a[(5, 5)]) = (-1e3, -1e3);
        }
        let lag = if self.lag.is_finite() { self.lag } else { 1e6 };
        a[(1, 6)] = self.constant / self.motor_inertia;
        (a[(6, 6)], a[(6, 7)]) = (-lag, lag);
        (a * CONTROL_PERIOD).exp()
    }

    /// tau_t of the first four states.
    pub fn transmitted(&self) -> [f64; 4] {
        [self.stiffness * self.ratio, self.damping * self.ratio, -self.stiffness, -self.damping]
    }

    /// Moves the states on by one period under a command.
    pub fn step(&self, discrete: &DMatrix<f64>, x: &mut [f64], command: f64) {
        let applied = if self.delay == 0 { command } else { x[7] };
        let mut next = [0.0; 7];
        for (row, next) in next.iter_mut().enumerate() {
            *next = (0..7).map(|k| discrete[(row, k)] * x[k]).sum::<f64>() + discrete[(row, 7)] * applied;
        }
        x[..7].copy_from_slice(&next);
        if self.delay > 0 {
            x.copy_within(8.., 7);
            x[6 + self.delay] = command;
        }
    }

    /// Readings of the sensors for a state.
    pub fn read(&self, x: &[f64]) -> [f64; OUTPUTS] {
        let transmitted = self.transmitted().iter().zip(x).map(|(gain, x)| gain * x).sum();
        [x[0], x[2], x[6], transmitted]
    }
}
