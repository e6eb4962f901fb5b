//! Payload that a trial of the joint has and its compensator is not told.

use clap::Args;
use strainwave_desktop::plant::payload::Payload;
use strainwave_desktop::{BadInput, GearFile};

/// Options of the payload.
#[derive(Args)]
pub struct PayloadArguments {
    /// Inertia attached to the output that the compensator is not told (kg m^2)
    #[arg(long, value_name = "KG_M2", conflicts_with = "replay", allow_hyphen_values = true)]
    payload: Option<f64>,
    /// Mass attached to the output that the compensator is not told (kg), at --payload-lever, with its weight
    #[arg(
        long,
        value_name = "KG",
        requires = "payload_lever",
        conflicts_with = "replay",
        allow_hyphen_values = true
    )]
    payload_mass: Option<f64>,
    /// Distance of that mass from the output's axis (m)
    #[arg(long, value_name = "M", requires = "payload_mass", allow_hyphen_values = true)]
    payload_lever: Option<f64>,
    /// Output angle at which that mass hangs below the axis (rad); 0 when left out
    #[arg(long, value_name = "RAD", requires = "payload_mass", allow_hyphen_values = true)]
    payload_hangs_at: Option<f64>,
}

impl PayloadArguments {
    /// Some payload was given.
    pub fn given(&self) -> bool {
        self.payload.is_some() || self.payload_mass.is_some()
    }

    /// The payload; one whose weight the gear does not bear is refused.
    pub fn of(&self, gear: &GearFile) -> Result<Payload, BadInput> {
        let inertia = within("--payload", self.payload, [0.0, 1e5], "kg m^2")?;
        let mass = within("--payload-mass", self.payload_mass, [0.0, 1e5], "kg")?;
        let lever = within("--payload-lever", self.payload_lever, [0.0, 100.0], "m")?;
        let hanging = within("--payload-hangs-at", self.payload_hangs_at, [-1e6, 1e6], "rad")?;
        let payload = Payload::new(inertia, [mass, lever], hanging);
        let most = gear.gear.peak_torque;
        if payload.gravity > most {
            return Err(BadInput::message(format_args!(
                "--payload-mass {mass} --payload-lever {lever}: {:.4} N m of weight; allowed: at most \
                 gear.peak_torque_nm = {most}",
                payload.gravity
            )));
        }
        Ok(payload)
    }
}

/// A number of an option, 0 without it.
fn within(name: &str, value: Option<f64>, [least, most]: [f64; 2], unit: &str) -> Result<f64, BadInput> {
    let value = value.unwrap_or(0.0);
    if (least..=most).contains(&value) {
        return Ok(value);
    }
    let why =
        format_args!("{name} {value} is out of range; allowed: a number from {least:e} to {most:e} {unit}");
    Err(BadInput::message(why))
}
