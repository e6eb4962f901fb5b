//! The motor's drive where that is behind the node: the control commands none itself, and the pins of one that it could are left without torque.

use stm32g4xx_hal::gpio::{Output, PA4, PB0};
use stm32g4xx_hal::pac::DAC1;
use stm32g4xx_hal::rcc::Rcc;

/// The enable of a drive that may be wired to the board's other programs, low.
pub struct Drive {
    _enable: PB0<Output>,
}

impl Drive {
    /// Disabled for good.
    pub fn new(_dac: DAC1, _torque: PA4, enable: PB0, _peak_torque: f32, _rcc: &mut Rcc) -> Self {
        Self { _enable: enable.into_push_pull_output() }
    }
}

impl strainwave_controller::Drive for Drive {
    fn command(&mut self, _torque: f32) {}

    fn release(&mut self) {}
}
