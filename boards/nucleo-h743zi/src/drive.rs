//! The motor's drive: torque command on the DAC, enable on a pin (ST RM0433, chapter 26).

use stm32h7::stm32h743v::{DAC, GPIOB};
use strainwave_controller::{Drive as _, TorqueCode};

/// The drive's two inputs.
pub struct Drive {
    torque: DAC,
    enable: GPIOB,
    code: TorqueCode,
}

impl Drive {
    /// Disabled, without torque; at the rails of its input the drive gives `peak_torque` (N m).
    pub fn new(dac: DAC, enable: GPIOB, peak_torque: f32) -> Self {
        let mut drive = Self { torque: dac, enable, code: TorqueCode::new(peak_torque) };
        drive.release();
        drive.torque.cr().modify(|_, w| w.en1().set_bit());
        drive
    }

    fn put(&mut self, code: u16) {
        // SAFETY: a code has 12 bits.
        self.torque.dhr12r1().write(|w| unsafe { w.bits(u32::from(code)) });
    }
}

impl strainwave_controller::Drive for Drive {
    fn command(&mut self, torque: f32) {
        self.put(self.code.of(torque));
        self.enable.bsrr().write(|w| w.bs1().set_bit());
    }

    fn release(&mut self) {
        self.enable.bsrr().write(|w| w.br1().set_bit());
        self.put(TorqueCode::NEUTRAL);
    }
}
