//! Centre distance, spans and wraps of two pulleys from the teeth of pulleys and belt.
//!
//! ```text
//! B = 2*L + (pi + 2*gamma)*R + (pi - 2*gamma)*r,   L = sqrt(C^2 - (R - r)^2),   sin(gamma) = (R - r)/C
//! ```
//!
//! B = z_b*p is the length of the belt at its pitch line, R and r the radii of the larger and of the smaller pulley there, C the
//! centre distance, L the free length of a span; the belt lies on pi + 2*gamma of the larger pulley and on pi - 2*gamma of the smaller.
//! Units: m, rad. B grows with C; C is found by bisection between touching pulleys, R + r, and B. The pretension's stretch, 1e-3 of B,
//! is left out.

use std::f64::consts::{PI, TAU};

/// Bisections of the centre distance: to rounding.
const BISECTIONS: u32 = 80;

/// Where the belt lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// C (m).
    pub centre_distance: f64,
    /// L, free length of either span (m).
    pub span_length: f64,
    /// Angles over which it lies on the motor's and on the output's pulley (rad).
    pub wrap: [f64; 2],
}

impl Geometry {
    /// Of pulleys of `teeth`, the motor's first; `None` when a belt of `belt_teeth` is too short to go around pulleys that touch.
    pub fn new(pitch: f64, teeth: [u32; 2], belt_teeth: u32) -> Option<Self> {
        let radii = teeth.map(|teeth| f64::from(teeth) * pitch / TAU);
        let length = f64::from(belt_teeth) * pitch;
        let (mut near, mut far) = (radii[0] + radii[1], length);
        if Self::at(near, radii).length(radii) > length {
            return None;
        }
        for _ in 0..BISECTIONS {
            let middle = f64::midpoint(near, far);
            if Self::at(middle, radii).length(radii) > length { far = middle } else { near = middle }
        }
        Some(Self::at(near, radii))
    }

    /// Fewest teeth of a belt that goes around pulleys of `teeth`.
    pub fn fewest_teeth(pitch: f64, teeth: [u32; 2]) -> u32 {
        let radii = teeth.map(|teeth| f64::from(teeth) * pitch / TAU);
        (Self::at(radii[0] + radii[1], radii).length(radii) / pitch).ceil() as u32
    }

    /// Pulleys of these radii at a centre distance.
    fn at(centre_distance: f64, radii: [f64; 2]) -> Self {
        let step = radii[1] - radii[0];
        let lean = 2.0 * (step / centre_distance).asin();
        let span_length = ((centre_distance - step) * (centre_distance + step)).sqrt();
        Self { centre_distance, span_length, wrap: [PI - lean, PI + lean] }
    }

    /// B (m).
    fn length(&self, radii: [f64; 2]) -> f64 {
        2.0 * self.span_length + self.wrap[0] * radii[0] + self.wrap[1] * radii[1]
    }

    /// Teeth of a pulley that are in mesh, of `teeth` on the `pulley` 0, the motor's, or 1.
    pub fn teeth_in_mesh(&self, teeth: u32, pulley: usize) -> f64 {
        f64::from(teeth) * self.wrap[pulley] / TAU
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn equal_pulleys_lie_half_in_the_belt() {
        let geometry = Geometry::new(0.005, [20, 20], 120).unwrap();
        assert!(
            (geometry.span_length - 0.25).abs() < 1e-12 && (geometry.centre_distance - 0.25).abs() < 1e-12
        );
        assert_eq!(geometry.wrap, [PI, PI]);
        assert!((geometry.teeth_in_mesh(20, 0) - 10.0).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn the_belt_is_as_long_as_it_lies(teeth in (8u32..200, 8u32..200), spare in 0u32..500) {
            let teeth = [teeth.0, teeth.1];
            let belt = Geometry::fewest_teeth(0.005, teeth) + spare;
            let geometry = Geometry::new(0.005, teeth, belt).unwrap();
            let radii = teeth.map(|teeth| f64::from(teeth) * 0.005 / TAU);
            prop_assert!((geometry.length(radii) / (f64::from(belt) * 0.005) - 1.0).abs() < 1e-12);
            prop_assert!((geometry.wrap[0] + geometry.wrap[1] - TAU).abs() < 1e-12);
            prop_assert!(Geometry::new(0.005, teeth, belt - spare - 1).is_none());
        }
    }
}
