//! One step's input and output as bytes on the link between firmware and host.
//!
//! Fields in the order of their declaration, little-endian, no padding; f32 as its raw bits, so
//! that NaNs and signed zeros survive; a set of faults as its bits, of which those without a name are
//! ignored; an `Option` as a flag byte (0 absent, 1 present) followed by the value, which is sent as zero and
//! ignored when absent.
//! A command is a byte of its kind (0 position, 1 velocity, 2 torque), an angle and four floats, of which those that the
//! kind has not are zero, and ignored: position and its derivatives; velocity, acceleration; torque.
//! Any other flag or kind byte makes the whole frame invalid: the two sides do not speak the same frame.

use strainwave::Angle;
use strainwave::compensator::adaptation::Factors;
use strainwave::compensator::{
    Command, Directions, Estimate, EstimateDeviation, Faults, Input, Output, Sensors, Setpoint, Shares,
};

const WORD: usize = 4;
const ANGLE: usize = 8 + WORD;
const OPTION: usize = 1 + WORD;

const COMMAND: usize = 1 + ANGLE + 4 * WORD;

/// Length of an input frame (bytes): sensors, command, shares forward and backward.
pub const INPUT_BYTES: usize = (2 * WORD + 2 * OPTION) + COMMAND + 2 * 8 * WORD;
/// Length of an output frame (bytes): torques and reference, estimate, its deviation, factors, faults.
pub const OUTPUT_BYTES: usize = (2 * WORD + ANGLE) + (ANGLE + 6 * WORD) + 7 * WORD + 4 * WORD + WORD;

/// The bytes of an input.
pub fn encode_input(input: &Input<f32>) -> [u8; INPUT_BYTES] {
    let mut writer = Writer::new();
    writer.u32(input.sensors.motor_encoder);
    writer.option(input.sensors.output_encoder);
    writer.f32(input.sensors.motor_torque);
    writer.option(input.sensors.output_torque.map(f32::to_bits));
    writer.command(&input.command);
    writer.shares(&input.shares.forward);
    writer.shares(&input.shares.backward);
    writer.bytes
}

/// The input in a frame; `None` when a flag byte is neither 0 nor 1.
pub fn decode_input(frame: &[u8; INPUT_BYTES]) -> Option<Input<f32>> {
    let mut reader = Reader::new(frame);
    let sensors = Sensors {
        motor_encoder: reader.u32(),
        output_encoder: reader.option()?,
        motor_torque: reader.f32(),
        output_torque: reader.option()?.map(f32::from_bits),
    };
    let command = reader.command()?;
    let shares = Directions { forward: reader.shares(), backward: reader.shares() };
    Some(Input { sensors, command, shares })
}

/// The bytes of an output.
pub fn encode_output(output: &Output<f32>) -> [u8; OUTPUT_BYTES] {
    let mut writer = Writer::new();
    writer.f32(output.motor_torque);
    writer.f32(output.feed_forward_torque);
    writer.angle(output.motor_reference);
    writer.angle(output.estimate.output_position);
    writer.f32(output.estimate.output_velocity);
    writer.f32(output.estimate.torsion);
    writer.f32(output.estimate.transmitted_torque);
    writer.f32(output.estimate.input_friction);
    writer.f32(output.estimate.output_friction);
    writer.f32(output.estimate.external_torque);
    writer.f32(output.estimate.deviation.output_position);
    writer.f32(output.estimate.deviation.output_velocity);
    writer.f32(output.estimate.deviation.torsion);
    writer.f32(output.estimate.deviation.transmitted_torque);
    writer.f32(output.estimate.deviation.input_friction);
    writer.f32(output.estimate.deviation.output_friction);
    writer.f32(output.estimate.deviation.external_torque);
    writer.f32(output.factors.inertia);
    writer.f32(output.factors.input_friction);
    writer.f32(output.factors.output_friction);
    writer.f32(output.factors.compliance);
    writer.u32(output.faults.bits());
    writer.bytes
}

/// The output in a frame.
pub fn decode_output(frame: &[u8; OUTPUT_BYTES]) -> Output<f32> {
    let mut reader = Reader::new(frame);
    Output {
        motor_torque: reader.f32(),
        feed_forward_torque: reader.f32(),
        motor_reference: reader.angle(),
        estimate: Estimate {
            output_position: reader.angle(),
            output_velocity: reader.f32(),
            torsion: reader.f32(),
            transmitted_torque: reader.f32(),
            input_friction: reader.f32(),
            output_friction: reader.f32(),
            external_torque: reader.f32(),
            deviation: EstimateDeviation {
                output_position: reader.f32(),
                output_velocity: reader.f32(),
                torsion: reader.f32(),
                transmitted_torque: reader.f32(),
                input_friction: reader.f32(),
                output_friction: reader.f32(),
                external_torque: reader.f32(),
            },
        },
        factors: Factors {
            inertia: reader.f32(),
            input_friction: reader.f32(),
            output_friction: reader.f32(),
            compliance: reader.f32(),
        },
        faults: Faults::from_bits(reader.u32()),
    }
}

/// Fills a frame from its start. What would not fit is lost: the tests hold the lengths to the fields.
struct Writer<const N: usize> {
    bytes: [u8; N],
    length: usize,
}

impl<const N: usize> Writer<N> {
    fn new() -> Self {
        Self { bytes: [0; N], length: 0 }
    }

    fn put<const K: usize>(&mut self, value: [u8; K]) {
        for (slot, byte) in self.bytes.iter_mut().skip(self.length).zip(value) {
            *slot = byte;
        }
        self.length += K;
    }

    fn u32(&mut self, value: u32) {
        self.put(value.to_le_bytes());
    }

    fn f32(&mut self, value: f32) {
        self.u32(value.to_bits());
    }

    fn option(&mut self, value: Option<u32>) {
        self.put([u8::from(value.is_some())]);
        self.u32(value.unwrap_or(0));
    }

    fn angle(&mut self, value: Angle<f32>) {
        self.put(value.counts.to_le_bytes());
        self.f32(value.rest);
    }

    fn command(&mut self, command: &Command<f32>) {
        let (kind, setpoint) = match *command {
            Command::Position(setpoint) => (0, setpoint),
            Command::Velocity { velocity, acceleration } => {
                (1, Setpoint { velocity, acceleration, ..Setpoint::default() })
            }
            Command::Torque(torque) => (2, Setpoint { velocity: torque, ..Setpoint::default() }),
        };
        self.put([kind]);
        self.angle(setpoint.position);
        self.f32(setpoint.velocity);
        self.f32(setpoint.acceleration);
        self.f32(setpoint.jerk);
        self.f32(setpoint.snap);
    }

    fn shares(&mut self, shares: &Shares<f32>) {
        self.f32(shares.feedback);
        self.f32(shares.inertia);
        self.f32(shares.friction);
        self.f32(shares.wind_up);
        self.f32(shares.kinematic_error);
        self.f32(shares.output_feedback);
        self.f32(shares.adaptation);
        self.f32(shares.ripple);
    }
}

/// Reads a frame from its start. Past the end there are zeros.
struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    fn new(frame: &'a [u8]) -> Self {
        Self { rest: frame }
    }

    fn take<const K: usize>(&mut self) -> [u8; K] {
        let (value, rest) = self.rest.split_first_chunk().unwrap_or((&[0; K], &[]));
        self.rest = rest;
        *value
    }

    fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    fn f32(&mut self) -> f32 {
        f32::from_bits(self.u32())
    }

    fn option(&mut self) -> Option<Option<u32>> {
        let [flag] = self.take();
        let value = self.u32();
        match flag {
            0 => Some(None),
            1 => Some(Some(value)),
            _ => None,
        }
    }

    fn angle(&mut self) -> Angle<f32> {
        let counts = i64::from_le_bytes(self.take());
        Angle { counts, rest: self.f32() }
    }

    fn command(&mut self) -> Option<Command<f32>> {
        let [kind] = self.take();
        let setpoint = Setpoint {
            position: self.angle(),
            velocity: self.f32(),
            acceleration: self.f32(),
            jerk: self.f32(),
            snap: self.f32(),
        };
        let Setpoint { velocity, acceleration, .. } = setpoint;
        match kind {
            0 => Some(Command::Position(setpoint)),
            1 => Some(Command::Velocity { velocity, acceleration }),
            2 => Some(Command::Torque(velocity)),
            _ => None,
        }
    }

    fn shares(&mut self) -> Shares<f32> {
        Shares {
            feedback: self.f32(),
            inertia: self.f32(),
            friction: self.f32(),
            wind_up: self.f32(),
            kinematic_error: self.f32(),
            output_feedback: self.f32(),
            adaptation: self.f32(),
            ripple: self.f32(),
        }
    }
}
