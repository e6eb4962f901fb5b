//! The period of the SYNCs: the master's has to be that of object 0x60c2.

use super::*;

/// A node in operation enabled that only another period can take out of it soon.
fn patient() -> Node {
    let mut node = Params { timeout: 1000, ..PARAMS }.build().unwrap();
    node.read(&MOVES, true);
    node.receive(&nmt(1));
    sent(&mut node);
    for word in [0x06, 0x07, 0x0f] {
        command(&mut node, word);
    }
    node
}

/// After how many of these intervals with new data the joint brakes, if it does.
fn brakes_after(node: &mut Node, intervals: impl IntoIterator<Item = u32>) -> Option<usize> {
    let brakes = |periods| {
        ticks(node, periods);
        command(node, 0x0f);
        node.wanted() == Wanted::Brake
    };
    intervals.into_iter().map(brakes).position(|brakes| brakes)
}

#[test]
fn the_period_with_jitter_is_kept() {
    let mut node = patient();
    // Early and late by up to half of the period, and one SYNC in four missing.
    let intervals = [20, 11, 29, 30, 10, 20, 40, 15, 10, 40, 25];
    assert_eq!(brakes_after(&mut node, intervals.into_iter().cycle().take(5000)), None);
    assert_eq!(brakes_after(&mut node, [11; 1000]), None);
    assert_eq!(brakes_after(&mut node, [30; 1000]), None);
}

#[test]
fn another_period_is_a_loss_of_the_bus() {
    for interval in [2 * PERIOD, 3 * PERIOD, 10 * PERIOD, PERIOD / 2, 1, 31] {
        let mut node = patient();
        assert_eq!(brakes_after(&mut node, [interval; 10]), Some(4), "{interval}");
        let mut node = patient();
        ticks(&mut node, PERIOD);
        for _ in 0..5 {
            node.receive(&rpdo1(0x0f, POSITION, 0));
            node.receive(&sync());
            ticks(&mut node, interval);
        }
        assert_eq!((node.wanted(), sent_as(&mut node, 0x085)), (Wanted::On, None), "{interval}");
        node.receive(&sync());
        assert_eq!((node.wanted(), node.target()), (Wanted::Brake, None), "{interval}");
        assert_eq!(sent_as(&mut node, 0x085).unwrap(), [0x00, 0x87, 0x11, 0, 0, 0, 0, 0], "{interval}");
    }
}

#[test]
fn four_bad_intervals_in_a_row_are_not_enough() {
    let mut node = patient();
    let intervals = [3 * PERIOD, 3 * PERIOD, 1, 1, PERIOD];
    assert_eq!(brakes_after(&mut node, intervals.into_iter().cycle().take(1000)), None);
}

#[test]
fn intervals_count_in_operation_enabled_only() {
    let mut node = patient();
    assert_eq!(brakes_after(&mut node, [3 * PERIOD; 4]), None);
    ticks(&mut node, PERIOD);
    for word in [0x07, 0x07, 0x07, 0x07, 0x07, 0x07, 0x0f] {
        command(&mut node, word);
        ticks(&mut node, 3 * PERIOD);
    }
    assert_eq!(brakes_after(&mut node, [0, 3 * PERIOD, 3 * PERIOD, 3 * PERIOD, 3 * PERIOD]), Some(4));
}

#[test]
fn the_period_is_that_of_its_object() {
    let mut node = Params { timeout: 1000, ..PARAMS }.build().unwrap();
    node.read(&MOVES, true);
    node.receive(&frame(0x605, &[0x2f, 0xc2, 0x60, 1, 3, 0, 0, 0]));
    node.receive(&nmt(1));
    for word in [0x06, 0x07, 0x0f] {
        command(&mut node, word);
    }
    assert_eq!(brakes_after(&mut node, [3 * PERIOD; 100]), None);
    assert_eq!(brakes_after(&mut node, [PERIOD; 100]), Some(4));
}
