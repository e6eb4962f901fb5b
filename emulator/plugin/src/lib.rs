//! QEMU TCG plugin that counts the instructions and cycles of the control step.
//!
//! Loaded with `-plugin FILE,plan=PLAN,out=FOLDER[,calls=yes][,path=NUMBER]`; `plan` says what to count, `counter` counts, and
//! this file is the plugin interface of `qemu-plugin.h` as far as it is used: only functions that are the
//! same in interface version 1 (QEMU up to 8.2.3) and 2 and later. QEMU loads a plugin only when
//! the version that it declares is one that it supports; it comes from `STRAINWAVE_QEMU_PLUGIN_API` at
//! build time, 1 when that is not set.
//!
//! The result, a file in the folder named by QEMU's process id, holds one line per tracked function,
//! `CALLS INSTRUCTIONS_MIN MAX SUM CYCLES_MIN MAX SUM`, then `executed N`; of the first tracked function `calls CYCLES ...`
//! of every call with `calls=yes`, and `path ADDRESS ...` of the instructions of one call, in decimal, with its number; when a
//! count cannot be trusted, `anomaly TEXT`.

mod counter;
mod plan;
#[cfg(not(test))]
mod qemu;
