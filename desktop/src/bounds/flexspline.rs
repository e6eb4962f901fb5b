//! What `verify flexspline` measures: mesh, catalogue, strain, real time and speed.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "flexspline.8x3.k1",
        value: 2e-3,
        unit: "1",
        why: "relative error of the coarse mesh's small-torsion stiffness against K1, with the ellipse between nodes",
    },
    Bound {
        name: "flexspline.12x3.k1",
        value: 1e-6,
        unit: "1",
        why: "the same of 12 x 3; 5e-3 is asked of all five meshes",
    },
    Bound { name: "flexspline.16x4.k1", value: 3e-5, unit: "1", why: "the same of 16 x 4" },
    Bound {
        name: "flexspline.36x4.k1",
        value: 2e-4,
        unit: "1",
        why: "the same of the reference mesh: what the ellipse's pre-strain adds to the links' stiffness",
    },
    Bound { name: "flexspline.72x8.k1", value: 1e-4, unit: "1", why: "the same of the finest mesh" },
    Bound {
        name: "flexspline.8x3.line",
        value: 2e-5,
        unit: "1",
        why: "distance from the catalogue's line up to rated torque, as a share of it; the contact has the knees",
    },
    Bound {
        name: "flexspline.36x4.line",
        value: 2e-4,
        unit: "1",
        why: "the same of the reference mesh; 3e-2 is asked",
    },
    Bound {
        name: "flexspline.oracle.mujoco",
        value: 5e-14,
        unit: "m",
        why: "distance of any node of a free shell from MuJoCo's over 1000 steps, strained by up to 0.53 %, where \
              the link law's series ends; 1e-12 is asked",
    },
    Bound {
        name: "flexspline.8x3.reduced.strain",
        value: 4e-5,
        unit: "1",
        why: "strain that any gauge on the reduced mesh lacks: the inner slices' displacement of second order in w0/R; \
              the ellipse alone strains by 4.8e-3",
    },
    Bound {
        name: "flexspline.36x4.reduced.strain",
        value: 8e-5,
        unit: "1",
        why: "the same of the reference mesh; its ellipse strains by 2.3e-3",
    },
    Bound {
        name: "flexspline.8x3.reduced.strain_by_torque",
        value: 6e-6,
        unit: "1",
        why: "what torque times ellipse adds to a strain; rated torque strains by 1.6e-4",
    },
    Bound {
        name: "flexspline.36x4.reduced.strain_by_torque",
        value: 8e-6,
        unit: "1",
        why: "the same of the reference mesh; rated torque strains by 1.9e-4",
    },
    Bound {
        name: "flexspline.8x3.size_14",
        value: 2e-5,
        unit: "1",
        why: "a smaller cup, the catalogue's HFUS line, up to 10 N m; the contact has the knees; 3e-2 is asked of \
              all sizes",
    },
    Bound {
        name: "flexspline.8x3.size_17",
        value: 2e-5,
        unit: "1",
        why: "the same up to 31 N m; T1, T2 and K2 of this line are recalled",
    },
    Bound {
        name: "flexspline.8x3.size_20",
        value: 2e-5,
        unit: "1",
        why: "the same up to 52 N m; T1, T2 and K2 are recalled",
    },
    Bound {
        name: "flexspline.8x3.size_25",
        value: 2e-5,
        unit: "1",
        why: "the same up to 67 N m; the default gear's own line",
    },
    Bound {
        name: "flexspline.8x3.size_32",
        value: 2e-5,
        unit: "1",
        why: "the same up to 141 N m, a larger cup",
    },
    Bound {
        name: "flexspline.36x4.size_14",
        value: 2e-4,
        unit: "1",
        why: "what the ellipse's pre-strain adds to the reference mesh's torque, as in K1",
    },
    Bound { name: "flexspline.36x4.size_17", value: 2e-4, unit: "1", why: "the same of size 17" },
    Bound { name: "flexspline.36x4.size_20", value: 2e-4, unit: "1", why: "the same of size 20" },
    Bound { name: "flexspline.36x4.size_25", value: 2e-4, unit: "1", why: "the same of size 25" },
    Bound { name: "flexspline.36x4.size_32", value: 2e-4, unit: "1", why: "the same of size 32" },
    Bound {
        name: "flexspline.free_shell.energy_trend",
        value: 1e-6,
        unit: "1",
        why: "a symplectic scheme loses none; what is left is the exchange between modes, see conserved.rs; as \
              asked",
    },
    Bound {
        name: "flexspline.free_shell.momentum",
        value: 1e-14,
        unit: "1",
        why: "every link pulls both its nodes alike: rounding of 10^5 steps; 1e-12 is asked",
    },
    Bound {
        name: "flexspline.free_shell.angular_momentum",
        value: 2e-14,
        unit: "1",
        why: "every link pulls along itself: rounding of 10^5 steps; 1e-12 is asked",
    },
    Bound {
        name: "flexspline.real_time.s1.rms",
        value: 5e-4,
        unit: "1",
        why: "24 levels of hysteresis against the reference's 64, the ringing of each small step; 1e-2 is asked",
    },
    Bound { name: "flexspline.real_time.s1.max", value: 2e-3, unit: "1", why: "the same; 2e-2 is asked" },
    Bound {
        name: "flexspline.real_time.s3.rms",
        value: 5e-4,
        unit: "1",
        why: "0.1 ms steps of a move in 0.25 s and of the ringing after it; 1e-2 is asked",
    },
    Bound {
        name: "flexspline.real_time.s3.max",
        value: 8e-3,
        unit: "1",
        why: "the condensed dashpot changes at once where the torsion passes a knee at speed; 2e-2 is asked",
    },
    Bound {
        name: "flexspline.real_time.s6.rms",
        value: 1e-3,
        unit: "1",
        why: "24 levels of hysteresis against the reference's 64 on every branch; 1e-2 is asked",
    },
    Bound { name: "flexspline.real_time.s6.max", value: 4e-3, unit: "1", why: "the same; 2e-2 is asked" },
    Bound {
        name: "flexspline.torsion_mode.frequency",
        value: 1e-4,
        unit: "1",
        why: "relative; (omega*dt)^2/24 of semi-implicit steps of 0.1 ms is 1.1e-5, the rest is the mesh's pre- \
              strain; 1e-2 is asked",
    },
    Bound {
        name: "flexspline.torsion_mode.damping_ratio",
        value: 1e-3,
        unit: "1",
        why: "relative; what the condensation neglects of the damping, 9e-5 and less a term; 0.1 is asked",
    },
    Bound {
        name: "flexspline.real_time.ripple",
        value: 0.0,
        unit: "1",
        why: "the condensed law does not know the wave generator's angle, and torsion keeps its 24 bits at any \
              angle",
    },
    Bound {
        name: "flexspline.8x3.ripple",
        value: 3e-5,
        unit: "1",
        why: "what eight nodes under an ellipse leave at rated torsion, as a share of rated torque; 1e-3 is asked",
    },
    Bound {
        name: "flexspline.real_time.size",
        value: 192.0,
        unit: "byte",
        why: "40 numbers of four bytes and no state; 1024 are asked",
    },
    Bound {
        name: "flexspline.target.cycles",
        value: 150.0,
        unit: "cycle",
        why: "a step of the condensed mesh over S1-S6 on a Cortex-M4F, modelled at the pessimistic end; 600 are \
              asked",
    },
];
