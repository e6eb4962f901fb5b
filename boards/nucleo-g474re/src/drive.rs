//! The motor's drive: torque command on the DAC, enable on a pin.
//!
//! Through the registers: the HAL would set the DAC up for the clock that it assumes (ST RM0440, 22.7.16).

use stm32g4xx_hal::gpio::{Output, PA4, PB0};
use stm32g4xx_hal::pac::DAC1;
use stm32g4xx_hal::rcc::{Enable, Rcc, Reset};
use strainwave_controller::{Drive as _, TorqueCode};

/// The drive's two inputs.
pub struct Drive {
    torque: DAC1,
    enable: PB0<Output>,
    code: TorqueCode,
}

impl Drive {
    /// Disabled, without torque; at the rails of its input the drive gives `peak_torque` (N m).
    pub fn new(dac: DAC1, torque: PA4, enable: PB0, peak_torque: f32, rcc: &mut Rcc) -> Self {
        let enable = enable.into_push_pull_output();
        let _pin = torque.into_analog();
        DAC1::enable(rcc);
        DAC1::reset(rcc);
        dac.mcr().modify(|_, w| w.hfsel().more160mhz());
        let mut drive = Self { torque: dac, enable, code: TorqueCode::new(peak_torque) };
        drive.release();
        drive.torque.cr().modify(|_, w| w.en1().set_bit());
        drive
    }

    fn put(&mut self, code: u16) {
        // SAFETY: a code has 12 bits.
        self.torque.dhr12r(0).write(|w| unsafe { w.bits(u32::from(code)) });
    }
}

impl strainwave_controller::Drive for Drive {
    fn command(&mut self, torque: f32) {
        self.put(self.code.of(torque));
        self.enable.set_high();
    }

    fn release(&mut self) {
        self.enable.set_low();
        self.put(TorqueCode::NEUTRAL);
    }
}
