//! Load side: all of the load rigidly on the output flange, or a part of it behind a spring, and gravity.
//!
//! ```text
//! tau_flange          = k*gap(delta) + d*ddelta/dt                 delta = theta_link - theta_fs
//! J_l*d2theta_link    = tau_load + tau_gravity - tau_flange
//! tau_gravity         = -G*sin(theta_link - theta_hanging)
//! k = J_l*(2*pi*f)^2,  d = 2*zeta*2*pi*f*J_l
//! ```
//!
//! gap() is a dead zone of the backlash's width: within it the flange feels nothing, and beyond it the two only push each
//! other. The backlash is that of the coupling between flange and link: the gear itself is preloaded and has none. f is the
//! frequency of the link with the flange held, G the largest torque of gravity. Without a link the flange has it all, and
//! theta_link is theta_fs. Sign: torques on the output, as tau_load. Units: rad, N m, Hz.
//!
//! A brake lets go of gravity over the first 0.1 s, as no joint's load falls onto it at once.
//!
//! Discretisation: semi-implicit Euler with the plant's micro-step, which a frequency below 200 Hz takes in 40 a radian.

use std::f64::consts::TAU;

use strainwave::gear::Motion;

/// Release time of the brake (s).
pub(crate) const RELEASE: f64 = 0.1;

/// A part of the load behind a spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkParams {
    /// J_l over J_fs.
    pub fraction: f64,
    /// f (Hz).
    pub frequency: f64,
    /// zeta.
    pub damping: f64,
    /// Full width of the dead zone (rad).
    pub backlash: f64,
}

/// The load side of a plant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadParams {
    /// Flexible part of the load.
    pub link: Option<LinkParams>,
    /// G (N m).
    pub gravity: f64,
    /// theta_hanging (rad), where the link would hang at rest.
    pub hanging: f64,
}

impl LoadParams {
    /// Inertia that is rigid with the flange (kg m^2), of all of it.
    pub fn rigid(&self, inertia: f64) -> f64 {
        self.link.map_or(inertia, |link| (1.0 - link.fraction) * inertia)
    }
}

/// The link, and what is between it and the flange.
#[derive(Clone, Debug)]
struct Link {
    motion: Motion<f64>,
    inertia: f64,
    /// k (N m/rad), d (N m s/rad), half the backlash (rad).
    stiffness: f64,
    damping: f64,
    half_gap: f64,
}

/// The load side, stepped by micro-steps.
#[derive(Clone, Debug)]
pub(super) struct Load {
    link: Option<Link>,
    gravity: f64,
    hanging: f64,
}

impl Load {
    /// Of a load of this inertia (kg m^2).
    pub(super) fn new(params: &LoadParams, inertia: f64) -> Self {
        let link = params.link.map(|link| {
            let (inertia, omega) = (link.fraction * inertia, TAU * link.frequency);
            Link {
                motion: Motion::default(),
                inertia,
                stiffness: inertia * omega * omega,
                damping: 2.0 * link.damping * omega * inertia,
                half_gap: 0.5 * link.backlash,
            }
        });
        Self { link, gravity: params.gravity, hanging: params.hanging }
    }

    /// Moves the link on by `dt` (s), and answers with the torque on the flange (N m).
    pub(super) fn step(&mut self, load: f64, flange: &Motion<f64>, time: f64, dt: f64) -> f64 {
        let at = self.link.as_ref().map_or(flange, |link| &link.motion);
        let acting = if self.gravity == 0.0 { load } else { load + self.gravity(at, time) };
        match &mut self.link {
            None => acting,
            Some(link) => {
                let torque = link.on_flange(flange);
                link.motion.advance((acting - torque) / link.inertia, dt);
                torque
            }
        }
    }

    fn gravity(&self, link: &Motion<f64>, time: f64) -> f64 {
        -self.gravity * (time / RELEASE).min(1.0) * link.angle.plus(-self.hanging).sin_cos().0
    }
}

impl Link {
    fn on_flange(&self, flange: &Motion<f64>) -> f64 {
        let wound = self.motion.angle.minus(flange.angle);
        let beyond = wound - wound.clamp(-self.half_gap, self.half_gap);
        let torque = self.stiffness * beyond + self.damping * (self.motion.velocity - flange.velocity);
        match (self.half_gap > 0.0, beyond) {
            (false, _) => torque,
            (true, beyond) if beyond > 0.0 => torque.max(0.0),
            (true, beyond) if beyond < 0.0 => torque.min(0.0),
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use strainwave::Angle;

    use super::*;

    const DT: f64 = 2.5e-5;
    const LINK: LinkParams = LinkParams { fraction: 0.4, frequency: 30.0, damping: 0.0, backlash: 0.0 };

    fn load(link: Option<LinkParams>) -> Load {
        Load::new(&LoadParams { link, ..LoadParams::default() }, 1.2)
    }

    #[test]
    fn a_rigid_load_passes_torque_on_as_it_is() {
        assert_eq!(load(None).step(12.3, &Motion::default(), 0.0, DT), 12.3);
        assert_eq!(LoadParams::default().rigid(1.2), 1.2);
    }

    /// With the flange held the link swings at f, and an undamped one keeps its energy.
    #[test]
    fn the_link_has_its_frequency_and_its_energy() {
        let mut load = load(Some(LINK));
        let flange = Motion::default();
        load.link.as_mut().unwrap().motion.velocity = 0.1;
        let (mut crossings, mut energies) = (Vec::new(), Vec::new());
        let mut before = 0.0;
        for k in 1..40_000 {
            load.step(0.0, &flange, 0.0, DT);
            let link = load.link.as_ref().unwrap();
            let angle = link.motion.angle.to_radians();
            if before < 0.0 && angle >= 0.0 {
                crossings.push(f64::from(k) * DT - DT * angle / (angle - before));
            }
            before = angle;
            energies.push(
                0.5 * link.inertia * link.motion.velocity.powi(2) + 0.5 * link.stiffness * angle * angle,
            );
        }
        let (first, last) = (crossings[0], crossings[crossings.len() - 1]);
        let frequency = (crossings.len() - 1) as f64 / (last - first);
        assert!((frequency / 30.0 - 1.0).abs() < 1e-4, "{frequency}");
        let energy = 0.5 * 0.48 * 0.01;
        assert!(energies.iter().all(|now| (now / energy - 1.0).abs() < 5e-3));
    }

    #[test]
    fn in_the_gap_there_is_no_torque_and_beyond_it_the_two_only_push() {
        let link = LinkParams { damping: 0.1, backlash: 2e-4, ..LINK };
        let torque = |wound: f64, rate: f64| {
            let mut load = load(Some(link));
            load.link.as_mut().unwrap().motion =
                Motion { angle: Angle::from_radians_f64(wound), velocity: rate };
            load.step(5.0, &Motion::default(), 0.0, DT)
        };
        assert_eq!([torque(0.99e-4, 1.0), torque(-0.99e-4, -1.0), torque(0.0, 3.0)], [0.0; 3]);
        assert!(torque(2e-4, 0.0) > 0.0 && torque(-2e-4, 0.0) < 0.0);
        assert_eq!([torque(1.01e-4, -9.0), torque(-1.01e-4, 9.0)], [0.0; 2]);
    }

    /// It pulls to where the link hangs, at G when that is a quarter of a revolution away, once the brake is open.
    #[test]
    fn gravity_pulls_down() {
        let params = LoadParams { gravity: 40.0, hanging: 0.3, ..LoadParams::default() };
        let pull = |angle: f64, time: f64| {
            let flange = Motion { angle: Angle::from_radians_f64(angle), velocity: 0.0 };
            Load::new(&params, 1.2).step(0.0, &flange, time, DT)
        };
        assert!(pull(0.5, 1.0) < 0.0 && pull(0.1, 1.0) > 0.0 && pull(0.3, 1.0).abs() < 1e-7);
        assert!((pull(0.3 - 0.25 * TAU, 1.0) - 40.0).abs() < 1e-9);
        assert!((pull(0.3 - 0.25 * TAU, 0.05) - 20.0).abs() < 1e-9);
    }
}
