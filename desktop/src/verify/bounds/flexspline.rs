//! Bounds of `verify flexspline`: mesh, catalogue, strain, real time and speed.

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
        why: "the same of 12 x 3; target 5e-3 for all five meshes",
    },
    Bound { name: "flexspline.16x4.k1", value: 3e-5, unit: "1", why: "the same of 16 x 4" },
    Bound {
        name: "flexspline.36x4.k1",
        value: 2e-4,
        unit: "1",
        why: "the same of the reference mesh: the ellipse's pre-strain stiffens the links",
    },
    Bound { name: "flexspline.72x8.k1", value: 1e-4, unit: "1", why: "the same of the finest mesh" },
    Bound {
        name: "flexspline.8x3.line",
        value: 2e-5,
        unit: "1",
        why: "distance from the catalogue's line up to rated torque, as a fraction of it; the contact has the knees",
    },
    Bound {
        name: "flexspline.36x4.line",
        value: 2e-4,
        unit: "1",
        why: "the same of the reference mesh; target 3e-2",
    },
    Bound {
        name: "flexspline.oracle.mujoco",
        value: 5e-14,
        unit: "m",
        why: "distance of any node of a free shell from MuJoCo's over 1000 steps, strained by up to 0.53 %, where \
              the link law's series ends; target 1e-12",
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
        why: "strain by the product of torque and ellipse; rated torque strains by 1.6e-4",
    },
    Bound {
        name: "flexspline.36x4.reduced.strain_by_torque",
        value: 8e-6,
        unit: "1",
        why: "the same of the reference mesh; rated torque strains by 1.9e-4",
    },
    Bound {
        name: "flexspline.free_shell.shadow_energy_trend",
        value: 1e-6,
        unit: "1",
        why: "trend of the shadow energy, which a symplectic scheme keeps in the place of the mechanical one; the rest is \
              the exchange between modes, see conserved.rs: no drift over a run",
    },
    Bound {
        name: "flexspline.free_shell.momentum",
        value: 1e-14,
        unit: "1",
        why: "every link pulls both its nodes alike: rounding of 10^5 steps; target 1e-12",
    },
    Bound {
        name: "flexspline.free_shell.angular_momentum",
        value: 2e-14,
        unit: "1",
        why: "every link pulls along itself: rounding of 10^5 steps; target 1e-12",
    },
    Bound {
        name: "flexspline.real_time.s1.rms",
        value: 5e-4,
        unit: "1",
        why: "24 levels of hysteresis against the reference's 64, the ringing of each small step; target 1e-2",
    },
    Bound { name: "flexspline.real_time.s1.max", value: 2e-3, unit: "1", why: "the same; target 2e-2" },
    Bound {
        name: "flexspline.real_time.s3.rms",
        value: 5e-4,
        unit: "1",
        why: "0.1 ms steps of a move in 0.25 s and of the ringing after it; target 1e-2",
    },
    Bound {
        name: "flexspline.real_time.s3.max",
        value: 8e-3,
        unit: "1",
        why: "the condensed dashpot changes at once where the torsion passes a knee at speed; target 2e-2",
    },
    Bound {
        name: "flexspline.real_time.s6.rms",
        value: 1e-3,
        unit: "1",
        why: "24 levels of hysteresis against the reference's 64 on every branch; target 1e-2",
    },
    Bound { name: "flexspline.real_time.s6.max", value: 4e-3, unit: "1", why: "the same; target 2e-2" },
    Bound {
        name: "flexspline.bends.8x3.k1",
        value: 1e-5,
        unit: "1",
        why: "hardening in the bend links: error of the literal mesh's small-torsion stiffness against K1; the ellipse's pre-strain, \
              with no contact in series",
    },
    Bound {
        name: "flexspline.bends.36x4.k1",
        value: 1e-3,
        unit: "1",
        why: "the same of the reference mesh; target 5e-3 for both",
    },
    Bound {
        name: "flexspline.bends.8x3.line",
        value: 3e-2,
        unit: "1",
        why: "distance of the literal mesh from the catalogue's line up to rated torque, as a fraction of it: a cubic that \
              saturates has no knees; target 3e-2",
    },
    Bound {
        name: "flexspline.bends.36x4.line",
        value: 3e-2,
        unit: "1",
        why: "the same of the reference mesh",
    },
    Bound { name: "flexspline.bends.48x6.line", value: 3e-2, unit: "1", why: "the same of a finer mesh" },
    Bound {
        name: "flexspline.bends.8x3.law",
        value: 5e-3,
        unit: "1",
        why: "distance of the reduced law from the literal mesh up to rated torque, as a fraction of it: eight straight pieces, \
              products of torsion and ellipse",
    },
    Bound {
        name: "flexspline.bends.36x4.law",
        value: 5e-3,
        unit: "1",
        why: "the same of the reference mesh",
    },
    Bound {
        name: "flexspline.bends.8x3.ripple",
        value: 2e-6,
        unit: "1",
        why: "ripple of the literal mesh over the wave generator's angle, which the law leaves out; target 1e-3",
    },
    Bound {
        name: "flexspline.bends.8x3.ellipse_reaction",
        value: 3e-4,
        unit: "N m",
        why: "torque on the wave generator from rotating the ellipse, which the law leaves out: a hundredth of the Coulomb \
              friction there",
    },
    Bound {
        name: "flexspline.bends.real_time.s1.rms",
        value: 1e-2,
        unit: "1",
        why: "reduced 8 x 3 against literal 36 x 4, both with hardening bend links; target 1e-2",
    },
    Bound { name: "flexspline.bends.real_time.s1.max", value: 2e-2, unit: "1", why: "the same; target 2e-2" },
    Bound { name: "flexspline.bends.real_time.s3.rms", value: 1e-2, unit: "1", why: "the same; target 1e-2" },
    Bound { name: "flexspline.bends.real_time.s3.max", value: 2e-2, unit: "1", why: "the same; target 2e-2" },
    Bound { name: "flexspline.bends.real_time.s6.rms", value: 5e-3, unit: "1", why: "the same; target 1e-2" },
    Bound { name: "flexspline.bends.real_time.s6.max", value: 2e-2, unit: "1", why: "the same; target 2e-2" },
    Bound {
        name: "flexspline.torsion_mode.frequency",
        value: 1e-4,
        unit: "1",
        why: "relative; (omega*dt)^2/24 of semi-implicit steps of 0.1 ms is 1.1e-5, the rest is the mesh's pre- \
              strain; target 1e-2",
    },
    Bound {
        name: "flexspline.torsion_mode.damping_ratio",
        value: 1e-3,
        unit: "1",
        why: "relative; damping terms that the condensation neglects, 9e-5 and less each; target 0.1",
    },
    Bound {
        name: "flexspline.8x3.ripple",
        value: 3e-5,
        unit: "1",
        why: "ripple of eight nodes under an ellipse at rated torsion, as a fraction of rated torque; target 1e-3",
    },
    Bound {
        name: "flexspline.8x3.ellipse_reaction",
        value: 1e-3,
        unit: "N m",
        why: "torque on the wave generator from rotating the ellipse under eight nodes, zero on average, which the condensed \
              law leaves out: a thirtieth of the Coulomb friction there",
    },
    Bound {
        name: "flexspline.real_time.size",
        value: 352.0,
        unit: "byte",
        why: "84 numbers of four bytes and no state; target 1024",
    },
    Bound {
        name: "flexspline.target.cycles",
        value: 150.0,
        unit: "cycle",
        why: "a step of the condensed mesh over S1-S6 on a Cortex-M4F, modelled at the pessimistic end; target \
              600",
    },
];
