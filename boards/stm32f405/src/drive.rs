//! The motor's drive: torque command on the DAC, enable on a pin.

use stm32f4xx_hal::dac::{C1, DacExt, DacOut, DacPin};
use stm32f4xx_hal::gpio::{Output, PA4, PB0};
use stm32f4xx_hal::pac::DAC;
use stm32f4xx_hal::rcc::Rcc;
use strainwave_controller::{Drive as _, TorqueCode};

/// The drive's two inputs.
pub struct Drive {
    torque: C1,
    enable: PB0<Output>,
    code: TorqueCode,
}

impl Drive {
    /// Disabled, without torque; at the rails of its input the drive gives `peak_torque` (N m).
    pub fn new(dac: DAC, torque: PA4, enable: PB0, peak_torque: f32, rcc: &mut Rcc) -> Self {
        let enable = enable.into_push_pull_output();
        let torque = dac.constrain(torque.into_analog(), rcc);
        let mut drive = Self { torque, enable, code: TorqueCode::new(peak_torque) };
        drive.release();
        drive.torque.enable();
        drive
    }
}

impl strainwave_controller::Drive for Drive {
    fn command(&mut self, torque: f32) {
        self.torque.set_value(self.code.of(torque));
        self.enable.set_high();
    }

    fn release(&mut self) {
        self.enable.set_low();
        self.torque.set_value(TorqueCode::NEUTRAL);
    }
}
