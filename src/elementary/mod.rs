//! The f32 elementary functions of the control step: our own, and micromath's and libm's in their place.
//!
//! [`Real`](crate::Real) for f32 takes them from [`ours`]; with the cargo feature `micromath` from that crate; with `libm` from that one,
//! also where both are on. Whoever turns a feature on does so for everything that is built with the same `strainwave`; no claim of this
//! project is about another build than the default. The feature `micromath-beside` only adds the module
//! `micromath`, to compare with. What each costs on a Cortex-M4F, and its errors, stand in the book's chapter on figures.

pub(crate) mod double;
pub mod libm;
#[cfg(any(feature = "micromath", feature = "micromath-beside"))]
pub mod micromath;
pub mod ours;

#[cfg(feature = "libm")]
pub(crate) use self::libm as chosen;
#[cfg(all(feature = "micromath", not(feature = "libm")))]
pub(crate) use self::micromath as chosen;
#[cfg(not(any(feature = "micromath", feature = "libm")))]
pub(crate) use self::ours as chosen;

#[cfg(test)]
mod tests;
