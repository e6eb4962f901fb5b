//! Lock of data that stay whole when a holder panics.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// The data behind a lock, whatever has become of its last holder.
pub(crate) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
