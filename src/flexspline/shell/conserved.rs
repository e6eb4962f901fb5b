//! Energy, momentum and angular momentum of a shell: what a free, undamped one keeps.

use core::ops::Range;

use super::ring::Ring;
use super::{Shell, ShellState, Slice, mass_share};
use crate::real::Real;

impl<R: Real, const N: usize, const M: usize> Shell<R, N, M> {
    /// Elastic energy of all links (J).
    pub fn elastic_energy(&self, state: &ShellState<R, N, M>) -> R {
        let mut energy = R::ZERO;
        self.for_each_link(state, |direction, _, _, u| {
            let square = direction.rest_length * direction.rest_length;
            energy += self.stiffness * square * self.bend_of(direction).potential(u);
        });
        energy
    }

    /// Kinetic energy of the nodes of some slices (J).
    pub fn kinetic_energy(&self, state: &ShellState<R, N, M>, slices: Range<usize>) -> R {
        slices.fold(R::ZERO, |energy, j| {
            let squares =
                entries(&state.velocity[j]).fold(R::ZERO, |sum, [x, y, z]| sum + x * x + y * y + z * z);
            energy + R::lit(0.5) * self.node_mass * mass_share::<R>(j, M).0 * squares
        })
    }

    /// Invariant of the semi-implicit scheme for a linear mesh, exact: the energy less dt/2 times the power of
    /// the links, dV/dt. The energy itself oscillates about it, by omega*dt of itself.
    pub fn scheme_energy(&self, state: &ShellState<R, N, M>) -> R {
        let mut force = [[Ring::ZERO; 3]; M];
        self.pull(state, &mut force);
        let power =
            force.iter().zip(&state.velocity).flat_map(|(force, velocity)| force.iter().zip(velocity));
        let power = power.fold(R::ZERO, |sum, (force, velocity)| {
            force.entries().iter().zip(velocity.entries()).fold(sum, |sum, (f, v)| sum + *f * *v)
        });
        let energy = self.elastic_energy(state) + self.kinetic_energy(state, 0..M);
        energy + R::lit(0.5) * self.dt * power
    }

    /// Momentum (kg m/s).
    pub fn momentum(&self, state: &ShellState<R, N, M>) -> [R; 3] {
        self.moments(state, |_, velocity| velocity)
    }

    /// Angular momentum about the origin (kg m^2/s).
    pub fn angular_momentum(&self, state: &ShellState<R, N, M>) -> [R; 3] {
        self.moments(state, |[x, y, z], [u, v, w]| [y * w - z * v, z * u - x * w, x * v - y * u])
    }

    /// Sum of mass times a vector that follows from each node's position and velocity.
    fn moments(&self, state: &ShellState<R, N, M>, of: impl Fn([R; 3], [R; 3]) -> [R; 3]) -> [R; 3] {
        let mut total = [R::ZERO; 3];
        for (j, (position, velocity)) in state.position.iter().zip(&state.velocity).enumerate() {
            let mass = self.node_mass * mass_share::<R>(j, M).0;
            for (position, velocity) in entries(position).zip(entries(velocity)) {
                for (total, part) in total.iter_mut().zip(of(position, velocity)) {
                    *total += mass * part;
                }
            }
        }
        total
    }
}

/// The vectors of a slice, entry by entry.
fn entries<R: Real, const N: usize>(slice: &Slice<R, N>) -> impl Iterator<Item = [R; 3]> + '_ {
    let [x, y, z] = slice.each_ref().map(|axis| axis.entries().iter().copied());
    x.zip(y).zip(z).map(|((x, y), z)| [x, y, z])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flexspline::calibration::tests::SIZE_25;
    use crate::flexspline::shell::{Bend, ShellParams};

    fn params(bend: Bend<f64>) -> ShellParams<f64> {
        ShellParams { cup: SIZE_25.cup, link_stiffness: 6e6, link_damping: 0.0, bend }
    }

    /// A shell that spins, drifts and rings.
    fn ringing<const N: usize, const M: usize>(shell: &Shell<f64, N, M>) -> ShellState<f64, N, M> {
        let mut state = shell.round();
        for j in 0..M {
            for i in 0..N {
                let [x, y, z] = state.position(i, j);
                let ripple = (2.0 * y.atan2(x) + 60.0 * z).sin();
                state.set_velocity(i, j, [1.0 - 20.0 * y + ripple, 20.0 * x - ripple, 0.3 + 2.0 * ripple]);
            }
        }
        state
    }

    #[test]
    fn a_free_shell_keeps_momentum_angular_momentum_and_energy() {
        for bend in [Bend::LINEAR, Bend { hardening: 2e4, saturation: 4e-3 }] {
            let shell = Shell::<f64, 8, 3>::build(&params(bend), 1e-6).unwrap();
            let mut state = ringing(&shell);
            let kept = |state: &ShellState<f64, 8, 3>| {
                (shell.momentum(state), shell.angular_momentum(state), shell.scheme_energy(state))
            };
            let (momentum, angular, energy) = kept(&state);
            for _ in 0..2000 {
                assert_eq!(shell.step(&mut state), 0.0);
            }
            let (momentum_now, angular_now, energy_now) = kept(&state);
            for axis in 0..3 {
                assert!((momentum_now[axis] - momentum[axis]).abs() < 1e-13 * momentum[0]);
                assert!((angular_now[axis] - angular[axis]).abs() < 1e-13 * angular[2]);
            }
            assert!((energy_now / energy - 1.0).abs() < 1e-3, "{energy} {energy_now}");
        }
    }

    #[test]
    fn what_the_links_lose_is_what_the_shell_loses() {
        let damped = ShellParams { link_damping: 0.2, ..params(Bend::LINEAR) };
        let shell = Shell::<f64, 8, 3>::build(&damped, 1e-8).unwrap();
        let mut state = ringing(&shell);
        let before = shell.scheme_energy(&state);
        let lost: f64 = (0..2000).map(|_| 1e-8 * shell.step(&mut state)).sum();
        let gone = before - shell.scheme_energy(&state);
        assert!(lost > 1e-4 * before && (gone / lost - 1.0).abs() < 1e-2, "{gone} J gone, {lost} J lost");
    }
}
