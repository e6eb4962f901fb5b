//! Design: from the joint file to parameters, and to gains that have margins; the loops that the controller closes, linear, over the box that a joint
//! may lie in.
//!
//! The joint ([`plant`]) in a corner of the box ([`corners`]) and the controller slot by slot ([`controller`]), as its
//! fundamental answers a sine ([`response`]), make open loops ([`loops`]). Each has margins ([`margins`]) for either set of
//! sensors, with the observer's gains of a motor that moves and of one that stands, the disturbance path passing everything
//! or (within its dead zone) nothing; [`judge`] finds the worst. Margins say how far a stable loop is from an unstable one;
//! that it is stable the poles say ([`poles`]). Gains with margins follow by rule: the cascade's ([`cascade_rule`]), and how
//! much of every other function there may be on top of it ([`level_rule`]). They are offered as an alternative to the gains that
//! [`crate::design::joint::joint_params`] gives the firmware, by rules whose constants stand in [`tuned`]. [`sweep`] measures the same L in the loop of the real code.

pub mod belt;
pub mod buildable;
pub mod capability;
pub mod cascade;
pub mod cascade_rule;
pub mod compensation;
pub mod controller;
pub mod corners;
mod dense;
pub mod estimated_damping;
pub mod export;
pub mod feedback;
pub mod integral_level;
pub mod joint;
pub mod judge;
pub mod level_rule;
pub mod levels;
pub mod loops;
pub mod margins;
pub mod mode;
pub mod observer_design;
mod output_loop;
pub mod parts;
pub mod plant;
pub mod poles;
pub mod required;
pub mod response;
pub mod rules;
mod stable_level;
pub mod sweep;
pub mod tuned;
pub mod variant;
pub mod wave_generator;
