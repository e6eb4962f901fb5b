//! Torque command as a voltage, by a converter of 12 bits.
//!
//! ```text
//! code = 2048 + 2047 * torque/peak_torque        0..4095 for 0..3.3 V, 1.65 V is no torque
//! ```

/// From there to peak torque.
const SPAN: i32 = 2047;

/// From torques to codes.
pub struct TorqueCode {
    /// Steps of the code per torque (1/(N m)).
    scale: f32,
}

impl TorqueCode {
    /// The code of no torque.
    pub const NEUTRAL: u16 = 2048;

    /// For a drive that gives `peak_torque` (N m) at the rails of its input.
    pub fn new(peak_torque: f32) -> Self {
        Self { scale: SPAN as f32 / peak_torque }
    }

    /// The code of a torque (N m).
    pub fn of(&self, torque: f32) -> u16 {
        // The conversion to an integer saturates, and takes NaN as 0.
        let steps = (torque * self.scale) as i32;
        (i32::from(Self::NEUTRAL) + steps.clamp(-SPAN, SPAN)) as u16
    }
}
