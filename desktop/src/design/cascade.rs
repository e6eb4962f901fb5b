//! The cascade alone, closed: what it answers at a frequency, and whether it is stable on a plant.
//!
//! ```text
//! C(z) = k_v*(1 + dt/T_i*z/(z - 1))*(k_p + g*(1 - 1/z)/(dt*(1 - (1 - g)/z))),   g = 1 - e^(-omega_f dt),   tau = -C*theta
//! ```
//!
//! As [`strainwave::compensator::actuate::cascade`] with the setpoint zero. Units: rad, rad/s, N m.

use nalgebra::Complex;
use strainwave::compensator::actuate::cascade::FeedbackParams;

use super::plant::Plant;
use super::poles;
use strainwave::compensator::schedule::CONTROL_PERIOD;

/// C at w (rad/s).
pub fn answer(cascade: &FeedbackParams<f64>, omega: f64) -> Complex<f64> {
    let (dt, z) = (CONTROL_PERIOD, Complex::from_polar(1.0, omega * CONTROL_PERIOD));
    let gain = -(-dt * cascade.filter_corner).exp_m1();
    let speed = gain * (1.0 - z.inv()) / (dt * (1.0 - (1.0 - gain) * z.inv()));
    cascade.velocity_gain
        * (1.0 + dt / cascade.integral_time * z / (z - 1.0))
        * (cascade.position_gain + speed)
}

/// One control period of the states theta (rad), omega (rad/s) and I (N m) at the motor's angle: torque (N m).
fn step(cascade: &FeedbackParams<f64>, x: &mut [f64], angle: f64) -> f64 {
    let dt = CONTROL_PERIOD;
    let speed = (angle - x[0]) / dt;
    x[0] = angle;
    x[1] += -(-dt * cascade.filter_corner).exp_m1() * (speed - x[1]);
    let lag = -cascade.position_gain * angle - x[1];
    x[2] += cascade.velocity_gain * dt / cascade.integral_time * lag;
    cascade.velocity_gain * lag + x[2]
}

/// The closed loop's poles are within the circle.
pub fn is_stable(cascade: &FeedbackParams<f64>, plant: &Plant) -> bool {
    let (own, discrete) = (plant.states(), plant.discrete());
    let round = |x: &mut [f64]| {
        let (joint, states) = x.split_at_mut(own);
        let command = step(cascade, states, plant.read(joint)[0]);
        plant.step(&discrete, joint, command);
    };
    poles::of(&vec![1.0; own + 3], round).is_some_and(|all| poles::is_stable(&all))
}
