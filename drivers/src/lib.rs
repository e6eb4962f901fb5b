//! embedded-hal drivers of the joint's sensors.
