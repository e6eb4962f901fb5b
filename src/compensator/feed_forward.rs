//! Feed-forward: where the motor should be, and with what torque, for the output to follow its setpoint.
//!
//! ```text
//! tau_fric_out = friction of the output along the setpoint
//! tau_t     = J_fs*ddq + s_f*tau_fric_out - d               what the flexspline must carry
//! phi       = line^-1(tau_t - tau_hyst)                      wind-up that carries it
//! theta_ref = (q + s_w*phi - s_e*e(theta_ref)) / r           put in advance
//! tau_ff    = s_i*(J_wg*ddtheta_ref + r*J_fs*ddq) + s_f*(tau_fric_in + r*tau_fric_out)
//! ```
//!
//! q is the setpoint of the output with its derivatives, d the external torque that the observer believes,
//! and s the shares (0..=1) of inertia, friction, wind-up and kinematic error. Units: rad, N m.
//!
//! The flexible joint is flat: motor angle and torque follow from the output's trajectory without solving a
//! differential equation. Friction is the gear's own model driven along the setpoint, so its
//! presliding before a reversal is contained; at rest the setpoint covers no path and friction neither
//! drives nor hunts. Hysteresis and kinematic error are implicit equations; both are solved by one
//! fixed-point step per control period: the hysteresis torque follows the torsion of the step before
//! (contraction: its slope over K1, about 0.2), e follows the motor reference of the step before
//! (contraction: N*de/dtheta, about 0.02).
//!
//! The external torque winds the gear up but is left to the feedback's integral as a torque: it is
//! estimated from that very torque.

use crate::angle::Angle;
use crate::compensator::{Setpoint, Shares};
use crate::error::{Error, require};
use crate::flexspline::Reduced;
use crate::friction::joint_friction::{JointFriction, JointFrictionParams, JointFrictionState};
use crate::gear::{Gear, GearParams, Motion};
use crate::hysteresis::torsion_hysteresis::TorsionHysteresisState;
use crate::real::Real;

