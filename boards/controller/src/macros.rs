//! What an image has to define itself: its entry, its statics, its handlers and its logger.

/// The image that controls the joint with a `$board` on a `$chip`. `$parts` brings the board up, `$receive` takes a key in the
/// interrupt `$port`, `$send` sends bytes. The control timer's handler is `$timer`, an `interrupt` or an `exception`. Beside it the names
/// `Interrupt` and `interrupt` of the chip's device crate, and `exception` where it is one.
#[macro_export]
macro_rules! controller {
    ($chip:ty, $board:ty, $parts:path, $kind:meta $timer:ident, $port:ident, $receive:path, $send:path) => {
        use $crate::strainwave_app::{Control, Slot, Telemetry};

        static CONTROL: $crate::static_cell::StaticCell<Control<$board>> =
            $crate::static_cell::StaticCell::new();
        static SLOT: Slot<$board> = Slot::new();

        #[cortex_m_rt::entry]
        fn main() -> ! {
            static mut TELEMETRY: Telemetry = Telemetry::new();
            $crate::control::run::<$chip, $board>(&CONTROL, &SLOT, TELEMETRY, $parts, Interrupt::$port)
        }

        $crate::handlers!($chip, SLOT.tick(), $kind $timer, $port, $receive(), $send);
    };
}

/// The same whose serial port carries the tuning link, with a store where the board has one: `$service` brings both up, and `$serve` serves the
/// interrupt of the port.
#[cfg(feature = "served")]
#[macro_export]
macro_rules! served_controller {
    ($chip:ty, $board:ty, $parts:path, $service:path, $kind:meta $timer:ident, $port:ident, $serve:path, $send:path) => {
        use $crate::served::Places;
        use $crate::strainwave_app::Telemetry;

        static PLACES: Places<$board> = Places::new();

        #[cortex_m_rt::entry]
        fn main() -> ! {
            static mut TELEMETRY: Telemetry = Telemetry::new();
            $crate::served::run::<$chip, $board, _, _>(&PLACES, TELEMETRY, $parts, $service, Interrupt::$port)
        }

        $crate::handlers!($chip, PLACES.slot.tick(), $kind $timer, $port, $serve(), $send);
    };
}

/// The same of a joint that is commanded over CAN: `$parts` brings the board up, of these encoder and drive, `$start` the bus, a `$bus`, with the
/// drive behind the node, a `$behind`, and `$port` is an interrupt that nothing else requests.
#[cfg(feature = "can")]
#[macro_export]
macro_rules! commanded_controller {
    ($chip:ty, $encoder:ty, $drive:ty, $bus:ty, $behind:ty, $parts:path, $start:path, $kind:meta $timer:ident, $port:ident, $send:path) => {
        use $crate::commanded::Places;
        use $crate::strainwave_app::Telemetry;

        static PLACES: Places<$chip, $encoder, $drive, $bus, $behind> = Places::new();

        #[cortex_m_rt::entry]
        fn main() -> ! {
            static mut TELEMETRY: Telemetry = Telemetry::new();
            $crate::commanded::run(&PLACES, TELEMETRY, $parts, $start, Interrupt::$port)
        }

        $crate::handlers!($chip, PLACES.slot.tick(), $kind $timer, $port, PLACES.poll(), $send);
    };
}

/// The handlers of either, and the logger.
#[doc(hidden)]
#[macro_export]
macro_rules! handlers {
    ($chip:ty, $tick:expr, $kind:meta $timer:ident, $port:ident, $serve:expr, $send:path) => {
        /// The 10 kHz interrupt.
        #[$kind]
        fn $timer() {
            <<$chip as $crate::Chip>::Timer as $crate::Timer>::acknowledge();
            $tick;
            cortex_m::peripheral::NVIC::pend(Interrupt::$port);
        }

        /// The serial port, or the bus; once a period also by the control, below which the constants are checked.
        #[interrupt]
        fn $port() {
            $serve;
            if $crate::joint::has_changed() {
                $crate::fault::halt::<$chip>();
            }
        }

        #[cortex_m_rt::exception(trampoline = false)]
        unsafe fn HardFault() -> ! {
            $crate::fault::halt::<$chip>()
        }

        #[cortex_m_rt::exception]
        unsafe fn DefaultHandler(_number: i16) {
            $crate::fault::halt::<$chip>()
        }

        // From thread mode only: see `strainwave_app::logger`.
        $crate::strainwave_app::global_logger!($send);
    };
}
