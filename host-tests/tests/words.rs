//! The built compensator as words: what firmware reads in place is what the host has built, or is refused by name.

use std::path::PathBuf;

use strainwave::compensator::adapt::learning::Learnt;
use strainwave::compensator::words::{BadWords, LEARNT_WORDS, WORDS, motor_encoder_bits};
use strainwave::compensator::{CompensationGains, Compensator, Input, Sensors};
use strainwave_app::constants::{PARTS, is_unchanged};
use strainwave_desktop::GearFile;
use strainwave_desktop::design::export::Export;
use strainwave_desktop::design::joint::joint_params;

/// Gears of several sizes, ratios, sensors and friction; with and without learnt factors and hysteresis weights.
const GEARS: [&str; 7] = [
    "hd25-100",
    "lara8-j1",
    "lara8-j5",
    "catalogue/hd08-030",
    "catalogue/hd20-160",
    "catalogue/hd45-100",
    "catalogue/hd58-160",
];

fn gear(name: &str) -> GearFile {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("../gears/{name}.toml"));
    GearFile::read(&path).expect("is a gear file")
}

fn built(gear: &GearFile) -> Compensator<f32> {
    joint_params(gear).and_then(|joint| joint.build()).expect("can be built")
}

/// The default gear with identified weights of its hysteresis and more terms of the kinematic error than it has.
fn unusual() -> GearFile {
    let mut gear = GearFile::default_gear();
    gear.hysteresis.half_range = Some(1.5e-3);
    gear.hysteresis.weights = Some(vec![vec![0.5], vec![2.0, 0.5]]);
    for (order, harmonic) in (5..).zip(&mut gear.kinematic_error.wave_generator) {
        harmonic.order = order;
    }
    gear.sensors.output_encoder_delay = 4;
    gear
}

#[test]
fn what_is_read_in_place_is_what_was_built_field_by_field() {
    for gear in GEARS.map(gear).iter().chain([&unusual()]) {
        let built = built(gear);
        let words = built.to_words();
        let read = Compensator::from_words(&words).expect("is sound");
        assert_eq!(read, &built, "{}", gear.gear.name);
        // In place: it lies behind the header of three words.
        assert!(std::ptr::eq(std::ptr::from_ref(read).cast(), &raw const words[3]));
        assert_eq!(read.to_words(), words, "{}", gear.gear.name);
    }
}

#[test]
fn the_motor_encoders_bits_can_be_read_before_the_words_are_checked() {
    let default = motor_encoder_bits(&strainwave_app::joint::WORDS);
    assert_eq!(default, GearFile::default_gear().sensors.motor_encoder_bits);
    for (gear, bits) in GEARS.map(gear).iter_mut().zip([10, 14, 17, 19, 21, 24, 32]) {
        gear.sensors.motor_encoder_bits = bits;
        assert_eq!(motor_encoder_bits(&built(gear).to_words()), bits, "{}", gear.gear.name);
    }
}

#[test]
fn it_steps_as_what_was_built() {
    for gear in GEARS.map(gear) {
        let built = built(&gear);
        let words = built.to_words();
        let read = Compensator::from_words(&words).expect("is sound");
        let (mut here, mut there) = (built.rest(), read.rest());
        let mut moved = false;
        for period in 0..4000_u32 {
            let angle = (period as f32 * 3e-3).sin();
            let sensors = Sensors {
                motor_encoder: ((2000.0 * angle) as i32 as u32) & 0x3ff,
                motor_torque: 0.1 * angle,
                ..Sensors::default()
            };
            let input = Input { sensors, gains: CompensationGains::ALL.into(), ..Input::default() };
            let output = built.step(&mut here, &input);
            assert_eq!(output, read.step(&mut there, &input), "{}, period {period}", gear.gear.name);
            moved |= output.motor_torque != 0.0;
        }
        assert!(moved, "{}", gear.gear.name);
    }
}

#[test]
fn a_flipped_bit_is_refused_wherever_it_is() {
    let sound = built(&GearFile::default_gear()).to_words();
    for word in 0..WORDS {
        let mut words = sound;
        words[word] ^= 1 << (word % 32);
        let expected = match word {
            0 => BadWords::Layout,
            1 => BadWords::Length,
            _ => BadWords::Checksum,
        };
        assert_eq!(Compensator::from_words(&words), Err(expected), "word {word}");
    }
    assert_eq!(BadWords::Checksum.to_string(), "wrong checksum");
}

#[test]
fn words_of_another_layout_or_length_are_refused() {
    let sound = built(&GearFile::default_gear()).to_words();
    let mut longer = sound.to_vec();
    longer.push(0);
    for words in [&[], &sound[..3], &sound[..WORDS - 1], &longer] {
        assert_eq!(Compensator::from_words(words), Err(BadWords::Length), "{} words", words.len());
    }
    // What another version has written begins with another layout, whatever its length.
    longer[0] = 1;
    assert_eq!(Compensator::from_words(&longer), Err(BadWords::Layout));
    assert_eq!(BadWords::Layout.to_string(), "layout of another version");
}

/// The words in an array initialiser.
fn array(text: &str) -> Vec<u32> {
    let words = text.split(',').filter_map(|word| word.trim().strip_prefix("0x"));
    words.map(|word| u32::from_str_radix(word, 16).expect("is a word")).collect()
}

#[test]
fn both_languages_hold_these_words_and_the_same_text_each_time() {
    let gear = gear("lara8-j5");
    let (one, other) = (Export::of(&gear).expect("is built"), Export::of(&gear).expect("is built"));
    assert_eq!((one.rust(), one.c()), (other.rust(), other.c()));
    let words = built(&gear).to_words();
    let inside = |text: String, open: &str| array(text.split_once(open).expect("has an array").1);
    assert_eq!(inside(one.rust(), "] = [\n"), words);
    assert_eq!(inside(one.c(), "] = {\n"), words);
}

#[test]
fn a_name_of_any_characters_breaks_neither_text() {
    let mut gear = GearFile::default_gear();
    gear.gear.name = "a\"\\*/\n\u{e9}??/".into();
    let export = Export::of(&gear).expect("is built");
    assert!(export.rust().contains("pub const GEAR: &str = \"a\\\"\\\\*/\\né??/\";\n"), "{}", export.rust());
    let c = export.c();
    assert!(c.contains("#define STRAINWAVE_GEAR \"a\\042\\134*/\\012\\303\\251\\077\\077/\"\n"), "{c}");
    assert_eq!(c.matches("*/").count(), 2, "{c}");
}

/// Whatever a store gives, the state starts from finite factors and ripple within their bounds; what is within them, unchanged.
#[test]
fn what_was_learnt_is_read_as_it_was_written_and_bounded_where_it_is_used() {
    let compensator = built(&GearFile::default_gear());
    let mut learnt = compensator.learnt(&compensator.rest());
    learnt.factors.inertia = 1.05;
    learnt.factors.presliding_stiffness = 0.97;
    learnt.ripple.position[1] = [1e-6, -2e-6];
    learnt.ripple.torque[3] = [3e-4, 4e-4];
    let words = learnt.to_words();
    assert_eq!(Learnt::from_words(&words), learnt);
    for (place, (word, nominal)) in words.iter().zip(Learnt::default().to_words()).enumerate() {
        assert_eq!(*word != nominal, [0, 5, 8, 9, 20, 21].contains(&place), "word {place}");
    }
    for bits in [f32::NAN, f32::INFINITY, -1e30, f32::MAX].map(f32::to_bits) {
        let state = compensator.rest_with(&Learnt::from_words(&[bits; LEARNT_WORDS]));
        let started = compensator.learnt(&state).to_words().map(f32::from_bits);
        assert!(started.iter().all(|value| value.abs() < 3.0), "{bits:x}: {started:?}");
    }
}

#[test]
fn a_changed_bit_of_the_constants_is_found_in_its_part_whichever_it_is() {
    let parts = |words: &_| [0, 1].map(|part| is_unchanged(words, part));
    let mut words = strainwave_app::joint::WORDS;
    assert_eq!(PARTS, 2);
    assert_eq!(parts(&words), [true; 2]);
    let half = words.len().div_ceil(PARTS);
    for word in 0..words.len() {
        for bit in 0..32 {
            words[word] ^= 1 << bit;
            assert_eq!(parts(&words), [word >= half, word < half], "bit {bit} of word {word}");
            words[word] ^= 1 << bit;
        }
    }
}
