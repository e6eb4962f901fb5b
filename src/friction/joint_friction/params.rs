//! Parameters of the gear's friction block, checked and built.

use super::{JointFriction, Side};
use crate::error::{Error, require};
use crate::friction::FrictionParams;
use crate::friction::bliman_sorine::{BlimanSorine, BlimanSorineParams};
use crate::friction::load_dependence::LoadFactors;
use crate::friction::lubricated_contact::LubricatedContactParams;
use crate::friction::ripple::{RIPPLE_ORDERS, RippleParams};
use crate::real::Real;

/// Levels below this count as this (N m): a level divides.
pub(super) const LEAST_LEVEL: f64 = 1e-9;

/// Order of the Bliman-Sorine dynamics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// Dahl's monotone rise.
    One,
    /// Rise with a peak.
    #[default]
    Two,
}

/// Friction of one side of the gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointFrictionParams<R> {
    /// Order of the presliding dynamics.
    pub order: Order,
    /// Fc, Fs, vs, delta and Fv of motion forwards.
    pub forward: LubricatedContactParams<R>,
    /// Those of motion backwards.
    pub backward: LubricatedContactParams<R>,
    /// eps (rad), at the level of `forward.static_level`; 1e-9..=1e6.
    pub presliding: R,
    /// eta; 0.01..=0.99, unused with order 1.
    pub presliding_ratio: R,
    /// Part of the level by the torque through the contact.
    pub load: LoadFactors<R>,
    /// Fraction of the level over the wave generator's angle.
    pub ripple: RippleParams<R, RIPPLE_ORDERS>,
}

impl<R: Real> JointFrictionParams<R> {
    /// The same in both directions, without load or ripple.
    pub fn symmetric(
        order: Order,
        contact: LubricatedContactParams<R>,
        presliding: R,
        presliding_ratio: R,
    ) -> Self {
        Self {
            order,
            forward: contact,
            backward: contact,
            presliding,
            presliding_ratio,
            load: LoadFactors::default(),
            ripple: RippleParams::NONE,
        }
    }

    /// Largest level without load (N m): static or sliding, in either direction, where its ripple is highest.
    pub fn largest_level(&self) -> R {
        let level = |contact: &LubricatedContactParams<R>, ripple: R| {
            contact.static_level.max(contact.coulomb) * ripple
        };
        let ripple = &self.ripple;
        level(&self.forward, ripple.forward.largest()).max(level(&self.backward, ripple.backward.largest()))
    }

    /// Largest level over the torque through the contact.
    pub fn largest_load_factor(&self) -> R {
        self.load.driving.max(self.load.driven)
    }

    /// Every level and viscous friction times `factor`.
    pub fn scale(&mut self, factor: R) {
        for contact in [&mut self.forward, &mut self.backward] {
            contact.coulomb *= factor;
            contact.static_level *= factor;
            contact.viscous *= factor;
        }
        self.load.driving *= factor;
        self.load.driven *= factor;
    }

    /// Order 1 is built as an order 2 whose second force stays at zero: one type, one code path.
    fn normalised_presliding(&self) -> Result<BlimanSorine<R, 2>, Error> {
        let (eps, eta) = (self.presliding, self.presliding_ratio);
        require((R::lit(1e-9)..=R::lit(1e6)).contains(&eps), "presliding")?;
        match self.order {
            Order::One => BlimanSorineParams { levels: [R::ONE, R::ZERO], distances: [eps, eps] },
            Order::Two => {
                require((R::lit(0.01)..=R::lit(0.99)).contains(&eta), "presliding_ratio")?;
                let f1 = R::ONE / (R::ONE - eta);
                BlimanSorineParams { levels: [f1, -eta * f1], distances: [eta * eps, eps] }
            }
        }
        .build_dissipative()
    }
}

impl<R: Real> FrictionParams<R> for JointFrictionParams<R> {
    type Model = JointFriction<R>;

    /// # Errors
    /// [`Error::OutOfRange`] with the name of the field, the contacts' and the ripple's too.
    fn build(&self) -> Result<JointFriction<R>, Error> {
        let (forward, backward) = (with_a_level(self.forward), with_a_level(self.backward));
        let ripple = self.ripple.build()?;
        let [load, backward_load] = self.load.build()?;
        // The path is divided by g alone: g0 is in the distances.
        let inverse_level = R::ONE / forward.static_level;
        let presliding = self.normalised_presliding()?.scaled(R::ONE, inverse_level);
        let backward_presliding = presliding.scaled(-R::ONE, R::ONE);
        Ok(JointFriction {
            forward: Side::new(forward.build()?, ripple.forward, load, presliding),
            backward: Side::new(backward.build()?, ripple.backward, backward_load, backward_presliding),
            inverse_eta: match self.order {
                Order::One => R::ZERO,
                Order::Two => R::ONE / self.presliding_ratio,
            },
        })
    }
}

/// The same with levels of at least [`LEAST_LEVEL`]; what is refused stays so.
fn with_a_level<R: Real>(contact: LubricatedContactParams<R>) -> LubricatedContactParams<R> {
    let raised = |level: R| if level >= R::ZERO { level.max(R::lit(LEAST_LEVEL)) } else { level };
    let (coulomb, static_level) = (raised(contact.coulomb), raised(contact.static_level));
    LubricatedContactParams { coulomb, static_level, ..contact }
}
