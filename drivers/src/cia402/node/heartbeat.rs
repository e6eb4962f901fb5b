//! Heartbeats: ours, and that of the master. Times in ms, counted in control periods.

/// Object 0x1017.
#[derive(Clone, Debug)]
pub(super) struct Producer {
    time: u16,
    elapsed: u32,
}

impl Producer {
    /// Heartbeats every `time` ms, none for 0.
    pub(super) const fn new(time: u16) -> Self {
        Self { time, elapsed: 0 }
    }

    pub(super) fn time(&self) -> u16 {
        self.time
    }

    /// Once a control period, of which a millisecond has `per_ms`: a heartbeat is due.
    pub(super) fn tick(&mut self, per_ms: u32) -> bool {
        self.elapsed = self.elapsed.saturating_add(1);
        let due = self.time != 0 && self.elapsed >= periods(self.time, per_ms);
        if due {
            self.elapsed = 0;
        }
        due
    }
}

/// Object 0x1016: time and node of the heartbeat that is watched.
#[derive(Clone, Debug, Default)]
pub(super) struct Consumer {
    node: u8,
    time: u16,
    silent: u32,
}

impl Consumer {
    /// By the object's value, node in bits 16 to 23 and ms below. `None` when it is not that of a node, or of this one.
    pub(super) fn new(value: u32, own: u8) -> Option<Self> {
        let [t0, t1, node, reserved] = value.to_le_bytes();
        let valid = reserved == 0 && node <= 127 && node != own;
        valid.then_some(Self { node, time: u16::from_le_bytes([t0, t1]), silent: 0 })
    }

    pub(super) fn value(&self) -> u32 {
        u32::from(self.node) << 16 | u32::from(self.time)
    }

    /// A heartbeat of this node has come.
    pub(super) fn heard(&mut self, node: u16) {
        if node == u16::from(self.node) {
            self.silent = 0;
        }
    }

    /// Once a control period.
    pub(super) fn tick(&mut self) {
        self.silent = self.silent.saturating_add(1);
    }

    pub(super) fn lost(&self, per_ms: u32) -> bool {
        self.node != 0 && self.time != 0 && self.silent >= periods(self.time, per_ms)
    }
}

fn periods(time: u16, per_ms: u32) -> u32 {
    u32::from(time).saturating_mul(per_ms)
}
