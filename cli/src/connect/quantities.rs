//! The quantities of a reading as a row of numbers, each with its name and unit.

use strainwave_service::tuning::{QUANTITIES, Reading};

/// Ending of the name of an estimate's standard deviation.
const DEVIATION: &str = "_deviation";

/// Name and unit of every number of a row, in its order: time, mode and faults as numbers, angles, then the floats of the reading.
pub fn all() -> impl Iterator<Item = (&'static str, &'static str)> {
    let first = [("t", "s"), ("mode", "1"), ("faults", "1")];
    let angles = [("motor_reference", "rad"), ("output_position", "rad")];
    first.into_iter().chain(angles).chain(QUANTITIES.iter().copied())
}

/// How many numbers are in front of the quantities.
pub const STATE: usize = 3;

/// The numbers of a reading at this time (s).
pub fn row(time: f64, reading: &Reading) -> Vec<f64> {
    let state = [time, f64::from(reading.mode().code()), f64::from(reading.faults().bits())];
    let angles = [reading.motor_reference().to_radians(), reading.output_position().to_radians()];
    state.into_iter().chain(angles).chain(reading.floats().iter().map(|value| f64::from(*value))).collect()
}

/// Name of a column: with its unit, unless it has none.
pub fn column((name, unit): (&str, &str)) -> String {
    if unit == "1" { name.to_owned() } else { format!("{name}_{unit}") }
}

/// A quantity, its value, and the standard deviation of an estimate.
pub struct Quantity {
    pub name: &'static str,
    pub unit: &'static str,
    pub value: f64,
    pub deviation: Option<f64>,
}

/// The quantities of a row; a deviation stands beside its estimate.
pub fn of(row: &[f64]) -> impl Iterator<Item = Quantity> {
    let named = move || all().zip(row).skip(STATE);
    named().filter(|((name, _), _)| !name.ends_with(DEVIATION)).map(move |((name, unit), value)| {
        let of_it = |other: &str| other.strip_suffix(DEVIATION) == Some(name);
        let deviation = named().find(|((other, _), _)| of_it(other)).map(|(_, deviation)| *deviation);
        Quantity { name, unit, value: *value, deviation }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_deviation_stands_beside_its_estimate() {
        let row = row(0.5, &Reading::default());
        assert_eq!(row.len(), all().count());
        let numbers: Vec<f64> = (0..row.len()).map(|place| place as f64).collect();
        let quantities: Vec<_> = of(&numbers).collect();
        let deviations = quantities.iter().filter(|quantity| quantity.deviation.is_some()).count();
        assert_eq!((deviations, quantities.len()), (7, row.len() - STATE - 7));
        let at = |name| all().position(|(other, _)| other == name).unwrap() as f64;
        let torsion = quantities.iter().find(|quantity| quantity.name == "torsion").unwrap();
        assert_eq!((torsion.value, torsion.deviation), (at("torsion"), Some(at("torsion_deviation"))));
    }
}
