//! Conserved quantities of a free shell without damping over 10^5 steps: 36 x 4, f64.
//!
//! It drifts, spins and rings. The ringing is set off by a random velocity of every node and left alone for a while, so
//! that all modes have come to random phases; its largest strains are 0.1 %. The worst of [`SEEDS`] such motions.
//!
//! ```text
//! trend = slope*T/E               least-squares line through the shadow energy over the time T, mean E
//! momentum = max |P(t) - P(0)| / sum |m*v|,   angular momentum = max |L(t) - L(0)| / sum |x * m*v|
//! ```
//!
//! The shadow energy is the scheme's own ([`Shell::scheme_energy`]), not the mechanical one, which swings about it with
//! every mode: it is kept exactly by every mode of a linear shell. Finite strains pass
//! energy from mode to mode, and what is kept then weighs a mode by 1 + (omega*dt)^2/6 + ... (E. Hairer, C. Lubich, G.
//! Wanner, "Geometric Numerical Integration", chapter IX). So the shadow energy wanders with that exchange, as dt^2,
//! either way, and no further in ten times as many steps: by 1e-3 at 0.9 of the stable step, 5e-5 at a half, 1e-6 at a
//! tenth. A trend of 1e-6 can be separated from it at small steps only, hence [`FRACTION`].

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::Error;
use strainwave::flexspline::shell::ShellState;
use strainwave::flexspline::{FlexsplineParams, Shell, ShellParams};

use crate::design::joint::gear_params;
use crate::io::figure::Figure;
use crate::io::gear_file::GearFile;
use crate::plant::NODES;
use crate::plant::vectorised::Vectorised;
use crate::verify::bounds;
use crate::verify::largest;

/// Step as a fraction of the stable one.
const FRACTION: f64 = 0.05;
/// Motions.
const SEEDS: u64 = 3;
/// Steps that are measured.
const STEPS: usize = 100_000;
/// Steps before that.
const WARM_UP: usize = 5000;
/// Steps between two samples.
const BATCH: usize = 50;
/// Largest velocity of a node by which the ringing is set off, each way (m/s).
const RINGING: f64 = 1.0;
/// Velocity of the drift (m/s).
const DRIFT: [f64; 3] = [0.3, -0.2, 0.5];
/// Speed of the spin about the axis (rad/s).
const SPIN: f64 = 20.0;

const N: usize = NODES.0;
const M: usize = NODES.1;
type State = ShellState<f64, N, M>;

pub(super) fn measure(file: &GearFile) -> Result<Vec<Figure>, Error> {
    let shell = FreeShell::build(&gear_params(file).flexspline)?;
    let changes: Vec<_> = (1..=SEEDS).map(|seed| change(&shell, seed)).collect();
    let worst = |of: usize| largest(changes.iter().map(|change| change[of]));
    Ok(vec![
        bounds::figure("flexspline.free_shell.shadow_energy_trend", worst(0)),
        bounds::figure("flexspline.free_shell.momentum", worst(1)),
        bounds::figure("flexspline.free_shell.angular_momentum", worst(2)),
    ])
}

/// Trend of the shadow energy, largest changes of momentum and of angular momentum, over one motion.
fn change(shell: &FreeShell, seed: u64) -> [f64; 3] {
    let mut state = shell.ringing(seed);
    shell.shell.steps(&mut state, WARM_UP);
    let (mass_moved, mass_turned) = shell.scales(&state);
    let model = shell.shell.model();
    let (momentum, angular) = (model.momentum(&state), model.angular_momentum(&state));
    let (mut energies, mut difference, mut angular_difference) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..STEPS / BATCH {
        shell.shell.steps(&mut state, BATCH);
        energies.push(model.scheme_energy(&state));
        difference.push(distance(model.momentum(&state), momentum));
        angular_difference.push(distance(model.angular_momentum(&state), angular));
    }
    [trend(&energies), largest(difference) / mass_moved, largest(angular_difference) / mass_turned]
}

/// The shell, and the masses of its slices' nodes (kg).
struct FreeShell {
    shell: Vectorised<Shell<f64, N, M>>,
    masses: [f64; M],
}

impl FreeShell {
    fn build(params: &FlexsplineParams<f64>) -> Result<Self, Error> {
        let params = ShellParams { link_damping: 0.0, ..params.shell::<M>(N) };
        let shell = Shell::build(&params, FRACTION * Shell::<f64, N, M>::stable_step(&params))?;
        let mut masses = [params.node_mass(N, M); M];
        masses[0] *= 0.5;
        masses[M - 1] *= 0.5;
        Ok(Self { shell: Vectorised::new(shell), masses })
    }

    /// Round, with the velocities of drift, spin and ringing.
    fn ringing(&self, seed: u64) -> State {
        let mut state = self.shell.model().round();
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        for (i, j) in nodes() {
            let [x, y, _] = state.position(i, j);
            let [u, v, w] = DRIFT.map(|drift| drift + random.random_range(-RINGING..RINGING));
            state.set_velocity(i, j, [u - SPIN * y, v + SPIN * x, w]);
        }
        state
    }

    /// sum |m*v| and sum |x * m*v|.
    fn scales(&self, state: &State) -> (f64, f64) {
        nodes().fold((0.0, 0.0), |(moved, turned), (i, j)| {
            let (position, velocity) = (state.position(i, j), state.velocity(i, j));
            let mass = self.masses[j];
            (moved + mass * length(velocity), turned + mass * length(cross(position, velocity)))
        })
    }
}

fn nodes() -> impl Iterator<Item = (usize, usize)> {
    (0..M).flat_map(|j| (0..N).map(move |i| (i, j)))
}

fn cross([x, y, z]: [f64; 3], [u, v, w]: [f64; 3]) -> [f64; 3] {
    [y * w - z * v, z * u - x * w, x * v - y * u]
}

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|part| part * part).sum::<f64>().sqrt()
}

fn distance(one: [f64; 3], other: [f64; 3]) -> f64 {
    length(std::array::from_fn(|axis| one[axis] - other[axis]))
}

/// Rise of a least-squares line through evenly spaced samples over all of them, relative to their mean.
fn trend(samples: &[f64]) -> f64 {
    let count = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / count;
    let from_middle = |k: usize| k as f64 - 0.5 * (count - 1.0);
    let (mut along, mut squares) = (0.0, 0.0);
    for (k, sample) in samples.iter().enumerate() {
        along += from_middle(k) * (sample - mean);
        squares += from_middle(k).powi(2);
    }
    along / squares * count / mean
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_trend_of_a_line_is_its_rise_and_of_a_swing_next_to_none() {
        let line: Vec<f64> = (0..1000).map(|k| 5.0 + 1e-3 * f64::from(k)).collect();
        assert!((trend(&line) - 1.0 / 5.4995).abs() < 1e-12, "{}", trend(&line));
        let swing: Vec<f64> = (0..1000).map(|k| 5.0 + (f64::from(k) * 1.7).sin()).collect();
        assert!(trend(&swing).abs() < 1e-3, "{}", trend(&swing));
    }
}
