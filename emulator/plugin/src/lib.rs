//! QEMU TCG plugin that counts the instructions and cycles of the control step.
