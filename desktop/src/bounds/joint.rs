//! The gear as a whole, its plant, and the firmware beside the host.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "angle.torsion.million_turns",
        value: 2e-10,
        unit: "rad",
        why: "f32 torsion up to 1.5 mrad after 10^6 wave-generator turns: a 24-bit difference, 1 unit of which \
              is 1.2e-10 rad; the observer needs 1e-6",
    },
    Bound {
        name: "plant.power_balance",
        value: 1e-6,
        unit: "1",
        why: "what the reference plant's micro-steps leave unaccounted of the energy moved; 1e-4 is asked",
    },
    Bound {
        name: "plant.condensed.output",
        value: 5e-6,
        unit: "rad",
        why: "what 4 micro-steps a period and a mesh without inertia leave of the reference plant's output in a closed loop: a twelfth of a 19-bit encoder's count",
    },
    Bound {
        name: "plant.condensed.torsion",
        value: 5e-6,
        unit: "rad",
        why: "the same of the torsion: 0.07 % of that at rated torque",
    },
    Bound {
        name: "gear.steps.wind_up",
        value: 2e-2,
        unit: "1",
        why: "steady torsion after steps under -50 N m against the catalogue's line, relative: what friction holds; as asked",
    },
    Bound {
        name: "gear.steps.ringing",
        value: 2e-2,
        unit: "1",
        why: "frequency after steps under -50 N m against the eigenvalue at that torque, relative; as asked",
    },
    Bound {
        name: "gear.real_time.output_position.max",
        value: 2e-6,
        unit: "rad",
        why: "a sixth of a 19-bit encoder's count, 1.2e-5 rad",
    },
    Bound {
        name: "gear.real_time.torsion.max",
        value: 2e-6,
        unit: "rad",
        why: "0.14 % of the torsion at rated torque",
    },
    Bound {
        name: "gear.real_time.transmitted_torque.max",
        value: 0.1,
        unit: "N m",
        why: "0.15 % of rated torque",
    },
    Bound {
        name: "gear.real_time.wave_generator_torque.max",
        value: 4e-3,
        unit: "N m",
        why: "a ninth of the Coulomb friction at the wave generator",
    },
    Bound {
        name: "pil.replay.size_17.rms",
        value: 6e-5,
        unit: "rad",
        why: "a measured gear's output predicted with the catalogue's line alone; a rigid gear misses by 2.4e-4",
    },
    Bound {
        name: "pil.faults",
        value: 0.0,
        unit: "1",
        why: "different faults but a limited torque that a joint raises that has none, while it works and in a scenario; as asked",
    },
    Bound {
        name: "pil.limited",
        value: 0.01,
        unit: "s",
        why: "time at the torque limit in a scenario's judged part: no move or load asks for it; as asked",
    },
    Bound {
        name: "pil.worse_marks",
        value: 0.0,
        unit: "1",
        why: "marks of a scenario that are worse than a baseline's on the same plant by more than 5 % and 12 urad; as asked",
    },
    Bound {
        name: "pil.steps_unlike_host",
        value: 0.0,
        unit: "1",
        why: "one generic code, and IEEE arithmetic on both processors: every bit of every output",
    },
];
