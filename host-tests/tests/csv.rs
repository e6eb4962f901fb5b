//! CSV files: what is accepted, and how each kind of mistake is refused.

use std::path::Path;

use proptest::prelude::*;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave_desktop::BadInput;
use strainwave_desktop::io::log::{Drive, DriveSample, MeasuredLog, OpenLoop, OpenLoopRow, write_open_loop};

const GOOD: &str = "t_s,theta_wg_rad,tau_load_nm\n0,0,0\n0.001,0.1,-50\n0.002,0.2,-50\n";

fn open_loop(text: &str) -> Result<OpenLoop, String> {
    OpenLoop::parse(Path::new("in.csv"), text.as_bytes()).map_err(|error| error.to_string())
}

fn measured(text: &str) -> Result<MeasuredLog, String> {
    MeasuredLog::parse(Path::new("log.csv"), text.as_bytes()).map_err(|error| error.to_string())
}

#[test]
fn columns_may_stand_in_any_order() {
    let log = open_loop("tau_load_nm,t_s,omega_wg_rad_s\r\n-50,0,1\r\n-40,0.0002,3\r\n\r\n").unwrap();
    assert_eq!(log.load_torque, [-50.0, -40.0]);
    assert_eq!(log.drive, Drive::Velocity(vec![1.0, 3.0]));
    let halfway = log.time.resampled(CONTROL_PERIOD).nth(1).unwrap();
    assert_eq!(log.drive.at(halfway), DriveSample::Velocity(2.0));
    assert_eq!(halfway.of(&log.load_torque), -45.0);
}

#[test]
fn a_byte_order_mark_spaces_and_quotes_are_tolerated() {
    let log = open_loop("\u{feff}t_s, theta_wg_rad ,\"tau_load_nm\"\n 0 ,\"1e-3\",0\n").unwrap();
    assert_eq!(log.drive, Drive::Position(vec![1e-3]));
}

#[test]
fn every_mistake_names_its_row_and_column() {
    for (from, to, expected) in [
        (GOOD, "", "empty file"),
        (GOOD, " \n\n", "empty file"),
        (GOOD, "\u{feff}", "empty file"),
        (GOOD, "t_s,theta_wg_rad,tau_load_nm\n", "no rows after the header"),
        ("tau_load_nm", "tau_nm", "row 1, column \"tau_nm\": unknown; known columns are t_s, theta_wg_rad, "),
        (",tau_load_nm", ",tau_load_nm,t_s", "row 1, column t_s: stands there twice"),
        (",tau_load_nm", "", "row 1, column tau_load_nm: missing"),
        ("t_s,", "", "row 1, column t_s: missing"),
        (",theta_wg_rad", "", "row 1, column theta_wg_rad or omega_wg_rad_s: missing"),
        (
            "theta_wg_rad",
            "theta_wg_rad,omega_wg_rad_s",
            "row 1, column omega_wg_rad_s: only one of theta_wg_rad and omega_wg_rad_s is allowed",
        ),
        ("0.1,-50", ",-50", "row 3, column theta_wg_rad: no value (a gap)"),
        ("0.1,-50", "0.1", "row 3, column tau_load_nm: no value (a gap)"),
        ("0.1,-50", "0.1,-50,7", "row 3, column 4: \"7\" has no name in the header"),
        ("0.001,0.1,-50", "", "row 3: empty (a gap)"),
        ("t_s", "\nt_s", "row 1: empty (a gap)"),
        (
            "0.1,-50",
            "0.1,NaN",
            "row 3, column tau_load_nm: \"NaN\" is out of range; allowed: a number from -1e6",
        ),
        ("0.1,-50", "-inf,-50", "row 3, column theta_wg_rad: \"-inf\" is out of range; allowed: a number"),
        ("0.1,-50", "0.1,1e999", "row 3, column tau_load_nm: \"1e999\" is out of range"),
        ("0.1,-50", "0.1,-5O", "row 3, column tau_load_nm: \"-5O\" is not a number"),
        ("0.1,-50", "0.1,\"-5\n0\"", "row 3, column tau_load_nm: \"-5\\n0\" is not a number"),
        ("0.002", "0.0005", "row 4, column t_s: time 0.0005 does not come after 0.001, the row before"),
        ("0.002", "0.001", "row 4, column t_s: time 0.001 does not come after 0.001, the row before"),
        ("0.002", "0.9", "row 4, column t_s: a gap of 0.899000 s before this row; allowed: at most"),
        ("0.002", "5000", "row 4, column t_s: time 5000 is more than 3600 s from the start"),
    ] {
        assert!(GOOD.contains(from));
        let line = open_loop(&GOOD.replacen(from, to, 1)).expect_err(expected);
        assert!(line.starts_with(&format!("in.csv: {expected}")), "{line}\nin.csv: {expected}");
        assert!(!line.contains('\n'));
    }
}

#[test]
fn a_file_that_is_not_utf8_is_refused_at_its_cell() {
    let bytes = [GOOD.as_bytes(), b"0.003,\xff\xfe,0\n"].concat();
    let line = OpenLoop::parse(Path::new("in.csv"), &bytes).unwrap_err().to_string();
    assert!(line.starts_with("in.csv: row 5, column theta_wg_rad: "), "{line}");
}

#[test]
fn a_measured_log_may_lack_sensors_and_have_the_controllers_model() {
    let log = measured("t_s,theta_motor_rad,tau_motor_nm\n0,1,2\n").unwrap();
    assert_eq!((log.output_position, log.output_torque, log.model_torque), (None, None, None));
    let all = "t_s,theta_motor_rad,theta_out_rad,tau_motor_nm,tau_model_nm,tau_out_nm\n0,1,2,3,4,5\n";
    let log = measured(all).unwrap();
    assert_eq!(log.output_position.unwrap(), [2.0]);
    assert_eq!((log.model_torque.unwrap(), log.output_torque.unwrap()), (vec![4.0], vec![5.0]));
    let line = measured(&all.replace("tau_model_nm", "temperature")).unwrap_err();
    assert!(
        line.starts_with("log.csv: row 1, column \"temperature\": unknown; known columns are t_s, "),
        "{line}"
    );
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let line = MeasuredLog::read(&folder.path().join("none.csv")).unwrap_err().to_string();
    assert!(line.contains("none.csv: cannot be read: No such file"), "{line}");
    let line = OpenLoop::read(folder.path()).unwrap_err().to_string();
    assert!(line.ends_with("cannot be read: it is a folder"), "{line}");
}

fn row(time: f64) -> OpenLoopRow {
    OpenLoopRow {
        time,
        output_position: -1e-5,
        output_velocity: 0.25,
        input_torque: 0.0,
        torsion: 1.0 / 3.0,
        transmitted_torque: -50.0,
        shell_torque: 0.0,
        strains: vec![1e-4],
        forces: None,
    }
}

/// As a run gives rows, none of which fails.
fn written(path: &Path, rows: [OpenLoopRow; 2]) -> Result<(), BadInput> {
    write_open_loop(path, &["strain_0_0_1_1".into()], rows.map(|row| Ok::<_, String>((row, Vec::new()))))
}

#[test]
fn the_output_has_the_documented_columns_and_loses_no_digit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.csv");
    written(&path, [row(0.0), row(3.0 * CONTROL_PERIOD)]).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let mut lines = text.lines();
    let header = "t_s,theta_fs_rad,omega_fs_rad_s,tau_wg_nm,torsion_rad,tau_t_nm,strain_0_0_1_1";
    assert_eq!(lines.next(), Some(header));
    assert_eq!(lines.next(), Some("0.0,-0.00001,0.25,0.0,0.3333333333333333,-50.0,0.0001"));
    assert!(lines.next().unwrap().starts_with("0.0003,"));
}

#[test]
fn a_value_that_is_not_finite_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.csv");
    for bad in [
        OpenLoopRow { torsion: f64::NAN, ..row(0.5) },
        OpenLoopRow { strains: vec![f64::INFINITY], ..row(0.5) },
    ] {
        let line = written(&path, [row(0.0), bad]).unwrap_err().to_string();
        assert!(line.ends_with("out.csv: not written: a value at 0.5 s is not finite"), "{line}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

#[test]
fn a_run_that_fails_after_some_rows_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.csv");
    let rows = [Ok((row(0.0), Vec::new())), Err("it broke")];
    let line = write_open_loop(&path, &["strain_0_0_1_1".into()], rows).unwrap_err().to_string();
    assert!(line.ends_with("out.csv: not written: it broke"), "{line}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

fn one_line_or_log(bytes: &[u8]) -> Result<(), TestCaseError> {
    let path = Path::new("log.csv");
    let errors = [OpenLoop::parse(path, bytes).err(), MeasuredLog::parse(path, bytes).err()];
    for line in errors.into_iter().flatten().map(|error| error.to_string()) {
        prop_assert!(line.starts_with("log.csv: ") && !line.chars().any(char::is_control), "{line}");
    }
    Ok(())
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        one_line_or_log(&bytes)?;
    }

    /// Damage to a good file reaches further into the checks than noise does.
    #[test]
    fn no_damage_panics(
        at in 0..GOOD.len(), cut in 0..8usize,
        put in prop_oneof!["[0-9,.\ne\"-]{0,8}".prop_map(String::into_bytes), prop::collection::vec(any::<u8>(), 0..4)],
    ) {
        let end = (at + cut).min(GOOD.len());
        one_line_or_log(&[&GOOD.as_bytes()[..at], &put, &GOOD.as_bytes()[end..]].concat())?;
    }

    /// Resampling stays within the values of the log, ends where it ends, and keeps the grid.
    #[test]
    fn resampling_invents_nothing(
        intervals in prop::collection::vec(1e-5..2e-2f64, 1..60), start in -1e3..2e9f64,
        values in prop::collection::vec(-1e3..1e3f64, 61),
    ) {
        let mut stamp = start;
        let mut text = format!("t_s,theta_wg_rad,tau_load_nm\n{start},{},0\n", values[0]);
        for (interval, value) in intervals.iter().zip(&values[1..]) {
            stamp += interval;
            text += &format!("{stamp},{value},0\n");
        }
        let log = open_loop(&text).unwrap();
        let Drive::Position(column) = &log.drive else { panic!("a position was given") };
        let (least, most) = column.iter().fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(*x), b.max(*x)));
        let instants: Vec<_> = log.time.resampled(CONTROL_PERIOD).collect();
        for (step, instant) in instants.iter().enumerate() {
            prop_assert_eq!(instant.elapsed, step as f64 * CONTROL_PERIOD);
            prop_assert!((least..=most).contains(&instant.of(column)));
        }
        let left_over = (stamp - start) - instants.last().unwrap().elapsed;
        prop_assert!((-2e-7..CONTROL_PERIOD + 1e-6).contains(&left_over), "{}", left_over);
    }
}
