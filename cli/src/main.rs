//! The `strainwave` command, thin over the desktop and emulator libraries.

fn main() {}
