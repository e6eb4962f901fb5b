//! From a belt file, or a gear file with a belt, to the parameters of the belt.

use std::array::from_fn;

use strainwave::Real;
use strainwave::belt::{BeltParams, PITCH_TERMS, PitchErrorParams, PitchTerm, PulleyParams, SpanParams};
use strainwave::friction::{AnyFrictionParams, ViscousParams};

use crate::io::belt_file::{BeltFile, PitchHarmonic, Pulley};
use crate::io::gear_file::GearFile;
use crate::io::gear_file::friction_params::friction_params;

/// Parameters of the belt gear of a checked file.
pub fn belt_params<R: Real>(file: &BeltFile) -> BeltParams<R, AnyFrictionParams<R>> {
    let geometry = file.geometry().expect("the file is checked");
    let belt = &file.belt;
    let params = BeltParams {
        pitch: R::lit(belt.pitch),
        belt_teeth: belt.teeth.cast_signed(),
        span: SpanParams {
            length: R::lit(geometry.span_length),
            stiffness: R::lit(belt.stiffness),
            mass: R::lit(belt.mass),
            pretension: R::lit(belt.pretension),
            damping_time: R::ZERO,
        },
        motor: pulley(&file.motor_pulley, geometry.wrap[0]),
        output: pulley(&file.output_pulley, geometry.wrap[1]),
        pitch_error: PitchErrorParams {
            motor: terms(&file.pitch_error.motor),
            output: terms(&file.pitch_error.output),
            belt: terms(&file.pitch_error.belt),
        },
        motor_friction: friction_params(&file.friction.motor),
        output_friction: friction_params(&file.friction.output),
    };
    damped(params, file.damping.output_mode_ratio)
}

/// The belt in front of a gear without friction of its own, and its damping; of a checked file.
pub fn driving_belt(file: &GearFile) -> Option<BeltParams<f64, ViscousParams<f64>>> {
    let belt = file.belt.as_ref()?;
    let geometry = belt.geometry().expect("the file is checked");
    let pulley = |place: usize, inertia| PulleyParams {
        teeth: belt.pulley_teeth()[place].cast_signed(),
        wrap: geometry.wrap[place],
        inertia,
    };
    let params = BeltParams {
        pitch: belt.pitch,
        belt_teeth: belt.teeth.cast_signed(),
        span: SpanParams {
            length: geometry.span_length,
            stiffness: belt.stiffness,
            mass: belt.mass,
            pretension: belt.pretension,
            damping_time: 0.0,
        },
        motor: pulley(0, belt.rotor_inertia),
        output: pulley(1, file.inertia.wave_generator),
        pitch_error: PitchErrorParams::default(),
        motor_friction: ViscousParams { viscous: 0.0 },
        output_friction: ViscousParams { viscous: 0.0 },
    };
    Some(damped(params, belt.mode_damping_ratio))
}

/// With the damping ratio of the mode of the driven pulley on both spans: zeta = T_d*w/2, w^2 = K/J.
fn damped<R: Real, P>(mut params: BeltParams<R, P>, ratio: f64) -> BeltParams<R, P> {
    let frequency = (params.torsional_stiffness() / params.inertia(&params.output, 0)).sqrt();
    params.span.damping_time = R::lit(2.0 * ratio) / frequency;
    params
}

fn pulley<R: Real>(pulley: &Pulley, wrap: f64) -> PulleyParams<R> {
    PulleyParams { teeth: pulley.teeth.cast_signed(), wrap: R::lit(wrap), inertia: R::lit(pulley.inertia) }
}

fn terms<R: Real>(list: &[PitchHarmonic]) -> [PitchTerm<R>; PITCH_TERMS] {
    from_fn(|index| {
        list.get(index).map_or_else(PitchTerm::default, |term| PitchTerm {
            order: term.order,
            amplitude: R::lit(term.amplitude),
            phase: R::lit(term.phase),
        })
    })
}
