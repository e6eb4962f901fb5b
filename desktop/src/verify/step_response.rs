//! The paper's Fig. 9: the gear as a two-port, its wave generator led by repeated steps under a constant load.
//!
//! ```text
//! windup  = mean over the steps of |phi| at the end of each, against line^-1(tau_load)
//! ringing = 3 / time of the first three periods of phi about its end, against sqrt(K(tau_load)/J_fs)/(2*pi)
//! ```
//!
//! The wave generator is prescribed, so what rings is the load J_fs on the gear at the slope K of the catalogue's line:
//! the eigenvalue of the linearised two masses with the motor's held. Each step is made within one sampling time of
//! 0.1 ms, every 0.4 s; the load grows to -50 N m over the first 0.1 s and stays. Units: rad, Hz, N m.
//!
//! Friction and hysteresis are there as always, and no height of the steps shows the line alone in both figures. Both are
//! taken at one, 1 mrad at the output. Of the default gear, wind-up and ringing off by:
//!
//! | height (mrad) | wind-up | ringing |
//! | --- | --- | --- |
//! | 0.2, the presliding of the output's friction, within which that is one more spring | 0.7 % | 18 % |
//! | 0.5 | 1.8 % | 4.5 % |
//! | 1: friction and hysteresis hold more of the wind-up | 2.5 % | 0.3 % |
//! | 2, which rings over a knee of the line | 2.1 % | -5.9 % |

use std::f64::consts::TAU;

use strainwave::Error;
use strainwave::compensator::schedule::CONTROL_PERIOD;

use crate::design::joint::gear_params;
use crate::io::figure::Figure;
use crate::io::gear_file::GearFile;
use crate::io::log::{Drive, OpenLoop, OpenLoopRow, Time};
use crate::plant::divergence::RunError;
use crate::plant::two_port::{self, Build};
use crate::verify::bounds;

/// Load on the output (N m), at most three quarters of what the gear is rated at.
const LOAD: f64 = -50.0;
const SHARE_OF_RATED: f64 = 0.75;
/// Over this time it grows (s).
const LOADING: f64 = 0.1;
/// From one step to the next (s).
const EVERY: f64 = 0.4;
/// Number of steps.
const STEPS: usize = 4;
/// Height of a step at the output (rad).
const HEIGHT: f64 = 1e-3;
/// Periods that the frequency is taken from.
const PERIODS: usize = 3;

/// The run of a gear.
pub struct StepResponse {
    /// Angle of the wave generator (rad), a sample each 0.1 ms.
    pub wave_generator: Vec<f64>,
    /// Response of the gear.
    pub rows: Vec<OpenLoopRow>,
    /// Load on the output (N m).
    pub load: f64,
    line_torsion: f64,
    eigenfrequency: f64,
}

impl StepResponse {
    /// Of the gear of a file, in a build.
    ///
    /// # Errors
    /// A gear that cannot be built, or a mesh that diverges.
    pub fn of(file: &GearFile, build: Build) -> Result<Self, RunError> {
        let load = LOAD.max(-SHARE_OF_RATED * file.gear.rated_torque);
        let input = input(file, load);
        let rows = two_port::run(file, &input, build, &[])?.collect::<Result<Vec<_>, _>>()?;
        let Drive::Position(wave_generator) = input.drive else { unreachable!("the steps are positions") };
        let (line_torsion, eigenfrequency) = linearised(file, load)?;
        Ok(Self { wave_generator, rows, load, line_torsion, eigenfrequency })
    }

    /// Wind-up and ringing with their bounds.
    pub fn figures(&self) -> Vec<Figure> {
        vec![
            bounds::figure("gear.steps.wind_up", self.wind_up_error().abs()),
            bounds::figure("gear.steps.ringing", self.ringing_error().abs()),
        ]
    }

    /// Steady wind-up, mean over the steps (rad).
    pub fn wind_up(&self) -> f64 {
        (1..=STEPS).map(|step| self.rows[at(step + 1) - 1].torsion.abs()).sum::<f64>() / STEPS as f64
    }

    /// Torsion of the catalogue's line under the load (rad).
    pub fn line_torsion(&self) -> f64 {
        self.line_torsion
    }

    /// Relative error of the steady wind-up against that torsion.
    pub fn wind_up_error(&self) -> f64 {
        self.wind_up() / self.line_torsion - 1.0
    }

    /// Frequency of the ringing, that of the step whose frequency is farthest off the eigenvalue (Hz).
    pub fn ringing(&self) -> f64 {
        self.eigenfrequency * (1.0 + self.ringing_error())
    }

    /// Eigenfrequency of the output on the slope of the line under the load (Hz).
    pub fn eigenfrequency(&self) -> f64 {
        self.eigenfrequency
    }

    /// Largest distance of the torsion from where the last step ends, in the first and in the last quarter of it but for its last
    /// 10 ms (rad).
    pub fn oscillation(&self) -> [f64; 2] {
        let rows = &self.rows[at(STEPS) + 1..at(STEPS + 1)];
        let end = rows.last().map_or(f64::NAN, |row| row.torsion);
        let (quarter, last) = (rows.len() / 4, rows.len() - (0.01 / CONTROL_PERIOD) as usize);
        let largest =
            |rows: &[OpenLoopRow]| rows.iter().map(|row| (row.torsion - end).abs()).fold(0.0, f64::max);
        [largest(&rows[..quarter]), largest(&rows[3 * quarter..last])]
    }

    /// Relative error of the ringing's frequency against the eigenvalue: the worst of all steps, NaN where one does not
    /// ring for three periods.
    pub fn ringing_error(&self) -> f64 {
        let errors = (1..=STEPS).map(|step| self.frequency(step) / self.eigenfrequency - 1.0);
        errors.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(f64::NAN)
    }

    /// Of the ringing after a step (Hz).
    fn frequency(&self, step: usize) -> f64 {
        let rows = &self.rows[at(step) + 1..at(step + 1)];
        let end = rows.last().map_or(f64::NAN, |row| row.torsion);
        let difference = |row: &OpenLoopRow| row.torsion - end;
        let crossings = rows.windows(2).filter(|pair| difference(&pair[0]) * difference(&pair[1]) < 0.0);
        let times: Vec<_> = crossings
            .map(|pair| {
                pair[0].time
                    + CONTROL_PERIOD * difference(&pair[0]) / (difference(&pair[0]) - difference(&pair[1]))
            })
            .take(2 * PERIODS + 1)
            .collect();
        let last = times.get(2 * PERIODS).copied().unwrap_or(f64::NAN);
        times.first().map_or(f64::NAN, |first| PERIODS as f64 / (last - first))
    }
}

/// Row at which a step is made, counted from 1.
fn at(step: usize) -> usize {
    (EVERY * step as f64 / CONTROL_PERIOD).round() as usize
}

fn input(file: &GearFile, load: f64) -> OpenLoop {
    let count = at(STEPS + 1);
    let height = HEIGHT / file.gear.signed_ratio().value::<f64>();
    let step = |k: usize| height * (1..=STEPS).filter(|step| k >= at(*step)).count() as f64;
    let grown = |k: usize| {
        let x = (k as f64 * CONTROL_PERIOD / LOADING).min(1.0);
        x * x * (3.0 - 2.0 * x)
    };
    OpenLoop {
        time: Time::every(CONTROL_PERIOD, count),
        drive: Drive::Position((0..count).map(step).collect()),
        load_torque: (0..count).map(|k| load * grown(k)).collect(),
    }
}

/// Torsion of the catalogue's line under a load (rad), and eigenfrequency of the output on its slope there (Hz).
fn linearised(file: &GearFile, load: f64) -> Result<(f64, f64), Error> {
    let gear = gear_params::<f64>(file);
    let line = gear.flexspline.line.build()?;
    let eigenfrequency = 1.0 / (line.compliance(load) * gear.flexspline_inertia).sqrt() / TAU;
    Ok((line.torsion(load).abs(), eigenfrequency))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A gear that is its linearised self, with a dashpot: what is measured of it is what it is.
    #[test]
    fn a_linear_gear_is_measured_as_it_is() {
        let file = GearFile::default_gear();
        let (torsion, frequency) = linearised(&file, LOAD).unwrap();
        let since = |k: usize| (k as f64 - at(k / at(1)) as f64) * CONTROL_PERIOD;
        let rows: Vec<_> = (0..at(STEPS + 1))
            .map(|k| OpenLoopRow {
                time: k as f64 * CONTROL_PERIOD,
                output_position: 0.0,
                output_velocity: 0.0,
                input_torque: 0.0,
                torsion: -torsion
                    * (1.0 + 0.5 * (-25.0 * since(k)).exp() * (TAU * frequency * since(k)).cos()),
                transmitted_torque: 0.0,
                shell_torque: 0.0,
                strains: Vec::new(),
                forces: None,
            })
            .collect();
        let response = StepResponse {
            wave_generator: Vec::new(),
            rows,
            load: LOAD,
            line_torsion: torsion,
            eigenfrequency: frequency,
        };
        assert!(response.wind_up_error().abs() < 1e-4, "{}", response.wind_up_error());
        assert!(response.ringing_error().abs() < 1e-3, "{}", response.ringing_error());
    }

    #[test]
    fn the_default_gears_output_hangs_on_k3() {
        let (torsion, frequency) = linearised(&GearFile::default_gear(), LOAD).unwrap();
        assert!((torsion - (14.0 / 3.1e4 + 34.0 / 5.0e4 + 2.0 / 5.7e4)).abs() < 1e-12);
        assert!((frequency - (5.7e4f64 / 1.2).sqrt() / TAU).abs() < 1e-9);
    }
}
