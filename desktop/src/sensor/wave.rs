//! One sine over a revolution: of a scale's error, of a motor's torque.
//!
//! ```text
//! a*sin(k*theta + p)        k whole periods a revolution
//! ```
//!
//! The angle is an integer phase: the value repeats exactly every revolution, however many there were.

use strainwave::{Angle, Real};

/// One sine over a revolution.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wave {
    /// Periods a revolution.
    pub order: u32,
    /// Amplitude; 0 for none.
    pub amplitude: f64,
    /// (rad)
    pub phase: f64,
}

impl Wave {
    /// None.
    pub const NONE: Self = Self { order: 0, amplitude: 0.0, phase: 0.0 };

    /// Its value at an angle.
    pub fn at(&self, angle: Angle<f64>) -> f64 {
        if self.amplitude == 0.0 {
            return 0.0;
        }
        let (sine, cosine) = f64::sin_cos_phase(self.order.wrapping_mul(angle.phase()));
        let (of_cosine, of_sine) = self.phase.sin_cos();
        self.amplitude * (sine * of_sine + cosine * of_cosine)
    }
}
