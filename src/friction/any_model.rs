//! Any of a list of friction models behind one type, for a gear whose model is known when its file is read.
//!
//! An enumeration of the models, each step a match: no allocation, no table of functions. A state is that of
//! the model which it was first stepped by; before that, and for any other model, it is at rest.

use super::{FrictionModel, FrictionParams};

/// State of the model that parameters are built to.
pub type StateOf<R, P> = <<P as FrictionParams<R>>::Model as FrictionModel<R>>::State;

/// One type each for the parameters, the models and the states of a list of models.
macro_rules! any_model {
    ($any_params:ident $any:ident $any_state:ident: $($name:ident: $params:ty,)*) => {
        /// Parameters of any of these friction models.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[expect(missing_docs, reason = "each variant is the model of its name")]
        pub enum $any_params<R: Real> {
            $($name($params),)*
        }

        impl<R: Real> crate::friction::FrictionParams<R> for $any_params<R> {
            type Model = $any<R>;

            fn build(&self) -> Result<$any<R>, Error> {
                Ok(match self {
                    $(Self::$name(params) => $any::$name(params.build()?),)*
                })
            }
        }

        /// Any of these friction models, built.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[expect(missing_docs, reason = "each variant is the model of its name")]
        pub enum $any<R: Real> {
            $($name(<$params as crate::friction::FrictionParams<R>>::Model),)*
        }

        /// State of any of these friction models.
        #[derive(Clone, Debug, Default, PartialEq)]
        #[expect(missing_docs, reason = "each variant is the model of its name")]
        pub enum $any_state<R: Real> {
            /// Of no model yet.
            #[default]
            Rest,
            $($name(crate::friction::any_model::StateOf<R, $params>),)*
        }

        impl<R: Real> crate::friction::FrictionModel<R> for $any<R> {
            type State = $any_state<R>;

            fn force(&self, state: &Self::State) -> R {
                match (self, state) {
                    $((Self::$name(model), $any_state::$name(own)) => model.force(own),)*
                    $((Self::$name(model), _) => model.force(&Default::default()),)*
                }
            }

            fn advance(&self, state: &mut Self::State, slip: &crate::friction::Slip<R>) {
                self.step(state, slip);
            }

            /// The model's own: each knows what it reads, and holds when that is not finite.
            fn step(&self, state: &mut Self::State, slip: &crate::friction::Slip<R>) -> crate::friction::Friction<R> {
                match (self, state) {
                    $((Self::$name(model), $any_state::$name(own)) => model.step(own, slip),)*
                    $((Self::$name(model), other) => {
                        let mut own = Default::default();
                        let friction = model.step(&mut own, slip);
                        if !friction.held {
                            *other = $any_state::$name(own);
                        }
                        friction
                    })*
                }
            }
        }
    };
}

pub(super) use any_model;
