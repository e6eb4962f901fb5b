//! Any registered friction model behind one type, chosen by its name when a program runs.
//!
//! ```
//! use strainwave::friction::{AnyFrictionParams, FrictionData, FrictionModel, FrictionParams, ModelName, Slip};
//!
//! let data = FrictionData::<f64> { dead_band: 1e-3, ..FrictionData::falling(1.5, 1e-4) };
//! let force_after_1_um = |word: &str| {
//!     let name = ModelName::of_word(word).expect("a registered model");
//!     let friction = AnyFrictionParams::of_data(name, &data).build()?;
//!     Ok(friction.step(&mut Default::default(), &Slip::new(1e-2, 1e-4)).force)
//! };
//! let [dahl, karnopp]: [Result<f64, strainwave::Error>; 2] = ["dahl", "karnopp"].map(force_after_1_um);
//! assert!(dahl? < 0.01 && karnopp? > 1.0); // a hundredth of the presliding distance, but a sliding contact
//! # Ok::<(), strainwave::Error>(())
//! ```

use super::any_model::any_model;
// Every model: a row of the registry names the parameters of one.
use super::*;

macro_rules! any_friction {
    ($($name:ident = $word:literal, $params:ty, $what:literal;)*) => {
        /// Name of a registered friction model.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum ModelName {
            $(#[doc = $what] $name,)*
        }

        impl ModelName {
            /// Every name.
            pub const ALL: &[Self] = &[$(Self::$name),*];
            /// Every name as a gear file has it.
            pub const WORDS: &[&str] = &[$($word),*];

            /// The name as a gear file has it.
            pub fn word(self) -> &'static str {
                match self {
                    $(Self::$name => $word,)*
                }
            }

            /// Friction of a contact that stands still.
            pub fn standstill(self) -> Standstill {
                type R = f64;
                match self {
                    $(Self::$name => <$params as Registered<R>>::STANDSTILL,)*
                }
            }

            /// A body that a spring draws sticks and slips.
            pub fn sticks_and_slips(self) -> bool {
                type R = f64;
                match self {
                    $(Self::$name => <$params as Registered<R>>::STICK_SLIP,)*
                }
            }

            /// Names of the data without which the model cannot be built.
            pub fn needs(self) -> impl Iterator<Item = &'static str> {
                type R = f64;
                let groups = match self {
                    $(Self::$name => <$params as Registered<R>>::NEEDS,)*
                };
                groups.iter().copied().flatten().copied()
            }

            /// Names of the data that the model reads where they are known.
            pub fn may_have(self) -> &'static [&'static str] {
                type R = f64;
                match self {
                    $(Self::$name => <$params as Registered<R>>::MAY_HAVE,)*
                }
            }
        }

        any_model! { AnyFrictionParams AnyFriction AnyFrictionState: $($name: $params,)* }

        impl<R: Real> AnyFrictionParams<R> {
            /// Parameters of the model of a name, of a contact with these data.
            pub fn of_data(name: ModelName, data: &FrictionData<R>) -> Self {
                match name {
                    $(ModelName::$name => Self::$name(Registered::of_data(data)),)*
                }
            }
        }

        /// Runs a test of closed motions with every registered model that has presliding and loses work over any of them, of a
        /// `level` (N) and a presliding `distance` (m).
        pub fn closed_motions<R: Real>(level: f64, distance: f64, test: &mut impl ClosedMotionTest<R>) {
            $(if <$params as Registered<R>>::STANDSTILL == Standstill::Presliding {
                <$params as Registered<R>>::closed_motions(level, distance, test);
            })*
        }
    };
}

friction_models!(any_friction);

impl ModelName {
    /// Those of the firmware's block, [`JointFriction`].
    pub const IN_FIRMWARE: [Self; 2] = [Self::BlimanSorine1, Self::BlimanSorine2];

    /// The name that is this word in a gear file.
    pub fn of_word(word: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|name| name.word() == word)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn a_word_names_one_model() {
        assert_eq!(ModelName::WORDS.iter().collect::<BTreeSet<_>>().len(), ModelName::ALL.len());
        for (name, word) in ModelName::ALL.iter().zip(ModelName::WORDS) {
            assert_eq!((name.word(), ModelName::of_word(word)), (*word, Some(*name)));
        }
        assert_eq!(ModelName::of_word("Dahl"), None);
    }

    #[test]
    fn unknown_data_build_no_model() {
        for name in ModelName::ALL {
            let params = AnyFrictionParams::<f64>::of_data(*name, &FrictionData::unknown());
            assert!(name.needs().count() > 0 && params.build().is_err(), "{}", name.word());
        }
    }

    /// Runs, and those with a model whose force depends on the path alone.
    #[derive(Default)]
    struct Runs([u32; 2]);

    impl ClosedMotionTest<f64> for Runs {
        fn run<M: FrictionModel<f64>>(&mut self, model: Result<M, Error>, _: ForceOverPath) {
            assert!(model.is_ok());
            self.0[0] += 1;
            self.0[1] += u32::from(M::RATE_INDEPENDENT);
        }
    }

    /// At least the three exponents of Dahl, bristles, reset integrator, the block of both orders, order 2 alone, LuGre and a
    /// state space; of these Dahl's, order 2 alone and the state space do not depend on the rate.
    #[test]
    fn closed_motions_reach_every_form() {
        let mut runs = Runs::default();
        closed_motions(1.0, 0.015_625, &mut runs);
        let [all, rate_independent] = runs.0;
        assert!(all >= 10 && rate_independent >= 5, "{all} {rate_independent}");
    }

    #[test]
    fn a_state_is_that_of_the_model_that_moved_it() {
        let data = FrictionData::<f64>::falling(1.0, 0.01);
        let [dahl, lugre] = [ModelName::Dahl, ModelName::LuGre]
            .map(|name| AnyFrictionParams::of_data(name, &data).build().unwrap());
        let mut state = AnyFrictionState::default();
        assert!(dahl.step(&mut state, &Slip::new(f64::NAN, 1e-3)).held);
        assert_eq!(state, AnyFrictionState::default());
        let force = dahl.step(&mut state, &Slip::new(1.0, 1e-3)).force;
        assert_eq!((dahl.force(&state), lugre.force(&state)), (force, 0.0));
    }
}
