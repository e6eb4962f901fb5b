//! `connect`: the command against a simulated joint that serves its link.

use std::fs;
use std::io::{Read as _, Write as _};
use std::os::unix::net::UnixListener;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use strainwave::compensator::{Mode, Status};
use strainwave_desktop::GearFile;
use strainwave_service::tuning::frame::Sealed;
use strainwave_service::tuning::{Function, Order, Refusal, Reply, Trial, VERSION};

use crate::bench::{Answer, Bench, GEAR};
use crate::served::Served;

/// A bench with a joint at `unix:joint`.
fn bench() -> (Bench, Served) {
    let bench = Bench::new();
    let served = Served::at_unix(&bench.path("joint"));
    (bench, served)
}

fn ran(bench: &Bench, words: &str) -> Answer {
    let answer = bench.run(&format!("connect {words}"));
    assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{words}: {}", answer.output);
    answer
}

/// One line, and exit code 2.
fn refused(bench: &Bench, words: &str) -> String {
    let answer = bench.run(&format!("connect {words}"));
    assert_eq!((answer.code, answer.error.lines().count()), (Some(2), 1), "{words}: {}", answer.error);
    answer.error.trim_end().to_owned()
}

fn value(bench: &Bench, name: &str) -> f64 {
    let figures = bench.figures("out.json");
    let named = |figure: &&serde_json::Value| figure["name"] == format!("connect.{name}");
    figures.iter().find(named).unwrap_or_else(|| panic!("{name}"))["value"].as_f64().unwrap()
}

#[test]
fn readings_are_shown_logged_and_drawn() {
    let (bench, _served) = bench();
    let words =
        "unix:joint --gear g.toml --seconds 1 --rate 50 --log out.csv --plot new/page.html --json out.json";
    let answer = ran(&bench, words);
    let lines: Vec<_> = answer.output.lines().collect();
    assert!(
        lines[0].starts_with("unix:joint: hd25-100, joint ")
            && lines[0].ends_with(", control 10000 Hz, nothing is stored")
    );
    assert!(lines[1].starts_with("t_s=0 mode=active faults=none motor_reference_rad="), "{}", lines[1]);
    assert!(lines[1].contains(" inertia_factor=1 ") && lines[1].contains(" torsion_deviation_rad="));
    let count = value(&bench, "readings");
    // On a busy machine some are left out.
    assert!((20.0..=51.0).contains(&count) && count + value(&bench, "missing") >= 45.0, "{count}");
    assert_eq!((lines.len() as f64, value(&bench, "last.inertia_factor")), (count + 2.0, 1.0));
    let log = fs::read_to_string(bench.path("out.csv")).unwrap();
    let header = log.lines().next().unwrap();
    assert!(
        header.starts_with("t_s,mode,faults,motor_reference_rad,output_position_rad,motor_torque_nm,"),
        "{header}"
    );
    assert_eq!(log.lines().count() as f64, count + 1.0);
    let last: f64 = log.lines().last().unwrap().split(',').next().unwrap().parse().unwrap();
    assert!((0.9..=1.0).contains(&last), "{last}");
    let page = fs::read_to_string(bench.path("new/page.html")).unwrap();
    assert!(page.contains("Readings of hd25-100") && page.contains("transmitted torque"));
}

#[test]
fn gains_are_in_force_while_the_command_runs() {
    let (bench, served) = bench();
    let answer = ran(
        &bench,
        "unix:joint --set friction=0.25,0.5 --set inertia=0 --hold --seconds 1.5 --json out.json",
    );
    let gains = served.joint().gains;
    assert_eq!((gains.forward.friction, gains.backward.friction, gains.forward.inertia), (0.25, 0.5, 0.0));
    assert!(
        answer.output.contains("\ngains: inertia 0; friction 0.25 forward, 0.5 backward\n"),
        "{}",
        answer.output
    );
    assert!(!answer.output.contains("t_s="), "nothing is shown");
    let friction = Trial::NONE.with(Function::Friction, [0.25, 0.5]).unwrap();
    let both = friction.with(Function::Inertia, [0.0; 2]).unwrap();
    let tried: Vec<_> =
        served.joint().did.iter().filter(|order| matches!(order, Order::Try(_))).copied().collect();
    assert_eq!(tried, [Order::Try(friction), Order::Try(both)]);
    let begun = Instant::now();
    while served.joint().gains.forward.friction != 0.8 {
        assert!(begun.elapsed() < Duration::from_secs(10), "the joint's own gains do not come back");
        thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn faults_are_shown_and_reset() {
    let (bench, served) = bench();
    served.joint().status = Status::RESTARTED;
    let answer = ran(&bench, "unix:joint --seconds 0.1");
    assert!(answer.output.contains("t_s=0 mode=safe faults=restarted "), "{}", answer.output);
    let answer = ran(&bench, "unix:joint --reset");
    assert!(answer.output.ends_with("\nreset\n"), "{}", answer.output);
    ran(&bench, "unix:joint --seconds 0.1 --json out.json");
    assert_eq!(value(&bench, "last.mode"), f64::from(Mode::Active.code()));
}

#[test]
fn what_was_learnt_is_kept_told_and_erased() {
    let (bench, served) = bench();
    assert_eq!(
        refused(&bench, "unix:joint --stored"),
        "error: unix:joint: the joint has refused \"stored\": nothing is stored"
    );
    let answer = ran(&bench, "unix:joint --keep --stored --json out.json");
    assert!(
        answer.output.contains("\nkept: record 1\nstored: record 1\n    compliance = 1.0\n"),
        "{}",
        answer.output
    );
    assert_eq!(
        (value(&bench, "kept"), value(&bench, "stored.record"), value(&bench, "stored.inertia")),
        (1.0, 1.0, 1.0)
    );
    assert!(served.joint().kept.is_some());
    let answer = ran(&bench, "unix:joint --erase");
    assert!(
        answer.output.contains("the store is in use\nerased\n") && served.joint().kept.is_none(),
        "{}",
        answer.output
    );
    let words = "unix:joint --gear g.toml --learnt-to kept.toml";
    assert!(ran(&bench, words).output.ends_with("\nlearnt: kept.toml\n"));
    let kept = fs::read_to_string(bench.path("kept.toml")).unwrap();
    assert!(kept.starts_with(GEAR) && GearFile::read(&bench.path("kept.toml")).unwrap().learnt.is_some());
    served.joint().may_write = false;
    let line = refused(&bench, "unix:joint --keep");
    assert!(line.contains("the joint has refused \"keep\": the drive is on"), "{line}");
}

#[test]
fn a_joint_is_reached_by_tcp_and_by_a_serial_device() {
    let bench = Bench::new();
    let (_served, name) = Served::at_tcp();
    let answer = ran(&bench, &format!("{name} --seconds 0.2"));
    assert!(answer.output.starts_with(&format!("{name}: hd25-100")), "{}", answer.output);
    let (_served, _open, name) = Served::at_terminal();
    let answer = ran(&bench, &format!("{name} --seconds 0.2 --baud 115200"));
    assert!(answer.output.contains(" mode=active "), "{}", answer.output);
}

#[test]
fn an_interrupt_ends_the_readings_and_writes_them() {
    let (bench, served) = bench();
    let mut command = bench.command("connect unix:joint --rate 100 --log out.csv --keep");
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut first = [0; 400];
    child.stdout.as_mut().unwrap().read_exact(&mut first).unwrap();
    assert!(!bench.path("out.csv").exists(), "complete or not at all");
    // As Ctrl-C, which a shell lets its background jobs ignore.
    let kill = Command::new("sh").arg("-c").arg(format!("kill -TERM {}", child.id())).status().unwrap();
    assert!(kill.success());
    let answer = child.wait_with_output().unwrap();
    assert_eq!((answer.status.code(), answer.stderr.as_slice()), (Some(0), [].as_slice()));
    assert!(String::from_utf8_lossy(&answer.stdout).ends_with(" missing\nkept: record 1\n"));
    assert!(fs::read_to_string(bench.path("out.csv")).unwrap().lines().count() > 1);
    assert!(served.joint().kept.is_some());
}

#[test]
fn a_joint_that_stops_or_leaves_ends_the_readings_with_nothing_written() {
    let (bench, served) = bench();
    served.joint().stands_still = true;
    let before = bench.files();
    let line = refused(&bench, "unix:joint --seconds 5 --log out.csv --plot page.html --json out.json");
    assert!(line.starts_with("error: out.csv: not written: unix:joint: the joint has refused \"read\": the control runs no step"), "{line}");
    assert!(bench.files() == before, "something was written");
    drop(served);
    fs::remove_file(bench.path("joint")).unwrap();

    // The other end closes it amid the readings.
    let served = Served::at_unix(&bench.path("joint"));
    let mut command = bench.command("connect unix:joint --log out.csv");
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    child.stdout.as_mut().unwrap().read_exact(&mut [0; 400]).unwrap();
    drop(served);
    let answer = child.wait_with_output().unwrap();
    let line = String::from_utf8(answer.stderr).unwrap();
    assert_eq!(answer.status.code(), Some(2));
    assert!(
        line.starts_with("error: out.csv: not written: unix:joint: the connection failed: ")
            && line.lines().count() == 1,
        "{line}"
    );
    assert!(!bench.path("out.csv").exists());
}

#[test]
fn another_joint_is_refused() {
    let (bench, _served) = bench();
    bench.write("other.toml", GEAR.replacen("coulomb_nm = 0.035", "coulomb_nm = 0.03", 1));
    let line = bench.refused("connect unix:joint --gear other.toml --set friction=0.5 --json out.json");
    assert!(
        line.starts_with("error: unix:joint: the joint is hd25-100 ") && line.contains(", not hd25-100 "),
        "{line}"
    );
}

/// A socket that answers whatever comes with these bytes.
fn answering(bench: &Bench, bytes: Vec<u8>) -> thread::JoinHandle<()> {
    let listener = UnixListener::bind(bench.path("joint")).unwrap();
    thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let mut asked = [0; 64];
        while stream.read(&mut asked).is_ok_and(|count| count > 0) && stream.write_all(&bytes).is_ok() {}
    })
}

#[test]
fn another_version_and_no_joint_are_told() {
    let bench = Bench::new();
    let frame = Sealed::with_version(VERSION + 1, 1, &Reply::Refused(Refusal::Version));
    let thread = answering(&bench, frame.bytes().to_vec());
    let line = refused(&bench, "unix:joint");
    assert_eq!(
        line,
        "error: unix:joint: the joint has version 2 of the tuning link, this program has version 1"
    );
    thread.join().unwrap();
    fs::remove_file(bench.path("joint")).unwrap();
    let thread = answering(&bench, b"login: \0".to_vec());
    let line = refused(&bench, "unix:joint");
    assert!(
        line.starts_with("error: unix:joint: no answer to \"hello\", sent 4 times with 0.25 s each: "),
        "{line}"
    );
    thread.join().unwrap();
}

#[test]
fn bad_input_is_one_line() {
    let bench = Bench::new();
    for (words, expected) in [
        ("none", "error: none: cannot be opened: No such file or directory"),
        ("g.toml", "error: g.toml: cannot be opened: "),
        ("unix:none", "error: unix:none: cannot be opened: No such file or directory"),
        ("tcp:127.0.0.1", "error: tcp:127.0.0.1: cannot be opened: invalid socket address"),
        ("unix:a --baud 50", "invalid value '50' for '--baud <BAUD>': 50 is not in 1200..=12000000"),
        (
            "unix:a --set drag=1",
            "no gain is called \"drag\"; allowed: feedback, inertia, friction, wind-up, kinematic-error",
        ),
        ("unix:a --set friction=1.5", "friction = 1.5 is out of range; allowed: 0 to 1"),
        ("unix:a --hold", "the following required arguments were not provided: --set"),
        ("unix:a --learnt-to k.toml", "the following required arguments were not provided: --gear"),
        ("unix:a --rate 0.1", "--rate 0.1 is out of range; allowed: a number from 0.2 to 1000 Hz"),
        ("unix:a --seconds nan", "--seconds NaN is out of range; allowed: a number from 0.1 to 1000000 s"),
        ("unix:a --log -", "--log - is not possible; allowed: a file"),
        ("unix:a --log a.csv --plot ./a.csv", "--plot and --log are the same file"),
        ("unix:a --gear g.toml --log g.toml", "g.toml: --log and --gear are the same file"),
        ("unix:a --log none/a.csv", "none/a.csv: cannot be written: there is no folder none"),
        ("unix:a --gear none.toml", "none.toml: cannot be read: No such file"),
    ] {
        let line = bench.refused(&format!("connect {words}"));
        assert!(line.contains(expected), "{line}\n{expected}");
    }
}
