//! The frames of the emulator link transmit every bit of every field, both ways.

use proptest::array;
use proptest::prelude::*;
use strainwave::Angle;
use strainwave::compensator::adapt::parameters::Factors;
use strainwave::compensator::{
    Command, CompensationGains, Directions, Estimate, EstimateDeviation, Faults, Input, Mode, Output,
    Sensors, Setpoint, Status,
};
use strainwave_app::frame::{
    INPUT_BYTES, OUTPUT_BYTES, decode_input, decode_output, encode_input, encode_output,
};

/// Offsets of the two flag bytes in an input frame.
const OUTPUT_ENCODER_FLAG: usize = 4;
const OUTPUT_TORQUE_FLAG: usize = 13;
/// Offset of the byte that says which kind the command is.
const COMMAND_KIND: usize = 18;
/// Length of the command behind it: an angle and four floats.
const COMMAND: usize = 12 + 16;

fn input_of(words: [u32; 28], counts: i64, flags: [bool; 2], kind: u8) -> Input<f32> {
    let f = |k: usize| f32::from_bits(words[k]);
    let gains = |k: usize| CompensationGains {
        feedback: f(k),
        inertia: f(k + 1),
        friction: f(k + 2),
        wind_up: f(k + 3),
        kinematic_error: f(k + 4),
        output_feedback: f(k + 5),
        adaptation: f(k + 6),
        ripple: f(k + 7),
    };
    Input {
        sensors: Sensors {
            motor_encoder: words[0],
            output_encoder: flags[0].then_some(words[1]),
            motor_torque: f(2),
            output_torque: flags[1].then_some(f(3)),
        },
        command: match kind {
            0 => Command::Position(Setpoint {
                position: Angle { counts, rest: f(4) },
                velocity: f(5),
                acceleration: f(6),
                jerk: f(7),
                snap: f(8),
            }),
            1 => Command::Velocity { velocity: f(5), acceleration: f(6) },
            _ => Command::Torque(f(5)),
        },
        gains: Directions { forward: gains(9), backward: gains(17) },
        elapsed: f(25),
        setpoint_age: f(26),
        status: Status(words[27]),
    }
}

fn output_of(words: [u32; 24], counts: [i64; 2]) -> Output<f32> {
    let f = |k: usize| f32::from_bits(words[k]);
    Output {
        motor_torque: f(0),
        feed_forward_torque: f(1),
        motor_reference: Angle { counts: counts[0], rest: f(2) },
        estimate: Estimate {
            output_position: Angle { counts: counts[1], rest: f(3) },
            output_velocity: f(4),
            torsion: f(5),
            transmitted_torque: f(6),
            input_friction: f(7),
            output_friction: f(8),
            external_torque: f(9),
            deviation: EstimateDeviation {
                output_position: f(10),
                output_velocity: f(11),
                torsion: f(12),
                transmitted_torque: f(13),
                input_friction: f(14),
                output_friction: f(15),
                external_torque: f(16),
            },
        },
        factors: Factors {
            inertia: f(17),
            input_friction: f(18),
            output_friction: f(19),
            compliance: f(20),
            presliding: f(21),
            presliding_stiffness: f(22),
        },
        observed: counts[0] & 1 == 1,
        faults: Faults::from_bits(words[23]),
        mode: Mode::of_code(words[23] >> 30),
    }
}

/// Every bit of a value, NaN payloads too, as its `Debug` text cannot show them.
fn input_bits(input: &Input<f32>) -> Vec<u64> {
    let Input { sensors, command, gains, elapsed, setpoint_age, status } = input;
    let bits = |x: f32| u64::from(x.to_bits());
    let some = |x: Option<u32>| x.map_or(u64::MAX, u64::from);
    let mut all = vec![
        u64::from(sensors.motor_encoder),
        some(sensors.output_encoder),
        bits(sensors.motor_torque),
        some(sensors.output_torque.map(f32::to_bits)),
        bits(*elapsed),
        bits(*setpoint_age),
        u64::from(status.0),
    ];
    match command {
        Command::Position(Setpoint { position, velocity, acceleration, jerk, snap }) => {
            all.extend([0, position.counts.cast_unsigned()]);
            all.extend([position.rest, *velocity, *acceleration, *jerk, *snap].map(bits));
        }
        Command::Velocity { velocity, acceleration } => all.extend([1, bits(*velocity), bits(*acceleration)]),
        Command::Torque(torque) => all.extend([2, bits(*torque)]),
    }
    for gains in [&gains.forward, &gains.backward] {
        let CompensationGains {
            feedback,
            inertia,
            friction,
            wind_up,
            kinematic_error,
            output_feedback,
            adaptation,
            ripple,
        } = *gains;
        all.extend([feedback, inertia, friction, wind_up].map(bits));
        all.extend([kinematic_error, output_feedback, adaptation, ripple].map(bits));
    }
    all
}

fn output_bits(output: &Output<f32>) -> Vec<u64> {
    let estimate = &output.estimate;
    let bits = |x: f32| u64::from(x.to_bits());
    vec![
        bits(output.motor_torque),
        u64::from(output.observed),
        bits(output.factors.inertia),
        bits(output.factors.input_friction),
        bits(output.factors.output_friction),
        bits(output.factors.compliance),
        bits(output.factors.presliding),
        bits(output.factors.presliding_stiffness),
        bits(output.feed_forward_torque),
        output.motor_reference.counts.cast_unsigned(),
        bits(output.motor_reference.rest),
        estimate.output_position.counts.cast_unsigned(),
        bits(estimate.output_position.rest),
        bits(estimate.output_velocity),
        bits(estimate.torsion),
        bits(estimate.transmitted_torque),
        bits(estimate.input_friction),
        bits(estimate.output_friction),
        bits(estimate.external_torque),
        bits(estimate.deviation.output_position),
        bits(estimate.deviation.output_velocity),
        bits(estimate.deviation.torsion),
        bits(estimate.deviation.transmitted_torque),
        bits(estimate.deviation.input_friction),
        bits(estimate.deviation.output_friction),
        bits(estimate.deviation.external_torque),
        u64::from(output.faults.bits()),
        u64::from(output.mode.code()),
    ]
}

fn input_frame(seed: &[u8]) -> [u8; INPUT_BYTES] {
    seed.try_into().expect("the strategy makes frames of this length")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn an_input_survives_the_frame(
        words in array::uniform28(any::<u32>()),
        counts: i64,
        flags: [bool; 2],
        kind in 0..3u8,
    ) {
        let input = input_of(words, counts, flags, kind);
        let back = decode_input(&encode_input(&input)).expect("a valid frame");
        prop_assert_eq!(input_bits(&back), input_bits(&input));
    }

    #[test]
    fn an_output_survives_the_frame(words in array::uniform24(any::<u32>()), counts: [i64; 2]) {
        let output = output_of(words, counts);
        prop_assert_eq!(output_bits(&decode_output(&encode_output(&output))), output_bits(&output));
    }

    #[test]
    fn an_output_frame_survives_the_output(bytes in prop::collection::vec(any::<u8>(), OUTPUT_BYTES)) {
        let frame: [u8; OUTPUT_BYTES] = bytes.try_into().expect("the strategy's length");
        let mut expected = frame;
        let word = u32::from_le_bytes(frame[OUTPUT_BYTES - 4..].try_into().expect("four bytes"));
        // Mode and whether the estimate is of this step.
        let named = Faults::from_bits(word).bits() | word & 0b111 << 29;
        expected[OUTPUT_BYTES - 4..].copy_from_slice(&named.to_le_bytes());
        prop_assert_eq!(encode_output(&decode_output(&frame)), expected);
    }

    #[test]
    fn an_input_frame_survives_the_input(
        bytes in prop::collection::vec(any::<u8>(), INPUT_BYTES),
        flags: [bool; 2],
        kind in 0..3u8,
    ) {
        let mut frame = input_frame(&bytes);
        frame[COMMAND_KIND] = kind;
        // Velocity and acceleration, or torque, lie behind the angle.
        let (from, to) = [(0, 0), (20, 12), (16, 12)][usize::from(kind)];
        if kind > 0 {
            frame[COMMAND_KIND + 1..][..to].fill(0);
            frame[COMMAND_KIND + 1..][from..COMMAND].fill(0);
        }
        for (at, present) in [(OUTPUT_ENCODER_FLAG, flags[0]), (OUTPUT_TORQUE_FLAG, flags[1])] {
            frame[at] = u8::from(present);
            if !present {
                frame[at + 1..at + 5].fill(0);
            }
        }
        let input = decode_input(&frame).expect("flags and kind are valid");
        prop_assert_eq!(encode_input(&input), frame);
    }

    #[test]
    fn any_other_flag_invalidates_the_frame(
        bytes in prop::collection::vec(any::<u8>(), INPUT_BYTES),
        flag in 3u8..,
        at in prop::sample::select(&[OUTPUT_ENCODER_FLAG, OUTPUT_TORQUE_FLAG, COMMAND_KIND][..]),
    ) {
        let mut frame = input_frame(&bytes);
        (frame[OUTPUT_ENCODER_FLAG], frame[OUTPUT_TORQUE_FLAG], frame[COMMAND_KIND]) = (1, 0, 2);
        prop_assert!(decode_input(&frame).is_some());
        frame[at] = flag;
        prop_assert!(decode_input(&frame).is_none());
    }
}

#[test]
fn fields_are_little_endian_in_the_order_of_their_declaration() {
    let words = std::array::from_fn(|k| 0x0403_0200 + k as u32);
    let frame = encode_input(&input_of(words, -2, [true, false], 0));
    assert_eq!(frame[..9], [0, 2, 3, 4, 1, 1, 2, 3, 4]);
    assert_eq!(frame[OUTPUT_TORQUE_FLAG..18], [0, 0, 0, 0, 0]);
    assert_eq!(frame[COMMAND_KIND], 0);
    assert_eq!(frame[19..27], [0xfe, 255, 255, 255, 255, 255, 255, 255]);
    assert_eq!(frame[INPUT_BYTES - 4..], [27, 2, 3, 4]);
}
