//! The linked image in the emulator: the same answers as the host, bit for bit, and no process left behind.

use rustix::process::{Pid, Signal, kill_process, test_kill_process};
use std::io::{BufRead, BufReader};
use std::iter;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use strainwave::Angle;
use strainwave::compensator::{
    Command as JointCommand, CompensationGains, Directions, Input, Sensors, Setpoint,
};
use strainwave_app::frame::{INPUT_BYTES, decode_input, encode_input, encode_output};
use strainwave_app::{Compensator, control_step, joint};
use strainwave_desktop::GearFile;
use strainwave_desktop::design::export::{Export, WITH_BELT};
use strainwave_desktop::design::joint::joint_params;
use strainwave_emulator::machine::{Error, Options};
use strainwave_emulator::{Machine, firmware, setup};

const BOARD: &str = "mps2-an386";

/// The image, or `None` on a machine that has no emulator.
fn image() -> Option<PathBuf> {
    if setup::present_emulator(&setup::ThisHost).is_none() {
        println!("skipped: no emulator");
        return None;
    }
    Some(firmware::build(BOARD, None).expect("the board builds").elf)
}

/// A repeatable sequence of numbers (Knuth's MMIX generator).
struct Sequence(u64);

impl Sequence {
    fn word(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 32) as u32
    }

    /// Even on -1..1.
    fn unit(&mut self) -> f32 {
        self.word().cast_signed() as f32 / 2_147_483_648.0
    }
}

/// Within a revolution of an encoder of 19 bits.
const LARGEST_COUNT: u32 = (1 << 19) - 1;

const GAINS: CompensationGains<f32> = CompensationGains { friction: 0.8, ..CompensationGains::ALL };

/// A position that moves at -1 rad/s, and for some time a velocity and a torque.
fn command(sequence: &mut Sequence, period: u32) -> JointCommand<f32> {
    let velocity = -1.0 + 0.1 * sequence.unit();
    let acceleration = 10.0 * sequence.unit();
    match period / 100 % 8 {
        3 => JointCommand::Velocity { velocity, acceleration },
        5 => JointCommand::Torque(20.0 * sequence.unit()),
        _ => JointCommand::Position(Setpoint {
            position: Angle { counts: -68_321 * i64::from(period), rest: 0.5 * sequence.unit() },
            velocity,
            acceleration,
            jerk: 100.0 * sequence.unit(),
            snap: 1e4 * sequence.unit(),
        }),
    }
}

/// Readings of a joint that moves at 100 rad/s in front of the gear, with sensors that come and go.
fn plausible(sequence: &mut Sequence, period: u32) -> Input<f32> {
    Input {
        sensors: Sensors {
            // 0.01 rad are 834 counts; the last two bits are noise.
            motor_encoder: (834 * period + (sequence.word() >> 30)) & LARGEST_COUNT,
            output_encoder: (!period.is_multiple_of(3))
                .then(|| (834 * period / 100).wrapping_neg() & LARGEST_COUNT),
            motor_torque: 0.6 * sequence.unit(),
            output_torque: period.is_multiple_of(5).then(|| 60.0 * sequence.unit()),
        },
        command: command(sequence, period),
        gains: Directions { forward: GAINS, backward: CompensationGains { friction: 0.6, ..GAINS } },
        ..Input::default()
    }
}

/// A joint that stands still, far from where it should be.
fn out_of_reach() -> Input<f32> {
    let position = Setpoint { position: Angle::from_radians(0.5), ..Setpoint::default() };
    Input { command: position.into(), gains: GAINS.into(), ..Input::default() }
}

/// Any bits at all, in a valid frame.
fn arbitrary(sequence: &mut Sequence) -> Input<f32> {
    let mut frame = [0; INPUT_BYTES];
    frame.fill_with(|| sequence.word() as u8);
    (frame[4], frame[13], frame[18]) = (frame[4] & 1, frame[13] & 1, frame[18] % 3);
    decode_input(&frame).expect("flags and kind are valid")
}

#[test]
fn every_board_links_and_none_can_panic() {
    let boards = firmware::boards().expect("the folder of the boards");
    assert_eq!(
        boards,
        [
            "mps2-an386",
            "mps2-an500",
            "mps2-an505",
            "mps3-an547",
            "nucleo-g474re",
            "nucleo-h743zi",
            "pico2",
            "stm32f405"
        ]
    );
    for board in boards {
        // A panic that can be reached leaves a symbol undefined.
        let built = firmware::build(&board, None).expect("builds");
        assert!(built.compiler.starts_with("rustc 1."), "{}", built.compiler);
        assert!(built.elf.is_file());
    }
}

fn default_joint() -> &'static Compensator {
    Compensator::from_words(&joint::WORDS).expect("the default joint is sound")
}

/// The image with this file of a joint.
fn image_with(source: &str) -> PathBuf {
    let folder = tempfile::tempdir().expect("a temporary directory");
    let path = folder.path().join("joint.rs");
    std::fs::write(&path, source).expect("is written");
    firmware::build(BOARD, Some(&path)).expect("builds").elf
}

#[test]
fn a_joint_with_a_flipped_bit_or_of_another_layout_is_refused_by_name() {
    if image().is_none() {
        return;
    }
    let sound = Export::of(&GearFile::default_gear()).expect("is built").rust();
    for (word, reason) in [(0, "layout of another version"), (500, "wrong checksum")] {
        let [old, new] = [joint::WORDS[word], joint::WORDS[word] ^ 1].map(|word| format!("{word:#010x},"));
        let (before, array) = sound.split_once("= [\n").expect("has an array");
        let mut words: Vec<_> = array.split_inclusive(',').map(str::to_owned).collect();
        words[word] = words[word].replace(&old, &new);
        let elf = image_with(&format!("{before}= [\n{}", words.concat()));
        let mut machine = Machine::boot(&elf, &[]).expect("boots");
        let error = machine.exchange(&encode_input(&Input::default())).expect_err("is refused").to_string();
        assert!(error.contains(&format!("joint hd25-100: {reason}")), "{error}");
    }
}

/// Without its first line nothing tells that the words are those of a joint with a belt: the image is built without code for one.
#[test]
fn an_image_without_code_for_a_belt_refuses_a_joint_with_one() {
    if image().is_none() {
        return;
    }
    let source = Export::of(&GearFile::wrist()).expect("is built").rust();
    let (heading, words) = source.split_once('\n').expect("has lines");
    assert!(heading.contains(WITH_BELT), "{heading}");
    let mut machine = Machine::boot(&image_with(words), &[]).expect("boots");
    let error = machine.exchange(&encode_input(&Input::default())).expect_err("is refused").to_string();
    assert!(error.contains("joint with a belt, program without the feature `belt`"), "{error}");
}

#[test]
fn another_joint_is_another_image() {
    let Some(elf) = image() else { return };
    let mut gear = GearFile::default_gear();
    gear.motor.peak_torque = 0.25;
    let weak = image_with(&Export::of(&gear).expect("is built").rust());
    assert_ne!(weak, elf);
    let mut machine = Machine::boot(&weak, &[]).expect("boots");
    let compensator = joint_params(&gear).and_then(|joint| joint.build()).expect("is sound");
    let mut state = compensator.rest();
    let mut sequence = Sequence(2);
    let strong = default_joint();
    let (mut beside, mut differs) = (strong.rest(), false);
    for period in 0..300 {
        let input = if period < 200 { plausible(&mut sequence, period) } else { out_of_reach() };
        control_step(&compensator, &mut state, &input);
        let expected = compensator.output(&state);
        let answer = machine.exchange(&encode_input(&input)).expect("answers");
        assert_eq!(answer, encode_output(&expected), "period {period}");
        differs |= strong.step(&mut beside, &input) != expected;
    }
    assert!(differs);
}

#[test]
fn the_image_answers_as_the_host_does_bit_for_bit() {
    let Some(elf) = image() else { return };
    let mut machine = Machine::boot(&elf, &[]).expect("boots");
    let compensator = default_joint();
    let mut state = compensator.rest();
    let mut sequence = Sequence(1);
    let mut moved = false;
    for period in 0..1200 {
        let input = if period < 1000 { plausible(&mut sequence, period) } else { arbitrary(&mut sequence) };
        control_step(compensator, &mut state, &input);
        let expected = compensator.output(&state);
        let answer = machine.exchange(&encode_input(&input)).expect("answers");
        assert_eq!(answer, encode_output(&expected), "period {period}: {input:?} -> {expected:?}");
        moved |= expected.motor_torque != 0.0;
    }
    assert!(moved);
    let ending = machine.finish().expect("ends as it should");
    assert_eq!(ending.dropped, 0);
    assert!(ending.stack > 100 && ending.stack < 65_536, "{}", ending.stack);
    let reported = ending.telemetry.iter().filter(|line| line.starts_with("period ")).count();
    assert_eq!(reported, 1200, "{:?}", ending.telemetry.last());
    assert!(ending.telemetry[1199].starts_with("period 1199 "), "{}", ending.telemetry[1199]);
    assert!(ending.telemetry[1199].contains(" overruns 0 "), "{}", ending.telemetry[1199]);
}

#[test]
fn a_processor_too_slow_for_the_period_is_ended_by_the_watchdog() {
    let Some(elf) = image() else { return };
    // 2^10 ns an instruction: the five periods that the watchdog grants are 488 instructions.
    let options = Options { shift: 10, ..Options::default() };
    let mut machine = Machine::boot_with(&elf, &options).expect("boots");
    let frame = encode_input(&Input::default());
    let error = (0..100).find_map(|_| machine.exchange(&frame).err()).expect("ends").to_string();
    assert!(error.starts_with("the emulator ended with exit status: 1"), "{error}");
    assert!(error.contains("watchdog: the control missed its periods"), "{error}");
}

#[test]
fn a_frame_of_another_layout_ends_the_firmware_with_an_error() {
    let Some(elf) = image() else { return };
    let mut machine = Machine::boot(&elf, &[]).expect("boots");
    let mut frame = encode_input(&Input::default());
    machine.exchange(&frame).expect("answers");
    frame[4] = 2;
    let error = machine.exchange(&frame).expect_err("ends");
    assert!(matches!(error, Error::Ended { .. }), "{error}");
}

#[test]
fn a_hang_is_reported_with_what_the_firmware_said() {
    let Some(elf) = image() else { return };
    let options = Options { patience: Duration::from_millis(300), ..Options::default() };
    let mut machine = Machine::boot_with(&elf, &options).expect("boots");
    let frame = encode_input(&Input::default());
    for _ in 0..3 {
        // Starting may take longer than this machine's patience.
        while matches!(machine.exchange(&frame), Err(Error::Hung { .. })) {}
    }
    kill_process(pid(machine.id()), Signal::STOP).expect("stops");
    // Answers to frames that were given up while it started are still to be read.
    let error =
        iter::repeat_with(|| machine.exchange(&frame)).find_map(Result::err).expect("hangs").to_string();
    assert!(
        error.starts_with("the firmware did not answer within 0.3 s: last telemetry: period "),
        "{error}"
    );
    let id = pid(machine.id());
    drop(machine);
    assert!(gone(id));
}

#[test]
fn an_image_that_is_none_ends_with_an_error() {
    if image().is_none() {
        return;
    }
    let error = Machine::boot(Path::new("/nowhere/image.elf"), &[]).err().expect("refused").to_string();
    assert!(error.contains("/nowhere/image.elf"), "{error}");
    let error = Machine::boot(Path::new("Cargo.toml"), &[]).err().expect("refused");
    assert!(matches!(error, Error::Image(_)), "{error}");
    let real = firmware::build("stm32f405", None).expect("the board builds").elf;
    let error = Machine::boot(&real, &[]).err().expect("refused");
    assert!(matches!(error, Error::NotEmulated { .. }), "{error}");
}

#[test]
fn the_emulator_is_gone_after_the_machine() {
    let Some(elf) = image() else { return };
    let mut machine = Machine::boot(&elf, &[]).expect("boots");
    machine.exchange(&encode_input(&Input::default())).expect("answers");
    let id = pid(machine.id());
    assert!(runs(id));
    drop(machine);
    assert!(gone(id));
}

#[test]
fn a_machine_outlives_the_thread_that_booted_it() {
    let Some(elf) = image() else { return };
    let booted = std::thread::spawn(move || Machine::boot(&elf, &[]).expect("boots"));
    let mut machine = booted.join().expect("the thread ends");
    for _ in 0..10 {
        machine.exchange(&encode_input(&Input::default())).expect("answers");
    }
}

/// Set for the process that [`a_dying_host_takes_the_emulator_along`] starts of itself.
const VICTIM: &str = "STRAINWAVE_TEST_VICTIM";

#[test]
fn a_dying_host_takes_the_emulator_along() {
    let Some(elf) = image() else { return };
    if std::env::var_os(VICTIM).is_some() {
        return wait_for_the_end(&elf);
    }
    // Nothing of ours runs any more after the first; the second has a handler.
    for (signal, handled) in [(Signal::KILL, false), (Signal::TERM, true)] {
        let directory = tempfile::tempdir().expect("a temporary directory");
        let (mut victim, emulator) = victim(directory.path());
        assert!(runs(emulator));
        kill_process(pid(victim.id()), signal).expect("can be killed");
        let status = victim.wait().expect("ends");
        assert_eq!(status.code(), handled.then_some(143), "{status}");
        let said = std::io::read_to_string(victim.stderr.take().expect("is piped")).expect("is text");
        assert_eq!(said, if handled { "error: interrupted\n" } else { "" });
        assert!(gone(emulator), "{signal:?}");
        let left = directory.path().read_dir().expect("is readable").count();
        assert_eq!(left, usize::from(!handled), "{signal:?}");
    }
}

fn wait_for_the_end(elf: &Path) {
    let mut machine = Machine::boot(elf, &[]).expect("boots");
    machine.exchange(&encode_input(&Input::default())).expect("answers");
    println!("\nemulator {}", machine.id());
    std::thread::sleep(Duration::from_secs(60));
}

/// This very test in a process of its own, with its temporary files in `directory`, and its emulator.
fn victim(directory: &Path) -> (Child, Pid) {
    let mut child = Command::new(std::env::current_exe().expect("has a path"))
        .args(["--exact", "firmware::a_dying_host_takes_the_emulator_along", "--nocapture"])
        .env(VICTIM, "1")
        .env("TMPDIR", directory)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    let output = BufReader::new(child.stdout.take().expect("is piped"));
    let id =
        output.lines().map_while(Result::ok).find_map(|line| line.strip_prefix("emulator ")?.parse().ok());
    (child, pid(id.expect("says its emulator's id")))
}

fn pid(id: u32) -> Pid {
    Pid::from_raw(id.cast_signed()).expect("an id is positive")
}

/// Waits a moment for a process to be gone.
fn gone(id: Pid) -> bool {
    let deadline = Instant::now() + Duration::from_secs(2);
    while runs(id) {
        if Instant::now() > deadline {
            return false;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    true
}

/// Alive, and not only waiting to be reaped by whoever inherited it.
fn runs(id: Pid) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{}/stat", id.as_raw_nonzero())).unwrap_or_default();
    let state = status.rsplit(") ").next().and_then(|rest| rest.chars().next());
    test_kill_process(id).is_ok() && state != Some('Z')
}
