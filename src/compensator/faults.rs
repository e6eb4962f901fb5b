//! Faults of a joint, by name.

/// A set of named faults, one bit each.
///
/// ```
/// use strainwave::compensator::Faults;
///
/// let mut faults = Faults::NONE;
/// faults.raise_if(true, Faults::OVERSPEED);
/// faults.raise_if(1.0 > 2.0, Faults::TORQUE_LIMITED);
/// assert_eq!(faults.names().collect::<Vec<_>>(), ["overspeed"]);
/// assert_eq!(Faults::from_bits(faults.bits()), faults); // as telemetry carries them
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults(u32);

macro_rules! faults {
    ($($bit:literal $name:ident $text:literal: $doc:literal;)*) => {
        impl Faults {
            $(#[doc = $doc] pub const $name: Self = Self(1 << $bit);)*

            /// Every fault with its name.
            pub const NAMES: &'static [(Self, &'static str)] = &[$((Self::$name, $text)),*];
        }
    };
}

faults! {
    0 INPUT_NOT_FINITE "input not finite": "A sensor or setpoint was NaN or infinite; its last finite value was held.";
    1 SETPOINT_LIMITED "setpoint limited": "A derivative of the setpoint was beyond what the joint can do; it was limited.";
    2 MOTOR_ENCODER_JUMP "motor encoder jump": "The motor encoder moved farther than the motor can, or its count has too many bits.";
    3 MOTOR_ENCODER_FROZEN "motor encoder frozen": "The motor encoder stood still while a motion of the motor was commanded, or for longer than its noise lets it: frozen, or the joint is blocked. It stays until the encoder moves.";
    4 OUTPUT_ENCODER_JUMP "output encoder jump": "The output encoder moved farther than the output can, or its count has too many bits.";
    5 TORQUE_LIMITED "torque limited": "The torque command was beyond the motor's peak torque or what the gear may carry; it was limited.";
    6 OBSERVER_RESET "observer reset": "The observer's torsion left the range of the gear; it starts again from the motor's angle.";
    7 ESTIMATE_LIMITED "estimate limited": "An estimate was beyond what the joint can do; it was limited.";
    8 TORSION_BEYOND_RANGE "torsion beyond range": "The observed torsion or its rate requires more torque than the gear can transmit; the model's torque saturates there.";
    9 SETPOINT_STEP "setpoint step": "The position moved farther from one reading of the command to the next than the output can.";
    10 OUTPUT_ENCODER_FROZEN "output encoder frozen": "The output encoder stood still while the motor went farther than the gear's torsion allows; it is ignored until it moves.";
    11 PERIOD_OUT_OF_RANGE "period out of range": "The time since the last step was shorter than a quarter of the control period or longer than 16: the control stood still.";
    12 MOTOR_ENCODER_LOST "motor encoder lost": "The motor encoder was refused for so long that the motor's angle is no longer known.";
    13 GEAR_OVERLOAD "gear overload": "The rotor's motion under its torque shows more torque through the gear than it can transmit: an overload, or torque and motion that disagree in sign or size.";
    14 DRIVE_NOT_FOLLOWING "drive not following": "The motor's measured torque does not follow the command.";
    15 OVERSPEED "overspeed": "The motor is faster than its speed limit.";
    16 FOLLOWING_ERROR "following error": "The motor is farther from its reference than its torque explains.";
    17 SETPOINT_STALE "setpoint stale": "The setpoint has not been renewed for too long; the joint brakes to rest.";
    18 OUTPUT_ENCODER_LOST "output encoder lost": "The output encoder has stopped reporting; the joint goes on without it.";
    19 OUTPUT_ENCODER_OFF "output encoder off": "The output encoder disagrees with the torque through the gear; it is ignored until a reset.";
    20 TORQUE_SENSOR_OFF "torque sensor off": "The output's torque sensor disagrees with the motor; it is ignored until a reset.";
    21 CONTROL_OVERRUN "control overrun": "A control step lasted into the next period.";
    22 RESTARTED "restarted": "The controller was restarted by its watchdog or after a fault, or began on a joint that moved elsewhere than commanded; it waits for a reset.";
    23 FEEDBACK_REDUCED "feedback reduced": "The torsion at rest or the motor's torque kept oscillating; the feedback functions are reduced, down to a softer motor-side cascade, and come back slowly; it stays until the cascade is as stiff as it was built.";
    24 LIMIT_CYCLE "limit cycle": "The torque kept going from one limit of the motor to the other, without the feedback functions, too.";
}

impl Faults {
    /// No fault.
    pub const NONE: Self = Self(0);

    /// The set with these bits; bits without a name are dropped.
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits & ((1 << Self::NAMES.len()) - 1))
    }

    /// The bits of the set.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// All of `other` are in the set.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Any of `other` is in the set.
    #[inline(always)]
    pub const fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Adds `other` when `condition` holds.
    #[inline(always)]
    pub fn raise_if(&mut self, condition: bool, other: Self) {
        if condition {
            self.0 |= other.0;
        }
    }

    /// Both sets.
    #[inline(always)]
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The intersection with `others`.
    #[inline(always)]
    #[must_use]
    pub const fn among(self, others: Self) -> Self {
        Self(self.0 & others.0)
    }

    /// The names of the faults in the set.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        Self::NAMES.iter().filter(move |(fault, _)| self.contains(*fault)).map(|(_, name)| *name)
    }
}
