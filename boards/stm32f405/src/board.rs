//! The board's parts put together: what the control sees, and what start-up still needs.

use crate::drive::Drive;
use crate::encoder::MotorEncoder;
use crate::{clock, joint, serial, timer, watchdog};
use cortex_m::peripheral::NVIC;
use stm32f4xx_hal::gpio::GpioExt;
use stm32f4xx_hal::pac::{IWDG, Peripherals, TIM2};
use stm32f4xx_hal::rcc::{Enable, Rcc, RccExt};
use strainwave_app::compensator::schedule::CONTROL_PERIOD;
use strainwave_app::compensator::{CompensationGains, Sensors, Setpoint, Status};
use strainwave_app::jog::{Jog, LIMITS, Trajectory};
use strainwave_app::{Compensator, Input, Output};

/// Gains once the joint holds: all 1, but the friction's below that which could drive it.
const GAINS: CompensationGains<f32> = CompensationGains { friction: 0.8, ..CompensationGains::ALL };

/// Periods in which the observer only watches, before the joint holds where it then is: 0.1 s.
const WATCHING: u32 = 1000;

/// Hardware that `main` starts once the control is in place.
pub struct Hardware {
    pub interrupts: NVIC,
    pub timer: TIM2,
    pub watchdog: IWDG,
}

/// Brings the board up; `None`, after saying why, when it is not fit to control a joint.
pub fn start() -> Option<(Board, &'static Compensator, Hardware)> {
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
    let Ok(trajectory) = LIMITS.build(CONTROL_PERIOD as f32) else {
        defmt::error!("no moves can be planned with the joint's control period");
        return None;
    };
    TIM2::enable(&mut rcc);
    let board = Board {
        encoder,
        drive,
        trajectory,
        restarted,
        torque: 0.0,
        watched: 0,
        here: Setpoint::default(),
        jog: None,
    };
    Some((board, compensator, Hardware { interrupts: core.NVIC, timer: device.TIM2, watchdog: device.IWDG }))
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
    trajectory: Trajectory<f32>,
    restarted: bool,
    /// The last torque command (N m).
    torque: f32,
    watched: u32,
    /// Angle of the output, at rest.
    here: Setpoint<f32>,
    /// Absent while the observer only watches.
    jog: Option<Jog>,
}

impl Board {
    fn target(&mut self) -> (Setpoint<f32>, CompensationGains<f32>) {
        match &mut self.jog {
            Some(jog) => (jog.step(serial::target()), GAINS),
            None => (self.here, CompensationGains::default()),
        }
    }
}

impl strainwave_app::Board for Board {
    fn restarted(&self) -> bool {
        self.restarted
    }

    // 1000 reports a second, of 40 bytes at most, fit through the USART twice over.
    const REPORT_EVERY: u32 = 10;

    // A function of its own: what plans a move is not on the stack while the control step is.
    #[inline(never)]
    fn input(&mut self, input: &mut Input<f32>) -> bool {
        // Of a failed reading the compensator makes its own prediction, for a while.
        let (motor_encoder, status) = match self.encoder.count() {
            Some(count) => (count, Status::FINE),
            None => (0, Status::MOTOR_ENCODER_INVALID),
        };
        let sensors =
            Sensors { motor_encoder, output_encoder: None, motor_torque: self.torque, output_torque: None };
        let (setpoint, gains) = self.target();
        let (command, gains) = (setpoint.into(), gains.into());
        *input = Input { sensors, status, command, gains, ..Input::default() };
        true
    }

    fn command(&mut self, torque: f32) {
        self.torque = torque;
        self.drive.command(torque);
    }

    // Only before the first move is it asked where the output is.
    fn report(&mut self, output: impl FnOnce() -> Output<f32>) {
        if self.jog.is_some() {
            return;
        }
        self.here.position = output().estimate.output_position;
        self.watched += 1;
        if self.watched == WATCHING {
            self.jog = Some(Jog::at(self.trajectory, self.here.position));
        }
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
