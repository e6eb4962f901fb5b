//! Report of `design` on a joint.

use std::f64::consts::TAU;

use strainwave::compensator::tuned::{GAIN_MARGIN, Tuned};

use crate::design::cascade_rule::CascadeGains;
use crate::design::corners::{Corner, Point};
use crate::design::judge::{Judged, Unstable, judge, unstable};
use crate::design::levels::Levels;
use crate::design::loops::{Break, Loop};
use crate::design::mode::Mode;
use crate::design::parts::Parts;
use crate::design::plant::Plant;
use crate::design::poles;
use crate::design::required;
use crate::design::tuned;
use crate::design::variant::Variant;
use crate::io::figure::{Figure, number};
use crate::io::gear_file::GearFile;
use crate::io::gear_file::SensorSet;
use crate::verify::bounds;

/// Fastest pole that is printed (rad/s).
const FASTEST: f64 = TAU * 500.0;
/// JSON has no infinity.
const MOST: f64 = 1e3;

/// The bounded figures of a set, over all its loops: gain, phase, delay, uncertainty.
fn names(set: SensorSet) -> [&'static str; 4] {
    match set {
        SensorSet::Motor => [
            "design.motor.torque.gain",
            "design.motor.torque.phase",
            "design.motor.torque.delay",
            "design.motor.disturbance.uncertainty",
        ],
        SensorSet::Both => [
            "design.both.torque.gain",
            "design.both.torque.phase",
            "design.both.torque.delay",
            "design.both.disturbance.uncertainty",
        ],
    }
}

/// Poles of a closed loop.
pub struct Poles {
    /// Sensors.
    pub set: SensorSet,
    /// Gains.
    pub mode: Mode,
    /// Frequencies (rad/s) and damping ratios.
    pub modes: Vec<(f64, f64)>,
}

/// Report on a joint.
pub struct Report {
    parts: Parts,
    by_rule: bool,
    /// The cascade alone, and as soft as the supervisor makes it.
    pub cascade: [Judged; 2],
    /// Each loop and set.
    pub judged: Vec<Judged>,
    /// Unstable variants and corners of the closed loop.
    pub unstable: Vec<Unstable>,
    /// Of the nominal joint's closed loop.
    pub poles: Vec<Poles>,
}

/// Variant and corner of a margin's worst case, as text.
pub fn place(at: &Option<(Variant, Corner)>) -> String {
    at.map_or_else(|| "-".into(), |(variant, corner)| format!("{:?} {}", variant.mode, corner.name()))
}

impl Report {
    /// Of a joint with these parts at these levels, the cascade's by its rule or the file's; `progress` is called with the fraction done.
    pub fn of(
        file: &GearFile,
        parts: &Parts,
        rule: Option<CascadeGains>,
        levels: Levels,
        mut progress: impl FnMut(f64),
    ) -> Self {
        let by_rule = rule.is_some();
        let parts = levels.apply(parts);
        let all: Vec<_> = SensorSet::ALL.into_iter().flat_map(Loop::all).collect();
        let alone = Loop { set: SensorSet::Motor, broken: Break::Torque, passes: false };
        let mut without = |parts: &Parts, first: f64| {
            judge(file, &Levels::NONE.apply(parts), &[alone], 1, |done| progress(first + 0.05 * done))[0]
        };
        let cascade = [without(&parts, 0.0), without(&parts.softened(), 0.05)];
        let judged = judge(file, &parts, &all, 1, |done| progress(0.1 + 0.3 * done));
        let unstable = unstable(file, &parts, &all, 1, |done| progress(0.4 + 0.6 * done));
        let nominal = |(set, mode)| {
            let variant = Variant { set, mode, point: Point::K1, passes: true };
            let plant = Plant::new(file, &Corner::nominal(mode));
            let closed = poles::eigenvalues(&variant.controller(file, &parts), &plant);
            Poles { set, mode, modes: poles::modes(&closed.unwrap_or_default(), FASTEST) }
        };
        let each = SensorSet::ALL.into_iter().flat_map(|set| Mode::ALL.map(|mode| (set, mode)));
        let poles = each.map(nominal).collect();
        Self { parts, by_rule, cascade, judged, unstable, poles }
    }

    fn of_set(&self, set: SensorSet, broken: Break) -> impl Iterator<Item = &Judged> {
        self.judged.iter().filter(move |j| j.of.set == set && j.of.broken == broken)
    }

    /// Figures with their bounds.
    pub fn figures(&self) -> Vec<Figure> {
        let mut figures = Vec::new();
        for set in SensorSet::ALL {
            let least = |of: fn(&Judged) -> f64| self.of_set(set, Break::Torque).map(of).fold(MOST, f64::min);
            let size = self.of_set(set, Break::Disturbance).map(|j| j.size.value).fold(0.0, f64::max);
            let values = [least(|j| j.gain.value), least(|j| j.phase.value), least(|j| j.delay.value), size];
            figures.extend(names(set).iter().zip(values).map(|(name, value)| bounds::figure(name, value)));
        }
        figures.push(Figure::bounded("design.unstable", self.unstable.len() as f64, "corner", 0.0));
        figures
    }

    /// Gains: name, value, unit, rule; omega_o is the outer frequency, the lesser of sqrt(K1/J_fs) and k_p over the gain margin
    /// and [`tuned::INTEGRAL`].
    pub fn gains(&self) -> Vec<[String; 4]> {
        let Parts { feedback: f, disturbance: d, output_feedback, measured_feedback: m, .. } = &self.parts;
        let row = |name: &str, value: f64, unit: &str, rule: &str| {
            [name.to_owned(), number(value), unit.to_owned(), rule.to_owned()]
        };
        let [k_p, k_v, t_i, omega_f] = self.cascade_rules();
        let outer = |constant: Tuned| format!("level * {} omega_o", constant.get());
        let integral = |constant: Tuned| format!("{}, 0 without output encoder", outer(constant));
        let damping = |ratio: Tuned| format!("level * 2*{}/sqrt(K1/J_fs)", ratio.get());
        let of_mode = |constant: Tuned| format!("{} sqrt(K1/J_fs)", constant.get());
        let stiffening = |fraction: Tuned| format!("level * {}, at least zeta/T(omega)", fraction.get());
        let wind_up = format!("level * {}", 1.0 - 1.0 / GAIN_MARGIN);
        let mut rows = vec![
            row("cascade k_p", f.position_gain, "1/s", k_p),
            row("cascade k_v", f.velocity_gain, "N m s/rad", k_v),
            row("cascade T_i", f.integral_time, "s", t_i),
            row("cascade omega_f", f.filter_corner, "rad/s", omega_f),
            row("disturbance omega_l", d.slow_corner, "rad/s", &outer(tuned::INTEGRAL)),
            row("disturbance omega_f", d.fast_corner, "rad/s", "level / lateness"),
            row("disturbance s", d.wind_up_fraction, "1", &wind_up),
            row("disturbance z_0", d.dead_zone, "N m", "static friction of both sides"),
            row("disturbance t", d.tolerance, "1", "N (torque constant + rotor)"),
        ];
        for (set, b) in SensorSet::ALL.into_iter().zip(output_feedback) {
            let name = |what: &str| format!("output feedback {what} ({})", set.name());
            rows.extend([
                row(&name("b"), b.damping, "s", &damping(tuned::ADDED_DAMPING)),
                row(&name("b at rest"), b.damping_at_rest, "s", &damping(tuned::ADDED_DAMPING)),
                row(&name("k"), b.integral, "1/s", &integral(tuned::INTEGRAL)),
                row(&name("omega_y"), b.filter_corner, "rad/s", "sqrt(K1/J_fs)"),
            ]);
        }
        let name = |what: &str| format!("measured feedback {what}");
        let (p, p_at_rest) = (stiffening(tuned::MEASURED), stiffening(tuned::PROPORTIONAL_AT_REST));
        rows.extend([
            row(&name("P"), m.proportional, "1", &p),
            row(&name("P at rest"), m.proportional_at_rest, "1", &p_at_rest),
            row(&name("D"), m.derivative, "s", &damping(tuned::MEASURED)),
            row(&name("D at rest"), m.derivative_at_rest, "s", &damping(tuned::MEASURED_DAMPING_AT_REST)),
            row(&name("omega_m"), m.corner, "rad/s", &of_mode(tuned::MEASURED_CORNER)),
        ]);
        rows
    }

    fn cascade_rules(&self) -> [&'static str; 4] {
        if self.by_rule {
            ["omega_c/a", "omega_c J_wg", "a/omega_c", "2 pi * largest current loop"]
        } else {
            ["2 pi f_p", "2 pi f_v (J_wg + r^2 J_fs)", "file", "20 pi f_v"]
        }
    }

    /// Names of the figures that miss their bound.
    pub fn missed(&self) -> Vec<String> {
        let figures = self.figures();
        figures.into_iter().filter(|figure| !figure.holds).map(|figure| figure.name).collect()
    }

    /// Margins: loop, margin, value, bound, worst corner.
    pub fn margins(&self) -> Vec<[String; 5]> {
        let mut rows = Vec::new();
        let named = self.judged.iter().map(|judged| (judged.of.name(), judged));
        let cascade = ["cascade alone", "cascade softened"].map(str::to_owned).into_iter().zip(&self.cascade);
        for (name, judged) in cascade.chain(named) {
            let torque = [
                ("gain [dB]", &judged.gain, required::GAIN),
                ("phase [deg]", &judged.phase, required::PHASE),
                ("delay [period]", &judged.delay, required::DELAY),
            ];
            let disturbance = [("largest |L|", &judged.size, required::SIZE)];
            let said: &[_] = if judged.of.broken == Break::Torque { &torque } else { &disturbance };
            rows.extend(said.iter().map(|(what, worst, bound)| {
                [name.clone(), (*what).into(), number(worst.value), number(*bound), place(&worst.at)]
            }));
        }
        rows
    }
}
