//! What an image has to define itself: its entry, its statics, its vector table and its logger.

/// The image that controls the joint on a [`Machine`](crate::Machine); `SysTick` where that is its timer.
#[macro_export]
macro_rules! controller {
    ($machine:ty) => {
        $crate::controller!(@image $machine);
        $crate::vectors!(<$machine as $crate::Machine>::TIMER.interrupt(), control_interrupt);
    };
    ($machine:ty, SysTick) => {
        $crate::controller!(@image $machine);
        $crate::vectors!(0, DefaultHandler);

        #[cortex_m_rt::exception]
        fn SysTick() {
            control_interrupt();
        }
    };
    (@image $machine:ty) => {
        use $crate::strainwave_app::{Control, Slot, Telemetry};

        static CONTROL: $crate::static_cell::StaticCell<Control<$crate::Board<$machine>>> =
            $crate::static_cell::StaticCell::new();
        static SLOT: Slot<$crate::Board<$machine>> = Slot::new();

        #[cortex_m_rt::entry]
        fn main() -> ! {
            static mut TELEMETRY: Telemetry = Telemetry::new();
            $crate::start(&CONTROL, &SLOT, TELEMETRY)
        }

        /// The 10 kHz interrupt.
        extern "C" fn control_interrupt() {
            $crate::timer::acknowledge::<$machine>();
            SLOT.tick();
        }

        $crate::strainwave_app::global_logger!($crate::uart::send::<$machine>);
    };
}

/// An image that is counted: it enables no interrupt, and ends as `$program`, which gives `Result<bool, Error>`, does.
#[macro_export]
macro_rules! counted {
    ($machine:ty, $program:path) => {
        #[cortex_m_rt::entry]
        fn main() -> ! {
            $crate::counted::run::<$machine>($program)
        }

        /// Target of the application's panic handler; nothing else defines it.
        #[unsafe(no_mangle)]
        extern "C" fn strainwave_a_panic_is_reachable() -> ! {
            $crate::fault::fail_because(c"the counted program panicked\n")
        }

        $crate::vectors!(0, DefaultHandler);
        $crate::strainwave_app::global_logger!($crate::uart::send::<$machine>);
    };
}

/// The device's part of the vector table, up to the interrupt of this number.
#[macro_export]
macro_rules! vectors {
    ($number:expr, $handler:ident) => {
        unsafe extern "C" {
            fn DefaultHandler();
        }

        // SAFETY: this section and name are cortex-m-rt's contract for a device's vectors; every entry is a handler.
        #[unsafe(link_section = ".vector_table.interrupts")]
        #[unsafe(no_mangle)]
        static __INTERRUPTS: [unsafe extern "C" fn(); $number + 1] = {
            let mut table: [unsafe extern "C" fn(); $number + 1] = [DefaultHandler; $number + 1];
            table[$number] = $handler;
            table
        };
    };
}
