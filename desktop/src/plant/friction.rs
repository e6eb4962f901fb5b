//! Friction of a plant's contact: the gear's block, or one of another structure, with the same levels.
//!
//! All have the level of [`strainwave::friction::joint_friction`], so that load, ripple and direction act on each:
//!
//! ```text
//! g = (Fc + (Fs - Fc)*exp(-|v/vs|^delta)) * ripple(theta_wg) + k*|tau|
//! ```
//!
//! | structure | force |
//! | --- | --- |
//! | [`Structure::Presliding`] | Bliman-Sorine of order 1 or 2; order 1 with Fs = Fc is Dahl's model |
//! | [`Structure::LuGre`] | order 1, which is LuGre's bristle with sigma0 = g0/eps, plus sigma1*dz/dt |
//! | [`Structure::Static`] | at standstill whatever is applied, up to g(0); in motion g(v)*sign(v) |
//!
//! LuGre: sigma1 = 2*zeta*sqrt(sigma0*J)/(1 + (v/vs)^2), dz/dt its mean over the step; it fades with speed, so that it is
//! below the 4*g/|v| from which on fast sliding would gain work.
//!
//! Static: the contact stands when the force that would bring it to rest within the step, F_e + J*v/dt, is within +-g(0).
//! There is no dead band, no drift, and the model never drives.
//!
//! Over time levels and viscous part may drift apart: F = c*(F - Fv*v) + d*Fv*v, c and d linear in time.
//!
//! Sign: F has the sign of the velocity that it opposes. Units: N m, rad, rad/s.

use strainwave::Error;
use strainwave::friction::{
    Friction, FrictionModel, FrictionParams, JointFriction, JointFrictionParams, JointFrictionState,
    LoadFactors, LubricatedContact, Order, RIPPLE_ORDERS, Ripple, Slip,
};

/// Structure of friction: the model of its contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Structure {
    /// The gear's block, as its parameters say.
    #[default]
    Presliding,
    /// A bristle with damping.
    LuGre {
        /// zeta.
        damping: f64,
    },
    /// Stribeck's curve with static friction.
    Static,
}

/// Drift of friction over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Age at the start (s).
    pub age: f64,
    /// Age at which the factors are reached (s).
    pub duration: f64,
    /// Factor on the levels.
    pub coulomb: f64,
    /// Factor on the viscous part.
    pub viscous: f64,
}

impl Drift {
    /// Factors on levels and viscous part after so much time (s).
    pub fn at(&self, time: f64) -> [f64; 2] {
        let fraction = ((self.age + time) / self.duration).min(1.0);
        [self.coulomb, self.viscous].map(|factor| 1.0 + (factor - 1.0) * fraction)
    }
}

/// Parameters of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantFrictionParams {
    /// Levels, presliding, load and ripple.
    pub joint: JointFrictionParams<f64>,
    /// Structure.
    pub structure: Structure,
    /// Inertia of the body that it acts on (kg m^2).
    pub inertia: f64,
    /// Drift.
    pub drift: Option<Drift>,
}

impl PlantFrictionParams {
    /// The gear's own block on a body of this inertia (kg m^2).
    pub fn of(joint: JointFrictionParams<f64>, inertia: f64) -> Self {
        Self { joint, structure: Structure::default(), inertia, drift: None }
    }
}

impl FrictionParams<f64> for PlantFrictionParams {
    type Model = PlantFriction;

    fn build(&self) -> Result<PlantFriction, Error> {
        let bristle = || JointFrictionParams { order: Order::One, ..self.joint }.build();
        let core = match self.structure {
            Structure::Presliding => Core::Presliding(self.joint.build()?),
            Structure::LuGre { damping } => {
                let stiffness = self.joint.forward.static_level / self.joint.presliding;
                let over_stiffness = 2.0 * damping * (self.inertia / stiffness).sqrt();
                Core::LuGre { bristle: bristle()?, damping: over_stiffness }
            }
            Structure::Static => Core::Static(Stiction::build(self)?),
        };
        Ok(PlantFriction {
            core,
            viscous: [self.joint.forward.viscous, self.joint.backward.viscous],
            slow: self.joint.forward.stribeck_velocity,
            drift: self.drift,
        })
    }
}

/// Built model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantFriction {
    core: Core,
    /// Fv forwards and backwards.
    viscous: [f64; 2],
    /// vs forwards.
    slow: f64,
    drift: Option<Drift>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Core {
    Presliding(JointFriction<f64>),
    LuGre {
        bristle: JointFriction<f64>,
        /// sigma1/sigma0 at standstill (s).
        damping: f64,
    },
    Static(Stiction),
}

/// State of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlantFrictionState {
    joint: JointFrictionState<f64>,
    /// Of the bristle (N m).
    elastic: f64,
    /// (N m)
    force: f64,
    /// (s)
    time: f64,
}

impl PlantFriction {
    fn viscous(&self, velocity: f64) -> f64 {
        self.viscous[usize::from(velocity < 0.0)] * velocity
    }
}

impl FrictionModel<f64> for PlantFriction {
    type State = PlantFrictionState;
    const READS_APPLIED: bool = true;

    fn force(&self, state: &Self::State) -> f64 {
        state.force
    }

    fn advance(&self, state: &mut Self::State, slip: &Slip<f64>) {
        let velocity = slip.velocity;
        let force = match &self.core {
            Core::Presliding(joint) => joint.step(&mut state.joint, slip).force,
            Core::LuGre { bristle, damping } => {
                let whole = bristle.step(&mut state.joint, slip).force;
                let elastic = whole - self.viscous(velocity);
                let rate = (elastic - state.elastic) / slip.duration.seconds().max(f64::MIN_POSITIVE);
                state.elastic = elastic;
                whole + damping / (1.0 + (velocity / self.slow).powi(2)) * rate
            }
            Core::Static(stiction) => {
                let viscous = self.viscous(velocity);
                stiction.force(slip, viscous) + viscous
            }
        };
        state.force = match &self.drift {
            None => force,
            Some(drift) => {
                state.time += slip.duration.seconds();
                let ([level, viscous], resisting) = (drift.at(state.time), self.viscous(velocity));
                level * (force - resisting) + viscous * resisting
            }
        };
    }

    #[inline]
    fn step(&self, state: &mut Self::State, slip: &Slip<f64>) -> Friction<f64> {
        if let (Core::Presliding(joint), None) = (&self.core, &self.drift) {
            return joint.step(&mut state.joint, slip);
        }
        if slip.velocity.is_finite() && slip.applied.is_finite() && slip.load.is_finite() {
            self.advance(state, slip);
            return Friction { force: state.force, held: false };
        }
        Friction { force: state.force, held: true }
    }
}

/// Static friction that knows the body's inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stiction {
    /// Forwards and backwards.
    contacts: [LubricatedContact<f64>; 2],
    ripple: Ripple<f64, RIPPLE_ORDERS>,
    load: LoadFactors<f64>,
    inertia: f64,
}

impl Stiction {
    fn build(params: &PlantFrictionParams) -> Result<Self, Error> {
        let mut ripple = params.joint.ripple;
        for harmonics in [&mut ripple.forward, &mut ripple.backward] {
            // Fractions of a level of 1.
            let scale = 1.0 / harmonics.mean;
            harmonics.mean = 1.0;
            harmonics.cosines = harmonics.cosines.map(|part| scale * part);
            harmonics.sines = harmonics.sines.map(|part| scale * part);
        }
        Ok(Self {
            contacts: [params.joint.forward.build()?, params.joint.backward.build()?],
            ripple: ripple.build()?,
            load: params.joint.load,
            inertia: params.inertia,
        })
    }

    /// Beside the viscous part (N m).
    fn force(&self, slip: &Slip<f64>, viscous: f64) -> f64 {
        let to_rest = slip.applied - viscous
            + self.inertia * slip.velocity / slip.duration.seconds().max(f64::MIN_POSITIVE);
        let backwards = if slip.velocity == 0.0 { to_rest < 0.0 } else { slip.velocity < 0.0 };
        let driving = if backwards { slip.load < 0.0 } else { slip.load > 0.0 };
        let factor = if driving { self.load.driving } else { self.load.driven };
        let level = self.contacts[usize::from(backwards)].level(slip.velocity)
            * self.ripple.level(slip.wave_generator, backwards)
            + factor * slip.load.abs();
        to_rest.clamp(-level, level)
    }
}

#[cfg(test)]
mod tests {
    use strainwave::friction::{DahlParams, LuGreParams, LubricatedContactParams};

    use super::*;

    const DT: f64 = 2.5e-5;
    const INERTIA: f64 = 6e-5;

    fn contact() -> LubricatedContactParams<f64> {
        LubricatedContactParams {
            coulomb: 0.035,
            static_level: 0.05,
            stribeck_velocity: 2.0,
            stribeck_exponent: 1.0,
            viscous: 1.2e-4,
        }
    }

    fn params(order: Order, structure: Structure) -> PlantFrictionParams {
        let joint = JointFrictionParams::symmetric(order, contact(), 0.02, 0.3);
        PlantFrictionParams { structure, ..PlantFrictionParams::of(joint, INERTIA) }
    }

    fn forces<M: FrictionModel<f64>>(model: &M) -> Vec<f64> {
        let mut state = M::State::default();
        let velocity = |k: u32| 3.0 * (f64::from(k) * 2e-3).sin();
        (0..20_000).map(|k| model.step(&mut state, &Slip::new(velocity(k), DT)).force).collect()
    }

    fn furthest(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn the_gears_block_is_itself_bit_for_bit() {
        let params = params(Order::Two, Structure::Presliding);
        assert_eq!(forces(&params.build().unwrap()), forces(&params.joint.build().unwrap()));
    }

    #[test]
    fn without_damping_the_bristle_is_lugres_and_without_stribeck_dahls() {
        let bristle = forces(&params(Order::Two, Structure::LuGre { damping: 0.0 }).build().unwrap());
        let lugre = LuGreParams { contact: contact(), stiffness: 0.05 / 0.02, damping: 0.0 }.build().unwrap();
        assert!(furthest(&bristle, &forces(&lugre)) < 1e-12);
        let mut dahl = params(Order::One, Structure::Presliding);
        for contact in [&mut dahl.joint.forward, &mut dahl.joint.backward] {
            (contact.static_level, contact.viscous) = (contact.coulomb, 0.0);
        }
        let library = DahlParams { coulomb: 0.035, stiffness: 0.035 / 0.02, exponent: 1.0 }.build().unwrap();
        assert!(furthest(&forces(&dahl.build().unwrap()), &forces(&library)) < 1e-12);
    }

    /// A body on a spring: pushed below Fs it stays where it is to the last bit, beyond it slides, and comes to rest.
    #[test]
    fn static_friction_holds_and_lets_go() {
        let model = params(Order::Two, Structure::Static).build().unwrap();
        let run = |push: f64, mut velocity: f64| {
            let mut state = PlantFrictionState::default();
            for _ in 0..4000 {
                let force = model.step(&mut state, &Slip::new(velocity, DT).under(push, 0.0)).force;
                velocity += DT * (push - force) / INERTIA;
            }
            velocity
        };
        let held = [run(0.0, 0.0), run(0.0499, 0.0), run(-0.0499, 0.0), run(0.0, 5.0)];
        assert!(held.iter().all(|velocity| velocity.abs() < 1e-15), "{held:?}");
        assert!(run(0.0501, 0.0) > 1.0 && run(-0.0501, 0.0) < -1.0);
    }

    /// Over strokes there and back all structures lose work.
    #[test]
    fn no_structure_drives() {
        for structure in [Structure::Presliding, Structure::LuGre { damping: 0.5 }, Structure::Static] {
            let model = params(Order::Two, structure).build().unwrap();
            let mut state = PlantFrictionState::default();
            let mut work = 0.0;
            for k in 0..50_000 {
                let velocity = 4.0 * (f64::from(k) * 1e-3).sin() * (f64::from(k) * 3.1e-4).cos();
                let before = state.force;
                let force = model.step(&mut state, &Slip::new(velocity, DT)).force;
                work += if structure == Structure::Presliding { 0.5 * (before + force) } else { force }
                    * velocity
                    * DT;
                assert!(work > -1e-6, "{structure:?} {k}: {work}");
            }
        }
    }

    #[test]
    fn drift_takes_its_time() {
        let drift = Drift { age: 30.0, duration: 60.0, coulomb: 0.7, viscous: 2.0 };
        assert_eq!([drift.at(0.0), drift.at(30.0), drift.at(90.0)], [[0.85, 1.5], [0.7, 2.0], [0.7, 2.0]]);
        let aged = Drift { age: 90.0, ..drift };
        let model = PlantFrictionParams { drift: Some(aged), ..params(Order::One, Structure::Presliding) };
        let (model, mut state) = (model.build().unwrap(), PlantFrictionState::default());
        let sliding = Slip::new(200.0, 1e-3);
        let force = (0..100).map(|_| model.step(&mut state, &sliding).force).last().unwrap();
        assert!((force - (0.7 * 0.035 + 2.0 * 1.2e-4 * 200.0)).abs() < 1e-9, "{force}");
    }
}
