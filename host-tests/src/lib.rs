//! Tests that compare the firmware's build with the desktop's.
