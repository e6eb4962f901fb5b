//! Active damping of an arm link by a PZT patch: one patch bends it, an equal one on the other face measures by its charge.
//!
//! Strain-rate feedback: the voltage opposes the current of the sensor, the rate of its charge. Actuator and sensor lie at the same
//! place and have one coupling, so that the feedback takes energy out of every mode. Hysteresis of the driven ceramic and the limits of its
//! amplifier are in.

use std::f64::consts::TAU;

use strainwave::Error;
use strainwave::link::{Link, LinkInput, LinkParams, Span};
use strainwave::piezo::{Piezo, PiezoParams};

const DT: f64 = 1e-4; // s
const FORCE: f64 = 1.0; // N, lets go of the tip at the start
const GAIN: f64 = 3e7; // V/A
const PATCH: Span<f64> = Span { start: 0.01, end: 0.06 };

/// An aluminium strip of 500 x 40 x 4 mm with a payload of 150 g, turning about a vertical axis.
fn link() -> Result<Link<f64, 2>, Error> {
    let params = LinkParams {
        length: 0.5,
        bending_stiffness: 14.9,
        linear_density: 0.432,
        thickness: 4e-3,
        payload_mass: 0.15,
        payload_inertia: 3e-5,
        damping: [0.004, 0.005],
        gravity: 0.0,
        patch: Some(PATCH),
    };
    params.build(DT)
}

/// Soft PZT of 50 x 35 x 0.3 mm.
fn patch() -> Result<Piezo<f64, 24, 28>, Error> {
    let params = PiezoParams {
        span: PATCH,
        width: 0.035,
        thickness: 0.3e-3,
        link_thickness: 4e-3,
        youngs_modulus: 62e9,
        charge_constant: -190e-12,
        permittivity: 1.6e-8,
        voltage_limit: 200.0,
        rate_limit: 1e6,
        hysteresis: 0.15,
    };
    params.build(DT)
}

/// Deflection of the tip after the force has gone, and the largest voltage.
fn swing(link: &Link<f64, 2>, patch: &Piezo<f64, 24, 28>, gain: f64) -> (Vec<f64>, f64) {
    let held = LinkInput::default();
    let pulled = LinkInput { tip_force: FORCE, ..held };
    let (mut state, mut driven) = (link.settled(&pulled), patch.rest());
    let mut charge = patch.charge(0.0, link.peek(&state, &pulled).rotation);
    let (mut voltage, mut most) = (0.0, 0.0_f64);
    let deflections = (0..20_000).map(|_| {
        let actuated = patch.step(&mut driven, voltage);
        most = most.max(actuated.voltage.abs());
        let output = link.step(&mut state, &LinkInput { couple: actuated.couple, ..held });
        // The sensor's amplifier holds it at 0 V.
        let now = patch.charge(0.0, output.rotation);
        let current = (now - charge) / DT;
        charge = now;
        voltage = -gain * current;
        output.deflection
    });
    let deflections: Vec<_> = deflections.collect();
    (deflections, most)
}

/// Frequency (Hz) and damping ratio of the first mode: zero crossings, and the line through the logarithms of the peaks.
fn decay(deflections: &[f64]) -> (f64, f64) {
    let late = &deflections[500..]; // the second mode has died away
    let peaks: Vec<(f64, f64)> = (1..late.len() - 1)
        .filter(|k| late[*k] > late[k - 1] && late[*k] >= late[k + 1] && late[*k] > 1e-6)
        .map(|k| (k as f64 * DT, late[k].ln()))
        .collect();
    let count = peaks.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| peaks.iter().map(of).sum::<f64>() / count;
    let (time, height) = (mean(|peak| peak.0), mean(|peak| peak.1));
    let rise: f64 = peaks.iter().map(|peak| (peak.0 - time) * (peak.1 - height)).sum();
    let spread: f64 = peaks.iter().map(|peak| (peak.0 - time).powi(2)).sum();
    let frequency = (count - 1.0) / (peaks[peaks.len() - 1].0 - peaks[0].0);
    (frequency, -rise / spread / (TAU * frequency))
}

fn main() -> Result<(), Error> {
    let (link, patch) = (link()?, patch()?);
    println!("first modes [Hz]: {:.2?}", link.frequencies().map(|omega| omega / TAU));
    println!(
        "                     frequency [Hz]   damping ratio   largest voltage [V]   tip after 1 s [um]"
    );
    let mut ratios = Vec::new();
    for (name, gain) in [("without feedback", 0.0), ("strain-rate feedback", GAIN)] {
        let (deflections, voltage) = swing(&link, &patch, gain);
        let (frequency, ratio) = decay(&deflections);
        let left = deflections[9000..11_000].iter().fold(0.0_f64, |most, w| most.max(w.abs()));
        println!("{name:20} {frequency:14.3} {ratio:15.5} {voltage:21.1} {:20.1}", left * 1e6);
        ratios.push(ratio);
    }
    println!("The patch multiplies the damping of the first mode by {:.1}.", ratios[1] / ratios[0]);
    Ok(())
}
