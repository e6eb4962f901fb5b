//! Identification of the hysteresis: the Preisach weights from what was measured, eq. (9).
//!
//! ```text
//! min  sum over samples of (y - offset - sum mu_p x_p)^2/N + lambda*|D mu|^2,     mu_p >= 0
//! ```
//!
//! | file | |
//! | --- | --- |
//! | `reversal` | how often an input reverses; inputs that excite the triangle: reversal curves, major and minor loops |
//! | `regressors` | x_p, what each weight contributes: the operator itself |
//! | `smoothness` | \|D mu\|, what is preferred where the log does not decide |
//! | `least_squares` | the bounded least squares |
//! | `choice` | lambda, by cross-validation |
//! | `excitation` | which cells the input moved |
//! | `sequence` | weights of any actuator from its input and output |
//! | `law` | the gear's torque over torsion, and its inverse |
//! | `line` | a factor on the stiffness line from a held joint's logs |
//! | `start` | offset and start state of a held joint's log |
//! | `gear_log` | a measured log as torque and torsion |
//! | `joint` | weights of a gear from measured logs: torque over torsion |
//! | `identified_gear` | what that gives: gear, errors, weights, covariance |
//! | `operator` | weights of any actuator that need not be symmetric, from any start |
//! | `moving` | friction and kinematic error from a moving joint's log |
//! | `covariance` | joint covariance of what was identified |
//! | `refusal` | why an identified gear file is not written |
//! | `not_identified` | what logs do not show, and which log would |
//! | `verdict` | what becomes of an identified file, and which log would help |
//!
//! From a catalogue's figure alone there is nothing to fit: the loss in arc minutes is the gap of the standard
//! shape ([`strainwave::hysteresis::gap_for_width`], [`strainwave::hysteresis::Weights::uniform`]). The identified
//! weights tend to that shape where the log says nothing: it is what the smoothness prefers.
//!
//! Units: those of input and output. Sign: weights that are not negative make the output lag its input.

mod choice;
mod covariance;
pub mod excitation;
mod gear_log;
mod identified_gear;
pub mod joint;
pub(crate) mod law;
mod least_squares;
mod line;
pub mod moving;
mod not_identified;
pub mod operator;
mod refusal;
pub mod regressors;
pub mod replay;
pub mod reversal;
pub mod ripple_fit;
mod sequence;
mod smoothness;
mod start;
pub mod torque_loop;
mod verdict;

pub use choice::Smoothing;
pub use covariance::Covariance;
pub use excitation::Excitation;
pub use gear_log::GearLog;
pub use identified_gear::{IdentifiedGear, IdentifiedTable};
pub use joint::{GearOptions, identify_gear};
pub use moving::{LearntGear, learn_gear};
pub use not_identified::NotIdentified;
pub use operator::{IdentifiedOperator, Operator, OperatorOptions, identify_operator};
pub use refusal::Refusal;
pub use sequence::{Identified, Options, Sequence, identify};
pub use start::Start;
pub use verdict::{HELD_LOG, MOVING_LOG, OPERATOR_LOG, Verdict};

/// Why nothing could be identified.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// Too few samples.
    #[error("{samples} samples are too few; allowed: at least {least}")]
    TooShort {
        /// Number of samples.
        samples: usize,
        /// Least number of samples.
        least: usize,
    },
    /// Input and output are not of one log.
    #[error("{inputs} inputs and {outputs} outputs; allowed: as many of each")]
    Lengths {
        /// Inputs.
        inputs: usize,
        /// Outputs.
        outputs: usize,
    },
    /// Not a number.
    #[error("sample {sample} is not finite")]
    NotFinite {
        /// Which, from 0.
        sample: usize,
    },
    /// Without a reversal there is no hysteresis to be seen.
    #[error(
        "the {input} never reverses by {fraction} of its span {span:.4e}; hysteresis shows where it does"
    )]
    NeverReverses {
        /// Input of the operator.
        input: &'static str,
        /// Least fraction.
        fraction: f64,
        /// Span of the input, in its unit.
        span: f64,
    },
    /// There is nothing to be predicted.
    #[error("the output y is the same in every row that trains; allowed: one that changes")]
    ConstantOutput,
    /// The kinematic error would count as torsion.
    #[error("the motor turns by {travel:.3} rad; allowed: at most {most} rad, the joint has to be held")]
    NotHeld {
        /// Span of its angle (rad).
        travel: f64,
        /// The most allowed (rad).
        most: f64,
    },
    /// Within presliding friction is a spring, which says nothing of its level.
    #[error(
        "the motor turns by {travel:.3e} rad in the part that trains; friction needs at least {least:.3e} rad, twice its \
         presliding distance"
    )]
    TooLittleTravel {
        /// Span of the motor's angle (rad).
        travel: f64,
        /// Least span (rad).
        least: f64,
    },
    /// It is another gear's output, or counts the other way.
    #[error(
        "column theta_out_rad: it moves by {factor:.4} times what the gear file's ratio makes of theta_motor_rad; allowed: within {most} rad \
         of that; see gear.ratio and gear.arrangement, or change the column's sign"
    )]
    WrongRatio {
        /// Motion of the output over that of a rigid gear.
        factor: f64,
        /// Largest difference of the two over the motion (rad).
        most: f64,
    },
    /// Friction would drive.
    #[error(
        "column tau_motor_nm: with its sign changed it fits the motion {ratio:.1} times as well; allowed: at most {most}, \
         friction never drives; if the torque counts against the angle, give --reversed-torque"
    )]
    ReversedTorque {
        /// Sum of squares as logged over that with the sign changed.
        ratio: f64,
        /// The most allowed.
        most: f64,
    },
    /// A parameter of the operator or an option.
    #[error(transparent)]
    Model(#[from] strainwave::Error),
    /// The solver gave up.
    #[error("the least-squares solver ended without a solution: {0}")]
    Solver(String),
}
