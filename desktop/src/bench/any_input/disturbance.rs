//! Disturbances of the input of one control period, scaled to the joint, so that no field is always out of range.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use strainwave::Angle;
use strainwave::compensator::tuned::SETTLED_TIME;
use strainwave::compensator::{
    Command, CompensationGains, Directions, Input, JointParams, Sensors, Setpoint, Status,
};

/// One thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Disturbance {
    /// The motor's count is any word, or off by a power of two of counts.
    MotorCount,
    /// Its frame is refused.
    MotorInvalid,
    /// The output's count is any word, or off alike, also where there is no encoder.
    OutputCount,
    /// The output's encoder says nothing, or is refused.
    OutputAbsent,
    /// Any measured torque of the motor.
    MotorTorque,
    /// Any torque at the output, or none.
    Gauge,
    /// Any time since the last step.
    Elapsed,
    /// Any age of the setpoint.
    Age,
    /// An overrun, a drive that is off, a restart, any other bits.
    Status,
    /// Any value of one of the setpoint's derivatives, or of its fraction of a count.
    Derivative,
    /// A setpoint somewhere else.
    Position,
    /// A command of another kind.
    Kind,
    /// Any gains.
    Gains,
    /// Any bits of everything.
    Bits,
}

impl Disturbance {
    /// All of them.
    pub const ALL: [Self; 14] = [
        Self::MotorCount,
        Self::MotorInvalid,
        Self::OutputCount,
        Self::OutputAbsent,
        Self::MotorTorque,
        Self::Gauge,
        Self::Elapsed,
        Self::Age,
        Self::Status,
        Self::Derivative,
        Self::Position,
        Self::Kind,
        Self::Gains,
        Self::Bits,
    ];

    /// Any of them.
    pub fn sample(random: &mut ChaCha8Rng) -> Self {
        Self::ALL[random.random_range(0..Self::ALL.len())]
    }

    /// Disturbs an input of this joint.
    pub fn apply(self, input: &mut Input<f32>, joint: &JointParams<f32>, random: &mut ChaCha8Rng) {
        let sensors = &mut input.sensors;
        match self {
            Self::MotorCount => {
                sensors.motor_encoder = count(sensors.motor_encoder, joint.motor_encoder_bits, random);
            }
            Self::MotorInvalid => input.status = input.status.with(Status::MOTOR_ENCODER_INVALID),
            Self::OutputCount => {
                let before = sensors.output_encoder.unwrap_or(0);
                sensors.output_encoder = Some(count(before, joint.output_encoder_bits, random));
            }
            Self::OutputAbsent if random.random_bool(0.5) => sensors.output_encoder = None,
            Self::OutputAbsent => input.status = input.status.with(Status::OUTPUT_ENCODER_INVALID),
            Self::MotorTorque => sensors.motor_torque = float(joint.limits.motor_torque, random),
            Self::Gauge => {
                let present = random.random_bool(0.8);
                sensors.output_torque = present.then(|| float(joint.limits.output_torque, random));
            }
            Self::Elapsed => {
                let within = joint.dt * random.random_range(0.2..17.0);
                input.elapsed = if random.random_bool(0.7) { within } else { float(joint.dt, random) };
            }
            Self::Age => input.setpoint_age = float(SETTLED_TIME.get() as f32, random),
            Self::Status => input.status = input.status.with(status(random)),
            Self::Derivative => *derivative(setpoint(&mut input.command), random) = float(10.0, random),
            Self::Position => {
                let far = 10f32.powf(random.random_range(-6.0..2.0));
                let setpoint = setpoint(&mut input.command);
                let far = if random.random_bool(0.5) { far } else { -far };
                setpoint.position = setpoint.position.plus(far);
            }
            Self::Kind => input.command = command(joint, random),
            Self::Gains => {
                input.gains = Directions { forward: gains(random), backward: gains(random) };
            }
            Self::Bits => *input = bits(random),
        }
    }
}

/// Any word, or a count that is off by up to a power of two.
fn count(before: u32, bits: u32, random: &mut ChaCha8Rng) -> u32 {
    if random.random_bool(0.2) {
        return random.random();
    }
    let largest = 1u32 << random.random_range(0..bits);
    let difference = random.random_range(0..=largest);
    before.wrapping_add(if random.random_bool(0.5) { difference } else { difference.wrapping_neg() })
        & (u32::MAX >> (32 - bits))
}

/// A number up to twice `size`, one of those that are special, or any bits.
fn float(size: f32, random: &mut ChaCha8Rng) -> f32 {
    const SPECIAL: [f32; 8] =
        [0.0, -0.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN_POSITIVE, 1e-42];
    match random.random_range(0..4) {
        0 | 1 => size * random.random_range(-2.0..2.0),
        2 => SPECIAL[random.random_range(0..SPECIAL.len())],
        _ => f32::from_bits(random.random()),
    }
}

fn status(random: &mut ChaCha8Rng) -> Status {
    match random.random_range(0..20) {
        0..8 => Status::OVERRUN,
        8..16 => Status::DRIVE_OFF,
        // After a restart the drive stays off: rarely, or little else would be seen.
        16 => Status::RESTARTED,
        _ => Status(random.random::<u32>() & !Status::RESTARTED.0),
    }
}

/// The setpoint of a position command, which the command becomes.
fn setpoint(command: &mut Command<f32>) -> &mut Setpoint<f32> {
    if !matches!(command, Command::Position(_)) {
        *command = Command::default();
    }
    match command {
        Command::Position(setpoint) => setpoint,
        Command::Velocity { .. } | Command::Torque(_) => unreachable!("it is a position"),
    }
}

fn derivative<'a>(setpoint: &'a mut Setpoint<f32>, random: &mut ChaCha8Rng) -> &'a mut f32 {
    let Setpoint { position, velocity, acceleration, jerk, snap } = setpoint;
    let places = [&mut position.rest, velocity, acceleration, jerk, snap];
    let place = random.random_range(0..places.len());
    places.into_iter().nth(place).expect("there are so many")
}

fn command(joint: &JointParams<f32>, random: &mut ChaCha8Rng) -> Command<f32> {
    if random.random_bool(0.5) {
        Command::Torque(float(joint.limits.output_torque, random))
    } else {
        Command::Velocity { velocity: float(5.0, random), acceleration: float(50.0, random) }
    }
}

fn gains(random: &mut ChaCha8Rng) -> CompensationGains<f32> {
    let mut gain =
        || if random.random_bool(0.8) { random.random_range(0.0..1.0) } else { float(1.0, random) };
    CompensationGains {
        feedback: gain(),
        inertia: gain(),
        friction: gain(),
        wind_up: gain(),
        kinematic_error: gain(),
        output_feedback: gain(),
        adaptation: gain(),
        ripple: gain(),
    }
}

/// Any bits of every field, of either kind of special number more than there are.
fn bits(random: &mut ChaCha8Rng) -> Input<f32> {
    let command = match random.random_range(0..3) {
        0 => Command::Torque(float(1e3, random)),
        1 => Command::Velocity { velocity: float(1e3, random), acceleration: float(1e3, random) },
        _ => Command::Position(Setpoint {
            position: Angle { counts: random.random(), rest: float(1.0, random) },
            velocity: float(1e3, random),
            acceleration: float(1e3, random),
            jerk: float(1e3, random),
            snap: float(1e3, random),
        }),
    };
    Input {
        sensors: Sensors {
            motor_encoder: random.random(),
            output_encoder: random.random_bool(0.5).then(|| random.random()),
            motor_torque: float(1.0, random),
            output_torque: random.random_bool(0.5).then(|| float(1e3, random)),
        },
        command,
        gains: Directions { forward: gains(random), backward: gains(random) },
        elapsed: float(1e-3, random),
        setpoint_age: float(SETTLED_TIME.get() as f32, random),
        status: status(random),
    }
}
