//! From a belt file to the parameters of the belt gear.

use std::array::from_fn;

use strainwave::Real;
use strainwave::belt::{BeltParams, PITCH_TERMS, PitchErrorParams, PitchTerm, PulleyParams, SpanParams};
use strainwave::friction::AnyFrictionParams;

use crate::io::belt_file::{BeltFile, PitchHarmonic, Pulley};
use crate::io::gear_file::friction_params::friction_params;

/// Parameters of the belt gear of a checked file.
pub fn belt_params<R: Real>(file: &BeltFile) -> BeltParams<R, AnyFrictionParams<R>> {
    let geometry = file.geometry().expect("the file is checked");
    let belt = &file.belt;
    let mut params = BeltParams {
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
    // zeta = T_d*w/2 of the mode w^2 = K/J.
    let frequency = (params.torsional_stiffness() / params.inertia(&params.output, 0)).sqrt();
    params.span.damping_time = R::lit(2.0 * file.damping.output_mode_ratio) / frequency;
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
