//! Commands of position, velocity and torque around one joint, switched while it moves, and faults on the way: every
//! torque is finite, every fault has its name, and no switch makes a step.

use strainwave::Angle;
use strainwave::compensator::schedule;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::tuned::TRANSIENT_TIME;
use strainwave::compensator::{
    Command, CompensationGains, Compensator, Directions, Faults, Input, JointParams, Mode, Output,
    RealTimeGear, Sensors, Setpoint, State,
};
use strainwave::flexspline::Reduced;
use strainwave::gear::{Applied, GearState, Motion};
use strainwave_desktop::GearFile;
use strainwave_desktop::design::joint::joint_params;
use strainwave_desktop::sensor::encoder::encoder_count;

const GAINS: CompensationGains<f32> = CompensationGains::ALL;

/// Periods in a second.
const SECOND: usize = (1.0 / CONTROL_PERIOD) as usize;
const SLOW_PERIODS: usize = schedule::SLOW_PERIODS as usize;

/// Periods of the torque's ramp: what the cascade does after it is its own affair.
const RAMP: usize = 100;

/// A joint that is the model of its controller, and its controller.
struct Joint {
    params: JointParams<f64>,
    gear: RealTimeGear<f64>,
    plant: GearState<f64, (), strainwave::friction::JointFrictionState<f64>, 28>,
    motor: Motion<f64>,
    flange: Motion<f64>,
    compensator: Compensator<f32>,
    state: State<f32>,
    torque: f32,
    gains: Directions<f32>,
}

impl Joint {
    /// At rest, with all functions on.
    fn new() -> Self {
        let file = GearFile::default_gear();
        let params: JointParams<f64> = joint_params(&file).unwrap();
        let reduced = Reduced::build(&params.gear.flexspline, params.gear.rated_torque).unwrap();
        let gear: RealTimeGear<f64> = params.gear.build(reduced, CONTROL_PERIOD).unwrap();
        let compensator = joint_params::<f32>(&file).unwrap().build().unwrap();
        let mut joint = Self {
            plant: gear.rest(),
            gear,
            params,
            motor: Motion::default(),
            flange: Motion::default(),
            state: compensator.rest(),
            compensator,
            torque: 0.0,
            gains: GAINS.into(),
        };
        joint.run(300, |_| Command::default());
        joint
    }

    fn sensors(&self) -> Sensors<f32> {
        let count = |motion: &Motion<f64>, bits| encoder_count(motion.angle, bits);
        Sensors {
            motor_encoder: count(&self.motor, self.params.motor_encoder_bits),
            output_encoder: Some(count(&self.flange, self.params.output_encoder_bits)),
            motor_torque: self.torque,
            ..Sensors::default()
        }
    }

    /// One control period; `change` is what is wrong with its input.
    fn step(&mut self, command: Command<f32>, change: impl Fn(&mut Input<f32>)) -> Output<f32> {
        let mut input = Input { sensors: self.sensors(), command, gains: self.gains, ..Input::default() };
        change(&mut input);
        let output = self.compensator.step(&mut self.state, &input);
        assert!(output.motor_torque.is_finite() && output.feed_forward_torque.is_finite(), "{output:?}");
        self.torque = output.motor_torque;
        let held = f64::from(self.torque);
        let torques =
            self.gear.torques(&mut self.plant, &self.motor, &self.flange, Applied { motor: held, load: 0.0 });
        let inertia = self.params.gear.wave_generator_inertia;
        self.motor.advance((held - torques.wave_generator) / inertia, CONTROL_PERIOD);
        self.flange.advance(self.gear.flange_acceleration(&torques, 0.0), CONTROL_PERIOD);
        output
    }

    fn run(&mut self, periods: usize, command: impl Fn(usize) -> Command<f32>) -> Vec<Output<f32>> {
        (0..periods).map(|k| self.step(command(k), |_| ())).collect()
    }

    /// Largest change of the torque in a period while it is ramped, rounding included.
    fn largest_change(&self) -> f32 {
        (2.0 * self.params.limits.motor_torque * CONTROL_PERIOD / TRANSIENT_TIME.get() * (1.0 + 1e-5)) as f32
    }

    /// Angle of the output (rad).
    fn position(&self) -> f64 {
        self.flange.angle.to_radians()
    }
}

fn hold(position: f64) -> Command<f32> {
    Setpoint { position: Angle::from_radians_f64(position), ..Setpoint::default() }.into()
}

/// At a constant speed (rad/s), from zero on.
fn crawl(speed: f64, k: usize) -> Setpoint<f32> {
    let position = Angle::from_radians_f64(speed * CONTROL_PERIOD * k as f64);
    Setpoint { position, velocity: speed as f32, ..Setpoint::default() }
}

fn velocity(velocity: f32) -> Command<f32> {
    Command::Velocity { velocity, acceleration: 0.0 }
}

/// Largest step of the torque where it is not limited: the protection of the gear may step.
fn largest_step(outputs: &[Output<f32>], before: f32) -> f32 {
    let limited = |output: &Output<f32>| output.faults.contains(Faults::TORQUE_LIMITED);
    let outputs = outputs.iter().map(|output| (output.motor_torque, limited(output)));
    let torques: Vec<_> = std::iter::once((before, false)).chain(outputs).collect();
    let free = torques.windows(2).filter(|pair| !pair[0].1 && !pair[1].1);
    free.map(|pair| (pair[1].0 - pair[0].0).abs()).fold(0.0, f32::max)
}

#[test]
fn a_velocity_goes_on_from_the_reference_that_is_there() {
    let mut joint = Joint::new();
    joint.run(SECOND / 2, |k| crawl(0.1, k).into());
    let from = joint.position();
    let outputs = joint.run(SECOND, |_| velocity(0.25));
    assert!(outputs.iter().all(|output| !output.faults.contains(Faults::SETPOINT_STEP)));
    assert!((joint.position() - from - 0.25).abs() < 1e-3, "{}", joint.position() - from);
    // It takes the speed no faster than the joint can.
    assert!(
        outputs[..2 * SLOW_PERIODS].iter().any(|output| output.faults.contains(Faults::SETPOINT_LIMITED))
    );
    assert!(!outputs[SECOND - 1].faults.contains(Faults::SETPOINT_LIMITED));
}

/// A sine of 110 rad/s^2 for 0.14 s takes more than the gear's peak rating.
#[test]
fn a_move_beyond_the_joint_is_ended_later_without_a_fault_that_switches_off() {
    let mut joint = Joint::new();
    let (largest, duration) = (110.0, 0.14);
    let omega = std::f64::consts::TAU / duration;
    let setpoint = |k: usize| {
        let phase = (omega * CONTROL_PERIOD * k as f64).min(std::f64::consts::TAU);
        let position = largest / (omega * omega) * (phase - phase.sin());
        Setpoint {
            position: Angle::from_radians_f64(position),
            velocity: (largest / omega * (1.0 - phase.cos())) as f32,
            acceleration: (largest * phase.sin()) as f32,
            jerk: if phase < std::f64::consts::TAU { (largest * omega * phase.cos()) as f32 } else { 0.0 },
            ..Setpoint::default()
        }
    };
    let outputs = joint.run(SECOND, |k| setpoint(k).into());
    let end = setpoint(SECOND).position.to_radians();
    assert!(outputs.iter().any(|output| output.faults.contains(Faults::SETPOINT_LIMITED)));
    assert!(outputs.iter().all(|output| output.mode == Mode::Active));
    assert!((joint.position() - end).abs() < 1e-3, "{} {end}", joint.position());
}

/// Friction and inertia of the motor are left to the torque's own: with the friction fed forward the output
/// accelerates as the torque alone would have it, without it by what friction leaves.
#[test]
fn a_torque_accelerates_what_it_should() {
    let accelerate = |friction: f32| {
        let mut joint = Joint::new();
        joint.gains = CompensationGains { friction, ..GAINS }.into();
        joint.run(500, |_| Command::Torque(20.0));
        let from = joint.flange.velocity;
        joint.run(500, |_| Command::Torque(20.0));
        (joint.flange.velocity - from) / (500.0 * CONTROL_PERIOD)
    };
    let gear = Joint::new().params.gear;
    let inertia = gear.flexspline_inertia + gear.wave_generator_inertia * f64::from(gear.ratio).powi(2);
    let (with, without) = (accelerate(1.0), accelerate(0.0));
    assert!((with / (20.0 / inertia) - 1.0).abs() < 0.1, "{with} of {}", 20.0 / inertia);
    assert!(without < 0.8 * with, "{without} {with}");
}

#[test]
fn switching_the_kind_of_command_makes_no_step_in_the_torque() {
    let mut joint = Joint::new();
    joint.run(SECOND / 2, |k| crawl(0.3, k).into());
    let at = joint.position();
    let limit = joint.largest_change();
    let commands = [
        velocity(0.3),
        Command::Torque(30.0),
        velocity(-0.3),
        Command::Torque(-40.0),
        hold(at),
        velocity(0.5),
        hold(at),
    ];
    for command in commands {
        let before = joint.torque;
        let outputs = joint.run(SECOND / 20, |_| command);
        let step = largest_step(&outputs[..100], before);
        assert!(step <= limit, "{command:?}: {step} of {limit}");
    }
}

/// The torque that held a load continues in the cascade's integral.
#[test]
fn the_feedback_takes_the_torque_over() {
    let mut joint = Joint::new();
    joint.run(SECOND / 10, |_| Command::Torque(3.0));
    let (before, at) = (joint.torque, joint.position());
    let after = joint.step(velocity(0.0), |_| ());
    assert!(before.abs() > 0.02, "{before}");
    assert!((after.motor_torque - before).abs() < 0.01 * before.abs(), "{before} {after:?} at {at}");
}

#[test]
fn shares_of_either_direction_cross_over_without_a_step() {
    let mut joint = Joint::new();
    let backward = CompensationGains { inertia: 0.0, friction: 0.0, ripple: 0.0, adaptation: 0.0, ..GAINS };
    joint.gains = Directions { forward: GAINS, backward };
    let mut outputs = Vec::new();
    for k in 0..4000 {
        // From -0.8 to 0.8 rad/s at 4 rad/s^2.
        let time = CONTROL_PERIOD * k as f64;
        let (position, velocity) = (2.0 * time * time - 0.8 * time, (4.0 * time - 0.8) as f32);
        let position = Angle::from_radians_f64(position);
        outputs.push(
            joint.step(
                Setpoint { position, velocity, acceleration: 4.0, ..Setpoint::default() }.into(),
                |_| (),
            ),
        );
    }
    let fed: Vec<f32> = outputs.iter().map(|output| output.feed_forward_torque).collect();
    assert!(fed[500..1000].iter().all(|torque| *torque == 0.0), "backward nothing is fed forward");
    assert!(fed[3999].abs() > 0.01, "{}", fed[3999]);
    let step = fed[500..].windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f32::max);
    // A gain goes from 0 to 1 within 20 ms at the fastest, in a step every 2.4 ms.
    assert!(step <= 0.13 * fed[3999].abs().max(0.05), "{step}");
}

/// Fault of an input: its name, the change of the input, and the faults that stay until a reset.
type Wrong = (&'static str, fn(&mut Input<f32>, usize), Faults);

const WRONG: [Wrong; 4] = [
    ("input not finite", |input, _| input.sensors.motor_torque = f32::NAN, Faults::NONE),
    ("input not finite", |input, _| input.sensors.output_torque = Some(f32::INFINITY), Faults::NONE),
    ("output encoder jump", |input, _| input.sensors.output_encoder = Some(1 << 19), Faults::NONE),
    (
        "output encoder frozen",
        |input, _| input.sensors.output_encoder = Some(1000),
        Faults::OUTPUT_ENCODER_OFF,
    ),
];

#[test]
fn a_fault_falls_back_to_the_cascade_without_a_step() {
    for (name, wrong, left) in WRONG {
        let mut joint = Joint::new();
        let before: Vec<_> = joint.run(SECOND / 2, |k| crawl(0.2, k).into());
        let (last, limit) = (before[SECOND / 2 - 1], joint.largest_change());
        assert!(last.feed_forward_torque.abs() > 0.01, "{last:?}");
        let command = |k: usize| Command::Position(crawl(0.2, SECOND / 2 + k));
        let faulty: Vec<_> =
            (0..SECOND / 5).map(|k| joint.step(command(k), |input| wrong(input, k))).collect();
        let named = faulty.iter().position(|output| output.faults.names().any(|fault| fault == name));
        let named = named.unwrap_or_else(|| panic!("{name}: no output names it"));
        let fallen = &faulty[named..];
        let step =
            largest_step(fallen, if named == 0 { last.motor_torque } else { faulty[named - 1].motor_torque });
        assert!(step <= limit, "{name}: {step} of {limit}");
        // After the ramp: the cascade alone.
        let output = fallen.last().unwrap();
        assert_eq!(output.feed_forward_torque, 0.0, "{name}");
        // Sound again: what is compensated returns, without a step.
        let sound: Vec<_> = (0..SECOND).map(|k| joint.step(command(SECOND / 5 + k), |_| ())).collect();
        assert!(largest_step(&sound[..RAMP], output.motor_torque) <= limit, "{name}");
        let end = sound.last().unwrap();
        assert!(end.feed_forward_torque.abs() > 0.01, "{name}: {end:?}");
        assert_eq!(end.faults, left, "{name}");
    }
}

/// Within what the gear bears, and named.
#[test]
fn a_setpoint_that_jumps_is_chased() {
    let mut joint = Joint::new();
    let from = joint.position();
    let jumped = joint.run(SECOND, |_| hold(from + 0.1));
    assert!(jumped[..SLOW_PERIODS].iter().any(|output| output.faults.contains(Faults::SETPOINT_STEP)));
    assert!(jumped.iter().all(|output| output.mode == Mode::Active));
    let torques = jumped.iter().map(|output| f64::from(output.estimate.transmitted_torque.abs()));
    let largest = torques.fold(0.0, f64::max);
    assert!(largest > 20.0 && largest < joint.params.limits.output_torque, "{largest} N m");
    assert!((joint.position() - from - 0.1).abs() < 1e-4, "{}", joint.position() - from);
    assert_eq!(jumped[SECOND - 1].faults, Faults::NONE);
}

/// Some of them are near enough to be taken, and disagree with the torque.
#[test]
fn an_output_encoder_of_random_counts_is_ignored_until_a_reset() {
    let mut joint = Joint::new();
    joint.run(SECOND / 2, |k| crawl(0.2, k).into());
    let command = |k: usize| Command::Position(crawl(0.2, SECOND / 2 + k));
    for k in 0..SECOND / 5 {
        joint.step(command(k), |input| {
            input.sensors.output_encoder = Some((k as u32 * 99_991) & 0x7_ffff);
        });
    }
    let sound = joint.run(SECOND, |k| command(SECOND / 5 + k));
    let end = sound.last().unwrap();
    assert_eq!((end.mode, end.faults), (Mode::Degraded, Faults::OUTPUT_ENCODER_OFF));
    assert!(end.feed_forward_torque.abs() > 0.01, "{end:?}");
    let at = joint.position();
    joint.compensator.reset(&mut joint.state);
    assert_eq!(joint.run(SECOND / 5, |_| hold(at)).last().unwrap().mode, Mode::Active);
}

#[test]
fn without_the_motors_angle_the_drive_is_off_until_a_reset() {
    let mut joint = Joint::new();
    joint.run(SECOND / 2, |k| crawl(0.2, k).into());
    let command = |k: usize| Command::Position(crawl(0.2, SECOND / 2 + k));
    let lost = |input: &mut Input<f32>| input.sensors.motor_encoder = 1 << 19;
    let faulty: Vec<_> = (0..100).map(|k| joint.step(command(k), lost)).collect();
    let named = faulty.iter().position(|output| output.mode == Mode::Safe).expect("a drive that is off");
    assert!(named < 25, "{named} periods");
    for output in &faulty[named..] {
        assert_eq!((output.motor_torque, output.feed_forward_torque), (0.0, 0.0));
        assert!(output.faults.contains(Faults::MOTOR_ENCODER_LOST));
    }
    let sound = joint.run(SECOND / 10, |k| command(100 + k));
    assert!(sound.iter().all(|output| output.mode == Mode::Safe && output.motor_torque == 0.0));
    joint.compensator.reset(&mut joint.state);
    let at = joint.position();
    let again = joint.run(SECOND / 10, |_| hold(at));
    assert!(again[10..].iter().all(|output| output.mode == Mode::Active), "{:?}", again[10]);
}

/// With the fallback the motor's reference is the ideal gear's, as the cascade alone has it.
#[test]
fn the_fallback_follows_the_ideal_gear() {
    let mut joint = Joint::new();
    let ideal = |k: usize| joint_ratio().to_motor(crawl(0.2, k).position);
    joint.run(1000, |k| crawl(0.2, k).into());
    let sound = joint.step(crawl(0.2, 1000).into(), |_| ());
    assert_ne!(sound.motor_reference, ideal(1000));
    for k in 1001..1300 {
        let output = joint.step(crawl(0.2, k).into(), |input| input.sensors.motor_torque = f32::NAN);
        assert!(k < 1150 || output.motor_reference.minus(ideal(k)).abs() < 1e-6, "{k}: {output:?}");
    }
}

fn joint_ratio() -> strainwave::Ratio {
    GearFile::default_gear().gear.signed_ratio()
}
