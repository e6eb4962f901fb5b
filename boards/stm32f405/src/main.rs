#![no_std]
#![no_main]
use stm32f4xx_hal::rcc::RccExt;
use stm32f4xx_hal::{pac, prelude::*, rcc::Config};
use strainwave_app as _;
#[cortex_m_rt::entry]
fn main() -> ! {
    let Some(dp) = pac::Peripherals::take() else { loop {} };
    let rcc = dp.RCC.freeze(Config::hse(8.MHz()).sysclk(168.MHz()));
    let _ = rcc;
    loop {}
}
unsafe extern "C" {
    fn strainwave_a_panic_is_reachable() -> !;
}
#[panic_handler]
fn panic(_info: &core::panic::PanicInfo) -> ! {
    unsafe { strainwave_a_panic_is_reachable() }
}
#[defmt::global_logger]
struct L;
unsafe impl defmt::Logger for L {
    fn acquire() {}
    unsafe fn flush() {}
    unsafe fn release() {}
    unsafe fn write(_: &[u8]) {}
}
