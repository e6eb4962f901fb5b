//! The motor's drive: torque command on the DAC, enable on a pin.
//!
//! ```text
//! code = 2048 + 2047 * torque/peak_torque        0..4095 for 0..3.3 V, 1.65 V is no torque
//! ```

use stm32f4xx_hal::dac::{C1, DacExt, DacOut, DacPin};
use stm32f4xx_hal::gpio::{Output, PA4, PB0};
use stm32f4xx_hal::pac::DAC;
use stm32f4xx_hal::rcc::Rcc;

/// The code of no torque.
const NEUTRAL: i32 = 2048;
/// From there to peak torque.
const SPAN: i32 = 2047;

/// The drive's two inputs.
pub struct Drive {
    torque: C1,
    enable: PB0<Output>,
    /// Steps of the code per torque (1/(N m)).
    scale: f32,
}

impl Drive {
    /// Disabled, without torque; at the rails of its input the drive gives `peak_torque` (N m).
    pub fn new(dac: DAC, torque: PA4, enable: PB0, peak_torque: f32, rcc: &mut Rcc) -> Self {
        let enable = enable.into_push_pull_output();
        let torque = dac.constrain(torque.into_analog(), rcc);
        let mut drive = Self { torque, enable, scale: SPAN as f32 / peak_torque };
        drive.release();
        drive.torque.enable();
        drive
    }

    /// Commands a torque at the motor's shaft (N m).
    pub fn command(&mut self, torque: f32) {
        // The conversion to an integer saturates, and takes NaN as 0.
        let steps = (torque * self.scale) as i32;
        self.torque.set_value((NEUTRAL + steps.clamp(-SPAN, SPAN)) as u16);
        self.enable.set_high();
    }

    /// Takes the torque off and disables the drive.
    pub fn release(&mut self) {
        self.enable.set_low();
        self.torque.set_value(NEUTRAL as u16);
    }
}
