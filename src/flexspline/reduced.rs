//! The mesh in real time: the same N x M links, condensed to one law and two shapes.
//!
//! ```text
//! tau = limit(line(phi) + c_piece*dphi, 5*tau_rated)
//! displacement(i, j) = tau*twist_j + ellipse_j at b,    b = a_i + theta_fs - theta_wg,    a_i = 2*pi*i/N
//! ```
//!
//! Torque in N m, torsion phi in rad, drive angle less flange angle. No state.
//!
//! # Derivation from eq. (6)
//!
//! 1. About the round, unloaded shape the link forces are linear in the displacements, and the same all around: the
//!    stiffness is block-circulant and a Fourier transform around the ring decouples its harmonics
//!    (`condensation.rs`). What drives the mesh lies in two of them: the torque in harmonic 0, the ellipse
//!    w0*cos(2b), -(w0/2)*sin(2b) in harmonic 2. The ellipse transmits no torque, and a mirror keeps the
//!    tangential part of harmonic 0 apart from the rest: a chain of M angles.
//! 2. The shell is so light that at 0.1 ms it is at rest in its shape: acceleration and mu drop out of
//!    eq. (6), the inner slices follow from the ends, once, at build. What is left is `twist`, the angle of
//!    every slice per torque, `ellipse`, three amplitudes a slice, and the chain's stiffness, which the
//!    calibration of k makes that of the tube, G*J/l, for every N x M ([`super::calibration`]).
//! 3. The rim between shell and tooth contact has no inertia that matters, so the two are in series: compliances
//!    add, which gives `line`, and the contact's dashpot takes its fraction of the motion, and acts back through it:
//!    `c_piece = c_contact*(K_piece/K_contact,piece)^2`.
//!
//! With [`Hardening::Bends`] the torsion's chain of step 1 is not linear. It is settled torsion by torsion at build, from the
//! same links (`chain.rs`), and `line` is its torque in eight straight pieces; `twist` gets a part by the torsion. The dashpot
//! lies across the whole.
//!
//! Nothing is integrated, so no time step is too long: of the two limits of the explicit mesh, 2/omega of the
//! links (2 to 6 us) has gone with their inertia, and the dashpot's with the rim's. The joint's own mode is
//! left, which the gear steps: dt*sqrt(K3/J_fs) = 0.022 where the scheme allows 2.
//!
//! # What is neglected
//!
//! Size 25, K_shell = 1.603e5 N m/rad, K_contact,1 = 3.84e4 N m/rad, c_contact = 11.9 N m s/rad:
//!
//! | term | size |
//! | --- | --- |
//! | inertia of the shell m*R^2 = 0.0226*0.031^2 = 2.2e-5 kg m^2 | 1.8e-5 of J_fs |
//! | its modes: torsion, (pi/l)*sqrt(G/rho) = 2.7e5 rad/s, under the joint's sqrt(K3/J_fs) = 218 rad/s | (218/2.7e5)^2 = 6.5e-7 of the twist |
//! | the same of the ellipse, lowest mode 8.6e4 (8 x 3), 7.4e4 rad/s (36 x 4), under 2*586 rad/s | 1.8e-4, 2.5e-4 of its inner slices |
//! | the shell's own damping mu: as zeta = 0.02 of those modes | 0.02*218/2.7e5 = 1.6e-5 of the damping |
//! | the dashpot against both springs, c_contact/(K_contact + K_shell) = 60 us, at sqrt(K1/J_fs) = 161 rad/s | (161*6e-5)^2 = 9e-5 of the damping |
//! | the ellipse's tension in the links, second order in w0/R | 7.1e-4 of K1 (8 x 3), 3.4e-5 (36 x 4): `verify flexspline` |
//! | the ellipse's reaction on the wave generator, zero on average | at rated torsion 3.9e-4 N m (8 x 3): `verify flexspline` |
//! | with the hardening in the contact: that of the bend links from their free length, none by default | hardening*(4.8e-3)^2 of a bend link's stiffness |
//! | with the hardening in the bend links: the law's straight pieces, torsion times ellipse, pre-strain | `flexspline.bends.8x3.law` |
//! | inner slices' second-order displacement, harmonics 0 and 4 | strain 2.7e-5 (8 x 3), 5.0e-5 (36 x 4): [`super::StrainGauge`] |
//!
//! # Range
//!
//! Up to [`RANGE`] times the rated torque. There the law ends: torque is limited and the step says
//! `saturated`. Energy and loss are those of the limited line, so what is limited stays passive: limiting is
//! monotone, hence `limit(line + c*dphi) - limit(line)` never has the sign against dphi.

use crate::angle::Angle;
use crate::constants::constants;
use crate::error::{Error, require};
use crate::flexspline::calibration::{FlexsplineParams, Hardening};
use crate::flexspline::chain::MeshLaw;
use crate::flexspline::condensation::{Displacement, Link, Shape, settled};
use crate::flexspline::cup::{Cup, DIRECTIONS};
use crate::flexspline::stiffness_line::TorsionLaw;
use crate::flexspline::{Ends, Flexspline, Reaction};
use crate::real::Real;

/// Largest torque that the law gives, in rated torques.
///
/// Past it a gear is no spring any more, its teeth ratchet: size 25, ratio 100, rated at 67 N m, at 500 N m
/// (Harmonic Drive CSF catalogue, table 4), 7.5 times; sizes 17, 20 and 25 of the stronger CSG series at 200,
/// 330 and 610 N m (table 6), 6.3 to 7.0 times the 31, 52 and 87 N m that gears of that class are rated at
/// (Schaeffler RT1-H-CS). The peak torque in operation, 157 N m of the default gear, is 2.3 times.
pub const RANGE: f64 = 5.0;

/// Node i of slice j, slice 0 the rim.
pub type Node = (usize, usize);

/// Steps around and along that a link spans, one of the 16.
pub type Direction = (i32, i32);

/// The condensed N x M mesh.
///
/// One law in the place of thousands of steps: a damped spring along the catalogue's line. It says where each slice of
/// the cup stands, too: the rim turns ahead of the flange by the torque over the stiffness of the tube.
///
/// ```
/// # mod joint { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/joint/hd25_100.rs")); }
/// # use joint::JOINT;
/// use strainwave::flexspline::Reduced;
///
/// let (params, rated) = (JOINT.gear.flexspline, JOINT.gear.rated_torque);
/// let flexspline = Reduced::<f32, 8, 3>::build(&params, rated)?;
/// let torsion = flexspline.torsion(40.0);
/// assert!((flexspline.torque(torsion, 0.0) - 40.0).abs() < 1e-3);
/// assert!(flexspline.torque(torsion, 0.1) > 40.0); // damping resists the motion
/// assert!(flexspline.saturates(flexspline.torque(1.0, 0.0))); // bounded: at 5 times the rated torque
/// let [rim, .., flange] = flexspline.twist(); // rad/(N m)
/// assert_eq!(flange, 0.0);
/// assert!((rim * params.cup.stiffness() - 1.0).abs() < 1e-4);
/// # Ok::<(), strainwave::Error>(())
/// ```
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reduced<R, const N: usize, const M: usize> {
    line: TorsionLaw<R>,
    /// Dashpot of each piece of the line (N m s/rad).
    damping: [R; 8],
    /// End of the law's range, as a torque (N m) and as a torsion at rest (rad).
    largest_torque: R,
    largest_torsion: R,
    cup: Cup<R>,
    /// Displacement of every slice per torque (m/(N m)).
    pub(super) twist: Shape<R, M>,
    /// Rotation of every slice per torsion, that per torque apart: none where the hardening is in the contact.
    leading: [R; M],
    /// Amplitudes of harmonic 2 of every slice (m).
    ellipse: Shape<R, M>,
}

impl<R: Real, const N: usize, const M: usize> Reduced<R, N, M> {
    /// Condenses the N x M mesh that these parameters describe, for a gear of this rated torque (N m).
    ///
    /// # Errors
    /// As [`FlexsplineParams::check`]; `n` outside 5..=1000, `m` outside 3..=32; `rated_torque` unless it is
    /// positive and [`RANGE`] times it is finite.
    pub fn build(params: &FlexsplineParams<R>, rated_torque: R) -> Result<Self, Error> {
        params.check()?;
        require((5..=1000).contains(&N), "n")?;
        require((3..=32).contains(&M), "m")?;
        let largest_torque = R::lit(RANGE) * rated_torque;
        require(largest_torque.is_positive(), "rated_torque")?;
        let cup = params.cup;
        let mut reduced = match params.hardening {
            Hardening::Contact => Self::with_contact(params)?,
            Hardening::Bends => Self::with_bends(params, largest_torque)?,
        };
        reduced.largest_torque = largest_torque;
        reduced.largest_torsion = reduced.line.torsion(largest_torque);
        reduced.ellipse = settled(&cup, N, 2, [cup.ellipse, R::lit(-0.5) * cup.ellipse, R::ZERO]);
        Ok(reduced)
    }

    /// Law and twist of a linear shell in series with the contact.
    fn with_contact(params: &FlexsplineParams<R>) -> Result<Self, Error> {
        let contact = params.contact_line();
        let cup = params.cup;
        let whole = contact.in_series(cup.stiffness());
        let piece = |k: usize| whole.stiffness[k.min(2)] / contact.stiffness[k.min(2)];
        let damping = core::array::from_fn(|k| params.contact_damping() * (piece(k) * piece(k)));
        let twist = settled(&cup, N, 0, [R::ZERO, cup.radius / cup.stiffness(), R::ZERO]);
        Ok(Self::of(cup, whole.build_law()?, damping, twist, [R::ZERO; M]))
    }

    /// Law and twist of a shell whose bend links harden.
    fn with_bends(params: &FlexsplineParams<R>, largest_torque: R) -> Result<Self, Error> {
        let MeshLaw { line, by_torsion, by_torque } = params.mesh_law::<M>(N, largest_torque)?;
        let twist = by_torque.map(|angle| [R::ZERO, angle * params.cup.radius, R::ZERO]);
        Ok(Self::of(params.cup, line, [params.damping(); 8], twist, by_torsion))
    }

    /// Without range and ellipse.
    fn of(cup: Cup<R>, line: TorsionLaw<R>, damping: [R; 8], twist: Shape<R, M>, leading: [R; M]) -> Self {
        let ellipse = [[R::ZERO; 3]; M];
        Self {
            line,
            damping,
            largest_torque: R::ZERO,
            largest_torsion: R::ZERO,
            cup,
            twist,
            leading,
            ellipse,
        }
    }

    /// Torque at a torsion and its rate (N m), within +-[`RANGE`] times the rated torque; for NaN it is that
    /// bound too.
    #[inline(never)] // The timing budget counts blocks by their symbols.
    pub fn torque(&self, torsion: R, rate: R) -> R {
        let (torque, piece) = self.line.torque_and_piece(torsion);
        (torque + self.damping[piece] * rate).limit(self.largest_torque)
    }

    /// A torque of [`Self::torque`] is at the end of its range.
    #[inline(always)]
    pub fn saturates(&self, torque: R) -> bool {
        torque.abs() >= self.largest_torque
    }

    /// Torsion for a torque at rest (rad); the line continues beyond its range.
    #[inline(always)]
    pub fn torsion(&self, torque: R) -> R {
        self.line.torsion(torque)
    }

    /// Slope of that torsion over the torque (rad/(N m)).
    #[inline(always)]
    pub fn compliance(&self, torque: R) -> R {
        self.line.compliance(torque)
    }

    /// Angle of each slice relative to the flange, per small torque (rad/(N m)); rim first.
    pub fn twist(&self) -> [R; M] {
        core::array::from_fn(|j| self.turned(j, R::ONE, self.compliance(R::ZERO))[1] / self.cup.radius)
    }

    /// Angle of each slice relative to the flange under a torque at rest (rad); rim first.
    pub fn angles(&self, torque: R) -> [R; M] {
        core::array::from_fn(|j| self.turned(j, torque, self.torsion(torque))[1] / self.cup.radius)
    }

    /// Tangential displacement of every slice per torsion, that per torque apart (m/rad).
    pub(super) fn leading(&self) -> [R; M] {
        self.leading.map(|angle| angle * self.cup.radius)
    }

    /// Displacement of a slice by a torque and its torsion (m).
    fn turned(&self, j: usize, torque: R, torsion: R) -> Displacement<R> {
        let [radial, tangential, axial] = self.twist[j].map(|per_torque| torque * per_torque);
        [radial, tangential + torsion * self.leading[j] * self.cup.radius, axial]
    }

    /// Radial, tangential and axial amplitude of each slice under the ellipse (m): at the angle b from the wave
    /// generator's major axis radial*cos(2b), tangential*sin(2b), axial*cos(2b); rim first.
    pub fn ellipse(&self) -> [[R; 3]; M] {
        self.ellipse
    }

    /// Radial, tangential and axial displacement of node i of slice j from the round, unloaded cup (m), seen from
    /// the flange: `wave_generator` is theta_wg - theta_fs.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `node` unless i < N and j < M.
    pub fn displacement(&self, (i, j): Node, torque: R, wave_generator: Angle<R>) -> Result<[R; 3], Error> {
        require(i < N && j < M, "node")?;
        let [radial, tangential, axial] = self.pressed(i, j, wave_generator);
        let [_, turned, _] = self.turned(j, torque, self.torsion(torque));
        Ok([radial, tangential + turned, axial])
    }

    /// Strain L/L0 - 1 of the link from `node` (i, j) that spans `direction` (around, along), either way: exact
    /// in the ellipse's displacement of its ends, to first order in the torque's; `wave_generator` is
    /// theta_wg - theta_fs. For one place that is read in every control step build a [`super::StrainGauge`].
    ///
    /// # Errors
    /// [`Error::OutOfRange`] `node` unless i < N and j < M; `direction` unless it is one of the 16 and ends
    /// within the cup.
    pub fn strain(
        &self,
        node: Node,
        direction: Direction,
        torque: R,
        wave_generator: Angle<R>,
    ) -> Result<R, Error> {
        let (link, ends) = self.link(node, direction)?;
        let [near, far] = ends.map(|(i, j)| self.pressed(i, j, wave_generator));
        let turned = ends.map(|(_, j)| self.turned(j, torque, self.torsion(torque)));
        Ok(link.strain(near, far) + link.linear_strain(turned[0], turned[1]))
    }

    /// Strain of the same link per torque (1/(N m)), that per small torque where the bend links harden.
    ///
    /// # Errors
    /// As [`Reduced::strain`].
    pub fn strain_per_torque(&self, node: Node, direction: Direction) -> Result<R, Error> {
        let (link, ends) = self.link(node, direction)?;
        let [near, far] = ends.map(|(_, j)| self.turned(j, R::ONE, self.compliance(R::ZERO)));
        Ok(link.linear_strain(near, far))
    }

    /// A link and the two nodes that it joins, near one first.
    fn link(&self, (i, j): Node, (around, along): Direction) -> Result<(Link<R>, [Node; 2]), Error> {
        require(i < N && j < M, "node")?;
        let spans = |sign: i32| move |(a, s): &(i32, usize)| (sign * a, sign * *s as i32) == (around, along);
        let forward = DIRECTIONS.into_iter().find(spans(1));
        let direction =
            forward.or(DIRECTIONS.into_iter().find(spans(-1))).ok_or(Error::OutOfRange("direction"))?;
        let slice = j.checked_add_signed(along as isize).filter(|slice| *slice < M);
        let other =
            ((i as i32 + around).rem_euclid(N as i32) as usize, slice.ok_or(Error::OutOfRange("direction"))?);
        let link = Link::new(&self.cup, N, M, direction);
        Ok((link, if forward.is_some() { [(i, j), other] } else { [other, (i, j)] }))
    }

    /// Displacement of a node that exists, by the ellipse.
    fn pressed(&self, i: usize, j: usize, wave_generator: Angle<R>) -> Displacement<R> {
        let around: Angle<R> = Angle::from_turn_fraction(i as i32, N as i32);
        let (sine, cosine) = R::sin_cos_phase(around.less(wave_generator).phase().wrapping_mul(2));
        let [radial, tangential, axial] = self.ellipse[j];
        [radial * cosine, tangential * sine, axial * cosine]
    }
}

impl<R: Real, const N: usize, const M: usize> Flexspline<R> for Reduced<R, N, M> {
    type State = ();

    fn rest(&self) -> Self::State {}

    fn step(&self, _state: &mut Self::State, ends: &Ends<R>) -> Reaction<R> {
        let torsion = ends.drive.minus(ends.flange);
        let rate = ends.drive_rate - ends.flange_rate;
        let torque = self.torque(torsion, rate);
        let elastic = self.line.torque(torsion).limit(self.largest_torque);
        Reaction {
            torsion,
            contact: torque,
            flange: torque,
            ellipse: R::ZERO,
            loss: (torque - elastic) * rate,
            saturated: self.saturates(torque),
        }
    }

    fn energy(&self, _state: &Self::State, ends: &Ends<R>) -> R {
        let torsion = ends.drive.minus(ends.flange);
        let beyond = (torsion.abs() - self.largest_torsion).max(R::ZERO);
        self.line.energy(torsion.limit(self.largest_torsion)) + self.largest_torque * beyond
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flexspline::calibration::tests::SIZE_25;
    use crate::flexspline::shell::Bend;
    use proptest::prelude::*;

    const RATED: f64 = 67.0;
    const LARGEST: f64 = RANGE * RATED;

    fn reduced() -> Reduced<f64, 8, 3> {
        Reduced::build(&SIZE_25, RATED).unwrap()
    }

    /// The same in the firmware's precision.
    fn single() -> Reduced<f32, 8, 3> {
        let cup = SIZE_25.cup;
        let params = FlexsplineParams {
            cup: Cup {
                radius: cup.radius as f32,
                length: cup.length as f32,
                wall: cup.wall as f32,
                ellipse: cup.ellipse as f32,
                youngs_modulus: cup.youngs_modulus as f32,
                poisson_ratio: cup.poisson_ratio as f32,
                density: cup.density as f32,
            },
            line: crate::flexspline::stiffness_line::StiffnessLineParams {
                stiffness: SIZE_25.line.stiffness.map(|k| k as f32),
                knee_torque: SIZE_25.line.knee_torque.map(|torque| torque as f32),
            },
            damping_ratio: SIZE_25.damping_ratio as f32,
            inertia: SIZE_25.inertia as f32,
            hardening: Hardening::Contact,
            bend: Bend::LINEAR,
        };
        Reduced::build(&params, RATED as f32).unwrap()
    }

    fn ends(torsion: f64, rate: f64) -> Ends<f64> {
        Ends { drive: Angle::from_radians(torsion), drive_rate: rate, ..Ends::default() }
    }

    fn step(torsion: f64, rate: f64) -> Reaction<f64> {
        reduced().step(&mut (), &ends(torsion, rate))
    }

    proptest! {
        #[test]
        fn any_bits_give_a_torque_within_the_range(torsion: u32, rate: u32) {
            let (reduced, largest) = (single(), LARGEST as f32);
            let (torsion, rate) = (f32::from_bits(torsion), f32::from_bits(rate));
            let torque = reduced.torque(torsion, rate);
            prop_assert!(torque.abs() <= largest, "{} at {}, {}", torque, torsion, rate);
            let ends = Ends { flange: Angle { counts: 0, rest: torsion }, drive_rate: rate, ..Ends::default() };
            let reaction = reduced.step(&mut (), &ends);
            prop_assert!(reaction.flange.abs() <= largest && reaction.contact == reaction.flange);
            prop_assert!(reaction.saturated || (torsion.is_finite() && rate.is_finite()));
        }

        #[test]
        fn within_the_range_it_is_line_and_dashpot(torsion in -8e-3..8e-3f64, rate in -40.0..40.0f64) {
            let reduced = reduced();
            let whole = reduced.line.torque(torsion) + reduced.damping[reduced.line.piece(torsion)] * rate;
            prop_assert_eq!(reduced.torque(torsion, rate), whole.clamp(-LARGEST, LARGEST));
            // An angle holds the torsion to 1e-16 rad.
            prop_assume!((whole.abs() - LARGEST).abs() > 1e-9);
            let reaction = step(torsion, rate);
            prop_assert_eq!(reaction.saturated, whole.abs() > LARGEST);
            prop_assert!((reaction.flange - whole.clamp(-LARGEST, LARGEST)).abs() < 1e-9);
        }

        /// At rest everywhere, and at a rate within each piece; from one to the next the dashpot steps.
        #[test]
        fn torque_rises_with_torsion(a in -0.1..0.1f64, b in -0.1..0.1f64, rate in -1e3..1e3f64) {
            let (low, high) = (a.min(b), a.max(b));
            let reduced = reduced();
            prop_assert!(reduced.torque(low, 0.0) <= reduced.torque(high, 0.0));
            if reduced.line.piece(low) == reduced.line.piece(high) {
                prop_assert!(reduced.torque(low, rate) <= reduced.torque(high, rate));
            }
        }

        /// Bend links that harden: torque rises, is the slope of the energy, and the damping never drives.
        #[test]
        fn a_hardening_mesh_is_monotone_and_passive(a in -0.02..0.02f64, b in -0.02..0.02f64, rate in -1e3..1e3f64) {
            let params = FlexsplineParams { hardening: Hardening::Bends, ..SIZE_25 };
            let reduced = Reduced::<f64, 8, 3>::build(&params, RATED).unwrap();
            let (low, high) = (a.min(b), a.max(b));
            prop_assert!(reduced.torque(low, rate) <= reduced.torque(high, rate));
            prop_assert_eq!(reduced.torque(-a, -rate), -reduced.torque(a, rate));
            let energy = |torsion| reduced.energy(&(), &ends(torsion, 0.0));
            let slope = (energy(a + 1e-7) - energy(a - 1e-7)) / 2e-7;
            prop_assert!((slope - reduced.torque(a, 0.0)).abs() < 5e-3);
            prop_assert!(reduced.step(&mut (), &ends(a, rate)).loss >= 0.0);
        }

        /// Damping is dissipative: the torque beyond the elastic one never drives.
        #[test]
        fn it_is_passive(torsion in -0.1..0.1f64, rate in -1e4..1e4f64) {
            let dashpot = step(torsion, rate).flange - step(torsion, 0.0).flange;
            prop_assert!(dashpot * rate >= 0.0);
            prop_assert!((step(torsion, rate).loss - dashpot * rate).abs() <= 1e-9 * (1.0 + (dashpot * rate).abs()));
        }

        #[test]
        fn torque_at_rest_is_the_slope_of_the_energy(torsion in -0.02..0.02f64) {
            let energy = |torsion| reduced().energy(&(), &ends(torsion, 0.0));
            let slope = (energy(torsion + 1e-7) - energy(torsion - 1e-7)) / 2e-7;
            prop_assert!((slope - step(torsion, 0.0).flange).abs() < 5e-3);
        }

        /// The rim follows the wave generator's inextensional ellipse, rotated by the torque; the flange is fixed.
        #[test]
        fn the_ends_stand_where_they_are_held(i in 0..8usize, torque in -300.0..300.0f64, counts: u32) {
            let (cup, angle) = (SIZE_25.cup, Angle::from_counts(i64::from(counts)));
            let b = core::f64::consts::TAU * i as f64 / 8.0 - angle.to_radians();
            let [radial, tangential, axial] = reduced().displacement((i, 0), torque, angle).unwrap();
            let turned = torque / cup.stiffness() * cup.radius;
            prop_assert!((radial - cup.ellipse * (2.0 * b).cos()).abs() < 1e-11);
            prop_assert!((tangential - turned + 0.5 * cup.ellipse * (2.0 * b).sin()).abs() < 1e-11);
            prop_assert_eq!(axial, 0.0);
            prop_assert_eq!(reduced().displacement((i, 2), torque, angle), Ok([0.0; 3]));
        }
    }

    #[test]
    fn not_a_number_is_beyond_the_range() {
        for (torsion, rate) in [(f64::NAN, 0.0), (0.0, f64::NAN), (f64::INFINITY, f64::NEG_INFINITY)] {
            assert!(reduced().torque(torsion, rate).abs() <= LARGEST);
        }
        assert!(step(0.0, f64::NAN).saturated && step(0.0, f64::INFINITY).saturated);
    }

    #[test]
    fn the_twist_falls_from_the_shells_compliance_to_none() {
        let twist = Reduced::<f64, 36, 4>::build(&SIZE_25, RATED).unwrap().twist();
        assert!((twist[0] * SIZE_25.cup.stiffness() - 1.0).abs() < 1e-12);
        assert!(twist.is_sorted_by(|a, b| a > b) && twist[3] == 0.0, "{twist:?}");
    }

    #[test]
    fn single_precision_has_the_same_shapes() {
        let (double, single) = (reduced(), single());
        for (a, b) in double.twist().iter().zip(single.twist()) {
            assert!((a - f64::from(b)).abs() < 1e-6 * double.twist()[0]);
        }
        for (a, b) in double.ellipse().as_flattened().iter().zip(single.ellipse().as_flattened()) {
            assert!((a - f64::from(*b)).abs() < 1e-6 * SIZE_25.cup.ellipse);
        }
    }

    #[test]
    fn what_is_no_mesh_is_refused_by_name() {
        let refused = |torque| Reduced::<f64, 8, 3>::build(&SIZE_25, torque).err();
        for torque in [0.0, -1.0, f64::NAN, f64::INFINITY, f64::MAX] {
            assert_eq!(refused(torque), Some(Error::OutOfRange("rated_torque")));
        }
        assert_eq!(Reduced::<f64, 4, 3>::build(&SIZE_25, RATED).err(), Some(Error::OutOfRange("n")));
        assert_eq!(Reduced::<f64, 8, 2>::build(&SIZE_25, RATED).err(), Some(Error::OutOfRange("m")));
        assert_eq!(reduced().displacement((0, 3), 0.0, Angle::default()), Err(Error::OutOfRange("node")));
    }
}
