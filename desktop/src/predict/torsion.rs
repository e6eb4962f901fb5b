//! The torsion of a measured output torque: stiffness line and hysteresis in parallel, inverted.
//!
//! ```text
//! phi[k]:  line(phi) + tau_hyst[phi] = tau_out[k]
//! ```
//!
//! Never loaded before the first row; independent of the rate.

use strainwave::Error;
use strainwave::compensator::{HYSTERESIS_LEVELS, HYSTERESIS_MEMORY};
use strainwave::hysteresis::TorsionHysteresisState;

use crate::design::joint::firmware_gear_params;
use crate::io::gear_file::GearFile;

/// Torsion (rad) at every output torque (N m).
pub(super) fn predict(file: &GearFile, torque: &[f64]) -> Result<Vec<f64>, Error> {
    let params = firmware_gear_params::<f32>(file)?;
    let line = params.flexspline.line.build()?;
    let hysteresis = params.hysteresis::<HYSTERESIS_LEVELS, HYSTERESIS_MEMORY>()?;
    let inverse = hysteresis.inverse(&line)?;
    let mut state = TorsionHysteresisState::default();
    let step = |torque: &f64| {
        let torsion = inverse.torsion(&state, *torque as f32);
        hysteresis.step(&mut state, torsion);
        f64::from(torsion)
    };
    Ok(torque.iter().map(step).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// After +-rated torque the loop is as wide at no torque as the gear file says.
    #[test]
    fn the_loop_has_its_width() {
        let file = GearFile::default_gear();
        let rated = file.gear.rated_torque;
        let found = predict(&file, &[rated, 0.0, -rated, 0.0]).unwrap();
        assert!(((found[1] - found[3]) / file.hysteresis.width() - 1.0).abs() < 0.02, "{found:?}");
    }
}
