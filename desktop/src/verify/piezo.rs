//! The PZT patch: couple and charge against the constitutive law integrated over the patch, what it does to the link, and the width
//! of its loop.
//!
//! ```text
//! T1 = E*(S1 - d31*E3)        D3 = d31*T1 + permittivity*E3        E3 = V/thickness
//! ```

use strainwave::link::{Link, LinkInput, LinkParams, LinkState, Span};
use strainwave::piezo::{Piezo, PiezoParams};

use super::Measured;
use crate::verify::link::motion::link_params;
use crate::verify::{bounds, largest};

const DT: f64 = 1e-4;
/// Gauss's points and weights of fifth degree on -1..1.
const GAUSS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];
/// Steps along each quarter of a loop.
const SIDE: i32 = 2000;

pub(super) fn measure() -> Measured {
    let figures = vec![
        bounds::figure("piezo.couple", couple_error()),
        bounds::figure("piezo.charge", charge_error()),
        bounds::figure("piezo.deflection", deflection_error()),
        bounds::figure("piezo.loop_width", width_error()),
    ];
    Measured::from(figures)
}

fn piezo_params() -> PiezoParams<f64> {
    PiezoParams {
        span: Span { start: 0.02, end: 0.08 },
        width: 0.035,
        thickness: 0.3e-3,
        link_thickness: link_params::<f64>().thickness,
        youngs_modulus: 62e9,
        charge_constant: -190e-12,
        permittivity: 1.6e-8,
        voltage_limit: 200.0,
        rate_limit: 1e6,
        hysteresis: 0.15,
    }
}

fn patch(hysteresis: f64) -> Piezo<f64, 24, 28> {
    PiezoParams { hysteresis, ..piezo_params() }.build(DT).expect("the parameters are in range")
}

/// The link with the patch, without weight.
fn link_with_patch() -> LinkParams<f64> {
    LinkParams { damping: [0.5; 2], gravity: 0.0, patch: Some(piezo_params().span), ..link_params() }
}

fn link() -> Link<f64, 2> {
    link_with_patch().build(DT).expect("the parameters are in range")
}

/// Integral over an interval.
fn integral(from: f64, to: f64, value: impl Fn(f64) -> f64) -> f64 {
    let (middle, half) = (f64::midpoint(from, to), 0.5 * (to - from));
    half * GAUSS.iter().map(|(place, weight)| weight * value(middle + half * place)).sum::<f64>()
}

/// The couple of a patch that is held straight is the moment of its stress about the link's middle.
fn couple_error() -> f64 {
    let params = piezo_params();
    let voltage = 80.0;
    let stress = -params.youngs_modulus * params.charge_constant * voltage / params.thickness;
    let face = 0.5 * params.link_thickness;
    // A tension on the upper face bends downwards.
    let moment = -params.width * integral(face, face + params.thickness, |z| -z * stress);
    let (patch, mut state) = (patch(0.0), patch(0.0).rest());
    (patch.step(&mut state, voltage).couple / moment - 1.0).abs()
}

/// The charge of a patch at a voltage on a bent link is the displacement through its electrodes.
fn charge_error() -> f64 {
    let params = piezo_params();
    let (link, patch, beam) = (link(), patch(0.0), link_with_patch());
    let (voltage, pull) = (-30.0, LinkInput { tip_force: 5.0, ..LinkInput::default() });
    let state = link.settled(&pull);
    let field = voltage / params.thickness;
    let lever = (params.link_thickness + params.thickness) / params.link_thickness;
    let displacement = |place: f64| {
        // The gauge lies on the face, the middle of the ceramic further out.
        let gauge = beam.gauge(place).expect("the patch is on the link");
        let stress =
            params.youngs_modulus * (lever * link.strain(&state, &gauge) - params.charge_constant * field);
        params.charge_constant * stress + params.permittivity * field
    };
    let expected = params.width * integral(params.span.start, params.span.end, displacement);
    let rotation = link.peek(&state, &pull).rotation;
    (patch.charge(voltage, rotation) / expected - 1.0).abs()
}

/// Deflection of the tip by a steady voltage against couple*(end - start)*(L - middle)/EI.
fn deflection_error() -> f64 {
    let (link, patch, Span { start, end }) = (link(), patch(0.0), piezo_params().span);
    let (mut state, mut driven) = (LinkState::default(), patch.rest());
    let mut deflection = f64::NAN;
    for _ in 0..100_000 {
        let couple = patch.step(&mut driven, 120.0).couple;
        deflection = link.step(&mut state, &LinkInput { couple, ..LinkInput::default() }).deflection;
    }
    let beam = link_params::<f64>();
    let arm = (end - start) * (beam.length - f64::midpoint(start, end)) / beam.bending_stiffness;
    (deflection / (patch.coupling() * 120.0 * arm) - 1.0).abs()
}

/// Width of the major loop of the couple over its span against stated*(1 - (V/limit)^2), the largest difference over the stated one.
fn width_error() -> f64 {
    let PiezoParams { hysteresis: stated, voltage_limit: limit, .. } = piezo_params();
    let (patch, mut state) = (patch(stated), patch(stated).rest());
    let mut sweep = |from: i32, to: i32| -> Vec<f64> {
        let fraction = |k: i32| f64::from(from + (to - from) * k / SIDE) / f64::from(SIDE);
        (0..=SIDE).map(|k| patch.step(&mut state, limit * fraction(k)).couple).collect()
    };
    sweep(0, SIDE);
    let falling = [sweep(SIDE, 0), sweep(0, -SIDE)].concat();
    let rising = [sweep(-SIDE, 0), sweep(0, SIDE)].concat();
    let span = falling[0] - rising[0];
    let errors = falling.iter().zip(rising.iter().rev()).zip(0..).map(|((falling, rising), k)| {
        // Each half ends where the next begins.
        let place = f64::from(SIDE - k + i32::from(k > SIDE)) / f64::from(SIDE);
        (falling - rising) / span / stated - (1.0 - place * place)
    });
    largest(errors)
}
