//! The gear file: one TOML file that describes a joint.
//!
//! Keys carry their unit (`[stiffness] k1_nm_per_rad`); the fields here are the same numbers in the
//! same SI units, without the suffix. [`KEYS`] lists every key with what it may hold: an unknown or
//! missing key, a wrong type and a value out of range are refused by one line that names the file,
//! the key, the value and what is allowed; so is a number that vanishes or overflows in the controller's f32.
//! [`GearFile::faultless`] tells everything that is wrong with a file, the other readers the first of it.
//!
//! Which keys of `[friction]` a file must have depends on the friction model that it names: see [`friction`].
//!
//! Signs and symbols: the signed ratio is r = -1/N with the circular spline fixed and +1/(N+1) with
//! the flexspline fixed (then the output is the circular spline).

mod aliases;
mod baselines;
pub mod belt;
pub(crate) mod drive;
pub mod friction;
pub(crate) mod friction_keys;
pub mod friction_params;
mod gains;
mod keys;
mod learnt;
pub(crate) mod physics;
mod sensor_set;
mod text;

use serde::{Deserialize, Serialize};
use strainwave::friction::ModelName;
use strainwave::hysteresis::HysteresisTable;
use strainwave::{Ratio, Real};

pub use crate::io::keyed_file::key::{Allowed, Key, Relation};
pub use baselines::Baselines;
pub use belt::DrivingBelt;
pub use drive::{Drive, Tolerances};
pub use friction::{Backward, BothFrictions, Friction, StateRow};
pub use gains::{BaselineGains, GAINS, Gain, Kind, StoredGains};
pub use keys::{KEYS, RELATIONS};
pub use learnt::Learnt;
pub use sensor_set::SensorSet;

/// The default gear `hd25-100`, as a file.
pub const DEFAULT: &str = include_str!("../../../../gears/hd25-100.toml");

/// The gear of a measured joint, size 17 by its catalogue line, as a file.
pub const LARA8_J5: &str = include_str!("../../../../gears/lara8-j5.toml");

/// Gears of measured joints that move, by their catalogue lines, as files: joint and text.
pub const LARA8_MOVING: [(&str, &str); 4] = [
    ("j1", include_str!("../../../../gears/lara8-j1.toml")),
    ("j2", include_str!("../../../../gears/lara8-j2.toml")),
    ("j3", include_str!("../../../../gears/lara8-j3.toml")),
    ("j6", include_str!("../../../../gears/lara8-j6.toml")),
];

/// The default gear and those of the measured joints: path and text.
pub fn shipped() -> impl Iterator<Item = (String, &'static str)> {
    let measured = LARA8_MOVING.into_iter().chain([("j5", LARA8_J5)]);
    let measured = measured.map(|(joint, text)| (format!("gears/lara8-{joint}.toml"), text));
    [("gears/hd25-100.toml".into(), DEFAULT)].into_iter().chain(measured)
}

/// A gear file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GearFile {
    /// Name, ratio and ratings.
    pub gear: Gear,
    /// The catalogue's torsion curve.
    pub stiffness: Stiffness,
    /// Hysteresis of the torsion curve.
    pub hysteresis: Hysteresis,
    /// Position error of the ideal gear.
    #[serde(default, skip_serializing_if = "KinematicError::is_empty")]
    pub kinematic_error: KinematicError,
    /// The cup.
    pub flexspline: Flexspline,
    /// Inertia of both sides.
    pub inertia: Inertia,
    /// Structural damping.
    pub damping: Damping,
    /// Tooth belt in front of the wave generator; the motor is on its shaft when it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub belt: Option<DrivingBelt>,
    /// Friction of both sides.
    pub friction: BothFrictions,
    /// Limits of the motor.
    pub motor: Motor,
    /// Drive: from torque command to torque.
    #[serde(default)]
    pub drive: Drive,
    /// Tolerances of the parameters.
    #[serde(default)]
    pub tolerances: Tolerances,
    /// Sensors of the joint.
    pub sensors: Sensors,
    /// Tuning of the cascaded feedback.
    pub feedback: Feedback,
    /// Compensation functions.
    pub compensation: Compensation,
    /// Learnt factors and ripple of the joint; none when it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub learnt: Option<Learnt>,
    /// Tuned gains of the baselines; an omitted one follows from its rule.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub baselines: Option<Baselines>,
}

/// Which of the three parts stands still.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Arrangement {
    /// The flexspline is the output, turning against the wave generator: r = -1/N.
    CircularSplineFixed,
    /// The circular spline is the output, turning with the wave generator: r = +1/(N+1).
    FlexsplineFixed,
}

/// `[gear]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gear {
    /// Name of the gear.
    pub name: String,
    /// N, teeth of the flexspline over the difference of teeth.
    pub ratio: i32,
    /// Which part stands still.
    pub arrangement: Arrangement,
    /// Rated torque at the output (N m).
    #[serde(rename = "rated_torque_nm")]
    pub rated_torque: f64,
    /// Peak torque at the output (N m).
    #[serde(rename = "peak_torque_nm")]
    pub peak_torque: f64,
}

impl Gear {
    /// The signed ratio r of output to wave-generator angle.
    pub fn signed_ratio(&self) -> Ratio {
        let n = match self.arrangement {
            Arrangement::CircularSplineFixed => -self.ratio,
            Arrangement::FlexsplineFixed => self.ratio + 1,
        };
        Ratio::one_over(n).expect("the range of gear.ratio lies within that of Ratio")
    }
}

/// `[stiffness]`: slope K1 up to the torque T1, K2 up to T2, K3 beyond.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stiffness {
    /// K1 (N m/rad).
    #[serde(rename = "k1_nm_per_rad")]
    pub k1: f64,
    /// K2 >= K1 (N m/rad).
    #[serde(rename = "k2_nm_per_rad")]
    pub k2: f64,
    /// K3 >= K2 (N m/rad).
    #[serde(rename = "k3_nm_per_rad")]
    pub k3: f64,
    /// T1 (N m).
    #[serde(rename = "t1_nm")]
    pub t1: f64,
    /// T2 > T1 (N m).
    #[serde(rename = "t2_nm")]
    pub t2: f64,
}

/// `[hysteresis]`: the standard shape of a width, or identified weights.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hysteresis {
    /// Full width of the loop at zero torque after +-rated torque, in the catalogue's unit (arcmin). Beside
    /// weights it is for people.
    pub width_arcmin: f64,
    /// U, torsion at which the loop of the weights closes (rad).
    #[serde(rename = "half_range_rad", default, skip_serializing_if = "Option::is_none")]
    pub half_range: Option<f64>,
    /// mu_ij (N m), row i from j = 0 to i; symmetric, mu_ij = mu_(L-1-j)(L-1-i) with L rows.
    #[serde(rename = "weights_nm", default, skip_serializing_if = "Option::is_none")]
    pub weights: Option<Vec<Vec<f64>>>,
}

impl Hysteresis {
    /// Full width of the loop at zero torque after +-rated torque (rad).
    pub fn width(&self) -> f64 {
        (self.width_arcmin / 60.0).to_radians()
    }

    /// The identified weights; `None` for the standard shape.
    pub fn table<R: Real>(&self) -> Option<HysteresisTable<R>> {
        let half_range = R::lit(self.half_range?);
        let rows = self.weights.as_ref()?;
        Some(HysteresisTable::from_fn(half_range, rows.len(), |i, j| R::lit(rows[i][j])))
    }
}

/// `[kinematic_error]`: e = sum of A_k sin(k x + p_k) at the output.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct KinematicError {
    /// x is the wave-generator angle relative to the case.
    pub wave_generator: Vec<Harmonic>,
    /// x is the wave-generator angle relative to the flexspline.
    pub flexspline: Vec<Harmonic>,
}

impl KinematicError {
    fn is_empty(&self) -> bool {
        self.wave_generator.is_empty() && self.flexspline.is_empty()
    }
}

/// One term of the kinematic error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Harmonic {
    /// k, periods a revolution.
    pub order: u32,
    /// A_k at the output (rad).
    #[serde(rename = "amplitude_rad")]
    pub amplitude: f64,
    /// p_k (rad).
    #[serde(rename = "phase_rad")]
    pub phase: f64,
}

impl Harmonic {
    /// A_k sin(k x + p_k) (rad).
    pub fn at(&self, x: f64) -> f64 {
        self.amplitude * (f64::from(self.order) * x + self.phase).sin()
    }
}

/// `[flexspline]`: a cylinder.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flexspline {
    /// R (m).
    #[serde(rename = "radius_m")]
    pub radius: f64,
    /// l (m).
    #[serde(rename = "length_m")]
    pub length: f64,
    /// h (m).
    #[serde(rename = "wall_m")]
    pub wall: f64,
    /// w0, radial displacement at the ellipse's major axis (m).
    #[serde(rename = "ellipse_m")]
    pub ellipse: f64,
    /// E (Pa).
    #[serde(rename = "youngs_modulus_pa")]
    pub youngs_modulus: f64,
    /// nu.
    pub poisson_ratio: f64,
    /// rho (kg/m^3).
    #[serde(rename = "density_kg_per_m3")]
    pub density: f64,
    /// Where the hardening lies: in the tooth contact when the key is left out.
    #[serde(default, skip_serializing_if = "Hardening::is_contact")]
    pub hardening: Hardening,
    /// Gain of the mesh's bend links per strain squared; 0 when the key is left out.
    #[serde(default)]
    pub bend_hardening: f64,
    /// Strain from which on they gain no more.
    #[serde(default)]
    pub bend_saturation: f64,
}

/// Where the flexspline's hardening lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Hardening {
    /// In the tooth contact.
    #[default]
    Contact,
    /// In the mesh's bend links.
    Bends,
}

impl Hardening {
    fn is_contact(&self) -> bool {
        *self == Self::Contact
    }
}

/// `[inertia]`
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Inertia {
    /// J_wg, with the motor's rotor; behind a belt with its pulley in the place of it (kg m^2).
    #[serde(rename = "wave_generator_kg_m2")]
    pub wave_generator: f64,
    /// J_fs, with the load (kg m^2).
    #[serde(rename = "flexspline_kg_m2")]
    pub flexspline: f64,
}

/// `[damping]`
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Damping {
    /// Modal damping ratio of the torsion mode.
    pub torsion_mode_ratio: f64,
}

/// `[motor]`
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motor {
    /// Peak torque at the shaft (N m).
    #[serde(rename = "peak_torque_nm")]
    pub peak_torque: f64,
    /// Limit of the rotor's speed (rad/s).
    #[serde(rename = "rotor_speed_limit_rad_per_s")]
    pub rotor_speed_limit: f64,
}

/// `[sensors]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sensors {
    /// Bits a revolution of the motor encoder.
    pub motor_encoder_bits: u32,
    /// Noise of the motor's encoder in addition to its resolution, as the observer is designed for (rad); it has one when it is left out.
    #[serde(rename = "motor_encoder_noise_rad", default, skip_serializing_if = "Option::is_none")]
    pub motor_encoder_noise: Option<f64>,
    /// Control periods for which the motor's encoder at rest tells the same count at most, for its noise changes it: one that does for longer is
    /// frozen. Not judged by that when it is left out.
    #[serde(rename = "motor_encoder_still_periods", default, skip_serializing_if = "Option::is_none")]
    pub motor_encoder_still: Option<u32>,
    /// Noise of the output's encoder, as that of the motor's (rad).
    #[serde(rename = "output_encoder_noise_rad", default, skip_serializing_if = "Option::is_none")]
    pub output_encoder_noise: Option<f64>,
    /// Bits a revolution of the output encoder, when there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output_encoder_bits: Option<u32>,
    /// Its reading where that of the motor's is 0, but for whole turns of the motor (rad); the first readings tell it when left out.
    #[serde(rename = "output_encoder_zero_rad", default, skip_serializing_if = "Option::is_none")]
    pub output_encoder_zero: Option<f64>,
    /// By how many control periods the output encoder's reading is late.
    #[serde(rename = "output_encoder_delay_periods", default, skip_serializing_if = "is_default::<0>")]
    pub output_encoder_delay: u32,
    /// Control periods from one reading of the output encoder to the next.
    #[serde(
        rename = "output_encoder_period_periods",
        default = "one",
        skip_serializing_if = "is_default::<1>"
    )]
    pub output_encoder_period: u32,
    /// There is a torque sensor at the output.
    pub output_torque: bool,
    /// Standard deviation of the motor torque's noise [N m at the shaft].
    #[serde(rename = "motor_torque_noise_nm")]
    pub motor_torque_noise: f64,
    /// Standard deviation of the output torque's noise (N m).
    #[serde(rename = "output_torque_noise_nm")]
    pub output_torque_noise: f64,
    /// Error of the output encoder's scale, as its eccentricity makes it: reading = theta_fs + sum of A_k sin(k x + p_k),
    /// x the angle of the output.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub output_encoder_error: Vec<Harmonic>,
}

impl Sensors {
    /// Bits a revolution of the output encoder; where there is none, of one like the motor's.
    pub fn output_bits(&self) -> u32 {
        self.output_encoder_bits.unwrap_or(self.motor_encoder_bits)
    }
}

impl Sensors {
    /// Error of the output encoder's reading at the output angle x (rad).
    pub fn output_encoder_error_at(&self, x: f64) -> f64 {
        self.output_encoder_error.iter().map(|harmonic| harmonic.at(x)).sum()
    }
}

fn one() -> u32 {
    1
}

fn is_default<const VALUE: u32>(value: &u32) -> bool {
    *value == VALUE
}

/// `[feedback]`: position P over velocity PI, both at the motor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Feedback {
    /// Bandwidth of the position loop (Hz).
    #[serde(rename = "position_bandwidth_hz")]
    pub position_bandwidth: f64,
    /// Bandwidth of the velocity loop (Hz).
    #[serde(rename = "velocity_bandwidth_hz")]
    pub velocity_bandwidth: f64,
    /// Integral time of the velocity loop (s).
    #[serde(rename = "integral_time_s")]
    pub integral_time: f64,
}

/// `[compensation]`
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Compensation {
    /// Fraction of the friction that is fed forward: all of it can drive the joint by itself.
    pub friction_gain: f64,
    /// By how much the external torque wanders in a second [N m/s^0.5]; the observer's design has one when it is left out, which the loop
    /// through the disturbance path bears; one that is given is not limited. It is how much of the motor torque that friction and inertia do
    /// not explain the observer takes for external torque.
    #[serde(
        rename = "external_torque_wander_nm_per_sqrt_s",
        default,
        skip_serializing_if = "Option::is_none"
    )]
    pub external_torque_wander: Option<f64>,
}

impl GearFile {
    /// Inertia of all in front of the gear, as it is at the wave generator (kg m^2).
    pub fn driving_inertia(&self) -> f64 {
        let rotor = self.belt.as_ref().map_or(0.0, |belt| belt.rotor_inertia / belt.ratio().powi(2));
        self.inertia.wave_generator + rotor
    }

    /// The friction models of both sides are those that the firmware has.
    ///
    /// # Errors
    /// One line that names the key, the model and what is allowed.
    pub fn require_firmware_friction(&self) -> Result<(), String> {
        for (side, friction) in [("input", &self.friction.input), ("output", &self.friction.output)] {
            if !ModelName::IN_FIRMWARE.contains(&friction.model) {
                let [one, two] = ModelName::IN_FIRMWARE.map(ModelName::word);
                return Err(format!(
                    "friction.{side}.model = {:?} is not in the firmware; allowed there: {one:?} or {two:?}",
                    friction.model.word()
                ));
            }
        }
        Ok(())
    }
}
