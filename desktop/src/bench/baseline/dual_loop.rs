//! The output's loop around a motor-side cascade: the measured output's error, by P, I and D, moves the reference.
//!
//! ```text
//! e     = q(t - T_d) - theta_out                                T_d: by how much the encoder's reading is late
//! e_f   = low pass of e, m_f = low pass of m                    corner f_l
//! z    += I*dt*n,   |z| <= b                                    not while the torque is at its limit, nor in fast moves
//! shift = P*m_f + D*dm_f/dt + z,   |shift| <= b
//! ```
//!
//! m is e and n is e_f. Where the setpoint rests, m is what of e exceeds 1.5 of the encoder's counts, so that its rounding
//! and a count of noise are no torque; and n what of e_f exceeds 0.4 counts: static friction and an integral would answer
//! every change of the last count. b is twice the torsion at the gear's peak torque. In a move faster than a twentieth of
//! the joint's fastest speed z stands still, since what a fast move leaves changes its sign before z could follow. Between
//! two readings e is held. Units: rad at the output, s.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use strainwave::compensator::sense::encoder::{Encoder, EncoderParams, EncoderState};
use strainwave::gear::GearParams;
use strainwave::low_pass::LowPass;
use strainwave::{Angle, Error, Real};

use super::BaselineGains;
use super::Commanded;
use crate::io::gear_file::GearFile;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Half width of the dead zone of a resting output, in counts of its encoder.
const HIDDEN: f64 = 0.4;
/// Rounding and noise of a resting output's reading, in counts.
const NOISE: f64 = 1.5;
/// Fastest setpoint at which z runs, as a fraction of the joint's fastest speed.
const SLOW: f64 = 0.05;
/// b in torsions at peak torque.
const ROOM: f64 = 2.0;

/// The output's loop, and what it remembers.
#[derive(Clone)]
pub(super) struct DualLoop {
    encoder: Encoder,
    encoder_state: EncoderState,
    proportional: f64,
    /// I*dt.
    integral: f64,
    /// D/dt.
    derivative: f64,
    low_pass: LowPass<f64>,
    /// One count (rad).
    count: f64,
    /// b (rad).
    bound: f64,
    /// (rad/s)
    slow: f64,
    /// Setpoints delayed to the reading that they belong to, the newest last; one more than the delay.
    past: VecDeque<Angle<f64>>,
    delay: usize,
    /// e, e_f, m_f and z (rad).
    error: f64,
    filtered: f64,
    beyond_noise: f64,
    summed: f64,
}

impl DualLoop {
    pub fn build(file: &GearFile, gear: &GearParams<f64>, gains: &BaselineGains) -> Result<Self, Error> {
        let bits = file.sensors.output_bits();
        let fastest = file.motor.rotor_speed_limit / f64::from(file.gear.signed_ratio().n()).abs();
        let line = gear.flexspline.line.build()?;
        Ok(Self {
            // A late and slow encoder's next reading may be many periods on.
            encoder: EncoderParams { bits, speed_limit: 2.0 * fastest }
                .build(CONTROL_PERIOD * f64::from(file.sensors.output_encoder_period))?,
            encoder_state: EncoderState::default(),
            proportional: gains.output_proportional,
            integral: gains.output_integral * CONTROL_PERIOD,
            derivative: gains.output_derivative / CONTROL_PERIOD,
            low_pass: LowPass::of_gain(-(-TAU * gains.output_low_pass * CONTROL_PERIOD).exp_m1()),
            count: TAU / 2f64.powi(bits.cast_signed()),
            bound: ROOM * line.torsion(file.gear.peak_torque),
            slow: SLOW * fastest,
            past: VecDeque::new(),
            delay: file.sensors.output_encoder_delay as usize,
            error: 0.0,
            filtered: 0.0,
            beyond_noise: 0.0,
            summed: 0.0,
        })
    }

    /// Shift of the output's setpoint (rad). `raw`: the output's encoder, in a period in which it reads;
    /// `limited`: the last torque was at its limit.
    pub fn step(&mut self, commanded: &Commanded, raw: Option<u32>, limited: bool) -> f64 {
        let then = self.delayed(commanded.position);
        if let Some(raw) = raw {
            let output = self.encoder.step::<f64>(&mut self.encoder_state, raw);
            self.error = then.minus(output.angle);
        }
        let count = if commanded.rests() { self.count } else { 0.0 };
        let before = self.beyond_noise;
        self.low_pass.step(&mut self.filtered, self.error);
        self.low_pass.step(&mut self.beyond_noise, self.error.dead_zone(NOISE * count));
        if !limited && commanded.velocity.abs() <= self.slow {
            self.summed += self.integral * self.filtered.dead_zone(HIDDEN * count);
            self.summed = self.summed.clamp(-self.bound, self.bound);
        }
        let shift = self.proportional * self.beyond_noise
            + self.derivative * (self.beyond_noise - before)
            + self.summed;
        shift.clamp(-self.bound, self.bound)
    }

    /// The setpoint of a reading that arrives now.
    fn delayed(&mut self, position: Angle<f64>) -> Angle<f64> {
        self.past.push_back(position);
        if self.past.len() > self.delay + 1 {
            self.past.pop_front();
        }
        self.past.front().copied().unwrap_or(position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::baseline::Kind;
    use crate::design::joint::firmware_gear_params;

    fn built(file: &GearFile) -> DualLoop {
        let gains = BaselineGains::untuned(file, Kind::B3);
        DualLoop::build(file, &firmware_gear_params(file).unwrap(), &gains).unwrap()
    }

    fn raw(angle: f64) -> u32 {
        Angle::<f64>::from_radians_f64(angle).phase() >> 13
    }

    /// An output that is held off for ever: the shift goes to its bound and comes back at once.
    #[test]
    fn the_integral_is_bounded() {
        let mut held = built(&GearFile::default_gear());
        let shifts: Vec<_> =
            (0..200_000).map(|_| held.step(&Commanded::default(), Some(raw(-1e-2)), false)).collect();
        assert!(shifts.iter().all(|shift| shift.abs() <= held.bound));
        assert_eq!((shifts[199_999], held.summed), (held.bound, held.bound));
        for _ in 0..2000 {
            held.step(&Commanded::default(), Some(raw(1e-2)), false);
        }
        assert!(
            held.summed < held.bound && held.step(&Commanded::default(), Some(raw(1e-2)), false) < held.bound
        );
    }

    #[test]
    fn the_integral_stands_still_at_the_torques_limit_and_in_a_fast_move() {
        let mut held = built(&GearFile::default_gear());
        let fast = Commanded { velocity: 1.0, ..Commanded::default() };
        for _ in 0..1000 {
            held.step(&Commanded::default(), Some(raw(-1e-3)), true);
            held.step(&fast, Some(raw(-1e-3)), false);
        }
        assert_eq!(held.summed, 0.0);
        held.step(&Commanded::default(), Some(raw(-1e-3)), false);
        assert!(held.summed > 0.0);
    }

    /// An error below a count is not integrated at rest; a moving setpoint has no dead zone.
    #[test]
    fn a_fraction_of_a_count_moves_nothing_at_rest() {
        let mut held = built(&GearFile::default_gear());
        let count = TAU / f64::from(1 << 19);
        let shift = |held: &mut DualLoop, fraction: f64, velocity| {
            let commanded = Commanded {
                position: Angle::from_radians(fraction * count),
                velocity,
                ..Commanded::default()
            };
            for _ in 0..2000 {
                held.step(&commanded, Some(0), false);
            }
            held.summed
        };
        assert_eq!(shift(&mut held, 0.39, 0.0), 0.0);
        assert_eq!(held.beyond_noise, 0.0);
        assert!(shift(&mut held, 0.39, 0.01) > 0.0);
    }

    /// A late reading of an output that follows its setpoint shows no error.
    #[test]
    fn a_late_reading_is_compared_with_its_own_setpoint() {
        let mut file = GearFile::default_gear();
        file.sensors.output_encoder_delay = 5;
        let mut late = built(&file);
        for k in 0..1000 {
            let at = |k: i32| 1e-3 * f64::from(k.max(0));
            let position = Angle::from_radians(at(k));
            let commanded = Commanded { position, velocity: 10.0, ..Commanded::default() };
            let shift = late.step(&commanded, (k >= 5).then(|| raw(at(k - 5))), false);
            assert!(shift.abs() < 2e-4, "{k}: {shift}");
        }
    }
}
