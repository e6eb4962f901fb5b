//! The gear file of a catalogue size and ratio.
//!
//! | quantity | law |
//! | --- | --- |
//! | stiffness, knees, rated torque, inertia of the wave generator, friction | [`super::figures`] |
//! | peak torque | 157/67 of the rated torque, as the default gear's |
//! | kinematic error | twice and four times a revolution, 0.34 and 0.07 of the positional accuracy, as the default gear's |
//! | cup | radius, length, wall and ellipse of the default gear's size 25, linear with size |
//! | J_wg | the wave generator's, and a rotor of 0.45 of it, as the default gear's |
//! | J_fs | 2*N^2*J_wg, as the default gear's |
//! | friction at the wave generator | static: starting torque; Coulomb: 0.72 of it; viscous: the rest of the running torque; load: the rest of the loss at rated torque |
//! | friction at the flexspline | Coulomb 0.5 % of the rated torque, static 1.3 times, viscous 4 s/rad times that |
//! | motor | 1.5 times peak torque/N; 5600 revolutions a minute of size 25, with size^-0.62 (4800 of size 32) |
//! | noise of the torques | 1 % of the rated torque, at the motor over N |
//! | baselines | as tuned; else the default gear's, transferred ([`super::load`]) |
//! | cascade | that of baseline B0, faster where the torsion mode lets it ([`super::load`]) |
//!
//! The default gear's velocity loop crosses over at 180 Hz above the torsion mode, where the rotor alone is left: what
//! limits it is the drive's lag, the same for every size and load. Damping, presliding, Stribeck speeds, drive and
//! tolerances are the default gear's.

use crate::io::gear_file::{
    Arrangement, Baselines, BothFrictions, Compensation, Damping, Drive, Flexspline, Friction, Gear,
    GearFile, Harmonic, Hysteresis, Inertia, KinematicError, Motor, Sensors, Stiffness, Tolerances,
};

use super::figures::{self, Read};
use super::load::{feedback, untuned};

/// J_fs/(N^2*J_wg).
pub const NOMINAL_LOAD: f64 = 2.0;
/// J_wg over the wave generator's.
const WITH_ROTOR: f64 = 6.0e-5 / 0.413e-4;

/// A gear of the catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Model {
    /// Size, the pitch diameter in tenths of an inch.
    pub size: u32,
    /// N.
    pub ratio: i32,
}

/// To three digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

impl Model {
    /// As in `hd08-030`.
    pub fn name(self) -> String {
        format!("hd{:02}-{:03}", self.size, self.ratio)
    }

    /// The gear file; without tuned baselines it has those of the default gear, transferred.
    pub fn gear(self, baselines: Option<Baselines>) -> GearFile {
        let n = f64::from(self.ratio);
        let rated = rounded(figures::rated_torque(self.size, self.ratio));
        let peak = rounded(157.0 / 67.0 * rated);
        let rotor = rounded(WITH_ROTOR * figures::wave_generator_inertia(self.size));
        let file = GearFile {
            gear: Gear {
                name: self.name(),
                ratio: self.ratio,
                arrangement: Arrangement::CircularSplineFixed,
                rated_torque: rated,
                peak_torque: peak,
            },
            stiffness: self.stiffness(),
            hysteresis: Hysteresis {
                width_arcmin: figures::hysteresis_loss(self.ratio),
                half_range: None,
                weights: None,
            },
            kinematic_error: self.kinematic_error(),
            flexspline: self.cup(),
            inertia: Inertia { wave_generator: rotor, flexspline: rounded(NOMINAL_LOAD * n * n * rotor) },
            damping: Damping { torsion_mode_ratio: 0.02 },
            belt: None,
            friction: BothFrictions { input: self.input_friction(), output: output_friction(rated) },
            motor: Motor {
                peak_torque: rounded(1.5 * peak / n),
                rotor_speed_limit: rounded(586.0 * (25.0 / f64::from(self.size)).powf(0.62)),
            },
            drive: Drive::default(),
            tolerances: Tolerances::default(),
            sensors: sensors(rated, n),
            feedback: GearFile::default_gear().feedback,
            compensation: Compensation { friction_gain: 0.8, external_torque_wander: None },
            learnt: None,
            baselines,
        };
        match file.baselines {
            Some(_) => GearFile { feedback: feedback(&file), ..file },
            None => untuned(file),
        }
    }

    fn stiffness(self) -> Stiffness {
        let [k1, k2, k3] = figures::slopes(self.size, self.ratio).map(rounded);
        let [t1, t2] = figures::knees(self.size).map(rounded);
        Stiffness { k1, k2, k3, t1, t2 }
    }

    fn kinematic_error(self) -> KinematicError {
        let accuracy = figures::positional_accuracy(self.size, self.ratio);
        let order =
            |order, fraction: f64| Harmonic { order, amplitude: rounded(fraction * accuracy), phase: 0.0 };
        KinematicError { wave_generator: vec![order(2, 1.0 / 2.9), order(4, 0.2 / 2.9)], flexspline: vec![] }
    }

    fn cup(self) -> Flexspline {
        let linear = |of_25: f64| rounded(of_25 * f64::from(self.size) / 25.0);
        Flexspline {
            radius: linear(0.031),
            length: linear(0.037),
            wall: linear(0.40e-3),
            ellipse: linear(0.30e-3),
            ..GearFile::default_gear().flexspline
        }
    }

    fn input_friction(self) -> Friction {
        let of = figures::friction(self.size);
        let coulomb = 0.72 * of.starting;
        let load = Some(rounded(of.load));
        Friction {
            coulomb: Some(rounded(coulomb)),
            static_level: Some(rounded(of.starting)),
            viscous: Some(rounded((of.running - coulomb) / figures::RUNNING_SPEED)),
            load_driving: load,
            load_driven: load,
            ..GearFile::default_gear().friction.input
        }
    }

    /// The gear file as text: where its figures come from, then its keys.
    pub fn text(self, baselines: Option<Baselines>) -> String {
        format!("{}\n{}", self.comment(), self.gear(baselines).to_toml())
    }

    fn comment(self) -> String {
        let (main, friction) = (Read::of(self.size), Read::friction(self.size));
        let from = |read: Read, what: &str| match read.scale {
            1.0 => format!("# {what}: catalogue figures of size {}.", self.size),
            scale => format!(
                "# {what}: catalogue figures of size {}, scaled by the size ratio x = {scale:.3}: torque and stiffness x^3, inertia x^5.",
                read.size
            ),
        };
        let slopes = if figures::slopes_were_read(self.size, self.ratio) {
            "# K1, K2, K3 are the catalogue's for this size and ratio.".to_owned()
        } else {
            format!(
                "# K1, K2, K3 are those of the ratio {}, completed by law where one of them was not read for this size and ratio.",
                figures::row_ratio(self.ratio)
            )
        };
        [
            format!("# Size {}, N = {}. Generated; every law and source: desktop/src/catalogue/.", self.size, self.ratio),
            from(main, "Stiffness, ratings and inertia of the wave generator"),
            slopes,
            from(friction, "Friction at the wave generator, of ratio 100"),
            "# Hysteresis, cup, output friction, motor and noise follow from size and rated torque; not a claim about one unit.".to_owned(),
            "# [feedback] is baseline B0's, its position loop half as fast again, its integral time 0.65 of it, slower by the same factor where it would feed the torsion mode; [baselines] as tuned, else the default gear's, transferred.".to_owned(),
        ]
        .join("\n")
            + "\n"
    }
}

fn output_friction(rated: f64) -> Friction {
    let coulomb = 0.005 * rated;
    Friction {
        coulomb: Some(rounded(coulomb)),
        static_level: Some(rounded(1.3 * coulomb)),
        viscous: Some(rounded(4.0 * coulomb)),
        ..GearFile::default_gear().friction.output
    }
}

fn sensors(rated: f64, n: f64) -> Sensors {
    Sensors {
        motor_torque_noise: rounded(0.01 * rated / n),
        output_encoder_zero: None,
        output_torque_noise: rounded(0.01 * rated),
        ..GearFile::default_gear().sensors
    }
}
