//! Any friction model of the library behind one type, for a gear whose model is known when its file is read.
//!
//! An enumeration of the models, each step a match: no allocation, no table of functions. A state is that of
//! the model which it was first stepped by; before that, and for any other model, it is at rest.

use strainwave::friction::{
    Armstrong, ArmstrongParams, Bristle, BristleParams, Coulomb, CoulombParams, Dahl, DahlParams, Friction,
    FrictionModel, FrictionParams, JointFriction, JointFrictionParams, Karnopp, KarnoppParams, LuGre,
    LuGreParams, LubricatedContact, LubricatedContactParams, ResetIntegrator, ResetIntegratorParams, Slip,
    StateSpace, StateSpaceParams, Static, StaticParams, Stribeck, StribeckParams, Viscous, ViscousParams,
};
use strainwave::{Error, Real};

use crate::io::gear_file::friction::BRISTLES;

macro_rules! any_friction {
    ($($name:ident: $params:ty => $model:ty,)*) => {
        /// Parameters of any friction model.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[expect(missing_docs, reason = "each variant is the model of its name")]
        pub enum AnyFrictionParams<R> {
            $($name($params),)*
        }

        impl<R: Real> FrictionParams<R> for AnyFrictionParams<R> {
            type Model = AnyFriction<R>;

            fn build(&self) -> Result<AnyFriction<R>, Error> {
                Ok(match self {
                    $(Self::$name(params) => AnyFriction::$name(params.build()?),)*
                })
            }
        }

        /// Any friction model, built.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[expect(missing_docs, reason = "each variant is the model of its name")]
        pub enum AnyFriction<R> {
            $($name($model),)*
        }

        /// State of any friction model.
        #[derive(Clone, Debug, Default)]
        #[expect(missing_docs, reason = "each variant is the model of its name")]
        pub enum AnyFrictionState<R: Real> {
            /// Of no model yet.
            #[default]
            Rest,
            $($name(<$model as FrictionModel<R>>::State),)*
        }

        impl<R: Real> FrictionModel<R> for AnyFriction<R> {
            type State = AnyFrictionState<R>;

            fn force(&self, state: &Self::State) -> R {
                match (self, state) {
                    $((Self::$name(model), AnyFrictionState::$name(own)) => model.force(own),)*
                    $((Self::$name(model), _) => model.force(&Default::default()),)*
                }
            }

            fn advance(&self, state: &mut Self::State, slip: &Slip<R>) {
                self.step(state, slip);
            }

            /// The model's own: each knows what it reads, and holds when that is not finite.
            fn step(&self, state: &mut Self::State, slip: &Slip<R>) -> Friction<R> {
                match (self, state) {
                    $((Self::$name(model), AnyFrictionState::$name(own)) => model.step(own, slip),)*
                    $((Self::$name(model), other) => {
                        let mut own = Default::default();
                        let friction = model.step(&mut own, slip);
                        *other = AnyFrictionState::$name(own);
                        friction
                    })*
                }
            }
        }
    };
}

any_friction! {
    Coulomb: CoulombParams<R> => Coulomb<R>,
    Viscous: ViscousParams<R> => Viscous<R>,
    Static: StaticParams<R> => Static<R>,
    Stribeck: StribeckParams<R> => Stribeck<R>,
    Karnopp: KarnoppParams<R> => Karnopp<R>,
    Armstrong: ArmstrongParams<R> => Armstrong<R>,
    Dahl: DahlParams<R> => Dahl<R>,
    Bristle: BristleParams<R, BRISTLES> => Bristle<R, BRISTLES>,
    ResetIntegrator: ResetIntegratorParams<R> => ResetIntegrator<R>,
    Joint: JointFrictionParams<R> => JointFriction<R>,
    LubricatedContact: LubricatedContactParams<R> => LubricatedContact<R>,
    LuGre: LuGreParams<R> => LuGre<R>,
    StateSpace1: StateSpaceParams<R, 1> => StateSpace<R, 1>,
    StateSpace2: StateSpaceParams<R, 2> => StateSpace<R, 2>,
    StateSpace3: StateSpaceParams<R, 3> => StateSpace<R, 3>,
    StateSpace4: StateSpaceParams<R, 4> => StateSpace<R, 4>,
}
