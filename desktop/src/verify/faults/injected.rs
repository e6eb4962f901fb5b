//! One fault: what breaks, when, in which run; drawn from its number.

use std::collections::VecDeque;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainwave::compensator::{
    Command, Compensator, Faults, Input, JointParams, Mode, Output, State, Status,
};

use crate::bench::controller::Controller;
use crate::bench::scenario::Scenario;
use crate::io::gear_file::SensorSet;
use crate::plant::divergence::RunError;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::compensator::words;

macro_rules! kinds {
    ($($kind:ident $name:literal: $doc:literal;)*) => {
        /// Kind of an injected fault.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Kind {
            $(#[doc = $doc] $kind,)*
        }

        impl Kind {
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$kind),*];

            /// As the table names it.
            pub fn name(self) -> &'static str {
                match self { $(Self::$kind => $name,)* }
            }
        }
    };
}

kinds! {
    Freeze "motor encoder frozen": "The motor encoder repeats its last count.";
    Zeros "motor encoder zeros": "It reads 0.";
    Ones "motor encoder ones": "It reads all ones.";
    Bit "motor encoder bit": "One of its bits is stuck.";
    Jump "motor encoder jump": "It jumps by 0.01 to 6 rad and stays there.";
    Burst "motor encoder burst": "Random counts for 1 to 200 ms.";
    Flip "motor encoder sign": "It counts the other way.";
    Drift "motor encoder drift": "It drifts by 0.1 to 2 rad/s.";
    Eccentric "motor encoder eccentric": "An error of order 1, 2 to 50 mrad.";
    Loss "motor encoder lost": "Its frames are no longer valid.";
    Late "motor encoder late": "Its counts come 2 to 20 periods late.";
    OutputLoss "output encoder lost": "The output encoder says nothing more.";
    OutputFreeze "output encoder frozen": "It repeats its last count.";
    OutputJump "output encoder jump": "It jumps by 0.1 to 100 mrad.";
    OutputFlip "output encoder sign": "It counts the other way.";
    OutputDrift "output encoder drift": "It drifts by 1 to 50 mrad/s.";
    Gauge "torque sensor stuck": "The output's torque sensor repeats a torque.";
    DriveDead "drive dead": "The drive gives no torque.";
    DriveStuck "drive stuck": "It gives a torque of its own while it is on.";
    DriveFlip "drive sign": "It gives the opposite of what is commanded.";
    TorqueZero "motor torque zero": "The measured motor torque is 0.";
    TorqueFull "motor torque full": "The measured motor torque is the motor's peak.";
    NotANumber "not a number": "A sensor or setpoint is NaN for 1 to 200 ms.";
    Parameter "parameter bit": "A bit of the constants in RAM flips; boards find it within 3 periods.";
    Overrun "overrun": "1 to 200 steps are not completed in time; a watchdog waits for 38 of them.";
    Restart "restart in motion": "The controller starts again; half of them know why.";
    SetpointJump "setpoint jump": "The setpoint jumps by 0.01 to 1 rad.";
    SetpointFrozen "setpoint frozen": "The setpoint is no longer renewed, and its age is told.";
}

/// Steps that a board's watchdog waits for: 3.8 ms, that of an STM32F405 whose clock is as slow as it may be.
const WATCHDOG: u32 = 38;

/// Steps that run with a changed constant: a board's check of them takes two periods, and a third may have begun.
const CHANGED: usize = 3;

/// A fault in a run.
#[derive(Clone, Copy, Debug)]
pub struct Injected {
    /// It is drawn from.
    pub number: u64,
    /// Kind of the fault.
    pub kind: Kind,
    /// Scenario of the run.
    pub scenario: Scenario,
    /// Sensors of the compensator.
    pub sensors: SensorSet,
    /// A torque sensor at the output is there too.
    pub gauge: bool,
    /// The plant.
    pub seed: u64,
    /// When (s).
    pub at: f64,
    /// Size of the fault, in the unit of its kind, 0..=1.
    pub size: f64,
    /// A choice that some kinds have.
    pub choice: u32,
}

impl Injected {
    /// The fault of this number.
    pub fn of(number: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(number);
        let kinds = Kind::ALL;
        let kind = kinds[(number % kinds.len() as u64) as usize];
        let scenario = Scenario::ALL[random.random_range(0..5)];
        let both = random.random_bool(0.5);
        let at_output = matches!(
            kind,
            Kind::OutputLoss | Kind::OutputFreeze | Kind::OutputJump | Kind::OutputFlip | Kind::OutputDrift
        );
        let latest = match scenario {
            Scenario::S2 => 2.0,
            Scenario::S3 => 0.35,
            _ => 0.7,
        };
        Self {
            number,
            kind,
            scenario,
            sensors: if both || at_output { SensorSet::Both } else { SensorSet::Motor },
            gauge: kind == Kind::Gauge || random.random_bool(0.2),
            seed: random.random_range(10_000..11_000),
            at: random.random_range(0.05..latest),
            size: random.random_range(0.0..1.0),
            choice: random.random(),
        }
    }

    /// In a line.
    pub fn describe(&self) -> String {
        format!(
            "{}: {} ({:.3}, {:#x}) at {:.4} s of {}, {}{}, plant {}",
            self.number,
            self.kind.name(),
            self.size,
            self.choice,
            self.at,
            self.scenario.name(),
            self.sensors.name(),
            if self.gauge { " and torque sensor" } else { "" },
            self.seed
        )
    }

    /// Between two ends, evenly over the logarithm.
    fn between(&self, least: f64, most: f64) -> f64 {
        least * (most / least).powf(self.size)
    }

    fn sign(&self) -> f64 {
        if self.choice & 1 == 0 { 1.0 } else { -1.0 }
    }

    /// What is not a number: 0 the motor's torque, 1 the time of the period, 2 the setpoint.
    fn input(&self) -> u32 {
        (self.choice >> 8) % 3
    }

    /// The fault changes the commanded motion, or takes it away: the one before is no reference.
    pub fn asks_otherwise(&self) -> bool {
        matches!(self.kind, Kind::SetpointJump | Kind::SetpointFrozen)
            || self.kind == Kind::NotANumber && self.input() == 2
    }
}

/// A controller with a fault in it, in its sensors or in its drive. What it answers is what the drive gives.
pub struct Broken {
    fault: Option<Injected>,
    model: Compensator<f32>,
    state: State<f32>,
    params: JointParams<f32>,
    /// Periods so far.
    now: usize,
    /// The drive is switched off from outside in this period, as a comparison needs.
    pub released: Option<usize>,
    random: ChaCha8Rng,
    held: Option<Input<f32>>,
    late: VecDeque<u32>,
    answer: Output<f32>,
    missed: u32,
    /// The parameters were refused, or the watchdog has switched the drive off: until a reset.
    halted: bool,
}

/// Control periods in a time (s).
pub fn periods_of(time: f64) -> usize {
    (time / CONTROL_PERIOD).round() as usize
}

impl Broken {
    /// Around the compensator of a joint; sound without a fault.
    ///
    /// # Errors
    /// As [`JointParams::build`].
    pub fn build(params: &JointParams<f32>, fault: Option<Injected>) -> Result<Self, strainwave::Error> {
        let model = params.build()?;
        Ok(Self {
            fault,
            state: model.rest(),
            model,
            params: *params,
            now: 0,
            released: None,
            random: ChaCha8Rng::seed_from_u64(fault.map_or(0, |fault| fault.number)),
            held: None,
            late: VecDeque::new(),
            answer: Output::default(),
            missed: 0,
            halted: false,
        })
    }

    fn counts(bits: u32, angle: f64) -> u32 {
        (angle / std::f64::consts::TAU * 2f64.powi(bits.cast_signed())).round() as i64 as u32
    }

    /// The input as the fault makes it; `since` its start, in periods. `None`: the step is not run.
    fn spoil(&mut self, fault: &Injected, since: usize, input: &mut Input<f32>) -> Option<()> {
        let bits = self.params.motor_encoder_bits;
        let output_bits = self.params.output_encoder_bits;
        let mask = u32::MAX >> (32 - bits);
        let output_mask = u32::MAX >> (32 - output_bits);
        let time = since as f64 * CONTROL_PERIOD;
        let held = *self.held.get_or_insert(*input);
        let motor = input.sensors.motor_encoder;
        let within = |least: f64, most: f64| since < periods_of(fault.between(least, most));
        let mirror = |now: u32, then: u32| then.wrapping_mul(2).wrapping_sub(now);
        let spoilt = match fault.kind {
            Kind::Freeze => held.sensors.motor_encoder,
            Kind::Zeros => 0,
            Kind::Ones => mask,
            Kind::Bit => {
                let bit = 1 << ((fault.choice >> 8) % bits);
                if fault.choice & 1 == 0 { motor & !bit } else { motor | bit }
            }
            Kind::Jump => motor.wrapping_add(Self::counts(bits, fault.sign() * fault.between(0.01, 6.0))),
            Kind::Burst if within(1e-3, 0.2) => self.random.random(),
            Kind::Flip => mirror(motor, held.sensors.motor_encoder),
            Kind::Drift => {
                motor.wrapping_add(Self::counts(bits, fault.sign() * fault.between(0.1, 2.0) * time))
            }
            Kind::Eccentric => {
                let phase = |count: u32| f64::from(count) * std::f64::consts::TAU / (f64::from(mask) + 1.0);
                let error = phase(motor).sin() - phase(held.sensors.motor_encoder).sin();
                motor.wrapping_add(Self::counts(bits, fault.between(2e-3, 0.05) * error))
            }
            _ => motor,
        };
        input.sensors.motor_encoder = spoilt & mask;
        let output = input.sensors.output_encoder;
        let then = held.sensors.output_encoder.unwrap_or(0);
        match fault.kind {
            Kind::Loss => input.status = input.status.with(Status::MOTOR_ENCODER_INVALID),
            Kind::Late => {
                self.late.push_back(motor);
                let behind = 2 + (fault.size * 18.0) as usize;
                if self.late.len() > behind {
                    self.late.pop_front();
                }
                input.sensors.motor_encoder = self.late.front().copied().unwrap_or(motor);
            }
            Kind::OutputLoss => input.sensors.output_encoder = None,
            Kind::OutputFreeze => input.sensors.output_encoder = output.map(|_| then),
            Kind::OutputJump => {
                let far = Self::counts(output_bits, fault.sign() * fault.between(1e-4, 0.1));
                input.sensors.output_encoder = output.map(|count| count.wrapping_add(far) & output_mask);
            }
            Kind::OutputFlip => {
                input.sensors.output_encoder = output.map(|count| mirror(count, then) & output_mask);
            }
            Kind::OutputDrift => {
                let far = Self::counts(output_bits, fault.sign() * fault.between(1e-3, 0.05) * time);
                input.sensors.output_encoder = output.map(|count| count.wrapping_add(far) & output_mask);
            }
            Kind::Gauge => {
                let limit = f64::from(self.params.limits.output_torque);
                let torque = fault.sign() * fault.size * limit;
                input.sensors.output_torque = input.sensors.output_torque.map(|_| torque as f32);
            }
            Kind::TorqueZero => input.sensors.motor_torque = 0.0,
            Kind::TorqueFull => {
                input.sensors.motor_torque = fault.sign() as f32 * self.params.limits.motor_torque;
            }
            Kind::NotANumber if within(1e-3, 0.2) => match fault.input() {
                0 => input.sensors.motor_torque = f32::NAN,
                1 => input.elapsed = f32::NAN,
                _ => {
                    if let Command::Position(setpoint) = &mut input.command {
                        setpoint.velocity = f32::NAN;
                        setpoint.acceleration = f32::INFINITY;
                        setpoint.position.rest = f32::NAN;
                    }
                }
            },
            Kind::Parameter if since == 0 => self.flip(fault),
            Kind::Parameter => self.halted |= since >= CHANGED,
            Kind::Overrun if since < 1 + (fault.between(1.0, 200.0) as usize) => {
                self.missed += 1;
                self.halted |= self.missed >= WATCHDOG;
                return None;
            }
            Kind::Restart if since == 0 => {
                self.state = self.model.rest();
                if fault.choice & 1 == 0 {
                    input.status = input.status.with(Status::RESTARTED);
                }
            }
            Kind::SetpointJump => {
                if let Command::Position(setpoint) = &mut input.command {
                    let far = (fault.sign() * fault.between(0.01, 1.0)) as f32;
                    setpoint.position = setpoint.position.plus(far);
                }
            }
            Kind::SetpointFrozen => (input.command, input.setpoint_age) = (held.command, time as f32),
            _ => {}
        }
        Some(())
    }

    fn flip(&mut self, fault: &Injected) {
        let mut words = self.model.to_words();
        let [_, _, checksum, own @ ..] = &mut words;
        let place = (fault.choice >> 5) as usize % own.len();
        own[place] ^= 1 << (fault.choice % 32);
        // As if start-up had found it sound: the bit flips afterwards.
        *checksum = words::checksum(own);
        match Compensator::from_words(&words) {
            Ok(model) => self.model = model.clone(),
            Err(_) => self.halted = true,
        }
    }

    /// The torque that the drive gives for what is commanded.
    fn drive(&self, fault: &Injected, commanded: &Output<f32>) -> f32 {
        let limit = f64::from(self.params.limits.motor_torque);
        match fault.kind {
            _ if commanded.mode == Mode::Safe => 0.0,
            Kind::DriveDead => 0.0,
            Kind::DriveStuck => (fault.sign() * fault.size * limit) as f32,
            Kind::DriveFlip => -commanded.motor_torque,
            _ => commanded.motor_torque.clamp(-limit as f32, limit as f32),
        }
    }
}

impl Controller for Broken {
    type Error = RunError;

    fn step(&mut self, input: &Input<f32>) -> Result<Output<f32>, RunError> {
        let (now, mut input) = (self.now, *input);
        self.now += 1;
        if self.released.is_some_and(|released| now >= released) {
            input.status = input.status.with(Status::DRIVE_OFF);
        }
        let fault = self.fault.filter(|fault| now >= periods_of(fault.at));
        if let Some(fault) = fault {
            let since = now - periods_of(fault.at);
            let runs = self.spoil(&fault, since, &mut input).is_some();
            if self.halted {
                return Ok(Output { mode: Mode::Safe, faults: Faults::RESTARTED, ..Output::default() });
            }
            if !runs {
                return Ok(self.answer);
            }
            if self.missed > 0 {
                input.elapsed = (f64::from(self.missed + 1) * CONTROL_PERIOD) as f32;
                input.status = input.status.with(Status::OVERRUN);
                self.missed = 0;
            }
        }
        let mut answer = self.model.step(&mut self.state, &input);
        if let Some(fault) = fault {
            answer.motor_torque = self.drive(&fault, &answer);
        }
        self.answer = answer;
        Ok(answer)
    }
}
