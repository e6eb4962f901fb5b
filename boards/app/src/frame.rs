//! One step's input and output as bytes on the link between firmware and host.
//!
//! Fields in the order of their declaration, little-endian, no padding; f32 as its raw bits, so that NaNs and signed
//! zeros survive; a set of faults as its bits, of which those without a name are ignored but the highest: the
//! estimate is of this step; an `Option` as a flag byte (0 absent, 1 present) followed by the value, which is sent as
//! zero and ignored when absent. A command is a byte of its kind (0 position, 1 velocity, 2 torque), an angle and
//! four floats, of which those that the kind has not are zero, and ignored: position and its derivatives; velocity,
//! acceleration; torque. Any other flag or kind byte makes the whole frame invalid: the two sides do not speak the
//! same frame.
//!
//! The fields are listed once: [`Fields`] goes through them, whether it writes a frame, reads one or has other plans.

use strainwave::Angle;
use strainwave::compensator::adapt::parameters::Factors;
use strainwave::compensator::{
    Command, CompensationGains, Estimate, EstimateDeviation, Faults, Input, Mode, Output, Sensors, Setpoint,
};

const WORD: usize = 4;
const ANGLE: usize = 8 + WORD;
const OPTION: usize = 1 + WORD;

const COMMAND: usize = 1 + ANGLE + 4 * WORD;

/// Length of an input frame (bytes): sensors, command, gains forward and backward, elapsed time, setpoint's age,
/// status.
pub const INPUT_BYTES: usize = (2 * WORD + 2 * OPTION) + COMMAND + 2 * 8 * WORD + 3 * WORD;
/// Length of an output frame (bytes): torques and reference, estimate, its deviation, factors, faults.
pub const OUTPUT_BYTES: usize = (2 * WORD + ANGLE) + (ANGLE + 6 * WORD) + 7 * WORD + 6 * WORD + WORD;

/// Position of the mode in the faults' word, two bits.
const MODE_BIT: u32 = 29;
/// Position of the bit in the faults' word that the estimate is of this step.
const OBSERVED_BIT: u32 = 31;

/// The bytes of an input.
pub fn encode_input(input: &Input<f32>) -> [u8; INPUT_BYTES] {
    let mut frame = [0; INPUT_BYTES];
    // An input that there is has a valid frame.
    let _ = Writer { rest: &mut frame }.input(&mut { *input });
    frame
}

/// The input in a frame; `None` when a flag or kind byte is not one of its values.
pub fn decode_input(frame: &[u8; INPUT_BYTES]) -> Option<Input<f32>> {
    let mut input = Input::default();
    read_input(frame, &mut input).then_some(input)
}

/// Reads a frame into an input, without a copy of it on the stack; false when a flag or kind byte is not one of its values.
#[inline]
pub fn read_input(frame: &[u8; INPUT_BYTES], input: &mut Input<f32>) -> bool {
    Reader { rest: frame }.input(input).is_some()
}

/// The bytes of an output.
pub fn encode_output(output: &Output<f32>) -> [u8; OUTPUT_BYTES] {
    let mut frame = [0; OUTPUT_BYTES];
    write_output(&mut frame, &mut { *output });
    frame
}

/// Writes an output, which stays as it is, into a frame: without a copy of either on the stack.
#[inline]
pub fn write_output(frame: &mut [u8; OUTPUT_BYTES], output: &mut Output<f32>) {
    Writer { rest: frame }.output(output);
}

/// The output in a frame.
pub fn decode_output(frame: &[u8; OUTPUT_BYTES]) -> Output<f32> {
    let mut output = Output::default();
    Reader { rest: frame }.output(&mut output);
    output
}

/// Goes through the fields of a frame in their order, and may change what it comes to.
pub trait Fields {
    /// Bytes of a field.
    fn bytes<const K: usize>(&mut self, bytes: &mut [u8; K]);

    /// A word. Not inlined, for size: a frame has some fifty.
    #[inline(never)]
    fn u32(&mut self, value: &mut u32) {
        let mut bytes = value.to_le_bytes();
        self.bytes(&mut bytes);
        *value = u32::from_le_bytes(bytes);
    }

    /// A float.
    fn f32(&mut self, value: &mut f32) {
        let mut bits = value.to_bits();
        self.u32(&mut bits);
        *value = f32::from_bits(bits);
    }

    /// Floats.
    fn f32s<const K: usize>(&mut self, values: [&mut f32; K]) {
        for value in values {
            self.f32(value);
        }
    }

    /// A word that may be absent; `None` when the flag is neither 0 nor 1.
    fn option(&mut self, value: &mut Option<u32>) -> Option<()> {
        let (mut flag, mut word) = ([u8::from(value.is_some())], value.unwrap_or(0));
        self.bytes(&mut flag);
        self.u32(&mut word);
        *value = match flag {
            [0] => None,
            [1] => Some(word),
            _ => return None,
        };
        Some(())
    }

    /// An angle.
    fn angle(&mut self, angle: &mut Angle<f32>) {
        let mut counts = angle.counts.to_le_bytes();
        self.bytes(&mut counts);
        angle.counts = i64::from_le_bytes(counts);
        self.f32(&mut angle.rest);
    }

    /// An input; `None` when it is not valid.
    fn input(&mut self, input: &mut Input<f32>) -> Option<()> {
        self.sensors(&mut input.sensors)?;
        self.command(&mut input.command)?;
        self.gains(&mut input.gains.forward);
        self.gains(&mut input.gains.backward);
        self.f32s([&mut input.elapsed, &mut input.setpoint_age]);
        self.u32(&mut input.status.0);
        Some(())
    }

    /// Sensors; `None` when a flag is not valid.
    fn sensors(&mut self, sensors: &mut Sensors<f32>) -> Option<()> {
        let Sensors { motor_encoder, output_encoder, motor_torque, output_torque } = sensors;
        let mut output_torque_bits = output_torque.map(f32::to_bits);
        self.u32(motor_encoder);
        self.option(output_encoder)?;
        self.f32(motor_torque);
        self.option(&mut output_torque_bits)?;
        *output_torque = output_torque_bits.map(f32::from_bits);
        Some(())
    }

    /// A command; `None` when it is of no kind.
    fn command(&mut self, command: &mut Command<f32>) -> Option<()> {
        let (kind, mut setpoint) = parts(command);
        let mut kind = [kind];
        self.bytes(&mut kind);
        let Setpoint { position, velocity, acceleration, jerk, snap } = &mut setpoint;
        self.angle(position);
        self.f32s([velocity, acceleration, jerk, snap]);
        *command = of_parts(kind[0], setpoint)?;
        Some(())
    }

    /// Gains of one direction.
    fn gains(&mut self, gains: &mut CompensationGains<f32>) {
        let CompensationGains { feedback, inertia, friction, wind_up, .. } = gains;
        self.f32s([feedback, inertia, friction, wind_up]);
        let CompensationGains { kinematic_error, output_feedback, adaptation, ripple, .. } = gains;
        self.f32s([kinematic_error, output_feedback, adaptation, ripple]);
    }

    /// An output.
    fn output(&mut self, output: &mut Output<f32>) {
        let Output { motor_torque, feed_forward_torque, motor_reference, estimate, .. } = output;
        self.f32s([motor_torque, feed_forward_torque]);
        self.angle(motor_reference);
        self.estimate(estimate);
        let Output { observed, factors, faults, mode, .. } = output;
        let Factors { inertia, input_friction, output_friction, compliance, .. } = factors;
        self.f32s([inertia, input_friction, output_friction, compliance]);
        let Factors { presliding, presliding_stiffness, .. } = factors;
        self.f32s([presliding, presliding_stiffness]);
        let mut bits = faults.bits() | mode.code() << MODE_BIT | u32::from(*observed) << OBSERVED_BIT;
        self.u32(&mut bits);
        *faults = Faults::from_bits(bits);
        *mode = Mode::of_code(bits >> MODE_BIT & 3);
        *observed = bits >> OBSERVED_BIT != 0;
    }

    /// An estimate with its deviation.
    fn estimate(&mut self, estimate: &mut Estimate<f32>) {
        let Estimate { output_position, output_velocity, torsion, transmitted_torque, .. } = estimate;
        self.angle(output_position);
        self.f32s([output_velocity, torsion, transmitted_torque]);
        let Estimate { input_friction, output_friction, external_torque, deviation, .. } = estimate;
        self.f32s([input_friction, output_friction, external_torque]);
        let EstimateDeviation { output_position, output_velocity, torsion, transmitted_torque, .. } =
            deviation;
        self.f32s([output_position, output_velocity, torsion, transmitted_torque]);
        let EstimateDeviation { input_friction, output_friction, external_torque, .. } = deviation;
        self.f32s([input_friction, output_friction, external_torque]);
    }
}

/// Kind of a command, and what it has of a setpoint; a torque stands in the place of the velocity.
fn parts(command: &Command<f32>) -> (u8, Setpoint<f32>) {
    match *command {
        Command::Position(setpoint) => (0, setpoint),
        Command::Velocity { velocity, acceleration } => {
            (1, Setpoint { velocity, acceleration, ..Setpoint::default() })
        }
        Command::Torque(torque) => (2, Setpoint { velocity: torque, ..Setpoint::default() }),
    }
}

/// The command of these parts; `None` when there is no such kind.
fn of_parts(kind: u8, setpoint: Setpoint<f32>) -> Option<Command<f32>> {
    let Setpoint { velocity, acceleration, .. } = setpoint;
    match kind {
        0 => Some(Command::Position(setpoint)),
        1 => Some(Command::Velocity { velocity, acceleration }),
        2 => Some(Command::Torque(velocity)),
        _ => None,
    }
}

/// Fills a frame from its start. What would not fit is lost: the tests hold the lengths to the fields.
struct Writer<'a> {
    rest: &'a mut [u8],
}

impl Fields for Writer<'_> {
    fn bytes<const K: usize>(&mut self, bytes: &mut [u8; K]) {
        if let Some((place, rest)) = core::mem::take(&mut self.rest).split_first_chunk_mut() {
            *place = *bytes;
            self.rest = rest;
        }
    }
}

/// Reads a frame from its start. Past the end there are zeros.
struct Reader<'a> {
    rest: &'a [u8],
}

impl Fields for Reader<'_> {
    fn bytes<const K: usize>(&mut self, bytes: &mut [u8; K]) {
        let (value, rest) = self.rest.split_first_chunk().unwrap_or((&[0; K], &[]));
        self.rest = rest;
        *bytes = *value;
    }
}
