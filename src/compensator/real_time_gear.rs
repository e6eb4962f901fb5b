//! The gear in its real-time build: resolution of its parts. The sizes are fixed at compile time, for nothing is
//! allocated.

use crate::flexspline::Reduced;
use crate::friction::JointFriction;
use crate::gear::Gear;

/// Levels of the real-time hysteresis.
pub const HYSTERESIS_LEVELS: usize = 24;

/// Turning points that it stores: a state of 244 bytes.
pub const HYSTERESIS_MEMORY: usize = 28;

/// Nodes around and slices along of the mesh that the real-time flexspline is condensed from.
pub const MESH: (usize, usize) = (8, 3);

/// The flexspline in its real-time build.
pub type RealTimeFlexspline<R> = Reduced<R, { MESH.0 }, { MESH.1 }>;

/// The gear in its real-time build.
pub type RealTimeGear<R> =
    Gear<R, RealTimeFlexspline<R>, JointFriction<R>, HYSTERESIS_LEVELS, HYSTERESIS_MEMORY>;
