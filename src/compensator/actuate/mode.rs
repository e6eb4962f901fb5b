//! Mode of the drive: a state machine that latches the safe state.
//!
//! ```text
//! Ready     the drive is kept off from outside, the joint is watched      -> Active when it is on
//! Active    the joint is controlled                                       -> Degraded while a function is missing
//! Degraded  it is controlled without an output encoder, torque sensor, feedback function or fresh setpoint, which the faults name
//! Safe      torque 0, drive off; the cause stays among the faults          -> Ready by a reset alone
//! ```
//!
//! Loss of the motor's angle, inconsistent torque and motion, or a limit cycle of the torque lead to Safe at once: [`UNSAFE`]. The drive is switched
//! off, not braked: a ramp would need the lost angle, and the torque of a gear without motor torque does not exceed its
//! last one. A reset ([`crate::compensator::Compensator::reset`]) starts from rest; the encoders are initialised again,
//! and no earlier angle is used.
//!
//! A single control overrun is reported; one is forgotten after ten periods without, 2 ms of them on end lead to Safe.

use crate::compensator::schedule::{CONTROL_PERIOD, SLOW_PERIODS};
use crate::compensator::tuned::{FAULT_TIME, RECOVERY};
use crate::compensator::{Faults, Status};

/// Faults that lead to Safe.
pub const UNSAFE: Faults = Faults::MOTOR_ENCODER_LOST
    .with(Faults::MOTOR_ENCODER_FROZEN)
    .with(Faults::GEAR_OVERLOAD)
    .with(Faults::DRIVE_NOT_FOLLOWING)
    .with(Faults::OVERSPEED)
    .with(Faults::FOLLOWING_ERROR)
    .with(Faults::LIMIT_CYCLE)
    .with(Faults::PERIOD_OUT_OF_RANGE)
    .with(Faults::RESTARTED);

/// Faults that disable a function.
pub const DEGRADING: Faults = Faults::OUTPUT_ENCODER_LOST
    .with(Faults::OUTPUT_ENCODER_OFF)
    .with(Faults::OUTPUT_ENCODER_FROZEN)
    .with(Faults::OUTPUT_ENCODER_JUMP)
    .with(Faults::TORQUE_SENSOR_OFF)
    .with(Faults::FEEDBACK_REDUCED)
    .with(Faults::SETPOINT_STALE);

/// Increment of the error counter by an overrun, [`RECOVERY`] of which is the decrement of 1 in every period, a round's at once.
#[inline(always)]
fn overrun_increment() -> u32 {
    (1.0 / RECOVERY.get() + 0.5) as u32
}

/// Error count that leads to Safe.
#[inline(always)]
fn error_count_limit() -> u32 {
    FAULT_TIME.periods(CONTROL_PERIOD) * overrun_increment()
}

/// Mode of the drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// The drive is kept off from outside.
    #[default]
    Ready,
    /// The joint is controlled.
    Active,
    /// It is controlled without a function that the faults name.
    Degraded,
    /// The drive is off until a reset; the faults name the cause.
    Safe,
}

impl Mode {
    /// The drive may give torque.
    #[inline(always)]
    pub const fn drives(self) -> bool {
        matches!(self, Self::Active | Self::Degraded)
    }

    /// As a number, for telemetry.
    pub const fn code(self) -> u32 {
        self as u32
    }

    /// The mode of a number; Safe for one that is of none.
    pub const fn of_code(code: u32) -> Self {
        match code {
            0 => Self::Ready,
            1 => Self::Active,
            2 => Self::Degraded,
            _ => Self::Safe,
        }
    }
}

/// The mode, and the cause of Safe.
///
/// What takes the motor's angle away ends in [`Mode::Safe`], and nothing but a reset ends that:
///
/// ```
/// use strainwave::compensator::actuate::mode::ModeState;
/// use strainwave::compensator::{Faults, Mode, Status};
///
/// let mut state = ModeState::default();
/// assert_eq!(state.step(&mut Faults::OUTPUT_ENCODER_LOST.clone(), Status::FINE), Mode::Degraded);
/// assert_eq!(state.step(&mut Faults::NONE.clone(), Status::FINE), Mode::Active); // the encoder is back
/// assert_eq!(state.step(&mut Faults::MOTOR_ENCODER_LOST.clone(), Status::FINE), Mode::Safe);
/// let mut later = Faults::NONE;
/// assert_eq!(state.step(&mut later, Status::FINE), Mode::Safe);
/// assert!(later.contains(Faults::MOTOR_ENCODER_LOST) && !state.mode().drives());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModeState {
    mode: Mode,
    cause: Faults,
    error_count: u32,
    /// Faults and status that the mode was decided on, where the same lead to the same again; else `UNDECIDED`.
    decided: (Faults, Status),
}

impl Default for ModeState {
    /// Ready, before the first step.
    fn default() -> Self {
        Self { mode: Mode::Ready, cause: Faults::NONE, error_count: 0, decided: UNDECIDED }
    }
}

impl ModeState {
    /// The mode of the last step.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Faults that led to Safe; none before.
    pub fn cause(&self) -> Faults {
        self.cause
    }

    /// Nothing that the mode depends on has changed since the last step: [`Self::step`] need not be called, for it would change neither the
    /// mode nor the faults.
    #[inline(always)]
    pub fn stays(&self, faults: Faults, status: Status) -> bool {
        self.decided == deciding(faults, status)
    }

    /// The mode with this step's faults, to which the latched cause is added.
    pub fn step(&mut self, faults: &mut Faults, status: Status) -> Mode {
        let overrun = status.contains(Status::OVERRUN);
        faults.raise_if(overrun, Faults::CONTROL_OVERRUN);
        faults.raise_if(status.contains(Status::RESTARTED), Faults::RESTARTED);
        self.cause = self.cause.with(faults.among(UNSAFE));
        if overrun {
            self.error_count += overrun_increment();
            if self.error_count >= error_count_limit() {
                self.error_count = error_count_limit();
                self.cause = self.cause.with(Faults::CONTROL_OVERRUN);
            }
        }
        *faults = faults.with(self.cause);
        self.mode = if self.cause != Faults::NONE {
            Mode::Safe
        } else if status.contains(Status::DRIVE_OFF) {
            Mode::Ready
        } else if faults.intersects(DEGRADING) {
            Mode::Degraded
        } else {
            Mode::Active
        };
        // A latched cause has to be added to the faults of every step.
        self.decided = if self.cause == Faults::NONE {
            deciding(*faults, status.among(Status::DRIVE_OFF))
        } else {
            UNDECIDED
        };
        self.mode
    }

    /// Forgets the overruns of a round ago.
    #[inline(always)]
    pub fn forget(&mut self) {
        self.error_count = self.error_count.saturating_sub(SLOW_PERIODS);
    }
}

/// What no step has.
const UNDECIDED: (Faults, Status) = (Faults::from_bits(u32::MAX), Status::FINE);

/// What of a step the mode depends on.
#[inline(always)]
fn deciding(faults: Faults, status: Status) -> (Faults, Status) {
    const STATUS: Status = Status::OVERRUN.with(Status::RESTARTED).with(Status::DRIVE_OFF);
    (faults.among(UNSAFE.with(DEGRADING)), status.among(STATUS))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(state: &mut ModeState, faults: Faults, status: Status) -> (Mode, Faults) {
        let mut faults = faults;
        (state.step(&mut faults, status), faults)
    }

    #[test]
    fn safe_is_latched_with_its_cause() {
        let mut state = ModeState::default();
        assert_eq!(step(&mut state, Faults::NONE, Status::FINE).0, Mode::Active);
        assert_eq!(step(&mut state, Faults::MOTOR_ENCODER_LOST, Status::FINE).0, Mode::Safe);
        for status in [Status::FINE, Status::DRIVE_OFF] {
            assert_eq!(step(&mut state, Faults::NONE, status), (Mode::Safe, Faults::MOTOR_ENCODER_LOST));
        }
    }

    #[test]
    fn a_missing_function_degrades_while_its_fault_lasts() {
        let mut state = ModeState::default();
        assert_eq!(step(&mut state, Faults::OUTPUT_ENCODER_LOST, Status::FINE).0, Mode::Degraded);
        assert_eq!(step(&mut state, Faults::NONE, Status::FINE).0, Mode::Active);
        assert_eq!(step(&mut state, Faults::TORQUE_LIMITED, Status::FINE).0, Mode::Active);
        assert_eq!(step(&mut state, Faults::NONE, Status::DRIVE_OFF).0, Mode::Ready);
    }

    #[test]
    fn an_overrun_is_reported_and_as_many_as_bad_frames_lead_to_safe() {
        let mut state = ModeState::default();
        for k in 0..error_count_limit() / overrun_increment() {
            let (mode, faults) = step(&mut state, Faults::NONE, Status::OVERRUN);
            assert!(faults.contains(Faults::CONTROL_OVERRUN));
            assert_eq!(mode == Mode::Safe, k + 1 == error_count_limit() / overrun_increment());
        }
        assert_eq!(step(&mut ModeState::default(), Faults::NONE, Status::RESTARTED).0, Mode::Safe);
    }

    /// Where the step is left out, it would have changed nothing; after all but Safe it is left out with the same inputs.
    #[test]
    fn a_step_that_is_left_out_changes_nothing() {
        let before = [
            (Faults::NONE, Status::FINE, true),
            (Faults::SETPOINT_STALE, Status::FINE, true),
            (Faults::NONE, Status::DRIVE_OFF, true),
            (Faults::OVERSPEED, Status::FINE, false),
            (Faults::NONE, Status::RESTARTED, false),
        ];
        for (decided_on, status, lasts) in before {
            let mut decided = ModeState::default();
            step(&mut decided, decided_on, status);
            assert_eq!(decided.stays(decided_on, status), lasts);
            let later = (0..24).flat_map(|bit| (0..32).map(move |status| (bit, Status(status))));
            for (bit, status) in
                later.filter(|(bit, status)| decided.stays(Faults::from_bits(1 << bit), *status))
            {
                let (faults, mut state) = (Faults::from_bits(1 << bit), decided);
                assert_eq!(step(&mut state, faults, status), (decided.mode(), faults), "{bit} {status:?}");
                assert_eq!(state, decided, "{bit} {status:?}");
            }
        }
    }

    /// An overrun costs one step of the mode, not one after it too.
    #[test]
    fn after_an_overrun_the_mode_stays() {
        let mut state = ModeState::default();
        step(&mut state, Faults::NONE, Status::OVERRUN);
        assert!(state.stays(Faults::NONE, Status::FINE) && !state.stays(Faults::NONE, Status::OVERRUN));
    }

    #[test]
    fn overruns_that_are_rare_are_forgotten() {
        let rounds = overrun_increment().div_ceil(SLOW_PERIODS);
        let mut state = ModeState::default();
        for _ in 0..100 {
            assert_eq!(step(&mut state, Faults::NONE, Status::OVERRUN).0, Mode::Active);
            (0..rounds).for_each(|_| state.forget());
        }
    }

    #[test]
    fn a_code_names_its_mode() {
        for mode in [Mode::Ready, Mode::Active, Mode::Degraded, Mode::Safe] {
            assert_eq!(Mode::of_code(mode.code()), mode);
        }
    }
}
