//! CMSDK UART in both directions, which waits for nothing (Arm DDI 0479, CMSDK APB UART).

use core::convert::Infallible;
use core::marker::PhantomData;
use embedded_hal_nb::nb;
use embedded_hal_nb::serial::{ErrorType, Read, Write};

use crate::register::Register;
use crate::uart::{CONTROL, DATA, DIVISOR, FASTEST, STATE, TRANSMIT_ENABLE, TRANSMIT_FULL};
use crate::{Machine, Uart};

const RECEIVE_FULL: u32 = 1 << 1;
const RECEIVE_ENABLE: u32 = 1 << 1;

/// A machine with a UART for the tuning link.
///
/// # Safety
/// As [`Machine`]; it is not the UART of the telemetry.
pub unsafe trait Tunable: Machine {
    /// The UART.
    const TUNING: Uart;
}

/// The port.
pub struct Port<M>(PhantomData<M>);

impl<M: Tunable> Port<M> {
    /// Switches receiver and transmitter on.
    pub fn open() -> Self {
        register::<M>(DIVISOR).write(FASTEST);
        register::<M>(CONTROL).write(TRANSMIT_ENABLE | RECEIVE_ENABLE);
        Self(PhantomData)
    }
}

fn register<M: Tunable>(offset: usize) -> Register {
    // SAFETY: `Tunable` promises a UART at the address, and the offsets are those of its registers.
    unsafe { Register::at(M::TUNING.address, offset) }
}

impl<M> ErrorType for Port<M> {
    type Error = Infallible;
}

impl<M: Tunable> Read<u8> for Port<M> {
    fn read(&mut self) -> nb::Result<u8, Infallible> {
        if register::<M>(STATE).read() & RECEIVE_FULL == 0 {
            return Err(nb::Error::WouldBlock);
        }
        // The upper bits of the register are zero.
        Ok(register::<M>(DATA).read() as u8)
    }
}

impl<M: Tunable> Write<u8> for Port<M> {
    fn write(&mut self, byte: u8) -> nb::Result<(), Infallible> {
        if register::<M>(STATE).read() & TRANSMIT_FULL != 0 {
            return Err(nb::Error::WouldBlock);
        }
        register::<M>(DATA).write(u32::from(byte));
        Ok(())
    }

    fn flush(&mut self) -> nb::Result<(), Infallible> {
        if register::<M>(STATE).read() & TRANSMIT_FULL != 0 { Err(nb::Error::WouldBlock) } else { Ok(()) }
    }
}
