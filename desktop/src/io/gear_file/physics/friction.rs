//! Whether the friction model that a side names can be built, from the keys of the file.

use strainwave::Error;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::friction::data::MOST_STATES;
use strainwave::friction::{FrictionParams, ModelName, RIPPLE_ORDERS};

use crate::io::gear_file::GearFile;
use crate::io::gear_file::friction::Friction;
use crate::io::gear_file::friction_params::friction_params;

pub(super) fn input(gear: &GearFile) -> Result<(), String> {
    check("friction.input", &gear.friction.input, gear.driving_inertia())
}

pub(super) fn output(gear: &GearFile) -> Result<(), String> {
    check("friction.output", &gear.friction.output, gear.inertia.flexspline)
}

/// The side at `path` can be built, and does not turn a speed around in a control period with this inertia (kg m^2).
///
/// # Errors
/// One line that names the key, its value and what is allowed.
pub(crate) fn check(path: &str, side: &Friction, inertia: f64) -> Result<(), String> {
    let refused = damped(side, inertia).and_then(|()| built(side));
    refused.map_err(|Refused { key, value, allowed }| {
        let value = value.map_or(String::new(), |value| format!(" = {value}"));
        format!("{path}.{key}{value} is out of range; allowed: {allowed}")
    })
}

/// A key of a side, its value where it is one number, and what is allowed.
struct Refused {
    key: &'static str,
    value: Option<f64>,
    allowed: String,
}

/// A step of the real-time build does not turn a speed around.
fn damped(side: &Friction, inertia: f64) -> Result<(), Refused> {
    let most = inertia / CONTROL_PERIOD;
    let damping = [
        ("viscous_nm_s_per_rad", side.viscous),
        ("backward.viscous_nm_s_per_rad", side.backwards().viscous),
        ("micro_damping_nm_s_per_rad", side.micro_damping),
    ];
    match damping.into_iter().find(|(_, value)| value.is_some_and(|value| value >= most)) {
        Some((key, value)) => {
            Err(Refused { key, value, allowed: format!("below J/dt = {most:.3e} N m s/rad") })
        }
        None => Ok(()),
    }
}

/// Both builds of the gear have it.
fn built(side: &Friction) -> Result<(), Refused> {
    let refused = |Error::OutOfRange(field)| blame(side, field);
    friction_params::<f64>(side).build().map_err(refused)?;
    friction_params::<f32>(side).build().map_err(refused)?;
    Ok(())
}

/// The key behind the field that a model refuses, each key being in its own range.
fn blame(side: &Friction, field: &str) -> Refused {
    let model = side.model.word();
    let (key, value, allowed) = match field {
        "coulomb" => ("coulomb_nm", side.coulomb, format!("at least 1e-9 N m with model = {model:?}")),
        "stick_gain" => ("coulomb_nm", side.coulomb, format!("above 1e-6 static_nm with model = {model:?}")),
        "stiffness" => ("presliding_rad", side.presliding, stiffness(side.model)),
        "static_level" => {
            ("backward.static_nm", side.backwards().static_level, "at least coulomb_nm backwards".into())
        }
        "forward" => ("ripple_cosines", None, ripple(side)),
        "backward" => ("backward.ripple_cosines", None, ripple(&side.backwards())),
        "a" => ("state_space", None, matrix()),
        "dissipative" => ("state_space", None, dissipative()),
        _ => ("model", None, format!("{field} in the range of model = {model:?}")),
    };
    Refused { key, value, allowed }
}

fn stiffness(model: ModelName) -> String {
    let (level, range) = match model {
        ModelName::LuGre => ("static_nm", "1e-9 to 1e9"),
        ModelName::Armstrong => ("static_nm", "1e-9 to 1e12"),
        ModelName::ResetIntegrator => ("coulomb_nm", "0 to 1e6"),
        ModelName::Bristle => ("coulomb_nm", "0 to 1e13"),
        _ => ("coulomb_nm", "1e-9 to 1e12"),
    };
    format!("{level}/presliding_rad from {range} N m/rad with model = {:?}", model.word())
}

fn ripple(side: &Friction) -> String {
    let fraction = |list: &Option<Vec<f64>>, k: usize| list.iter().flatten().nth(k).copied().unwrap_or(0.0);
    let amplitude = |k| fraction(&side.ripple_cosines, k).hypot(fraction(&side.ripple_sines, k));
    let sum: f64 = (0..RIPPLE_ORDERS).map(amplitude).sum();
    format!("with ripple_sines amplitudes sqrt(a_k^2 + b_k^2) that add up to at most 0.99, not {sum}")
}

fn matrix() -> String {
    format!("1 to {MOST_STATES} states, each a_per_rad with as many numbers, A stable (every mode decays)")
}

fn dissipative() -> String {
    "a model that takes work: the real part of C (i*w*I - A)^-1 B is negative for no w".into()
}
