//! Deflection of the tip at rest: F*L^3/(3*EI), and mu*g*L^4/(8*EI) + M*g*L^3/(3*EI) under the weight, of two modes that have swung out.

use strainwave::gear::Motion;
use strainwave::link::{LinkInput, LinkParams, LinkState};

use super::motion::{DT, link_params};
use crate::io::figure::Figure;
use crate::verify::bounds;

/// Force on the tip (N).
const FORCE: f64 = 5.0;
/// Steps in which the motion falls below rounding.
const STEPS: u32 = 100_000;
/// Damping ratio of both modes.
const DAMPING: f64 = 0.5;

pub(super) fn measure() -> Vec<Figure> {
    let params = link_params::<f64>();
    let (length, flexibility) = (params.length, 1.0 / params.bending_stiffness);
    let tip = length.powi(3) / 3.0 * flexibility;
    let beam = params.linear_density * length.powi(4) / 8.0 * flexibility;
    let weight = -params.gravity * (beam + params.payload_mass * tip);
    let pulled = settled(FORCE, 0.0) / (FORCE * tip) - 1.0;
    let hanging = settled(0.0, params.gravity) / weight - 1.0;
    vec![
        bounds::figure("link.deflection.force", pulled.abs()),
        bounds::figure("link.deflection.weight", hanging.abs()),
    ]
}

/// Deflection (m) where the link, straight at first, comes to rest under a force (N) and the acceleration of gravity (m/s^2).
fn settled(tip_force: f64, gravity: f64) -> f64 {
    let params = LinkParams { gravity, damping: [DAMPING; 2], ..link_params() };
    let link = params.build(DT).expect("the parameters are in range");
    let input = LinkInput { joint: Motion::default(), tip_force, ..LinkInput::default() };
    let mut state = LinkState::default();
    (0..STEPS).map(|_| link.step(&mut state, &input).deflection).last().unwrap_or(f64::NAN)
}
