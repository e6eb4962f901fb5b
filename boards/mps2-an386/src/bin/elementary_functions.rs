//! The elementary functions of several libraries on the emulated board, to be counted. Wiring only.
#![no_std]
#![no_main]

#[path = "../machine.rs"]
mod machine;

use strainwave_app::Error;
use strainwave_app::elementary_functions::{AGREEMENT, drive};

strainwave_mps::counted!(machine::An386, agrees);

fn agrees() -> Result<bool, Error> {
    let worst = drive();
    defmt::info!("ours and libm's {=f32} apart, allowed: {=f32}", worst, AGREEMENT);
    Ok(worst <= AGREEMENT)
}
