//! Parameters of the observer, checked and built.
//!
//! Delay and period of the output encoder are given in control periods; the observer counts its own and rounds up.

use crate::angle::Ratio;
use crate::compensator::estimate::observer::Observer;
use crate::compensator::estimate::observer::deviation::Uncertainty;
use crate::compensator::estimate::observer::gains::GainSets;
use crate::compensator::estimate::observer::multi_rate::MultiRate;
use crate::compensator::estimate::observer::past::LONGEST_DELAY;
use crate::compensator::estimate::observer::range::Range;
use crate::compensator::schedule::{OBSERVER_PERIODS, SLOW_PERIODS};
use crate::compensator::{Limits, Tolerances};
use crate::error::{Error, require};
use crate::gear::GearParams;
use crate::real::{RADIANS_PER_COUNT, Real};

/// Most control periods from one reading of the output encoder to the next.
pub const LONGEST_PERIOD: u32 = 100;

/// Parameters of the observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObserverParams<R> {
    /// Gains while the motor moves.
    pub moving: GainSets<R>,
    /// Gains while it stands.
    pub standing: GainSets<R>,
    /// Motion threshold: displacement above which the motor moves (rad).
    pub motion_threshold: R,
    /// Delay of the output encoder's reading (control periods).
    pub output_encoder_delay: u32,
    /// Control periods from one reading of the output encoder to the next.
    pub output_encoder_period: u32,
    /// q (rad): one count of the output encoder.
    pub output_count: R,
    /// Uncertainty of the model.
    pub uncertainty: Uncertainty<R>,
}

impl<R: Real> ObserverParams<R> {
    /// Prepares the observer of a gear for the control period dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `gains` unless all are finite, `motion_threshold` or `output_count` unless in 0..=1,
    /// `output_encoder_delay` beyond [`LONGEST_DELAY`], `output_encoder_period` unless in 1..=[`LONGEST_PERIOD`], or
    /// as [`Limits::check`] and the gear's parts.
    pub fn build(
        &self,
        gear: &GearParams<R>,
        limits: &Limits<R>,
        tolerances: &Tolerances<R>,
        dt: R,
    ) -> Result<Observer<R>, Error> {
        let sets = || self.moving.iter().chain(&self.standing);
        let mut gains = sets().flat_map(|g| g.motor.iter().chain(&g.output).chain(&g.torque).chain(&g.past));
        require(gains.all(|gain| gain.is_finite()), "gains")?;
        require(sets().all(|gains| gains.spread.is_finite()), "deviation")?;
        require(self.motion_threshold >= R::ZERO && self.motion_threshold <= R::ONE, "motion_threshold")?;
        require(self.output_count >= R::ZERO && self.output_count <= R::ONE, "output_count")?;
        let delay = self.output_encoder_delay;
        require(delay as usize <= LONGEST_DELAY, "output_encoder_delay")?;
        require((1..=LONGEST_PERIOD).contains(&self.output_encoder_period), "output_encoder_period")?;
        limits.check()?;
        let dt = R::from_i32(OBSERVER_PERIODS as i32) * dt;
        let ratio = Ratio::one_over(gear.ratio)?;
        let wave_generator_inertia = gear.wave_generator_inertia;
        require(wave_generator_inertia > R::ZERO, "wave_generator_inertia")?;
        Ok(Observer {
            moving: self.moving.map(|gains| gains.relative(ratio.value())),
            standing: self.standing.map(|gains| gains.relative(ratio.value())),
            motion_threshold_angle: self.motion_threshold,
            motion_threshold: (self.motion_threshold * R::lit(1.0 / RADIANS_PER_COUNT))
                .to_i32()
                .unsigned_abs(),
            late: delay,
            looks_back: delay > 0 || self.output_encoder_period > 1,
            ratio,
            delay: delay.div_ceil(OBSERVER_PERIODS),
            period: self.output_encoder_period.div_ceil(SLOW_PERIODS) * (SLOW_PERIODS / OBSERVER_PERIODS),
            output_count: self.output_count,
            uncertainty: self.uncertainty,
            limits: Range::build(gear, limits, tolerances, self.uncertainty.stiffness, self.output_count)?,
            inverse_wave_generator_inertia: R::ONE / wave_generator_inertia,
            inverse_flexspline_inertia: R::ONE / gear.flexspline_inertia,
            multi_rate: MultiRate::build(ratio.value(), dt),
        })
    }
}
