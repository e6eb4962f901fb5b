//! When the control step runs: every 0.1 ms by the clock, sooner or later by its jitter, and now and then not at all.
//!
//! ```text
//! t_k = k*T + j_k,    j_k even within +-J
//! ```
//!
//! At t_k the sensors are read and the new torque is given to the drive. A step that is missed reads nothing and gives
//! nothing: the torque before it is held. The jitter has no mean, and no instant shifts the next one. Unit: s.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Errors of the clock.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClockParams {
    /// J (s), less than half the control period.
    pub jitter: f64,
    /// Fraction of the steps that are missed.
    pub missed: f64,
}

/// The clock of a bench.
#[derive(Clone, Debug)]
pub struct Clock {
    params: ClockParams,
    random: ChaCha8Rng,
    /// j_k (s).
    offset: f64,
    /// Since the last step that was run, without j_k (s).
    waited: f64,
    /// Time error of the last step, if there was one (s).
    last: Option<f64>,
}

/// One instant of the clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// j_k (s).
    pub offset: f64,
    /// The step is run, and so much time has gone since the one before; 0 of the first (s).
    pub elapsed: Option<f64>,
}

impl Clock {
    /// Its first instant is on time.
    pub fn new(params: ClockParams, random: ChaCha8Rng) -> Self {
        Self { params, random, offset: 0.0, waited: 0.0, last: None }
    }

    /// The instant now.
    pub fn tick(&mut self) -> Tick {
        let offset = self.offset;
        if self.last.is_some() && self.params.missed > 0.0 && self.random.random_bool(self.params.missed) {
            return Tick { offset, elapsed: None };
        }
        let elapsed = self.last.map_or(0.0, |last| self.waited + (offset - last));
        (self.last, self.waited) = (Some(offset), 0.0);
        Tick { offset, elapsed: Some(elapsed) }
    }

    /// Goes to the next instant; returns its time error (s).
    pub fn advance(&mut self) -> f64 {
        self.waited += CONTROL_PERIOD;
        let jitter = self.params.jitter;
        self.offset = if jitter > 0.0 { self.random.random_range(-jitter..=jitter) } else { 0.0 };
        self.offset
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    fn clock(jitter: f64, missed: f64) -> Clock {
        Clock::new(ClockParams { jitter, missed }, ChaCha8Rng::seed_from_u64(5))
    }

    #[test]
    fn an_exact_clock_has_equal_steps() {
        let mut clock = clock(0.0, 0.0);
        assert_eq!(clock.tick(), Tick { offset: 0.0, elapsed: Some(0.0) });
        for _ in 0..10 {
            clock.advance();
            assert_eq!(clock.tick(), Tick { offset: 0.0, elapsed: Some(CONTROL_PERIOD) });
        }
    }

    /// Elapsed times add up to the time that has gone, whatever was missed, and are a period in the mean.
    #[test]
    fn jitter_and_missed_steps_keep_the_time() {
        let mut clock = clock(25e-6, 0.01);
        let (mut sum, mut missed, mut offset) = (0.0, 0, 0.0);
        let count = 100_000;
        for k in 0..count {
            let tick = clock.tick();
            assert!(tick.offset.abs() <= 25e-6);
            offset += tick.offset / f64::from(count);
            match tick.elapsed {
                Some(elapsed) => {
                    sum += elapsed;
                    assert!((sum - (f64::from(k) * CONTROL_PERIOD + tick.offset)).abs() < 1e-9);
                }
                None => missed += 1,
            }
            clock.advance();
        }
        assert!((900..1100).contains(&missed), "{missed}");
        assert!(offset.abs() < 0.2e-6, "{offset}");
    }
}
