//! A plant whose controller is a chip, in step with a program of the host.

use std::panic::resume_unwind;

use strainwave::Angle;
use strainwave::compensator::{Input, Output};
use strainwave_desktop::GearFile;
use strainwave_desktop::bench::controller::Controller;
use strainwave_desktop::bench::task::Task;
use strainwave_desktop::bench::{Bench, Conditions};
use strainwave_desktop::io::gear_file::SensorSet;
use strainwave_desktop::plant::divergence::RunError;

use crate::chips::chip;
use crate::chips::control::SEED;
use crate::chips::line::{ChipEnd, ProgramEnd, line};
use crate::chips::run_error::Error;

/// A chip with what runs beside it.
pub trait Beside {
    /// What the program brings a period.
    type Ask: Send;
    /// What it sees of one.
    type Look: Send;

    /// A period with the motor encoder at `count`: the torque of the motor (N m), and what the program sees.
    ///
    /// # Errors
    /// [`Error`].
    fn step(&mut self, count: u32, ask: &Self::Ask) -> Result<(f32, Self::Look), Error>;
}

/// Boots a chip with the plant's first reading and lets it go on as long as the program runs; `seen` is told the output's angle after each period.
///
/// # Errors
/// [`Error`].
pub fn run<B: Beside, T: Send>(
    gear: &GearFile,
    task: &impl Task,
    boot: impl Fn(u32) -> Result<B, Error>,
    program: impl FnOnce(ProgramEnd<B::Ask, B::Look>) -> T + Send,
    mut seen: impl FnMut(Angle<f64>),
) -> Result<(T, B), Error> {
    let conditions = Conditions { sensors: SensorSet::Motor, ..Conditions::of(gear, SEED) };
    let mut bench = Bench::condensed(gear, &conditions).map_err(RunError::from)?;
    let (end, program_end) = line();
    std::thread::scope(|scope| {
        let program = scope.spawn(move || program(program_end));
        let mut booting = Booting { boot, end, beside: None };
        let ended = bench.go(task, &mut booting, |_, _, plant, _| seen(plant.output().angle));
        let Booting { end, beside, .. } = booting;
        // The program ends when the chip has.
        drop(end);
        let found = program.join().unwrap_or_else(|panic| resume_unwind(panic));
        if let Err(Ended::Failed(error)) = ended {
            return Err(error);
        }
        let never = || chip::Error::NotStarted { said: "no period was run".into() };
        Ok((found, beside.ok_or_else(never)?))
    })
}

/// Why the plant stands still.
enum Ended {
    Program,
    Failed(Error),
}

impl From<RunError> for Ended {
    fn from(error: RunError) -> Self {
        Self::Failed(error.into())
    }
}

/// Boots the chip with the plant's first reading.
struct Booting<B: Beside, F> {
    boot: F,
    end: ChipEnd<B::Ask, B::Look>,
    beside: Option<B>,
}

impl<B: Beside, F: Fn(u32) -> Result<B, Error>> Controller for Booting<B, F> {
    type Error = Ended;

    fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, Ended> {
        let count = input.sensors.motor_encoder;
        let Some(ask) = self.end.ask() else { return Err(Ended::Program) };
        let beside = match &mut self.beside {
            Some(beside) => beside,
            none => none.insert((self.boot)(count).map_err(Ended::Failed)?),
        };
        let (motor_torque, look) = beside.step(count, &ask).map_err(Ended::Failed)?;
        self.end.show(look);
        Ok(Output { motor_torque, ..Output::default() })
    }
}
