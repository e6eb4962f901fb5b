//! The floor: a first-order lag, `x += a*(u - x)`, f64: the least that a model with a state does in a step.

use std::hint::black_box;

use super::Kernel;

/// Its name among the kernels.
pub(super) const NAME: &str = "floor";
/// Steps of a pass.
const STEPS: u32 = 4096;
/// a.
const FRACTION: f64 = 0.01;

pub(super) fn kernel() -> Kernel {
    let mut lagging = 0.0;
    Kernel::new(NAME, NAME, STEPS as usize, move || {
        for k in 0..STEPS {
            lagging += FRACTION * (black_box(f64::from(k)) - lagging);
        }
        black_box(lagging);
    })
}
