//! The default gear with its hardening in the bend links: literal mesh against the catalogue, reduced mesh against literal mesh.
//!
//! Stiffness and line as in `stiffness.rs`; the law is that of the reduced mesh of the same size; ripple as in `ripple.rs`, the
//! scenarios as in `real_time.rs`: there the real-time gear has 8 x 3 nodes and the reference 36 x 4.

use strainwave::Error;
use strainwave::flexspline::{FlexsplineParams, Reduced};

use super::stiffness::{off_k1, worst_off};
use super::{real_time, ripple};
use crate::bench::scenario::Scenario;
use crate::design::joint::gear_params;
use crate::io::figure::Figure;
use crate::io::gear_file::{GearFile, Hardening};
use crate::plant::divergence::RunError;
use crate::verify::bounds;

pub(super) fn measure(default: &GearFile) -> Result<Vec<Figure>, RunError> {
    let mut file = default.clone();
    file.flexspline.hardening = Hardening::Bends;
    let params = &gear_params(&file).flexspline;
    let rated = file.gear.rated_torque;
    let line = params.line.build()?;
    let mut figures = vec![
        bounds::figure("flexspline.bends.8x3.k1", off_k1::<8, 3>(params)?),
        bounds::figure("flexspline.bends.36x4.k1", off_k1::<36, 4>(params)?),
        bounds::figure(
            "flexspline.bends.8x3.line",
            worst_off::<8, 3>(params, rated, |phi| line.torque(phi))?,
        ),
        bounds::figure(
            "flexspline.bends.36x4.line",
            worst_off::<36, 4>(params, rated, |phi| line.torque(phi))?,
        ),
        bounds::figure(
            "flexspline.bends.48x6.line",
            worst_off::<48, 6>(params, rated, |phi| line.torque(phi))?,
        ),
        bounds::figure("flexspline.bends.8x3.law", off_law::<8, 3>(params, rated)?),
        bounds::figure("flexspline.bends.36x4.law", off_law::<36, 4>(params, rated)?),
    ];
    figures.extend(ripple::named(
        &file,
        ["flexspline.bends.8x3.ripple", "flexspline.bends.8x3.ellipse_reaction"],
    )?);
    figures.extend(real_time::over(
        [
            (Scenario::S1, "flexspline.bends.real_time.s1.rms", "flexspline.bends.real_time.s1.max"),
            (Scenario::S3, "flexspline.bends.real_time.s3.rms", "flexspline.bends.real_time.s3.max"),
            (Scenario::S6, "flexspline.bends.real_time.s6.rms", "flexspline.bends.real_time.s6.max"),
        ],
        &file,
    )?);
    Ok(figures)
}

/// Largest distance of the settled mesh from its reduced law up to rated torque, as a fraction of it.
fn off_law<const N: usize, const M: usize>(params: &FlexsplineParams<f64>, rated: f64) -> Result<f64, Error> {
    let reduced = Reduced::<f64, N, M>::build(params, rated)?;
    worst_off::<N, M>(params, rated, |torsion| reduced.torque(torsion, 0.0))
}
