//! The literal mesh on the emulated board, to be counted: wound up once, compared with its reduction. Wiring only.
#![no_std]
#![no_main]

#[path = "../machine.rs"]
mod machine;

use strainwave_app::Error;
use strainwave_app::literal_mesh::{AGREEMENT, default_gear, wind_up};

strainwave_mps::counted!(machine::An386, agrees);

fn agrees() -> Result<bool, Error> {
    let end = wind_up(&default_gear::JOINT)?;
    defmt::info!(
        "literal mesh {=f32} N m, reduced {=f32} N m, allowed: {=f32} of it apart",
        end.literal,
        end.reduced,
        AGREEMENT
    );
    Ok(end.agrees())
}
