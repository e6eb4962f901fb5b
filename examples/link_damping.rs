//! Active damping of an arm link by a PZT patch: one patch bends it, an equal one on the other face measures by its charge.
//!
//! Positive position feedback (J. Fanson, T. Caughey, AIAA Journal 28, 1990): a filter of second order at the first mode's frequency
//! takes the sensor's charge, and its output is the voltage. At that frequency the filter lags by a quarter of a period, so that the
//! couple opposes the speed; above it falls off, and the other modes stay as they are. Hysteresis of the driven ceramic and the
//! limits of its amplifier are in.
//!
//! ```text
//! d2eta + 2*zeta_f*omega_f*deta + omega_f^2*eta = omega_f^2*charge          voltage = gain*eta
//! ```

use std::f64::consts::TAU;

use strainwave::Error;
use strainwave::link::{Link, LinkInput, LinkParams, Span};
use strainwave::piezo::{Piezo, PiezoParams};

const DT: f64 = 1e-4; // s
const FORCE: f64 = 1.0; // N, lets go of the tip at the start
const GAIN: f64 = 6e7; // V/C; the link would be bent away at 3.8e8
const FILTER_DAMPING: f64 = 0.2;
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

/// The filter's output and its rate.
#[derive(Clone, Copy, Default)]
struct Filter {
    eta: f64,
    rate: f64,
}

impl Filter {
    fn step(&mut self, omega: f64, charge: f64) -> f64 {
        let acceleration = omega * omega * (charge - self.eta) - 2.0 * FILTER_DAMPING * omega * self.rate;
        self.rate += DT * acceleration;
        self.eta += DT * self.rate;
        self.eta
    }
}

/// Deflection of the tip after the force has gone, and the largest voltage.
fn swing(link: &Link<f64, 2>, patch: &Piezo<f64, 24, 28>, gain: f64) -> (Vec<f64>, f64) {
    let held = LinkInput::default();
    let mut state = link.settled(&LinkInput { tip_force: FORCE, ..held });
    let (mut driven, mut filter) = (patch.rest(), Filter::default());
    let (mut voltage, mut most) = (0.0, 0.0_f64);
    let deflections = (0..20_000).map(|_| {
        let actuated = patch.step(&mut driven, voltage);
        most = most.max(actuated.voltage.abs());
        let output = link.step(&mut state, &LinkInput { couple: actuated.couple, ..held });
        // The sensor's amplifier holds it at 0 V.
        voltage = gain * filter.step(link.frequencies()[0], patch.charge(0.0, output.rotation));
        output.deflection
    });
    let deflections: Vec<_> = deflections.collect();
    (deflections, most)
}

/// Frequency (Hz) and damping ratio of the first mode: time and height of every half swing, as far as
/// they are above a fifth of the first; the damping is the slope of the line through the heights' logarithms.
fn decay(deflections: &[f64]) -> (f64, f64) {
    let half_swings = deflections.chunk_by(|a, b| (*a > 0.0) == (*b > 0.0));
    let mut start = 0;
    let mut peaks: Vec<(f64, f64)> = Vec::new();
    for half_swing in half_swings {
        let largest = half_swing.iter().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let (place, height) = largest.map_or((0, 0.0), |(place, height)| (place, height.abs()));
        peaks.push(((start + place) as f64 * DT, height.ln()));
        start += half_swing.len();
    }
    // The first began before the force had gone, the last may be cut off.
    peaks.truncate(peaks.len() - 1);
    let first = peaks[1].1;
    let peaks: Vec<_> = peaks.into_iter().skip(1).take_while(|peak| peak.1 > first - 5.0_f64.ln()).collect();
    let count = peaks.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| peaks.iter().map(of).sum::<f64>() / count;
    let (time, height) = (mean(|peak| peak.0), mean(|peak| peak.1));
    let rise: f64 = peaks.iter().map(|peak| (peak.0 - time) * (peak.1 - height)).sum();
    let spread: f64 = peaks.iter().map(|peak| (peak.0 - time).powi(2)).sum();
    let frequency = 0.5 * (count - 1.0) / (peaks[peaks.len() - 1].0 - peaks[0].0);
    (frequency, -rise / spread / (TAU * frequency))
}

fn main() -> Result<(), Error> {
    let (link, patch) = (link()?, patch()?);
    println!("first modes [Hz]: {:.2?}", link.frequencies().map(|omega| omega / TAU));
    println!(
        "                     frequency [Hz]   damping ratio   largest voltage [V]   tip after 1 s [um]"
    );
    let mut ratios = Vec::new();
    for (name, gain) in [("without feedback", 0.0), ("position feedback", GAIN)] {
        let (deflections, voltage) = swing(&link, &patch, gain);
        let (frequency, ratio) = decay(&deflections);
        let left = deflections[9000..11_000].iter().fold(0.0_f64, |most, w| most.max(w.abs()));
        println!("{name:20} {frequency:14.3} {ratio:15.5} {voltage:21.1} {:20.1}", left * 1e6);
        ratios.push(ratio);
    }
    println!("The patch multiplies the damping of the first mode by {:.1}.", ratios[1] / ratios[0]);
    Ok(())
}
