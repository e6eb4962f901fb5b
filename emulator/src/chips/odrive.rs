//! Model of an ODrive on a CAN bus, by its documentation and not by the firmware's code: what shared code had wrong would be unseen.
//!
//! ```text
//! taken   0x07 Set_Axis_State u32   0x0b Set_Controller_Mode u32, u32   0x0e Set_Input_Torque f32   0x18 Clear_Errors
//! sent    0x01 Heartbeat: active errors u32, axis state u8, procedure result u8, trajectory done u8, 0
//! ```
//!
//! Axis states are idle and closed-loop control, which it enters without errors only. An error takes it to idle and stays until it is cleared;
//! so does its watchdog, fed by every torque, in closed-loop control. Its motor has the torque in closed-loop control, by the modes of torque
//! and passthrough alone, at most the peak. Its current loop is the plant's.

use embedded_can::Frame as _;

use crate::chips::can::CanFrame;

/// Axis states.
const IDLE: u8 = 1;
const CLOSED_LOOP_CONTROL: u8 = 8;
/// Error: its watchdog has expired.
const WATCHDOG_TIMER_EXPIRED: u32 = 0x0100_0000;
/// Error: the motor's current is beyond its limit.
pub const CURRENT_LIMIT_VIOLATION: u32 = 0x0000_1000;

/// How it is configured.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Its node, 0 to 62.
    pub node: u8,
    /// Clocks from one heartbeat to the next.
    pub heartbeat: u64,
    /// Clocks without a torque after which the watchdog expires.
    pub watchdog: u64,
    /// Torque limit (N m).
    pub peak: f32,
}

/// The drive.
#[derive(Debug)]
pub struct Odrive {
    settings: Settings,
    state: u8,
    errors: u32,
    /// Torque and passthrough.
    follows_torque: bool,
    input: f32,
    /// When the watchdog was fed last.
    fed: u64,
    next_heartbeat: u64,
    silent: bool,
    now: u64,
    /// Integral of the torque since it was last told (N m times clocks), and since when.
    impulse: f64,
    since: u64,
}

impl Odrive {
    /// Idle, from this time on.
    pub fn new(settings: Settings, now: u64) -> Self {
        Self {
            settings,
            state: IDLE,
            errors: 0,
            follows_torque: false,
            input: 0.0,
            fed: now,
            next_heartbeat: now,
            silent: false,
            now,
            impulse: 0.0,
            since: now,
        }
    }

    /// A frame has come.
    pub fn take(&mut self, at: u64, frame: &CanFrame) {
        self.pass(at);
        let Some(command) = frame.number().checked_sub(self.first()) else { return };
        match (command, frame.data()) {
            (0x07, &[1, 0, 0, 0]) => self.state = IDLE,
            (0x07, &[8, 0, 0, 0]) => self.enable(),
            (0x0b, mode) => self.follows_torque = mode == [1, 0, 0, 0, 1, 0, 0, 0],
            (0x0e, &[t0, t1, t2, t3]) => {
                (self.input, self.fed) = (f32::from_le_bytes([t0, t1, t2, t3]), at);
            }
            (0x18, _) => self.errors = 0,
            _ => {}
        }
    }

    /// Goes on to a time.
    pub fn pass(&mut self, to: u64) {
        let expires = self.fed + self.settings.watchdog;
        if self.is_on() && expires < to {
            self.work(expires);
            self.fail(WATCHDOG_TIMER_EXPIRED);
        }
        self.work(to);
    }

    /// Heartbeats until a time, each with its own.
    pub fn heartbeats(&mut self, until: u64) -> Vec<(u64, CanFrame)> {
        let mut sent = Vec::new();
        while self.next_heartbeat < until {
            if !self.silent {
                sent.extend(self.heartbeat().map(|frame| (self.next_heartbeat, frame)));
            }
            self.next_heartbeat += self.settings.heartbeat;
        }
        sent
    }

    /// An error comes.
    pub fn fail(&mut self, error: u32) {
        self.errors |= error;
        self.state = IDLE;
    }

    /// Whether its heartbeats come.
    pub fn is_heard(&mut self, is_heard: bool) {
        self.silent = !is_heard;
    }

    /// Its motor is powered.
    pub fn is_on(&self) -> bool {
        self.state == CLOSED_LOOP_CONTROL
    }

    /// Mean torque of the motor since this was last called (N m).
    pub fn mean_torque(&mut self) -> f32 {
        let mean = self.impulse / (self.now - self.since).max(1) as f64;
        (self.impulse, self.since) = (0.0, self.now);
        mean as f32
    }

    fn first(&self) -> u16 {
        u16::from(self.settings.node) << 5
    }

    fn enable(&mut self) {
        if self.errors == 0 && self.state == IDLE {
            (self.state, self.fed) = (CLOSED_LOOP_CONTROL, self.now);
        }
    }

    fn torque(&self) -> f32 {
        let peak = self.settings.peak;
        if self.is_on() && self.follows_torque { self.input.clamp(-peak, peak) } else { 0.0 }
    }

    fn work(&mut self, to: u64) {
        self.impulse += f64::from(self.torque()) * to.saturating_sub(self.now) as f64;
        self.now = self.now.max(to);
    }

    fn heartbeat(&self) -> Option<CanFrame> {
        let [e0, e1, e2, e3] = self.errors.to_le_bytes();
        CanFrame::of(self.first() + 0x01, &[e0, e1, e2, e3, self.state, 0, 0, 0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: Settings = Settings { node: 3, heartbeat: 100, watchdog: 50, peak: 2.0 };

    fn take(drive: &mut Odrive, at: u64, command: u16, data: &[u8]) {
        drive.take(at, &CanFrame::of(3 << 5 | command, data).unwrap());
    }

    fn torque(drive: &mut Odrive, at: u64, torque: f32) {
        take(drive, at, 0x0e, &torque.to_le_bytes());
    }

    fn enabled() -> Odrive {
        let mut drive = Odrive::new(SETTINGS, 0);
        take(&mut drive, 0, 0x0b, &[1, 0, 0, 0, 1, 0, 0, 0]);
        take(&mut drive, 0, 0x07, &[8, 0, 0, 0]);
        assert!(drive.is_on());
        drive
    }

    #[test]
    fn a_torque_counts_from_when_it_comes() {
        let mut drive = enabled();
        torque(&mut drive, 10, 1.0);
        torque(&mut drive, 30, 9.0);
        drive.pass(40);
        assert_eq!(drive.mean_torque(), (20.0 * 1.0 + 10.0 * 2.0) / 40.0);
        drive.pass(50);
        assert_eq!(drive.mean_torque(), 2.0);
        // Of another node, and in another mode.
        drive.take(50, &CanFrame::of(4 << 5 | 0x07, &[1, 0, 0, 0]).unwrap());
        assert!(drive.is_on());
        take(&mut drive, 50, 0x0b, &[2, 0, 0, 0, 1, 0, 0, 0]);
        drive.pass(60);
        assert_eq!(drive.mean_torque(), 0.0);
    }

    #[test]
    fn without_a_torque_its_watchdog_expires() {
        let mut drive = enabled();
        torque(&mut drive, 10, 1.0);
        drive.pass(100);
        assert_eq!((drive.is_on(), drive.mean_torque()), (false, 0.5));
        take(&mut drive, 100, 0x07, &[8, 0, 0, 0]);
        assert!(!drive.is_on());
        let [(_, told), ..] = drive.heartbeats(200)[..] else { panic!() };
        assert_eq!((told.number(), told.data()), (0x61, &[0, 0, 0, 1, 1, 0, 0, 0][..]));
        take(&mut drive, 100, 0x18, &[0]);
        take(&mut drive, 100, 0x07, &[8, 0, 0, 0]);
        assert!(drive.is_on());
        take(&mut drive, 110, 0x07, &[1, 0, 0, 0]);
        drive.pass(1000);
        assert_eq!(drive.errors, 0);
    }

    #[test]
    fn heartbeats_come_at_their_times() {
        let mut drive = enabled();
        let times = |sent: Vec<(u64, CanFrame)>| sent.into_iter().map(|(at, _)| at).collect::<Vec<_>>();
        assert_eq!(times(drive.heartbeats(201)), [0, 100, 200]);
        drive.is_heard(false);
        assert!(drive.heartbeats(401).is_empty());
        drive.is_heard(true);
        assert_eq!(times(drive.heartbeats(501)), [500]);
        drive.fail(CURRENT_LIMIT_VIOLATION);
        assert!(!drive.is_on());
    }
}
