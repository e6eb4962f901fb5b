//! Torque balance of the rotor: torque through the gear, and consistency of torque and motion. Once a round
//! ([`crate::compensator::schedule`]), from the motor's encoder and torque alone.
//!
//! ```text
//! omega = (theta - theta_before)/T,   alpha = (omega - omega_before)/T,   tau_f = tau_c*sign(omega) + F_v*omega
//! X = n*((tau + tau_before)/2 - J_wg*alpha - tau_f),   T_g <- T_g + g*(X - T_g)        torque through the gear
//!
//! dT = K*(omega/n - v),   T <- T + h*dT + 3*b*h*(X - T),   v <- v + h*(T/J_fs + a) - 3*b^2*h/K*(X - T)
//! a <- a - b^3*h/K*(X - T)
//! ```
//!
//! T is the time of the round, tau the mean of the motor's torque over it: alpha is the acceleration about the
//! beginning of the round. g is 1 unless a count of the encoder is so coarse that its noise in X,
//! J_wg*count/T^2*|n|, is more than a twentieth of the peak rating tau_p.
//!
//! The third line is for the protection of the gear ([`crate::compensator::actuate::protection`]), which needs the rate
//! dT too: X alone, differentiated, is noise. K is the middle slope of the stiffness line, v the output's speed, a its
//! acceleration by load, friction and an inertia error (without it dT would be wrong by 1.4*b*20 N m/s), b =
//! sqrt(g)*min(omega_0, 1/(4*h)), omega_0 the natural frequency of gear and load on a free motor, h the round. J_fs counts as
//! at least K_3*(2*h)^2 ([`output_inertia`]).
//!
//! | fault | raised when |
//! | --- | --- |
//! | gear overload | abs T_g > (1 + u_m)*tau_p at the end of a round: no command takes it there ([`crate::compensator::actuate::protection`]), so that it is a blow, or a sign or size of torque or angle that is wrong |
//! | frozen, standing | the count is the same at every observer step of two rounds or more, and tau had changed a round ago, since the rotor stood, or from (tau + tau_before)/2 - J_wg*alpha when it last moved, by more than 2*(1 + u_m)*(tau_s + mu*T_r/n) + T_c/n + 0.01*tau_max + 2*count*K/n^2 + 8*J_wg*count/h^2: static friction gives way at 2*(tau_s + mu*abs T/n) at most, and then the last of it moves the rotor by two counts within half a round |
//! | frozen, loaded | it stands, and the torque on it, that of the gear by the torque sensor included, has at the end of two rounds on end changed by more than that, with what mu*abs T is then and was when it came to stand, and u_s of the gear's change; by the output encoder, than that, 2*count_out*K_3/n and u_t of the change |
//! | frozen, moving | the count stands still at once, though (1 + u_m)*(tau_l + (1 + mu)*abs T_g/n + tau_s) + u_m*tau_p/n + 3*J_wg*count/h^2, with the larger tau_l of abs tau of this round and the last, and the last term for what rounding makes of two speeds, could not stop the rotor in the time: the change of two mean speeds is the work of both rounds |
//! | overspeed | abs omega > the speed limit |
//! | drive | mean torque of the drive over a round, farther than 0.1*tau_max + 0.5*abs tau_c from all between the mean commands of this round and the last, tau_c the larger of them, for longer than a sound drive takes to reach its command, a round of the other sign counting twice: five times the noise that the filter expects, a drive at 60 % of its limit. A drive that lags passes from one to the other; what it lags behind a command that changes from period to period is little in the mean |
//! | following | position error that the cascade follows (x of [`crate::compensator::actuate::braking`]) above 1.5*tau_max/((J_wg + J_fs/n^2)*k_p^2) + abs omega_ref/k_p at the end of a round: one and a half times that from which a cascade with the position gain k_p decelerates with all of the motor's torque, and without feed-forward of the speed |
//!
//! u_m, u_t and u_s are the parts of the torques by motor, torsion and torque sensor that are uncertain ([`Tolerances`]); tau_s is the larger static
//! friction of both directions without load, where its ripple is highest, and mu the larger part of the gear's torque that adds to it, driving or driven.
//! A rotor that stands tells the gear's torque no better than its friction lets it: T_r/n = (abs tau + tau_s)/(1 - mu) is the largest that
//! tau and friction hold, with the smaller tau of those that have changed; mu counts as at most 1/2 there. T_c is by how much the gear's torque
//! may have changed with tau on a rotor that friction holds: by the sensor at the output. Without one, by as much as the gear surely carried,
//! abs tau before the change less what friction holds, as an output that swings doubles its torque or loses it; and at least by what a load
//! that comes changes on a rotor that it does not move: once more what friction holds. Where friction yields before it gives way, such a
//! load moves the rotor by many counts, but a dry one holds it still. The torques by the output's encoder and by its torque sensor
//! are compared with T_g: with a difference of more than u_t*tau_p + u_m of it and of n*tau for 8 ms, the sensor is
//! disabled.
//! Units: rad, s, N m at the motor, of the gear at its output.

use crate::angle::Angle;
use crate::branch::seldom;
use crate::compensator::schedule::{OBSERVER_PERIODS, SLOW_PERIODS};
use crate::compensator::tuned::{GAIN_MARGIN, TRANSIENT_TIME, UNCERTAINTY_MARGIN};
use crate::compensator::{Faults, Limits, Tolerances};
use crate::constants::constants;
use crate::error::Error;
use crate::flexspline::stiffness_line::StiffnessLine;
use crate::gear::GearParams;
use crate::low_pass::LowPass;
use crate::real::Real;

/// Largest part of the gear's torque that counts as friction in what a standing rotor tells of that torque.
const MOST_LOADED: f64 = 0.5;

/// The built balance of the rotor.
#[constants]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotor<R> {
    round: R,
    inverse_round: R,
    inertia: R,
    coulomb: R,
    viscous: R,
    n: R,
    /// K, h/J_fs, 3*b*h, 3*b^2*h/K and b^3*h^2/K.
    stiffness: R,
    load_gain: R,
    gains: [R; 3],
    inverse_n: R,
    /// g.
    filter: LowPass<R>,
    overload: R,
    /// Largest change of tau on a standing rotor (N m), where tau is 0, and what of tau adds to it.
    grip: R,
    grip_by_torque: R,
    /// The same with the gear's torque by the encoders and by the torque sensor (N m at the output).
    held: [R; 2],
    /// (1 + u_m)*mu.
    load: R,
    /// Fraction of a change of the gear's torque, by the encoders and by the torque sensor, that is uncertain.
    uncertainty: [R; 2],
    /// The largest that a torque of the motor may be, over what is known of it.
    largest: R,
    /// What of the gear's torque stops a rotor, with the friction that it adds (N m at the motor).
    stopped_by_gear: R,
    /// Margin added to the torques that stop a rotor (N m).
    surplus: R,
    speed_limit: R,
    drive: R,
    following: R,
    lag: R,
    /// Difference of the gear's torques by different sensors that is no fault (N m), and the part of both that is added to it.
    difference: [R; 2],
    line: StiffnessLine<R>,
    /// Rounds on end in which the drive, and a sensor at the output, are off by a fault.
    not_following: u32,
    disagreeing: u32,
}

/// State of the rotor's balance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RotorState<R> {
    /// Sums of the motor's torques and of the drive's torque errors (N m) of the observer's periods since the last round, and
    /// the time since (s).
    torques: R,
    errors: R,
    time: R,
    /// Angle of the motor at the end of the last round, and that it has been at another one since.
    motor: Angle<R>,
    moves: bool,
    speed: R,
    /// tau of the last round (N m).
    applied: R,
    /// T_g.
    gear_torque: R,
    /// T, dT, v and h*a.
    torque: R,
    rate: R,
    output_speed: R,
    output_change: R,
    friction: R,
    still: u32,
    least: R,
    most: R,
    drive_rounds: u32,
    /// Mean command of the last round (N m).
    commanded: R,
    output_rounds: u32,
    gauge_rounds: u32,
    /// Torque held by friction when the rotor came to stand, by the encoders and by the torque sensor (N m at the output).
    held: [R; 2],
    /// Torque of the gear by the same sensors then (N m).
    gear_torque_then: [R; 2],
    /// By how much it has changed since, by the sensor that was read last; 0 where there is none.
    gear_change: R,
    /// The torque that friction would have to hold, by the same sensors, had changed too much at the end of the last round.
    exceeds: [bool; 2],
    rounds: u32,
}

/// Inputs of the rotor's balance.
#[derive(Clone, Copy, Debug)]
pub struct RotorInput<R> {
    /// Angle of the motor.
    pub motor: Angle<R>,
    /// Position error that the cascade follows (rad) and reference speed (rad/s) of the motor, where it is controlled.
    pub reference: Option<[R; 2]>,
    /// The drive is on.
    pub driven: bool,
}

/// Inertia of the output in the balance of the rotor, and in the protection that relies on it (kg m^2): that of the gear,
/// and at least K_3*(2*h)^2, with the stiffest slope K_3 of the line and the round h (s).
///
/// A mode of the output that goes through more than half a radian in a round cannot be followed by one value a round. A
/// lighter output counts as one whose mode can be, which the protection takes for one that is nearer to being held.
pub fn output_inertia<R: Real>(gear: &GearParams<R>, dt: R) -> R {
    let round = R::from_i32(SLOW_PERIODS as i32) * dt;
    let [_, _, stiffest] = gear.flexspline.line.stiffness;
    gear.flexspline_inertia.max(R::lit(4.0) * stiffest * round * round)
}

impl<R: Real> RotorState<R> {
    /// Adds the means of the motor's torque and of the drive's torque error (N m) over a period of the observer that took `time` (s)
    /// and ended at the angle `motor`.
    #[inline(always)]
    pub fn add(&mut self, [torques, errors]: [R; 2], time: R, motor: Angle<R>) {
        self.torques += torques;
        self.errors += errors;
        self.time += time;
        // An encoder's angle has whole counts.
        self.moves |= motor.counts != self.motor.counts;
    }

    /// Torque through the gear (N m), its rate (N m/s), and the rotor's friction (N m).
    #[inline(always)]
    pub fn gear(&self) -> [R; 3] {
        [self.torque, self.rate, self.friction]
    }
}

impl<R: Real> Rotor<R> {
    /// For a gear, a count of the motor's encoder and one of the output's (rad), the time in which a sound drive
    /// reaches its command (s), the position gain k_p (1/s) of the cascade, and the control period dt (s).
    ///
    /// # Errors
    /// As the gear's stiffness line.
    pub fn build(
        gear: &GearParams<R>,
        limits: &Limits<R>,
        tolerances: &Tolerances<R>,
        [count, output_count]: [R; 2],
        drive_response: R,
        k_p: R,
        dt: R,
    ) -> Result<Self, Error> {
        let line = gear.flexspline.line.build()?;
        let round = R::from_i32(SLOW_PERIODS as i32) * dt;
        let (n, peak) = (R::from_i32(gear.ratio), limits.output_torque);
        let friction = &gear.input_friction;
        let sides = [&friction.forward, &friction.backward];
        let larger = |of: [R; 2]| of[0].max(of[1]);
        let (static_level, loaded) = (friction.largest_level(), friction.largest_load_factor());
        let noise = gear.wave_generator_inertia * count / (round * round) * n.abs();
        let inertia = gear.wave_generator_inertia + gear.flexspline_inertia / (n * n);
        let stiffest = gear.flexspline.line.stiffness[2];
        let gain = R::ONE.min(R::lit(0.05) * peak / noise);
        let [_, stiffness, _] = gear.flexspline.line.stiffness;
        let output = output_inertia(gear, dt);
        let both = R::ONE / output + R::ONE / (n * n * gear.wave_generator_inertia);
        let corner = gain.sqrt() * (stiffness * both).sqrt().min(R::lit(0.25) / round);
        let largest = R::ONE + tolerances.of_motor();
        let load = largest * loaded;
        let grip_by_torque = R::lit(2.0) * load / (R::ONE - loaded.min(R::lit(MOST_LOADED)));
        let margin = R::lit(0.01) * limits.motor_torque
            + R::lit(2.0) * count * stiffest / (n * n)
            + R::lit(8.0) * noise / n.abs();
        let grip = R::lit(2.0) * largest * static_level + margin;
        Ok(Self {
            round,
            inverse_round: R::ONE / round,
            inertia: gear.wave_generator_inertia,
            coulomb: larger(sides.map(|side| side.coulomb)),
            viscous: larger(sides.map(|side| side.viscous)),
            n,
            stiffness,
            load_gain: round / output,
            gains: [
                R::lit(3.0) * corner * round,
                R::lit(3.0) * corner * corner * round / stiffness,
                corner * corner * corner * round * round / stiffness,
            ],
            inverse_n: R::ONE / n,
            filter: LowPass::of_gain(gain),
            overload: largest * peak,
            grip: grip + grip_by_torque * static_level,
            grip_by_torque,
            held: [n.abs() * grip + R::lit(2.0) * output_count * stiffest, n.abs() * grip],
            load,
            uncertainty: [tolerances.of_torsion(), tolerances.of_torque_sensor()],
            largest,
            stopped_by_gear: (largest + load) / n.abs(),
            surplus: tolerances.of_motor() * peak / n.abs()
                + largest * static_level
                + R::lit(3.0) * noise / n.abs(),
            speed_limit: limits.motor_speed + count / round,
            drive: R::lit(0.1) * limits.motor_torque,
            following: R::lit(UNCERTAINTY_MARGIN.get()) * limits.motor_torque / (inertia * k_p * k_p),
            lag: R::ONE / k_p,
            difference: [tolerances.of_torsion() * peak, tolerances.of_motor()],
            line,
            // One round more, as the response begins within one.
            not_following: ((drive_response / round).to_i32() + 2).cast_unsigned(),
            disagreeing: ((R::lit(TRANSIENT_TIME.get()) / round + R::lit(0.5)).to_i32().max(1))
                .cast_unsigned(),
        })
    }

    /// Once a round.
    #[inline(always)]
    pub fn step(&self, state: &mut RotorState<R>, input: &RotorInput<R>, faults: &mut Faults) {
        let (torques, errors, time) = (state.torques, state.errors, state.time);
        (state.torques, state.errors, state.time) = (R::ZERO, R::ZERO, R::ZERO);
        let inverse = if time == self.round {
            self.inverse_round
        } else {
            seldom();
            R::ONE / time.max(R::lit(0.25) * self.round)
        };
        let [torque, drive_error] =
            [torques, errors].map(|sum| R::lit(OBSERVER_PERIODS as f64 / SLOW_PERIODS as f64) * sum);
        let moved = input.motor.since(state.motor);
        let stands = moved == R::ZERO && !state.moves;
        (state.motor, state.moves) = (input.motor, false);
        let speed = moved * inverse;
        let before = state.speed;
        let inertial = self.inertia * (speed - before) * inverse;
        state.speed = speed;
        let kinetic = if moved == R::ZERO { R::ZERO } else { self.coulomb.copysign(moved) };
        state.friction = kinetic + self.viscous * speed;
        let applied_before = core::mem::replace(&mut state.applied, torque);
        let mean = R::lit(0.5) * (torque + applied_before);
        let balance = self.n * (mean - inertial - state.friction);
        if state.rounds < 2 {
            // Two speeds make an acceleration. The output has the motor's: the joint may move when it begins.
            seldom();
            state.rounds += 1;
            (state.least, state.most) = (torque, torque);
            state.output_speed = speed * self.inverse_n;
            return;
        }
        let gear_before = state.gear_torque;
        self.filter.step(&mut state.gear_torque, balance);
        state.rate = self.stiffness * (speed * self.inverse_n - state.output_speed);
        state.torque += self.round * state.rate;
        let residual = balance - state.torque;
        let [by_torque, by_speed, by_change] = self.gains;
        state.torque += by_torque * residual;
        state.output_change -= by_change * residual;
        state.output_speed += self.load_gain * state.torque + state.output_change - by_speed * residual;
        if !input.driven {
            seldom();
            state.still = 0;
            faults.raise_if(!speed.is_within(self.speed_limit), Faults::OVERSPEED);
            return;
        }
        if stands {
            let frozen = if state.still == 0 {
                // The change of two mean speeds is the work of both rounds.
                let strongest = torque.abs().max(applied_before.abs());
                let stopping =
                    self.largest * strongest + self.stopped_by_gear * gear_before.abs() + self.surplus;
                !inertial.is_within(stopping)
            } else {
                // The torque of this round may have come at its end, too late to be seen in the motion; that of the one before
                // counts from when the rotor stood in it.
                (state.least, state.most) = (state.least.min(applied_before), state.most.max(applied_before));
                state.most - state.least > self.largest_change(state, applied_before)
            };
            state.still = state.still.saturating_add(1);
            faults.raise_if(frozen, Faults::MOTOR_ENCODER_FROZEN);
        } else {
            (state.still, state.gear_change) = (0, R::ZERO);
            // What of the torque accelerates a rotor that moves does not hold one that stands.
            let held = mean - inertial;
            (state.least, state.most) = (held, held);
        }
        // A late drive still applies the command of a round ago, or passes from that to the one of this round.
        let commanded = torque - drive_error;
        let (least, most) = (commanded.min(state.commanded), commanded.max(state.commanded));
        let largest = least.abs().max(most.abs());
        state.commanded = commanded;
        let error = (torque - most).max(least - torque);
        // Torque of the other sign: such a round counts twice.
        state.drive_rounds += u32::from(error > self.drive + largest);
        faults.raise_if(!state.gear_torque.is_within(self.overload), Faults::GEAR_OVERLOAD);
        let follows = error <= self.drive + R::lit(1.0 - 1.0 / GAIN_MARGIN) * largest;
        state.drive_rounds = if follows { 0 } else { (state.drive_rounds + 1).min(self.not_following) };
        faults.raise_if(state.drive_rounds == self.not_following, Faults::DRIVE_NOT_FOLLOWING);
        let [position_error, velocity] = input.reference.unwrap_or_default();
        let lost = !position_error.is_within(self.following + self.lag * velocity.abs());
        faults.raise_if(lost, Faults::FOLLOWING_ERROR);
        faults.raise_if(!speed.is_within(self.speed_limit), Faults::OVERSPEED);
    }

    /// By how much the motor's torque, `applied` at last, may have changed on a rotor that friction holds (N m).
    #[inline(always)]
    fn largest_change(&self, state: &RotorState<R>, applied: R) -> R {
        let smaller = state.least.abs().min(state.most.abs());
        let rises = applied - state.least > state.most - applied;
        let seen = self.inverse_n * state.gear_change;
        let by_gear = if seen == R::ZERO {
            let before = if rises { state.least } else { state.most };
            self.grip.max(before.abs() - R::lit(0.5) * self.grip)
        } else if rises {
            seen
        } else {
            -seen
        };
        self.grip + self.grip_by_torque * smaller + by_gear.max(R::ZERO)
    }

    /// Compares the torsion by the encoders (rad) with the rotor's torque, once a round. The faulty encoder is the motor's,
    /// where it has not moved in that time, else the output's.
    #[inline(always)]
    pub fn torsion_disagrees(&self, state: &mut RotorState<R>, torsion: R) -> Faults {
        let torque = self.line.torque(torsion);
        let mut faults = Faults::NONE;
        faults.raise_if(self.slips(state, torque, 0), Faults::MOTOR_ENCODER_FROZEN);
        let disagrees = self.disagrees(state, torque);
        if !lasting(disagrees, &mut state.output_rounds, self.disagreeing) {
            return faults;
        }
        seldom();
        let stands = state.still >= self.disagreeing;
        faults.with(if stands { Faults::MOTOR_ENCODER_FROZEN } else { Faults::OUTPUT_ENCODER_OFF })
    }

    /// The same for the output's torque sensor (N m).
    #[inline(always)]
    pub fn gauge_disagrees(&self, state: &mut RotorState<R>, torque: R) -> Faults {
        let mut faults = Faults::NONE;
        faults.raise_if(self.slips(state, torque, 1), Faults::MOTOR_ENCODER_FROZEN);
        let disagrees = self.disagrees(state, torque);
        let lasts = lasting(disagrees, &mut state.gauge_rounds, self.disagreeing);
        faults.raise_if(lasts, Faults::TORQUE_SENSOR_OFF);
        faults
    }

    /// Whether the torque on a rotor that does not move has changed by more than static friction holds since it stood
    /// still, at the end of two rounds on end, with the gear's `torque` (N m) by the sensor of this `place`: one that has
    /// come at the end of this round is too late to be seen in the motion.
    #[inline(always)]
    fn slips(&self, state: &mut RotorState<R>, torque: R, place: usize) -> bool {
        let held = torque - self.n * state.applied;
        if state.still < 2 {
            (state.held[place], state.gear_torque_then[place]) = (held, torque);
        }
        let then = state.gear_torque_then[place];
        state.gear_change = torque - then;
        let uncertain =
            self.uncertainty[place] * (torque - then).abs() + self.load * (torque.abs() + then.abs());
        let exceeds = !(held - state.held[place]).is_within(self.held[place] + uncertain);
        core::mem::replace(&mut state.exceeds[place], exceeds) & exceeds
    }

    #[inline(always)]
    fn disagrees(&self, state: &RotorState<R>, measured: R) -> bool {
        let torques = measured.abs() + (self.n * state.applied).abs();
        let [difference, part] = self.difference;
        !(measured - state.gear_torque).is_within(difference + part * torques)
    }
}

/// Counts rounds up, and down where it does not hold.
#[inline(always)]
fn lasting(holds: bool, rounds: &mut u32, most: u32) -> bool {
    *rounds = if holds { (*rounds + 1).min(most) } else { rounds.saturating_sub(1) };
    *rounds >= most
}

#[cfg(test)]
mod tests;
