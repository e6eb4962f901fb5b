//! Bounds of `verify identify`: what is predicted of logs and motions that did not train.

use super::Bound;

pub(super) const ROWS: &[Bound] = &[
    Bound {
        name: "identify.held.stiffness",
        value: 0.05,
        unit: "1",
        why: "stiffness from the first 0.3 to 0.9 of a held joint's log against that of all of it, the largest relative \
              difference",
    },
    Bound {
        name: "identify.held.in_sample",
        value: 35e-6,
        unit: "rad",
        why: "rms of the same joint's torsion, all of the log training; a stiffness line with Dahl's hysteresis leaves 39 urad",
    },
    Bound {
        name: "identify.pairs.worst_over_untrained",
        value: 1.0,
        unit: "1",
        why: "one log of a measured joint trains, another is predicted: error over that of the gear file that it started \
              from, the worst pair; training never hurts",
    },
    Bound {
        name: "identify.pairs.median_over_rigid",
        value: 0.35,
        unit: "1",
        why: "the same error over the rigid gear's, median of all pairs",
    },
    Bound {
        name: "identify.moving.over_rigid",
        value: 0.5,
        unit: "1",
        why: "output error of a measured joint after the first third of its motion over the rigid gear's",
    },
    Bound {
        name: "identify.friction.outside",
        value: 0.1,
        unit: "1",
        why: "share of synthetic joints with a parameter of the input friction outside its 95 % interval, the parameter that is \
              outside most often",
    },
    Bound {
        name: "identify.friction.level",
        value: 0.02,
        unit: "1",
        why: "relative error of the Coulomb level that 95 % of them stay within; 1 % of the rated torque is 8 to 40 % of it",
    },
    Bound {
        name: "identify.friction.over_static",
        value: 0.15,
        unit: "1",
        why: "error of the friction of a motion that did not train over that of the best static law, the worst of them",
    },
    Bound {
        name: "identify.operator.held_out",
        value: 0.03,
        unit: "1",
        why: "rms error of an identified Preisach operator, of the output's span, on loops of an actuator of another class that \
              did not train, and on the second half of a held joint's log",
    },
    Bound {
        name: "identify.operator.butterfly",
        value: 0.05,
        unit: "1",
        why: "the same with weights of either sign, of an output that falls on both sides of its middle",
    },
    Bound {
        name: "identify.operator.over_rival",
        value: 1.0,
        unit: "1",
        why: "the same error over that of the best of a straight line, a line with Dahl's hysteresis and scipy's \
              non-negative least squares with the number of levels that suits what is held out best; --rivals measures it",
    },
];
