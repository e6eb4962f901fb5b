//! What makes a gear of the file's numbers: conditions on several keys at once.
//!
//! The cup carries the torque in series with the tooth contact, so the whole is softer than the cup,
//! K3 < G*J/l. The hysteresis loop closes at rated torque, so it is narrower than the torsion there.
//! The real-time build takes one semi-implicit step per control period dt, which is accurate while
//! dt^2*K3 < J_fs/4, and in which what resists in proportion to the speed must not turn a speed around,
//! dt*(Fv + sigma1) < J.

mod friction;

use strainwave::flexspline::Cup;
use strainwave::flexspline::stiffness_line::StiffnessLineParams;

use super::GearFile;

/// Control period of the real-time build (s).
const CONTROL_PERIOD: f64 = 1e-4;

pub(super) fn check(gear: &GearFile) -> Result<(), String> {
    let stiffness = &gear.stiffness;
    let shell = cup(gear).stiffness();
    if stiffness.k3 >= shell {
        let allowed = format!("below the cup's own stiffness G*J/l = {shell:.0} N m/rad");
        return refuse("stiffness.k3_nm_per_rad", stiffness.k3, &allowed);
    }
    let torsion = rated_torsion(gear)?;
    if gear.hysteresis.width() >= torsion {
        let allowed =
            format!("below the torsion at rated torque = {:.3} arcmin", torsion.to_degrees() * 60.0);
        return refuse("hysteresis.width_arcmin", gear.hysteresis.width_arcmin, &allowed);
    }
    let least = 4.0 * CONTROL_PERIOD * CONTROL_PERIOD * stiffness.k3;
    if gear.inertia.flexspline <= least {
        let allowed = format!("above 4*dt^2*K3 = {least:.3e} kg m^2, dt = {CONTROL_PERIOD} s");
        return refuse("inertia.flexspline_kg_m2", gear.inertia.flexspline, &allowed);
    }
    friction::check(gear)
}

fn refuse(path: &str, value: f64, allowed: &str) -> Result<(), String> {
    Err(format!("{path} = {value} is out of range; allowed: {allowed}"))
}

fn cup(gear: &GearFile) -> Cup<f64> {
    let cup = &gear.flexspline;
    Cup {
        radius: cup.radius,
        length: cup.length,
        wall: cup.wall,
        ellipse: cup.ellipse,
        youngs_modulus: cup.youngs_modulus,
        poisson_ratio: cup.poisson_ratio,
        density: cup.density,
    }
}

/// Torsion at rated torque by the catalogue's line (rad).
fn rated_torsion(gear: &GearFile) -> Result<f64, String> {
    let stiffness = &gear.stiffness;
    let line = StiffnessLineParams {
        stiffness: [stiffness.k1, stiffness.k2, stiffness.k3],
        knee_torque: [stiffness.t1, stiffness.t2],
    };
    Ok(line.build().map_err(|error| format!("stiffness: {error}"))?.torsion(gear.gear.rated_torque))
}
