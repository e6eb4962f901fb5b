//! The motor-side cascade that every baseline has: P position loop over PI velocity loop on the motor's encoder.
//!
//! ```text
//! k_p = 2*pi*f_p,  k_v = 2*pi*f_v*J,  J = J_wg + r^2*J_fs,  omega_f = F*2*pi*f_v
//! ```
//!
//! The velocity loop sees the rotor and the reflected load as one inertia J; F is the speed filter's factor. The law is
//! [`strainwave::compensator::feedback`], with its conditional anti-windup. Units: rad, N m at the motor's shaft.

use std::f64::consts::TAU;

use strainwave::compensator::actuate::cascade::{
    CascadeInput, Feedback, FeedbackParams, FeedbackState, Stiffness,
};
use strainwave::compensator::sense::encoder::{Encoder, EncoderParams, EncoderState, Reading};
use strainwave::{Angle, Error};

use super::BaselineGains;
use crate::io::gear_file::GearFile;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Encoder and cascade, and what they remember.
#[derive(Clone)]
pub(super) struct Cascade {
    encoder: Encoder,
    encoder_state: EncoderState,
    feedback: Feedback<f64>,
    state: FeedbackState<f64>,
    torque_limit: f64,
    limited: bool,
}

/// Angle of the motor, and its speed since the reading before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motor {
    pub angle: Angle<f64>,
    /// (rad/s)
    pub speed: f64,
}

/// Reference of the motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Demand {
    /// Reference angle.
    pub angle: Angle<f64>,
    /// (rad/s)
    pub velocity: f64,
    /// As far as it is known (rad/s^2).
    pub acceleration: f64,
    /// Fed forward (N m).
    pub torque: f64,
}

/// The cascade's gains.
pub(super) fn feedback_params(file: &GearFile, gains: &BaselineGains) -> FeedbackParams<f64> {
    let r: f64 = file.gear.signed_ratio().value();
    let inertia = file.inertia.wave_generator + r * r * file.inertia.flexspline;
    FeedbackParams {
        position_gain: TAU * gains.position_bandwidth,
        velocity_gain: TAU * gains.velocity_bandwidth * inertia,
        integral_time: gains.integral_time,
        filter_corner: gains.speed_filter_factor * TAU * gains.velocity_bandwidth,
        torque_limit: file.motor.peak_torque,
    }
}

impl Cascade {
    pub fn build(file: &GearFile, gains: &BaselineGains) -> Result<Self, Error> {
        let speed_limit = 2.0 * file.motor.rotor_speed_limit;
        Ok(Self {
            encoder: EncoderParams { bits: file.sensors.motor_encoder_bits, speed_limit }
                .build(CONTROL_PERIOD)?,
            encoder_state: EncoderState::default(),
            feedback: feedback_params(file, gains).build(CONTROL_PERIOD)?,
            state: FeedbackState::default(),
            torque_limit: file.motor.peak_torque,
            limited: false,
        })
    }

    /// The motor's encoder says `raw`, `elapsed` (s) after the reading before, 0 where that is not measured.
    pub fn read(&mut self, raw: u32, elapsed: f32) -> Motor {
        let Reading { angle, moved, .. } = self.encoder.step::<f64>(&mut self.encoder_state, raw);
        let elapsed = if elapsed > 0.0 { f64::from(elapsed) } else { CONTROL_PERIOD };
        Motor { angle, speed: moved / elapsed }
    }

    /// The last torque was at the limit.
    pub fn limited(&self) -> bool {
        self.limited
    }

    /// Torque for the motor (N m), within its limit.
    pub fn step(&mut self, motor: &Motor, demand: &Demand) -> f64 {
        let input = CascadeInput {
            position_error: demand.angle.minus(motor.angle),
            velocity: demand.velocity,
            acceleration: demand.acceleration,
        };
        let feedback =
            self.feedback.step(&mut self.state, motor.speed, &input, Stiffness::FULL, self.limited);
        let expected = feedback + demand.torque;
        let torque = expected.clamp(-self.torque_limit, self.torque_limit);
        self.limited = torque != expected;
        torque
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::baseline::Kind;
    use crate::design::feedback;

    /// Untuned, a baseline has the compensator's own cascade, to the bit.
    #[test]
    fn the_rule_is_the_compensators_own_cascade() {
        let mut file = GearFile::default_gear();
        file.baselines = None;
        let gains = BaselineGains::of(&file, Kind::B0);
        assert_eq!(feedback_params(&file, &gains), feedback::feedback_params(&file));
    }

    /// After a missed step the speed is what it was.
    #[test]
    fn a_missed_step_is_no_speed() {
        let file = GearFile::default_gear();
        let mut cascade = Cascade::build(&file, &BaselineGains::of(&file, Kind::B0)).unwrap();
        let speeds = [(0, 0.0), (100, 1e-4), (300, 2e-4), (400, 0.0), (450, 5e-5)]
            .map(|(raw, elapsed)| cascade.read(raw, elapsed).speed);
        assert_eq!(speeds[0], 0.0);
        assert!(speeds[1..].iter().all(|speed| (speed / speeds[1] - 1.0).abs() < 1e-6), "{speeds:?}");
    }

    #[test]
    fn the_torque_stays_within_its_limit() {
        let file = GearFile::default_gear();
        let mut cascade = Cascade::build(&file, &BaselineGains::of(&file, Kind::B0)).unwrap();
        let motor = cascade.read(0, 0.0);
        let demand = Demand { angle: Angle::from_radians(100.0), ..Demand::default() };
        assert_eq!((cascade.step(&motor, &demand), cascade.limited()), (file.motor.peak_torque, true));
        let back = Demand { angle: motor.angle, ..Demand::default() };
        assert!(cascade.step(&motor, &back) < file.motor.peak_torque && !cascade.limited());
    }
}
