//! Whether SYNCs come in the period of the bus: a master with another one would move the joint at another speed than it means.

/// So many intervals in a row tell another period: jitter and single SYNCs that are missing do not.
const IRREGULAR: u8 = 5;

/// Intervals between SYNCs (control periods).
#[derive(Clone, Debug, Default)]
pub(super) struct Intervals {
    elapsed: u32,
    /// How many in a row were too short or too long.
    irregular: u8,
}

impl Intervals {
    /// Once a control period.
    pub(super) fn tick(&mut self) {
        self.elapsed = self.elapsed.saturating_add(1);
    }

    /// A SYNC has come: false when it shows another period than this one. Only intervals of a joint that was enabled count.
    pub(super) fn end(&mut self, period: u32, enabled: bool) -> bool {
        // Twice the interval; half of the period is too short, three halves are not too long.
        let twice = self.elapsed.saturating_mul(2);
        let kept = twice > period && twice <= period.saturating_mul(3);
        self.elapsed = 0;
        self.irregular = if kept || !enabled { 0 } else { self.irregular.saturating_add(1) };
        self.irregular < IRREGULAR
    }
}
