//! Torque through the flexspline from 2 to 8 strain gauges on the cup, which calibrate themselves by the ellipse.
//!
//! ```text
//! y_g     = ripple_g + p_g*tau + noise            ripple_g = c_g . [1, cos(2t), sin(2t), cos(4t), sin(4t)]
//! tau     = sum(p_g*(y_g - ripple_g))/sum(p_g^2)                       least squares over the gauges
//! e_g     = y_g - ripple_g - q_g*tau_ref                               residual at the reference's torque
//! c_g    += w*mu*x*e_g      x the regressor, w = 1 for the constant, 2 for the others
//! q_g    += mu*(tau_ref/tau_rated)*e_g/tau_rated
//! p_g     = p0_g*(c_g2.c0_g2)/(c0_g2.c0_g2)                             gain by the amplitude of the 2nd harmonic
//! mu      = s/(H + s),   H = limit(S, H_least, H_most)
//! ```
//!
//! y_g strain (without unit), tau torque through the shell (N m; the hysteresis beside the shell is not in it), t =
//! theta_wg - theta_fs, p strain per torque (1/(N m)), tau_ref the torque as known elsewhere, by the observer or the motor's
//! balance. c0 and p0 are those of the mesh, [`StrainGauge`]. s is the way of the wave generator (rad) since the
//! gauge was last learnt, S its sum.
//!
//! **Why the gain is the ellipse's.** A gauge's gain cannot be told from the torque alone: a reference that is 10 % off
//! would make every gauge 10 % off. But the wave generator strains each gauge by ten times what rated torque does, by an
//! amount that geometry gives, once every half revolution: the gain is the amplitude that is read over the one that the
//! mesh predicts. The scale of the torque is then that of the ellipse w0 and of the cup's stiffness, and only the
//! zero is the reference's: its mean over the memory must be right, its scale need not be. q_g, the gauge's gain on the
//! reference, takes the reference's own scale up, so that it stays out of the harmonics.
//!
//! **Misplacement** around the cup turns the 2nd harmonic's phase, along the cup and in direction changes amplitude and
//! phase: the harmonics learn all of it. What a misplacement changes in the ratio of the torque's strain to the
//! ellipse's is not seen; it is declared, [`TorqueGaugesParams::misplacement`].
//!
//! **Excitation.** Learning goes with the way of the wave generator, not with time: at a standstill mu = 0 and nothing
//! moves, at any speed a revolution teaches the same. H is a memory in rad: at first short, so that the prior is gone after
//! some revolutions; then all that was seen, and at most `FORGETTING`. The coefficients are then means over the whole way, and the
//! reference's friction, whose error has the sign of the motion, averages out of the zero as the joint goes to and fro; a memory of a
//! quarter of the way keeps that of the last motions, and S8 has 2.5 times the error. In every third step one gauge learns, in turn; the
//! projection of its coefficients follows in the next step, its gain and the deviation in the one after: the cost of a step is bounded.
//!
//! **Bounds.** Every coefficient stays within the band around the mesh's that gain, offset and misplacement can explain
//! (projection); a residual beyond all of these, NaN included, is not learnt; torque and deviation are
//! finite for any bits.
//!
//! Standard deviation: with k the part of the prior's error that is left (k -= mu*k) and v the mean square over the
//! gauges of what least squares leaves,
//!
//! ```text
//! sd^2 = v*G/(G - 1)/sum(p^2) + k^2*prior^2 + misplacement^2*tau^2/G + reference^2
//! ```
//!
//! with prior^2 = sum((gain*|c0_g2|)^2 + offset^2)/sum(p0^2). Discretisation: one step a control period; the regressors are
//! orthogonal over half a revolution, hence one mu for each in the place of a covariance (a normalised LMS).
//! S. Haykin, "Adaptive Filter Theory", 5th edition, 2014, chapter 7.

mod reading;

pub use reading::GaugeTorque;

use crate::angle::Angle;
use crate::error::{Error, require};
use crate::flexspline::StrainGauge;
use crate::flexspline::reduced::RANGE;
use crate::real::{RADIANS_PER_COUNT, Real};

/// Memory at the start (rad of the wave generator): half a revolution, over which the regressors are orthogonal.
const START: f64 = core::f64::consts::PI;
/// Longest memory (rad): 100 revolutions.
const FORGETTING: f64 = 628.0;
/// Largest way of one correction, in starting memories: the gains of one step add up to less than 2.
const LARGEST_WAY: f64 = 0.3;
/// Bands of the learnt coefficients and of what a residual may be, in declared deviations.
const BAND: f64 = 4.0;
/// Misfit after a step of its low pass.
const MISFIT_SHARE: f64 = 0.01;

/// Gauges on a cup, and how well they are known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueGaugesParams<R, const G: usize> {
    /// The gauges where they should be, as the mesh has them.
    pub gauges: [StrainGauge<R>; G],
    /// The gear's rated torque (N m), positive.
    pub rated_torque: R,
    /// Standard deviation of a gauge's gain from 1; 1e-3..=0.2.
    pub gain: R,
    /// Standard deviation of a gauge's offset (strain); 0..=1e-2.
    pub offset: R,
    /// Standard deviation of a reading's noise (strain); 1e-9..=1e-2.
    pub noise: R,
    /// Standard deviation, relative, of the ratio of torque strain to ellipse strain by misplacement; 0..=0.2.
    pub misplacement: R,
    /// Standard deviation of the mean of the reference's error (N m); 0 or more, finite.
    pub reference: R,
}

/// The built gauges.
///
/// Four gauges with unknown gains and offsets, on a wave generator that turns under a swinging torque:
///
/// ```
/// # mod joint { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/joint/hd25_100.rs")); }
/// # use joint::JOINT;
/// use strainwave::Angle;
/// use strainwave::flexspline::{Reduced, StrainGauge, TorqueGaugesParams};
///
/// let cup = Reduced::<f32, 36, 4>::build(&JOINT.gear.flexspline, JOINT.gear.rated_torque)?;
/// let places = [((0, 0), (1, 1)), ((9, 0), (1, 1)), ((18, 0), (-1, 1)), ((27, 0), (-1, 1))];
/// let mut gauges = [StrainGauge::build(&cup, (0, 0), (1, 1))?; 4];
/// for (gauge, (node, direction)) in gauges.iter_mut().zip(places) {
///     *gauge = StrainGauge::build(&cup, node, direction)?;
/// }
/// let params = TorqueGaugesParams {
///     gauges, rated_torque: JOINT.gear.rated_torque,
///     gain: 0.06, offset: 5e-5, noise: 2e-6, misplacement: 0.01, reference: 0.5,
/// };
/// let sensor = params.build()?;
/// let mut state = sensor.rest();
/// let (gains, offset) = ([1.08, 0.94, 0.91, 1.05], 4e-5); // nobody tells the sensor
/// let mut wave_generator = Angle::<f32>::default();
/// let mut error = 0.0;
/// for period in 0..20_000 {
///     wave_generator = wave_generator.plus(0.02); // 200 rad/s
///     let torque = 50.0 * (period as f32 * 1e-3).sin();
///     let mut strains = gains;
///     for (strain, gauge) in strains.iter_mut().zip(&gauges) {
///         *strain = *strain * gauge.strain(torque, wave_generator) + offset;
///     }
///     let known = 0.9 * torque; // the motor's torque constant is 10 % off
///     let read = sensor.step(&mut state, &strains, wave_generator, Some(known));
///     error = read.torque - torque;
///     assert!(read.standard_deviation > 0.0);
/// }
/// assert!(error.abs() < 0.3, "{error}"); // N m
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueGauges<R, const G: usize> {
    gauges: [Prior<R>; G],
    largest_torque: R,
    per_rated: R,
    /// Largest reference that is learnt from (N m).
    largest_reference: R,
    /// `G/(G - 1)` by the mean over the gauges, `1/G` of it.
    misfit_per_gauge: R,
    least_misfit: R,
    prior_variance: R,
    misplacement_variance: R,
    reference_variance: R,
}

/// A gauge as the mesh has it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Prior<R> {
    /// Of [1, cos 2t, sin 2t, cos 4t, sin 4t], and per torque.
    coefficients: [R; COEFFICIENTS],
    /// Largest distance of each from these.
    band: [R; COEFFICIENTS],
    /// p per amplitude of cos 2t and of sin 2t (1/(N m)).
    per_amplitude: [R; 2],
    /// Largest residual that is learnt.
    residual: R,
}

/// The five of the ripple, and the gain on the reference.
const COEFFICIENTS: usize = 6;

/// What a gauge has learnt.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Learnt<R> {
    coefficients: [R; COEFFICIENTS],
    /// Strain per torque (1/(N m)).
    per_torque: R,
    /// Phase of the wave generator when it was last learnt.
    phase: u32,
}

/// What a step does beside the torque, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Slot {
    /// Corrects a gauge's coefficients.
    Learn,
    /// Brings them back into their bands; the misfit.
    Project,
    /// Its gain, and the standard deviation.
    Weight,
}

/// What the gauges have learnt, and which is next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueGaugesState<R, const G: usize> {
    learnt: [Learnt<R>; G],
    slot: Slot,
    next: usize,
    /// Way of the wave generator that was learnt from (rad), over all gauges.
    way: R,
    /// H (rad).
    memory: R,
    /// mu of the last correction.
    step: R,
    /// Part of the prior's error that is left.
    left: R,
    misfit: R,
    /// 1/sum(p_g^2), every third step.
    per_square: R,
    /// Standard deviation of the torque (N m), every third step.
    deviation: R,
    started: bool,
}

impl<R: Real, const G: usize> TorqueGaugesParams<R, G> {
    /// Builds the sensor.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `gauges` unless 2 to 8, each strained by torque and by the ellipse's 2nd harmonic; else the name of the
    /// first parameter that is out of its range.
    pub fn build(&self) -> Result<TorqueGauges<R, G>, Error> {
        self.check()?;
        let sum = |of: fn(&StrainGauge<R>) -> R| self.gauges.iter().map(of).fold(R::ZERO, |sum, x| sum + x);
        let (squares, ripple) =
            (sum(|gauge| gauge.per_torque * gauge.per_torque), sum(second_harmonic_squared));
        let count = R::from_i32(G as i32);
        let offsets = count * self.offset * self.offset;
        Ok(TorqueGauges {
            gauges: self.gauges.map(|gauge| self.prior(&gauge)),
            largest_torque: R::lit(RANGE) * self.rated_torque,
            per_rated: R::ONE / self.rated_torque,
            largest_reference: R::lit(RANGE) * self.rated_torque,
            misfit_per_gauge: R::ONE / (count - R::ONE),
            least_misfit: (count - R::ONE) * self.noise * self.noise,
            prior_variance: (self.gain * self.gain * ripple + offsets) / squares,
            misplacement_variance: self.misplacement * self.misplacement / count,
            reference_variance: self.reference * self.reference,
        })
    }

    fn check(&self) -> Result<(), Error> {
        let within = |value: R, least: f64, most: f64| value >= R::lit(least) && value <= R::lit(most);
        require((2..=8).contains(&G), "gauges")?;
        let strained = |gauge: &StrainGauge<R>| {
            (gauge.per_torque * gauge.per_torque).is_positive()
                && second_harmonic_squared(gauge).is_positive()
        };
        require(self.gauges.iter().all(strained), "gauges")?;
        require(self.rated_torque.is_positive() && self.rated_torque <= R::lit(1e6), "rated_torque")?;
        require(within(self.gain, 1e-3, 0.2), "gain")?;
        require(within(self.offset, 0.0, 1e-2), "offset")?;
        require(within(self.noise, 1e-9, 1e-2), "noise")?;
        require(within(self.misplacement, 0.0, 0.2), "misplacement")?;
        require(self.reference >= R::ZERO && self.reference <= R::lit(1e6), "reference")
    }

    fn prior(&self, gauge: &StrainGauge<R>) -> Prior<R> {
        let square = second_harmonic_squared(gauge);
        let amplitude = square.sqrt();
        let ripple = R::lit(BAND) * self.gain * amplitude;
        let constant = R::lit(BAND) * self.offset + ripple;
        let per_torque = R::lit(BAND) * self.gain * gauge.per_torque.abs();
        Prior {
            coefficients: [
                gauge.constant,
                gauge.cosine,
                gauge.sine,
                gauge.cosine_4,
                gauge.sine_4,
                gauge.per_torque,
            ],
            band: [constant, ripple, ripple, ripple, ripple, per_torque],
            per_amplitude: [gauge.cosine, gauge.sine].map(|part| gauge.per_torque * part / square),
            residual: R::lit(BAND) * (constant + R::lit(RANGE) * self.rated_torque * per_torque),
        }
    }
}

/// Square of the amplitude of the 2nd harmonic.
fn second_harmonic_squared<R: Real>(gauge: &StrainGauge<R>) -> R {
    gauge.cosine * gauge.cosine + gauge.sine * gauge.sine
}

impl<R: Real, const G: usize> TorqueGauges<R, G> {
    /// Nothing learnt: every gauge is as the mesh has it.
    pub fn rest(&self) -> TorqueGaugesState<R, G> {
        let learnt = |prior: Prior<R>| Learnt {
            coefficients: prior.coefficients,
            per_torque: prior.coefficients[COEFFICIENTS - 1],
            phase: 0,
        };
        TorqueGaugesState {
            learnt: self.gauges.map(learnt),
            slot: Slot::Learn,
            next: 0,
            way: R::ZERO,
            memory: R::lit(START),
            step: R::ZERO,
            left: R::ONE,
            misfit: self.least_misfit,
            per_square: R::ONE / sum_of_squares(self.per_torque().into_iter()),
            deviation: self.largest_torque,
            started: false,
        }
    }

    /// Strain per torque of each gauge, as the mesh has it (1/(N m)).
    pub fn per_torque(&self) -> [R; G] {
        self.gauges.map(|prior| prior.coefficients[COEFFICIENTS - 1])
    }

    /// Torque of a control period's readings at a wave-generator angle seen from the cup, theta_wg - theta_fs; one gauge
    /// learns from `reference`, the torque as known elsewhere (N m), where there is one.
    #[inline(never)] // The timing budget counts it by its symbol.
    pub fn step(
        &self,
        state: &mut TorqueGaugesState<R, G>,
        strains: &[R; G],
        wave_generator: Angle<R>,
        reference: Option<R>,
    ) -> GaugeTorque<R> {
        let phase = wave_generator.phase();
        if !state.started {
            state.learnt.iter_mut().for_each(|gauge| gauge.phase = phase);
            state.started = true;
        }
        let regressors = regressors(phase);
        let (mut product, mut rests) = (R::ZERO, [R::ZERO; G]);
        for ((rest, gauge), strain) in rests.iter_mut().zip(&state.learnt).zip(strains) {
            *rest = *strain - ripple(&gauge.coefficients, &regressors);
            product += gauge.per_torque * *rest;
        }
        let torque = (product * state.per_square).limit(self.largest_torque);
        match state.slot {
            Slot::Learn => {
                if let Some(reference) = reference.filter(|torque| torque.is_within(self.largest_reference)) {
                    self.learn(state, &rests, &regressors, phase, reference);
                }
                state.slot = Slot::Project;
            }
            Slot::Project => {
                self.project(state);
                self.fit(state, sum_of_squares(rests.into_iter()) - torque * product);
                state.slot = Slot::Weight;
            }
            Slot::Weight => {
                self.weight(state);
                state.deviation = self.deviation(state, torque);
                state.next = if state.next + 1 < G { state.next + 1 } else { 0 };
                state.slot = Slot::Learn;
            }
        }
        GaugeTorque { torque, standard_deviation: state.deviation }
    }

    /// Takes the sum of squares that least squares leaves into its mean.
    #[inline(always)]
    fn fit(&self, state: &mut TorqueGaugesState<R, G>, left: R) {
        if left.is_finite() {
            let misfit = state.misfit + R::lit(MISFIT_SHARE) * (left - state.misfit);
            state.misfit = misfit.max(self.least_misfit);
        }
    }

    #[inline(always)]
    fn deviation(&self, state: &TorqueGaugesState<R, G>, torque: R) -> R {
        let variance = state.misfit * self.misfit_per_gauge * state.per_square
            + state.left * state.left * self.prior_variance
            + self.misplacement_variance * torque * torque
            + self.reference_variance;
        variance.min(self.largest_torque * self.largest_torque).sqrt_or_zero()
    }

    /// The next gauge learns.
    #[inline(always)]
    fn learn(
        &self,
        state: &mut TorqueGaugesState<R, G>,
        rests: &[R; G],
        regressors: &[R; 4],
        phase: u32,
        reference: R,
    ) {
        let next = state.next;
        let (Some(prior), Some(gauge), Some(rest)) =
            (self.gauges.get(next), state.learnt.get_mut(next), rests.get(next))
        else {
            return;
        };
        let counts = phase.wrapping_sub(gauge.phase).cast_signed();
        gauge.phase = phase;
        let way = (R::from_i32(counts) * R::lit(RADIANS_PER_COUNT)).abs().min(R::lit(LARGEST_WAY * START));
        let residual = *rest - gauge.coefficients[COEFFICIENTS - 1] * reference;
        if !residual.is_within(prior.residual) {
            return;
        }
        state.way += way;
        state.step = way / (state.memory + way);
        gauge.correct(state.step * residual, regressors, reference * self.per_rated * self.per_rated);
    }

    /// The coefficients back into their bands, the memory, the part of the prior's error that is left.
    #[inline(always)]
    fn project(&self, state: &mut TorqueGaugesState<R, G>) {
        if let (Some(prior), Some(gauge)) = (self.gauges.get(state.next), state.learnt.get_mut(state.next)) {
            gauge.project(prior);
        }
        state.way = state.way.min(R::lit(G as f64 * FORGETTING));
        state.memory = (state.way * R::lit(1.0 / G as f64)).max(R::lit(START));
        // A gauge learns as often as every other: one number stands for all of them.
        state.left -= state.step * state.left * R::lit(1.0 / G as f64);
        state.step = R::ZERO;
    }

    /// The gauge's gain, and with it the sum of all.
    #[inline(always)]
    fn weight(&self, state: &mut TorqueGaugesState<R, G>) {
        if let (Some(prior), Some(gauge)) = (self.gauges.get(state.next), state.learnt.get_mut(state.next)) {
            gauge.weight(prior);
        }
        // Each gain is within its band, so the sum is positive.
        state.per_square = R::ONE / sum_of_squares(state.learnt.iter().map(|gauge| gauge.per_torque));
    }
}

impl<R: Real> Learnt<R> {
    /// Corrects the coefficients.
    #[inline(always)]
    fn correct(&mut self, correction: R, regressors: &[R; 4], reference: R) {
        let twice = correction + correction;
        let [cosine, sine, cosine_4, sine_4] = *regressors;
        let changes = [
            correction,
            twice * cosine,
            twice * sine,
            twice * cosine_4,
            twice * sine_4,
            correction * reference,
        ];
        self.coefficients.iter_mut().zip(changes).for_each(|(learnt, change)| *learnt += change);
    }

    /// Each coefficient within its band.
    #[inline(always)]
    fn project(&mut self, prior: &Prior<R>) {
        for ((learnt, expected), band) in
            self.coefficients.iter_mut().zip(&prior.coefficients).zip(&prior.band)
        {
            *learnt = *expected + (*learnt - *expected).limit(*band);
        }
    }

    /// The gain by the coefficients, within its band.
    #[inline(always)]
    fn weight(&mut self, prior: &Prior<R>) {
        let [per_cosine, per_sine] = prior.per_amplitude;
        let gain = self.coefficients[1] * per_cosine + self.coefficients[2] * per_sine;
        let (expected, band) = (prior.coefficients[COEFFICIENTS - 1], prior.band[COEFFICIENTS - 1]);
        self.per_torque = expected + (gain - expected).limit(band);
    }
}

/// Sum of the squares.
#[inline(always)]
fn sum_of_squares<R: Real>(values: impl Iterator<Item = R>) -> R {
    values.fold(R::ZERO, |sum, value| sum + value * value)
}

/// Cosine and sine of two and of four times the wave generator's angle.
#[inline(always)]
fn regressors<R: Real>(phase: u32) -> [R; 4] {
    let (sine, cosine) = R::sin_cos_phase(phase.wrapping_mul(2));
    [cosine, sine, cosine * cosine - sine * sine, R::lit(2.0) * sine * cosine]
}

/// Strain without torque.
#[inline(always)]
fn ripple<R: Real>(coefficients: &[R; COEFFICIENTS], regressors: &[R; 4]) -> R {
    let [constant, amplitudes @ .., _] = coefficients;
    amplitudes.iter().zip(regressors).fold(*constant, |sum, (amplitude, wave)| sum + *amplitude * *wave)
}

#[cfg(test)]
mod tests;
