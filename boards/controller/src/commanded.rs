//! The control of a joint that a controller commands over CAN.
//!
//! The node runs in the interrupt of its bus, which is below the control's and which the control interrupt requests once a period: idle loop and
//! telemetry do not hold it up.

use core::cell::Cell;
use cortex_m::interrupt::InterruptNumber;
use critical_section::Mutex;
use embedded_can::nb::Can;
use static_cell::StaticCell;
use strainwave_app::commanded::{BusNode, Commanded, Drive as NodeDrive, Exchange, NODE, node};
use strainwave_app::telemetry::Sender;
use strainwave_app::{Compensator, Control, Slot, Telemetry};
use strainwave_drivers::Encoder;

use crate::board::{Board, Drive};
use crate::control::{Parts, Start};
use crate::{Chip, Timer, Watchdog, fault, idle, keys};

/// A board whose joint is commanded so.
pub type CommandedBoard<C, E, D> = Board<C, E, D, Commanded>;

/// What the image has as statics. `N` is the drive behind the node.
pub struct Places<C: 'static, E: 'static, D: 'static, B: Can + 'static, N: 'static> {
    /// For the control.
    control: StaticCell<Control<CommandedBoard<C, E, D>>>,
    /// The control in its interrupt.
    pub slot: Slot<CommandedBoard<C, E, D>>,
    /// Between the control and its node.
    exchange: Exchange,
    node: StaticCell<BusNode<B, N>>,
    /// The node, where its interrupt finds it.
    found: Mutex<Cell<Option<&'static mut BusNode<B, N>>>>,
}

impl<C: Chip, E: Encoder, D: Drive, B: Can, N: NodeDrive> Places<C, E, D, B, N> {
    /// Empty.
    #[expect(clippy::new_without_default, reason = "only ever a static")]
    pub const fn new() -> Self {
        Self {
            control: StaticCell::new(),
            slot: Slot::new(),
            exchange: Exchange::new(),
            node: StaticCell::new(),
            found: Mutex::new(Cell::new(None)),
        }
    }

    /// Polls the node, in its interrupt.
    pub fn poll(&self) {
        let place = |node| critical_section::with(|section| self.found.borrow(section).replace(node));
        // The interrupt does not nest in itself: nobody looks for the node meanwhile.
        if let Some(node) = place(None) {
            node.poll();
            place(Some(node));
        }
    }
}

/// What brings up the bus of the node with this number, and the drive behind it.
pub type StartBus<B, N> = fn(u8, &Compensator) -> Option<(B, N)>;

/// Brings the board up by `parts` and its bus by `bus`, hands the control and the node to their interrupts, then reports; `interrupt` is the
/// node's. Ends with the drive off where the board is not fit to control a joint.
pub fn run<C: Chip, E: Encoder, D: Drive, B: Can, N: NodeDrive>(
    places: &'static Places<C, E, D, B, N>,
    telemetry: &'static mut Telemetry,
    parts: Start<Board<C, E, D>>,
    bus: StartBus<B, N>,
    interrupt: impl InterruptNumber,
) -> ! {
    let (sender, log) = telemetry.split();
    match start(places, sender, parts, bus, interrupt) {
        Some(()) => idle::run(log, || ()),
        None => fault::halt::<C>(),
    }
}

// Not inlined: its stack is not the idle loop's.
#[inline(never)]
fn start<C: Chip, E: Encoder, D: Drive, B: Can, N: NodeDrive>(
    places: &'static Places<C, E, D, B, N>,
    sender: Sender,
    parts: Start<Board<C, E, D>>,
    bus: StartBus<B, N>,
    interrupt: impl InterruptNumber,
) -> Option<()> {
    let Parts { board, compensator, mut interrupts } = parts()?;
    let Some(((bus, drive), node)) = bus(NODE, compensator).zip(node(NODE, compensator)) else {
        defmt::error!("the CAN controller does not start");
        return None;
    };
    let board = board.commanded_by(Commanded::new(&places.exchange, compensator));
    places.slot.put(places.control.try_uninit()?.write(Control::new(board, compensator, sender)));
    let node = places.node.try_uninit()?.write(BusNode::new(node, bus, drive, &places.exchange));
    critical_section::with(|section| places.found.borrow(section).set(Some(node)));
    keys::listen(&mut interrupts, interrupt);
    C::Watchdog::start();
    C::Timer::start(&mut interrupts);
    Some(())
}
