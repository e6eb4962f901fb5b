//! Why the control step has elementary functions of its own: compared with micromath's and libm's over the same ranges.
//!
//! Sine and cosine stand in the kinematic error, whose amplitudes are up to 1e-3 rad: an error of 1e-3 is
//! all of the 1 urad that torsion has to be resolved to. 1 - e^-x stands in the Stribeck level and in
//! presliding, where x is the path of one control period over eps, down to nothing: friction in f32 has
//! to follow f64 within the bound `friction.f32`.

use std::path::Path;

use micromath::F32Ext;
use strainwave::Real;
use strainwave::elementary;
use strainwave::real::{ONE_MINUS_EXP_NEG_ERROR, RADIANS_PER_COUNT, SIN_COS_ERROR, SQRT_ERROR};
use strainwave_desktop::verify::bounds;
use strainwave_emulator::budget::LIBRARIES;

const LARGEST_KINEMATIC_ERROR: f64 = 1e-3;
const TORSION_RESOLUTION: f64 = 1e-6;

/// Of sine and cosine, square root, and 1 - e^-x.
fn errors(library: &str) -> [f64; 3] {
    LIBRARIES.iter().find(|known| known.name == library).expect("it is compared").errors()
}

#[test]
fn sine() {
    let ([ours, ..], [theirs, ..]) = (errors("ours"), errors("micromath"));
    assert!(ours <= SIN_COS_ERROR);
    assert!(ours * LARGEST_KINEMATIC_ERROR < 1e-3 * TORSION_RESOLUTION);
    assert!(theirs * LARGEST_KINEMATIC_ERROR > TORSION_RESOLUTION, "{theirs:e}: it would do now");
}

#[test]
fn share_of_the_presliding_path() {
    let friction = bounds::find("friction.f32").expect("the table has it").value;
    let ([.., ours], [.., theirs]) = (errors("ours"), errors("micromath"));
    assert!(ours <= ONE_MINUS_EXP_NEG_ERROR && ours < friction);
    assert!(theirs > 100.0 * friction, "{theirs:e}: it would do now");
}

#[test]
fn square_root() {
    assert!(errors("ours")[1] <= SQRT_ERROR);
}

/// The default is ours; micromath's are the crate's own functions.
#[test]
fn a_library_has_its_own_functions() {
    for k in 0..100_000_u32 {
        let (phase, x) = (k.wrapping_mul(2_654_435_769), 1e-6 * 1.0002_f32.powi(k as i32 % 90_000));
        let radians = phase.cast_signed() as f32 * RADIANS_PER_COUNT as f32;
        let found = elementary::micromath::sine_cosine(phase);
        assert_eq!(found, (F32Ext::sin(radians), F32Ext::cos(radians)), "{phase}");
        assert_eq!(elementary::micromath::square_root_or_zero(x), F32Ext::sqrt(x), "{x}");
        let share = (1.0 - F32Ext::exp(-x)).clamp(0.0, 1.0);
        assert_eq!(elementary::micromath::one_minus_exp_neg(x), share, "{x}");
        assert_eq!(f32::sin_cos_phase(phase), elementary::ours::sine_cosine(phase), "{phase}");
        assert_eq!(Real::sqrt_or_zero(x), elementary::ours::square_root_or_zero(x), "{x}");
        assert_eq!(Real::one_minus_exp_neg(x), elementary::ours::one_minus_exp_neg(x), "{x}");
    }
}

/// The book's table: function, library, cycles, bytes of code and of tables, largest error.
#[test]
fn the_book_tells_the_errors_of_today() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/src/figures.md");
    let page = std::fs::read_to_string(page).unwrap();
    for (place, name) in
        ["`sine_cosine`", "`square_root_or_zero`", "`one_minus_exp_neg`"].into_iter().enumerate()
    {
        for library in LIBRARIES {
            let start = format!("| {name} | {} | ", library.name);
            let row = page.lines().find(|line| line.starts_with(&start));
            let row = row.unwrap_or_else(|| panic!("{start}"));
            let stated: f64 = row.trim_end_matches(" |").rsplit("| ").next().unwrap().parse().unwrap();
            let measured = library.errors()[place];
            assert!(measured <= stated && measured >= 0.95 * stated, "{row}: {measured:e}");
        }
    }
}
