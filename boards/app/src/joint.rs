// Generated from the gear file `hd25-100`; do not edit.
use strainwave::compensator::feedback::FeedbackParams;
use strainwave::compensator::observer::{Gains, ObserverParams};
use strainwave::compensator::{JointParams, Limits};
use strainwave::flexspline::stiffness_line::StiffnessLineParams;
use strainwave::flexspline::{Bend, Cup, FlexsplineParams};
use strainwave::friction::{
    Harmonics, JointFrictionParams, LoadFactors, LubricatedContactParams, Order::*, RippleParams,
};
use strainwave::gear::GearParams;
use strainwave::kinematic_error::{KinematicErrorParams, Term};

/// The joint that this firmware controls.
pub const JOINT: JointParams<f32> = JointParams {
    dt: 0.0001,
    gear: GearParams {
        ratio: -100,
        rated_torque: 67.0,
        flexspline: FlexsplineParams {
            cup: Cup {
                radius: 0.031,
                length: 0.037,
                wall: 0.0004,
                ellipse: 0.0003,
                youngs_modulus: 206000000000.0,
                poisson_ratio: 0.3,
                density: 7850.0,
            },
            line: StiffnessLineParams {
                stiffness: [
                    31000.0,
                    50000.0,
                    57000.0,
                ],
                knee_torque: [
                    14.0,
                    48.0,
                ],
            },
            damping_ratio: 0.02,
            inertia: 1.2,
            bend: Bend {
                hardening: 0.0,
                saturation: 0.0,
            },
        },
        hysteresis_width: 0.00029088822,
        kinematic_error: KinematicErrorParams {
            case: [
                Term {
                    order: 2,
                    amplitude: 0.0001,
                    phase: 0.0,
                },
                Term {
                    order: 4,
                    amplitude: 2e-5,
                    phase: 0.0,
                },
                Term {
                    order: 0,
                    amplitude: 0.0,
                    phase: 0.0,
                },
                Term {
                    order: 0,
                    amplitude: 0.0,
                    phase: 0.0,
                },
                Term {
                    order: 0,
                    amplitude: 0.0,
                    phase: 0.0,
                },
                Term {
                    order: 0,
                    amplitude: 0.0,
                    phase: 0.0,
                },
                Term {
                    order: 0,
                    amplitude: 0.0,
                    phase: 0.0,
                },
                Term {
                    order: 0,
                    amplitude: 0.0,
                    phase: 0.0,
                },
            ],
            flexspline: [
                Term {
                    order: 0,
                    amplitude: 0.0,
                    phase: 0.0,
                },
                Term {
                    order: 0,
                    amplitude: 0.0,
                    phase: 0.0,
                },
                Term {
                    order: 0,
                    amplitude: 0.0,
                    phase: 0.0,
                },
                Term {
                    order: 0,
                    amplitude: 0.0,
                    phase: 0.0,
                },
                Term {
                    order: 0,
                    amplitude: 0.0,
                    phase: 0.0,
                },
                Term {
                    order: 0,
                    amplitude: 0.0,
                    phase: 0.0,
                },
                Term {
                    order: 0,
                    amplitude: 0.0,
                    phase: 0.0,
                },
                Term {
                    order: 0,
                    amplitude: 0.0,
                    phase: 0.0,
                },
            ],
        },
        input_friction: JointFrictionParams {
            order: Two,
            forward: LubricatedContactParams {
                coulomb: 0.035,
                static_level: 0.05,
                stribeck_velocity: 2.0,
                stribeck_exponent: 1.0,
                viscous: 0.00012,
            },
            backward: LubricatedContactParams {
                coulomb: 0.035,
                static_level: 0.05,
                stribeck_velocity: 2.0,
                stribeck_exponent: 1.0,
                viscous: 0.00012,
            },
            presliding: 0.02,
            presliding_ratio: 0.3,
            load: LoadFactors {
                driving: 0.0,
                driven: 0.0,
            },
            ripple: RippleParams {
                forward: Harmonics {
                    mean: 1.0,
                    cosines: [
                        0.0,
                        0.0,
                    ],
                    sines: [
                        0.0,
                        0.0,
                    ],
                },
                backward: Harmonics {
                    mean: 1.0,
                    cosines: [
                        0.0,
                        0.0,
                    ],
                    sines: [
                        0.0,
                        0.0,
                    ],
                },
            },
        },
        output_friction: JointFrictionParams {
            order: Two,
            forward: LubricatedContactParams {
                coulomb: 1.0,
                static_level: 1.3,
                stribeck_velocity: 0.02,
                stribeck_exponent: 1.0,
                viscous: 4.0,
            },
            backward: LubricatedContactParams {
                coulomb: 1.0,
                static_level: 1.3,
                stribeck_velocity: 0.02,
                stribeck_exponent: 1.0,
                viscous: 4.0,
            },
            presliding: 0.0002,
            presliding_ratio: 0.3,
            load: LoadFactors {
                driving: 0.0,
                driven: 0.0,
            },
            ripple: RippleParams {
                forward: Harmonics {
                    mean: 1.0,
                    cosines: [
                        0.0,
                        0.0,
                    ],
                    sines: [
                        0.0,
                        0.0,
                    ],
                },
                backward: Harmonics {
                    mean: 1.0,
                    cosines: [
                        0.0,
                        0.0,
                    ],
                    sines: [
                        0.0,
                        0.0,
                    ],
                },
            },
        },
        wave_generator_inertia: 6e-5,
        flexspline_inertia: 1.2,
    },
    motor_encoder_bits: 19,
    output_encoder_bits: 19,
    limits: Limits {
        motor_torque: 2.4,
        motor_speed: 586.0,
        output_torque: 157.0,
    },
    observer: ObserverParams {
        gains: [
            Gains {
                motor: [
                    0.41685876,
                    1034.6537,
                    -0.14941251,
                    -66.73461,
                    -21127.314,
                ],
                output: [
                    0.0,
                    0.0,
                    0.0,
                    0.0,
                    0.0,
                ],
                torque: [
                    0.0,
                    0.0,
                    0.0,
                    0.0,
                    0.0,
                ],
            },
            Gains {
                motor: [
                    0.37175748,
                    815.9488,
                    -0.036040943,
                    -20.144278,
                    -7606.2354,
                ],
                output: [
                    -0.036040943,
                    -183.04178,
                    0.095709525,
                    58.644413,
                    24211.521,
                ],
                torque: [
                    0.0,
                    0.0,
                    0.0,
                    0.0,
                    0.0,
                ],
            },
            Gains {
                motor: [
                    0.37035596,
                    807.52075,
                    -0.031595696,
                    -18.186527,
                    -7037.758,
                ],
                output: [
                    0.0,
                    0.0,
                    0.0,
                    0.0,
                    0.0,
                ],
                torque: [
                    1.1296102e-6,
                    0.0060157008,
                    -3.2953933e-6,
                    -0.0020832983,
                    -0.88431066,
                ],
            },
            Gains {
                motor: [
                    0.36576805,
                    785.456,
                    -0.020155223,
                    -12.486287,
                    -5137.463,
                ],
                output: [
                    -0.020155223,
                    -101.19641,
                    0.05292761,
                    36.41717,
                    16686.254,
                ],
                torque: [
                    6.681379e-7,
                    0.0037802735,
                    -2.1353649e-6,
                    -0.0014698107,
                    -0.6736999,
                ],
            },
        ],
    },
    feedback: FeedbackParams {
        position_gain: 94.24778,
        velocity_gain: 0.0678584,
        integral_time: 0.02,
        filter_corner: 3769.9111,
        torque_limit: 2.4,
    },
};
