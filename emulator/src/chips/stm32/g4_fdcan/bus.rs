//! The bus of an STM32G4's FDCAN, with a peer at 1 Mbit/s: one frame after the other, each for its time.
//!
//! Of frames that could begin at once, that with the lowest identifier goes first. The peer sends in its order, no frame before its time, and once: what the chip does
//! not hear, because it is not on the bus or at another rate, is lost. The chip tries again until its frame is acknowledged. Its frame has no
//! acknowledgement where the peer gives none, at another rate, and where it is no classic data frame of an identifier of 11 bits.

use std::collections::VecDeque;
use std::sync::Mutex;

use crate::chips::can::{CanFrame, INTERMISSION, bits};
use crate::chips::stm32::g4_fdcan::message_ram::Outgoing;
use crate::chips::stm32::g4_fdcan::node::Node;
use crate::chips::time::Time;
use crate::lock::locked;

/// Clocks in a second (Hz).
pub const CLOCK: f64 = 24e6;
/// Clocks of a bit of the peer.
pub const BIT: u64 = 24;

/// The bus, as the peer and the chip have it.
#[derive(Debug, Default)]
pub struct CanBus {
    pub(super) state: Mutex<State>,
    pub(super) time: Time,
}

impl CanBus {
    /// The peer sends a frame, after those that it has sent before.
    pub fn put(&self, frame: CanFrame) {
        self.present(|state, now| state.waiting.push_back((now, frame)));
    }

    /// The same from a time on, in clocks.
    pub fn put_at(&self, time: u64, frame: CanFrame) {
        self.present(|state, _| state.waiting.push_back((time, frame)));
    }

    /// Frames of the chip that have come since this was last called.
    pub fn take(&self) -> Vec<CanFrame> {
        self.take_timed().into_iter().map(|(_, frame)| frame).collect()
    }

    /// The same, each with the time of its end, in clocks.
    pub fn take_timed(&self) -> Vec<(u64, CanFrame)> {
        self.present(|state, _| std::mem::take(&mut state.come))
    }

    /// Clocks until now.
    pub fn now(&self) -> u64 {
        self.time.now()
    }

    /// Frames that the chip has read and acknowledged in its queues since this was last called.
    pub fn read(&self) -> Vec<CanFrame> {
        self.present(|state, _| std::mem::take(&mut state.node.taken))
    }

    /// Whether the peer acknowledges the chip's frames.
    pub fn answers(&self, answers: bool) {
        self.present(|state, _| state.silent = !answers);
    }

    /// Frames that the chip has lost because their FIFO was full.
    pub fn overflows(&self) -> u32 {
        self.present(|state, _| state.overflows)
    }

    /// Errors take the chip off the bus.
    pub fn set_bus_off(&self) {
        self.present(|state, now| {
            state.node.go_off(now);
            state.follow(now);
        });
    }

    fn present<T>(&self, look: impl FnOnce(&mut State, u64) -> T) -> T {
        let now = self.time.now();
        let mut state = locked(&self.state);
        state.up_to(now);
        look(&mut state, now)
    }
}

/// A frame on the bus.
#[derive(Clone, Copy, Debug)]
struct Current {
    sender: Sender,
    end: u64,
}

#[derive(Clone, Copy, Debug)]
enum Sender {
    Chip(Outgoing),
    Peer { frame: CanFrame, heard: bool },
}

/// All of it.
#[derive(Debug, Default)]
pub struct State {
    /// The chip's end.
    pub node: Node,
    /// Of the peer, not yet sent, each with when it may begin.
    waiting: VecDeque<(u64, CanFrame)>,
    /// Of the chip, each with its end.
    come: Vec<(u64, CanFrame)>,
    silent: bool,
    overflows: u32,
    current: Option<Current>,
    /// Without a current frame: when the next may begin.
    free_at: u64,
}

impl State {
    /// What happens by now.
    pub fn up_to(&mut self, now: u64) {
        while let Some(current) = self.current.take().or_else(|| self.begins(now)) {
            if current.end > now {
                self.current = Some(current);
                return;
            }
            self.free_at = current.end + INTERMISSION * BIT;
            self.ends(current);
        }
        self.free_at = self.free_at.max(now);
    }

    /// After a change of the chip's registers: stopped, it leaves the current frame.
    pub fn follow(&mut self, now: u64) {
        match &mut self.current {
            Some(Current { sender: Sender::Peer { heard, .. }, .. }) => *heard &= !self.node.is_stopped(),
            Some(_) if self.node.is_stopped() => (self.current, self.free_at) = (None, now),
            _ => {}
        }
    }

    /// The next frame, if it begins by now.
    fn begins(&mut self, now: u64) -> Option<Current> {
        let joined = self.free_at.max(self.node.joins_at());
        let peers = self.waiting.front().map(|(time, frame)| (self.free_at.max(*time), frame.number()));
        let first = |chips: &Outgoing| peers.is_none_or(|peers| (joined, chips.frame.number()) <= peers);
        match (self.node.outgoing().filter(first), peers) {
            (Some(chips), _) => (joined <= now).then(|| {
                let end = joined + bits(&chips.frame) * self.node.bit();
                Current { sender: Sender::Chip(chips), end }
            }),
            (None, Some((at, _))) if at <= now => self.waiting.pop_front().map(|(_, frame)| {
                let heard = !self.node.is_stopped() && joined <= at && self.is_at_rate();
                Current { sender: Sender::Peer { frame, heard }, end: at + bits(&frame) * BIT }
            }),
            _ => None,
        }
    }

    fn ends(&mut self, Current { sender, end }: Current) {
        match sender {
            Sender::Chip(Outgoing { frame, plain: true }) if !self.silent && self.is_at_rate() => {
                self.node.has_sent();
                self.come.push((end, frame));
            }
            Sender::Chip(_) => self.node.was_not_acknowledged(),
            Sender::Peer { frame, heard: true } => self.overflows += u32::from(self.node.receive(&frame)),
            Sender::Peer { .. } => {}
        }
    }

    fn is_at_rate(&self) -> bool {
        self.node.bit() == BIT
    }
}
