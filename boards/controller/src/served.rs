//! The control of a board whose serial port carries the tuning link.
//!
//! What start-up has to say is sent as telemetry before the link begins; from then on the port is the link's. There are no keys: the joint holds
//! the position in which it starts, and after a reset the one that it then has.

use core::ops::Range;
use cortex_m::interrupt::InterruptNumber;
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use static_cell::StaticCell;
use strainwave_app::served::{Exchange, Served, ServedJoint};
use strainwave_app::telemetry::Sender;
use strainwave_app::{Board, Control, Slot, Telemetry};
use strainwave_service::tuning::TuningLink;

use crate::control::{Parts, Start};
use crate::line::{Line, Port};
use crate::{Chip, Timer, Watchdog, fault, keys};

/// What a board brings up for its link.
pub struct Service<L, F> {
    /// Its serial port.
    pub line: L,
    /// A flash, with the region of the store, where it has one.
    pub store: Option<(F, Range<u32>)>,
    /// Writing the flash does not hold the control up.
    pub writes_beside: bool,
}

/// The flash of a board that has none for a store.
pub enum NoFlash {}

impl ErrorType for NoFlash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for NoFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, _offset: u32, _bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        match *self {}
    }

    fn capacity(&self) -> usize {
        match *self {}
    }
}

impl NorFlash for NoFlash {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = 1;

    fn erase(&mut self, _from: u32, _to: u32) -> Result<(), NorFlashErrorKind> {
        match *self {}
    }

    fn write(&mut self, _offset: u32, _bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        match *self {}
    }
}

/// What the image has as statics.
pub struct Places<B: 'static> {
    /// For the control.
    pub control: StaticCell<Control<Served<B>>>,
    /// The control in its interrupt.
    pub slot: Slot<Served<B>>,
    /// Between the control and its link.
    pub exchange: Exchange,
}

impl<B: Board> Places<B> {
    /// Empty.
    #[expect(clippy::new_without_default, reason = "only ever a static")]
    pub const fn new() -> Self {
        Self { control: StaticCell::new(), slot: Slot::new(), exchange: Exchange::new() }
    }
}

/// Brings the board up by `parts` and its link by `service`, hands the control with what its store holds to its interrupt, then serves the
/// link; `port` is the interrupt of its serial port. Ends with the drive off where the board is not fit to control a joint.
pub fn run<C: Chip, B: Board, L: Line, F: NorFlash>(
    places: &'static Places<B>,
    telemetry: &'static mut Telemetry,
    parts: Start<B>,
    service: fn() -> Service<L, F>,
    port: impl InterruptNumber,
) -> ! {
    // Nobody reads its records: the port is the link's.
    let (sender, _) = telemetry.split();
    match start::<C, B, L, F>(places, sender, parts, service, port) {
        Some((line, joint)) => serve(line, joint),
        None => fault::halt::<C>(),
    }
}

// Not inlined: its stack is not the idle loop's.
#[inline(never)]
fn start<C: Chip, B: Board, L: Line, F: NorFlash>(
    places: &'static Places<B>,
    sender: Sender,
    parts: Start<B>,
    service: fn() -> Service<L, F>,
    port: impl InterruptNumber,
) -> Option<(L, ServedJoint<F>)> {
    let Parts { board, compensator, mut interrupts } = parts()?;
    let Service { line, store, writes_beside } = service();
    let mut joint = ServedJoint::new(&places.exchange, store, writes_beside);
    let place = places.control.try_uninit()?;
    let control = place.write(Control::new(Served::new(board, &places.exchange), compensator, sender));
    if let Some(learnt) = joint.learnt_before() {
        control.start_from(&learnt);
    }
    places.slot.put(control);
    keys::listen(&mut interrupts, port);
    C::Watchdog::start();
    C::Timer::start(&mut interrupts);
    Some((line, joint))
}

fn serve<L: Line, F: NorFlash>(line: L, mut joint: ServedJoint<F>) -> ! {
    let (mut port, mut link) = (Port(line), TuningLink::default());
    loop {
        link.poll(&mut port, &mut joint);
        cortex_m::asm::wfi();
    }
}
