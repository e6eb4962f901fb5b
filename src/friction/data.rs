//! Data of a friction contact: one vocabulary, from which the parameters of every registered model follow.
//!
//! | name of the datum | field | symbol | where it is unknown |
//! | --- | --- | --- | --- |
//! | `coulomb_nm` | [`Sliding::coulomb`] | Fc | |
//! | `static_nm` | [`Sliding::static_level`] | Fs >= Fc | |
//! | `stribeck_rad_per_s` | [`Sliding::stribeck_velocity`] | vs | |
//! | `stribeck_exponent` | [`Sliding::stribeck_exponent`] | delta, 1 or 2 | |
//! | `viscous_nm_s_per_rad` | [`Sliding::viscous`] | Fv | |
//! | `ripple_cosines`, `ripple_sines` | [`Sliding::ripple`] | a_k, b_k over the level | none |
//! | `presliding_rad` | [`FrictionData::presliding`] | eps | |
//! | `presliding_ratio` | [`FrictionData::presliding_ratio`] | eta | |
//! | `dead_band_rad_per_s` | [`FrictionData::dead_band`] | DV | |
//! | `frictional_memory_s` | [`FrictionData::frictional_memory`] | tau_L | |
//! | `dwell_s` | [`FrictionData::dwell`] | gamma | |
//! | `dahl_exponent` | [`FrictionData::dahl_exponent`] | i, 0, 1 or 2 | 1 |
//! | `micro_damping_nm_s_per_rad` | [`FrictionData::micro_damping`] | sigma1 | 0 |
//! | `load_driving`, `load_driven` | [`FrictionData::load`] | level over torque | 0 |
//! | `backward` | [`FrictionData::backward`] | of motion backwards | as forwards |
//! | `state_space` | [`FrictionData::state_space`] | A, B, C of eq. (8) | |
//!
//! Names have their unit, as gear files have it. eps is the distance over which friction builds up from rest, and the
//! level over eps the stiffness there. A number that is unknown is NaN, unless the last column has another one: a model that
//! needs it refuses to be built, by the name of its parameter.

use super::load_dependence::LoadFactors;
use super::ripple::{Harmonics, RIPPLE_ORDERS};
use crate::real::Real;

/// Greatest order of a state space.
pub const MOST_STATES: usize = 4;

/// Level of sliding.
pub(super) const COULOMB: &[&str] = &["coulomb_nm"];
/// Levels of sliding and of standstill.
pub(super) const LEVELS: &[&str] = &["coulomb_nm", "static_nm"];
/// Friction over speed.
pub(super) const CURVE: &[&str] =
    &["coulomb_nm", "static_nm", "stribeck_rad_per_s", "stribeck_exponent", "viscous_nm_s_per_rad"];
/// Presliding distance.
pub(super) const PRESLIDING: &[&str] = &["presliding_rad"];

/// Data of one contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionData<R> {
    /// Sliding forwards.
    pub forward: Sliding<R>,
    /// Sliding backwards.
    pub backward: Sliding<R>,
    /// eps (m) or (rad).
    pub presliding: R,
    /// eta, ratio of the two presliding distances of order 2.
    pub presliding_ratio: R,
    /// DV, below which a body counts as standing (m/s) or (rad/s).
    pub dead_band: R,
    /// tau_L, by which the Stribeck effect lags behind the speed (s).
    pub frictional_memory: R,
    /// gamma, in which static friction rises by half (s).
    pub dwell: R,
    /// i, shape exponent of Dahl's presliding.
    pub dahl_exponent: R,
    /// sigma1 (N s/m) or (N m s/rad).
    pub micro_damping: R,
    /// Part of the level by the torque through the contact.
    pub load: LoadFactors<R>,
    /// Matrices of eq. (8).
    pub state_space: StateMatrices<R>,
}

/// Friction over speed and over the wave generator's angle, in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sliding<R> {
    /// Fc (N) or (N m).
    pub coulomb: R,
    /// Fs (N) or (N m).
    pub static_level: R,
    /// vs (m/s) or (rad/s).
    pub stribeck_velocity: R,
    /// delta.
    pub stribeck_exponent: R,
    /// Fv (N s/m) or (N m s/rad).
    pub viscous: R,
    /// Ripple, of a mean of 1.
    pub ripple: Harmonics<R, RIPPLE_ORDERS>,
}

/// Matrices of eq. (8) up to order [`MOST_STATES`]; entries beyond `order` are unused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateMatrices<R> {
    /// P, number of states; 0 where the matrices are unknown.
    pub order: usize,
    /// A by rows (1/m) or (1/rad).
    pub a: [[R; MOST_STATES]; MOST_STATES],
    /// B (1/m) or (1/rad).
    pub b: [R; MOST_STATES],
    /// C (N) or (N m).
    pub c: [R; MOST_STATES],
}

impl<R: Real> FrictionData<R> {
    /// No datum is known.
    pub fn unknown() -> Self {
        let unknown = R::lit(f64::NAN);
        Self {
            forward: Sliding::unknown(),
            backward: Sliding::unknown(),
            presliding: unknown,
            presliding_ratio: unknown,
            dead_band: unknown,
            frictional_memory: unknown,
            dwell: unknown,
            dahl_exponent: R::ONE,
            micro_damping: R::ZERO,
            load: LoadFactors::default(),
            state_space: StateMatrices::unknown(),
        }
    }

    /// Data of a contact that breaks away at `level` (N) and slides at two thirds of it, with presliding over `distance` (m),
    /// without viscous friction.
    pub fn falling(level: f64, distance: f64) -> Self {
        let sliding = Sliding {
            coulomb: R::lit(level / 1.5),
            static_level: R::lit(level),
            stribeck_velocity: R::lit(0.1),
            stribeck_exponent: R::lit(2.0),
            viscous: R::ZERO,
            ..Sliding::unknown()
        };
        Self { forward: sliding, backward: sliding, presliding: R::lit(distance), ..Self::unknown() }
    }
}

impl<R: Real> Sliding<R> {
    /// No datum is known.
    pub fn unknown() -> Self {
        let unknown = R::lit(f64::NAN);
        Self {
            coulomb: unknown,
            static_level: unknown,
            stribeck_velocity: unknown,
            stribeck_exponent: unknown,
            viscous: unknown,
            ripple: Harmonics::NONE,
        }
    }
}

impl<R: Real> StateMatrices<R> {
    /// No entry is known.
    pub fn unknown() -> Self {
        let row = [R::lit(f64::NAN); MOST_STATES];
        Self { order: 0, a: [row; MOST_STATES], b: row, c: row }
    }
}
