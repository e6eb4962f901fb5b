//! What becomes of an identified file, and which log would help where it is not written.

use std::fmt;

/// The log that shows more of a held joint.
pub const HELD_LOG: &str = "a held log whose torque goes through loops up to rated torque both ways";
/// Of a moving joint.
pub const MOVING_LOG: &str = "a log of slow and medium motion both ways over a turn of the output";
/// Of an operator.
pub const OPERATOR_LOG: &str = "a log of reversal curves: from one end of the range to many places and back";

/// Whether a file is written; for people what stands in the line about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing speaks against it.
    Written,
    /// Something speaks against it, but it was asked for.
    Forced {
        /// What.
        why: String,
    },
    /// Something speaks against it.
    Refused {
        /// What.
        why: String,
        /// The log that would help.
        helps: &'static str,
    },
}

impl Verdict {
    /// Of what speaks against the file, if anything does.
    pub fn of(against: Option<String>, forced: bool, helps: &'static str) -> Self {
        match against {
            None => Self::Written,
            Some(why) if forced => Self::Forced { why },
            Some(why) => Self::Refused { why, helps },
        }
    }

    /// The file is written.
    pub fn is_written(&self) -> bool {
        !matches!(self, Self::Refused { .. })
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Written => formatter.write_str("written"),
            Self::Forced { why } => write!(formatter, "warning: {why}"),
            Self::Refused { why, helps } => write!(formatter, "not written: {why}; what helps is {helps}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_speaks_against_a_file_is_told_with_what_helps_unless_it_is_forced() {
        let of = |against: Option<&str>, forced| Verdict::of(against.map(String::from), forced, HELD_LOG);
        assert!(of(None, false) == Verdict::Written && of(None, true).is_written());
        let (forced, refused) = (of(Some("worse"), true), of(Some("worse"), false));
        assert!(forced.is_written() && forced.to_string() == "warning: worse");
        assert!(!refused.is_written());
        assert_eq!(refused.to_string(), format!("not written: worse; what helps is {HELD_LOG}"));
    }
}
