//! An arm link, open loop: angle of the joint, force on the tip and voltage of the patch in; tip, strain, torque and charge out.
//!
//! The joint's angle is the curve of the least squared jerk through the rows of the input (`curve.rs`), at rest before the first and
//! from the last on; force and voltage are linear between rows. The link starts at rest as it hangs at the first row's angle
//! under the first row's force, the patch without voltage.
//!
//! Discretisation: a row every control period from the first stamp of the input; the link's own steps are exact for inputs that are
//! linear between them. Units and signs as in [`strainwave::link`] and [`strainwave::piezo`].

use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::gear::Motion;
use strainwave::link::{Gauge, Link, LinkInput, LinkOutput, LinkState};
use strainwave::piezo::{Piezo, PiezoState};
use strainwave::{Angle, Error};

use crate::io::link_file::{LEVELS, LinkFile, MEMORY};
use crate::io::log::LinkInputLog;
use crate::plant::curve::Curve;

/// A link at an instant.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkRow {
    /// Time (s).
    pub time: f64,
    /// Deflection of the tip across the link (m).
    pub deflection: f64,
    /// Tip along the horizontal and upwards (m).
    pub tip: [f64; 2],
    /// Torque that the joint must supply (N m).
    pub torque: f64,
    /// Strain at each gauge.
    pub strains: Vec<f64>,
    /// The patch, where there is one.
    pub patch: Option<PatchRow>,
    /// What sensors on it measure; no columns of its own.
    pub sensed: SensedLink,
}

/// True values of the sensors of a link.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensedLink {
    /// Of the joint.
    pub joint: Motion<f64>,
    /// Specific force at the tip across the link, upwards where it is horizontal (m/s^2).
    pub specific_force: f64,
    /// Strain at the bridge, where there is one.
    pub strain: Option<f64>,
}

/// A patch at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchRow {
    /// Voltage (V).
    pub voltage: f64,
    /// Couple on the link (N m).
    pub couple: f64,
    /// Charge (C).
    pub charge: f64,
}

/// Names of the columns of a link's rows.
pub fn columns(file: &LinkFile) -> Vec<String> {
    let always = ["t_s", "tip_deflection_m", "tip_x_m", "tip_y_m", "tau_joint_nm"].map(String::from);
    let strains = file.link.gauges.iter().map(|place| format!("strain_at_{place}_m"));
    let patch = ["voltage_v", "couple_nm", "charge_c"].map(String::from);
    always.into_iter().chain(strains).chain(patch.into_iter().filter(|_| file.piezo.is_some())).collect()
}

impl LinkRow {
    /// The numbers in the order of the columns.
    pub fn numbers(&self) -> Vec<f64> {
        let Self { deflection, tip: [x, y], torque, .. } = *self;
        let patch = self.patch.map(|PatchRow { voltage, couple, charge }| [voltage, couple, charge]);
        let numbers = [self.time, deflection, x, y, torque].into_iter().chain(self.strains.iter().copied());
        numbers.chain(patch.into_iter().flatten()).collect()
    }
}

/// A run that is to be computed.
pub struct LinkRun<'a> {
    /// Natural frequencies of the link's modes with the joint held (rad/s).
    pub frequencies: Vec<f64>,
    /// The rows, computed one by one.
    pub rows: Box<dyn ExactSizeIterator<Item = LinkRow> + 'a>,
}

/// Runs the link of a file open loop, with a bridge of strain gauges at a place (m from the joint) where there is one.
///
/// # Errors
/// As [`strainwave::link::LinkParams::build`]; a file that was read has none. Of the bridge as
/// [`strainwave::link::LinkParams::gauge`].
pub fn run<'a>(
    file: &'a LinkFile,
    input: &'a LinkInputLog,
    bridge: Option<f64>,
) -> Result<LinkRun<'a>, Error> {
    match file.link.modes {
        1 => rows::<1>(file, input, bridge),
        2 => rows::<2>(file, input, bridge),
        3 => rows::<3>(file, input, bridge),
        4 => rows::<4>(file, input, bridge),
        5 => rows::<5>(file, input, bridge),
        6 => rows::<6>(file, input, bridge),
        7 => rows::<7>(file, input, bridge),
        8 => rows::<8>(file, input, bridge),
        _ => Err(Error::OutOfRange("modes")),
    }
}

fn rows<'a, const K: usize>(
    file: &LinkFile,
    input: &'a LinkInputLog,
    bridge: Option<f64>,
) -> Result<LinkRun<'a>, Error> {
    let params = file.params::<K>();
    let first = input.time.stamps()[0];
    let zero = input.angle[0];
    let stamps: Vec<f64> = input.time.stamps().iter().map(|stamp| stamp - first).collect();
    let angles: Vec<f64> = input.angle.iter().map(|angle| angle - zero).collect();
    let link = params.build(CONTROL_PERIOD)?;
    let patch = file.patch()?;
    let mut run = Run {
        gauges: file.link.gauges.iter().map(|place| params.gauge(*place)).collect::<Result<_, _>>()?,
        bridge: bridge.map(|place| params.gauge(place)).transpose()?,
        gravity: params.gravity,
        curve: Curve::through(&stamps, &angles, None, None),
        zero,
        state: LinkState::default(),
        patch: patch.map(|patch| (patch.rest(), patch)),
        link,
        input,
    };
    run.state = run.link.settled(&run.loads(0.0, 0.0));
    let frequencies = run.link.frequencies().to_vec();
    let instants = input.time.resampled(CONTROL_PERIOD);
    Ok(LinkRun { frequencies, rows: Box::new(instants.map(move |instant| run.row(first, instant.elapsed))) })
}

/// A run through its input.
struct Run<'a, const K: usize> {
    link: Link<f64, K>,
    state: LinkState<f64, K>,
    gauges: Vec<Gauge<f64, K>>,
    bridge: Option<Gauge<f64, K>>,
    gravity: f64,
    patch: Option<(PiezoState<f64, MEMORY>, Piezo<f64, LEVELS, MEMORY>)>,
    curve: Curve,
    /// Angle of the joint in the first row (rad).
    zero: f64,
    input: &'a LinkInputLog,
}

impl<const K: usize> Run<'_, K> {
    fn loads(&self, elapsed: f64, couple: f64) -> LinkInput<f64> {
        let point = self.curve.at(elapsed);
        let angle = Angle::from_radians_f64(self.zero + point.position);
        let joint = Motion { angle, velocity: point.velocity };
        let tip_force = self.at(elapsed, self.input.tip_force.as_deref());
        LinkInput { joint, acceleration: point.acceleration, tip_force, couple }
    }

    fn at(&self, elapsed: f64, column: Option<&[f64]>) -> f64 {
        column.map_or(0.0, |column| self.input.time.at(elapsed).of(column))
    }

    fn row(&mut self, first: f64, elapsed: f64) -> LinkRow {
        let asked = self.at(elapsed, self.input.voltage.as_deref());
        let driven = self.patch.as_mut().map(|(state, patch)| patch.step(state, asked));
        let loads = self.loads(elapsed, driven.map_or(0.0, |driven| driven.couple));
        // The first row is where the link hangs; the voltage comes on within the step to the second.
        let output = self.link.step(&mut self.state, &loads);
        let charged = driven.zip(self.patch.as_ref()).map(|(driven, (_, patch))| PatchRow {
            voltage: driven.voltage,
            couple: driven.couple,
            charge: patch.charge(driven.voltage, output.rotation),
        });
        LinkRow {
            time: first + elapsed,
            deflection: output.deflection,
            tip: output.tip,
            torque: output.torque,
            strains: self.gauges.iter().map(|gauge| self.link.strain(&self.state, gauge)).collect(),
            patch: charged,
            sensed: self.sensed(&loads, &output),
        }
    }

    /// Bending takes omega^2*w of the acceleration across the link, as the frame turns.
    fn sensed(&self, loads: &LinkInput<f64>, output: &LinkOutput<f64>) -> SensedLink {
        let joint = loads.joint;
        let acceleration = output.tip_acceleration - joint.velocity.powi(2) * output.deflection;
        SensedLink {
            joint,
            specific_force: acceleration + self.gravity * joint.angle.sin_cos().1,
            strain: self.bridge.map(|bridge| self.link.strain(&self.state, &bridge)),
        }
    }
}
