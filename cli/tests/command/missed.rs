//! Figures that miss their bounds: exit code 1.

use std::fmt::Write as _;

use crate::bench::{Bench, lacks_emulator};

/// Half a second of an output held, but for 0.1 urad, against a load of 40 N m that swings three times a second.
fn log_of_a_gear_without_torsion() -> String {
    let mut log = String::from("t_s,theta_motor_rad,tau_motor_nm,theta_out_rad,tau_out_nm\n");
    for k in 0..=125 {
        let time = f64::from(k) * 0.004;
        let swing = (std::f64::consts::TAU * 3.0 * time).sin();
        let _ = writeln!(log, "{time},0,0,{:e},{}", 1e-7 * swing, 40.0 * swing);
    }
    log
}

#[test]
fn a_replay_that_predicts_worse_than_a_rigid_gear_is_told_by_the_exit_code() {
    if lacks_emulator() {
        return;
    }
    let bench = Bench::new();
    bench.write("log.csv", log_of_a_gear_without_torsion());
    let answer = bench.run("pil --gear g.toml --replay log.csv --json out.json");
    assert_eq!((answer.code, answer.error.as_str()), (Some(1), ""), "{}", answer.output);
    let figures = bench.figures("out.json");
    let missed: Vec<_> = figures.iter().filter(|figure| figure["holds"] == false).collect();
    assert_eq!(missed.len(), 1, "{missed:?}");
    assert_eq!(missed[0]["name"], "pil.replay.predicted.rms");
    // The joint's wind-up under the load is predicted, and this gear has none.
    assert!(missed[0]["value"].as_f64() > Some(1e-4) && missed[0]["bound"].as_f64() < Some(1e-6));
    assert!(bench.path("out/pil.replay.svg").is_file());
}
