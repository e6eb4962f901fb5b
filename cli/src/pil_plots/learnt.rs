//! Plots of the factors that the compensator has learnt of the joint.

use strainwave::compensator::adapt::parameters::Factors;
use strainwave_desktop::bench::closed_loop::Row;
use strainwave_desktop::report::plot::{Panel, Series};

use super::column;

/// A name and the factor of it.
type Named = (&'static str, fn(&Factors<f32>) -> f32);

/// Factors of one panel each, two that are learnt side by side.
const PAIRS: [(&str, [Named; 2]); 3] = [
    (
        "inertia and compliance",
        [("load inertia", |factors| factors.inertia), ("compliance", |factors| factors.compliance)],
    ),
    (
        "friction",
        [
            ("at the wave generator", |factors| factors.input_friction),
            ("at the output", |factors| factors.output_friction),
        ],
    ),
    (
        "presliding",
        [
            ("fraction of order 2", |factors| factors.presliding),
            ("stiffness", |factors| factors.presliding_stiffness),
        ],
    ),
];

/// Learnt factors over time.
pub fn panels(rows: &[Row]) -> Vec<Panel> {
    let time = column(rows, |row| row.time);
    let factor = |of: fn(&Factors<f32>) -> f32| column(rows, |row| of(&row.answer.factors).into());
    let panel = |(title, [first, second]): (&str, [Named; 2])| {
        Panel::new("time", "s", "learnt factor", "1")
            .titled(title)
            .with(Series::line(first.0, &time, &factor(first.1)))
            .with(Series::dashed(second.0, &time, &factor(second.1)))
    };
    PAIRS.into_iter().map(panel).collect()
}
