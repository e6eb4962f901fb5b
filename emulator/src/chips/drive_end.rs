//! The drive of a joint that is commanded over CAN: at wires of the chip, or on its second bus.

use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave_app::Compensator;
use strainwave_app::commanded::{self, Commanded, ODRIVE, Wired};

use crate::chips::bus_program::{Ask, Failure};
use crate::chips::chip::{self, Chip};
use crate::chips::host::{self, Drive, Host, HostBoard, RELEASED};
use crate::chips::host_bus::{Beside, HostBus};
use crate::chips::odrive::{CURRENT_LIMIT_VIOLATION, Odrive, Settings};
use crate::chips::stm32::g4_fdcan::bus::CLOCK;

/// The end of the drive, and the host's beside it.
pub trait DriveEnd: Sized {
    /// What the host's node has behind it.
    type Behind: commanded::Drive + 'static;

    /// Of a chip that was started so long ago (s), before its first period.
    ///
    /// # Errors
    /// Where the host's build has no such drive.
    fn begin(started: f64, compensator: &Compensator) -> Result<(Self, Self::Behind), chip::Error>;

    /// Before a period.
    fn before(&mut self, _chip: &Chip, _ask: &Ask) {}

    /// After it, in which the host's control sees `count`: mean torque of the motor (N m), and the drive at its wires or as it is powered.
    ///
    /// # Errors
    /// As [`Chip::drive`].
    fn after(
        &mut self,
        chip: &Chip,
        host: &mut ControlBeside,
        count: Option<u32>,
    ) -> Result<(f32, Drive), chip::Error>;

    /// After the host's node was polled.
    fn polled(&mut self) {}
}

/// The host's control.
pub type ControlBeside = Host<HostBoard<Commanded>>;

/// A drive at wires: the code of its torque, and its enable.
pub struct WiredEnd {
    /// The motor's peak torque (N m).
    peak: f32,
}

impl DriveEnd for WiredEnd {
    type Behind = Wired;

    fn begin(_started: f64, compensator: &Compensator) -> Result<(Self, Wired), chip::Error> {
        Ok((Self { peak: compensator.limits().motor_torque }, Wired))
    }

    fn after(
        &mut self,
        chip: &Chip,
        host: &mut ControlBeside,
        count: Option<u32>,
    ) -> Result<(f32, Drive), chip::Error> {
        let drive = chip.drive()?;
        host.compare(count, drive);
        Ok((host::torque(drive, self.peak) as f32, drive))
    }
}

/// Clocks of the bus in a control period.
const PERIOD: u64 = (CONTROL_PERIOD * CLOCK) as u64;
/// From the begin of a period to its control interrupt, at least: what [`super::control`] says, less a step of its waiting.
const INTERRUPT: u64 = 3 * PERIOD / 10;
/// As the book has the drive configured (s).
const HEARTBEAT: f64 = 4e-3;
const WATCHDOG: f64 = 10e-3;

/// An ODrive on the second bus.
pub struct OdriveEnd {
    drive: Odrive,
    /// Frames to the drive.
    pub bus: Beside,
    /// When each has come (clocks), and that of the begin of the period whose torque the host's carries.
    come: Vec<u64>,
    sampled: Vec<u64>,
    /// Begin of this period (clocks).
    now: u64,
}

impl OdriveEnd {
    /// Longest time from a control interrupt until its torque, or a newer one, is at the drive (s).
    pub fn delay(&self) -> f64 {
        let frames = self.come.iter().skip(1).zip(&self.sampled);
        let delays = frames.map(|(come, sampled)| come.saturating_sub(sampled + PERIOD + INTERRUPT));
        delays.max().map_or(f64::NAN, |clocks| clocks as f64 / CLOCK)
    }
}

impl DriveEnd for OdriveEnd {
    type Behind = commanded::Odrive<HostBus>;

    fn begin(started: f64, compensator: &Compensator) -> Result<(Self, Self::Behind), chip::Error> {
        let now = (started * CLOCK).round() as u64;
        let settings = Settings {
            node: ODRIVE,
            heartbeat: (HEARTBEAT * CLOCK) as u64,
            watchdog: (WATCHDOG * CLOCK) as u64,
            peak: compensator.limits().motor_torque,
        };
        let bus = Beside::default();
        let behind = commanded::Odrive::new(ODRIVE, bus.host.clone(), compensator);
        let never = || chip::Error::NotStarted { said: "there is no such drive".into() };
        let drive = Odrive::new(settings, now);
        Ok((Self { drive, bus, come: Vec::new(), sampled: Vec::new(), now }, behind.ok_or_else(never)?))
    }

    fn before(&mut self, chip: &Chip, ask: &Ask) {
        self.drive.is_heard(ask.failure != Some(Failure::Silent));
        if ask.failure == Some(Failure::Error) {
            self.drive.fail(CURRENT_LIMIT_VIOLATION);
        }
        for (at, frame) in self.drive.heartbeats(self.now + PERIOD) {
            chip.second_bus().put_at(at, frame);
        }
    }

    fn after(
        &mut self,
        chip: &Chip,
        host: &mut ControlBeside,
        count: Option<u32>,
    ) -> Result<(f32, Drive), chip::Error> {
        for (at, frame) in chip.second_bus().take_timed() {
            self.drive.take(at, &frame);
            self.come.push(at);
            self.bus.sent.push(frame);
        }
        self.drive.pass(self.now + PERIOD);
        host.step(count);
        self.bus.host.put(chip.second_bus().read());
        let (released, _) = RELEASED;
        Ok((self.drive.mean_torque(), (released, self.drive.is_on())))
    }

    fn polled(&mut self) {
        self.sampled.resize(self.bus.host.count(), self.now);
        self.now += PERIOD;
    }
}
