//! What every drive behind a bus has: a limited torque, time-outs, and a safe state with a name, latched until a reset.
//!
//! ```text
//! torque sent = 0                             unless the drive was enabled since the reset and there is no cause of the safe state
//!             = min(max(torque, -peak), peak) else; 0 of what is not a number
//! cause       = the first of: a fault, leaving the enabled state, silence for more than the time-out, a failed attempt
//! ```
//!
//! How to be enabled, and what is sent in the safe state, is each drive's own.

use embedded_can::{Frame, Id};

/// Why there is no torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The drive was not reset yet.
    NotStarted,
    /// The drive reports a fault.
    DriveFault,
    /// The drive has left the enabled state by itself.
    Disabled,
    /// The drive did not do what it was asked for.
    Refused,
    /// The drive's own watchdog has expired: it did not hear us.
    WatchdogExpired,
    /// The drive's NMT state is not operational: it has restarted.
    NotOperational,
    /// No status within the time-out, or no readings where they are messages of their own.
    StatusLost,
    /// No heartbeat within the time-out.
    HeartbeatLost,
}

/// What a drive that counts in revolutions measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feedback {
    /// Position (revolutions), whole turns included.
    pub position: f32,
    /// Velocity (revolutions/s).
    pub velocity: f32,
    /// Torque (N m).
    pub torque: f32,
}

impl Feedback {
    /// Of readings that are numbers.
    pub(crate) fn new(position: f32, velocity: f32, torque: f32) -> Option<Self> {
        let finite = [position, velocity, torque].iter().all(|value| value.is_finite());
        finite.then_some(Self { position, velocity, torque })
    }

    /// The count within the revolution that an encoder of 2^BITS counts shows `age` (s) after the reading, at constant velocity; rounded down as in
    /// [`crate::encoder`].
    ///
    /// The position is an f32, of 24 bits with its whole turns: beyond n turns no more than 23 - log2(n) of them are left for the angle.
    pub fn count<const BITS: u32>(&self, age: f32) -> u32 {
        const { assert!(BITS < 32, "a count has less than 32 bits") };
        let counts = (self.position + self.velocity * age) * (1_u64 << BITS) as f32;
        let towards_zero = counts as i64;
        // Below zero the conversion rounds up.
        let floor = towards_zero.wrapping_sub(i64::from(counts < towards_zero as f32));
        floor as u32 & ((1 << BITS) - 1)
    }
}

/// The identifier of a frame with data, if it has 11 bits.
pub(crate) fn standard_id(frame: &impl Frame) -> Option<u16> {
    match frame.id() {
        Id::Standard(id) if !frame.is_remote_frame() => Some(id.as_raw()),
        _ => None,
    }
}

/// A message that the drive sends again and again.
#[derive(Clone, Debug)]
struct Message {
    /// What its silence is called.
    lost: Cause,
    /// Cycles since it came.
    silent: u32,
}

/// Decides whether a drive that sends N kinds of messages is driven. They have the numbers in which [`Guard::new`] names them.
#[derive(Clone, Debug)]
pub(crate) struct Guard<const N: usize> {
    peak_torque: f32,
    timeout: u32,
    messages: [Message; N],
    cause: Option<Cause>,
    /// The drive was enabled since the last reset.
    enabled: bool,
    /// Cycles since the one attempt after the last reset.
    attempted: Option<u32>,
}

impl<const N: usize> Guard<N> {
    /// Safe until [`Self::reset`]; `None` when the peak torque is not positive and finite, or there is no time-out.
    pub(crate) fn new(peak_torque: f32, timeout: u32, lost: [Cause; N]) -> Option<Self> {
        (peak_torque > 0.0 && peak_torque.is_finite() && timeout > 0).then(|| Self {
            peak_torque,
            timeout,
            messages: lost.map(|lost| Message { lost, silent: 0 }),
            cause: Some(Cause::NotStarted),
            enabled: false,
            attempted: None,
        })
    }

    pub(crate) fn cause(&self) -> Option<Cause> {
        self.cause
    }

    pub(crate) fn timeout(&self) -> u32 {
        self.timeout
    }

    /// Safe again until [`Self::reset`], which is no fault.
    pub(crate) fn disable(&mut self) {
        (self.cause, self.enabled, self.attempted) = (Some(Cause::NotStarted), false, None);
    }

    pub(crate) fn reset(&mut self) {
        (self.cause, self.enabled, self.attempted) = (None, false, None);
        self.messages.iter_mut().for_each(|message| message.silent = 0);
    }

    /// The first cause stays.
    pub(crate) fn stop(&mut self, cause: Cause) {
        self.cause.get_or_insert(cause);
    }

    /// The message of this number has come.
    pub(crate) fn heard(&mut self, message: usize) {
        if let Some(message) = self.messages.get_mut(message) {
            message.silent = 0;
        }
    }

    /// The drive says that it is enabled, or why it is not.
    pub(crate) fn status(&mut self, status: Result<(), Cause>) {
        match status {
            Ok(()) => self.enabled = true,
            Err(cause) if self.enabled => self.stop(cause),
            Err(_) => {}
        }
    }

    /// Once at the start of every cycle.
    pub(crate) fn cycle(&mut self) {
        self.attempted = self.attempted.map(|cycles| cycles.saturating_add(1));
        for Message { silent, .. } in &mut self.messages {
            *silent = silent.saturating_add(1);
        }
        if let Some(lost) = self.lost() {
            self.stop(lost);
        }
    }

    /// What the silence of the first message that is missing is called, in the safe state too.
    pub(crate) fn lost(&self) -> Option<Cause> {
        self.messages.iter().find(|message| message.silent > self.timeout).map(|message| message.lost)
    }

    /// Cycles since the attempt began, 0 in the first call after the last reset. After `limit` it has failed for this cause.
    ///
    /// `None` in the safe state. There is one attempt a reset: a fault that outlasts it is another one, or stays.
    pub(crate) fn attempt(&mut self, limit: u32, failed: Cause) -> Option<u32> {
        let cycles = *self.attempted.get_or_insert(0);
        if cycles >= limit {
            self.stop(failed);
        }
        self.cause.is_none().then_some(cycles)
    }

    /// Cycles since the attempt began, if it did.
    pub(crate) fn attempted(&self) -> Option<u32> {
        self.attempted
    }

    /// The torque takes effect.
    pub(crate) fn drives(&self) -> bool {
        self.enabled && self.cause.is_none()
    }

    /// The torque that is sent (N m) for the one that is asked for.
    pub(crate) fn torque(&self, torque: f32) -> f32 {
        if !self.drives() || torque.is_nan() {
            return 0.0;
        }
        // Not `clamp`, which panics where it cannot see that its limits are in order, nor `max` and `min`, which are calls where the core has
        // no instruction for them.
        if torque > self.peak_torque {
            self.peak_torque
        } else if torque < -self.peak_torque {
            -self.peak_torque
        } else {
            torque
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn at(position: f32) -> Feedback {
        Feedback::new(position, 0.0, 0.0).unwrap()
    }

    #[test]
    fn a_count_is_rounded_down_in_every_turn() {
        for (position, count) in [
            (0.0, 0),
            (0.25, 0x1000),
            (0.999_99, 0x3fff),
            (1.0, 0),
            (7.25, 0x1000),
            (-0.25, 0x3000),
            (-1e-9, 0x3fff),
            (-1.0, 0),
            (-7.75, 0x1000),
        ] {
            assert_eq!(at(position).count::<14>(0.0), count, "{position}");
        }
    }

    #[test]
    fn a_count_goes_on_at_the_velocity() {
        // 50 revolutions/s for 0.1 ms are 0.005 of one.
        for (velocity, count) in [(50.0, 0x1000 + 81), (-50.0, 0x1000 - 82)] {
            assert_eq!(Feedback { velocity, ..at(3.25) }.count::<14>(1e-4), count);
        }
    }

    #[test]
    fn what_is_no_number_is_no_feedback() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(Feedback::new(bad, 0.0, 0.0), None);
            assert_eq!(Feedback::new(0.0, bad, 0.0), None);
            assert_eq!(Feedback::new(0.0, 0.0, bad), None);
        }
    }

    #[test]
    fn parameters_out_of_range_guard_nothing() {
        for (peak, timeout) in [(0.0, 1), (-1.0, 1), (f32::NAN, 1), (f32::INFINITY, 1), (1.0, 0)] {
            assert!(Guard::new(peak, timeout, [Cause::StatusLost]).is_none(), "{peak} {timeout}");
        }
    }

    #[test]
    fn the_first_cause_stays_until_the_reset() {
        let mut guard = Guard::new(1.0, 3, [Cause::StatusLost]).unwrap();
        guard.stop(Cause::DriveFault);
        assert_eq!(guard.cause(), Some(Cause::NotStarted));
        guard.reset();
        guard.status(Err(Cause::Disabled));
        assert_eq!(guard.cause(), None);
        guard.status(Ok(()));
        guard.status(Err(Cause::Disabled));
        guard.status(Err(Cause::DriveFault));
        assert_eq!(guard.cause(), Some(Cause::Disabled));
    }

    proptest! {
        #[test]
        fn a_count_is_within_the_revolution(
            position in prop::num::f32::ANY, velocity in prop::num::f32::ANY, age in prop::num::f32::ANY,
        ) {
            if let Some(feedback) = Feedback::new(position, velocity, 0.0) {
                prop_assert!(feedback.count::<14>(age) < 1 << 14);
            }
        }

        #[test]
        fn a_torque_is_bounded_and_only_that_of_an_enabled_drive(torque in prop::num::f32::ANY, enabled: bool) {
            let mut guard = Guard::new(2.5, 3, [Cause::StatusLost]).unwrap();
            prop_assert_eq!(guard.torque(torque), 0.0);
            guard.reset();
            guard.status(if enabled { Ok(()) } else { Err(Cause::Disabled) });
            let sent = guard.torque(torque);
            prop_assert!(sent.abs() <= 2.5);
            prop_assert!(enabled || sent == 0.0);
            prop_assert!(!enabled || torque.is_nan() || torque.abs() > 2.5 || sent == torque);
        }
    }
}
