//! The belt gear against closed forms and scipy, its energy, its reduction against the chain, and f32 against f64.

mod chain;
mod energy;
mod oracle;
mod precision;
mod reduction;
mod statics;
pub mod wrist;

use strainwave::belt::{BeltParams, PitchErrorParams, SpanParams};
use strainwave::friction::ViscousParams;

use super::Measured;
use crate::design::belt::belt_params;
use crate::io::belt_file::BeltFile;

/// Every figure.
pub(super) fn measure() -> Measured {
    let figures = [
        statics::measure(),
        chain::measure(),
        oracle::measure(),
        energy::measure(),
        reduction::measure(),
        precision::measure(),
    ];
    Measured::from(figures.concat())
}

/// The example belt without friction and pitch error, with this damping over stiffness (s) and viscous friction at the
/// output (N m s/rad).
fn plain(damping_time: f64, viscous: f64) -> BeltParams<f64, ViscousParams<f64>> {
    let params = belt_params::<f64>(&BeltFile::example());
    BeltParams {
        pitch: params.pitch,
        belt_teeth: params.belt_teeth,
        span: SpanParams { damping_time, ..params.span },
        motor: params.motor,
        output: params.output,
        pitch_error: PitchErrorParams::default(),
        motor_friction: ViscousParams { viscous: 0.0 },
        output_friction: ViscousParams { viscous },
    }
}
