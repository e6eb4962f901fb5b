//! The real-time reduction in f32 against f64, along the motion of `reduction.rs`.

use super::reduction::run;
use crate::io::belt_file::BeltFile;
use crate::io::figure::Figure;
use crate::verify::{bounds, largest};

/// Largest difference of a span force, as a fraction of the pretension.
pub(super) fn measure() -> Vec<Figure> {
    let (double, single) = (run::<f64, 0>(1), run::<f32, 0>(1));
    let differences = double.iter().zip(&single).flat_map(|(double, single)| {
        [double.forward - f64::from(single.forward), double.backward - f64::from(single.backward)]
    });
    vec![bounds::figure("belt.f32", largest(differences) / BeltFile::example().belt.pretension)]
}
