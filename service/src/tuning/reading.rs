//! Quantities of one control period, each with its name and unit.

use serde::{Deserialize, Serialize};
use strainwave::Angle;
use strainwave::compensator::{Faults, Mode, Output};

/// Lists the floats of an output once: name, unit, value.
macro_rules! quantities {
    ($output:ident: $($name:literal $unit:literal $value:expr;)*) => {
        /// Names and units of the floats of a reading.
        pub const QUANTITIES: &[(&str, &str)] = &[$(($name, $unit)),*];

        /// The floats of an output.
        fn floats($output: &Output<f32>) -> [f32; QUANTITIES.len()] {
            [$($value),*]
        }
    };
}

quantities! { output:
    "motor_torque" "nm" output.motor_torque;
    "feed_forward_torque" "nm" output.feed_forward_torque;
    "output_velocity" "rad_s" output.estimate.output_velocity;
    "torsion" "rad" output.estimate.torsion;
    "transmitted_torque" "nm" output.estimate.transmitted_torque;
    "input_friction" "nm" output.estimate.input_friction;
    "output_friction" "nm" output.estimate.output_friction;
    "external_torque" "nm" output.estimate.external_torque;
    "output_position_deviation" "rad" output.estimate.deviation.output_position;
    "output_velocity_deviation" "rad_s" output.estimate.deviation.output_velocity;
    "torsion_deviation" "rad" output.estimate.deviation.torsion;
    "transmitted_torque_deviation" "nm" output.estimate.deviation.transmitted_torque;
    "input_friction_deviation" "nm" output.estimate.deviation.input_friction;
    "output_friction_deviation" "nm" output.estimate.deviation.output_friction;
    "external_torque_deviation" "nm" output.estimate.deviation.external_torque;
    "inertia_factor" "1" output.factors.inertia;
    "input_friction_factor" "1" output.factors.input_friction;
    "output_friction_factor" "1" output.factors.output_friction;
    "compliance_factor" "1" output.factors.compliance;
    "presliding_factor" "1" output.factors.presliding;
    "presliding_stiffness_factor" "1" output.factors.presliding_stiffness;
}

/// An angle: counts of 2^32 a revolution, and what is left of one (rad).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Turned(#[serde(with = "postcard::fixint::le")] i64, f32);

impl Turned {
    fn of(angle: Angle<f32>) -> Self {
        Self(angle.counts, angle.rest)
    }

    fn angle(self) -> Angle<f32> {
        Angle { counts: self.0, rest: self.1 }
    }
}

/// Quantities of one control period.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// Control periods since start-up.
    #[serde(with = "postcard::fixint::le")]
    pub period: u32,
    /// Readings of the stream that were left out so far, for the transport was too slow.
    #[serde(with = "postcard::fixint::le")]
    pub left_out: u32,
    #[serde(with = "postcard::fixint::le")]
    faults: u32,
    mode: u8,
    motor_reference: Turned,
    output_position: Turned,
    floats: [f32; QUANTITIES.len()],
}

impl Reading {
    /// The quantities of a step.
    pub fn new(period: u32, output: &Output<f32>) -> Self {
        Self {
            period,
            left_out: 0,
            faults: output.faults.bits(),
            mode: output.mode.code() as u8,
            motor_reference: Turned::of(output.motor_reference),
            output_position: Turned::of(output.estimate.output_position),
            floats: floats(output),
        }
    }

    /// The same with this many readings left out before it.
    #[must_use]
    pub fn with_left_out(self, left_out: u32) -> Self {
        Self { left_out, ..self }
    }

    /// Its faults.
    pub fn faults(&self) -> Faults {
        Faults::from_bits(self.faults)
    }

    /// Its mode.
    pub fn mode(&self) -> Mode {
        Mode::of_code(u32::from(self.mode))
    }

    /// Reference of the motor.
    pub fn motor_reference(&self) -> Angle<f32> {
        self.motor_reference.angle()
    }

    /// Estimated angle of the output.
    pub fn output_position(&self) -> Angle<f32> {
        self.output_position.angle()
    }

    /// The floats, in the order of [`QUANTITIES`].
    pub fn floats(&self) -> &[f32] {
        &self.floats
    }
}
