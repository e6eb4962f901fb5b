//! Torque by strain gauges on the emulated board, reading by reading from the host. Wiring only.
#![no_std]
#![no_main]

#[path = "../machine.rs"]
mod machine;

use strainwave_app::Error;
use strainwave_app::torque_gauges::{INPUT_BYTES, Program, decode, encode};
use strainwave_mps::link::Link;

strainwave_mps::counted!(machine::An386, answers);

fn answers() -> Result<bool, Error> {
    let Some(link) = Link::open() else {
        defmt::error!("sensors.fifo or command.fifo does not open");
        return Ok(false);
    };
    let mut program = Program::build()?;
    let (mut sound, mut frame) = (true, [0; INPUT_BYTES]);
    while link.read(&mut frame) && sound {
        sound = link.write(&encode(&program.step(&decode(&frame))));
    }
    Ok(sound)
}
