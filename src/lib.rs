//! Harmonic-drive torsion, friction and hysteresis in real time: an observer and a feed-forward
//! compensator beside the motor control on a joint controller's microcontroller, the observer every 0.2 ms, the
//! feed-forward every 0.8 ms, cascade and torque command every 0.1 ms.
//! `no_std`, no allocation, no `unsafe`, fixed size; generic over f32 (firmware) and f64 (reference).
//!
//! | module | what is in it |
//! | --- | --- |
//! | [`flexspline`] | torque over torsion: the mass-spring mesh of eq. (6), and its reduction for real time |
//! | [`friction`] | every model of Table 1 and LuGre, one trait; the gear's is Bliman-Sorine to a level of speed, load and angle |
//! | [`hysteresis`] | Preisach operator: relays, and the staircase with its Everett table |
//! | [`kinematic_error`] | the ideal gear's position error, over either rim |
//! | [`belt`] | tooth-belt gear: two pulleys, and the belt's spans as chains of masses, or reduced for real time |
//! | [`gear`] | the two-port that these make: composes, no physics of its own |
//! | [`link`] | flexible arm link with a payload at its tip, by its modes |
//! | [`piezo`] | piezoelectric patch on the link: couple from voltage, with hysteresis, and charge from bending |
//! | [`compensator`] | encoder, observer, feed-forward, feedback, limits and faults: one `step` |
//! | [`trajectory`] | moves from rest to rest with bounded velocity, acceleration, jerk and snap |
//! | [`low_pass`] | low-pass filter of one pole |
//! | [`angle`], [`real`], [`fixed`], [`error`] | angles without bound, the scalar and its functions, its integers, why a build fails |
//! | [`elementary`] | the f32 functions of the control step, and those of other libraries that a cargo feature puts in their place |
//!
//! # Quick start
//!
//! `JOINT` is a joint's parameters as Rust source, generated from its gear file; `examples/joint/hd25_100.rs` is that of a
//! gear of size 25 with the ratio 100. (Firmware reads a compensator that the host has built, in place:
//! [`compensator::Compensator::from_words`].) Below, the model of the gear takes the place of motor and gear. A load of 20 N m
//! pushes against the output; the output reaches its target to 50 urad.
//!
//! ```
//! # mod joint { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/joint/hd25_100.rs")); }
//! # use joint::JOINT;
//! use strainwave::compensator::{CompensationGains, Input, RealTimeFlexspline, RealTimeGear, Sensors};
//! use strainwave::gear::{Applied, Motion};
//! use strainwave::trajectory::TrajectoryParams;
//! use strainwave::Angle;
//!
//! let compensator = JOINT.build()?; // checks every parameter once, by name
//! let mut state = compensator.rest();
//! let limits = TrajectoryParams { velocity: 0.5, acceleration: 5.0, jerk: 100.0, snap: 5e3 };
//! let way = limits.build(JOINT.dt)?.plan(Angle::default(), Angle::from_radians(0.1))?;
//!
//! // The plant; on a controller these are the encoder, the motor and the gear themselves.
//! let flexspline = RealTimeFlexspline::build(&JOINT.gear.flexspline, JOINT.gear.rated_torque)?;
//! let gear: RealTimeGear<f32> = JOINT.gear.build(flexspline, JOINT.dt)?;
//! let (mut memory, mut motor, mut output) = (gear.rest(), Motion::default(), Motion::default());
//! let (mut torque, load) = (0.0, -20.0);
//!
//! for period in 0..10_000 {
//!     // What the 10 kHz interrupt does: read the sensors, one call, send the torque.
//!     let sensors = Sensors {
//!         motor_encoder: motor.angle.phase() >> (32 - JOINT.motor_encoder_bits),
//!         output_encoder: Some(output.angle.phase() >> (32 - JOINT.output_encoder_bits)), // None without one
//!         motor_torque: torque,
//!         output_torque: None, // of a strain gauge
//!     };
//!     let command = way.at(period).into();
//!     let input = Input { sensors, command, gains: CompensationGains::ALL.into(), ..Input::default() };
//!     torque = compensator.control(&mut state, &input).motor_torque; // finite and bounded for any input bits
//!
//!     let inside = gear.torques(&mut memory, &motor, &output, Applied { motor: torque, load });
//!     output.advance(gear.flange_acceleration(&inside, load), JOINT.dt);
//!     motor.advance((torque - inside.wave_generator) / JOINT.gear.wave_generator_inertia, JOINT.dt);
//! }
//! let estimate = compensator.output(&state).estimate; // torsion, torques, load, and their standard deviations
//! assert!((output.angle.minus(way.end())).abs() < 5e-5); // rad; the gear is wound up by ten times that
//! assert!((estimate.external_torque - load).abs() < 2.0); // N m, estimated, not measured
//! # Ok::<(), strainwave::Error>(())
//! ```
//!
//! More are in `examples/`: a whole control loop, a measured log through the observer, a move fed forward, the inverse of
//! the hysteresis, the friction models compared, a link damped by a patch.
//!
//! Equation, figure and table numbers are those of "Modeling of torsional vibration in harmonic drives".
//! Everything has one shape: `Params` in SI units; `build` checks them once and names the first that is out
//! of range; then `step(&self, &mut State, input) -> output`, total: finite and bounded for any input bits.
//!
//! # Units and signs
//!
//! rad, rad/s, N m, kg m^2, s. WG is the wave generator (motor side), FS the flexspline (output side).
//!
//! ```text
//! phi    = r*theta_wg + e(theta_wg) - theta_fs          torsion; r = -1/N (circular spline fixed) or 1/(N + 1)
//! tau_t  = tau_mesh(phi, dphi) + tau_hyst[phi]          through the FS: drives it forwards where phi > 0
//! J_fs*d2theta_fs = tau_t - tau_fric_out + tau_load     tau_load acts ON the FS
//! tau_wg = J_wg*d2theta_wg + tau_fric_in + (r + de/dtheta_wg)*tau_t         what the motor must supply
//! ```
//!
//! Friction has the sign of the velocity that it opposes. Torsion is as exact after a million revolutions as
//! after none:
//!
//! ```
//! use strainwave::{Angle, Ratio};
//!
//! let ratio = Ratio::one_over(-100)?;
//! let wave_generator = Angle::<f32>::from_counts((1_000_000 << 32) + 12_345);
//! let flexspline = ratio.apply(wave_generator).plus(-1e-3);
//! let torsion = ratio.apply(wave_generator).minus(flexspline);
//! assert!((torsion - 1e-3).abs() < 1e-9);
//! # Ok::<(), strainwave::Error>(())
//! ```
#![no_std]
#![warn(missing_docs)]

#[cfg(test)]
extern crate std;

pub mod angle;
pub mod belt;
mod branch;
pub mod compensator;
mod constants;
pub mod elementary;
pub mod error;
mod exponential;
pub mod fixed;
pub mod flexspline;
pub mod friction;
pub mod gear;
pub mod hysteresis;
pub mod kinematic_error;
pub mod link;
pub mod low_pass;
pub mod piezo;
pub mod real;
mod sine_cosine;
pub mod trajectory;

pub use angle::{Angle, Heading, Ratio};
pub use error::Error;
pub use real::Real;
