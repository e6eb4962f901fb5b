//! Torque over torsion of both builds, against the catalogue's line.

use maud::{Markup, html};
use strainwave::Error;
use strainwave::compensator::RealTimeFlexspline;

use super::{M, N};
use crate::design::joint::gear_params;
use crate::io::gear_file::GearFile;
use crate::plant::settled::Settled;
use crate::report::plot::{Page, Panel, Series};
use crate::report::{figure, plot};

/// Points of the curves either side of zero.
const POINTS: i32 = 40;
/// Every how many of them one is marked.
const MARKED: usize = 4;
/// Largest torque, in rated torques.
const SPAN: f64 = 1.1;
/// Steps in which the mesh settles from one point to the next.
const SETTLING: usize = 8_000;
/// Angle of the wave generator, between two nodes (rad).
const WAVE_GENERATOR: f64 = 0.3;

pub(super) fn section(gear: &GearFile, mut progress: impl FnMut(f64)) -> Result<Markup, Error> {
    let (double, single) = (gear_params::<f64>(gear), gear_params::<f32>(gear));
    let line = double.flexspline.line.build()?;
    let real_time = RealTimeFlexspline::<f32>::build(&single.flexspline, single.rated_torque)?;
    let mut mesh = Settled::<N, M>::build(&double.flexspline, SETTLING)?;
    let mut rows = Vec::new();
    for k in -POINTS..=POINTS {
        progress(f64::from(k + POINTS) / f64::from(2 * POINTS));
        let torsion = line.torsion(SPAN * double.rated_torque * f64::from(k) / f64::from(POINTS));
        let condensed = f64::from(real_time.torque(torsion as f32, 0.0));
        rows.push([torsion, line.torque(torsion), mesh.torque(torsion, WAVE_GENERATOR), condensed]);
    }
    let knees = double.flexspline.line.knee_torque.map(|torque| [-torque, torque]);
    let knees: Vec<_> = knees.as_flattened().iter().map(|torque| [line.torsion(*torque), *torque]).collect();
    let page = Page::new("").with(torques(&rows, &knees)).with(differences(&rows));
    Ok(html! {
        h3 { "Torque over torsion" }
        p {
            "The reference mesh (" (N) "x" (M) ", f64, settled under each torsion) and the real-time flexspline (f32) "
            "against the catalogue's line of K1, K2 and K3 with its knees at T1 and T2."
        }
        (figure(&plot(&page), &html! {
            "Above: torque over torsion up to " (SPAN) " times rated torque. Below: what each build differs from the line by."
        }))
    })
}

/// A column of rows, scaled.
fn column<const K: usize>(rows: &[[f64; K]], of: impl Fn(&[f64; K]) -> f64, scale: f64) -> Vec<f64> {
    rows.iter().map(|row| of(row) * scale).collect()
}

fn torques(rows: &[[f64; 4]], knees: &[[f64; 2]]) -> Panel {
    let torsion = column(rows, |row| row[0], 1e3);
    let knee_torsion = column(knees, |knee| knee[0], 1e3);
    let marked: Vec<_> = rows.iter().step_by(MARKED).copied().collect();
    let marked_torsion = column(&marked, |row| row[0], 1e3);
    Panel::new("torsion", "mrad", "torque", "N m")
        .with(Series::line("catalogue", &torsion, &column(rows, |row| row[1], 1.0)))
        .with(Series::points("reference", &marked_torsion, &column(&marked, |row| row[2], 1.0)))
        .with(Series::dashed("real time", &torsion, &column(rows, |row| row[3], 1.0)))
        .with(Series::points("knees T1, T2", &knee_torsion, &column(knees, |knee| knee[1], 1.0)))
}

fn differences(rows: &[[f64; 4]]) -> Panel {
    let torsion = column(rows, |row| row[0], 1e3);
    Panel::new("torsion", "mrad", "torque less the line's", "mN m")
        .with(Series::line("reference", &torsion, &column(rows, |row| row[2] - row[1], 1e3)))
        .with(Series::dashed("real time", &torsion, &column(rows, |row| row[3] - row[1], 1e3)))
}
