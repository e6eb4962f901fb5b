//! From a gear file to the parameters of the models: f64 for the reference build, f32 for firmware.
//!
//! The numbers that the library does not compute itself, the observer's gains and those of the cascade, are
//! computed here, once, off line.

use strainwave::belt::SeriesBeltParams;
use strainwave::compensator::reference::output_feedback::OutputFeedbackParams;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::{JointParams, Limits, Tolerances};
use strainwave::flexspline::stiffness_line::StiffnessLineParams;
use strainwave::flexspline::{Bend, Cup, FlexsplineParams, Hardening};
use strainwave::friction::AnyFrictionParams;
use strainwave::gear::{GearParams, KINEMATIC_TERMS};
use strainwave::kinematic_error::{KinematicErrorParams, Term};
use strainwave::{Error, Real};

use crate::design::dense::dense;
use crate::design::feedback::feedback_params;
use crate::design::wave_generator::{at_wave_generator, series_belt};
use crate::design::{compensation, observer_design, rules};
use crate::io::gear_file::friction_params::{friction_params, joint_friction_params};
use crate::io::gear_file::{self, GearFile, Harmonic};

/// The gear that a file describes.
pub fn gear_params<R: Real>(file: &GearFile) -> GearParams<R, AnyFrictionParams<R>> {
    with_friction(file, [&file.friction.input, &file.friction.output].map(friction_params))
}

/// The same with the friction block that the firmware has, and with it the compensator and its plant.
///
/// # Errors
/// [`Error::OutOfRange`] `friction.input.model` or `friction.output.model` when the file names another.
pub fn firmware_gear_params<R: Real>(file: &GearFile) -> Result<GearParams<R>, Error> {
    let side = |side, key| joint_friction_params(side).ok_or(Error::OutOfRange(key));
    let input = side(&file.friction.input, "friction.input.model")?;
    Ok(with_friction(file, [input, side(&file.friction.output, "friction.output.model")?]))
}

fn with_friction<R: Real, P>(file: &GearFile, [input_friction, output_friction]: [P; 2]) -> GearParams<R, P> {
    let (stiffness, cup) = (&file.stiffness, &file.flexspline);
    GearParams {
        ratio: file.gear.signed_ratio().n(),
        rated_torque: R::lit(file.gear.rated_torque),
        flexspline: FlexsplineParams {
            cup: Cup {
                radius: R::lit(cup.radius),
                length: R::lit(cup.length),
                wall: R::lit(cup.wall),
                ellipse: R::lit(cup.ellipse),
                youngs_modulus: R::lit(cup.youngs_modulus),
                poisson_ratio: R::lit(cup.poisson_ratio),
                density: R::lit(cup.density),
            },
            line: StiffnessLineParams {
                stiffness: [stiffness.k1, stiffness.k2, stiffness.k3].map(R::lit),
                knee_torque: [stiffness.t1, stiffness.t2].map(R::lit),
            },
            damping_ratio: R::lit(file.damping.torsion_mode_ratio),
            inertia: R::lit(file.inertia.flexspline),
            hardening: match cup.hardening {
                gear_file::Hardening::Contact => Hardening::Contact,
                gear_file::Hardening::Bends => Hardening::Bends,
            },
            bend: Bend { hardening: R::lit(cup.bend_hardening), saturation: R::lit(cup.bend_saturation) },
        },
        hysteresis_width: R::lit(file.hysteresis.width()),
        hysteresis_table: file.hysteresis.table(),
        kinematic_error: KinematicErrorParams {
            case: terms(&file.kinematic_error.wave_generator),
            flexspline: terms(&file.kinematic_error.flexspline),
        },
        input_friction,
        output_friction,
        wave_generator_inertia: R::lit(file.inertia.wave_generator),
        flexspline_inertia: R::lit(file.inertia.flexspline),
    }
}

fn terms<R: Real>(harmonics: &[Harmonic]) -> [Term<R>; KINEMATIC_TERMS] {
    std::array::from_fn(|k| {
        harmonics.get(k).map_or(Term::default(), |harmonic| Term {
            order: harmonic.order,
            amplitude: R::lit(harmonic.amplitude),
            phase: R::lit(harmonic.phase),
        })
    })
}

/// All that a joint's compensator is built from.
///
/// # Errors
/// As [`firmware_gear_params`]; when the observer's gains cannot be computed for this gear.
pub fn joint_params<R: Real>(file: &GearFile) -> Result<JointParams<R>, Error> {
    let known = &at_wave_generator(file);
    let mut gear: GearParams<R> = firmware_gear_params(file)?;
    gear.wave_generator_inertia = R::lit(known.inertia.wave_generator);
    let output_feedback = rules::parts(known)?.output_feedback;
    Ok(JointParams {
        dt: R::lit(CONTROL_PERIOD),
        gear,
        belt: series_belt(file).map(|belt| SeriesBeltParams {
            teeth: belt.teeth,
            compliance: R::lit(belt.compliance),
            slack_torque: R::lit(belt.slack_torque),
        }),
        motor_encoder_bits: file.sensors.motor_encoder_bits,
        motor_encoder_still: file.sensors.motor_encoder_still,
        output_encoder_bits: file.sensors.output_bits(),
        output_encoder_zero: file.sensors.output_encoder_zero.map(R::lit),
        limits: Limits {
            motor_torque: R::lit(file.motor.peak_torque),
            motor_speed: R::lit(file.motor.rotor_speed_limit),
            output_torque: R::lit(file.gear.peak_torque),
        },
        tolerances: Tolerances {
            torque_constant: R::lit(file.drive.torque_constant),
            rotor_inertia: R::lit(file.tolerances.rotor_inertia),
            stiffness: R::lit(file.tolerances.stiffness),
        },
        drive_response: R::lit(file.drive.response()),
        observer: observer_design::observer_params(known)?,
        disturbance: compensation::disturbance_params(known),
        feedback: feedback_params(known),
        output_feedback: output_feedback.map(|gains| OutputFeedbackParams {
            damping: R::lit(gains.damping),
            damping_at_rest: R::lit(gains.damping_at_rest),
            integral: R::lit(gains.integral),
            filter_corner: R::lit(gains.filter_corner),
        }),
        measured_feedback: compensation::measured_feedback_params(known),
        learning: compensation::learning_params(known, output_feedback[1].integral),
        learnt: file.learnt.as_ref().map_or_else(Default::default, |learnt| learnt.start()),
    })
}

/// A joint's parameters as the Rust source that firmware includes.
///
/// `Debug` prints a float with the shortest digits that read back as the same bits, and a struct as
/// the expression that makes it; what fits on a line is put on one.
pub fn source(params: &JointParams<f32>, gear_name: &str) -> String {
    let table = match params.gear.hysteresis_table {
        Some(_) => "use strainwave::hysteresis::HysteresisTable;\n",
        None => "",
    };
    let belt = match params.belt {
        Some(_) => "use strainwave::belt::SeriesBeltParams;\n",
        None => "",
    };
    let joint = dense(&format!("pub const JOINT: JointParams<f32> = {params:#?};"));
    format!(
        "// Generated from the gear file `{gear_name}`; do not edit.\n\
         {belt}use strainwave::compensator::adapt::parameters::{{AdaptationParams, Factors}};\n\
         use strainwave::compensator::actuate::cascade::FeedbackParams;\n\
         use strainwave::compensator::adapt::learning::{{LearningParams, Learnt}};\n\
         use strainwave::compensator::adapt::ripple::{{LearntRippleParams, RippleMap, RippleOrder}};\n\
         use strainwave::compensator::estimate::disturbance::DisturbanceParams;\n\
         use strainwave::compensator::estimate::observer::deviation::{{Spread, Uncertainty}};\n\
         use strainwave::compensator::estimate::observer::{{Gains, ObserverParams}};\n\
         use strainwave::compensator::reference::measured_feedback::MeasuredFeedbackParams;\n\
         use strainwave::compensator::reference::output_feedback::OutputFeedbackParams;\n\
         use strainwave::compensator::{{EstimateDeviation, JointParams, Limits, Tolerances}};\n\
         use strainwave::flexspline::stiffness_line::StiffnessLineParams;\n\
         use strainwave::flexspline::{{Bend, Cup, FlexsplineParams, Hardening::*}};\n\
         use strainwave::friction::{{\n    \
         Harmonics, JointFrictionParams, LoadFactors, LubricatedContactParams, Order::*, RippleParams,\n}};\n\
         use strainwave::gear::GearParams;\n{table}\
         use strainwave::kinematic_error::{{KinematicErrorParams, Term}};\n\n\
         /// The joint that this firmware controls.\n\
         {joint}\n"
    )
}
