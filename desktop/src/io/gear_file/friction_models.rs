//! Registry of the friction models that a gear file may name: one row a model.
//!
//! A row has the model's name here and its word in the file, the keys without which it cannot be, its types in
//! [`strainwave::friction`], and its parameters from the numbers of a side of the file. What lists models is made of it:
//! the words and their keys (`friction.rs`), any model behind one type (`friction_params.rs`), and the tests that go through
//! [`super::FrictionModel::ALL`].

/// Hands every row to the macro `$then`.
macro_rules! friction_models {
    ($then:ident) => {
        $then! {
            /// One level.
            Coulomb = "coulomb" needs [&["coulomb_nm"]],
                CoulombParams<R> => Coulomb<R>, |side| CoulombParams { coulomb: needed(side.coulomb) };
            /// In proportion to the speed.
            Viscous = "viscous" needs [&["viscous_nm_s_per_rad"]],
                ViscousParams<R> => Viscous<R>, |side| ViscousParams { viscous: needed(side.viscous) };
            /// Holds at standstill, Coulomb's in motion.
            Static = "static" needs [LEVELS],
                StaticParams<R> => Static<R>, |side| stiction(side);
            /// Holds at standstill, a level that falls with speed in motion.
            Stribeck = "stribeck" needs [CURVE],
                StribeckParams<R> => Stribeck<R>, |side| StribeckParams { contact: contact(side) };
            /// A dead band of speed in which it holds.
            Karnopp = "karnopp" needs [CURVE, &["dead_band_rad_per_s"]],
                KarnoppParams<R> => Karnopp<R>, |side| karnopp(side);
            /// Seven parameters: presliding, Stribeck effect with memory, static friction that rises with the dwell.
            Armstrong = "armstrong" needs [
                LEVELS,
                &["stribeck_rad_per_s", "viscous_nm_s_per_rad"],
                PRESLIDING,
                &["frictional_memory_s", "dwell_s"],
            ],
                ArmstrongParams<R> => Armstrong<R>, |side| armstrong(side);
            /// A spring that yields.
            Dahl = "dahl" needs [&["coulomb_nm"], PRESLIDING],
                DahlParams<R> => Dahl<R>, |side| dahl(side);
            /// Bonds that snap.
            Bristle = "bristle" needs [&["coulomb_nm"], PRESLIDING],
                BristleParams<R, BRISTLES> => Bristle<R, BRISTLES>, |side| bristle(side);
            /// One bond that stretches and holds at its end.
            ResetIntegrator = "reset_integrator" needs [LEVELS, PRESLIDING],
                ResetIntegratorParams<R> => ResetIntegrator<R>, |side| reset_integrator(side);
            /// The gear's block: Bliman and Sorine's first order, which is Dahl's model, at the lubricated contact's level.
            BlimanSorine1 = "bliman_sorine_1" needs [CURVE, PRESLIDING],
                JointFrictionParams<R> => JointFriction<R>, |side| joint(side, Order::One);
            /// The gear's block: the second order, with a breakaway peak.
            BlimanSorine2 = "bliman_sorine_2" needs [CURVE, PRESLIDING, &["presliding_ratio"]],
                JointFrictionParams<R> => JointFriction<R>, |side| joint(side, Order::Two);
            /// A level that falls with speed, without presliding.
            LubricatedContact = "lubricated_contact" needs [CURVE],
                LubricatedContactParams<R> => LubricatedContact<R>, |side| contact(side);
            /// The mean deflection of bristles.
            LuGre = "lugre" needs [CURVE, PRESLIDING],
                LuGreParams<R> => LuGre<R>, |side| lugre(side);
            /// Bliman and Sorine's with general A, B, C.
            StateSpace = "state_space" needs [&["state_space"]],
                AnyStateSpaceParams<R> => AnyStateSpace<R>, |side| state_space(side);
        }
    };
}

pub(super) use friction_models;
