//! The board's parts put together: what the control sees, and what start-up still needs.

use crate::drive::Drive;
use crate::encoder::MotorEncoder;
use crate::{clock, joint, serial, timer, watchdog};
use cortex_m::peripheral::NVIC;
use stm32f4xx_hal::gpio::GpioExt;
use stm32f4xx_hal::pac::{IWDG, Peripherals, TIM2};
use stm32f4xx_hal::rcc::{Enable, Rcc, RccExt};
use strainwave_app::jog::{Jog, Planner};
use strainwave_app::operated::Operated;
use strainwave_app::{Compensator, Input, Output};

/// Moves of the joint, which the idle loop plans for the control interrupt.
static JOG: Jog = Jog::new();

/// Hardware that `main` starts once the control is in place.
pub struct Hardware {
    pub interrupts: NVIC,
    pub timer: TIM2,
    pub watchdog: IWDG,
}

/// Brings the board up; `None`, after saying why, when it is not fit to control a joint.
pub fn start() -> Option<(Board, Planner, &'static Compensator, Hardware)> {
    let device = Peripherals::take()?;
    let core = cortex_m::Peripherals::take()?;
    let mut rcc = device.RCC.constrain();
    let restarted = was_restarted(&rcc);
    let clock = clock::start(&rcc, &device.FLASH);
    let a = device.GPIOA.split(&mut rcc);
    let b = device.GPIOB.split(&mut rcc);
    serial::start(device.USART1, a.pa9, a.pa10, clock, &mut rcc);
    if clock != clock::FULL {
        defmt::error!("no 8 MHz crystal: the control does not fit into its period");
        return None;
    }
    let compensator = joint::compensator()?;
    let drive = Drive::new(device.DAC, a.pa4, b.pb0, compensator.limits().motor_torque, &mut rcc);
    let encoder = MotorEncoder::new(device.SPI1, (a.pa5, a.pa6, a.pa7), b.pb6, &mut rcc)?;
    let Ok(planner) = Planner::new(&JOG) else {
        defmt::error!("no moves can be planned with the joint's control period");
        return None;
    };
    TIM2::enable(&mut rcc);
    let board = Board { encoder, drive, joint: Operated::new(&JOG), restarted };
    Some((
        board,
        planner,
        compensator,
        Hardware { interrupts: core.NVIC, timer: device.TIM2, watchdog: device.IWDG },
    ))
}

/// Whether a watchdog or the firmware itself has reset the chip: then nobody has looked after the cause. Power and the
/// reset pin do not count. The flags are cleared for the next time.
fn was_restarted(rcc: &Rcc) -> bool {
    let flags = rcc.csr().read();
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    flags.wdgrstf().bit_is_set() || flags.wwdgrstf().bit_is_set() || flags.sftrstf().bit_is_set()
}

/// The board as the control sees it.
pub struct Board {
    encoder: MotorEncoder,
    drive: Drive,
    joint: Operated,
    restarted: bool,
}

impl strainwave_app::Board for Board {
    fn restarted(&self) -> bool {
        self.restarted
    }

    // 1000 reports a second, of 40 bytes at most, fit through the USART twice over.
    const REPORT_EVERY: u32 = 10;

    // A function of its own: what reads the encoder and goes through a move is not on the stack while the control step is.
    #[inline(never)]
    fn input(&mut self, input: &mut Input<f32>) -> bool {
        self.joint.input(self.encoder.count(), input);
        true
    }

    fn command(&mut self, torque: f32) {
        self.joint.commanded(torque);
        self.drive.command(torque);
    }

    fn report(&mut self, output: impl FnOnce() -> Output<f32>) {
        self.joint.report(output);
    }

    fn release(&mut self) {
        self.drive.release();
    }

    fn feed_watchdog(&mut self) {
        watchdog::feed();
    }

    fn overran(&mut self) -> bool {
        timer::waiting()
    }
}
