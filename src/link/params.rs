//! Parameters of a link, and what is computed from them once.

use core::f64::consts::FRAC_PI_2;

use super::eigenvalue::Payload;
use super::mode_shape::Shape;
use super::oscillator::Oscillator;
use super::{Beam, Gauge, LOADS, Link, Reading, static_shape};
use crate::error::{Error, require};
use crate::real::Real;

/// Most modes of a link.
pub const MOST_MODES: usize = 8;
/// Largest payload, in multiples of the beam's mass, and of mu*L^3.
const LARGEST_PAYLOAD: f64 = 1000.0;

/// A part of a link, by the places where it starts and ends (m from the joint).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Span<R> {
    /// At least 0.
    pub start: R,
    /// Above `start`, at most the link's length.
    pub end: R,
}

/// A uniform beam with a payload at its tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkParams<R, const K: usize = 2> {
    /// L (m); 1e-3..=100.
    pub length: R,
    /// EI, in the plane of the joint's motion (N m^2); 1e-6..=1e12.
    pub bending_stiffness: R,
    /// mu, mass per length (kg/m); 1e-6..=1e5.
    pub linear_density: R,
    /// Across the link in the plane of motion, from face to face (m); above 0, at most `length`.
    pub thickness: R,
    /// M, at the tip (kg); 0..=1000 mu*L.
    pub payload_mass: R,
    /// J, about the tip (kg m^2); 0..=1000 mu*L^3.
    pub payload_inertia: R,
    /// zeta of each mode; 0..1.
    pub damping: [R; K],
    /// g in the plane of motion (m/s^2); 0..=100, 0 for a vertical joint axis.
    pub gravity: R,
    /// Part of the link over which a patch bends it.
    pub patch: Option<Span<R>>,
}

impl Beam {
    fn payload(&self) -> Payload {
        let beam = self.density * self.length;
        Payload { mass: self.mass / beam, inertia: self.inertia / (beam * self.length * self.length) }
    }

    /// omega over lambda^2 (rad/s).
    fn rate(&self) -> f64 {
        let cube = self.length * self.length * self.length;
        Real::sqrt(self.stiffness / (self.density * cube * self.length))
    }

    fn root_mass(&self) -> f64 {
        Real::sqrt(self.density * self.length)
    }

    /// Deflection, slope and curvature of a mode of unit mass at x (m).
    fn mode_at(&self, shape: &Shape, x: f64) -> [f64; 3] {
        let [deflection, slope, curvature, _] = shape.at(x / self.length);
        let scale = 1.0 / self.root_mass();
        [scale * deflection, scale * slope / self.length, scale * curvature / (self.length * self.length)]
    }

    /// -c, phi(L), -s, p of a mode.
    fn coupling(&self, shape: &Shape) -> [f64; LOADS] {
        let fourth = shape.lambda * shape.lambda * shape.lambda * shape.lambda;
        let root_mass = self.root_mass();
        let slope = |x| self.mode_at(shape, x)[1];
        [
            -self.length * root_mass * shape.clamp_curvature() / fourth,
            self.mode_at(shape, self.length)[0],
            -root_mass * shape.clamp_shear() / fourth,
            self.patch.map_or(0.0, |[start, end]| slope(end) - slope(start)),
        ]
    }
}

/// Shapes and frequencies, in f64.
struct Modes<const K: usize> {
    beam: Beam,
    shapes: [Shape; K],
}

impl<const K: usize> Modes<K> {
    fn of(beam: Beam) -> Self {
        let payload = beam.payload();
        Self { beam, shapes: core::array::from_fn(|mode| Shape::of(mode, payload)) }
    }

    fn omega(&self, shape: &Shape) -> f64 {
        self.beam.rate() * shape.lambda * shape.lambda
    }

    /// Sum of derivatives of w at places (m), each with its order and factor.
    fn reading<R: Real>(&self, terms: &[(f64, usize, f64)]) -> Reading<R, K> {
        let (mut modes, mut loads) = ([R::ZERO; K], [0.0; LOADS]);
        for &(x, order, factor) in terms {
            let at_rest = static_shape::at(&self.beam, x)[order];
            loads.iter_mut().zip(at_rest).for_each(|(load, at_rest)| *load += factor * at_rest);
        }
        for (place, shape) in modes.iter_mut().zip(&self.shapes) {
            let of_mode =
                terms.iter().map(|&(x, order, factor)| factor * self.beam.mode_at(shape, x)[order]).sum();
            *place = R::lit(of_mode);
            let omega = self.omega(shape);
            let coupling = self.beam.coupling(shape);
            loads
                .iter_mut()
                .zip(coupling)
                .for_each(|(load, of_load)| *load -= of_mode * of_load / (omega * omega));
        }
        Reading { modes, loads: loads.map(R::lit) }
    }
}

impl<R: Real, const K: usize> LinkParams<R, K> {
    /// Longest dt that a link of these parameters may be stepped with (s): a quarter of the highest mode's period.
    ///
    /// # Errors
    /// As [`Self::build`], but for `dt`.
    pub fn longest_step(&self) -> Result<R, Error> {
        let modes = self.modes()?;
        Ok(R::lit(FRAC_PI_2 / modes.shapes.last().map_or(f64::NAN, |shape| modes.omega(shape))))
    }

    /// Builds the link with a time step dt (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the name of the first parameter that is out of its range; `modes` unless `K` is
    /// 1..=[`MOST_MODES`]; `patch` unless its places are in order on the link; `dt` unless positive and below [`Self::longest_step`].
    pub fn build(&self, dt: R) -> Result<Link<R, K>, Error> {
        require(dt.is_positive() && dt < self.longest_step()?, "dt")?;
        let modes = self.modes()?;
        let Beam { length, density, mass, inertia, patch, .. } = modes.beam;
        let oscillator = |k: usize| {
            Oscillator::build(modes.omega(&modes.shapes[k]), self.damping[k].to_f64(), dt.to_f64())
        };
        let rotation = patch.map_or([(0.0, 1, 0.0); 2], |[start, end]| [(end, 1, 1.0), (start, 1, -1.0)]);
        Ok(Link {
            modes: core::array::from_fn(oscillator),
            coupling: modes.shapes.map(|shape| modes.beam.coupling(&shape).map(R::lit)),
            deflection: modes.reading(&[(length, 0, 1.0)]),
            rotation: modes.reading(&rotation),
            length: self.length,
            gravity: self.gravity,
            inertia: R::lit(length * length * (density * length / 3.0 + mass) + inertia),
            moment: R::lit(length * (0.5 * density * length + mass)),
        })
    }

    /// A strain gauge at a place (m from the joint) on the upper face.
    ///
    /// # Errors
    /// As [`Self::build`], but for `dt`; `place` unless on the link.
    pub fn gauge(&self, place: R) -> Result<Gauge<R, K>, Error> {
        let modes = self.modes()?;
        require((R::ZERO..=self.length).contains(&place), "place")?;
        Ok(Gauge(modes.reading(&[(place.to_f64(), 2, -0.5 * modes.beam.thickness)])))
    }

    /// Deflection (kg^-1/2), slope and curvature of each mode of unit mass at a place (m from the joint).
    ///
    /// # Errors
    /// As [`Self::gauge`].
    pub fn mode_shapes(&self, place: R) -> Result<[[R; 3]; K], Error> {
        let modes = self.modes()?;
        require((R::ZERO..=self.length).contains(&place), "place")?;
        Ok(modes.shapes.map(|shape| modes.beam.mode_at(&shape, place.to_f64()).map(R::lit)))
    }

    fn modes(&self) -> Result<Modes<K>, Error> {
        require((1..=MOST_MODES).contains(&K), "modes")?;
        let within = |value: R, least: f64, most: f64| (R::lit(least)..=R::lit(most)).contains(&value);
        require(within(self.length, 1e-3, 100.0), "length")?;
        require(within(self.bending_stiffness, 1e-6, 1e12), "bending_stiffness")?;
        require(within(self.linear_density, 1e-6, 1e5), "linear_density")?;
        require(self.thickness.is_positive() && self.thickness <= self.length, "thickness")?;
        let beam = self.beam();
        let Payload { mass, inertia } = beam.payload();
        require((0.0..=LARGEST_PAYLOAD).contains(&mass), "payload_mass")?;
        require((0.0..=LARGEST_PAYLOAD).contains(&inertia), "payload_inertia")?;
        require(self.damping.iter().all(|zeta| (R::ZERO..R::ONE).contains(zeta)), "damping")?;
        require(within(self.gravity, 0.0, 100.0), "gravity")?;
        let in_order =
            |span: Span<R>| span.start >= R::ZERO && span.end > span.start && span.end <= self.length;
        require(self.patch.is_none_or(in_order), "patch")?;
        Ok(Modes::of(beam))
    }

    fn beam(&self) -> Beam {
        Beam {
            length: self.length.to_f64(),
            stiffness: self.bending_stiffness.to_f64(),
            density: self.linear_density.to_f64(),
            thickness: self.thickness.to_f64(),
            mass: self.payload_mass.to_f64(),
            inertia: self.payload_inertia.to_f64(),
            patch: self.patch.map(|Span { start, end }| [start.to_f64(), end.to_f64()]),
        }
    }
}
