//! Every key of a sensor file, with what it may hold.

use std::f64::consts::PI;

use crate::io::keyed_file::key::{Allowed, Key, Schema, joined, key, optional, positive, within};

const PHASE: Allowed = within(-PI, PI, "rad");
const SCALE: Allowed = within(0.0, 0.1, "rad");
const DELAY: Allowed = within(0.0, 0.1, "s");
const BANDWIDTH: Allowed = within(0.1, 1e7, "Hz");
const GAIN: Allowed = within(-0.9, 9.0, "1");
const TIME: Allowed = within(1e-3, 1e8, "s");

/// Keys of an encoder; the names are put together at compile time.
macro_rules! encoder {
    ($section:literal) => {
        [
            key(concat!($section, ".bits"), Allowed::Whole(4, 32)),
            optional(concat!($section, ".eccentricity_rad"), SCALE),
            optional(concat!($section, ".eccentricity_phase_rad"), PHASE),
            optional(concat!($section, ".tilt_rad"), SCALE),
            optional(concat!($section, ".tilt_phase_rad"), PHASE),
            optional(concat!($section, ".interpolation_rad"), SCALE),
            optional(concat!($section, ".interpolation_phase_rad"), PHASE),
            optional(concat!($section, ".signal_periods"), Allowed::Whole(1, 1 << 20)),
            optional(concat!($section, ".noise_counts"), within(0.0, 1e6, "counts")),
            optional(concat!($section, ".delay_s"), DELAY),
            optional(concat!($section, ".jitter_s"), DELAY),
            optional(concat!($section, ".update_periods"), Allowed::Whole(1, 1000)),
        ]
    };
}

const MOTOR: [Key; 12] = encoder!("motor_encoder");
const OUTPUT: [Key; 12] = encoder!("output_encoder");

const HEAD: [Key; 2] =
    [key("sensor_set.name", Allowed::Text), optional("sensor_set.seed", Allowed::Whole(0, i64::MAX))];

const ANALOGUE: [Key; 36] = [
    optional("torque_sensor.sensitivity_error", GAIN),
    optional("torque_sensor.zero_nm", within(-1e5, 1e5, "N m")),
    optional("torque_sensor.zero_drift_nm", within(0.0, 1e5, "N m")),
    optional("torque_sensor.zero_drift_time_s", TIME),
    optional("torque_sensor.bandwidth_hz", BANDWIDTH),
    optional("torque_sensor.noise_nm", within(0.0, 1e5, "N m")),
    optional("torque_sensor.range_nm", positive(1e6, "N m")),
    optional("torque_sensor.resolution_nm", within(0.0, 1e5, "N m")),
    key("motor_current.torque_constant_nm_per_a", positive(1e3, "N m/A")),
    optional("motor_current.gain_error", GAIN),
    optional("motor_current.offset_a", within(-1e4, 1e4, "A")),
    optional("motor_current.bandwidth_hz", BANDWIDTH),
    optional("motor_current.noise_a", within(0.0, 1e4, "A")),
    optional("motor_current.range_a", positive(1e5, "A")),
    optional("motor_current.resolution_a", within(0.0, 1e4, "A")),
    optional("accelerometer.sensitivity_error", GAIN),
    optional("accelerometer.bias_m_per_s2", within(-1e4, 1e4, "m/s^2")),
    optional("accelerometer.bias_drift_m_per_s2", within(0.0, 1e4, "m/s^2")),
    optional("accelerometer.bias_drift_time_s", TIME),
    optional("accelerometer.bandwidth_hz", BANDWIDTH),
    optional("accelerometer.noise_density_m_per_s2_per_sqrt_hz", within(0.0, 1e3, "m/s^2/sqrt(Hz)")),
    optional("accelerometer.range_m_per_s2", positive(1e6, "m/s^2")),
    optional("accelerometer.resolution_m_per_s2", within(0.0, 1e4, "m/s^2")),
    key("gauge_bridge.at_m", within(0.0, 100.0, "m")),
    key("gauge_bridge.gauge_factor", within(0.1, 1e3, "1")),
    key("gauge_bridge.active_arms", Allowed::Whole(1, 4)),
    key("gauge_bridge.excitation_v", positive(1e3, "V")),
    optional("gauge_bridge.amplification", positive(1e6, "1")),
    optional("gauge_bridge.gain_error", GAIN),
    optional("gauge_bridge.zero_v_per_v", within(-0.1, 0.1, "V/V")),
    optional("gauge_bridge.zero_drift_v_per_v", within(0.0, 0.1, "V/V")),
    optional("gauge_bridge.zero_drift_time_s", TIME),
    optional("gauge_bridge.bandwidth_hz", BANDWIDTH),
    optional("gauge_bridge.noise_density_v_per_sqrt_hz", within(0.0, 1.0, "V/sqrt(Hz)")),
    optional("gauge_bridge.range_v", positive(1e4, "V")),
    optional("gauge_bridge.resolution_v", within(0.0, 1e3, "V")),
];

/// Keys of a sensor file in its order.
pub const KEYS: &[Key] = &joined::<62>(&[&HEAD, &MOTOR, &OUTPUT, &ANALOGUE]);

/// All of it; every sensor may be left out.
pub(super) const SCHEMA: Schema = Schema {
    optional_sections: &[
        "motor_encoder",
        "output_encoder",
        "torque_sensor",
        "motor_current",
        "accelerometer",
        "gauge_bridge",
    ],
    ..Schema::of(KEYS)
};
