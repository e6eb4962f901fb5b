//! The first second of control in the emulator: whether a joint is alive on its board.
//!
//! The image starts and goes through the first second of the working motion against the reference plant of the gear: moves
//! there and back, within what the joint can do.

use std::path::Path;

use strainwave::compensator::{Faults, Mode};
use strainwave_desktop::bench::task::{Demand, Task, periods};
use strainwave_desktop::bench::working_motion::WorkingMotion;
use strainwave_desktop::bench::{Bench, Conditions};
use strainwave_desktop::design::capability::Capability;
use strainwave_desktop::design::joint::joint_params;
use strainwave_desktop::verify::bounds;
use strainwave_desktop::verify::judge::faults::Raised;
use strainwave_desktop::{Figure, GearFile};

use crate::machine::Machine;
use crate::target::{self, Target};

/// The nominal plant.
const SEED: u64 = 0;

/// The first second of the working motion.
struct FirstSecond;

impl Task for FirstSecond {
    fn duration(&self) -> f64 {
        1.0
    }

    fn at(&self, time: f64, capability: &Capability) -> Demand {
        WorkingMotion.at(time, capability)
    }
}

/// Starts the image at `elf`, which was built for `gear` and `board`, and lets it control for a second.
///
/// Figures: control periods in which it controlled, all of them; faults, none but that the torque was limited; periods in which an output
/// differs from the host's; the largest error of the output (rad).
///
/// # Errors
/// When the image does not start, hangs or ends, or the gear has no plant.
pub fn control_for_a_second(board: &str, elf: &Path, gear: &GearFile) -> Result<Vec<Figure>, target::Error> {
    let mut target = Target::new(Machine::boot(elf, &[])?, &joint_params(gear)?)?;
    let mut bench = Bench::build(gear, &Conditions::of(gear, SEED))?;
    let (mut active, mut faults, mut error) = (0_u32, Raised::default(), 0.0_f64);
    bench.go(&FirstSecond, &mut target, |_, demand, plant, answer| {
        active += u32::from(answer.mode == Mode::Active);
        faults.add(answer.faults);
        error = error.max((plant.output().angle.to_radians() - demand.position).abs());
    })?;
    let agreement = target.agreement();
    target.finish()?;
    let name = |rest: &str| format!("flash.{board}.{rest}");
    let counted = faults.times().filter(|(fault, ..)| *fault != Faults::TORQUE_LIMITED).count();
    let mut figures = vec![
        Figure::at_least(name("active"), f64::from(active), "1", periods(&FirstSecond) as f64),
        bounds::figure_as(name("faults"), "pil.faults", counted as f64),
    ];
    figures.extend(faults.times().map(|(_, fault, time)| {
        Figure::reported(name(&format!("fault.{}", fault.replace(' ', "_"))), time, "s")
    }));
    figures.push(agreement.figure(name("steps_unlike_host")));
    figures.push(Figure::reported(name("error.max"), error, "rad"));
    Ok(figures)
}
