//! The table of encoders in `docs/src/add-sensor.md` shows what the drivers state.

use std::convert::Infallible;
use std::fs;

use embedded_hal::spi::{ErrorType, MODE_1, MODE_3, Operation, SpiDevice};
use embedded_hal_mock::eh1::delay::NoopDelay;
use strainwave_drivers::{As5047p, BissC, Encoder, Ma732, Mt6835, Quadrature, SpiEncoder, Tle5012b};

/// Completes a driver's type; no frame is exchanged.
struct NoBus;

impl ErrorType for NoBus {
    type Error = Infallible;
}

impl SpiDevice for NoBus {
    fn transaction(&mut self, _: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        Ok(())
    }
}

fn microseconds(time: f32) -> String {
    format!("{:.1} us", time * 1e6)
}

/// Bits, interface, clock, time and latency of an encoder on SPI.
fn row<E: SpiEncoder>(name: &str) -> String {
    let mode = match E::MODE {
        MODE_1 => 1,
        MODE_3 => 3,
        other => panic!("{other:?} has no number here"),
    };
    let [time, latency] = [E::READING_TIME, E::LATENCY].map(microseconds);
    format!(
        "| {name} | {} | SPI mode {mode} | {} MHz | {time} | {latency} |",
        E::BITS,
        E::FASTEST / 1_000_000
    )
}

#[test]
fn every_driver_has_its_row() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/src/add-sensor.md");
    let page = fs::read_to_string(page).expect("is a page of the book");
    let quadrature = <Quadrature<fn() -> u16, u16, 10_000> as Encoder>::BITS;
    let rows = [
        row::<As5047p<NoBus, NoopDelay>>("`As5047p` (ams)"),
        row::<Ma732<NoBus, NoopDelay>>("`Ma732` (MPS), filter as delivered"),
        row::<Ma732<NoBus, NoopDelay, 187>>("`Ma732` (MPS), slowest filter"),
        row::<Mt6835<NoBus, NoopDelay>>("`Mt6835` (MagnTek)"),
        row::<Tle5012b<NoBus, NoopDelay>>("`Tle5012b` (Infineon)"),
        row::<BissC<NoBus, NoopDelay, 22>>("`BissC`, here of 22 bits"),
        format!("| `Quadrature`, here of 10 000 counts | {quadrature} | timer |"),
    ];
    for row in rows {
        assert!(page.contains(&row), "missing in docs/src/add-sensor.md: {row}");
    }
}
