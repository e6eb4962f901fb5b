//! Error of the whole gear's real-time build against the reference, over one open-loop run.
//!
//! Default gear; the wave generator swings by +-6 rad at 12 rad/s under a load that rises to -40 N m:
//! reversals of friction and hysteresis, both knees of the stiffness line, kinematic error.

use std::fmt::Write;
use std::path::Path;

use crate::io::figure::Figure;
use crate::io::gear_file::GearFile;
use crate::io::log::{OpenLoop, OpenLoopRow};
use crate::plant::divergence::RunError;
use crate::plant::two_port::{self, Build};
use crate::verify::bounds;
use crate::verify::largest;

pub(super) fn measure(gear: &GearFile) -> Result<Vec<Figure>, RunError> {
    let input = input();
    let run =
        |build| -> Result<Vec<OpenLoopRow>, RunError> { two_port::run(gear, &input, build, &[])?.collect() };
    let (reference, real_time) = (run(Build::REFERENCE)?, run(Build::RealTime)?);
    let worst =
        |of: fn(&OpenLoopRow) -> f64| largest(reference.iter().zip(&real_time).map(|(a, b)| of(a) - of(b)));
    Ok(vec![
        bounds::figure("gear.real_time.output_position.max", worst(|row| row.output_position)),
        bounds::figure("gear.real_time.torsion.max", worst(|row| row.torsion)),
        bounds::figure("gear.real_time.transmitted_torque.max", worst(|row| row.transmitted_torque)),
        bounds::figure("gear.real_time.wave_generator_torque.max", worst(|row| row.input_torque)),
    ])
}

fn input() -> OpenLoop {
    let mut text = "t_s,theta_wg_rad,tau_load_nm\n".to_owned();
    for k in 0..=400 {
        let time = f64::from(k) * 1e-3;
        let (angle, load) = (6.0 * (12.0 * time).sin(), -40.0 * (time / 0.1).min(1.0));
        writeln!(text, "{time},{angle},{load}").expect("a string grows");
    }
    OpenLoop::parse(Path::new("verify"), text.as_bytes()).expect("the input is well formed")
}
