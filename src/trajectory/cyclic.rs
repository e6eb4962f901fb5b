//! Setpoints for every control period from targets that come once a cycle of a bus.
//!
//! ```text
//! q(u)  = p_1 - d_1*(1 - u)^2/2 + d_2*u^2/2        0 <= u < 1,  d_1 = p_1 - p_0,  d_2 = p_2 - p_1
//! q'(u) = (d_1*(1 - u) + d_2*u)/T,   q''(u) = (d_2 - d_1)/T^2
//! u    <- u + (1 - (u_a - 1/2)/64)*dt/T            u_a: u at which the last target came
//! ```
//!
//! p_0 to p_2 are the last three targets, T is the cycle of the bus, dt the control period. It is the uniform quadratic B-spline: position and
//! velocity are continuous, a motion at constant speed is exact, and one of the acceleration a is a*T^2/8 off. The motion lags the targets by 2*T: 1.5*T of the
//! spline, and T/2 for which a target waits, so that it may come T/4 earlier or later than on the average. The phase follows the clock of the bus: u_a goes to
//! 1/2 with a time constant of 64*T, at rates that are within 0.8 % of dt/T.
//!
//! In the place of a target that is missing stands the last one, moved on at the mean speed between the last two that came, however many cycles
//! these were apart: what is off is not extrapolated. One that comes late after all takes the place of the next. How long that may go on is the
//! caller's: [`crate::compensator::Input::setpoint_age`] brakes the joint. A target out of reach gives a setpoint out of reach, which the control limits
//! ([`crate::compensator::Command`]); a difference of targets saturates at half a revolution. Units: rad, s.
//!
//! C. de Boor, "A Practical Guide to Splines", Springer (1978), chapter 9.

use crate::angle::Angle;
use crate::compensator::Setpoint;
use crate::error::{Error, require};
use crate::real::Real;

/// Cycles in which the phase follows the bus.
const FOLLOWING: f64 = 64.0;

/// Cycles that are counted without a target.
const MISSING: u32 = 1 << 20;

/// Interpolation of a cyclic target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cyclic<R> {
    /// 1/T (1/s), 1/T^2 (1/s^2).
    rate: R,
    rate_squared: R,
    /// dt/T.
    advance: R,
}

/// Its state; the default is before the first target.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CyclicState<R> {
    /// Absent before the first target.
    spline: Option<Spline<R>>,
    /// The last target, the cycles since then, and the speed at which it moves on (rad a cycle).
    last: Angle<R>,
    missing: u32,
    speed: R,
    /// Target of the next cycle.
    next: Option<Angle<R>>,
    /// u, and its next step.
    phase: R,
    advance: R,
}

/// The present piece.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Spline<R> {
    /// p_1.
    middle: Angle<R>,
    /// d_1, d_2 (rad).
    before: R,
    after: R,
}

impl<R: Real> Cyclic<R> {
    /// For a bus whose cycle is a number of control periods dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`]: `dt` outside 1e-6..=1, `periods` outside 2..=1000.
    pub fn build(periods: u32, dt: R) -> Result<Self, Error> {
        require(dt >= R::lit(1e-6) && dt <= R::ONE, "dt")?;
        require((2..=1000).contains(&periods), "periods")?;
        let rate = R::ONE / (R::from_i32(periods.cast_signed()) * dt);
        Ok(Self { rate, rate_squared: rate * rate, advance: dt * rate })
    }

    /// Takes a target that has come.
    pub fn take(&self, state: &mut CyclicState<R>, target: Angle<R>) {
        if state.spline.is_none() {
            state.spline = Some(Spline { middle: target, before: R::ZERO, after: R::ZERO });
            (state.phase, state.last) = (R::lit(0.5), target);
            (state.next, state.missing, state.speed) = (None, 0, R::ZERO);
        } else {
            state.next = Some(target);
        }
        let late = (state.phase - R::lit(0.5)) * R::lit(1.0 / FOLLOWING);
        state.advance = self.advance * (R::ONE - late);
    }

    /// Setpoint of the next control period; none before the first target.
    pub fn step(&self, state: &mut CyclicState<R>) -> Option<Setpoint<R>> {
        state.phase += state.advance;
        if state.phase >= R::ONE {
            state.phase -= R::ONE;
            state.go_on();
        }
        state.spline.map(|spline| self.at(&spline, state.phase))
    }

    fn at(&self, spline: &Spline<R>, phase: R) -> Setpoint<R> {
        let Spline { middle, before, after } = *spline;
        let left = R::ONE - phase;
        let offset = (after * phase * phase - before * left * left) * R::lit(0.5);
        Setpoint {
            position: middle.plus(offset),
            velocity: (before * left + after * phase) * self.rate,
            acceleration: (after - before) * self.rate_squared,
            ..Setpoint::default()
        }
    }
}

impl<R: Real> CyclicState<R> {
    /// To the next piece.
    fn go_on(&mut self) {
        let Some(spline) = &mut self.spline else { return };
        let end = spline.middle.plus(spline.after);
        let target = match self.next.take() {
            Some(target) => {
                let way = target.minus(self.last);
                // Most often no cycle has gone by without one.
                self.speed = if self.missing == 0 { way } else { way / R::from_i32(self.missing as i32 + 1) };
                (self.last, self.missing) = (target, 0);
                target
            }
            None => {
                self.missing = (self.missing + 1).min(MISSING);
                end.plus(self.speed)
            }
        };
        *spline = Spline { middle: end, before: spline.after, after: target.minus(end) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    const DT: f64 = 1e-4;
    const CYCLE: f64 = 1e-3;

    /// Setpoints of this motion, of which a target comes every millisecond, moved by `jitter` periods: time and setpoint.
    fn followed(
        motion: impl Fn(f64) -> f64,
        periods: usize,
        jitter: impl Fn(usize) -> usize,
    ) -> Vec<(f64, Setpoint<f64>)> {
        let cyclic = Cyclic::build(10, DT).unwrap();
        let mut state = CyclicState::default();
        let mut setpoints = Vec::new();
        for period in 0..periods {
            let time = period as f64 * DT;
            for cycle in [period / 10, (period / 10).saturating_sub(1)] {
                if cycle * 10 + jitter(cycle) == period {
                    cyclic.take(&mut state, Angle::from_radians(motion(cycle as f64 * CYCLE)));
                }
            }
            setpoints.extend(cyclic.step(&mut state).map(|setpoint| (time, setpoint)));
        }
        setpoints
    }

    fn angle(setpoint: &Setpoint<f64>) -> f64 {
        setpoint.position.minus(Angle::default())
    }

    #[test]
    fn a_motion_at_constant_acceleration_lags_by_two_cycles() {
        let (velocity, acceleration) = (0.3, 4.0);
        let motion = |time: f64| velocity * time + 0.5 * acceleration * time * time;
        for (time, setpoint) in followed(motion, 1000, |_| 0).iter().skip(40) {
            // The first step is taken in the period in which a target comes.
            let then = time + DT - 2.0 * CYCLE;
            let expected = motion(then) + acceleration * CYCLE * CYCLE / 8.0;
            assert!((angle(setpoint) - expected).abs() < 2e-9, "{time}");
            assert!((setpoint.velocity - (velocity + acceleration * then)).abs() < 1e-6);
            assert!((setpoint.acceleration - acceleration).abs() < 5e-3);
        }
    }

    #[test]
    fn targets_that_come_at_odd_times_move_nothing_but_the_phase() {
        // By 0 to 4 periods, the mean is 2.
        let jitter = |cycle: usize| cycle * 7 % 5;
        let velocity = 1.0;
        let setpoints = followed(|time| velocity * time, 20_000, jitter);
        for (time, setpoint) in setpoints.iter().skip(5000) {
            assert!((setpoint.velocity - velocity).abs() < 1e-6, "{time}: {}", setpoint.velocity);
            let lag = time - angle(setpoint) / velocity;
            assert!((lag - 2.1e-3).abs() < 1e-4, "{time}: {lag}");
        }
    }

    #[test]
    fn a_bus_whose_clock_differs_is_followed() {
        // Every 50th cycle comes a period early: 0.2 % faster than the control's clock.
        let cyclic = Cyclic::build(10, DT).unwrap();
        let mut state = CyclicState::default();
        let (mut due, mut cycle) = (0, 0);
        for period in 0..100_000 {
            if period == due {
                cyclic.take(&mut state, Angle::from_radians(cycle as f64 * CYCLE));
                cycle += 1;
                due += if cycle % 50 == 0 { 9 } else { 10 };
            }
            cyclic.step(&mut state);
            if period > 5000 && due - period == 1 {
                assert!(state.next.is_some() || state.phase < 0.5, "{period}: {}", state.phase);
            }
        }
    }

    #[test]
    fn missing_targets_go_on_at_their_speed() {
        let cyclic = Cyclic::build(10, DT).unwrap();
        let mut state = CyclicState::default();
        for cycle in 0..10 {
            cyclic.take(&mut state, Angle::from_radians(f64::from(cycle) * 1e-3));
            for _ in 0..10 {
                cyclic.step(&mut state);
            }
        }
        for _ in 0..50 {
            let setpoint = cyclic.step(&mut state).unwrap();
            assert!((setpoint.velocity - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn a_bus_that_is_slower_than_told_is_followed_without_growing_errors() {
        for slower in [2, 3, 10] {
            let cyclic = Cyclic::build(10, DT).unwrap();
            let mut state = CyclicState::default();
            let motion = |time: f64| 0.1 * (1.0 - (6.0 * time).cos());
            let mut most: f64 = 0.0;
            for period in 0..20_000 {
                let time = period as f64 * DT;
                if period % (10 * slower) == 0 {
                    cyclic.take(&mut state, Angle::from_radians(motion(time)));
                }
                let setpoint = cyclic.step(&mut state).unwrap();
                most = most.max((angle(&setpoint) - motion(time - 2.0 * CYCLE)).abs());
            }
            // The speed is that of the middle between two targets, extrapolated for as long.
            let apart = (slower + 1) as f64 * CYCLE;
            assert!(most < 2.0 * 3.6 * apart * apart, "{slower}: {most}");
        }
    }

    #[test]
    fn what_is_out_of_range_is_refused_by_name() {
        assert_eq!(Cyclic::build(1, DT), Err(Error::OutOfRange("periods")));
        assert_eq!(Cyclic::build(1001, DT), Err(Error::OutOfRange("periods")));
        assert_eq!(Cyclic::build(10, f64::NAN), Err(Error::OutOfRange("dt")));
        assert_eq!(Cyclic::build(10, DT).unwrap().step(&mut CyclicState::default()), None);
    }

    proptest! {
        #[test]
        fn setpoints_stay_between_the_last_targets_and_join(targets in prop::collection::vec(-1e-3..1e-3, 4..20)) {
            let cyclic = Cyclic::build(10, DT as f32).unwrap();
            let mut state = CyclicState::default();
            let mut last: Option<Setpoint<f32>> = None;
            for (index, target) in targets.iter().enumerate() {
                cyclic.take(&mut state, Angle::from_radians(*target as f32));
                let recent = &targets[index.saturating_sub(3)..=index];
                let least = recent.iter().copied().fold(f64::INFINITY, f64::min) as f32;
                let most = recent.iter().copied().fold(f64::NEG_INFINITY, f64::max) as f32;
                for _ in 0..10 {
                    let setpoint = cyclic.step(&mut state).unwrap();
                    let position = setpoint.position.minus(Angle::default());
                    prop_assert!(position >= least - 1e-8 && position <= most + 1e-8);
                    if let Some(last) = last {
                        // A period at the mean of both speeds, and at most one second difference of a change of speed.
                        let moved = setpoint.position.minus(last.position);
                        let mean = 0.5 * (setpoint.velocity + last.velocity) * DT as f32;
                        prop_assert!((moved - mean).abs() < 1e-4, "{} {}", moved, mean);
                    }
                    last = Some(setpoint);
                }
            }
        }
    }
}
