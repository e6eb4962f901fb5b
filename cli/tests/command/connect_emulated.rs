//! `connect` end to end: firmware in the emulator serves its link, a plant at work behind it, a flash that outlives it.

use std::os::unix::net::UnixStream;
use std::thread;
use std::time::{Duration, Instant};

use strainwave::compensator::{Faults, Mode, Status};
use strainwave_desktop::GearFile;
use strainwave_emulator::served::ServedBoard;
use strainwave_emulator::setup::{self, ThisHost};
use strainwave_service::tuning::client::{Client, Patience};
use strainwave_service::tuning::{Function, QUANTITIES, Reading, StoreState};

use crate::bench::Bench;

/// The machine has an emulator and the boards' compiler: a test installs neither.
fn is_set_up() -> bool {
    let target = strainwave_emulator::firmware::target("mps2-an386").unwrap();
    let present =
        setup::present_emulator(&ThisHost).is_some() && setup::present_compiler(&ThisHost, &target).is_some();
    if !present {
        println!("skipped: no emulator or no cross target");
    }
    present
}

fn connected(board: &ServedBoard) -> Client<UnixStream> {
    let stream = UnixStream::connect(board.socket()).unwrap();
    stream.set_read_timeout(Some(Duration::from_millis(10))).unwrap();
    // A busy machine gives the emulator little time.
    let patience = Patience { answer: Duration::from_secs(3), flash: Duration::from_secs(10), tries: 4 };
    Client::connect(stream, patience).unwrap()
}

fn float(reading: &Reading, name: &str) -> f32 {
    reading.floats()[QUANTITIES.iter().position(|(other, _)| *other == name).unwrap()]
}

/// Readings of the stream until one is as wanted, which must come within a minute.
fn wait_for(client: &mut Client<UnixStream>, wanted: impl Fn(&Reading) -> bool) -> Reading {
    let begun = Instant::now();
    loop {
        client.keep_alive().unwrap();
        let reading = client.next_reading(Duration::from_millis(100)).unwrap();
        if let Some(reading) = reading.filter(&wanted) {
            return reading;
        }
        assert!(begun.elapsed() < Duration::from_secs(60), "no such reading has come: {reading:?}");
    }
}

#[test]
fn gains_faults_and_store_of_an_emulated_board() {
    if !is_set_up() {
        return;
    }
    let bench = Bench::new();
    let (gear, flash) = (GearFile::default_gear(), bench.path("flash.bin"));
    let board = ServedBoard::start(&gear, Some(&flash)).unwrap();
    let mut client = connected(&board);
    assert_eq!((client.joint().gear(), client.joint().store), ("hd25-100", StoreState::Empty));
    assert_eq!(client.read().unwrap().mode(), Mode::Active);

    // Without any feed-forward its torque is none: soon, and as long as the host is heard.
    client.stream(100).unwrap();
    let feed_forward = |reading: &Reading| float(reading, "feed_forward_torque").abs();
    wait_for(&mut client, |reading| feed_forward(reading) > 0.02);
    let functions = Function::ALL.into_iter().filter(|function| *function != Function::Feedback);
    for function in functions {
        client.set_gain(function, [0.0; 2]).unwrap();
    }
    assert_eq!(client.gains().unwrap(), *client.trial());
    wait_for(&mut client, |reading| feed_forward(reading) == 0.0);
    for _ in 0..50 {
        wait_for(&mut client, |reading| feed_forward(reading) == 0.0 && reading.mode().drives());
    }
    client.stream(0).unwrap();
    // On a busy machine a second of the joint takes longer.
    let back = [2, 4, 8, 16].into_iter().any(|seconds| {
        thread::sleep(Duration::from_secs(seconds));
        client.gains().unwrap() != *client.trial()
    });
    assert!(back, "the joint's own gains do not come back");
    drop(client);
    let mut client = connected(&board);
    client.stream(100).unwrap();
    wait_for(&mut client, |reading| feed_forward(reading) > 0.02);

    board.report(Status::RESTARTED);
    let safe = wait_for(&mut client, |reading| reading.mode() == Mode::Safe);
    assert!(safe.faults().contains(Faults::RESTARTED));
    client.reset().unwrap();
    wait_for(&mut client, |reading| reading.mode() == Mode::Active);

    // What it learns after some moves is kept over a restart.
    wait_for(&mut client, |reading| (float(reading, "inertia_factor") - 1.0).abs() > 0.01);
    client.stream(0).unwrap();
    assert_eq!(client.keep().unwrap(), 1);
    let (_, kept) = client.stored().unwrap();
    drop(client);
    let ending = board.end().unwrap();
    assert!(ending.stack < 32_768, "{}", ending.stack);

    let board = ServedBoard::start(&gear, Some(&flash)).unwrap();
    let mut client = connected(&board);
    assert_eq!(client.joint().store, StoreState::Sound);
    assert_eq!(client.stored().unwrap(), (1, kept));
    let off = |inertia: f32| (inertia - kept.factors.inertia).abs();
    let started = client.learnt().unwrap().factors.inertia;
    assert!(off(started) < off(1.0), "{started} does not start from {}", kept.factors.inertia);
    client.erase().unwrap();
    assert_eq!(client.hello().unwrap().store, StoreState::Empty);
}

#[test]
fn the_command_tries_an_emulated_board() {
    if !is_set_up() {
        return;
    }
    let bench = Bench::new();
    let words = "connect emulated:flash.bin --set friction=0.5 --seconds 0.5 --rate 20 --keep --log out.csv";
    let answer = bench.run(words);
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", answer.output);
    assert!(answer.output.starts_with("emulated:flash.bin: hd25-100, joint "), "{}", answer.output);
    assert!(answer.output.ends_with("\nkept: record 1\n") && answer.output.contains(" mode=active faults="));
    assert!(std::fs::read_to_string(bench.path("out.csv")).unwrap().lines().count() > 5);
    let answer = bench.run("connect emulated:flash.bin --stored");
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", answer.output);
    assert!(answer.output.contains("\nstored: record 1\n    compliance = "), "{}", answer.output);

    // Another joint's store is neither read nor written, until it is erased.
    let other = std::fs::read_to_string(bench.path("g.toml")).unwrap();
    bench.write("other.toml", other.replacen("coulomb_nm = 0.035", "coulomb_nm = 0.03", 1));
    let answer = bench.run("connect emulated:flash.bin --gear other.toml --keep");
    let expected =
        "error: emulated:flash.bin: the joint has refused \"keep\": the store is another joint's\n";
    assert_eq!((answer.code, answer.error.as_str()), (Some(2), expected), "{}", answer.output);
    bench.write("short.bin", "no flash");
    let line = bench.refused("connect emulated:short.bin");
    assert!(line.ends_with("short.bin: is no flash of the emulated board, which has 8192 bytes"), "{line}");
}
