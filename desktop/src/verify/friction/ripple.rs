//! The ripple of a measured gear's friction (`zxf17/friction_map_4dp.json`), fitted and compared order by
//! order.

use std::f64::consts::TAU;

use serde::Deserialize;
use strainwave::friction::{Harmonics, Ripple, RippleParams};
use strainwave::{Heading, Real};

use crate::identify::ripple_fit;
use crate::io::data;
use crate::io::file::{self, BadInput};
use crate::verify::bounds;
use crate::verify::{Measured, largest};

const MAP: &str = "zxf17/friction_map_4dp.json";
/// Longest file (bytes).
const LONGEST: u64 = 1 << 16;
/// Orders that are fitted and compared.
const ORDERS: usize = 4;
/// Mean and amplitudes of orders 1 and 2 (N m) that came with the map, forwards and backwards.
const PUBLISHED: [[f64; 3]; 2] = [[7.96, 1.59, 1.005], [7.29, 1.04, 1.021]];

/// Kinetic friction by bins of the rotor's angle (N m).
#[derive(Clone, Debug, Deserialize)]
pub struct Map {
    map_pos: Vec<f64>,
    map_neg: Vec<f64>,
}

pub(super) fn measure() -> Result<Measured, BadInput> {
    let Some(path) = data::find(MAP) else {
        return Ok(Measured::skipped(format!("friction.ripple.*: skipped: no data ({MAP})")));
    };
    let map: Map =
        serde_json::from_slice(&file::read(&path, LONGEST)?).map_err(|error| BadInput::new(&path, error))?;
    let model = map.fit::<f32>().build().map_err(|error| BadInput::new(&path, error))?;
    Ok(vec![
        bounds::figure("friction.ripple.zxf17", map.distance(&model)),
        bounds::figure("friction.ripple.zxf17.published", off_published(&model)),
    ]
    .into())
}

impl Map {
    fn fit<R: Real>(&self) -> RippleParams<R, ORDERS> {
        RippleParams {
            forward: rounded(&ripple_fit::fit(&self.map_pos)),
            backward: rounded(&ripple_fit::fit(&self.map_neg)),
        }
    }

    /// Largest relative error of the mean and of an order's amplitude, both directions.
    fn distance(&self, model: &Ripple<f32, ORDERS>) -> f64 {
        largest([(&self.map_pos, false), (&self.map_neg, true)].map(|(bins, backwards)| {
            let sampled = sample(model, bins.len(), backwards);
            largest(
                (0..=ORDERS).map(|order| (amplitude(&sampled, order) / amplitude(bins, order) - 1.0).abs()),
            )
        }))
    }
}

fn off_published(model: &Ripple<f32, ORDERS>) -> f64 {
    largest([false, true].map(|backwards| {
        let sampled = sample(model, 360, backwards);
        let published = PUBLISHED[usize::from(backwards)].iter().enumerate();
        largest(published.map(|(order, expected)| (amplitude(&sampled, order) / expected - 1.0).abs()))
    }))
}

fn rounded<R: Real>(exact: &Harmonics<f64, ORDERS>) -> Harmonics<R, ORDERS> {
    Harmonics { mean: R::lit(exact.mean), cosines: exact.cosines.map(R::lit), sines: exact.sines.map(R::lit) }
}

/// The model's level at the middle of each bin.
fn sample(model: &Ripple<f32, ORDERS>, bins: usize, backwards: bool) -> Vec<f64> {
    let middle = |k: usize| (((2 * k as u64 + 1) << 32) / (2 * bins as u64)) as u32;
    (0..bins).map(|k| f64::from(model.level(Heading::of_phase(middle(k)), backwards))).collect()
}

/// Amplitude of an order; of order 0, the mean. Written apart from the fit: by the sum of pointers.
fn amplitude(bins: &[f64], order: usize) -> f64 {
    let (mut x, mut y) = (0.0, 0.0);
    for (k, level) in bins.iter().enumerate() {
        let (sine, cosine) = (TAU * (order * k) as f64 / bins.len() as f64).sin_cos();
        (x, y) = (x + level * cosine, y + level * sine);
    }
    x.hypot(y) / bins.len() as f64 * if order == 0 { 1.0 } else { 2.0 }
}
