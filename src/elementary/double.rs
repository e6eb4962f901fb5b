//! libm's f64 functions of any argument, for `build` only: errors below one unit of the last place.

/// e^x.
pub(crate) fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// Sine and cosine of x (rad).
pub(crate) fn sin_cos(x: f64) -> (f64, f64) {
    libm::sincos(x)
}
