//! The operator's keys, from USART1.

use strainwave_controller::keys;

use crate::serial::registers;

/// Takes the key that interrupted.
pub fn receive() {
    let usart = registers();
    let status = usart.sr().read();
    // Reading status, then data clears the errors too, an overrun among them. Without either a key may come in between, which would be lost.
    if status.rxne().bit_is_set() || status.ore().bit_is_set() {
        let key = usart.dr().read().bits() as u8;
        if status.rxne().bit_is_set() {
            keys::take(key);
        }
    }
}
