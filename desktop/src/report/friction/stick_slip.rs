//! Stick-slip: a mass on a spring whose end is pulled steadily.

use maud::{Markup, html};

use super::models::{Model, Models, Numbers};
use super::{COLUMNS, panel};
use crate::io::figure::number;
use crate::report::plot::{Page, Panel};
use crate::report::{figure, plot};

/// Displacement of the spring's end (eps).
const WAY: f64 = 400.0;
/// Displacement at which the spring alone reaches Fs (eps).
const STRETCH: f64 = 100.0;
/// Speed of the pull over vs.
const PULL: f64 = 0.1;
/// sqrt(k*J) over Fs/vs: a slip by Fs/20 reaches vs.
const IMPEDANCE: f64 = 0.05;
/// Steps of the run, and every how many of them a point is drawn.
const STEPS: u32 = 1_000_000;
const DRAWN: u32 = 250;

/// The pulled mass.
struct Rig {
    /// k (N m/rad).
    spring: f64,
    /// J (kg m^2).
    inertia: f64,
    /// (rad/s)
    pull: f64,
    /// (s)
    duration: f64,
}

impl Rig {
    fn of(numbers: &Numbers) -> Self {
        let &Numbers { static_level, stribeck_velocity, presliding, .. } = numbers;
        let spring = static_level / (STRETCH * presliding);
        let impedance = IMPEDANCE * static_level / stribeck_velocity;
        let pull = PULL * stribeck_velocity;
        Self { spring, inertia: impedance * impedance / spring, pull, duration: WAY * presliding / pull }
    }

    /// Times (s) and torques of the spring (N m).
    ///
    /// Semi-implicit, velocity first. A mass whose velocity would pass through zero within a step stands at its end:
    /// static friction needs a standstill to hold.
    fn run(&self, model: &Model) -> (Vec<f64>, Vec<f64>) {
        let dt = self.duration / f64::from(STEPS);
        let mut contact = model.rest();
        let (mut position, mut velocity) = (0.0, 0.0);
        let (mut times, mut torques) = (Vec::new(), Vec::new());
        for k in 0..=STEPS {
            let time = f64::from(k) * dt;
            let spring = self.spring * (self.pull * time - position);
            if k % DRAWN == 0 {
                times.push(time);
                torques.push(spring);
            }
            let friction = contact.step(velocity, dt, spring);
            let next = velocity + dt * (spring - friction) / self.inertia;
            velocity = if velocity * next < 0.0 { 0.0 } else { next };
            position += dt * velocity;
        }
        (times, torques)
    }
}

pub(super) fn section(numbers: &Numbers, models: &Models) -> Markup {
    let rig = Rig::of(numbers);
    let axes = || Panel::new("time", "s", "torque of the spring", "mN m");
    let levels = [numbers.coulomb, numbers.static_level];
    let page = models.drawn.iter().fold(Page::small_multiples("", COLUMNS), |page, model| {
        let (times, torques) = rig.run(model);
        let levels = levels.map(|level| vec![(0.0, level), (rig.duration, level)]);
        page.with(panel(axes(), model.name, [&times, &torques], &levels))
    });
    html! {
        h3 { "Stick-slip" }
        p {
            "An inertia of " (number(rig.inertia)) " kg m² on a spring of " (number(rig.spring)) " N m/rad whose end is "
            "pulled at " (number(rig.pull)) " rad/s. Where friction falls with speed or with the way, the inertia sticks "
            "until the spring has overcome it, and then slips; else it slides on behind the spring."
        }
        (figure(&plot(&page), &html! { "Torque of the spring over time. Dashed: Fc (orange) and Fs (green)." }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::gear_file::GearFile;
    use strainwave::friction::ModelName;

    /// By how much the spring's torque swings in the last third, in Fs - Fc.
    fn swing(name: &str) -> f64 {
        let numbers = Numbers::of(&GearFile::default_gear().friction.input);
        let models = Models::build(&numbers);
        let model = models.drawn.iter().find(|model| model.name == name).unwrap();
        let (_, torques) = Rig::of(&numbers).run(model);
        let last = &torques[2 * torques.len() / 3..];
        let (least, most) =
            last.iter().fold((f64::MAX, f64::MIN), |(a, b), torque| (a.min(*torque), b.max(*torque)));
        (most - least) / (numbers.static_level - numbers.coulomb)
    }

    /// A slip takes the spring about as far below the sliding friction as it was above.
    #[test]
    fn what_falls_with_speed_or_way_sticks_and_slips_and_a_level_does_not() {
        for name in ModelName::ALL {
            let swing = swing(name.word());
            let holds = if name.sticks_and_slips() { (1.2..2.5).contains(&swing) } else { swing < 0.1 };
            assert!(holds, "{}: {swing}", name.word());
        }
    }
}
