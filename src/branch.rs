//! Branch hints: which path the compiler lays out to fall through.

/// Marks a path that is seldom taken: the other one is the one to fall through.
#[cold]
#[inline(always)]
pub(crate) const fn seldom() {}

/// Marks a path that costs less than the alternative, which then is the one to fall through.
#[cold]
#[inline]
pub(crate) fn cheaper() {}
