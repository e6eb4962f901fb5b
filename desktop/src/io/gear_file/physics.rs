//! Physical conditions on a gear file: those on several keys at once.
//!
//! The cup transmits the torque in series with the tooth contact, so the whole is softer than the cup,
//! K3 < G*J/l. Bend links that harden can stiffen a mesh only so far, the reference mesh to three times its K1. The hysteresis loop closes at rated torque, so it is narrower than the torsion there. Identified
//! weights are symmetric, and no branch of theirs falls faster than the line rises: the torque grows with the
//! torsion. Nowhere does a branch fall faster than the major loop's rising one at the same torsion.
//! The real-time build takes one semi-implicit step per control period dt, which is accurate while
//! dt^2*K3 < J_fs/4, and in which what resists in proportion to the speed must not turn a speed around,
//! dt*(Fv + sigma1) < J. An encoder whose count may not repeat for long has noise that changes it.

pub(crate) mod friction;

use std::f64::consts::{PI, TAU};

use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::flexspline::stiffness_line::{StiffnessLine, StiffnessLineParams};
use strainwave::flexspline::{Bend, Cup, FlexsplineParams, Hardening as Place};
use strainwave::hysteresis::table::TABLE_LEVELS;
use strainwave::hysteresis::{TorsionHysteresis, TorsionHysteresisState};

use super::{DrivingBelt, GearFile, Hardening};

/// Turning points of a branch that never turns: the fewest that a memory may have.
const STEPS_BACK: usize = 8;

/// Most that the bend links' slope may gain: 99 times that of the others.
const LARGEST_GAIN: f64 = 99.0;
/// Nodes of the reference mesh, around and along.
const REFERENCE: (usize, usize) = (36, 4);

/// A condition, and the sections whose keys it reads.
struct Condition {
    sections: &'static [&'static str],
    check: fn(&GearFile) -> Result<(), String>,
}

const CONDITIONS: [Condition; 10] = [
    Condition { sections: &["belt"], check: belt_engaged },
    Condition { sections: &["stiffness", "flexspline"], check: softer_than_cup },
    Condition { sections: &["stiffness", "flexspline"], check: bends_in_reach },
    Condition { sections: &["hysteresis", "stiffness", "gear"], check: narrow_loop },
    Condition { sections: &["hysteresis", "stiffness"], check: check_weights },
    Condition { sections: &["drive"], check: ordered_current_loop },
    Condition { sections: &["sensors"], check: noise_shows },
    Condition { sections: &["inertia", "stiffness"], check: slow_mode },
    Condition { sections: &["friction", "inertia", "belt"], check: friction::input },
    Condition { sections: &["friction", "inertia"], check: friction::output },
];

/// The conditions that do not hold, of those that read none of the `damaged` sections, a line each.
pub(super) fn faults(gear: &GearFile, damaged: &[&str]) -> Vec<String> {
    let sound = |condition: &&Condition| !condition.sections.iter().any(|section| damaged.contains(section));
    let conditions = CONDITIONS.iter().filter(sound);
    conditions.filter_map(|condition| (condition.check)(gear).err()).collect()
}

fn belt_engaged(gear: &GearFile) -> Result<(), String> {
    gear.belt.as_ref().map_or(Ok(()), DrivingBelt::check)
}

fn softer_than_cup(gear: &GearFile) -> Result<(), String> {
    let shell = gear.cup_stiffness();
    if gear.stiffness.k3 < shell {
        return Ok(());
    }
    let allowed = format!("below the cup's own stiffness G*J/l = {shell:.0} N m/rad");
    refuse("stiffness.k3_nm_per_rad", gear.stiffness.k3, &allowed)
}

/// The bend links of the reference mesh can follow the line, or have a law of their own that hardens and is not too stiff.
fn bends_in_reach(gear: &GearFile) -> Result<(), String> {
    let cup_keys = &gear.flexspline;
    let (hardening, saturation) = (cup_keys.bend_hardening, cup_keys.bend_saturation);
    if cup_keys.hardening == Hardening::Contact {
        return Ok(());
    }
    if hardening > 0.0 {
        let stiffest = 3.0 * hardening * saturation * saturation;
        if stiffest > 0.0 && stiffest <= LARGEST_GAIN {
            return Ok(());
        }
        let most = (LARGEST_GAIN / (3.0 * hardening)).sqrt();
        let allowed = format!("above 0 to {most:.3e} with hardening = \"bends\" and this bend_hardening");
        return refuse("flexspline.bend_saturation", saturation, &allowed);
    }
    let params = FlexsplineParams {
        cup: cup(gear),
        line: stiffness_params(gear),
        damping_ratio: gear.damping.torsion_mode_ratio,
        inertia: gear.inertia.flexspline,
        hardening: Place::Bends,
        bend: Bend::LINEAR,
    };
    if params.shell::<{ REFERENCE.1 }>(REFERENCE.0).bend.hardening > 0.0 {
        return Ok(());
    }
    let allowed = "above stiffness.k1_nm_per_rad and below what bend links can reach, some 2.8 times that, with \
                   flexspline.hardening = \"bends\"";
    refuse("stiffness.k3_nm_per_rad", gear.stiffness.k3, allowed)
}

fn narrow_loop(gear: &GearFile) -> Result<(), String> {
    let torsion = rated_torsion(gear)?;
    if gear.hysteresis.width() < torsion {
        return Ok(());
    }
    let allowed = format!("below the torsion at rated torque = {:.3} arcmin", torsion.to_degrees() * 60.0);
    refuse("hysteresis.width_arcmin", gear.hysteresis.width_arcmin, &allowed)
}

fn ordered_current_loop(gear: &GearFile) -> Result<(), String> {
    let drive = &gear.drive;
    if drive.least_current_loop <= drive.largest_current_loop {
        return Ok(());
    }
    let allowed = format!("at most drive.current_loop_largest_hz = {} Hz", drive.largest_current_loop);
    refuse("drive.current_loop_least_hz", drive.least_current_loop, &allowed)
}

/// A count that may repeat so long and no longer has enough noise: an encoder at rest is read every second period by the detector, and tells the
/// same as before with the probability 1/(2 sqrt(pi) s), of Gaussian noise of the deviation s counts. In ten hours, of intervals of 16
/// periods, the chance of so many in a row is then below 1e-6.
fn noise_shows(gear: &GearFile) -> Result<(), String> {
    const LOGARITHM: f64 = 31.0;
    let Some(still) = gear.sensors.motor_encoder_still else { return Ok(()) };
    let count = TAU / f64::from(gear.sensors.motor_encoder_bits).exp2();
    let Some(noise) = gear.sensors.motor_encoder_noise else {
        return Err("sensors.motor_encoder_still_periods without sensors.motor_encoder_noise_rad".into());
    };
    let counts = noise / count;
    let least = 2.0 * LOGARITHM / (2.0 * PI.sqrt() * counts).ln();
    if least > 0.0 && f64::from(still) >= least {
        return Ok(());
    }
    let allowed = if least > 0.0 && least <= 1000.0 {
        format!(
            "at least {:.0}, for a noise of {counts:.1} counts (sensors.motor_encoder_noise_rad)",
            least.ceil()
        )
    } else {
        format!(
            "none, for a noise of {counts:.1} counts (sensors.motor_encoder_noise_rad) need not change a count"
        )
    };
    refuse("sensors.motor_encoder_still_periods", still.into(), &allowed)
}

fn slow_mode(gear: &GearFile) -> Result<(), String> {
    let least = gear.least_flexspline_inertia();
    if gear.inertia.flexspline > least {
        return Ok(());
    }
    let allowed = format!("above 4*dt^2*K3 = {least:.3e} kg m^2, dt = {CONTROL_PERIOD} s");
    refuse("inertia.flexspline_kg_m2", gear.inertia.flexspline, &allowed)
}

fn check_weights(gear: &GearFile) -> Result<(), String> {
    let (weights, half_range) = match (&gear.hysteresis.weights, gear.hysteresis.half_range) {
        (None, None) => return Ok(()),
        (Some(weights), Some(half_range)) => (weights, half_range),
        (Some(_), None) => return Err("hysteresis.weights_nm without hysteresis.half_range_rad".into()),
        (None, Some(_)) => return Err("hysteresis.half_range_rad without hysteresis.weights_nm".into()),
    };
    let last = weights.len() - 1;
    for (i, row) in weights.iter().enumerate() {
        for (j, weight) in row.iter().enumerate() {
            let mirror = weights[last - j][last - i];
            if *weight != mirror {
                let allowed =
                    format!("its mirror image hysteresis.weights_nm[{}][{}] = {mirror}", last - j, last - i);
                return refuse(&format!("hysteresis.weights_nm[{i}][{j}]"), *weight, &allowed);
            }
        }
    }
    check_slope(gear, half_range)
}

/// Torque over torsion rises on the steepest fall of the hysteresis, the major loop's branch from -U up.
fn check_slope(gear: &GearFile, half_range: f64) -> Result<(), String> {
    let Some(table) = gear.hysteresis.table::<f64>() else { return Ok(()) };
    let model = table.weights().and_then(|weights| {
        TorsionHysteresis::<f64, TABLE_LEVELS, STEPS_BACK>::from_weights(half_range, &weights)
    });
    let model = model.map_err(|error| format!("hysteresis.weights_nm: {error}"))?;
    let line = stiffness_line(gear)?;
    let mut state = TorsionHysteresisState::default();
    let mut before = model.step(&mut state, -half_range).torque + line.torque(-half_range);
    for k in 1..=TABLE_LEVELS {
        let torsion = half_range * (2.0 * k as f64 / TABLE_LEVELS as f64 - 1.0);
        let torque = model.step(&mut state, torsion).torque + line.torque(torsion);
        if torque <= before {
            let torsion = torsion.to_degrees() * 60.0;
            return Err(format!(
                "hysteresis.weights_nm: the torque falls with the torsion below {torsion:.3} arcmin; allowed: weights \
                 whose loop is flatter than stiffness.k1_nm_per_rad"
            ));
        }
        before = torque;
    }
    Ok(())
}

fn refuse(path: &str, value: f64, allowed: &str) -> Result<(), String> {
    Err(format!("{path} = {value} is out of range; allowed: {allowed}"))
}

impl GearFile {
    /// Inertia of flexspline and load that a step of the real-time build needs at the stiffness K3, 4*dt^2*K3 (kg m^2).
    pub fn least_flexspline_inertia(&self) -> f64 {
        4.0 * CONTROL_PERIOD * CONTROL_PERIOD * self.stiffness.k3
    }

    /// Stiffness of the cup itself, without the teeth, G*J/l (N m/rad).
    pub fn cup_stiffness(&self) -> f64 {
        cup(self).stiffness()
    }
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
    Ok(stiffness_line(gear)?.torsion(gear.gear.rated_torque))
}

fn stiffness_line(gear: &GearFile) -> Result<StiffnessLine<f64>, String> {
    stiffness_params(gear).build().map_err(|error| format!("stiffness: {error}"))
}

fn stiffness_params(gear: &GearFile) -> StiffnessLineParams<f64> {
    let stiffness = &gear.stiffness;
    StiffnessLineParams {
        stiffness: [stiffness.k1, stiffness.k2, stiffness.k3],
        knee_torque: [stiffness.t1, stiffness.t2],
    }
}
