//! The operator's keys, from USART1.

use strainwave_controller::keys;

use crate::serial::registers;

/// Takes the key that interrupted.
pub fn receive() {
    let usart = registers();
    // Reading status, then data clears the errors too, an overrun among them.
    let valid = usart.sr().read().rxne().bit_is_set();
    let key = usart.dr().read().bits() as u8;
    if valid {
        keys::take(key);
    }
}
