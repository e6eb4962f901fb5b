//! Why a model could not be built.

use core::fmt;

/// A parameter that a model cannot be built from.
///
/// Every `build` checks its parameters once and names the first that is out of range;
/// after that `step` is total.
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
