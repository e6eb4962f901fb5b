//! Piezoelectric (PZT) patch on a face of a link: an actuator that bends it, and a sensor of its bending.
//!
//! ```text
//! stress T = E*(S - d31*field)          displacement D = d31*T + permittivity*field          field = V/thickness
//! couple = coupling*V_e                 coupling = -d31*E*width*(link_thickness + thickness)/2
//! charge = coupling*(w'(end) - w'(start)) + capacitance*V
//! capacitance = (permittivity - d31^2*E)*width*(end - start)/thickness
//! V_e = share*V + P[V]                  P Preisach's operator over +-voltage_limit
//! ```
//!
//! Sign: the patch lies on the upper face; along its polarisation V > 0, and with d31 < 0, as PZT has it, it contracts and bends
//! the tip upwards: couple and w' of [`crate::link`]. One coupling gives couple and charge: the patch is reciprocal. A patch that
//! only measures is held at V = 0 by its charge amplifier.
//!
//! Hysteresis: the strain of the ceramic lags the voltage. Of the standard shape a width, the gap of the major loop at V = 0 over
//! its span, is enough: weights of the sum 2*width*voltage_limit, and share = 1 - 2*width, so that the loop's ends stay
//! where they are without it. Identified weights may have either sign ([`PiezoParams::build_with`]). The charge has none: it is that of
//! the linear law, and its error by the ceramic's hysteresis is not modelled.
//!
//! The amplifier follows the voltage that is asked for within +-voltage_limit, no faster than rate_limit. Left out: mass and
//! stiffness of the patch, which the link's own data have to hold, and the bending within its thickness.
//! Units: V, C, N m, m, Pa; d31 (m/V), permittivity at constant stress (F/m). Discretisation: one step every dt (s), exact.
//!
//! A. Preumont, "Vibration control of active structures", 3rd edition, 2011, chapters 3 and 4.

use crate::error::{Error, require};
use crate::hysteresis::{Staircase, StaircaseState, Weights};
use crate::link::Span;
use crate::real::Real;

/// A patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PiezoParams<R> {
    /// Where it lies on the link; [`crate::link::LinkParams::patch`] is the same.
    pub span: Span<R>,
    /// Across the span (m); 1e-4..=10.
    pub width: R,
    /// Of the ceramic between its electrodes (m); 1e-6..=0.1.
    pub thickness: R,
    /// Of the link below it (m); 1e-6..=10.
    pub link_thickness: R,
    /// E, along the span (Pa); 1e6..=1e12.
    pub youngs_modulus: R,
    /// d31 (m/V); within +-1e-8, not 0. Negative for PZT.
    pub charge_constant: R,
    /// At constant stress (F/m); above d31^2*E, at most 1e-6.
    pub permittivity: R,
    /// Largest voltage either way (V); 1e-3..=1e5.
    pub voltage_limit: R,
    /// Fastest change of the voltage (V/s); 1e-3..=1e12.
    pub rate_limit: R,
    /// Gap of the major loop at 0 V over its span; 0..0.5.
    pub hysteresis: R,
}

/// A patch with `L` levels of hysteresis and a memory of `MEMORY` turning points, stepped by a fixed dt.
///
/// A voltage that comes back leaves some of the couple; the charge tells how the link is bent:
///
/// ```
/// use strainwave::link::Span;
/// use strainwave::piezo::PiezoParams;
///
/// let params = PiezoParams {
///     span: Span { start: 0.01, end: 0.06 }, width: 0.03, thickness: 0.3e-3, link_thickness: 4e-3,
///     youngs_modulus: 62e9, charge_constant: -190e-12, permittivity: 1.6e-8,
///     voltage_limit: 200.0, rate_limit: 1e6, hysteresis: 0.15,
/// };
/// let patch = params.build::<24, 28>(1e-4_f64)?;
/// let mut state = patch.rest();
/// let couples = [150.0, 0.0].map(|voltage| (0..4).map(|_| patch.step(&mut state, voltage).couple).last().unwrap());
/// assert!(couples[0] > 0.1 && couples[1] > 0.01); // N m
/// let charge = patch.charge(0.0, 1e-3); // C at a rotation of 1 mrad
/// assert!((charge - patch.coupling() * 1e-3).abs() < 1e-12);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piezo<R: Real, const L: usize, const MEMORY: usize> {
    coupling: R,
    capacitance: R,
    voltage_limit: R,
    /// Largest change of the voltage within a step.
    step_limit: R,
    share: R,
    hysteresis: Staircase<R, L, MEMORY>,
}

/// Voltage of a patch, and the memory of its hysteresis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PiezoState<R: Real, const MEMORY: usize> {
    voltage: R,
    memory: StaircaseState<R, MEMORY>,
}

/// A patch after a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PiezoOutput<R> {
    /// V at the electrodes, within both limits (V).
    pub voltage: R,
    /// Couple on the link (N m).
    pub couple: R,
}

impl<R: Real> PiezoParams<R> {
    /// Builds the patch with hysteresis of the standard shape, for a time step dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the first parameter that is out of its range; `dt` unless positive.
    pub fn build<const L: usize, const MEMORY: usize>(&self, dt: R) -> Result<Piezo<R, L, MEMORY>, Error> {
        require(self.hysteresis >= R::ZERO && self.hysteresis < R::lit(0.5), "hysteresis")?;
        let lagging = self.hysteresis + self.hysteresis;
        let weights = Weights::uniform(lagging * self.voltage_limit)?;
        self.build_with(&weights, R::ONE - lagging, dt)
    }

    /// The same with identified weights of P (V), of either sign, and the share of V that is without hysteresis, within
    /// +-10; `hysteresis` is not read.
    ///
    /// # Errors
    /// As [`Self::build`]; `share`, `capacity`.
    pub fn build_with<const L: usize, const MEMORY: usize>(
        &self,
        weights: &Weights<R, L>,
        share: R,
        dt: R,
    ) -> Result<Piezo<R, L, MEMORY>, Error> {
        let within = |value: R, least: f64, most: f64| (R::lit(least)..=R::lit(most)).contains(&value);
        let Span { start, end } = self.span;
        require(start >= R::ZERO && end > start && end.is_finite(), "span")?;
        require(within(self.width, 1e-4, 10.0), "width")?;
        require(within(self.thickness, 1e-6, 0.1), "thickness")?;
        require(within(self.link_thickness, 1e-6, 10.0), "link_thickness")?;
        require(within(self.youngs_modulus, 1e6, 1e12), "youngs_modulus")?;
        let (d31, constant) = (self.charge_constant, self.charge_constant * self.youngs_modulus);
        require(within(d31, -1e-8, 1e-8) && d31 != R::ZERO, "charge_constant")?;
        let clamped = self.permittivity - d31 * constant;
        require(clamped.is_positive() && self.permittivity <= R::lit(1e-6), "permittivity")?;
        require(within(self.voltage_limit, 1e-3, 1e5), "voltage_limit")?;
        require(within(self.rate_limit, 1e-3, 1e12), "rate_limit")?;
        require(within(share, -10.0, 10.0), "share")?;
        require(dt.is_positive() && dt <= R::ONE, "dt")?;
        Ok(Piezo {
            coupling: -constant * self.width * R::lit(0.5) * (self.link_thickness + self.thickness),
            capacitance: clamped * self.width * (end - start) / self.thickness,
            voltage_limit: self.voltage_limit,
            step_limit: self.rate_limit * dt,
            share,
            hysteresis: Staircase::build(self.voltage_limit, weights)?,
        })
    }
}

impl<R: Real, const L: usize, const MEMORY: usize> Piezo<R, L, MEMORY> {
    /// Without voltage, never driven before.
    pub fn rest(&self) -> PiezoState<R, MEMORY> {
        PiezoState { voltage: R::ZERO, memory: StaircaseState::default() }
    }

    /// Couple per volt, which is charge per radian (N m/V, C/rad).
    pub fn coupling(&self) -> R {
        self.coupling
    }

    /// Charge per volt of the patch that is held straight (F).
    pub fn capacitance(&self) -> R {
        self.capacitance
    }

    /// Moves the voltage towards the one that is asked for (V), as far as both limits allow; what is not a number leaves it.
    pub fn step(&self, state: &mut PiezoState<R, MEMORY>, asked: R) -> PiezoOutput<R> {
        let is_number = asked.abs() >= R::ZERO;
        let wanted = if is_number { asked.limit(self.voltage_limit) } else { state.voltage };
        // The sum may be rounded beyond the limit.
        let moved = state.voltage + (wanted - state.voltage).limit(self.step_limit);
        state.voltage = moved.limit(self.voltage_limit);
        let lagging = self.hysteresis.step(&mut state.memory, state.voltage).output;
        let effective = self.share * state.voltage + lagging;
        PiezoOutput { voltage: state.voltage, couple: self.coupling * effective }
    }

    /// Charge on the electrodes (C) at a voltage (V) and a rotation of the link between the patch's ends (rad).
    pub fn charge(&self, voltage: R, rotation: R) -> R {
        self.coupling * rotation + self.capacitance * voltage
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    fn params() -> PiezoParams<f64> {
        PiezoParams {
            span: Span { start: 0.01, end: 0.06 },
            width: 0.03,
            thickness: 0.3e-3,
            link_thickness: 4e-3,
            youngs_modulus: 62e9,
            charge_constant: -190e-12,
            permittivity: 1.6e-8,
            voltage_limit: 200.0,
            rate_limit: 1e5,
            hysteresis: 0.15,
        }
    }

    fn patch() -> Piezo<f64, 24, 28> {
        params().build(1e-4).unwrap()
    }

    /// Couples at the turns of a slow voltage.
    fn couples(patch: &Piezo<f64, 24, 28>, turns: &[f64]) -> Vec<f64> {
        let mut state = patch.rest();
        let settled = |turn: &f64| (0..200).map(|_| patch.step(&mut state, *turn).couple).last().unwrap();
        turns.iter().map(settled).collect()
    }

    #[test]
    fn the_major_loop_has_the_stated_width_and_the_ends_of_the_linear_law() {
        let patch = patch();
        let [up, falling, down, rising] = couples(&patch, &[200.0, 0.0, -200.0, 0.0])[..] else { panic!() };
        assert!((up / (200.0 * patch.coupling()) - 1.0).abs() < 1e-12 && (up + down).abs() < 1e-12);
        assert!(((falling - rising) / (up - down) / 0.15 - 1.0).abs() < 1e-2, "{falling} {rising}");
    }

    /// Over a closed loop of the voltage the couple lags: the charge that it displaces takes energy.
    #[test]
    fn a_loop_of_the_voltage_is_never_free() {
        let patch = patch();
        let mut state = patch.rest();
        let mut area = 0.0;
        let mut before = PiezoOutput::default();
        for k in 0..4000 {
            let now = patch.step(&mut state, 150.0 * (f64::from(k) * core::f64::consts::TAU / 1000.0).sin());
            if k >= 1000 {
                area += 0.5 * (now.voltage + before.voltage) * (now.couple - before.couple);
            }
            before = now;
        }
        assert!(area > 0.1 * 150.0 * 150.0 * patch.coupling(), "{area}");
    }

    #[test]
    fn without_hysteresis_it_is_linear_and_reciprocal() {
        let patch = PiezoParams { hysteresis: 0.0, ..params() }.build::<24, 28>(1e-4).unwrap();
        for voltage in [10.0, -70.0, 200.0] {
            let couple = couples(&patch, &[voltage])[0];
            assert!((couple / voltage - patch.charge(0.0, 1.0)).abs() < 1e-12);
        }
        assert!(patch.coupling() > 0.0 && patch.capacitance() > 0.0);
        assert!((patch.charge(10.0, 0.0) / 10.0 - patch.capacitance()).abs() < 1e-20);
    }

    #[test]
    fn the_voltage_keeps_both_limits() {
        let (patch, mut state) = (patch(), patch().rest());
        let voltages: Vec<f64> = (0..30).map(|_| patch.step(&mut state, 1e9).voltage).collect();
        assert!((voltages[0] - 10.0).abs() < 1e-12 && (voltages[18] - 190.0).abs() < 1e-9);
        assert_eq!(voltages[29], 200.0);
        let held = patch.step(&mut state, f64::NAN);
        assert_eq!((held.voltage, patch.step(&mut state, -1e9).voltage), (200.0, 190.0));
    }

    /// Weights of either sign: a loop that turns the other way where they are negative.
    #[test]
    fn identified_weights_may_be_negative() {
        let weights = Weights::<f64, 24>::signed_from_fn(|i, j| if i - j < 8 { 0.2 } else { -0.1 }).unwrap();
        let patch: Piezo<f64, 24, 28> = params().build_with(&weights, 0.9, 1e-4).unwrap();
        let [up, falling, down, rising] = couples(&patch, &[200.0, 0.0, -200.0, 0.0])[..] else { panic!() };
        assert!(falling < rising && (up + down).abs() < 1e-12);
        assert!((up / patch.coupling() - (0.9 * 200.0 + weights.total())).abs() < 1e-9);
    }

    proptest! {
        #[test]
        fn any_input_bits_give_a_bounded_couple(bits in prop::collection::vec(any::<u32>(), 1..200)) {
            let params = PiezoParams::<f32> {
                span: Span { start: 0.01, end: 0.06 }, width: 0.03, thickness: 0.3e-3, link_thickness: 4e-3,
                youngs_modulus: 62e9, charge_constant: -190e-12, permittivity: 1.6e-8,
                voltage_limit: 200.0, rate_limit: 1e9, hysteresis: 0.15,
            };
            let patch = params.build::<24, 28>(1e-4).unwrap();
            let mut state = patch.rest();
            for bits in bits {
                let output = patch.step(&mut state, f32::from_bits(bits));
                prop_assert!(output.voltage.abs() <= 200.0 && output.couple.abs() <= 201.0 * patch.coupling());
            }
        }
    }

    #[test]
    fn a_parameter_out_of_range_is_named() {
        type Change = fn(&mut PiezoParams<f64>);
        let cases: [(&str, Change); 10] = [
            ("span", |p| p.span.end = 0.01),
            ("width", |p| p.width = 0.0),
            ("thickness", |p| p.thickness = 1.0),
            ("link_thickness", |p| p.link_thickness = f64::NAN),
            ("youngs_modulus", |p| p.youngs_modulus = 62.0),
            ("charge_constant", |p| p.charge_constant = 0.0),
            ("permittivity", |p| p.permittivity = 2e-9),
            ("voltage_limit", |p| p.voltage_limit = 0.0),
            ("rate_limit", |p| p.rate_limit = -1.0),
            ("hysteresis", |p| p.hysteresis = 0.5),
        ];
        for (name, change) in cases {
            let mut changed = params();
            change(&mut changed);
            // The limit of the voltage scales the weights.
            let found = changed.build::<24, 28>(1e-4).err();
            assert_eq!(found, Some(Error::OutOfRange(name)));
        }
        assert_eq!(params().build::<24, 28>(0.0).err(), Some(Error::OutOfRange("dt")));
    }
}
