//! Bounds of `verify hysteresis`: two realisations of one operator, its laws, inverse, cost and identification.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "hysteresis.8.staircase_against_relays",
        value: 5e-15,
        unit: "1",
        why: "two realisations of one operator on the grid, 10^6 random inputs, random weights: rounding is left",
    },
    Bound {
        name: "hysteresis.16.staircase_against_relays",
        value: 5e-15,
        unit: "1",
        why: "the same of 16 levels",
    },
    Bound {
        name: "hysteresis.24.staircase_against_relays",
        value: 1e-14,
        unit: "1",
        why: "the same of the real-time build's 24 levels",
    },
    Bound {
        name: "hysteresis.50.staircase_against_relays",
        value: 1e-14,
        unit: "1",
        why: "the same of 50 levels",
    },
    Bound {
        name: "hysteresis.wiping_out",
        value: 0.0,
        unit: "1",
        why: "a wiped-out extremum leaves no trace in the memory, and outputs are integers",
    },
    Bound {
        name: "hysteresis.congruency",
        value: 2e-15,
        unit: "1",
        why: "the difference of two outputs is rounded where they are made numbers",
    },
    Bound {
        name: "hysteresis.return_point",
        value: 0.0,
        unit: "1",
        why: "the branch that was left is resumed from its own start, in integers",
    },
    Bound {
        name: "hysteresis.rate_independence",
        value: 0.0,
        unit: "1",
        why: "an output depends on its branch and its input alone",
    },
    Bound {
        name: "hysteresis.continuity.f64",
        value: 5e-6,
        unit: "1",
        why: "the steepest slope is twice the output's span over the input's; target 1e-5",
    },
    Bound {
        name: "hysteresis.continuity.f32",
        value: 5e-6,
        unit: "1",
        why: "the same and the input's resolution; target 1e-5",
    },
    Bound {
        name: "hysteresis.forward_after_inverse.f64",
        value: 2e-15,
        unit: "1",
        why: "one equation solved in its cell: rounding; target 1e-9 of span",
    },
    Bound {
        name: "hysteresis.inverse_after_forward.f64",
        value: 5e-15,
        unit: "1",
        why: "rounding of the output, over the least slope after a turning point; target 1e-9 of span",
    },
    Bound {
        name: "hysteresis.forward_after_inverse.f32",
        value: 5e-6,
        unit: "1",
        why: "the fraction of a cell has 15 bits where a branch starts; target 1e-5 of span",
    },
    Bound {
        name: "hysteresis.inverse_after_forward.f32",
        value: 5e-6,
        unit: "1",
        why: "the same, over the least slope after a turning point; target 1e-5 of span",
    },
    Bound {
        name: "hysteresis.torque_after_torsion.f64",
        value: 1e-15,
        unit: "1",
        why: "line and hysteresis solved together, of twice rated torque; target 1e-9 for the inverse",
    },
    Bound {
        name: "hysteresis.torque_after_torsion.f32",
        value: 1e-6,
        unit: "1",
        why: "the same in f32; target 1e-5 for the inverse",
    },
    Bound {
        name: "hysteresis.loop_area",
        value: 3e-13,
        unit: "1",
        why: "area of a closed loop against the energy of the relays crossed, relative; target 1e-9",
    },
    Bound {
        name: "hysteresis.full_memory.error",
        value: 5e-2,
        unit: "1",
        why: "error by the forgotten smallest loops of a ring-down, of the output at saturation",
    },
    Bound {
        name: "hysteresis.full_memory.error_bound",
        value: 0.15,
        unit: "1",
        why: "output change over the smallest loop that is kept: no input after that ring-down can err more",
    },
    Bound {
        name: "hysteresis.default_gear.width",
        value: 5e-3,
        unit: "1",
        why: "relative error of the catalogue's 1 arcmin; the grid of 24 levels rounds the branches off; target 2e-2",
    },
    Bound {
        name: "hysteresis.default_gear.energy",
        value: 1e-9,
        unit: "1",
        why: "area of the cycle by trapezoids against the energy of the relays, relative",
    },
    Bound {
        name: "hysteresis.cycles.forward",
        value: 151.0,
        unit: "cycle",
        why: "the worst-case path through a step on a Cortex-M4F, modelled at the pessimistic end: no history costs more; 1 % \
              of a control period; target 150",
    },
    Bound {
        name: "hysteresis.cycles.inverse",
        value: 250.0,
        unit: "cycle",
        why: "the same of the inverse; 1.5 % of a control period",
    },
    Bound {
        name: "hysteresis.table.bytes",
        value: 2048.0,
        unit: "byte",
        why: "576 entries of two bytes and nine constants; 2 KiB of flash",
    },
    Bound {
        name: "hysteresis.state.bytes",
        value: 256.0,
        unit: "byte",
        why: "28 turning points of eight bytes, the last step's position and output, a count; a quarter KiB of RAM",
    },
    Bound {
        name: "hysteresis.identification.synthetic",
        value: 2e-2,
        unit: "1",
        why: "error, relative to the span, of unseen minor loops of ten random tables of 16 levels, identified from \
              reversal curves with 1 % noise: twice the noise",
    },
    Bound {
        name: "hysteresis.identification.size_17",
        value: 2.5e-5,
        unit: "rad",
        why: "torsion of a measured gear over the second half of its log, rms, offset included; offset and one factor on \
              the catalogue's line are from the first half alone: two counts of a 19-bit encoder",
    },
];
