//! Bounds of `verify sensor`: readings against the words of datasheets.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "sensor.encoder.quantisation",
        value: 1e-4,
        unit: "1",
        why: "rms of the rounding to counts over a count/sqrt(12), less 1, over angles that lie evenly; target 1e-2",
    },
    Bound {
        name: "sensor.encoder.delay",
        value: 2e-5,
        unit: "1",
        why: "lag at constant speed over the stated delay, less 1, whole samples and fractions: up to a count of 32 bits of the least lag; target 1e-2",
    },
    Bound {
        name: "sensor.encoder.eccentricity",
        value: 3e-6,
        unit: "1",
        why: "error of each order over a revolution against the stated one, of the largest amplitude: rounding to 24 bits; target 1e-2",
    },
    Bound {
        name: "sensor.encoder.jitter",
        value: 6e-3,
        unit: "1",
        why: "rms at constant speed over speed*jitter/sqrt(3), less 1, the worst of 8 runs: four times sqrt(1/(5*n)) of n = 1e5 samples; target 2e-2",
    },
    Bound {
        name: "sensor.accelerometer.noise_density",
        value: 2.6e-2,
        unit: "1",
        why: "density in a low, a middle and a high band over the stated one, less 1, the worst: four times 1/(2*sqrt(n)) of n = 6000 bins; target 5e-2",
    },
    Bound {
        name: "sensor.accelerometer.bandwidth",
        value: 5e-3,
        unit: "1",
        why: "frequency of -3 dB over the stated one, less 1: samples 0.1 ms apart join a sine of 200 Hz linearly; target 1e-2",
    },
    Bound {
        name: "sensor.gauge_bridge.output",
        value: 5e-13,
        unit: "1",
        why: "voltage of one, two and four arms against two voltage dividers; target 1e-9",
    },
    Bound {
        name: "sensor.gauge_bridge.drift",
        value: 6.3e-2,
        unit: "1",
        why: "deviation of the zero after 0.1, 1 and 4 time constants over the equation's, less 1, the worst: four times 1/sqrt(2*n) of n = 2000 drifts; target 0.1",
    },
    Bound {
        name: "sensor.torque_sensor.noise",
        value: 9e-3,
        unit: "1",
        why: "rms of the samples over the stated one, less 1, the worst of 8 runs: four times 1/sqrt(2*n) of n = 1e5 samples; target 2e-2",
    },
    Bound {
        name: "sensor.motor_current.quantisation",
        value: 5e-5,
        unit: "1",
        why: "rms of the rounding over a count/sqrt(12), less 1, over currents that lie evenly; target 1e-2",
    },
];
