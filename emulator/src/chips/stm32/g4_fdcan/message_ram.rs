//! Message RAM of an STM32G4's FDCAN (ST RM0440, 44.3.5): filters, frames that have come, frames to be sent.
//!
//! ```text
//! 0x000  28 filters of standard identifiers, a word each     SFT 31:30, SFEC 29:27, SFID1 26:16, SFID2 10:0
//! 0x0b0  FIFO 0, three elements of 18 words                  XTD 30, RTR 29, identifier 28:18
//! 0x188  FIFO 1                                              ANMF 31, FIDX 30:24, FDF 21, DLC 19:16
//! 0x278  three elements to be sent                           data, the first byte lowest
//! ```

use embedded_can::Frame as _;

use crate::chips::can::CanFrame;

/// Bytes of it.
pub const SIZE: usize = 0x350;
/// Most filters of standard identifiers.
const FILTERS: usize = 28;
/// Bytes of an element, and where those that have come and those to be sent begin.
const ELEMENT: usize = 72;
const RECEIVED: [usize; 2] = [0x0b0, 0x188];
const SENT: usize = 0x278;

/// In the first word: its identifier is extended; it asks for data.
const EXTENDED: u32 = 1 << 30;
const REMOTE: u32 = 1 << 29;
/// In the second: no filter matched; it is of CAN FD.
const UNMATCHED: u32 = 1 << 31;
const FLEXIBLE: u32 = 1 << 21;
/// Lowest bits of the identifier, the length, and the number of the filter that matched.
const ID: u32 = 18;
const LENGTH: u32 = 16;
const FILTER: u32 = 24;

/// A filter that matches a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Match {
    /// Its number.
    pub filter: usize,
    /// Where the frame goes, unless it is rejected.
    pub fifo: Option<usize>,
}

/// A frame to be sent.
#[derive(Clone, Copy, Debug)]
pub struct Outgoing {
    /// The frame.
    pub frame: CanFrame,
    /// It is what it is shown as: of an identifier of 11 bits, with data, classic.
    pub plain: bool,
}

/// Its words.
#[derive(Clone, Debug)]
pub struct MessageRam([u32; SIZE / 4]);

impl Default for MessageRam {
    fn default() -> Self {
        Self([0; SIZE / 4])
    }
}

impl MessageRam {
    /// The word at an offset.
    pub fn at(&self, offset: usize) -> u32 {
        self.0[offset / 4]
    }

    /// Puts it.
    pub fn put(&mut self, offset: usize, word: u32) {
        self.0[offset / 4] = word;
    }

    /// The first of so many filters that matches the identifier.
    pub fn first_match(&self, filters: usize, id: u16) -> Option<Match> {
        let filters = self.0[..filters.min(FILTERS)].iter().enumerate();
        filters.filter(|(_, filter)| matches(**filter, id.into())).find_map(|(number, filter)| {
            let fifo = match filter >> 27 & 0b111 {
                // With or without priority.
                1 | 5 => Some(0),
                2 | 6 => Some(1),
                3 | 4 => None,
                _ => return None,
            };
            Some(Match { filter: number, fifo })
        })
    }

    /// Puts a frame that has come into an element of a FIFO.
    pub fn store(&mut self, fifo: usize, element: u32, frame: &CanFrame, matched: Option<Match>) {
        let place = RECEIVED[fifo] + ELEMENT * element as usize;
        let matched = matched.map_or(UNMATCHED, |matched| (matched.filter as u32) << FILTER);
        self.put(place, u32::from(frame.number()) << ID);
        self.put(place + 4, matched | (frame.dlc() as u32) << LENGTH);
        for (offset, bytes) in (place + 8..).step_by(4).zip(frame.data().chunks(4)) {
            let mut word = [0; 4];
            word[..bytes.len()].copy_from_slice(bytes);
            self.put(offset, u32::from_le_bytes(word));
        }
    }

    /// The frame of an element that is to be sent.
    pub fn outgoing(&self, element: u32) -> Option<Outgoing> {
        let place = SENT + ELEMENT * element as usize;
        let (head, control) = (self.at(place), self.at(place + 4));
        let words = [self.at(place + 8), self.at(place + 12)].map(u32::to_le_bytes);
        let length = (control >> LENGTH & 0xf).min(8) as usize;
        let frame = CanFrame::of((head >> ID & 0x7ff) as u16, &words.concat()[..length])?;
        Some(Outgoing { frame, plain: head & (EXTENDED | REMOTE) | control & FLEXIBLE == 0 })
    }
}

/// By the type of the filter: a range, two identifiers, an identifier where a mask has ones.
fn matches(filter: u32, id: u32) -> bool {
    let (first, second) = (filter >> 16 & 0x7ff, filter & 0x7ff);
    match filter >> 30 {
        0 => (first..=second).contains(&id),
        1 => [first, second].contains(&id),
        2 => (id ^ first) & second == 0,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filter(kind: u32, action: u32, first: u32, second: u32) -> u32 {
        kind << 30 | action << 27 | first << 16 | second
    }

    fn to(ram: &MessageRam, id: u16) -> Option<(usize, Option<usize>)> {
        ram.first_match(5, id).map(|found| (found.filter, found.fifo))
    }

    #[test]
    fn the_first_filter_that_matches_decides() {
        let mut ram = MessageRam::default();
        let filters = [
            filter(0, 1, 0x100, 0x10f),
            filter(1, 2, 0x080, 0x200),
            filter(0, 0, 0, 0x7ff),
            filter(3, 1, 0x300, 0x7ff),
            filter(2, 3, 0x105, 0x00f),
            filter(0, 1, 0, 0x7ff),
        ];
        for (number, word) in filters.into_iter().enumerate() {
            ram.put(4 * number, word);
        }
        assert_eq!([0x100, 0x105, 0x10f].map(|id| to(&ram, id)), [Some((0, Some(0))); 3]);
        assert_eq!([0x080, 0x200].map(|id| to(&ram, id)), [Some((1, Some(1))); 2]);
        assert_eq!([0x0f5, 0x215].map(|id| to(&ram, id)), [Some((4, None)); 2]);
        // The sixth is not in use.
        assert_eq!([0x0ff, 0x110, 0x300, 0x7ff].map(|id| to(&ram, id)), [None; 4]);
    }

    #[test]
    fn a_frame_is_laid_out_as_the_manual_has_it() {
        let mut ram = MessageRam::default();
        let frame = CanFrame::of(0x123, &[1, 2, 3, 4, 5]).unwrap();
        ram.store(1, 2, &frame, Some(Match { filter: 7, fifo: Some(1) }));
        let words = [0, 4, 8, 12].map(|offset| ram.at(0x188 + 2 * 72 + offset));
        assert_eq!(words, [0x123 << 18, 7 << 24 | 5 << 16, 0x0403_0201, 0x0000_0005]);
        ram.store(0, 0, &frame, None);
        assert_eq!(ram.at(0x0b4), 1 << 31 | 5 << 16);
        for (offset, word) in (0x278 + 72..).step_by(4).zip(words) {
            ram.put(offset, word);
        }
        let outgoing = ram.outgoing(1).unwrap();
        assert_eq!((outgoing.frame, outgoing.plain), (frame, true));
        ram.put(0x278 + 72, 0x123 << 18 | EXTENDED);
        assert!(!ram.outgoing(1).unwrap().plain);
    }
}
