//! Scenario S8 on the target: torque by strain gauges, every step on the emulated processor, and the same step on the host.

use std::path::Path;

use strainwave::flexspline::GaugeTorque;
use strainwave_app::torque_gauges::{
    self as program, GAUGES, OUTPUT_BYTES, Program, decode_torque, encode, encode_reading,
};
use strainwave_desktop::GearFile;
use strainwave_desktop::bench::torque_sensing::{Errors, Reading, Record, judge};

use crate::machine::Machine;
use crate::target::{Agreement, Error};

/// A run of a seed on the target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaugesRun {
    /// Errors of the target's torque.
    pub errors: Errors,
    /// Steps, and those in which any bit of torque, deviation or displacements differed from the host's.
    pub agreement: Agreement,
}

/// Boots the program at `elf` with `arguments` for the emulator, and judges the seed's torque as the target tells it.
///
/// # Errors
/// As [`Machine::boot`], and when the target ends or hangs.
pub fn run(elf: &Path, arguments: &[String], record: &Record, seed: u64) -> Result<GaugesRun, Error> {
    let mut machine = Machine::boot(elf, arguments)?;
    let mut host = Program::build()?;
    let mut agreement = Agreement::default();
    let errors = judge(&GearFile::default_gear(), record, seed, |read: &Reading<GAUGES>| {
        let reading = reading(read);
        let answer: [u8; OUTPUT_BYTES] = machine.exchange_frame(&encode_reading(&reading))?;
        agreement.steps += 1;
        agreement.different += u64::from(answer != encode(&host.step(&reading)));
        Ok::<GaugeTorque<f32>, Error>(decode_torque(&answer))
    })?;
    machine.end()?;
    Ok(GaugesRun { errors, agreement })
}

fn reading(read: &Reading<GAUGES>) -> program::Reading {
    program::Reading {
        strains: read.strains,
        phase: read.wave_generator.phase(),
        reference: Some(read.reference),
    }
}
