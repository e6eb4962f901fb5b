//! What `design` says of a joint.

use std::f64::consts::TAU;

use strainwave::Error;

use super::corners::{Corner, Point};
use super::plant::Plant;
use super::{Break, Judged, LOOPS, Levels, Mode, Variant, Worst, judge, levels, open_loop, parts, poles};
use crate::bench::SensorSet;
use crate::bounds;
use crate::figure::{Figure, number};
use crate::gear_file::GearFile;
use crate::plot::{Page, Panel, Series};

/// Of the corners every so many have their poles looked at, beside the worst.
const LOOKED_AT: usize = 13;
/// Fastest pole that is printed (rad/s).
const FASTEST: f64 = TAU * 500.0;

/// The names of the bounded figures: of either set gain, phase, delay and uncertainty.
const NAMES: [[&str; 4]; 2] = [
    [
        "design.motor.torque.gain",
        "design.motor.torque.phase",
        "design.motor.torque.delay",
        "design.motor.disturbance.uncertainty",
    ],
    [
        "design.both.torque.gain",
        "design.both.torque.phase",
        "design.both.torque.delay",
        "design.both.disturbance.uncertainty",
    ],
];

/// What was found of a joint.
pub struct Report {
    file: GearFile,
    /// At which it was judged.
    pub levels: Levels,
    /// What its margins allow.
    pub allowed: Levels,
    /// Each loop and set.
    pub judged: Vec<Judged>,
    /// Corners whose poles were looked at, and which of them are not stable.
    pub looked_at: usize,
    /// Those that are not.
    pub unstable: Vec<String>,
    /// How many of them with the disturbance path off and on.
    pub unstable_by_path: [usize; 2],
    poles: Vec<(SensorSet, Mode, Vec<(f64, f64)>)>,
}

fn place(worst: &Worst) -> String {
    worst.at.map_or_else(
        || "-".into(),
        |(variant, corner)| {
            let path = if variant.passes { "path on" } else { "path off" };
            format!("{:?}, {path}: {}", variant.mode, corner.name())
        },
    )
}

impl Report {
    /// Of a joint.
    ///
    /// # Errors
    /// As [`parts`].
    pub fn of(file: &GearFile, each: usize) -> Result<Self, Error> {
        Self::at(file, each, levels(file))
    }

    /// The same at other levels.
    ///
    /// # Errors
    /// As [`parts`].
    pub fn at(file: &GearFile, each: usize, used: Levels) -> Result<Self, Error> {
        let parts = parts(file, &used)?;
        let judged = judge(file, &parts, &SensorSet::ALL, each);
        let allowed = levels::sought(file)?;
        let mut report = Self {
            file: file.clone(),
            levels: used,
            allowed,
            judged,
            looked_at: 0,
            unstable: vec![],
            unstable_by_path: [0; 2],
            poles: vec![],
        };
        let mut look = |variant: Variant, corner: &Corner| {
            let eigenvalues =
                poles::eigenvalues(&variant.controller(file, &parts), &Plant::new(file, corner));
            report.looked_at += 1;
            if eigenvalues.as_deref().is_none_or(|all| !poles::is_stable(all)) {
                report.unstable_by_path[usize::from(variant.passes)] += 1;
                report.unstable.push(format!(
                    "{} {}",
                    variant.set.name(),
                    place(&Worst { value: 0.0, at: Some((variant, *corner)) })
                ));
            }
            eigenvalues.unwrap_or_default()
        };
        for set in SensorSet::ALL {
            for mode in Mode::ALL {
                let nominal = Variant { set, mode, point: Point::K1, passes: true };
                let found = look(nominal, &Corner::nominal(mode));
                report.poles.push((set, mode, poles::modes(&found, FASTEST)));
                for corner in Corner::all(mode).iter().step_by(LOOKED_AT) {
                    for passes in [false, true] {
                        look(Variant { set, mode, point: corner.point, passes }, corner);
                    }
                }
            }
        }
        let worst: Vec<_> = report
            .judged
            .iter()
            .flat_map(|j| {
                [&j.gain, &j.gain_down, &j.phase, &j.delay, &j.modulus, &j.size].map(|worst| worst.at)
            })
            .flatten()
            .collect();
        for (variant, corner) in worst {
            look(variant, &corner);
        }
        Ok(report)
    }

    fn of_loop(&self, set: SensorSet, (broken, passes): (Break, bool)) -> Option<&Judged> {
        self.judged.iter().find(|j| (j.set, j.broken, j.passes) == (set, broken, passes))
    }

    /// Figures beside their bounds.
    pub fn figures(&self) -> Vec<Figure> {
        let mut figures = Vec::new();
        for (set, names) in SensorSet::ALL.into_iter().zip(NAMES) {
            let [Some(held), Some(torque), Some(disturbance)] = LOOPS.map(|each| self.of_loop(set, each))
            else {
                continue;
            };
            let least = |of: fn(&Judged) -> f64| of(held).min(of(torque));
            let values = [
                least(|j| j.gain.value),
                least(|j| j.phase.value),
                least(|j| j.delay.value),
                disturbance.size.value,
            ];
            // JSON has no infinity.
            let all = names.iter().zip(values).map(|(name, value)| bounds::figure(name, value.min(1e3)));
            figures.extend(all);
            for (judged, what) in
                [(held, "torque.path_off"), (torque, "torque.path_on"), (disturbance, "disturbance")]
            {
                let name = |margin: &str| format!("design.{}.{what}.{margin}", set.name());
                figures.extend([
                    Figure::reported(name("gain_down"), judged.gain_down.value.min(1e3), "dB"),
                    Figure::reported(name("modulus"), judged.modulus.value, "1"),
                ]);
            }
        }
        figures.push(Figure::bounded("design.unstable", self.unstable.len() as f64, "corner", 0.0));
        figures
    }

    /// Gains: name, value, unit, rule.
    pub fn gains(&self) -> Vec<[String; 4]> {
        let Ok(parts) = parts(&self.file, &self.levels) else { return vec![] };
        let (f, d) = (&parts.feedback, &parts.disturbance);
        let row = |name: &str, value: f64, unit: &str, rule: &str| {
            [name.to_owned(), number(value), unit.to_owned(), rule.to_owned()]
        };
        let mut rows = vec![
            row("cascade k_p", f.position_gain, "1/s", "2 pi f_p"),
            row("cascade k_v", f.velocity_gain, "N m s/rad", "2 pi f_v (J_wg + r^2 J_fs)"),
            row("cascade T_i", f.integral_time, "s", "file"),
            row("cascade omega_f", f.filter_corner, "rad/s", "20 pi f_v"),
            row("disturbance omega_l", d.slow_corner, "rad/s", "0.2 sqrt(K1/J_fs)"),
            row("disturbance omega_f", d.fast_corner, "rad/s", "level * 1/1 ms"),
            row("disturbance s", d.wound_up, "1", "level * 0.5"),
            row("disturbance z_0", d.dead_zone, "N m", "static friction of both sides"),
            row("disturbance t", d.tolerance, "1", "0.2 N"),
        ];
        for (set, b) in SensorSet::ALL.into_iter().zip(&parts.output_feedback) {
            let name = |what: &str| format!("output feedback {what} ({})", set.name());
            rows.push(row(&name("b"), b.damping, "s", "level * 2*0.125/sqrt(K1/J_fs)"));
            rows.push(row(
                &name("k"),
                b.integral,
                "1/s",
                "level * sqrt(K1/J_fs)/16, 0 without output encoder",
            ));
            rows.push(row(&name("omega_y"), b.filter_corner, "rad/s", "sqrt(K1/J_fs)/3"));
        }
        rows
    }

    /// Margins: loop, margin, value, worst corner.
    pub fn margins(&self) -> Vec<[String; 4]> {
        let mut rows = Vec::new();
        for j in &self.judged {
            let path = if j.passes { "on" } else { "off" };
            let name = format!("{}.{} (path {path})", j.set.name(), j.broken.name());
            let all = [
                ("gain [dB]", &j.gain),
                ("gain down [dB]", &j.gain_down),
                ("phase [deg]", &j.phase),
                ("delay [period]", &j.delay),
                ("modulus", &j.modulus),
                ("max |L|", &j.size),
            ];
            // Of a torque loop with integrators |L| says nothing.
            let said =
                all.into_iter().filter(|(what, _)| j.broken == Break::Disturbance || *what != "max |L|");
            rows.extend(
                said.map(|(what, worst)| [name.clone(), what.to_owned(), number(worst.value), place(worst)]),
            );
        }
        rows
    }

    /// Poles of the nominal joint, a line each set and mode.
    pub fn poles(&self) -> Vec<String> {
        let each = |(w, damping): &(f64, f64)| format!("{:.1} Hz/{damping:.2}", w / TAU);
        self.poles
            .iter()
            .map(|(set, mode, modes)| {
                format!("{} {mode:?}: {}", set.name(), modes.iter().map(each).collect::<Vec<_>>().join(", "))
            })
            .collect()
    }

    /// What its margins do not allow, by name.
    pub fn switched(&self) -> Vec<String> {
        let named = self.allowed.named().into_iter().filter(|(_, level)| *level < 1.0);
        named
            .map(|(name, level)| match level {
                0.0 => format!("switched off: {name}"),
                level => format!("scaled to {level:.4}: {name}"),
            })
            .collect()
    }

    /// |L| of the torque loop of the nominal joint.
    pub fn page(&self) -> Page {
        let omegas = super::frequencies();
        let hertz: Vec<f64> = omegas.iter().map(|w| (w / TAU).log10()).collect();
        let mut page = Page::new(format!("{}: loop at the motor's torque", self.file.gear.name));
        let Ok(parts) = parts(&self.file, &self.levels) else { return page };
        for what in ["magnitude", "phase"] {
            let unit = if what == "phase" { "deg" } else { "dB" };
            let mut panel = Panel::new("log10 of the frequency in Hz", "1", what, unit);
            for set in SensorSet::ALL {
                for mode in Mode::ALL {
                    let variant = Variant { set, mode, point: Point::K1, passes: true };
                    let l = open_loop(&self.file, &parts, variant, &Corner::nominal(mode), &omegas);
                    let y: Vec<f64> = match what {
                        "phase" => l.iter().map(|l| l.arg().to_degrees()).collect(),
                        _ => l.iter().map(|l| 20.0 * l.norm().log10()).collect(),
                    };
                    panel = panel.with(Series::line(format!("{} {mode:?}", set.name()), &hertz, &y));
                }
            }
            page = page.with(panel);
        }
        page
    }
}
