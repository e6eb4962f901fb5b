//! Which faults a run has raised, and for how long.

use strainwave::compensator::Faults;

use strainwave::compensator::schedule::CONTROL_PERIOD;

/// Control periods in which each fault was raised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Raised([u32; Faults::NAMES.len()]);

impl Raised {
    /// Counts one control period with these faults.
    pub fn add(&mut self, faults: Faults) {
        for (periods, (fault, _)) in self.0.iter_mut().zip(Faults::NAMES) {
            *periods += u32::from(faults.contains(*fault));
        }
    }

    /// The faults that were raised with their names, and for how long (s).
    pub fn times(&self) -> impl Iterator<Item = (Faults, &'static str, f64)> {
        let all = self.0.into_iter().zip(Faults::NAMES);
        all.filter(|(periods, _)| *periods > 0)
            .map(|(periods, (fault, name))| (*fault, *name, f64::from(periods) * CONTROL_PERIOD))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_fault_has_its_time() {
        let mut raised = Raised::default();
        assert_eq!(raised.times().count(), 0);
        for faults in [Faults::NONE, Faults::OVERSPEED, Faults::OVERSPEED.with(Faults::TORQUE_LIMITED)] {
            raised.add(faults);
        }
        let times: Vec<_> = raised.times().collect();
        let expected = [
            (Faults::TORQUE_LIMITED, "torque limited", CONTROL_PERIOD),
            (Faults::OVERSPEED, "overspeed", 2.0 * CONTROL_PERIOD),
        ];
        assert_eq!(times, expected);
    }
}
