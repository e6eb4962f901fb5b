//! The SDO server: values, writes, refusals.

use super::*;
use crate::cia402::node::objects::error_register;

/// The answer to a request.
pub(super) fn ask(node: &mut Node, request: [u8; 8]) -> [u8; 8] {
    let own = node.node;
    node.receive(&frame(0x600 | own, &request));
    sent_as(node, 0x580 | own).unwrap().try_into().unwrap()
}

pub(super) fn request(command: u8, index: u16, subindex: u8, data: u32) -> [u8; 8] {
    let ([i0, i1], [d0, d1, d2, d3]) = (index.to_le_bytes(), data.to_le_bytes());
    [command, i0, i1, subindex, d0, d1, d2, d3]
}

/// Size in bytes and value, or the abort code.
pub(super) fn read(node: &mut Node, index: u16, subindex: u8) -> Result<(u8, u32), u32> {
    let [command, i0, i1, sub, d0, d1, d2, d3] = ask(node, request(0x40, index, subindex, 0));
    assert_eq!((u16::from_le_bytes([i0, i1]), sub), (index, subindex));
    let data = u32::from_le_bytes([d0, d1, d2, d3]);
    match command {
        0x4f => Ok((1, data)),
        0x4b => Ok((2, data)),
        0x43 => Ok((4, data)),
        0x80 => Err(data),
        _ => panic!("{command:#x}"),
    }
}

/// Writes that many bytes.
pub(super) fn write(node: &mut Node, index: u16, subindex: u8, size: u8, data: u32) -> Result<(), u32> {
    let answer = ask(node, request(0x23 | (4 - size) << 2, index, subindex, data));
    if answer == request(0x60, index, subindex, 0) {
        return Ok(());
    }
    let [d0, d1, d2, d3] = [answer[4], answer[5], answer[6], answer[7]];
    let code = u32::from_le_bytes([d0, d1, d2, d3]);
    assert_eq!(answer, request(0x80, index, subindex, code));
    Err(code)
}

#[test]
fn objects_have_their_size_and_value() {
    let mut node = enabled();
    cycle(&mut node, &[rpdo1(0x0f, TORQUE, -3), rpdo2(-4, -5)], &MOVES);
    node.read(&MOVES, true);
    let table = [
        (0x1000, 0, 4, 0x0002_0192),
        (0x1001, 0, 1, 0),
        (0x1005, 0, 4, 0x80),
        (0x1014, 0, 4, 0x85),
        (0x1016, 0, 1, 1),
        (0x1016, 1, 4, 0),
        (0x1017, 0, 2, 100),
        (0x1018, 0, 1, 4),
        (0x1018, 1, 4, 0),
        (0x1018, 2, 4, 0x10),
        (0x1018, 3, 4, 0x20),
        (0x1018, 4, 4, 0x30),
        (0x1400, 0, 1, 2),
        (0x1400, 1, 4, 0x205),
        (0x1400, 2, 1, 1),
        (0x1401, 0, 1, 2),
        (0x1401, 1, 4, 0x305),
        (0x1401, 2, 1, 1),
        (0x1600, 0, 1, 3),
        (0x1600, 1, 4, 0x6040_0010),
        (0x1600, 2, 4, 0x6060_0008),
        (0x1600, 3, 4, 0x607a_0020),
        (0x1601, 0, 1, 2),
        (0x1601, 1, 4, 0x60ff_0020),
        (0x1601, 2, 4, 0x6071_0010),
        (0x1800, 0, 1, 2),
        (0x1800, 1, 4, 0x4000_0185),
        (0x1800, 2, 1, 1),
        (0x1801, 0, 1, 2),
        (0x1801, 1, 4, 0x4000_0285),
        (0x1801, 2, 1, 1),
        (0x1a00, 0, 1, 3),
        (0x1a00, 1, 4, 0x6041_0010),
        (0x1a00, 2, 4, 0x6061_0008),
        (0x1a00, 3, 4, 0x6064_0020),
        (0x1a01, 0, 1, 2),
        (0x1a01, 1, 4, 0x606c_0020),
        (0x1a01, 2, 4, 0x6077_0010),
        (0x603f, 0, 2, 0),
        (0x6040, 0, 2, 0x0f),
        (0x6041, 0, 2, 0x1237),
        (0x6060, 0, 1, 10),
        (0x6061, 0, 1, 10),
        (0x6064, 0, 4, 1_000_000),
        (0x606c, 0, 4, -2000_i32 as u32),
        (0x6071, 0, 2, u32::from(-5_i16 as u16)),
        (0x6076, 0, 4, 50_000),
        (0x6077, 0, 2, 250),
        (0x607a, 0, 4, -3_i32 as u32),
        (0x608f, 0, 1, 2),
        (0x608f, 1, 4, 1 << 26),
        (0x608f, 2, 4, 1),
        (0x60c2, 0, 1, 2),
        (0x60c2, 1, 1, 1),
        (0x60c2, 2, 1, 0xfd),
        (0x60ff, 0, 4, -4_i32 as u32),
        (0x6502, 0, 4, 0x380),
    ];
    for (index, subindex, size, value) in table {
        assert_eq!(read(&mut node, index, subindex), Ok((size, value)), "{index:#x}:{subindex}");
    }
    // Nothing else is there, and what is there is known by its index.
    for index in 0..=u16::MAX {
        let known = table.iter().filter(|row| row.0 == index).count() as u8;
        let absent = if known == 0 { 0x0602_0000 } else { 0x0609_0011 };
        assert_eq!(read(&mut node, index, known), Err(absent), "{index:#x}:{known}");
        assert_eq!(read(&mut node, index, 255), Err(absent), "{index:#x}");
    }
}

#[test]
fn writes_are_kept_and_reset_by_nmt() {
    let mut node = Params { timeout: 160, ..PARAMS }.build().unwrap();
    for (index, subindex, size, value, default) in [
        (0x1016, 1, 4, 0x007f_03e8, 0),
        (0x1017, 0, 2, 250, 100),
        (0x6060, 0, 1, 9, 0),
        (0x60c2, 1, 1, 4, 1),
        (0x60c2, 2, 1, 0xfc, 0xfd),
    ] {
        assert_eq!(read(&mut node, index, subindex), Ok((size, default)));
        assert_eq!(write(&mut node, index, subindex, size, value), Ok(()));
        assert_eq!(read(&mut node, index, subindex), Ok((size, value)));
        // The size need not be told; what is behind it does not count.
        if size < 4 {
            let junk = 0x5a00_0000 | value;
            assert_eq!(ask(&mut node, request(0x22, index, subindex, junk))[0], 0x60);
            assert_eq!(read(&mut node, index, subindex), Ok((size, value)));
        }
    }
    assert_eq!(read(&mut node, 0x6061, 0), Ok((1, 9)));
    assert_eq!(node.period(), 8);
    node.receive(&nmt(0x82));
    assert_eq!(read(&mut node, 0x1016, 1), Ok((4, 0)));
    assert_eq!(read(&mut node, 0x1017, 0), Ok((2, 100)));
    assert_eq!(read(&mut node, 0x6060, 0), Ok((1, 0)));
    assert_eq!(node.period(), 20);
    node.receive(&nmt(1));
    command(&mut node, 0x06);
    node.receive(&nmt(0x81));
    assert_eq!(read(&mut node, 0x6040, 0), Ok((2, 0)));
}

#[test]
fn writes_are_refused_by_name() {
    let mut node = PARAMS.build().unwrap();
    for (index, subindex, size, value, abort) in [
        (0x2000, 0, 4, 0, 0x0602_0000),
        (0x1017, 1, 2, 0, 0x0609_0011),
        (0x1000, 0, 4, 0, 0x0601_0002),
        (0x1000, 0, 1, 0, 0x0601_0002),
        (0x6040, 0, 2, 0x0f, 0x0601_0002),
        (0x607a, 0, 4, 0, 0x0601_0002),
        (0x1016, 0, 1, 1, 0x0601_0002),
        (0x1017, 0, 4, 100, 0x0607_0010),
        (0x1017, 0, 1, 100, 0x0607_0010),
        (0x6060, 0, 2, 8, 0x0607_0010),
        (0x6060, 0, 1, 0, 0x0609_0030),
        (0x6060, 0, 1, 1, 0x0609_0030),
        (0x6060, 0, 1, 0xf8, 0x0609_0030),
        (0x1016, 1, 4, 0x0080_0064, 0x0609_0030),
        (0x1016, 1, 4, 0x0100_0064, 0x0609_0030),
        (0x1016, 1, 4, 0x0005_0064, 0x0609_0030),
        // Two periods of 2 ms are longer than the time-out. 51 ms, 0 ms; 1 s, 50 us, 1000 s.
        (0x60c2, 1, 1, 2, 0x0609_0030),
        (0x60c2, 1, 1, 51, 0x0609_0030),
        (0x60c2, 1, 1, 0, 0x0609_0030),
        (0x60c2, 2, 1, 0, 0x0609_0030),
        (0x60c2, 2, 1, 0xfb, 0x0609_0030),
        (0x60c2, 2, 1, 3, 0x0609_0030),
    ] {
        let refused = write(&mut node, index, subindex, size, value);
        assert_eq!(refused, Err(abort), "{index:#x}:{subindex} {value:#x}");
    }
    assert_eq!(node.period(), 20);
    node.receive(&nmt(1));
    assert_eq!(write(&mut node, 0x60c2, 1, 1, 2), Err(0x0800_0022));
    assert_eq!(write(&mut node, 0x1017, 0, 2, 50), Ok(()));
}

#[test]
fn periods_are_whole_numbers_of_control_periods() {
    let mut node = Params { rate: 8000, timeout: 2000, ..PARAMS }.build().unwrap();
    for (object, value, expected) in [
        (1, 125, Ok(1000)),
        (1, 126, Err(1000)),
        (1, 25, Ok(200)),
        (2, 0xfc, Ok(20)),
        (2, 0xfb, Ok(2)),
        // 260 us are 2.08 periods of 125 us.
        (1, 26, Err(2)),
        (1, 50, Ok(4)),
    ] {
        let written = write(&mut node, 0x60c2, object, 1, value);
        assert_eq!(written.map(|()| node.period()).map_err(|_| node.period()), expected, "{value}");
    }
}

#[test]
fn other_transfers_are_refused_and_aborts_not_answered() {
    let mut node = PARAMS.build().unwrap();
    sent(&mut node);
    // Segments, blocks, the begin of a segmented write.
    for command in [0x00, 0x60, 0xa0, 0xc2, 0xe0, 0x21, 0x20] {
        let answer = ask(&mut node, request(command, 0x1017, 0, 0));
        assert_eq!(answer, request(0x80, 0x1017, 0, 0x0504_0001), "{command:#x}");
    }
    node.receive(&frame(0x605, &request(0x80, 0x1017, 0, 0x0504_0000)));
    assert_eq!(sent(&mut node), []);
    node.receive(&nmt(2));
    node.receive(&frame(0x605, &request(0x40, 0x1017, 0, 0)));
    node.receive(&nmt(0x80));
    assert_eq!(sent(&mut node), []);
    node.receive(&frame(0x605, &request(0x40, 0x1017, 0, 0)));
    node.receive(&nmt(2));
    assert_eq!(sent(&mut node), []);
}

#[test]
fn errors_are_told_by_code_and_kind() {
    let mut node = started();
    node.read(&Actual { fault: 0x2310, ..MOVES }, true);
    assert_eq!(read(&mut node, 0x603f, 0), Ok((2, 0x2310)));
    assert_eq!(read(&mut node, 0x1001, 0), Ok((1, 0x03)));
    for (code, register) in [
        (0, 0x00),
        (0x1000, 0x01),
        (0x2310, 0x03),
        (0x3210, 0x05),
        (0x4310, 0x09),
        (0x7305, 0x01),
        (0x8130, 0x11),
        (0x8250, 0x11),
        (0x8700, 0x11),
        (0x8611, 0x01),
        (0xff01, 0x81),
    ] {
        assert_eq!(error_register(code), register, "{code:#x}");
    }
}

#[test]
fn fixed_objects_take_the_value_that_they_have() {
    for state in [0x80, 1] {
        let mut node = PARAMS.build().unwrap();
        node.receive(&nmt(state));
        for (index, count) in [(0x1400, 2), (0x1401, 2), (0x1800, 2), (0x1801, 2)] {
            assert_eq!(write(&mut node, index, 0, 1, 2), Err(0x0601_0002));
            confirm(&mut node, index, 1..=count);
        }
        for (index, count) in [(0x1600, 3), (0x1601, 2), (0x1a00, 3), (0x1a01, 2)] {
            confirm(&mut node, index, 0..=count);
        }
        confirm(&mut node, 0x1005, 0..=0);
        confirm(&mut node, 0x1014, 0..=0);
    }
}

/// These subindices take their own value, by each length that a master may tell, and no other.
fn confirm(node: &mut Node, index: u16, subindices: core::ops::RangeInclusive<u8>) {
    for subindex in subindices {
        let (size, value) = read(node, index, subindex).unwrap();
        assert_eq!(write(node, index, subindex, size, value), Ok(()), "{index:#x}:{subindex}");
        assert_eq!(ask(node, request(0x22, index, subindex, value))[0], 0x60, "{index:#x}:{subindex}");
        for other in [value ^ 1, value ^ 0x40] {
            assert_eq!(write(node, index, subindex, size, other), Err(0x0609_0030), "{index:#x}:{subindex}");
        }
        assert_eq!(read(node, index, subindex), Ok((size, value)));
    }
}

#[test]
fn a_master_that_configures_pdos_as_they_are_succeeds() {
    let mut node = PARAMS.build().unwrap();
    for (parameter, mapping) in [(0x1400, 0x1600), (0x1401, 0x1601), (0x1800, 0x1a00), (0x1801, 0x1a01)] {
        let (_, identifier) = read(&mut node, parameter, 1).unwrap();
        let (_, count) = read(&mut node, mapping, 0).unwrap();
        assert_eq!(write(&mut node, parameter, 1, 4, identifier | 1 << 31), Ok(()));
        assert_eq!(write(&mut node, parameter, 2, 1, 1), Ok(()));
        assert_eq!(write(&mut node, mapping, 0, 1, 0), Ok(()));
        for subindex in 1..=count as u8 {
            let (_, entry) = read(&mut node, mapping, subindex).unwrap();
            assert_eq!(write(&mut node, mapping, subindex, 4, entry), Ok(()));
        }
        assert_eq!(write(&mut node, mapping, 0, 1, count), Ok(()));
        assert_eq!(write(&mut node, parameter, 1, 4, identifier), Ok(()));
        assert_eq!(write(&mut node, parameter, 1, 4, 1 << 31), Err(0x0609_0030));

        // PDOs that are exchanged cannot be disabled.
        node.receive(&nmt(1));
        assert_eq!(write(&mut node, parameter, 1, 4, identifier | 1 << 31), Err(0x0800_0022));
        assert_eq!(write(&mut node, mapping, 0, 1, 0), Err(0x0800_0022));
        node.receive(&nmt(0x80));
    }
    assert_eq!(write(&mut node, 0x1014, 0, 4, 0x8000_0085), Err(0x0609_0030));
}
