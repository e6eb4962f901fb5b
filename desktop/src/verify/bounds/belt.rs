//! Bounds of `verify belt`: closed forms, energy, reduction, precision.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "belt.stiffness",
        value: 1e-15,
        unit: "1",
        why: "load over torsion of the settled chain, both spans taut, relative error: rounding is left; target 1e-9",
    },
    Bound {
        name: "belt.stiffness.slack",
        value: 1e-15,
        unit: "1",
        why: "the same under loads at which one span is slack; target 1e-9",
    },
    Bound {
        name: "belt.span_forces",
        value: 2e-16,
        unit: "1",
        why: "tensions of both spans, taut and slack, relative to the pretension: rounding is left; target 1e-9",
    },
    Bound {
        name: "belt.chain.fixed",
        value: 1e-14,
        unit: "1",
        why: "squares of a span's 16 eigenvalues between fixed ends, from the chain's own steps; target 1e-9",
    },
    Bound {
        name: "belt.chain.pulley",
        value: 1e-9,
        unit: "1",
        why: "the same of both spans and the output's inertia: of the slowest, the output has 3*10^4 times a node's mass, and \
              the tensions that move it are differences; target 1e-9",
    },
    Bound {
        name: "belt.chain.scipy.angle",
        value: 1e-7,
        unit: "1",
        why: "angle of the output in motion against scipy's integration of 4 nodes a span, relative to the largest: \
              first-order error of steps of 0.25 us",
    },
    Bound {
        name: "belt.chain.scipy.forces",
        value: 1e-5,
        unit: "1",
        why: "span forces while both are taut, relative to the pretension: the same error",
    },
    Bound {
        name: "belt.chain.scipy.forces.slack",
        value: 1e-5,
        unit: "1",
        why: "the same while one goes slack and is caught",
    },
    Bound {
        name: "belt.chain.scipy.torque",
        value: 2e-5,
        unit: "1",
        why: "torque that the belt takes from the motor, over the whole run, relative to the largest: the same error",
    },
    Bound {
        name: "belt.chain.scipy.extrapolated",
        value: 1e-6,
        unit: "1",
        why: "span forces while both are taut, extrapolated from two steps to a step of 0: without the first-order error",
    },
    Bound {
        name: "belt.energy",
        value: 1e-6,
        unit: "1",
        why: "largest change in 10^5 steps at half of the stable one, the output swinging on the belt: what comes and goes with \
              (w*dt)^2/8; target 1e-6",
    },
    Bound {
        name: "belt.energy.every_mode",
        value: 1e-6,
        unit: "1",
        why: "the same with every node moving, in steps of a thousandth of the stable one; target 1e-6",
    },
    Bound {
        name: "belt.reduction.torsion",
        value: 1e-2,
        unit: "1",
        why: "massless spans in one step of 0.1 ms against 16 nodes a span, relative to the largest torsion",
    },
    Bound {
        name: "belt.reduction.forces",
        value: 5e-3,
        unit: "1",
        why: "span forces, relative to the pretension, while both spans are taut",
    },
    Bound {
        name: "belt.reduction.forces.slack",
        value: 0.1,
        unit: "1",
        why: "the same while one goes slack and is caught: its damper's force at the moment at which it is taut again, a row of \
              0.1 ms earlier or later",
    },
    Bound {
        name: "belt.f32",
        value: 1e-5,
        unit: "1",
        why: "span forces of the reduction in f32 against f64, relative to the pretension",
    },
    Bound {
        name: "belt.wrist.s1.vibration_to_b0",
        value: 1.6,
        unit: "1",
        why: "torsion's vibration after the steps of S1 over that of the cascade alone, worst of 8 plants of \
              the example of a wrist: 1 to 3 urad under either controller, as on the same joint without a belt",
    },
    Bound {
        name: "belt.wrist.s2.rms_to_b0",
        value: 0.05,
        unit: "1",
        why: "output error of S2 over that of the cascade alone, worst of 8 plants",
    },
    Bound {
        name: "belt.wrist.s2.rms_to_b1",
        value: 0.06,
        unit: "1",
        why: "output error of S2 over that of the cascade with a rigid joint's feed-forward, worst of 8 plants",
    },
    Bound {
        name: "belt.wrist.s3.vibration_to_b0",
        value: 2.4,
        unit: "1",
        why: "torsion's vibration after the move of S3 over that of the cascade alone, worst of 8 plants: \
              0.05 to 0.2 urad under either controller, as on the same joint without a belt",
    },
    Bound {
        name: "belt.wrist.s3.settling_to_b0",
        value: 0.2,
        unit: "1",
        why: "time until the output stays within 20 urad after S3, over that of the cascade alone, worst of 8 plants",
    },
    Bound {
        name: "belt.wrist.s4.ripple_to_b0",
        value: 0.01,
        unit: "1",
        why: "output error at the orders of the kinematic error in S4 over that of the cascade alone, worst of 8 plants",
    },
    Bound {
        name: "belt.wrist.s5.peak_to_b0",
        value: 0.95,
        unit: "1",
        why: "largest deviation under the load step of S5 over that of the cascade alone, worst of 8 plants: the bound without a belt",
    },
    Bound {
        name: "belt.wrist.s5.steady_to_b0",
        value: 0.45,
        unit: "1",
        why: "steady deviation under the load step of S5 over that of the cascade alone, worst of 8 plants: the bound without a belt",
    },
    Bound {
        name: "belt.wrist.s2.rms_to_rigid_belt",
        value: 0.85,
        unit: "1",
        why: "output error of S2 over that of the compensator that takes the belt for rigid, rms of 8 plants",
    },
    Bound {
        name: "belt.wrist.s3.vibration_to_rigid_belt",
        value: 1.05,
        unit: "1",
        why: "the same of the vibration after the move of S3, which the stretch changes little",
    },
    Bound {
        name: "belt.wrist.s5.steady_to_rigid_belt",
        value: 1.0,
        unit: "1",
        why: "the same of the steady deviation of S5, most of which is load within static friction",
    },
    Bound {
        name: "belt.wrist.s2.rms_to_massless_spans",
        value: 1.05,
        unit: "1",
        why: "output error of S2 with a chain of masses in the plant over that with massless spans",
    },
    Bound {
        name: "belt.wrist.s5.steady_to_massless_spans",
        value: 1.05,
        unit: "1",
        why: "the same of the steady deviation of S5",
    },
    Bound {
        name: "belt.wrist.target.cycles",
        value: 1750.0,
        unit: "cycle",
        why: "most costly control step of S1 to S6 with the belt on a Cortex-M4F, by the model; target 2000",
    },
    Bound {
        name: "belt.wrist.target.any_input.cycles",
        value: 1850.0,
        unit: "cycle",
        why: "the same on any input bits, the most costly found",
    },
];
