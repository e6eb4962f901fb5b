//! What the friction feed-forward must do: help along a motion and through its reversals, and leave a joint at
//! rest alone.

use std::f64::consts::TAU;

use strainwave::Angle;
use strainwave::compensator::feed_forward::{Believed, FeedForward, FeedForwardState};
use strainwave::compensator::{JointParams, RealTimeGear, Setpoint, Shares};
use strainwave::flexspline::Reduced;
use strainwave::gear::{Applied, GearParams, Motion};
use strainwave_desktop::GearFile;
use strainwave_desktop::draw::FRICTION;
use strainwave_desktop::joint::{CONTROL_PERIOD, joint_params};
use strainwave_desktop::scenario::Scenario;

const FRICTION_SHARE: f64 = 0.8;

/// Friction alone.
const SHARES: Shares<f64> = Shares {
    feedback: 0.0,
    inertia: 0.0,
    friction: FRICTION_SHARE,
    wind_up: 0.0,
    kinematic_error: 0.0,
    output_feedback: 0.0,
    adaptation: 0.0,
    ripple: 0.0,
};

fn gear(params: &GearParams<f64>) -> RealTimeGear<f64> {
    let flexspline = Reduced::build(&params.flexspline, params.rated_torque).unwrap();
    params.build(flexspline, CONTROL_PERIOD).unwrap()
}

/// The feed-forward of the default joint.
struct Joint {
    params: JointParams<f64>,
    gear: RealTimeGear<f64>,
    feed_forward: FeedForward<f64>,
    state: FeedForwardState<f64>,
}

impl Joint {
    fn new() -> Self {
        let params: JointParams<f64> = joint_params(&GearFile::default_gear()).unwrap();
        Self {
            gear: gear(&params.gear),
            feed_forward: FeedForward::build(&params.gear, CONTROL_PERIOD).unwrap(),
            state: FeedForwardState::default(),
            params,
        }
    }

    /// Torque for an output angle (rad) and speed (rad/s).
    fn torque(&mut self, position: f64, velocity: f64) -> f64 {
        let setpoint =
            Setpoint { position: Angle::from_radians_f64(position), velocity, ..Setpoint::default() };
        self.feed_forward.step(&self.gear, &mut self.state, &setpoint, &SHARES, &Believed::default()).torque
    }

    /// Levels of both sides at standstill, at the motor (N m).
    fn static_level(&self) -> f64 {
        let [input, output] = [&self.params.gear.input_friction, &self.params.gear.output_friction]
            .map(|side| side.forward.static_level);
        input + output / f64::from(self.params.gear.ratio.abs())
    }
}

/// Half a second of a smooth move over `amplitude` (rad), then rest: angle and speed by step.
fn move_and_rest(amplitude: f64, seconds_of_rest: f64) -> impl Iterator<Item = (f64, f64)> {
    let moving = (0..5000).map(move |k| {
        let phase = TAU * f64::from(k) / 5000.0;
        (amplitude * (phase - phase.sin()) / TAU, amplitude * (1.0 - phase.cos()) / 0.5)
    });
    let rest = (seconds_of_rest / CONTROL_PERIOD) as usize;
    moving.chain(std::iter::repeat_n((amplitude, 0.0), rest))
}

#[test]
fn before_the_first_move_it_feeds_nothing() {
    let mut joint = Joint::new();
    assert!((0..1000).all(|_| joint.torque(0.3, 0.0) == 0.0));
}

/// At rest the torque only falls, from within the share of what static friction holds to nothing.
#[test]
fn at_rest_it_does_not_hunt() {
    for amplitude in [0.5, -0.05, 1e-4, 3e-6] {
        let mut joint = Joint::new();
        let torques: Vec<f64> = move_and_rest(amplitude, 3.0)
            .map(|(position, velocity)| joint.torque(position, velocity))
            .collect();
        // From the second step of rest on: the load that friction sees is that of the step before.
        let (first, rest) = (torques[5002], &torques[5002..]);
        assert!(rest.is_sorted_by(|before, after| after.abs() < before.abs()), "{amplitude}");
        assert!(first.abs() <= FRICTION_SHARE * 1.11 * joint.static_level(), "{amplitude}: {first}");
        assert!(rest.last().is_some_and(|last| last.abs() < 0.01 * first.abs()), "{amplitude}");
    }
}

/// The motor alone pushes a joint whose friction is less than the controller believes, by all that it may be:
/// with the default share and no feedback at all the joint stays within a few presliding lengths, and comes to rest.
#[test]
fn at_rest_it_does_not_drive_a_joint_of_less_friction() {
    let mut joint = Joint::new();
    let mut lighter = joint.params.gear;
    lighter.input_friction.scale(1.0 - FRICTION);
    lighter.output_friction.scale(1.0 - FRICTION);
    let gear = gear(&lighter);
    let (mut state, mut motor, mut flange) = (gear.rest(), Motion::default(), Motion::default());
    let mut torques =
        move_and_rest(0.2, 5.0).map(|(position, velocity)| joint.torque(position, velocity)).skip(5000);
    let (mut angles, mut first) = (Vec::new(), None);
    for held in &mut torques {
        first.get_or_insert(held);
        let applied = Applied { motor: held, load: 0.0 };
        let torques = gear.torques(&mut state, &motor, &flange, applied);
        motor.advance((held - torques.wave_generator) / lighter.wave_generator_inertia, CONTROL_PERIOD);
        flange.advance(gear.flange_acceleration(&torques, 0.0), CONTROL_PERIOD);
        angles.push(motor.angle.to_radians());
    }
    let first = first.unwrap_or_default();
    let farthest = angles.iter().fold(0.0, |farthest: f64, angle| farthest.max(angle.abs()));
    let (late, last) = (angles[40_000], angles[49_999]);
    assert!(first.abs() > 0.5 * FRICTION_SHARE * joint.static_level(), "{first}: nothing was fed forward");
    assert!(farthest < 4.0 * lighter.input_friction.presliding, "{farthest}");
    assert!((last - late).abs() < 1e-5, "{late} {last}");
}

/// Around a slow reversal the joint's friction turns over its presliding: what is fed forward follows it, where
/// the sign of the velocity jumps.
#[test]
fn through_a_reversal_it_follows_presliding() {
    let mut joint = Joint::new();
    let reference = gear(&joint.params.gear);
    let n = f64::from(joint.params.gear.ratio);
    let (mut state, mut missed, mut jumped) = (reference.rest(), 0.0f64, 0.0f64);
    // 0.05 rad at 0.2 Hz, from the second reversal on.
    for k in 0..100_000 {
        let phase = TAU * 0.2 * f64::from(k) * CONTROL_PERIOD;
        let (position, velocity) = (0.05 * phase.sin(), 0.05 * TAU * 0.2 * phase.cos());
        let angle = Angle::from_radians_f64(position);
        let motor = Motion { angle: reference.ratio().undo(angle), velocity: n * velocity };
        let torques = reference.torques(&mut state, &motor, &Motion { angle, velocity }, Applied::default());
        let friction = torques.input_friction + torques.output_friction / n;
        let fed = joint.torque(position, velocity) / FRICTION_SHARE;
        if k > 50_000 {
            let level = [&joint.params.gear.input_friction, &joint.params.gear.output_friction]
                .map(|side| side.forward.coulomb);
            missed = missed.max((fed - friction).abs());
            jumped = jumped.max(((level[0] + level[1] / n.abs()) * (n * velocity).signum() - friction).abs());
        }
    }
    assert!(missed < 0.05 * jumped, "{missed} {jumped}");
}

/// The angle (rad, at the output) by which the sum of the demanded speeds is off the reference, at its largest, over a fast move.
fn speed_missed(shares: &Shares<f64>) -> f64 {
    let mut joint = Joint::new();
    let ratio = f64::from(joint.params.gear.ratio);
    let (mut summed, mut first, mut missed) = (0.0, None, 0.0f64);
    for k in 0..2500 {
        let demand = Scenario::S3.at(f64::from(k) * CONTROL_PERIOD, joint.params.gear.rated_torque);
        let setpoint = Setpoint {
            position: Angle::from_radians_f64(demand.position),
            velocity: demand.velocity,
            acceleration: demand.acceleration,
            jerk: demand.jerk,
            snap: demand.snap,
        };
        let demanded =
            joint.feed_forward.step(&joint.gear, &mut joint.state, &setpoint, shares, &Believed::default());
        let reference = demanded.motor.angle.to_radians() - 0.5 * CONTROL_PERIOD * demanded.motor.velocity;
        missed = missed.max((summed + *first.get_or_insert(reference) - reference).abs());
        summed += CONTROL_PERIOD * demanded.motor.velocity;
    }
    (missed / ratio).abs()
}

/// What the cascade is told of the motor's speed is how fast its reference moves, friction's wind-up included, which is 400 urad
/// here: a speed without it would drag the motor along behind its reference.
#[test]
fn the_speed_is_that_of_the_reference() {
    let missed = speed_missed(&Shares { kinematic_error: 0.0, ..Shares::ALL });
    assert!(missed < 10e-6, "{missed}");
}

/// How far the gear is wound up (rad, at the output) so many periods after a load of `torque` (N m) is believed.
fn wound_up(torque: f64, periods: usize) -> f64 {
    let mut joint = Joint::new();
    let believed = Believed { external_torque: torque, ..Believed::default() };
    let wound = (0..periods).map(|_| {
        let setpoint = Setpoint::default();
        let shares = Shares { kinematic_error: 0.0, ..Shares::ALL };
        joint.feed_forward.step(&joint.gear, &mut joint.state, &setpoint, &shares, &believed).motor.angle
    });
    wound.last().unwrap().to_radians() / f64::from(joint.params.gear.ratio)
}

/// Of 40 N m half is wound up for within 0.6 ms, of what may be noise next to nothing.
#[test]
fn a_load_is_wound_up_for_at_once_and_noise_is_not() {
    let line = joint_params::<f64>(&GearFile::default_gear()).unwrap().gear.flexspline.line.build().unwrap();
    assert!((wound_up(40.0, 20_000) + line.torsion(40.0)).abs() < 1.5e-4);
    assert!(-wound_up(40.0, 6) > 0.5 * line.torsion(40.0), "{}", wound_up(40.0, 6));
    assert!(-wound_up(3.0, 6) < 0.1 * line.torsion(3.0), "{}", wound_up(3.0, 6));
}

/// A load that swings by 20 N m at 50 Hz is a joint that shakes: the motor answers it for 0.15 s and no longer.
#[test]
fn a_joint_that_shakes_is_not_followed() {
    let mut joint = Joint::new();
    let mut answers = (0..4000).map(|k| {
        let external_torque = 20.0 * (TAU * 50.0 * CONTROL_PERIOD * f64::from(k)).sin();
        let believed = Believed { external_torque, ..Believed::default() };
        let setpoint = Setpoint::default();
        let shares = Shares::ALL;
        joint.feed_forward.step(&joint.gear, &mut joint.state, &setpoint, &shares, &believed).yielding.torque
    });
    let mean = |answers: &mut dyn Iterator<Item = f64>| answers.map(f64::abs).sum::<f64>();
    let (first, later) = (mean(&mut answers.by_ref().take(1000)) / 1e3, mean(&mut answers.skip(1000)) / 2e3);
    assert!(first > 0.1, "{first}");
    assert!(later < 0.1 * first, "{first} N m, later {later} N m");
}
