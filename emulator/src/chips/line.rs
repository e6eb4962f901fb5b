//! A program of the host at the serial port of an emulated chip, in step with it: the chip goes on by a control period when the program waits for
//! bytes, and stands still while it does anything else. So both repeat exactly, however fast the machine is.

use std::cell::RefCell;
use std::collections::{HashMap, VecDeque};
use std::io::{self, ErrorKind, Read, Write};
use std::rc::Rc;
use std::sync::mpsc::{Receiver, Sender, channel};

use strainwave_service::tuning::{Order, Reading};

use crate::chips::host::Drive;

/// What the program does in a period.
#[derive(Clone, Debug, Default)]
pub struct Ask {
    /// It sends these bytes.
    pub bytes: Vec<u8>,
    /// The motor encoder has no supply.
    pub encoder_fails: bool,
    /// Steps are compared with the host's.
    pub compares: bool,
    /// Before this period it has sent this order, which the hosts beside the chip take too.
    pub order: Option<Order>,
}

/// What it sees of one.
#[derive(Clone, Debug)]
pub struct Look {
    /// Bytes that the chip has sent.
    pub bytes: Vec<u8>,
    /// The drive at its end.
    pub drive: Drive,
    /// What the host's control says of it.
    pub reading: Option<Reading>,
}

/// The chip's end: what is asked of a period, and what is seen of it.
pub struct ChipEnd<A, L> {
    asks: Receiver<A>,
    looks: Sender<L>,
}

impl<A, L> ChipEnd<A, L> {
    /// What the next period brings; `None` when the program has ended.
    pub fn ask(&self) -> Option<A> {
        self.asks.recv().ok()
    }

    /// Shows the period.
    pub fn show(&self, look: L) {
        // A program that has ended looks no longer.
        let _ = self.looks.send(look);
    }
}

/// The program's end before it begins: it may go to another thread.
pub struct ProgramEnd<A, L> {
    asks: Sender<A>,
    looks: Receiver<L>,
}

impl<A, L> ProgramEnd<A, L> {
    /// Lets the chip go on by a period.
    ///
    /// # Errors
    /// When it does not.
    pub fn go_on(&self, ask: A) -> io::Result<L> {
        let ended = || io::Error::new(ErrorKind::BrokenPipe, "the chip has ended");
        self.asks.send(ask).map_err(|_| ended())?;
        self.looks.recv().map_err(|_| ended())
    }
}

/// Both ends.
pub fn line<A, L>() -> (ChipEnd<A, L>, ProgramEnd<A, L>) {
    let ((asks, asked), (looks, seen)) = (channel(), channel());
    (ChipEnd { asks: asked, looks }, ProgramEnd { asks, looks: seen })
}

/// The port as the program has it.
#[derive(Clone)]
pub struct Port(Rc<RefCell<Open>>);

struct Open {
    end: ProgramEnd<Ask, Look>,
    next: Ask,
    come: VecDeque<u8>,
    periods: u32,
    drive: Drive,
    readings: HashMap<u32, Reading>,
}

impl Port {
    /// On its end.
    pub fn open(end: ProgramEnd<Ask, Look>) -> Self {
        let drive = crate::chips::host::RELEASED;
        let (next, come, readings) = (Ask::default(), VecDeque::new(), HashMap::new());
        Self(Rc::new(RefCell::new(Open { end, next, come, periods: 0, drive, readings })))
    }

    /// Changes what the next periods bring.
    pub fn from_now_on(&self, change: impl FnOnce(&mut Ask)) {
        change(&mut self.0.borrow_mut().next);
    }

    /// Lets the chip go on for so many periods.
    ///
    /// # Errors
    /// When it does not.
    pub fn wait(&self, periods: u32) -> io::Result<()> {
        (0..periods).try_for_each(|_| self.0.borrow_mut().go_on())
    }

    /// Periods so far.
    pub fn periods(&self) -> u32 {
        self.0.borrow().periods
    }

    /// The drive at the end of the last one.
    pub fn drive(&self) -> Drive {
        self.0.borrow().drive
    }

    /// What the host's control says of a period.
    pub fn reading(&self, period: u32) -> Option<Reading> {
        self.0.borrow().readings.get(&period).copied()
    }
}

impl Open {
    fn go_on(&mut self) -> io::Result<()> {
        let look = self.end.go_on(self.next.clone())?;
        (self.next.bytes, self.next.order) = (Vec::new(), None);
        self.come.extend(look.bytes);
        self.readings.extend(look.reading.map(|reading| (reading.period, reading)));
        (self.drive, self.periods) = (look.drive, self.periods + 1);
        Ok(())
    }
}

impl Read for Port {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let mut open = self.0.borrow_mut();
        if open.come.is_empty() {
            open.go_on()?;
        }
        if open.come.is_empty() { Err(ErrorKind::WouldBlock.into()) } else { open.come.read(bytes) }
    }
}

impl Write for Port {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().next.bytes.extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chip_goes_on_while_the_program_waits_and_ends_with_it() {
        let (chip, program) = line();
        let waits = std::thread::spawn(move || {
            let mut port = Port::open(program);
            port.write_all(b"ab").unwrap();
            assert_eq!(port.read(&mut [0; 4]).unwrap_err().kind(), ErrorKind::WouldBlock);
            let mut bytes = [0; 4];
            let count = port.read(&mut bytes).unwrap();
            (bytes[..count].to_vec(), port.periods())
        });
        let mut asked = Vec::new();
        while let Some(ask) = chip.ask() {
            let bytes = if asked.is_empty() { Vec::new() } else { b"cd".to_vec() };
            asked.push(ask.bytes);
            chip.show(Look { bytes, drive: (0, false), reading: None });
        }
        assert_eq!(asked, [b"ab".to_vec(), Vec::new()]);
        assert_eq!(waits.join().unwrap(), (b"cd".to_vec(), 2));
    }
}
