//! Why a model could not be built.

use core::fmt;

/// A parameter that a model cannot be built from.
///
/// Every `build` checks its parameters once and names the first that is out of range;
/// after that `step` is total.
///
/// A build names the first parameter that is out of its range, so that a gear file can be corrected:
///
/// ```
/// use strainwave::Error;
/// use strainwave::friction::{DahlParams, FrictionParams};
///
/// let too_soft = DahlParams { coulomb: 1.0, stiffness: 0.0, exponent: 1.0 };
/// assert_eq!(too_soft.build().err(), Some(Error::OutOfRange("stiffness")));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error {
    /// The named parameter is not finite or outside the range that its documentation states.
    OutOfRange(&'static str),
}

impl fmt::Display for Error {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange(name) => write!(formatter, "{name} is out of range"),
        }
    }
}

impl core::error::Error for Error {}

/// `Ok` when `holds`, else the error that names the parameter.
pub(crate) fn require(holds: bool, name: &'static str) -> Result<(), Error> {
    if holds { Ok(()) } else { Err(Error::OutOfRange(name)) }
}
