//! The operator's keys, from USART1.

use strainwave_controller::keys;

use crate::serial::registers;

/// Takes a key, if one has come.
pub fn receive() {
    let usart = registers();
    let status = usart.sr().read();
    let (valid, overrun) = (status.rxne().bit_is_set(), status.ore().bit_is_set());
    // What comes behind the status is left to the next interrupt.
    if !(valid || overrun) {
        return;
    }
    // Reading status, then data clears an overrun too.
    let key = usart.dr().read().bits() as u8;
    if valid {
        keys::take(key);
    }
}
