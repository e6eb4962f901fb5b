//! Unknowns of a moving joint's torque, each in units of what is known of it before the log: of prior 0 +- 1.
//!
//! | unknown z | is | from to |
//! | --- | --- | --- |
//! | torque offset, slope | N m and N m over a radian of the output at the motor: the load's weight along the path, up to the gear's peak torque | |
//! | inertia | factor 1 + z on rotor and load | 0 to 20 |
//! | start | stroke z*eps from a contact without tension, by which the block had come when the log began | -4 to 4 |
//! | Coulomb level | factor 1 + z on Fc and Fs | 0 to 20 |
//! | viscous | factor 1 + z | 0 to 20 |
//! | static level | adds z*(Fs - Fc), at least z*Fc/10, times the Coulomb level's factor | Fs >= Fc, to 5 |
//! | Stribeck speed, presliding distance | factor e^z | 1/10 to 10 |
//! | load factors | factor 1 + z | 0 to 5 |
//! | ripple of the block | adds z/10 to a fraction of the level | -0.3 to 0.3 |
//! | wave | z*Fc as sine or cosine of an order of the motor's angle | |

use super::spectrum::Wave;
use crate::io::gear_file::{Backward, Friction};

/// Standard deviation of a fraction of the block's ripple.
const RIPPLE: f64 = 0.1;
/// Least scale of Fs - Fc, over Fc.
const LEAST_RISE: f64 = 0.1;

/// Least distance of a search's start to an end of the range: a tenth of what was known of the unknown before the log.
const INSIDE: f64 = 0.1;

/// A parameter of the input friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// Fc, and Fs with it.
    Coulomb,
    /// Fv.
    Viscous,
    /// Fs.
    Static,
    /// vs.
    Stribeck,
    /// eps.
    Presliding,
    /// Level over torque while the motor drives the load.
    Driving,
    /// While the load drives the motor.
    Driven,
    /// Fraction of the level, of this order.
    RippleCosine(usize),
    /// Fraction of the level, of this order.
    RippleSine(usize),
}

impl Parameter {
    /// Key of the gear file, of a list with the order.
    pub fn key(self) -> String {
        match self {
            Self::Coulomb => "coulomb_nm".into(),
            Self::Viscous => "viscous_nm_s_per_rad".into(),
            Self::Static => "static_nm".into(),
            Self::Stribeck => "stribeck_rad_per_s".into(),
            Self::Presliding => "presliding_rad".into(),
            Self::Driving => "load_driving".into(),
            Self::Driven => "load_driven".into(),
            Self::RippleCosine(order) => format!("ripple_cosines.{order}"),
            Self::RippleSine(order) => format!("ripple_sines.{order}"),
        }
    }

    /// SI unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Coulomb | Self::Static => "N m",
            Self::Viscous => "N m s/rad",
            Self::Stribeck => "rad/s",
            Self::Presliding => "rad",
            Self::Driving | Self::Driven | Self::RippleCosine(_) | Self::RippleSine(_) => "1",
        }
    }

    /// Its value of a side; `None` where the side has none.
    pub(crate) fn of(self, side: &Friction) -> Option<f64> {
        let fraction = |list: &Option<Vec<f64>>, order: usize| {
            Some(list.as_ref().and_then(|list| list.get(order - 1)).copied().unwrap_or(0.0))
        };
        match self {
            Self::Coulomb => side.coulomb,
            Self::Viscous => side.viscous,
            Self::Static => side.static_level,
            Self::Stribeck => side.stribeck_velocity,
            Self::Presliding => side.presliding,
            Self::Driving => side.load_driving,
            Self::Driven => side.load_driven,
            Self::RippleCosine(order) => fraction(&side.ripple_cosines, order),
            Self::RippleSine(order) => fraction(&side.ripple_sines, order),
        }
    }

    /// Its logarithm is what the unknown adds to.
    pub(super) fn is_logarithmic(self) -> bool {
        matches!(self, Self::Stribeck | Self::Presliding)
    }
}

/// An unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Unknown {
    /// Torque offset.
    Offset,
    /// Slope of the load's weight.
    Slope,
    /// Inertia.
    Inertia,
    /// Start of the block.
    Start,
    /// Parameter of the block.
    Of(Parameter),
    /// Sine of a wave.
    Sine(Wave),
    /// Its cosine.
    Cosine(Wave),
}

impl Unknown {
    /// Ends of the search.
    pub fn range(self) -> [f64; 2] {
        match self {
            Self::Offset | Self::Slope | Self::Sine(_) | Self::Cosine(_) => [-1e3, 1e3],
            Self::Inertia | Self::Of(Parameter::Coulomb | Parameter::Viscous) => [-1.0, 19.0],
            Self::Start => [-4.0, 4.0],
            Self::Of(Parameter::Static) => [-1.0, 5.0],
            Self::Of(Parameter::Stribeck | Parameter::Presliding) => [-10f64.ln(), 10f64.ln()],
            Self::Of(Parameter::Driving | Parameter::Driven) => [-1.0, 4.0],
            Self::Of(Parameter::RippleCosine(_) | Parameter::RippleSine(_)) => [-3.0, 3.0],
        }
    }

    /// A start of a search from this value: the solver's steps shrink with the distance to an end, from next to one it goes nowhere.
    pub fn inside(self, z: f64) -> f64 {
        let [least, most] = self.range();
        z.clamp(least + INSIDE, most - INSIDE)
    }

    /// As verdicts name it.
    pub fn name(self) -> String {
        match self {
            Self::Offset => "the torque offset".into(),
            Self::Slope => "the load's weight".into(),
            Self::Inertia => "the inertia".into(),
            Self::Start => "the start of the block".into(),
            Self::Of(parameter) => parameter.key(),
            Self::Sine(wave) | Self::Cosine(wave) => format!("the torque's order {}", wave.order),
        }
    }
}

/// What the unknowns make of the block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Change {
    pub level: f64,
    pub viscous: f64,
    /// In units of Fs - Fc.
    rise: f64,
    stribeck: f64,
    presliding: f64,
    driving: f64,
    driven: f64,
    cosines: [f64; 2],
    sines: [f64; 2],
}

impl Default for Change {
    fn default() -> Self {
        Self {
            level: 1.0,
            viscous: 1.0,
            rise: 0.0,
            stribeck: 1.0,
            presliding: 1.0,
            driving: 1.0,
            driven: 1.0,
            cosines: [0.0; 2],
            sines: [0.0; 2],
        }
    }
}

impl Change {
    /// By these values of the unknowns.
    pub fn of(unknowns: &[Unknown], z: &[f64]) -> Self {
        let mut change = Self::default();
        for (unknown, z) in unknowns.iter().zip(z) {
            let Unknown::Of(parameter) = unknown else { continue };
            match parameter {
                Parameter::Coulomb => change.level += z,
                Parameter::Viscous => change.viscous += z,
                Parameter::Static => change.rise += z,
                Parameter::Stribeck => change.stribeck *= z.exp(),
                Parameter::Presliding => change.presliding *= z.exp(),
                Parameter::Driving => change.driving += z,
                Parameter::Driven => change.driven += z,
                Parameter::RippleCosine(order) => change.cosines[order - 1] += RIPPLE * z,
                Parameter::RippleSine(order) => change.sines[order - 1] += RIPPLE * z,
            }
        }
        change
    }

    /// A side with this change in the directions that the motor moved in; presliding and load factors are those of both.
    pub fn put_into(&self, side: &mut Friction, [forward, backward]: [bool; 2]) {
        let (forwards, backwards) = (self.changed(side), self.changed(&side.backwards()));
        if forward != backward || side.backward.is_some() {
            let kept = side.backwards();
            let new = if backward { backwards } else { kept };
            let own = side.backward.take().unwrap_or_default();
            let rippled = self.cosines != [0.0; 2] || self.sines != [0.0; 2];
            side.backward = Some(Backward {
                coulomb: new.coulomb,
                static_level: new.static_level,
                viscous: new.viscous,
                stribeck_velocity: if self.stribeck == 1.0 {
                    own.stribeck_velocity
                } else {
                    new.stribeck_velocity
                },
                ripple_cosines: if rippled { new.ripple_cosines } else { own.ripple_cosines },
                ripple_sines: if rippled { new.ripple_sines } else { own.ripple_sines },
            });
        }
        let backward = side.backward.take();
        *side = if forward {
            forwards
        } else {
            let Friction { presliding, load_driving, load_driven, .. } = forwards;
            Friction { presliding, load_driving, load_driven, ..side.clone() }
        };
        side.backward = backward;
    }

    fn changed(&self, side: &Friction) -> Friction {
        let times = |value: Option<f64>, factor: f64| value.map(|value| value * factor);
        let coulomb = side.coulomb.unwrap_or_default();
        let raised = |level: f64| {
            let scale = (level - coulomb).max(LEAST_RISE * coulomb);
            self.level * if self.rise == 0.0 { level } else { (level + self.rise * scale).max(coulomb) }
        };
        let ripple = |list: &Option<Vec<f64>>, added: [f64; 2]| {
            let of = |k: usize| list.as_ref().and_then(|list| list.get(k)).copied().unwrap_or(0.0) + added[k];
            if added == [0.0; 2] { list.clone() } else { Some(vec![of(0), of(1)]) }
        };
        Friction {
            coulomb: times(side.coulomb, self.level),
            static_level: side.static_level.map(raised),
            viscous: times(side.viscous, self.viscous),
            stribeck_velocity: times(side.stribeck_velocity, self.stribeck),
            presliding: times(side.presliding, self.presliding),
            load_driving: times(side.load_driving, self.driving),
            load_driven: times(side.load_driven, self.driven),
            ripple_cosines: ripple(&side.ripple_cosines, self.cosines),
            ripple_sines: ripple(&side.ripple_sines, self.sines),
            ..side.clone()
        }
    }
}
