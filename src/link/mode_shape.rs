//! Mode shape of the clamped beam with a payload, by place along it.
//!
//! ```text
//! phi(xi) = cosh(lambda*xi) - cos(lambda*xi) - sigma*(sinh(lambda*xi) - sin(lambda*xi)),    xi = x/L
//! sigma = ((S - s) + m*lambda*(C - c))/((C + c) + m*lambda*(S - s))
//! integral of phi^2 + m*phi(1)^2 + j*phi'(1)^2 = 1           after scaling
//! ```
//!
//! The hyperbolic functions of a high mode are large and nearly cancel: written as
//! `e^(-lambda*xi) + (1 - sigma)*sinh(lambda*xi)`, with 1 - sigma from a formula of its own, no digit is lost. The
//! integral has the closed form that [`Shape::squared`] holds. Without unit; xi and the derivatives count in lengths of the beam.
//!
//! R. Blevins, "Formulas for natural frequency and mode shape", 1979, chapter 8.

use super::eigenvalue::{Payload, eigenvalue};
use crate::elementary::double;
use crate::real::Real;

/// A scaled mode shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    pub lambda: f64,
    pub sigma: f64,
    /// (1 - sigma)*sinh(lambda*xi) is this times e^(-lambda*(1 - xi)) - e^(-lambda*(1 + xi)).
    growing: f64,
    scale: f64,
}

impl Shape {
    /// That of a mode, counted from 0.
    pub fn of(mode: usize, payload: Payload) -> Self {
        let lambda = eigenvalue(mode, payload);
        let e = double::exp(-lambda);
        let (s, c) = double::sin_cos(lambda);
        let ml = payload.mass * lambda;
        let (cosh, sinh) = (0.5 * (1.0 + e * e), 0.5 * (1.0 - e * e));
        let denominator = (cosh + e * c) + ml * (sinh - e * s);
        let sigma = ((sinh - e * s) + ml * (cosh - e * c)) / denominator;
        let growing = 0.5 * ((e + c + s) + ml * (c - e - s)) / denominator;
        let shape = Self { lambda, sigma, growing, scale: 1.0 };
        let [tip, slope, ..] = shape.at(1.0);
        let norm = shape.squared() + payload.mass * tip * tip + payload.inertia * slope * slope;
        Self { scale: 1.0 / Real::sqrt(norm), ..shape }
    }

    /// phi and its first three derivatives.
    pub fn at(&self, xi: f64) -> [f64; 4] {
        let Self { lambda, sigma, growing, scale } = *self;
        let falls = double::exp(-lambda * xi);
        let (near, far) =
            (growing * double::exp(-lambda * (1.0 - xi)), growing * double::exp(-lambda * (1.0 + xi)));
        let (sin, cos) = double::sin_cos(lambda * xi);
        let first = scale * lambda;
        let second = first * lambda;
        [
            scale * (falls + (near - far) - cos + sigma * sin),
            first * (-falls + (near + far) + sin + sigma * cos),
            second * (falls + (near - far) + cos - sigma * sin),
            second * lambda * (-falls + (near + far) - sin - sigma * cos),
        ]
    }

    /// Second derivative at the clamp, 2*lambda^2 before scaling.
    pub fn clamp_curvature(&self) -> f64 {
        2.0 * self.scale * self.lambda * self.lambda
    }

    /// Minus the third derivative at the clamp, 2*sigma*lambda^3 before scaling.
    pub fn clamp_shear(&self) -> f64 {
        self.clamp_curvature() * self.sigma * self.lambda
    }

    /// Integral of phi^2 over the beam: with phi = phi' = 0 at the clamp and phi'''' = lambda^4*phi it is a form of the tip.
    fn squared(&self) -> f64 {
        let [shape, first, second, third] = self.at(1.0);
        let fourth = self.lambda * self.lambda * self.lambda * self.lambda;
        let form = 3.0 * shape * third - first * second + fourth * shape * shape - 2.0 * first * third
            + second * second;
        0.25 * form / fourth
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAYLOADS: [Payload; 4] = [
        Payload { mass: 0.0, inertia: 0.0 },
        Payload { mass: 0.3, inertia: 0.02 },
        Payload { mass: 5.0, inertia: 0.4 },
        Payload { mass: 100.0, inertia: 30.0 },
    ];

    /// Simpson's rule with the payload's share.
    fn product(a: &Shape, b: &Shape, payload: Payload) -> f64 {
        let steps = 2000;
        let weight = |k: i32| if k == 0 || k == steps { 1.0 } else { 2.0 + 2.0 * f64::from(k % 2) };
        let value = |k: i32| {
            let xi = f64::from(k) / f64::from(steps);
            weight(k) * a.at(xi)[0] * b.at(xi)[0]
        };
        let integral = (0..=steps).map(value).sum::<f64>() / (3.0 * f64::from(steps));
        let ([a, da, ..], [b, db, ..]) = (a.at(1.0), b.at(1.0));
        integral + payload.mass * a * b + payload.inertia * da * db
    }

    #[test]
    fn modes_are_orthogonal_and_of_unit_mass() {
        for payload in PAYLOADS {
            let shapes: [Shape; 6] = core::array::from_fn(|mode| Shape::of(mode, payload));
            for (i, j) in (0..6).flat_map(|i| (0..6).map(move |j| (i, j))) {
                let expected = f64::from(u8::from(i == j));
                let found = product(&shapes[i], &shapes[j], payload);
                assert!((found - expected).abs() < 1e-9, "{payload:?} {i} {j}: {found}");
            }
        }
    }

    /// Clamped at 0; at the tip shear and moment are those of the payload's inertia.
    #[test]
    fn both_ends_have_their_boundary_conditions() {
        for payload in PAYLOADS {
            for mode in 0..6 {
                let shape = Shape::of(mode, payload);
                let ([start, slope, curvature, shear], [tip, rotation, moment, force]) =
                    (shape.at(0.0), shape.at(1.0));
                let fourth = shape.lambda.powi(4);
                assert!(start.abs() < 1e-13 && slope.abs() < 1e-12, "{mode} {start:e} {slope:e}");
                assert!((curvature / shape.clamp_curvature() - 1.0).abs() < 1e-13);
                assert!((shear / -shape.clamp_shear() - 1.0).abs() < 1e-13);
                let size = shape.lambda.powi(3) * shape.clamp_curvature();
                assert!(
                    (moment - payload.inertia * fourth * rotation).abs() < 1e-11 * size,
                    "{payload:?} {mode}"
                );
                assert!((force + payload.mass * fourth * tip).abs() < 1e-11 * size, "{payload:?} {mode}");
            }
        }
    }
}
