//! The stream of a joint's readings, by the joint's own clock.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use strainwave_service::tuning::client::{Client, Error};
use strainwave_service::tuning::link::FASTEST;
use strainwave_service::tuning::{Reading, Refusal};

use super::port::Transport;

/// A connected joint.
pub type Joint = Client<Box<dyn Transport>>;

/// Longest wait at once: the joint is to hear of the host meanwhile.
const GLANCE: Duration = Duration::from_millis(100);
/// Time without a reading after which the joint is asked why, beside two intervals of the stream.
const SILENCE: Duration = Duration::from_secs(1);

/// The readings of a stream, each with its time (s) from the first on.
pub struct Readings<'a> {
    joint: &'a mut Joint,
    /// Control periods from one to the next.
    every: u16,
    /// Time after which they end (s).
    seconds: f64,
    stopped: &'static AtomicBool,
    /// Period of the last reading, and periods from the first one to it.
    last: Option<u32>,
    elapsed: u64,
    /// When the last reading came.
    heard: Instant,
    missing: u64,
    count: u64,
}

/// Control periods between readings for a rate of them (Hz), as near as can be.
pub fn periods(rate: f64, control_rate: u32) -> u16 {
    (f64::from(control_rate) / rate).round().clamp(f64::from(FASTEST), f64::from(u16::MAX)) as u16
}

impl<'a> Readings<'a> {
    /// Begins a stream; it ends after `seconds`, or when `stopped` is set.
    pub fn begin(
        joint: &'a mut Joint,
        rate: f64,
        seconds: f64,
        stopped: &'static AtomicBool,
    ) -> Result<Self, Error> {
        let every = periods(rate, joint.joint().rate);
        joint.stream(every)?;
        let heard = Instant::now();
        Ok(Self { joint, every, seconds, stopped, last: None, elapsed: 0, heard, missing: 0, count: 0 })
    }

    /// Ends the stream; how many readings came, and how many are missing in between.
    pub fn end(self) -> Result<(u64, u64), Error> {
        self.joint.stream(0)?;
        Ok((self.count, self.missing))
    }

    /// The next one; `None` at the end.
    fn following(&mut self) -> Result<Option<(f64, Reading)>, Error> {
        loop {
            if self.stopped.load(Ordering::Relaxed) {
                return Ok(None);
            }
            self.joint.keep_alive()?;
            if let Some(reading) = self.joint.next_reading(GLANCE)? {
                let time = self.time_of(&reading);
                let within = time <= self.seconds;
                self.count += u64::from(within);
                return Ok(within.then_some((time, reading)));
            }
            let interval = Duration::from_secs_f64(f64::from(self.every) / f64::from(self.rate()));
            if self.heard.elapsed() > SILENCE + 2 * interval {
                self.begin_anew()?;
            }
        }
    }

    /// Begins a stream anew that was lost on its way, unless the control runs no step.
    fn begin_anew(&mut self) -> Result<(), Error> {
        match self.joint.read() {
            // The joint still has the stream's order, which its control does not take.
            Err(Error::Refused { request, why: Refusal::Busy }) => {
                return Err(Error::Refused { request, why: Refusal::NoStep });
            }
            read => read?,
        };
        self.joint.stream(self.every)?;
        self.heard = Instant::now();
        Ok(())
    }

    fn rate(&self) -> u32 {
        self.joint.joint().rate.max(1)
    }

    /// Time of a reading that has come now.
    fn time_of(&mut self, reading: &Reading) -> f64 {
        let passed = self.last.map_or(0, |last| reading.period.wrapping_sub(last));
        let intervals = (f64::from(passed) / f64::from(self.every)).round() as u64;
        self.missing += intervals.saturating_sub(1);
        self.elapsed += u64::from(passed);
        self.last = Some(reading.period);
        self.heard = Instant::now();
        self.elapsed as f64 / f64::from(self.rate())
    }
}

impl Iterator for Readings<'_> {
    type Item = Result<(f64, Reading), Error>;

    fn next(&mut self) -> Option<Self::Item> {
        self.following().transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::periods;

    #[test]
    fn a_rate_is_that_of_whole_periods_within_what_the_joint_sends() {
        assert_eq!([1000.0, 300.0, 10.0, 0.2].map(|rate| periods(rate, 10_000)), [10, 33, 1000, 50_000]);
        assert_eq!([1000.0, 0.2].map(|rate| periods(rate, 2_000)), [10, 10_000]);
        assert_eq!(periods(0.2, 20_000), u16::MAX);
    }
}
