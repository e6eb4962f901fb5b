//! Required margins of every loop over the box of joint parameters; [`crate::verify::bounds`] has them as bounds.

/// Gain margin (dB).
pub const GAIN: f64 = 6.0;
/// Phase margin (degrees).
pub const PHASE: f64 = 35.0;
/// Delay margin beyond the declared delay (control periods).
pub const DELAY: f64 = 2.0;
/// Least |T|*|Delta| of the disturbance path that is too large.
pub const SIZE: f64 = 1.0;
