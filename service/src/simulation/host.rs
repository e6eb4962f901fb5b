//! The host's end of a line to a joint, as a client reads and writes it: the joint runs while it is read.

use std::io::{self, ErrorKind, Read, Write};
use std::thread;
use std::time::Duration;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::joint::{Line, RestingJoint};
use crate::tuning::TuningLink;

/// Control periods in which the joint runs at each read, and their time.
const PERIODS: u32 = 10;
const TIME: Duration = Duration::from_millis(1);

/// A line that loses and garbles bytes, each by chance.
#[derive(Clone, Debug)]
struct Noise {
    /// Probabilities of a byte to be lost, and to have a bit turned.
    lost: f64,
    turned: f64,
    random: ChaCha8Rng,
}

impl Noise {
    /// The byte at the other end, if it arrives.
    fn carry(&mut self, byte: u8) -> Option<u8> {
        let turned =
            if self.random.random_bool(self.turned) { 1 << self.random.random_range(0..8) } else { 0 };
        (!self.random.random_bool(self.lost)).then_some(byte ^ turned)
    }
}

/// The host's end.
#[derive(Default)]
pub struct HostEnd {
    /// The joint at the other one.
    pub joint: RestingJoint,
    /// Its link.
    pub link: TuningLink,
    line: Line,
    noise: Option<Noise>,
    /// Nothing is carried any more, in either direction.
    pub cut: bool,
}

impl HostEnd {
    /// The end of a line on which bytes are lost and have a bit turned, with these probabilities.
    pub fn noisy(lost: f64, turned: f64, seed: u64) -> Self {
        let noise = Noise { lost, turned, random: ChaCha8Rng::seed_from_u64(seed) };
        Self { noise: Some(noise), ..Self::default() }
    }

    /// Runs the joint for so many control periods, during which the host is silent.
    pub fn run(&mut self, periods: u32) {
        self.joint.run(&mut self.link, &mut self.line, periods);
    }
}

/// A byte at the other end of the line, if it arrives.
fn carry(noise: &mut Option<Noise>, cut: bool, byte: u8) -> Option<u8> {
    match noise {
        _ if cut => None,
        Some(noise) => noise.carry(byte),
        None => Some(byte),
    }
}

impl Read for HostEnd {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.run(PERIODS);
        let count = bytes.len().min(self.line.back.len());
        let mut read = 0;
        let (noise, cut) = (&mut self.noise, self.cut);
        let arrived = self.line.back.drain(..count).filter_map(|byte| carry(noise, cut, byte));
        for (place, byte) in bytes.iter_mut().zip(arrived) {
            *place = byte;
            read += 1;
        }
        if read > 0 {
            return Ok(read);
        }
        // The joint's time is no faster than the host's, by which the client waits.
        thread::sleep(TIME);
        Err(ErrorKind::TimedOut.into())
    }
}

impl Write for HostEnd {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let (noise, cut) = (&mut self.noise, self.cut);
        self.line.there.extend(bytes.iter().filter_map(|byte| carry(noise, cut, *byte)));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
