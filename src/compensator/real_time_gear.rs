//! The gear as it runs in real time: how finely its parts are resolved. The sizes are fixed at compile time, for
//! nothing is allocated.

use crate::flexspline::Reduced;
use crate::friction::JointFriction;
use crate::gear::Gear;

/// Levels of the hysteresis that runs in real time.
pub const HYSTERESIS_LEVELS: usize = 24;

/// Turning points that it remembers: a state of 244 bytes.
pub const HYSTERESIS_MEMORY: usize = 28;

/// Nodes around and slices along of the mesh whose reduction runs in real time.
pub const MESH: (usize, usize) = (8, 3);

/// The flexspline as it runs in real time.
pub type RealTimeFlexspline<R> = Reduced<R, { MESH.0 }, { MESH.1 }>;

/// The gear as it runs in real time.
pub type RealTimeGear<R> =
    Gear<R, RealTimeFlexspline<R>, JointFriction<R>, HYSTERESIS_LEVELS, HYSTERESIS_MEMORY>;
