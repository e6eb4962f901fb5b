//! The free shell against MuJoCo: where its nodes stand after 10, 100 and 1000 steps of eq. (6).
//!
//! The problem and MuJoCo's answer are `desktop/oracle/free_shell.toml` and `.csv`: the 36 x 4 shell of the
//! default gear, set moving by a rigid motion and five harmonics, no node held. The initial velocity of the
//! node at angle a and height s*l (s = 0..1) is, in m/s,
//!
//! ```text
//! v = translation + spin x p + sum cos(pi*along*s)*(radial*cos(b)*e_r + tangential*sin(b)*e_t + axial*cos(b)*e_z)
//! b = around*a + phase
//! ```

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use serde::Deserialize;
use strainwave::flexspline::shell::{Shell, ShellParams, ShellState};
use strainwave::flexspline::{Bend, Cup};

use crate::design::joint::gear_params;
use crate::io::figure::Figure;
use crate::io::gear_file::GearFile;
use crate::verify::bounds;
use crate::verify::largest;

const PROBLEM: &str = include_str!("../../../oracle/free_shell.toml");
const TABLE: &str = include_str!("../../../oracle/free_shell.csv");

/// Nodes around and slices of the stored problem.
const N: usize = 36;
const M: usize = 4;

/// The stored problem.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Problem {
    /// The shell.
    pub shell: ShellFacts,
    run: Run,
    velocity: Velocity,
}

/// Size, links and mass of the shell.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShellFacts {
    nodes_around: usize,
    slices: usize,
    radius_m: f64,
    length_m: f64,
    /// k of eq. (6) (N/m).
    pub link_stiffness_n_per_m: f64,
    /// mu of eq. (6) (N s/m).
    pub link_damping_n_s_per_m: f64,
    mass_kg: f64,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Run {
    time_step_s: f64,
    steps: Vec<u32>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Velocity {
    translation_m_per_s: [f64; 3],
    spin_rad_per_s: [f64; 3],
    mode: Vec<Mode>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Mode {
    around: u32,
    along: u32,
    phase_rad: f64,
    radial_m_per_s: f64,
    tangential_m_per_s: f64,
    axial_m_per_s: f64,
}

/// MuJoCo's position of one node (m).
#[derive(Clone, Copy, Debug, Deserialize)]
struct Row {
    step: u32,
    i: usize,
    j: usize,
    x_m: f64,
    y_m: f64,
    z_m: f64,
}

pub(super) fn measure() -> Vec<Figure> {
    let distances = Problem::stored().distances();
    vec![bounds::figure("flexspline.oracle.mujoco", largest(distances.into_values()))]
}

impl Problem {
    /// # Panics
    /// When the embedded file is not the problem that this code steps, which is a mistake in the program.
    pub fn stored() -> Self {
        let problem: Self = toml::from_str(PROBLEM).expect("free_shell.toml is a problem");
        assert_eq!((problem.shell.nodes_around, problem.shell.slices), (N, M), "free_shell.toml");
        problem
    }

    /// Largest distance of a coordinate from MuJoCo's (m), by the step after which they are compared.
    ///
    /// # Panics
    /// When the shell cannot be built, or the embedded table lacks a node.
    pub fn distances(&self) -> BTreeMap<u32, f64> {
        let shell = Shell::<f64, N, M>::build(&self.params(), self.run.time_step_s).expect("a stable shell");
        let mut state = self.start(&shell);
        let mut table = table();
        let last = self.run.steps.iter().max().copied().unwrap_or_default();
        let mut distances = BTreeMap::new();
        for step in 1..=last {
            shell.step(&mut state);
            if self.run.steps.contains(&step) {
                let rows = table.remove(&step).unwrap_or_default();
                assert_eq!(rows.len(), N * M, "free_shell.csv at step {step}");
                distances.insert(step, largest(rows.iter().map(|row| row.distance(&state))));
            }
        }
        distances
    }

    fn params(&self) -> ShellParams<f64> {
        ShellParams {
            cup: self.shell.cup(),
            link_stiffness: self.shell.link_stiffness_n_per_m,
            link_damping: self.shell.link_damping_n_s_per_m,
            bend: Bend::LINEAR,
        }
    }

    fn start(&self, shell: &Shell<f64, N, M>) -> ShellState<f64, N, M> {
        let mut state = shell.round();
        for (i, j) in (0..M).flat_map(|j| (0..N).map(move |i| (i, j))) {
            let (angle, height) = (TAU * i as f64 / N as f64, j as f64 / (M - 1) as f64);
            state.set_velocity(i, j, self.velocity.at(angle, height, state.position(i, j)));
        }
        state
    }
}

impl ShellFacts {
    /// The default gear's cup with this radius and length, and a density that gives it this mass.
    fn cup(&self) -> Cup<f64> {
        let cup = gear_params(&GearFile::default_gear()).flexspline.cup;
        let sized = Cup { radius: self.radius_m, length: self.length_m, ..cup };
        Cup { density: sized.density * self.mass_kg / sized.mass(), ..sized }
    }
}

impl Velocity {
    fn at(&self, angle: f64, height: f64, position: [f64; 3]) -> [f64; 3] {
        let ([x, y, z], [wx, wy, wz]) = (position, self.spin_rad_per_s);
        let spin = [wy * z - wz * y, wz * x - wx * z, wx * y - wy * x];
        let rigid = std::array::from_fn(|axis| self.translation_m_per_s[axis] + spin[axis]);
        let parts = self.mode.iter().map(|mode| mode.at(angle, height));
        parts.fold(rigid, |sum, part| std::array::from_fn(|axis| sum[axis] + part[axis]))
    }
}

impl Mode {
    fn at(&self, angle: f64, height: f64) -> [f64; 3] {
        let (sine, cosine) = angle.sin_cos();
        let (b_sine, b_cosine) = (f64::from(self.around) * angle + self.phase_rad).sin_cos();
        let along = (PI * f64::from(self.along) * height).cos();
        let radial = self.radial_m_per_s * along * b_cosine;
        let tangential = self.tangential_m_per_s * along * b_sine;
        let axial = self.axial_m_per_s * along * b_cosine;
        [radial * cosine - tangential * sine, radial * sine + tangential * cosine, axial]
    }
}

impl Row {
    /// Largest distance of a coordinate (m).
    fn distance(&self, state: &ShellState<f64, N, M>) -> f64 {
        let ours = state.position(self.i, self.j).into_iter();
        largest(ours.zip([self.x_m, self.y_m, self.z_m]).map(|(ours, theirs)| (ours - theirs).abs()))
    }
}

/// MuJoCo's positions by step.
fn table() -> BTreeMap<u32, Vec<Row>> {
    let mut table = BTreeMap::<u32, Vec<Row>>::new();
    for row in csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(TABLE.as_bytes()).deserialize() {
        let row: Row = row.expect("free_shell.csv has a node a row");
        table.entry(row.step).or_default().push(row);
    }
    table
}
