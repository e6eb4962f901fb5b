//! Preisach forward and inverse: the torsion that the default gear needs for a torque depends on its past; the inverse
//! finds it, and the forward operator confirms it.

use strainwave::Error;
use strainwave::compensator::{HYSTERESIS_LEVELS, HYSTERESIS_MEMORY};
use strainwave::hysteresis::{TorsionHysteresis, TorsionHysteresisState};

mod joint {
    include!("joint/hd25_100.rs"); // generated from gears/hd25-100.toml
}
use joint::JOINT;

fn main() -> Result<(), Error> {
    let line = JOINT.gear.flexspline.line.build()?;
    let hysteresis: TorsionHysteresis<f32, HYSTERESIS_LEVELS, HYSTERESIS_MEMORY> = JOINT.gear.hysteresis()?;
    let inverse = hysteresis.inverse(&line)?;
    let mut state = TorsionHysteresisState::default();
    println!("target torque [N m]   torsion [urad]   of the line alone   torque that it gives [N m]");
    let mut worst = 0.0f32;
    for target in [20.0, 0.0, 67.0, 0.0, -67.0, 0.0, 30.0, -10.0, 30.0, 0.0] {
        let torsion = inverse.torsion(&state, target);
        let given = line.torque(torsion) + hysteresis.step(&mut state, torsion).torque;
        worst = worst.max((given - target).abs());
        println!("{target:19.1} {:16.1} {:19.1} {given:28.6}", torsion * 1e6, line.torsion(target) * 1e6);
    }
    println!("largest difference: {worst:.1e} N m");
    println!(
        "At 0 N m the torsion differs by up to {:.0} urad: the width of the loop.",
        JOINT.gear.hysteresis_width * 1e6
    );
    Ok(())
}
