//! The peripheral as a driver has it, at its registers.

use super::*;
use crate::chips::can::{CanFrame, bits};

const CCCR: u64 = 0x18;
const NBTP: u64 = 0x1c;
const ECR: u64 = 0x40;
const PSR: u64 = 0x44;
const IR: u64 = 0x50;
const RXGFC: u64 = 0x80;
const RXF0S: u64 = 0x90;
const RXF0A: u64 = 0x94;
const RXF1S: u64 = 0x98;
const TXBC: u64 = 0xc0;
const TXFQS: u64 = 0xc4;
const TXBRP: u64 = 0xc8;
const TXBAR: u64 = 0xcc;
const TXBTO: u64 = 0xd4;

/// 1 Mbit/s: 24 quanta of a clock each.
const TIMING: u32 = 2 << 25 | 17 << 8 | 4;
/// Two filters; what matches none is rejected.
const RULES: u32 = 2 << 16 | 0b11_11_11;
/// 11 bits of 24 clocks, after INIT is read back.
const JOINED: u64 = 24 + 11 * 24;
const MICROSECOND: u64 = 24;

struct Board(Fdcan);

impl Board {
    /// With its clock.
    fn new() -> Self {
        let board = Self(Fdcan::on(Arc::default()));
        board.0.enable.0.store(true, Ordering::Relaxed);
        board
    }

    /// Set up for `timing`, and on the bus: identifiers 0x100 to 0x10f go to FIFO 0, 0x80 to FIFO 1.
    fn at_bus(timing: u32) -> Self {
        let board = Self::new();
        board.opens();
        board.write(NBTP, timing);
        board.write(RXGFC, RULES);
        board.ram(0, 1 << 27 | 0x100 << 16 | 0x10f);
        board.ram(4, 2 << 30 | 2 << 27 | 0x080 << 16 | 0x7ff);
        board.write(CCCR, 0);
        board.pass(JOINED);
        board
    }

    fn opens(&self) {
        self.write(CCCR, 1);
        self.pass(MICROSECOND);
        self.write(CCCR, 0b11);
    }

    fn pass(&self, clocks: u64) {
        let time = &self.0.bus.time;
        time.advance_to(time.now() + clocks);
    }

    fn read(&self, offset: u64) -> u32 {
        let mut word = [0; 4];
        self.0.face(Place::Registers).read(offset, &mut word, MemAttrs::DEFAULT).unwrap();
        u32::from_le_bytes(word)
    }

    fn write(&self, offset: u64, word: u32) {
        self.0.face(Place::Registers).write(offset, &word.to_le_bytes(), MemAttrs::DEFAULT).unwrap();
    }

    fn ram(&self, offset: u64, word: u32) {
        self.0.face(Place::Ram).write(offset, &word.to_le_bytes(), MemAttrs::DEFAULT).unwrap();
    }

    fn ram_at(&self, offset: u64) -> u32 {
        let mut word = [0; 4];
        self.0.face(Place::Ram).read(offset, &mut word, MemAttrs::DEFAULT).unwrap();
        u32::from_le_bytes(word)
    }

    fn peer(&self, ids: &[u16]) {
        ids.iter().for_each(|id| self.0.bus.put(frame(*id)));
    }

    /// Requests a frame without data, as a driver does.
    fn sends(&self, id: u16) {
        let element = self.read(TXFQS) >> 16 & 0b11;
        self.ram(0x278 + 72 * u64::from(element), u32::from(id) << 18);
        self.ram(0x278 + 72 * u64::from(element) + 4, 0);
        self.write(TXBAR, 1 << element);
    }

    fn sent(&self) -> Vec<u16> {
        self.0.bus.take().iter().map(CanFrame::number).collect()
    }
}

fn frame(id: u16) -> CanFrame {
    CanFrame::of(id, &[]).unwrap()
}

/// Clocks of a frame without data, and until the next can begin.
fn length() -> u64 {
    24 * bits(&frame(0))
}

fn period() -> u64 {
    length() + 3 * 24
}

#[test]
fn without_its_clock_nothing_is_read_or_written() {
    let board = Board(Fdcan::on(Arc::default()));
    board.ram(0, 1);
    assert_eq!((board.read(4), board.read(CCCR)), (0, 0));
    board.0.enable.0.store(true, Ordering::Relaxed);
    assert_eq!((board.read(4), board.read(CCCR), board.ram_at(0)), (0x8765_4321, 1, 0));
    assert_eq!(board.read(PSR), 0x707);
}

#[test]
fn protected_registers_are_written_while_it_is_open() {
    let board = Board::new();
    let timing = board.read(NBTP);
    board.write(NBTP, TIMING);
    board.write(RXGFC, RULES);
    board.write(TXBC, 1 << 24);
    assert_eq!((board.read(NBTP), board.read(RXGFC), board.read(TXBC)), (timing, 0, 0));
    board.write(CCCR, 0b11 | 0b11 << 8);
    board.write(NBTP, TIMING);
    board.write(CCCR, 0b11 | 0b11 << 8);
    assert_eq!((board.read(NBTP), board.read(CCCR)), (TIMING, 0b11 | 0b11 << 8));
    board.write(CCCR, 0b11);
    board.write(CCCR, 0b10);
    board.write(NBTP, 0);
    board.pass(MICROSECOND);
    assert_eq!((board.read(NBTP), board.read(CCCR)), (TIMING, 0));
}

#[test]
fn init_is_read_back_after_a_while_and_opens_only_then() {
    let board = Board::at_bus(TIMING);
    board.write(CCCR, 1);
    assert_eq!(board.read(CCCR), 0);
    board.write(CCCR, 0b11);
    assert_eq!(board.read(CCCR), 0);
    board.pass(MICROSECOND);
    assert_eq!(board.read(CCCR), 1);
    board.write(CCCR, 0b11);
    assert_eq!(board.read(CCCR), 0b11);
    board.write(CCCR, 0);
    assert_eq!(board.read(CCCR), 1);
    board.pass(MICROSECOND);
    assert_eq!(board.read(CCCR), 0);
}

#[test]
fn frames_go_through_the_filters_in_their_order() {
    let board = Board::at_bus(TIMING);
    board.peer(&[0x10f, 0x110, 0x080, 0x100]);
    board.pass(length() - 1);
    assert_eq!(board.read(RXF0S), 0);
    board.pass(1);
    assert_eq!(board.read(RXF0S), 1 | 1 << 16);
    board.pass(3 * period());
    assert_eq!((board.read(RXF0S), board.read(RXF1S)), (2 | 2 << 16, 1 | 1 << 16));
    assert_eq!(board.read(IR), 1 | 1 << 3);
    let ids = [0x0b0, 0x0b0 + 72, 0x188].map(|place| board.ram_at(place) >> 18);
    assert_eq!(ids, [0x10f, 0x100, 0x080]);
    assert_eq!(board.ram_at(0x18c), 1 << 24);
}

#[test]
fn what_matches_no_filter_goes_where_the_rules_say() {
    let board = Board::at_bus(TIMING);
    board.opens();
    board.write(RXGFC, 2 << 16 | 1 << 4);
    board.write(CCCR, 0);
    board.pass(JOINED);
    board.peer(&[0x7ff]);
    board.pass(period());
    assert_eq!((board.read(RXF0S), board.read(RXF1S), board.ram_at(0x18c)), (0, 1 | 1 << 16, 1 << 31));
}

#[test]
fn a_full_fifo_loses_what_comes_and_acknowledged_has_room_again() {
    let board = Board::at_bus(TIMING);
    board.peer(&[0x100, 0x101, 0x102, 0x103]);
    board.pass(4 * period());
    assert_eq!(board.read(RXF0S), 3 | 1 << 24 | 1 << 25);
    assert_eq!((board.read(IR), board.0.bus.overflows()), (0b111, 1));
    board.write(IR, 0b100);
    board.write(RXF0A, 1);
    assert_eq!(board.read(RXF0S), 1 | 2 << 8);
    board.peer(&[0x104]);
    board.pass(period());
    assert_eq!(board.read(RXF0S), 2 | 2 << 8 | 1 << 16);
    assert_eq!([0x0b0, 0x0b0 + 144].map(|place| board.ram_at(place) >> 18), [0x104, 0x102]);
    board.write(RXF0A, 1);
    assert_eq!(board.read(RXF0S) & 0xf, 2);
}

#[test]
fn frames_are_sent_in_the_order_of_their_requests_each_in_its_time() {
    let board = Board::at_bus(TIMING);
    [0x300, 0x200, 0x100].iter().for_each(|id| board.sends(*id));
    assert_eq!((board.read(TXFQS), board.read(TXBRP)), (1 << 21, 0b111));
    board.pass(length() - 1);
    assert!(board.sent().is_empty());
    board.pass(1);
    assert_eq!(board.sent(), [0x300]);
    assert_eq!((board.read(TXFQS), board.read(TXBRP), board.read(TXBTO)), (1 | 1 << 8, 0b110, 0b001));
    board.pass(2 * period());
    assert_eq!(board.sent(), [0x200, 0x100]);
    assert_eq!((board.read(TXFQS), board.read(TXBTO), board.read(IR)), (3, 0b111, 1 << 9));
    board.sends(0x101);
    assert_eq!((board.read(TXBRP), board.read(TXBTO)), (0b001, 0b110));
}

#[test]
fn an_element_out_of_turn_is_not_requested() {
    let board = Board::at_bus(TIMING);
    board.write(TXBAR, 0b110);
    assert_eq!(board.read(TXBRP), 0);
    board.write(TXBAR, 0b101);
    assert_eq!(board.read(TXBRP), 0b001);
}

#[test]
fn the_lower_identifier_goes_first() {
    for (id, first, then) in [(0x081, (1, vec![]), (1, vec![0x081])), (0x07f, (0, vec![0x07f]), (1, vec![]))]
    {
        let board = Board::at_bus(TIMING);
        board.peer(&[0x7ff, 0x080]);
        board.sends(id);
        board.pass(2 * period());
        assert_eq!((board.read(RXF1S) & 0xf, board.sent()), first);
        board.pass(period());
        assert_eq!((board.read(RXF1S) & 0xf, board.sent()), then);
    }
}

#[test]
fn without_an_answer_a_frame_stays_and_errors_are_counted() {
    let board = Board::at_bus(TIMING);
    board.0.bus.answers(false);
    board.sends(0x100);
    board.pass(2 * period());
    assert_eq!((board.read(ECR), board.read(TXBRP), board.read(TXBTO)), (16, 1, 0));
    assert_eq!((board.read(PSR) & 7, board.read(PSR) & 7), (3, 7));
    board.pass(100 * period());
    assert_eq!((board.read(ECR), board.read(PSR)), (128, 0x700 | 3 | 1 << 5 | 1 << 6));
    board.0.bus.answers(true);
    board.pass(period());
    assert_eq!((board.sent(), board.read(ECR), board.read(TXBRP)), (vec![0x100], 127, 0));
}

#[test]
fn at_another_rate_nothing_is_exchanged() {
    // A quantum less, a prescaler of 2, a segment of its register's value, out of reset.
    for timing in [TIMING - 1, TIMING | 1 << 16, 2 << 25 | 18 << 8 | 5, 0x0600_0a03] {
        let board = Board::at_bus(timing);
        board.pass(JOINED);
        board.peer(&[0x100]);
        board.sends(0x100);
        board.pass(10 * period());
        assert_eq!((board.read(RXF0S), board.read(TXBRP), board.sent()), (0, 1, vec![]), "{timing:#x}");
    }
}

#[test]
fn a_slower_quantum_with_fewer_of_them_is_the_same_rate() {
    let board = Board::at_bus(1 << 16 | 7 << 8 | 2);
    board.sends(0x100);
    board.pass(length());
    assert_eq!(board.sent(), [0x100]);
}

#[test]
fn frames_of_other_kinds_are_not_acknowledged() {
    let board = Board::at_bus(TIMING);
    board.ram(0x278, 1 << 30);
    board.write(TXBAR, 1);
    board.pass(2 * period());
    assert_eq!((board.read(TXBRP), board.sent()), (1, vec![]));
}

#[test]
fn stopped_it_neither_hears_nor_sends_and_keeps_what_was_requested() {
    let board = Board::at_bus(TIMING);
    board.peer(&[0x100]);
    board.pass(length() / 2);
    board.write(CCCR, 1);
    board.sends(0x100);
    board.pass(2 * period());
    assert_eq!((board.read(RXF0S), board.read(TXBRP), board.sent()), (0, 1, vec![]));
    board.write(CCCR, 0);
    board.pass(JOINED + length());
    assert_eq!((board.read(TXBRP), board.sent()), (0, vec![0x100]));
    board.sends(0x101);
    board.pass(length() / 2);
    board.opens();
    assert_eq!((board.read(TXBRP), board.read(TXBTO)), (0, 0));
    board.write(CCCR, 0);
    board.pass(JOINED + period());
    assert!(board.sent().is_empty());
}

#[test]
fn off_the_bus_it_is_back_after_the_recovery_that_the_driver_begins() {
    let board = Board::at_bus(TIMING);
    board.sends(0x100);
    board.0.bus.set_bus_off();
    board.pass(100 * period());
    assert_eq!((board.read(CCCR), board.read(PSR) >> 7 & 1, board.read(IR)), (1, 1, 1 << 19));
    assert!(board.sent().is_empty());
    board.write(CCCR, 0);
    board.pass(MICROSECOND + 129 * 11 * 24 - 1);
    assert_eq!((board.read(CCCR), board.read(PSR) >> 7 & 1), (0, 1));
    board.pass(1);
    assert_eq!((board.read(PSR) >> 5 & 0b111, board.read(ECR)), (0, 0));
    board.pass(length());
    assert_eq!(board.sent(), [0x100]);
}

#[test]
fn a_reset_stops_it_and_keeps_the_message_ram() {
    let board = Board::at_bus(TIMING);
    board.sends(0x100);
    board.0.reset(ResetKind::Cold);
    board.pass(2 * period());
    assert_eq!((board.read(CCCR), board.read(TXBRP), board.sent()), (1, 0, vec![]));
    assert_eq!(board.ram_at(0x278), 0x100 << 18);
}
