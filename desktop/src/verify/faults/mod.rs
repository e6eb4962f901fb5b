//! Faults injected into runs: whether each is noticed, and what the joint does until it is and after.
//!
//! Each fault has a number, from which all of it is drawn ([`Injected::of`]): what breaks, when, in which of S1 to S5,
//! with which sensors, on which plant of the box of which gear; so it can be run again alone. The same run without the fault is its
//! twin: same plant, same noise, its drive switched off when the broken one is.
//!
//! | judged | a run is unsafe when |
//! | --- | --- |
//! | speed | the output is faster than its limit, motor_speed/abs n, though its twin is not, until 20 ms after the drive is off, in which a brake engages |
//! | motion | it differs by more than 20 mrad from its twin, and from its angle at the fault, in the same time; not where another motion is asked for, nor where the fault cannot be known |
//! | torque | the motor gives 95 % of its peak for more than 5 ms after the fault, though its twin does not |
//! | gear | the torque through the gear is beyond its peak rating |
//!
//! Named is the first fault that the twin has not. A frozen or stuck motor encoder can be known from when torque
//! exceeds friction: that on a motor that stands as its encoder does, of the gear what the sensors see, has changed in a
//! round's mean by more than static friction holds from one limit to the other, and the motor is 16 counts away; in the
//! phase of the rounds in which that comes last, of those in which it comes at all. It can be known from its noise, too: from when it has stood
//! still for as long as a healthy one may, where the gear file tells. Without either the fault cannot be known: a
//! load that moves a joint whose encoder stands and whose motor does nothing looks like rest.
//! Everything else can be known from when it is injected.

mod injected;

use std::fmt::Write;

use strainwave::Error;
use strainwave::compensator::{Faults, Mode};

use crate::bench::controller::HostCompensator;
use crate::bench::scenario::Scenario;
use crate::bench::task::Demand;
use crate::bench::task::Task;
use crate::bench::{Bench, Conditions};
use crate::design::capability::Capability;
use crate::design::joint::joint_params;
use crate::io::figure::Figure;
use crate::io::gear_file::{GearFile, SensorSet};
use crate::plant::divergence::RunError;
use crate::verify::Measured;
use crate::verify::bounds;
use crate::verify::compensator::each;
pub use injected::{Broken, Injected, Kind, periods_of};
use strainwave::compensator::schedule::{CONTROL_PERIOD, SLOW_PERIODS};

/// Faults when nothing else is said.
pub const COUNT: u64 = 2000;

/// A run goes on for so long after its fault (s).
const AFTER: f64 = 0.3;
/// Uncommanded motion that is borne (rad).
const MOTION: f64 = 0.02;
/// In which a brake engages (s).
const BRAKE: f64 = 0.02;
/// Full torque, as a fraction of the peak, and how long it is borne (s).
const FULL: (f64, f64) = (0.95, 0.005);
/// Faults of a limited command or setpoint, which do not name an injected fault.
pub(super) const LIMITS: Faults = Faults::TORQUE_LIMITED.with(Faults::SETPOINT_LIMITED);

/// The beginning of a scenario.
struct Beginning(Scenario, f64);

impl Task for Beginning {
    fn duration(&self) -> f64 {
        self.1
    }

    fn at(&self, time: f64, capability: &Capability) -> Demand {
        self.0.at(time.min(self.0.duration()), capability)
    }
}

/// One period of a run.
#[derive(Clone, Copy, Debug, Default)]
struct Row {
    output: f64,
    velocity: f64,
    motor: f64,
    transmitted: f64,
    torque: f64,
    faults: Faults,
    safe: bool,
}

/// Outcome of a fault.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The fault.
    pub fault: Injected,
    /// Name of the gear.
    pub gear_name: String,
    /// Time from when it could be known to its name (s); none when it was not named.
    pub named: Option<f64>,
    /// Reported faults.
    pub names: Faults,
    /// The drive was switched off.
    pub safe: bool,
    /// It could be known.
    pub known: bool,
    /// Largest speed of the output over its limit.
    pub speed: f64,
    /// Uncommanded motion (rad).
    pub motion: f64,
    /// As much of it as there was when the fault could be known (rad): no controller with these sensors avoids it.
    pub motion_when_known: f64,
    /// Longest time of full torque (s).
    pub full: f64,
    /// Largest torque through the gear over its peak rating.
    pub gear: f64,
    /// In which ways it was unsafe: speed, motion, torque, gear.
    pub unsafe_by: [bool; 4],
}

/// Why a fault could not be run.
pub type Failed = RunError;

fn go(file: &GearFile, fault: &Injected, controller: &mut Broken) -> Result<Vec<Row>, RunError> {
    let conditions = Conditions { sensors: fault.sensors, ..Conditions::of(file, fault.seed) };
    let mut bench = Bench::condensed(file, &conditions)?;
    let mut rows = Vec::new();
    bench.go(&Beginning(fault.scenario, fault.at + AFTER), controller, |_, _, plant, answer| {
        rows.push(Row {
            output: plant.output().angle.to_radians(),
            velocity: plant.output().velocity,
            motor: plant.motor().angle.to_radians(),
            transmitted: plant.last_torques().transmitted,
            torque: f64::from(answer.motor_torque),
            faults: answer.faults,
            safe: answer.mode == Mode::Safe,
        });
    })?;
    Ok(rows)
}

/// Runs a fault and its twin.
///
/// # Errors
/// A gear that cannot be built, or a plant that diverges.
pub fn run(file: &GearFile, fault: Injected) -> Result<Outcome, RunError> {
    let mut file = file.clone();
    file.sensors.output_torque |= fault.gauge;
    let params = joint_params(&file)?;
    let broken = go(&file, &fault, &mut Broken::build(&params, Some(fault))?)?;
    let released = broken.iter().position(|row| row.safe);
    let mut twin = Broken::build(&params, None)?;
    twin.released = released;
    let twin = go(&file, &fault, &mut twin)?;
    Ok(judge(&file, fault, released, &broken, &twin))
}

fn judge(file: &GearFile, fault: Injected, released: Option<usize>, rows: &[Row], twin: &[Row]) -> Outcome {
    let start = periods_of(fault.at);
    let (n, peak) = (f64::from(file.gear.signed_ratio().n()), file.motor.peak_torque);
    let limit = file.motor.rotor_speed_limit / n.abs();
    let largest =
        |rows: &[Row], of: fn(&Row) -> f64| rows.iter().map(|row| of(row).abs()).fold(0.0, f64::max);
    let watched = released.map_or(rows.len(), |at| (at + periods_of(BRAKE)).min(rows.len()));
    let speed = |rows: &[Row]| largest(&rows[start..watched], |row| row.velocity) / limit;
    // A joint that stands has not moved, whatever its twin does.
    let from = rows[start].output;
    let difference = |k: usize| (rows[k].output - twin[k].output).abs().min((rows[k].output - from).abs());
    let moved = |until: usize| (start..until.min(watched)).map(difference).fold(0.0, f64::max);
    let motion = |until: usize| if fault.asks_otherwise() { 0.0 } else { moved(until) };
    let full = |rows: &[Row]| longest(rows[start..].iter().map(|row| row.torque.abs() >= FULL.0 * peak));
    let gear = largest(&rows[start..], |row| row.transmitted);
    let known = known(file, &fault, rows, start);
    let named =
        (start..rows.len()).find(|&k| rows[k].faults.bits() & !twin[k].faults.with(LIMITS).bits() != 0);
    let names = named.map_or(Faults::NONE, |k| rows[k].faults);
    let safe = released.is_some();
    Outcome {
        fault,
        gear_name: file.gear.name.clone(),
        named: named.map(|k| (k as f64 - known.unwrap_or(start) as f64).max(0.0) * CONTROL_PERIOD),
        names,
        safe,
        known: known.is_some(),
        speed: speed(rows),
        motion: motion(watched),
        motion_when_known: motion(known.unwrap_or(watched)),
        full: full(rows),
        gear: gear / file.gear.peak_torque,
        unsafe_by: [
            speed(rows) > 1.0 && speed(twin) <= 1.0,
            motion(watched) > MOTION && known.is_some(),
            full(rows) > FULL.1 && full(twin) <= FULL.1,
            gear > file.gear.peak_torque,
        ],
    }
}

/// Longest stretch (s).
fn longest(holds: impl Iterator<Item = bool>) -> f64 {
    let (mut now, mut longest) = (0, 0);
    for holds in holds {
        now = if holds { now + 1 } else { 0 };
        longest = longest.max(now);
    }
    f64::from(longest) * CONTROL_PERIOD
}

/// From which period on the fault can be known.
fn known(file: &GearFile, fault: &Injected, rows: &[Row], start: usize) -> Option<usize> {
    if !matches!(fault.kind, Kind::Freeze | Kind::Zeros | Kind::Ones) {
        return Some(start);
    }
    let n = f64::from(file.gear.signed_ratio().n());
    let far = 16.0 * std::f64::consts::TAU / 2f64.powi(file.sensors.motor_encoder_bits.cast_signed());
    let most = most_held(file, fault);
    let on_motor = |rows: &[Row]| {
        let sum: f64 = rows.iter().map(|row| row.torque - seen(file, fault, row) / n).sum();
        sum / rows.len() as f64
    };
    let round = SLOW_PERIODS as usize;
    let by_rounds = |phase: usize| {
        let last = start.checked_sub(phase)?;
        let before = on_motor(rows.get(last.checked_sub(round)?..last)?);
        (last + round..=rows.len()).step_by(round).find(|&k| {
            let moved = rows[k - 1].motor - rows[start].motor;
            moved.abs() > far && (on_motor(&rows[k - round..k]) - before).abs() > most
        })
    };
    // The latest of the phases that the controller's rounds may have, of those in which it is known at all.
    let by_torque = (0..round).filter_map(by_rounds).max();
    let by_noise = file.sensors.motor_encoder_still.map(|still| start + still as usize);
    by_torque.into_iter().chain(by_noise).min().filter(|at| *at < rows.len())
}

/// Largest change of torque that friction holds on a standing motor (N m), as far as joint file and sensors tell: levels
/// and torque constant have tolerances, and each of two torques may be four standard deviations or a count off.
fn most_held(file: &GearFile, fault: &Injected) -> f64 {
    let (sensors, n) = (&file.sensors, f64::from(file.gear.signed_ratio().n()).abs());
    let friction = 2.0 * file.friction.input.static_level.unwrap_or_default();
    let noise = |deviation: f64| 8.0 * deviation / f64::from(SLOW_PERIODS).sqrt();
    let count = std::f64::consts::TAU / 2f64.powi(sensors.output_bits().cast_signed());
    let gear = match (fault.gauge, fault.sensors) {
        (true, _) => noise(sensors.output_torque_noise),
        (false, SensorSet::Both) => 2.0 * count * file.stiffness.k2,
        (false, SensorSet::Motor) => 0.0,
    };
    friction * (1.0 + file.tolerances.friction) * (1.0 + file.drive.torque_constant)
        + noise(sensors.motor_torque_noise)
        + gear / n
}

/// Torque of the gear that the sensors see on a motor that stands (N m), from any zero, less the torque constant's tolerance;
/// by the encoders less that of the stiffness, and as much for the hysteresis, too.
fn seen(file: &GearFile, fault: &Injected, row: &Row) -> f64 {
    let (constant, stiffness) = (file.drive.torque_constant, file.tolerances.stiffness);
    match (fault.gauge, fault.sensors) {
        (true, _) => (1.0 - constant) * row.transmitted,
        (false, SensorSet::Both) => -(1.0 - constant - 2.0 * stiffness) * file.stiffness.k2 * row.output,
        (false, SensorSet::Motor) => 0.0,
    }
}

/// Everything that came of many faults.
#[derive(Clone, Debug)]
pub struct Report {
    /// Of each fault.
    pub outcomes: Vec<Outcome>,
    /// Faults of healthy runs: scenario, sensors, seed, names.
    pub false_alarms: Vec<String>,
}

/// Runs the faults of these numbers; `progress` is called with the fraction done. Every kind of fault goes through the gears of `files` in turn.
///
/// # Panics
/// Without a gear.
///
/// # Errors
/// As [`run`].
pub fn measure(
    files: &[GearFile],
    first: u64,
    count: u64,
    mut progress: impl FnMut(f64),
) -> Result<Report, RunError> {
    let numbers: Vec<u64> = (first..first + count).collect();
    let gear_of = |number: u64| &files[(number / Kind::ALL.len() as u64) as usize % files.len()];
    let outcomes = each(&numbers, |number| run(gear_of(*number), Injected::of(*number)), &mut progress);
    let outcomes = outcomes.into_iter().collect::<Result<Vec<_>, _>>()?;
    // One healthy run in full for twenty faults.
    let healthy: Vec<u64> = numbers.iter().copied().filter(|number| number % 20 == 0).collect();
    let alarms = each(&healthy, |number| alarm(gear_of(*number), &Injected::of(*number)), &mut |_| ());
    let alarms = alarms.into_iter().collect::<Result<Vec<_>, _>>()?;
    Ok(Report { outcomes, false_alarms: alarms.into_iter().flatten().collect() })
}

/// False alarm of a healthy run.
fn alarm(file: &GearFile, fault: &Injected) -> Result<Option<String>, RunError> {
    let mut file = file.clone();
    file.sensors.output_torque |= fault.gauge;
    let conditions = Conditions { sensors: fault.sensors, ..Conditions::of(&file, fault.seed) };
    let mut bench = Bench::condensed(&file, &conditions)?;
    let mut controller = HostCompensator::build(&joint_params(&file)?)?;
    let mut faults = Faults::NONE;
    bench.go(&fault.scenario, &mut controller, |_, _, _, answer| faults = faults.with(answer.faults))?;
    let names: Vec<_> = faults.names().collect();
    let quiet = faults.bits() & !Faults::TORQUE_LIMITED.bits() == 0;
    let line = || {
        format!(
            "{} {} plant {}, {}: {}",
            fault.scenario.name(),
            fault.sensors.name(),
            fault.seed,
            file.gear.name,
            names.join(", ")
        )
    };
    Ok((!quiet).then(line))
}

impl Outcome {
    /// Any of them.
    pub fn is_unsafe(&self) -> bool {
        self.unsafe_by.contains(&true)
    }

    /// In a line.
    pub fn describe(&self) -> String {
        let names: Vec<_> = self.names.names().collect();
        let ways = ["speed", "motion", "torque", "gear"];
        let ways: Vec<_> =
            ways.iter().zip(self.unsafe_by).filter(|(_, is)| *is).map(|(way, _)| *way).collect();
        format!(
            "{}, {}\n  named {} ms: {}; safe {}; speed {:.2}, motion {:.1} mrad, {:.1} when it could be known, full {:.1} ms, gear {:.2} of its peak; unsafe: {}",
            self.fault.describe(),
            self.gear_name,
            self.named.map_or("-".into(), |time| format!("{:.1}", 1e3 * time)),
            names.join(", "),
            self.safe,
            self.speed,
            1e3 * self.motion,
            1e3 * self.motion_when_known,
            1e3 * self.full,
            self.gear,
            ways.join(", ")
        )
    }
}

impl Report {
    /// A line for each kind: count, unsafe, unnamed, worst delay to name, motion, torque through the gear.
    pub fn table(&self) -> String {
        let mut text = format!(
            "{:<26}{:>6}{:>8}{:>9}{:>9}{:>11}{:>13}{:>10}\n",
            "fault", "count", "unsafe", "unnamed", "safe", "named (ms)", "motion (mrad)", "gear/peak"
        );
        for kind in Kind::ALL {
            let of: Vec<_> = self.outcomes.iter().filter(|outcome| outcome.fault.kind == *kind).collect();
            if of.is_empty() {
                continue;
            }
            let count = |is: &dyn Fn(&Outcome) -> bool| of.iter().filter(|outcome| is(outcome)).count();
            let worst =
                |value: &dyn Fn(&Outcome) -> f64| of.iter().map(|outcome| value(outcome)).fold(0.0, f64::max);
            let _ = writeln!(
                text,
                "{:<26}{:>6}{:>8}{:>9}{:>9}{:>11.1}{:>13.1}{:>10.2}",
                kind.name(),
                of.len(),
                count(&Outcome::is_unsafe),
                count(&|outcome| outcome.named.is_none()),
                count(&|outcome| outcome.safe),
                1e3 * worst(&|outcome| outcome.named.unwrap_or(0.0)),
                1e3 * worst(&|outcome| outcome.motion),
                worst(&|outcome| outcome.gear),
            );
        }
        text
    }

    /// The figures with their bounds.
    pub fn measured(&self) -> Measured {
        let count = |way: usize| self.outcomes.iter().filter(|outcome| outcome.unsafe_by[way]).count() as f64;
        let too_late = |outcome: &&Outcome| outcome.known && outcome.motion_when_known > MOTION;
        let unavoidable = self.outcomes.iter().filter(too_late).count();
        let slowest = |kinds: &[Kind]| {
            let of =
                self.outcomes.iter().filter(|outcome| kinds.contains(&outcome.fault.kind) && outcome.known);
            of.map(|outcome| outcome.named.unwrap_or(AFTER)).fold(0.0, f64::max)
        };
        let figures = vec![
            bounds::figure("faults.overspeed", count(0)),
            bounds::figure("faults.motion", count(1)),
            Figure::reported("faults.motion.before_known", unavoidable as f64, "run"),
            bounds::figure("faults.full_torque", count(2)),
            bounds::figure("faults.gear", count(3)),
            Figure::reported(
                "faults.unknowable",
                self.outcomes.iter().filter(|outcome| !outcome.known).count() as f64,
                "run",
            ),
            bounds::figure("faults.named.frozen", slowest(&[Kind::Freeze, Kind::Zeros, Kind::Ones])),
            bounds::figure("faults.named.jump", slowest(&[Kind::Jump])),
            bounds::figure("faults.named.loss", slowest(&[Kind::Loss])),
            bounds::figure("faults.false_alarms", self.false_alarms.len() as f64),
        ];
        Measured { figures, notes: self.false_alarms.clone() }
    }
}

/// The joint of a gear file can be built.
///
/// # Errors
/// As [`joint_params`].
pub fn check(file: &GearFile) -> Result<(), Error> {
    joint_params::<f32>(file)?.build().map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_repeats_its_fault() {
        let file = GearFile::default_gear();
        let [one, other] = [(); 2].map(|()| run(&file, Injected::of(7)).unwrap().describe());
        assert_eq!(one, other);
        assert_ne!(Injected::of(7).describe(), Injected::of(8).describe());
    }

    #[test]
    fn every_kind_has_its_turn() {
        let count = Kind::ALL.len() as u64;
        for (number, kind) in (0..count).zip(Kind::ALL) {
            assert_eq!(Injected::of(number).kind, *kind);
        }
    }

    /// The encoder of a joint that is known to a quarter comes eight periods late: its cascade alone oscillates, too.
    #[test]
    fn a_cascade_that_oscillates_is_switched_off() {
        let mut file = GearFile::default_gear();
        (file.drive.torque_constant, file.tolerances.stiffness) = (0.25, 0.25);
        file.tolerances.rotor_inertia = 0.2;
        let fault = Injected::of(542);
        assert_eq!(fault.kind, Kind::Late);
        let outcome = run(&file, fault).unwrap();
        assert!(outcome.safe && outcome.motion < MOTION, "{}", outcome.describe());
    }

    /// A torque that changes within a round is seen whole by rounds of one phase only.
    #[test]
    fn a_frozen_encoder_is_known_by_rounds_of_any_phase() {
        let file = GearFile::default_gear();
        let fault =
            Injected { kind: Kind::Freeze, sensors: SensorSet::Motor, gauge: false, ..Injected::of(0) };
        let (most, start) = (most_held(&file, &fault), 80);
        let row = |k: usize| {
            let fraction = match k {
                76..84 => -0.9,
                84..120 => 0.6,
                120.. => 1.2,
                _ => 0.0,
            };
            Row { torque: fraction * most, motor: if k > start { 1.0 } else { 0.0 }, ..Row::default() }
        };
        let rows: Vec<_> = (0..200).map(row).collect();
        assert_eq!(known(&file, &fault, &rows[..120], start), Some(96));
        assert_eq!(known(&file, &fault, &rows, start), Some(132));
        assert_eq!(known(&file, &fault, &vec![row(0); 200], start), None);
    }

    /// A watchdog takes the drive off when the control does not come back, and nothing but a reset switches it on.
    #[test]
    fn a_long_overrun_ends_with_the_drive_off() {
        let file = GearFile::default_gear();
        let params = joint_params(&file).unwrap();
        for (size, ends) in [(0.5, false), (1.0, true)] {
            let fault = Injected { kind: Kind::Overrun, size, at: 0.1, ..Injected::of(0) };
            let rows = go(&file, &fault, &mut Broken::build(&params, Some(fault)).unwrap()).unwrap();
            let safe: Vec<_> = rows.iter().skip_while(|row| !row.safe).collect();
            assert_eq!(!safe.is_empty(), ends, "{size}");
            assert!(safe.iter().all(|row| row.safe && row.torque == 0.0), "{size}");
        }
    }

    /// Motion that the controller would make without the fault does not count against it.
    #[test]
    fn a_controller_is_its_own_twin() {
        let file = GearFile::default_gear();
        let params = joint_params(&file).unwrap();
        let fault = Injected { at: 0.1, ..Injected::of(0) };
        let [one, other] =
            [(); 2].map(|()| go(&file, &fault, &mut Broken::build(&params, None).unwrap()).unwrap());
        let outcome = judge(&file, fault, None, &one, &other);
        assert!(!outcome.is_unsafe() && outcome.named.is_none(), "{}", outcome.describe());
    }
}
