//! Sine and cosine of a phase, in f32: a table around the revolution, and the addition theorem for the remainder.
//!
//! ```text
//! theta = k*2*pi/128 + r, |r| <= pi/128       t = r - r^3/6 (sin r),   h = r^2/2 (1 - cos r)
//! cos(theta) = C_k - (C_k*h + S_k*t)          sin(theta) = S_k + (C_k*t - S_k*h)
//! ```
//!
//! The series leave out r^4/24 < 1.6e-8. k and the rest are bits of the phase: no quadrant is distinguished, and half a
//! revolution more gives exactly the negative of both, a quarter exchanges them.

/// Radians in one count of a phase of 2^32 counts a revolution.
pub const RADIANS_PER_COUNT: f64 = core::f64::consts::TAU / 4_294_967_296.0;

/// Steps of a revolution.
const STEPS: usize = 1 << STEPS_LOG2;
const STEPS_LOG2: u32 = 7;
/// Counts of one step, as an exponent of 2.
const STEP_LOG2: u32 = 32 - STEPS_LOG2;
/// Steps of a quarter, which the cosine is ahead.
const QUARTER: usize = STEPS / 4;
/// Sines of a revolution and a quarter; 640 bytes.
const ENTRIES: usize = STEPS + QUARTER;

/// Bytes of the table.
pub const BYTES: usize = ENTRIES * size_of::<f32>();

/// S_k; C_k is S_(k + 32).
static TABLE: [f32; ENTRIES] = {
    let mut table = [0.0; ENTRIES];
    let mut k = 0;
    while k < ENTRIES {
        // From one quarter, so that what is symmetric has the same bits.
        let (sine, cosine) = (exact_sine(k % QUARTER), exact_sine(QUARTER - k % QUARTER));
        table[k] = match k / QUARTER {
            1 => cosine,
            2 => -sine,
            3 => -cosine,
            _ => sine,
        };
        k += 1;
    }
    table
};

/// sin(k*2*pi/[`STEPS`]) up to a quarter revolution, by its series.
const fn exact_sine(k: usize) -> f32 {
    let x = k as f64 * (core::f64::consts::TAU / STEPS as f64);
    let (mut series, mut order) = (1.0, 21.0);
    while order > 1.0 {
        series = 1.0 - series * x * x / (order * (order - 1.0));
        order -= 2.0;
    }
    (x * series) as f32
}

/// Sine and cosine of a phase of 2^32 counts a revolution.
#[inline(always)]
pub fn sine_cosine_f32(phase: u32) -> (f32, f32) {
    let k = phase.wrapping_add(1 << (STEP_LOG2 - 1)) >> STEP_LOG2;
    let [sine, cosine] = [0, QUARTER].map(|ahead| TABLE[k as usize + ahead]);
    let rest = phase.wrapping_sub(k << STEP_LOG2).cast_signed() as f32 * RADIANS_PER_COUNT as f32;
    let square = rest * rest;
    let (t, h) = (rest - rest * (square * (1.0 / 6.0)), 0.5 * square);
    (sine + (cosine * t - sine * h), cosine - (cosine * h + sine * t))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn half_a_turn_negates_and_a_quarter_exchanges_exactly(phase: u32) {
            let (sine, cosine) = sine_cosine_f32(phase);
            prop_assert_eq!(sine_cosine_f32(phase.wrapping_add(1 << 31)), (-sine, -cosine));
            prop_assert_eq!(sine_cosine_f32(phase.wrapping_add(1 << 30)), (cosine, -sine));
        }
    }

    #[test]
    fn a_quarter_turn_is_exact() {
        assert_eq!(
            [0, 1, 2, 3].map(|k: u32| sine_cosine_f32(k << 30)),
            [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)]
        );
    }
}
