//! One step's input and output as bytes on the link between firmware and host.
//!
//! Fields in the order of their declaration, little-endian, no padding; f32 as its raw bits, so
//! that NaNs and signed zeros survive; a set of faults as its bits, of which those without a name are
//! ignored; an `Option` as a flag byte (0 absent, 1 present) followed by the value, which is sent as zero and
//! ignored when absent.
//! Any other flag byte makes the whole frame invalid: the two sides do not speak the same frame.

use strainwave::Angle;
use strainwave::compensator::{
    Estimate, EstimateDeviation, Faults, Input, Output, Sensors, Setpoint, Shares,
};

const WORD: usize = 4;
const ANGLE: usize = 8 + WORD;
const OPTION: usize = 1 + WORD;

/// Length of an input frame (bytes): sensors, setpoint, shares.
pub const INPUT_BYTES: usize = (2 * WORD + 2 * OPTION) + (ANGLE + 4 * WORD) + 5 * WORD;
/// Length of an output frame (bytes): torques and reference, estimate, its deviation, faults.
pub const OUTPUT_BYTES: usize = (2 * WORD + ANGLE) + (ANGLE + 6 * WORD) + 7 * WORD + WORD;

/// The bytes of an input.
pub fn encode_input(input: &Input<f32>) -> [u8; INPUT_BYTES] {
    let mut writer = Writer::new();
    writer.u32(input.sensors.motor_encoder);
    writer.option(input.sensors.output_encoder);
    writer.f32(input.sensors.motor_torque);
    writer.option(input.sensors.output_torque.map(f32::to_bits));
    writer.angle(input.setpoint.position);
    writer.f32(input.setpoint.velocity);
    writer.f32(input.setpoint.acceleration);
    writer.f32(input.setpoint.jerk);
    writer.f32(input.setpoint.snap);
    writer.f32(input.shares.feedback);
    writer.f32(input.shares.inertia);
    writer.f32(input.shares.friction);
    writer.f32(input.shares.wind_up);
    writer.f32(input.shares.kinematic_error);
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
    let setpoint = Setpoint {
        position: reader.angle(),
        velocity: reader.f32(),
        acceleration: reader.f32(),
        jerk: reader.f32(),
        snap: reader.f32(),
    };
    let shares = Shares {
        feedback: reader.f32(),
        inertia: reader.f32(),
        friction: reader.f32(),
        wind_up: reader.f32(),
        kinematic_error: reader.f32(),
    };
    Some(Input { sensors, setpoint, shares })
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
}
