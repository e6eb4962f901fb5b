//! The wrist: a compensator in front of a tooth belt and a harmonic drive, against the baselines and against itself where it is not told of
//! the stretch.
//!
//! S1 to S5 as `verify compensator` has them, with the motor's sensors after 10 s of work, on `SAMPLES` plants from seed
//! `FIRST` on: a belt of spans of many nodes in front of the condensed gear; friction, stiffness of belt and gear and load inertia off
//! by the box. A ratio to a baseline is the worst of these plants. The other compensator knows the pulleys and all inertia, as the baselines do, and
//! takes the belt for rigid; ratios to it, and to the same compensator with massless spans in the plant, are of the sums of squares over all plants.

use strainwave::belt::SeriesBeltParams;
use strainwave::compensator::JointParams;

use crate::bench::baseline::Baseline;
use crate::bench::{Bench, Conditions};
use crate::design::joint::joint_params;
use crate::io::figure::Figure;
use crate::io::gear_file::{GearFile, SensorSet};
use crate::plant::divergence::RunError;
use crate::plant::driving_belt::Spans;
use crate::verify::compensator::{Performance, each, worked};
use crate::verify::judge::Metric;
use crate::verify::{Measured, bounds};

/// First plant.
const FIRST: u64 = 10_000;
/// Plants.
const SAMPLES: u64 = 8;

/// Rows of the ratios to a baseline, B0 or B1.
const TO_BASELINES: [(&str, Metric, usize); 8] = [
    ("belt.wrist.s1.vibration_to_b0", Metric::StepVibration, 0),
    ("belt.wrist.s2.rms_to_b0", Metric::Error, 0),
    ("belt.wrist.s2.rms_to_b1", Metric::Error, 1),
    ("belt.wrist.s3.vibration_to_b0", Metric::MoveVibration, 0),
    ("belt.wrist.s3.settling_to_b0", Metric::Settling, 0),
    ("belt.wrist.s4.ripple_to_b0", Metric::Ripple, 0),
    ("belt.wrist.s5.peak_to_b0", Metric::Peak, 0),
    ("belt.wrist.s5.steady_to_b0", Metric::Steady, 0),
];
/// Rows of the ratios to the compensator without the stretch.
const TO_RIGID_BELT: [(&str, Metric); 3] = [
    ("belt.wrist.s2.rms_to_rigid_belt", Metric::Error),
    ("belt.wrist.s3.vibration_to_rigid_belt", Metric::MoveVibration),
    ("belt.wrist.s5.steady_to_rigid_belt", Metric::Steady),
];
/// Rows of the ratios to the same with massless spans in the plant.
const TO_MASSLESS_SPANS: [(&str, Metric); 2] = [
    ("belt.wrist.s2.rms_to_massless_spans", Metric::Error),
    ("belt.wrist.s5.steady_to_massless_spans", Metric::Steady),
];

/// All controllers on one plant.
struct Compared {
    baselines: [Performance; 2],
    told: Performance,
    rigid_belt: Performance,
    massless_spans: Performance,
}

/// Every figure; `progress` is called with the fraction done.
///
/// # Errors
/// A plant that diverges.
pub fn measure(mut progress: impl FnMut(f64)) -> Result<Measured, RunError> {
    let file = GearFile::wrist();
    let seeds: Vec<_> = (FIRST..FIRST + SAMPLES).collect();
    let compared = each(&seeds, |seed| compare(&file, *seed), &mut progress);
    let compared = compared.into_iter().collect::<Result<Vec<_>, _>>()?;
    let mut figures: Vec<Figure> = TO_BASELINES
        .iter()
        .map(|(name, metric, baseline)| {
            let ratio = |on: &Compared| on.told.metric(*metric) / on.baselines[*baseline].metric(*metric);
            let ratios = compared.iter().zip(&seeds).map(|(on, seed)| (ratio(on), *seed));
            let (worst, seed) = ratios.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::NAN, 0));
            bounds::figure(name, worst).of_seed(seed)
        })
        .collect();
    let sums = |metric, of: fn(&Compared) -> &Performance| {
        compared.iter().map(|on| of(on).metric(metric).powi(2)).sum::<f64>()
    };
    let mut rows = |rows: &[(&str, Metric)], other: fn(&Compared) -> &Performance| {
        figures.extend(rows.iter().map(|(name, metric)| {
            bounds::figure(name, (sums(*metric, |on| &on.told) / sums(*metric, other)).sqrt())
        }));
    };
    rows(&TO_RIGID_BELT, |on| &on.rigid_belt);
    rows(&TO_MASSLESS_SPANS, |on| &on.massless_spans);
    Ok(Measured::from(figures).with_tight_bounds())
}

/// All of them on the plant of a seed.
fn compare(file: &GearFile, seed: u64) -> Result<Compared, RunError> {
    let conditions = Conditions { sensors: SensorSet::Motor, ..Conditions::of(file, seed) };
    let (plant, limit) = (conditions.plant(file)?, file.motor.peak_torque);
    let bench = Bench::condensed(file, &conditions)?;
    let baseline = |baseline| Performance::of(&bench, &baseline, &plant, limit);
    let told: JointParams<f32> = joint_params(file)?;
    let rigid = told.belt.map(|belt| SeriesBeltParams { compliance: 0.0, ..belt });
    let compensated = |joint: &JointParams<f32>, spans| {
        let (bench, controller) = worked(joint, file, &Conditions { spans, ..conditions })?;
        Performance::of(&bench, &controller, &plant, limit)
    };
    Ok(Compared {
        baselines: [baseline(Baseline::b0(file)?)?, baseline(Baseline::b1(file)?)?],
        told: compensated(&told, Spans::Chain)?,
        rigid_belt: compensated(&JointParams { belt: rigid, ..told }, Spans::Chain)?,
        massless_spans: compensated(&told, Spans::Massless)?,
    })
}
