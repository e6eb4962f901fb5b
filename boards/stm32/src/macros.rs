//! What an image has to define itself: its entry, its statics, its handlers and its logger.

/// The image that controls the joint with a `$board` on a `$chip`. `$parts` brings the board up, `$receive` takes a key in the
/// interrupt `$port`, `$send` sends bytes. Beside it the names `Interrupt` and `interrupt` of the chip's device crate.
#[macro_export]
macro_rules! controller {
    ($chip:ty, $board:ty, $parts:path, $port:ident, $receive:path, $send:path) => {
        use $crate::strainwave_app::{Control, Slot, Telemetry};

        static CONTROL: $crate::static_cell::StaticCell<Control<$board>> =
            $crate::static_cell::StaticCell::new();
        static SLOT: Slot<$board> = Slot::new();

        #[cortex_m_rt::entry]
        fn main() -> ! {
            static mut TELEMETRY: Telemetry = Telemetry::new();
            $crate::control::run::<$chip, $board>(&CONTROL, &SLOT, TELEMETRY, $parts, Interrupt::$port)
        }

        /// The 10 kHz interrupt.
        #[interrupt]
        fn TIM2() {
            $crate::timer::acknowledge::<$chip>();
            SLOT.tick();
        }

        /// A key from the operator.
        #[interrupt]
        fn $port() {
            $receive();
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
