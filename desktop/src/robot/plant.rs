//! Robot: the gears of all joints, coupled by the links behind them.
//!
//! ```text
//! (M(q) + diag(J_c))*ddq = tau_t - tau_fric_out - h(q, dq) + tau_brake + tau_load       q_i = q0_i + theta_fs_i
//! tau_brake = (1 - min(t/T_r, 1))*g(q)
//! J_wg*domega_wg = tau_motor - (tau_wg - J_wg*domega_wg)                                of each joint
//! ```
//!
//! The flexspline's output is the joint's coordinate: tau_t - tau_fric_out of each gear ([`crate::plant`]) acts on the links
//! ([`super::chain`]), and their motion is that of its flange. J_c is the inertia of the flexspline's cup. A brake lets go of gravity
//! g(q) over the first T_r = 0.1 s, as the load of [`crate::plant::load_side`]. Signs as there: torques on the output. Units: rad, N m, kg m^2, s.
//!
//! What a gear feels of the arm is booked as a load of its own: J_fs, the inertia that the joint feels at the start with all others
//! free, and tau_load = J_fs*ddq - tau_t + tau_fric_out. Static friction at rest reads that of the micro-step before.
//!
//! Neglected: the gyroscopic coupling of the rotors. A rotor turns on the link before with its speed relative to that link; what that link's
//! own motion adds to its kinetic energy is abs r, a hundredth, of what is counted. Its mass is part of that link's.
//!
//! A belt in front of a gear ([`crate::plant::driving_belt`]) has the motor and its encoder in front of it: tau_motor is then the belt's torque
//! on the wave generator, J_wg with the driven pulley.
//!
//! Links that bend add their modes to the first line ([`super::flexible`]); they start as they hang.
//!
//! Discretisation: as [`crate::plant`], semi-implicit Euler with the micro-step, speeds first; M, h and g at the angles and speeds of the
//! micro-step's start, all joints at once.

use strainwave::Error;
use strainwave::flexspline::{Flexspline, Mesh};
use strainwave::gear::GearParams;

use strainwave::compensator::schedule::CONTROL_PERIOD;

use super::chain::{Chain, ChainState};
use super::flexible::{FlexibleChain, FlexibleState};
use super::sample::RobotSample;
use crate::plant::divergence::Diverged;
use crate::plant::driving_belt::Spans;
use crate::plant::load_side::RELEASE;
use crate::plant::{
    CONDENSED_STEPS, CondensedMesh, MicroStep, NODES, Plant, PlantMesh, STEP_SHARE, Sides, plant_params,
};

/// Gears and links.
#[derive(Clone)]
pub struct RobotPlant<F: Flexspline<f64> = PlantMesh> {
    chain: Chain,
    links: ChainState,
    /// The links with their modes, where some bend.
    bent: Option<(FlexibleChain, FlexibleState)>,
    /// q0 (rad).
    starts: Vec<f64>,
    joints: Vec<Plant<F>>,
    /// tau_load of the last micro-step (N m).
    loads: Vec<f64>,
    /// Micro-steps since the start.
    taken: u64,
    /// Energy of the links at the start, what came to them since, and the sum of its magnitudes (J).
    energy_at_rest: f64,
    came: f64,
    moved: f64,
}

impl RobotPlant {
    /// At rest in its start, on the reference mesh.
    ///
    /// # Errors
    /// As [`Plant::between`], [`Plant::driven_by`], [`Chain::build`] and [`FlexibleChain::build`]; `modes` of which the micro-step cannot carry the fastest.
    pub fn reference(sample: &RobotSample) -> Result<Self, Error> {
        let stable = sample
            .gears
            .iter()
            .map(|gear| Mesh::<f64, { NODES.0 }, { NODES.1 }>::stable_step(&gear.flexspline));
        let longest = STEP_SHARE * stable.fold(f64::INFINITY, f64::min);
        Self::around(sample, |params| Plant::within(&plant_params(params), &Sides::IDEAL, Some(longest)))
    }
}

impl RobotPlant<CondensedMesh> {
    /// At rest in its start, the meshes condensed.
    ///
    /// # Errors
    /// As [`RobotPlant::reference`].
    pub fn condensed(sample: &RobotSample) -> Result<Self, Error> {
        Self::around(sample, Plant::condensed)
    }
}

impl<F: Flexspline<f64>> RobotPlant<F> {
    fn around(
        sample: &RobotSample,
        build: impl Fn(&GearParams<f64>) -> Result<Plant<F>, Error>,
    ) -> Result<Self, Error> {
        let chain = Chain::build(&sample.links, sample.gravity)?;
        let mut links = chain.rest();
        sample.starts.iter().enumerate().for_each(|(joint, start)| links.set(joint, [*start, 0.0]));
        let joint = |(joint, gear): (usize, &GearParams<f64>)| {
            let mut params = *gear;
            params.flexspline_inertia = chain.free_inertia(&links, joint);
            let plant = build(&params)?;
            match &sample.belts[joint] {
                Some(belt) => plant.driven_by(belt, Spans::Chain),
                None => Ok(plant),
            }
        };
        let joints = sample.gears.iter().enumerate().map(joint).collect::<Result<Vec<_>, _>>()?;
        let bent = bent(sample)?;
        let dt = joints[0].micro_step_time();
        if bent.as_ref().is_some_and(|(chain, state)| dt >= chain.longest_step(state)) {
            return Err(Error::OutOfRange("modes"));
        }
        Ok(Self {
            loads: vec![0.0; joints.len()],
            starts: sample.starts.clone(),
            energy_at_rest: energy(&chain, &links, bent.as_ref()),
            bent,
            chain,
            links,
            joints,
            taken: 0,
            came: 0.0,
            moved: 0.0,
        })
    }

    /// Gives the drive of each joint its torque command (N m).
    pub fn command(&mut self, torques: impl IntoIterator<Item = f64>) {
        self.joints.iter_mut().zip(torques).for_each(|(joint, torque)| joint.command(torque, 0.0));
    }

    /// One control period under these external torques on the joints (N m).
    ///
    /// # Errors
    /// When a mesh has diverged.
    pub fn go_on(&mut self, loads: &[f64]) -> Result<(), Diverged> {
        for _ in 0..self.joints[0].micro_steps() {
            if !self.micro_step(loads) {
                break;
            }
        }
        self.joints.iter().try_for_each(Plant::check)
    }

    /// Whether the micro-steps of the period may go on.
    fn micro_step(&mut self, external: &[f64]) -> bool {
        let steps: Vec<_> =
            self.joints.iter_mut().zip(&self.loads).map(|(joint, load)| joint.begin(*load)).collect();
        let torques = self.on_links(&steps, external);
        let dt = self.joints[0].micro_step_time();
        let accelerations = match &mut self.bent {
            None => self.chain.accelerations(&mut self.links, &torques),
            Some((chain, state)) => chain.step(state, &torques, dt),
        };
        for (index, (joint, step)) in self.joints.iter_mut().zip(&steps).enumerate() {
            let before = joint.output().velocity;
            self.loads[index] = joint.load_of(step, accelerations[index]);
            joint.end(step, self.loads[index], accelerations[index]);
            let output = joint.output();
            let motion = [self.starts[index] + output.angle.to_radians(), output.velocity];
            self.links.set(index, motion);
            if let Some((_, state)) = &mut self.bent {
                state.set(index, motion);
            }
            let work = torques[index] * 0.5 * (before + output.velocity) * dt;
            self.came += work;
            self.moved += work.abs();
        }
        self.taken += 1;
        steps.iter().all(MicroStep::may_go_on)
    }

    /// Torques on the links (N m): of the gears, from outside, and of the brake while it lets go.
    fn on_links(&self, steps: &[MicroStep], external: &[f64]) -> Vec<f64> {
        let gears = steps.iter().zip(external).map(|(step, external)| step.on_flange() + external);
        let held = 1.0 - self.taken as f64 * self.joints[0].micro_step_time() / RELEASE;
        if held <= 0.0 {
            return gears.collect();
        }
        let weight = match &self.bent {
            None => self.chain.holding_torques(&self.links),
            Some((chain, state)) => chain.holding_torques(state),
        };
        gears.zip(weight).map(|(torque, weight)| torque + held * weight).collect()
    }

    /// The joints, from the base on.
    pub fn joints(&self) -> &[Plant<F>] {
        &self.joints
    }

    /// Angles of the joints at the start (rad).
    pub fn starts(&self) -> &[f64] {
        &self.starts
    }

    /// The links, those that bend as they are when they do not.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// tau_load of each joint (N m).
    pub fn loads(&self) -> &[f64] {
        &self.loads
    }

    /// Place of the tip in the frame of the base (m).
    pub fn tip(&self) -> [f64; 3] {
        match &self.bent {
            None => self.chain.tip(&self.links),
            Some((chain, state)) => chain.tip(state),
        }
    }

    /// Power balance of the links since the start: what is missing, as a fraction of the energy moved.
    pub fn imbalance(&self) -> f64 {
        let stored = energy(&self.chain, &self.links, self.bent.as_ref()) - self.energy_at_rest;
        let lost = self.bent.as_ref().map_or(0.0, |(_, state)| state.lost);
        ((self.came - stored - lost) / self.moved.max(f64::MIN_POSITIVE)).abs()
    }
}

/// The links with their modes, where some bend, as they hang in the start.
fn bent(sample: &RobotSample) -> Result<Option<(FlexibleChain, FlexibleState)>, Error> {
    if sample.beams.iter().all(Option::is_none) {
        return Ok(None);
    }
    let chain = FlexibleChain::build(&sample.links, &sample.beams, sample.gravity)?;
    let state = chain.settled(&sample.starts);
    Ok(Some((chain, state)))
}

/// Energy of the links (J).
fn energy(chain: &Chain, links: &ChainState, bent: Option<&(FlexibleChain, FlexibleState)>) -> f64 {
    bent.map_or_else(|| chain.energy(links), |(chain, state)| chain.energy(state))
}

/// Refuses beams with modes too fast for the micro-step of the condensed gears.
///
/// # Errors
/// One line that names the step, its bound and the keys.
pub fn require_modes(sample: &RobotSample) -> Result<(), String> {
    let step = CONTROL_PERIOD / CONDENSED_STEPS as f64;
    let Some((chain, state)) = bent(sample).map_err(|why| why.to_string())? else { return Ok(()) };
    let bound = chain.longest_step(&state);
    if step < bound {
        return Ok(());
    }
    let fastest = chain.frequencies(&state).last().copied().unwrap_or_default();
    Err(format!(
        "link.modes of the beams: the fastest mode of the arm has {fastest:.0} rad/s, and the step is {step:.2e} s; allowed: a step below \
         a quarter of its period, {bound:.2e} s, so fewer modes or softer beams"
    ))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use strainwave::link::{LinkParams, MOST_MODES};

    use super::*;
    use crate::design::belt::driving_belt;
    use crate::io::gear_file::GearFile;
    use crate::plant::load_side::LoadParams;
    use crate::robot::RobotFile;
    use crate::robot::beam::Beam;
    use crate::robot::chain::Link;

    fn sample() -> RobotSample {
        RobotSample::boxed(&RobotFile::example(), 0).unwrap()
    }

    /// Torques that hold the arm in its start on the whole, and a push that moves it.
    fn pushed<F: Flexspline<f64>>(mut plant: RobotPlant<F>, periods: usize) -> RobotPlant<F> {
        let weight = plant.chain.holding_torques(&plant.links);
        for k in 0..periods {
            let push = [30.0, -10.0].map(|push: f64| push * (0.02 * k as f64).sin());
            plant.command(weight.iter().zip(push).map(|(weight, push)| -(weight + push) / 100.0));
            plant.go_on(&[0.0; 2]).unwrap();
        }
        plant
    }

    /// The arm with a belt of this stiffness (N) and ratio 1 before the elbow's gear; half of the rotor's inertia is the driven pulley's.
    fn belted(stiffness: f64) -> RobotSample {
        let mut belt = driving_belt(&GearFile::wrist()).unwrap();
        let mut sample = sample();
        belt.span.stiffness = stiffness;
        belt.output.inertia = 0.5 * sample.gears[1].wave_generator_inertia;
        belt.motor = belt.output;
        sample.gears[1].wave_generator_inertia =
            [&belt.motor, &belt.output].map(|pulley| belt.inertia(pulley, 0)).iter().sum();
        sample.belts[1] = Some(belt);
        sample
    }

    /// What goes into the links is what they have, and so in each gear, behind a belt too.
    #[test]
    fn the_power_balance_closes() {
        for sample in [sample(), belted(6e4)] {
            let plant = pushed(RobotPlant::condensed(&sample).unwrap(), 5000);
            assert!(plant.joints()[0].output().angle.to_radians().abs() > 1e-3, "it has not moved");
            assert!(plant.imbalance() < 1e-3, "{}", plant.imbalance());
            for joint in plant.joints() {
                assert!(joint.imbalance() < 3e-3, "{}", joint.imbalance());
            }
        }
    }

    /// A stiff belt of ratio 1 moves the arm as a motor on the shaft does, a soft one does not.
    #[test]
    fn a_belt_becomes_a_shaft() {
        let without = |sample: RobotSample| RobotSample { belts: vec![None; 2], ..sample };
        let on_shaft = pushed(RobotPlant::condensed(&without(belted(1.0))).unwrap(), 1000).tip();
        let off = |stiffness: f64| {
            let tip = pushed(RobotPlant::condensed(&belted(stiffness)).unwrap(), 1000).tip();
            (0..2).map(|k| (tip[k] - on_shaft[k]).powi(2)).sum::<f64>().sqrt()
        };
        let (soft, stiff) = (off(5e2), off(6e4));
        assert!(soft > 1e-5 && stiff < 0.1 * soft, "{soft} m, {stiff} m");
    }

    /// Gravity winds the gears up by what it takes to hold the links.
    #[test]
    fn gears_bear_the_links_weight() {
        let mut plant = RobotPlant::condensed(&sample()).unwrap();
        for _ in 0..10_000 {
            let motors: Vec<_> = plant.joints.iter().map(Plant::motor).collect();
            plant.command(motors.iter().map(|motor| -2.0 * motor.angle.to_radians() - 0.01 * motor.velocity));
            plant.go_on(&[0.0; 2]).unwrap();
        }
        let weight = plant.chain.holding_torques(&plant.links);
        for (joint, weight) in plant.joints().iter().zip(weight) {
            let torques = joint.last_torques();
            assert!((torques.transmitted - torques.output_friction - weight).abs() < 0.02 * weight.abs());
        }
    }

    /// A push at the shoulder winds the elbow's gear up.
    #[test]
    fn joints_are_coupled() {
        let mut plant = RobotPlant::condensed(&RobotSample { gravity: [0.0; 3], ..sample() }).unwrap();
        plant.command([0.5, 0.0]);
        (0..200).for_each(|_| plant.go_on(&[0.0; 2]).unwrap());
        let [shoulder, elbow] = [0, 1].map(|joint| plant.joints()[joint].output().angle.to_radians());
        assert!(shoulder < -1e-5 && elbow > 1e-6, "{shoulder} {elbow}");
        assert!(plant.loads()[1].abs() > 0.1, "{:?}", plant.loads());
    }

    /// A robot of one joint is a joint with a payload.
    #[test]
    fn one_joint_moves_as_a_joint_with_a_payload() {
        let mut file = RobotFile::example();
        file.joints.truncate(1);
        let sample = RobotSample::boxed(&file, 5).unwrap();
        let mut robot = RobotPlant::condensed(&sample).unwrap();
        let link = &sample.links[0];
        let mut params = sample.gears[0];
        params.flexspline_inertia = link.inertia[2] + link.mass * link.centre[0].powi(2) + link.flange;
        let load = LoadParams {
            link: None,
            gravity: -link.mass * link.centre[0] * sample.gravity[1],
            hanging: -FRAC_PI_2 - sample.starts[0],
        };
        let mut single =
            Plant::condensed_between(&plant_params(&params), &Sides { load, ..Sides::IDEAL }).unwrap();
        for k in 0..5000 {
            let torque = 0.3 * (2e-3 * f64::from(k)).sin();
            robot.command([torque]);
            robot.go_on(&[3.0]).unwrap();
            single.step(torque, 3.0).unwrap();
        }
        let [alone, as_robot] = [&single, &robot.joints()[0]].map(|plant| plant.output().angle.to_radians());
        assert!(alone.abs() > 0.1 && (alone - as_robot).abs() < 1e-9, "{alone} {as_robot}");
    }

    /// The arm with beams of this stiffness (N m^2) and number of modes.
    fn bending(stiffness: f64, modes: usize) -> RobotSample {
        let mut sample = sample();
        let params = LinkParams {
            length: 0.4,
            bending_stiffness: stiffness,
            linear_density: 5.0,
            thickness: 0.05,
            payload_mass: 1.5,
            payload_inertia: 4e-3,
            damping: [0.01; MOST_MODES],
            gravity: 0.0,
            patch: None,
        };
        let beam = Beam { params, modes, twist: 0.0 };
        for (link, place) in sample.links.iter_mut().zip(&mut sample.beams) {
            *link = Link { flange: link.flange, ..beam.straight() };
            *place = Some(beam);
        }
        sample
    }

    /// Stiff beams move as the rigid links that they are, soft ones do not; the power balance closes for either.
    #[test]
    fn beams_become_rigid_links() {
        let rigid = pushed(
            RobotPlant::condensed(&RobotSample { beams: vec![None; 2], ..bending(1.0, 2) }).unwrap(),
            1000,
        );
        let off = |stiffness: f64| {
            let plant = pushed(RobotPlant::condensed(&bending(stiffness, 2)).unwrap(), 1000);
            assert!(plant.imbalance() < 3e-3, "{stiffness}: {}", plant.imbalance());
            let (found, asked) = (plant.tip(), rigid.tip());
            (0..2).map(|k| (found[k] - asked[k]).powi(2)).sum::<f64>().sqrt()
        };
        let (soft, stiff) = (off(3e3), off(6e4));
        assert!(soft > 1e-4 && stiff < 0.1 * soft, "{soft} m, {stiff} m");
    }

    #[test]
    fn modes_that_the_step_cannot_carry_are_refused() {
        assert_eq!(require_modes(&bending(3e3, 2)), Ok(()));
        let fast = bending(3e5, 8);
        let line = require_modes(&fast).unwrap_err();
        assert!(
            line.starts_with("link.modes of the beams: the fastest mode of the arm has ")
                && line.contains("the step is 2.50e-5 s"),
            "{line}"
        );
        assert_eq!(RobotPlant::condensed(&fast).err(), Some(Error::OutOfRange("modes")));
    }

    /// The condensed gears move the arm as the reference mesh does.
    #[test]
    fn the_reference_mesh_moves_it_alike() {
        let [condensed, reference] = [
            pushed(RobotPlant::condensed(&sample()).unwrap(), 300).tip(),
            pushed(RobotPlant::reference(&sample()).unwrap(), 300).tip(),
        ];
        let apart = (0..2).map(|k| (condensed[k] - reference[k]).powi(2)).sum::<f64>().sqrt();
        assert!(apart < 1e-5, "{apart} m");
    }
}
