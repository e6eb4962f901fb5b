//! The histories that cost the hysteresis most on the emulated board, to be counted. Wiring only.
#![no_std]
#![no_main]

#[path = "../machine.rs"]
mod machine;

use strainwave_app::Error;
use strainwave_app::worst_case::{AGREEMENT, drive};

strainwave_mps::counted!(machine::An386, agrees);

fn agrees() -> Result<bool, Error> {
    let worst = drive()?;
    defmt::info!("inverse {=f32} off, allowed: {=f32}", worst, AGREEMENT);
    Ok(worst <= AGREEMENT)
}
