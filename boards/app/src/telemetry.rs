//! Telemetry of the control: from the interrupt through a queue to the idle loop.
//!
//! The interrupt never waits: a record that finds the queue full is counted and dropped. The idle
//! loop is the only reader and the only one that logs.

use core::sync::atomic::{AtomicU32, Ordering};
use heapless::spsc::{Consumer, Producer, Queue};
use strainwave::compensator::{Input, Output};

/// Records that the queue holds before it drops: 2.5 ms of control when every period is reported.
pub const CAPACITY: usize = SLOTS - 1;
/// One slot of a ring stays empty.
const SLOTS: usize = 26;

/// One control period, as reported.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Record {
    /// Control periods since start-up.
    pub period: u32,
    /// Periods that lasted into the next one.
    pub overruns: u32,
    /// Motor encoder, raw count within the revolution.
    pub motor_encoder: u32,
    /// Torque command to the motor (N m).
    pub motor_torque: f32,
    /// Torsion of the flexspline (rad).
    pub torsion: f32,
    /// External torque on the flexspline (N m).
    pub external_torque: f32,
    /// Faults, by bit.
    pub faults: u32,
}

impl Record {
    /// The record of one step.
    pub fn new(period: u32, overruns: u32, input: &Input<f32>, output: &Output<f32>) -> Self {
        Self {
            period,
            overruns,
            motor_encoder: input.sensors.motor_encoder,
            motor_torque: output.motor_torque,
            torsion: output.estimate.torsion,
            external_torque: output.estimate.external_torque,
            faults: output.faults.bits(),
        }
    }
}

/// The queue between interrupt and idle loop.
pub struct Telemetry {
    queue: Queue<Record, SLOTS>,
    dropped: AtomicU32,
}

impl Telemetry {
    /// An empty queue.
    pub const fn new() -> Self {
        Self { queue: Queue::new(), dropped: AtomicU32::new(0) }
    }

    /// The interrupt's end and the idle loop's end.
    pub fn split(&'static mut self) -> (Sender, Log) {
        let (producer, consumer) = self.queue.split();
        (Sender { producer, dropped: &self.dropped }, Log { consumer, dropped: &self.dropped })
    }
}

impl Default for Telemetry {
    fn default() -> Self {
        Self::new()
    }
}

/// The interrupt's end.
pub struct Sender {
    producer: Producer<'static, Record, SLOTS>,
    dropped: &'static AtomicU32,
}

impl Sender {
    /// Queues a record, or counts it as dropped.
    #[inline]
    pub fn send(&mut self, record: Record) {
        if self.producer.enqueue(record).is_err() {
            // The interrupt is the only writer: a load and a store make no race.
            let dropped = self.dropped.load(Ordering::Relaxed).saturating_add(1);
            self.dropped.store(dropped, Ordering::Relaxed);
        }
    }
}

/// The idle loop's end.
pub struct Log {
    consumer: Consumer<'static, Record, SLOTS>,
    dropped: &'static AtomicU32,
}

impl Log {
    /// The oldest record that has not been taken yet.
    pub fn take(&mut self) -> Option<Record> {
        self.consumer.dequeue()
    }

    /// Records dropped since start-up because the queue was full.
    pub fn dropped(&self) -> u32 {
        self.dropped.load(Ordering::Relaxed)
    }

    /// Logs every waiting record. Idle loop only.
    #[cfg(target_os = "none")]
    pub fn drain(&mut self) {
        while let Some(record) = self.take() {
            write(&record, self.dropped());
        }
    }
}

#[cfg(target_os = "none")]
fn write(record: &Record, dropped: u32) {
    defmt::info!(
        "period {=u32} encoder {=u32} torque {=f32} torsion {=f32} external {=f32} faults {=u32:#x} overruns {=u32} dropped {=u32}",
        record.period,
        record.motor_encoder,
        record.motor_torque,
        record.torsion,
        record.external_torque,
        record.faults,
        record.overruns,
        dropped
    );
}
