//! The motor's drive: torque command as the mean of a pulse width, enable on a pin (RP2350 datasheet, 12.5).

use rp235x_pac::PWM;
use strainwave_controller::{Drive as _, TorqueCode};

use crate::pins::Enable;

/// The slice whose second output is GP15.
const SLICE: usize = 7;
/// Last count of a period: 12 bits, 36.6 kHz.
const TOP: u16 = 4095;

/// The drive's two inputs.
pub struct Drive {
    torque: PWM,
    enable: Enable,
    code: TorqueCode,
}

impl Drive {
    /// Disabled, without torque; at the rails of its input the drive gives `peak_torque` (N m).
    pub fn new(pwm: PWM, enable: Enable, peak_torque: f32) -> Self {
        let mut drive = Self { torque: pwm, enable, code: TorqueCode::new(peak_torque) };
        drive.release();
        let slice = drive.torque.ch(SLICE);
        // SAFETY: the register takes any word of 16 bits.
        slice.top().write(|w| unsafe { w.top().bits(TOP) });
        slice.csr().write(|w| w.en().set_bit());
        drive
    }

    fn put(&mut self, code: u16) {
        // SAFETY: the field has 16 bits.
        self.torque.ch(SLICE).cc().write(|w| unsafe { w.b().bits(code) });
    }
}

impl strainwave_controller::Drive for Drive {
    fn command(&mut self, torque: f32) {
        self.put(self.code.of(torque));
        self.enable.set();
    }

    fn release(&mut self) {
        self.enable.clear();
        self.put(TorqueCode::NEUTRAL);
    }
}
