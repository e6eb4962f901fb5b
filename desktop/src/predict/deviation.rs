//! Error of a prediction, its constant offset apart from its shape.

/// Error of a prediction, predicted - measured, in the unit of the quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Rms, its offset included.
    pub rms: f64,
    /// Largest magnitude, its offset included.
    pub max: f64,
    /// Mean.
    pub offset: f64,
    /// Rms about the mean.
    pub shape_rms: f64,
    /// Largest magnitude about the mean.
    pub shape_max: f64,
}

impl Deviation {
    /// Of a prediction against as many measurements, at least one.
    pub fn of(predicted: &[f64], measured: &[f64]) -> Self {
        let error: Vec<_> = predicted.iter().zip(measured).map(|(p, m)| p - m).collect();
        let offset = error.iter().sum::<f64>() / error.len() as f64;
        let shape: Vec<_> = error.iter().map(|error| error - offset).collect();
        Self { rms: rms(&error), max: max(&error), offset, shape_rms: rms(&shape), shape_max: max(&shape) }
    }
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

fn max(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| value.abs().max(most))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offset_and_shape_add_up() {
        let found = Deviation::of(&[3.0, 5.0, 3.0, 5.0], &[1.0, 1.0, 1.0, 1.0]);
        assert_eq!((found.offset, found.shape_rms, found.shape_max, found.max), (3.0, 1.0, 1.0, 4.0));
        assert!((found.rms.powi(2) - found.offset.powi(2) - found.shape_rms.powi(2)).abs() < 1e-12);
    }
}
