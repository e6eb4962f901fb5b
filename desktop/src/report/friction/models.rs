//! The models that are drawn, and the numbers that they are built from.
//!
//! Parameters that the gear's file lacks are derived from those that it has, so that all models can be compared.

use strainwave::friction::{
    AnyFriction, AnyFrictionState, FrictionModel as _, FrictionParams, ModelName, Slip,
};

use crate::io::figure::number;
use crate::io::gear_file::friction_params::friction_params;
use crate::io::gear_file::{Friction, GearFile, StateRow};

/// Fc over Fs where the file has one of them only.
const KINETIC_SHARE: f64 = 0.7;
/// Dead band over vs.
const DEAD_BAND: f64 = 1e-3;
/// Micro-damping over Fs/vs.
const MICRO_DAMPING: f64 = 0.1;
/// Dwell that raises static friction by half (s).
const DWELL: f64 = 1.0;

/// All that any model reads.
pub(super) struct Numbers {
    pub side: Friction,
    /// Fc (N m).
    pub coulomb: f64,
    /// Fs (N m), above 0.
    pub static_level: f64,
    /// vs (rad/s).
    pub stribeck_velocity: f64,
    /// eps (rad).
    pub presliding: f64,
}

impl Numbers {
    pub fn of(side: &Friction) -> Self {
        let default = GearFile::default_gear().friction.input;
        let or = |own: Option<f64>, default: Option<f64>| {
            own.or(default).expect("the default gear has every level")
        };
        let coulomb = side.coulomb.or(side.static_level.map(|level| KINETIC_SHARE * level));
        let coulomb = or(coulomb, default.coulomb);
        let static_level = side.static_level.unwrap_or(coulomb / KINETIC_SHARE).max(1e-9);
        let stribeck_velocity = or(side.stribeck_velocity, default.stribeck_velocity);
        let presliding = or(side.presliding, default.presliding);
        let side = Friction {
            coulomb: Some(coulomb),
            static_level: Some(static_level),
            stribeck_velocity: Some(stribeck_velocity),
            stribeck_exponent: side.stribeck_exponent.or(default.stribeck_exponent),
            viscous: side.viscous.or(default.viscous),
            presliding: Some(presliding),
            presliding_ratio: side.presliding_ratio.or(default.presliding_ratio),
            dead_band: side.dead_band.or(Some(DEAD_BAND * stribeck_velocity)),
            frictional_memory: side.frictional_memory.or(Some(presliding / stribeck_velocity)),
            dwell: side.dwell.or(Some(DWELL)),
            micro_damping: side.micro_damping.or(Some(MICRO_DAMPING * static_level / stribeck_velocity)),
            state_space: side.state_space.clone().or_else(|| Some(swinging(coulomb, presliding))),
            ..side.clone()
        };
        Self { side, coulomb, static_level, stribeck_velocity, presliding }
    }

    /// For people.
    pub fn levels(&self) -> String {
        let Self { coulomb, static_level, stribeck_velocity, presliding, .. } = self;
        format!(
            "Fc = {} mN m, Fs = {} mN m, vs = {} rad/s, presliding over eps = {} mrad",
            number(coulomb * 1e3),
            number(static_level * 1e3),
            number(*stribeck_velocity),
            number(presliding * 1e3)
        )
    }

    /// Derived parameters where a file has none, as text.
    pub fn taken(&self) -> String {
        format!(
            "What the file does not have is taken here as: dead band {DEAD_BAND} vs, frictional memory eps/vs, dwell {DWELL} s, \
             micro-damping {MICRO_DAMPING} Fs/vs, and for the state space a rise that swings."
        )
    }
}

/// Order 2 with a pair of complex modes, which first passes its kinetic level `coulomb` (N m) by a third of it.
fn swinging(coulomb: f64, presliding: f64) -> Vec<StateRow> {
    // C (p - A)^-1 B is (p + 1)/((p + 1)^2 + damped^2) in 1/eps, times c.
    let (rate, damped) = (1.0 / presliding, 1.2);
    vec![
        StateRow { a: vec![-rate, damped * rate], b: rate, c: coulomb * (1.0 + damped * damped) },
        StateRow { a: vec![-damped * rate, -rate], b: 0.0, c: 0.0 },
    ]
}

/// A model at work.
pub(super) struct Model {
    pub name: &'static str,
    built: AnyFriction<f64>,
}

impl Model {
    /// The one that the side names; `None` where its numbers do not build it.
    pub fn of(side: &Friction) -> Option<Self> {
        let built = friction_params::<f64>(side).build().ok()?;
        Some(Self { name: side.model.word(), built })
    }

    /// From rest.
    pub fn rest(&self) -> Contact<'_> {
        Contact { model: &self.built, state: AnyFrictionState::default() }
    }
}

/// A contact on its way.
pub(super) struct Contact<'a> {
    model: &'a AnyFriction<f64>,
    state: AnyFrictionState<f64>,
}

impl Contact<'_> {
    /// Friction (N m) at the end of a step at a velocity (rad/s) for a time (s), while the rest of the torques on the body
    /// is `applied` (N m).
    pub fn step(&mut self, velocity: f64, duration: f64, applied: f64) -> f64 {
        self.model.step(&mut self.state, &Slip::new(velocity, duration).under(applied, 0.0)).force
    }
}

/// Those that can be built, and why others cannot.
pub(super) struct Models {
    pub drawn: Vec<Model>,
    pub left_out: Vec<String>,
}

impl Models {
    pub fn build(numbers: &Numbers) -> Self {
        let (mut drawn, mut left_out) = (Vec::new(), Vec::new());
        for model in ModelName::ALL {
            let name = model.word();
            match friction_params::<f64>(&Friction { model: *model, ..numbers.side.clone() }).build() {
                Ok(built) => drawn.push(Model { name, built }),
                Err(error) => {
                    left_out.push(format!("{name} is not drawn: with the numbers of this gear its {error}."))
                }
            }
        }
        Self { drawn, left_out }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_is_drawn_for_the_default_gear_and_for_one_with_a_single_number() {
        let mut side = GearFile::default_gear().friction.input;
        let models = Models::build(&Numbers::of(&side));
        assert_eq!((models.drawn.len(), models.left_out.len()), (ModelName::ALL.len(), 0));
        side = Friction { model: ModelName::Coulomb, coulomb: Some(3.0), ..blank(side) };
        let numbers = Numbers::of(&side);
        assert_eq!(Models::build(&numbers).drawn.len(), ModelName::ALL.len());
        assert_eq!(numbers.coulomb, 3.0);
        side.coulomb = Some(0.0);
        let models = Models::build(&Numbers::of(&side));
        assert!(
            models.left_out.iter().any(|line| line.starts_with("dahl is not drawn")),
            "{:?}",
            models.left_out
        );
    }

    fn blank(side: Friction) -> Friction {
        let mut table = toml::Table::try_from(side).unwrap();
        table.retain(|name, _| name == "model");
        table.try_into().unwrap()
    }
}
