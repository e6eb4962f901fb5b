//! Requirements of the friction feed-forward: help along a motion and through its reversals, and leave a joint at
//! rest alone.

use std::f64::consts::TAU;

use strainwave::Angle;
use strainwave::compensator::adapt::parameters::Factors;
use strainwave::compensator::reference::feed_forward::{
    Demand, FeedForward, FeedForwardState, ModelCorrection,
};
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::schedule::SLOW_PERIODS;
use strainwave::compensator::tuned::LIMIT_TO_LIMIT;
use strainwave::compensator::{CompensationGains, JointParams, RealTimeGear, Setpoint};
use strainwave::flexspline::Reduced;
use strainwave::gear::{Applied, GearParams, Motion};
use strainwave::hysteresis::torsion::TorsionHysteresisState;
use strainwave_desktop::GearFile;
use strainwave_desktop::bench::scenario::Scenario;
use strainwave_desktop::design::capability::Capability;
use strainwave_desktop::design::joint::joint_params;
use strainwave_desktop::plant::box_sample::FRICTION;

const FRICTION_SHARE: f64 = 0.8;

/// A round (s): with one slot of the feed-forward.
const DT: f64 = SLOW_PERIODS as f64 * CONTROL_PERIOD;

/// Rounds in half a second.
const HALF: usize = (0.5 / DT) as usize;

/// Friction alone.
const GAINS: CompensationGains<f64> = CompensationGains {
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
    params.build(flexspline, DT).unwrap()
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

    /// One round: the demand, and the slots of the models later in the round.
    fn demand(&mut self, setpoint: &Setpoint<f64>, gains: &CompensationGains<f64>) -> Demand<f64> {
        let correction = ModelCorrection::default();
        let demand = self.feed_forward.step(&self.gear, &mut self.state, setpoint, gains, &correction);
        let reference = demand.motor.angle.plus(0.5 * DT * demand.motor.velocity);
        self.step_models(reference);
        demand
    }

    /// The slots of the models with the motor's reference at `reference`.
    fn step_models(&mut self, reference: Angle<f64>) {
        self.feed_forward.step_torsion(&self.gear, &mut self.state, &Factors::default());
        self.feed_forward.step_models(&self.gear, &mut self.state, reference, &Factors::default());
    }

    /// Torque for an output angle (rad) and speed (rad/s).
    fn torque(&mut self, position: f64, velocity: f64) -> f64 {
        let setpoint =
            Setpoint { position: Angle::from_radians_f64(position), velocity, ..Setpoint::default() };
        self.demand(&setpoint, &GAINS).torque
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
    let moving = (0..HALF).map(move |k| {
        let phase = TAU * k as f64 / HALF as f64;
        (amplitude * (phase - phase.sin()) / TAU, amplitude * (1.0 - phase.cos()) / 0.5)
    });
    let rest = (seconds_of_rest / DT) as usize;
    moving.chain(std::iter::repeat_n((amplitude, 0.0), rest))
}

/// With loops of any width that has an inverse: a load that is held gives one torsion, in balance with line and
/// hysteresis, whatever the loads were before.
#[test]
fn a_held_load_gives_one_torsion() {
    for width in [1.0, 2.0, 3.0] {
        let mut joint = Joint::new();
        let mut params = joint.params.gear;
        params.hysteresis_width *= width;
        params.hysteresis_table = None;
        joint.gear = gear(&params);
        let mut hysteresis = TorsionHysteresisState::default();
        for torque in [20.0, 12.0, 12.5, 12.4, -15.0, -14.9, 3.0] {
            let correction = ModelCorrection { load: -torque, ..ModelCorrection::default() };
            let mut torsions = [0.0; 60];
            for torsion in &mut torsions {
                let setpoint = Setpoint::default();
                let demand = joint.feed_forward.step(
                    &joint.gear,
                    &mut joint.state,
                    &setpoint,
                    &CompensationGains { kinematic_error: 0.0, ..CompensationGains::ALL },
                    &correction,
                );
                joint.step_models(demand.motor.angle);
                *torsion = demand.link_offset;
            }
            let [.., before, last] = torsions;
            assert!((last - before).abs() < 1e-9, "{width}, {torque} N m: {before}, {last}");
            for torsion in torsions {
                joint.gear.hysteresis().step(&mut hysteresis, torsion);
            }
            let on_line = torque - joint.gear.hysteresis().torque(&hysteresis);
            let balanced = joint.gear.flexspline().torsion(on_line);
            assert!((last - balanced).abs() < 2e-8, "{width}, {torque} N m: {last}, {balanced}");
        }
    }
}

#[test]
fn before_the_first_move_it_feeds_nothing() {
    let mut joint = Joint::new();
    assert!((0..1000).all(|_| joint.torque(0.3, 0.0) == 0.0));
}

/// At rest the torque only falls, from at most the friction gain times static friction to nothing.
#[test]
fn at_rest_it_does_not_hunt() {
    for amplitude in [0.5, -0.05, 1e-4, 3e-6] {
        let mut joint = Joint::new();
        let torques: Vec<f64> = move_and_rest(amplitude, 3.0)
            .map(|(position, velocity)| joint.torque(position, velocity))
            .collect();
        // From the second step of rest on: the load that friction sees is that of the step before.
        let (first, rest) = (torques[HALF + 2], &torques[HALF + 2..]);
        assert!(rest.is_sorted_by(|before, after| after.abs() < before.abs()), "{amplitude}");
        assert!(first.abs() <= FRICTION_SHARE * 1.11 * joint.static_level(), "{amplitude}: {first}");
        assert!(rest.last().is_some_and(|last| last.abs() < 0.01 * first.abs()), "{amplitude}");
    }
}

/// The motor alone pushes a joint whose friction is less than the controller assumes, by all that it may be:
/// with the default friction gain and no feedback at all the joint stays within a few presliding lengths, and comes to rest.
#[test]
fn at_rest_it_does_not_drive_a_joint_of_less_friction() {
    let mut joint = Joint::new();
    let mut lighter = joint.params.gear;
    lighter.input_friction.scale(1.0 - FRICTION);
    lighter.output_friction.scale(1.0 - FRICTION);
    let gear = gear(&lighter);
    let (mut state, mut motor, mut flange) = (gear.rest(), Motion::default(), Motion::default());
    let mut torques =
        move_and_rest(0.2, 5.0).map(|(position, velocity)| joint.torque(position, velocity)).skip(HALF);
    let (mut angles, mut first) = (Vec::new(), None);
    for held in &mut torques {
        first.get_or_insert(held);
        let applied = Applied { motor: held, load: 0.0 };
        let torques = gear.torques(&mut state, &motor, &flange, applied);
        motor.advance((held - torques.wave_generator) / lighter.wave_generator_inertia, DT);
        flange.advance(gear.flange_acceleration(&torques, 0.0), DT);
        angles.push(motor.angle.to_radians());
    }
    let first = first.unwrap_or_default();
    let farthest = angles.iter().fold(0.0, |farthest: f64, angle| farthest.max(angle.abs()));
    let (late, last) = (angles[8 * HALF], angles[10 * HALF - 1]);
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
    let (mut state, mut residual, mut jumped) = (reference.rest(), 0.0f64, 0.0f64);
    // 0.05 rad at 0.2 Hz, from the second reversal on.
    for k in 0..20 * HALF {
        let phase = TAU * 0.2 * k as f64 * DT;
        let (position, velocity) = (0.05 * phase.sin(), 0.05 * TAU * 0.2 * phase.cos());
        let angle = Angle::from_radians_f64(position);
        let motor = Motion { angle: reference.ratio().to_motor(angle), velocity: n * velocity };
        let torques = reference.torques(&mut state, &motor, &Motion { angle, velocity }, Applied::default());
        let friction = torques.input_friction + torques.output_friction / n;
        let fed = joint.torque(position, velocity) / FRICTION_SHARE;
        if k > 10 * HALF {
            let level = [&joint.params.gear.input_friction, &joint.params.gear.output_friction]
                .map(|side| side.forward.coulomb);
            residual = residual.max((fed - friction).abs());
            jumped = jumped.max(((level[0] + level[1] / n.abs()) * (n * velocity).signum() - friction).abs());
        }
    }
    assert!(residual < 0.05 * jumped, "{residual} {jumped}");
}

/// The setpoint of S3 after so many rounds.
fn fast_move(round: usize) -> Setpoint<f64> {
    let demand = Scenario::S3.at(round as f64 * DT, &Capability::default());
    Setpoint {
        position: Angle::from_radians_f64(demand.position),
        velocity: demand.velocity,
        acceleration: demand.acceleration,
        jerk: demand.jerk,
        snap: demand.snap,
    }
}

/// The inverse of the gear: ends that move as demanded wind it up to the torque that the load takes, and the motor
/// bears what the flexspline, the kinematic error's lever and its friction make of it, up to the flexspline's dashpot,
/// which takes 0.2 N m where the setpoint slows down. The lever takes up to 8 mN m there.
#[test]
fn a_gear_that_moves_as_demanded_carries_the_load() {
    let mut joint = Joint::new();
    let model = gear(&joint.params.gear);
    let (inertia, rotor) = (joint.params.gear.flexspline_inertia, joint.params.gear.wave_generator_inertia);
    let mut state = model.rest();
    let last = HALF / 2;
    // Up to where the torsion passes a knee of the line.
    for k in 0..last * 37 / 40 {
        let setpoint = fast_move(k);
        let demanded = joint.demand(&setpoint, &CompensationGains::ALL);
        let flange = Motion { angle: setpoint.position, velocity: setpoint.velocity };
        let torques = model.torques(&mut state, &demanded.motor, &flange, Applied::default());
        if k < last * 17 / 20 {
            continue;
        }
        let needed = inertia * setpoint.acceleration + torques.output_friction;
        let residual = torques.transmitted - needed;
        assert!(residual.abs() < 0.3, "{k}: {residual} of {needed} N m");
        let short = rotor * demanded.acceleration + torques.wave_generator - demanded.torque;
        println!("{k} {residual} {short}");
        assert!(short.abs() < 2e-3, "{k}: {short} of {} N m", demanded.torque);
    }
}

/// The angle (rad, at the output) by which the sum of the demanded speeds is off the reference, at its largest, over
/// a fast move.
fn speed_residual(gains: &CompensationGains<f64>) -> f64 {
    let mut joint = Joint::new();
    let ratio = f64::from(joint.params.gear.ratio);
    let (mut summed, mut first, mut residual) = (0.0, None, 0.0f64);
    for k in 0..HALF / 2 {
        let setpoint = fast_move(k);
        let demanded = joint.demand(&setpoint, gains);
        let reference = demanded.motor.angle.to_radians() - 0.5 * DT * demanded.motor.velocity;
        residual = residual.max((summed + *first.get_or_insert(reference) - reference).abs());
        summed += DT * demanded.motor.velocity;
    }
    (residual / ratio).abs()
}

/// The speed that is passed to the cascade is that of the motor's reference, friction's wind-up included, which
/// is 400 urad here, to a tenth of it: the slope of the hysteresis is that of the round before. A speed without it would
/// drag the motor along behind its reference.
#[test]
fn the_speed_is_that_of_the_reference() {
    let residual = speed_residual(&CompensationGains { kinematic_error: 0.0, ..CompensationGains::ALL });
    assert!(residual < 40e-6, "{residual}");
}

/// Largest torque (N m) and offset of the reference (rad at the output) for the kinematic error, at a steady speed of the motor (rad/s).
fn for_kinematic_error(joint: &mut Joint, speed: f64) -> [f64; 2] {
    let ratio = 1.0 / f64::from(joint.params.gear.ratio);
    let gains = CompensationGains { inertia: 1.0, friction: 0.0, kinematic_error: 1.0, ..GAINS };
    let mut largest = [0.0f64; 2];
    for k in 0..4 * HALF {
        let velocity = ratio * speed;
        let position = Angle::from_radians_f64(velocity * DT * k as f64);
        let demand = joint.demand(&Setpoint { position, velocity, ..Setpoint::default() }, &gains);
        if k > HALF {
            largest[0] = largest[0].max(demand.torque.abs());
            largest[1] = largest[1].max(demand.link_offset.abs());
        }
    }
    largest
}

/// The torque for it grows with the speed's square up to 1/sqrt(3) of the motor's peak torque, and no further; a slow motor compensates it
/// whole.
#[test]
fn the_kinematic_error_takes_no_more_torque_than_a_wave_between_the_limits() {
    let mut joint = Joint::new();
    let gear = joint.params.gear;
    let curvature = gear.kinematic_error.curvature(1.0 / f64::from(gear.ratio)) * f64::from(gear.ratio).abs();
    let full = 100.0;
    let most = gear.wave_generator_inertia * curvature * full * full;
    joint.feed_forward = joint.feed_forward.with_motor(&gear, most / LIMIT_TO_LIMIT);
    let [slow_torque, whole] = for_kinematic_error(&mut joint, 0.5 * full);
    assert!((0.2..=0.26).contains(&(slow_torque / most)), "{slow_torque} of {most}");
    for times in [1.0, 2.0, 4.0] {
        let [torque, offset] = for_kinematic_error(&mut joint, times * full);
        assert!((0.8..1.02).contains(&(torque / most)), "{times}: {torque} of {most}");
        assert!((offset * times * times / whole - 1.0).abs() < 0.05, "{times}: {offset} of {whole}");
    }
}

/// A gear without a kinematic error, or a motor that no speed of it is too fast for, changes nothing.
#[test]
fn a_strong_motor_compensates_the_kinematic_error_at_any_speed() {
    let mut joint = Joint::new();
    let whole = for_kinematic_error(&mut joint, 400.0);
    joint.feed_forward = joint.feed_forward.with_motor(&joint.params.gear, 1e9);
    assert_eq!(for_kinematic_error(&mut joint, 400.0), whole);
    joint.params.gear.kinematic_error = Default::default();
    let without = joint.feed_forward.with_motor(&joint.params.gear, 1.0);
    assert_eq!(without, joint.feed_forward.with_motor(&joint.params.gear, 2.0));
}
