//! What logs do not show, and which log would.

use std::fmt;

/// A property of the joint that stays the base gear's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotIdentified {
    /// Which.
    pub what: String,
    /// Why it stays.
    pub why: &'static str,
    /// The log that shows it.
    pub helps: &'static str,
}

impl fmt::Display for NotIdentified {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}: not identified, {}; the base gear's stays", self.what, self.why)
    }
}
