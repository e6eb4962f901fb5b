//! A motion that the picture plays: frames at even intervals.

use strainwave::compensator::schedule::CONTROL_PERIOD;

use super::shape::Shape;
use crate::bench::closed_loop::Run;
use crate::bench::scenario::Scenario;
use crate::io::gear_file::{Arrangement, GearFile};
use crate::verify::step_response::StepResponse;

/// Most frames of a motion.
const FRAMES: usize = 900;

/// The plant at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moment {
    /// theta_wg (rad).
    pub wave_generator: f64,
    /// Output angle (rad).
    pub output: f64,
    /// Torsion (rad).
    pub torsion: f64,
}

/// Frames of a motion.
pub(super) struct Motion {
    /// As in `s2`.
    pub name: &'static str,
    /// One line for people.
    pub title: String,
    /// Between frames (s).
    pub interval: f64,
    /// Of each frame: wave generator and flange as seen from the circular spline (rad), torque through the shell (N m),
    /// torsion (rad).
    pub frames: Vec<[f64; 4]>,
}

impl Motion {
    /// The compensated run of a scenario.
    pub fn of_run(file: &GearFile, shape: &Shape, scenario: Scenario, run: &Run) -> Self {
        let moment = |row: &crate::bench::closed_loop::Row| Moment {
            wave_generator: row.motor,
            output: row.output,
            torsion: row.torsion,
        };
        let moments: Vec<_> = run.trace.iter().map(moment).collect();
        let title = format!("{} {}", scenario.name().to_uppercase(), scenario.title());
        Self::of(file, shape, scenario.name(), title, &moments)
    }

    /// The steps of Fig. 9, open loop.
    pub fn of_steps(file: &GearFile, shape: &Shape, response: &StepResponse) -> Self {
        let moment = |(row, wave_generator): (&crate::io::log::OpenLoopRow, &f64)| Moment {
            wave_generator: *wave_generator,
            output: row.output_position,
            torsion: row.torsion,
        };
        let moments: Vec<_> = response.rows.iter().zip(&response.wave_generator).map(moment).collect();
        let title = format!("Fig. 9: steps of the wave generator, load {} N m", response.load);
        Self::of(file, shape, "fig-9", title, &moments)
    }

    /// Of moments one control period apart.
    pub fn of(file: &GearFile, shape: &Shape, name: &'static str, title: String, moments: &[Moment]) -> Self {
        let stride = moments.len().div_ceil(FRAMES).max(1);
        let frame = |k: usize| {
            let (before, now, after) =
                (moments[k.saturating_sub(1)], moments[k], moments[(k + 1).min(moments.len() - 1)]);
            let torque =
                shape.reduced.torque(now.torsion, (after.torsion - before.torsion) / (2.0 * CONTROL_PERIOD));
            seen(file, &now, torque)
        };
        let frames = (0..moments.len()).step_by(stride).map(frame).collect();
        Self { name, title, interval: CONTROL_PERIOD * stride as f64, frames }
    }
}

/// As seen from the circular spline. Where that is the output, the flexspline is at rest and the torque acts the other way.
fn seen(file: &GearFile, moment: &Moment, torque: f64) -> [f64; 4] {
    let Moment { wave_generator, output, torsion } = *moment;
    match file.gear.arrangement {
        Arrangement::CircularSplineFixed => [wave_generator, output, torque, torsion],
        Arrangement::FlexsplineFixed => [wave_generator - output, -output, -torque, -torsion],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::joint::gear_params;

    fn shape(file: &GearFile) -> Shape {
        let params = gear_params::<f64>(file);
        Shape::build(&params.flexspline, params.rated_torque).unwrap()
    }

    fn moments(count: usize) -> Vec<Moment> {
        let moment = |k: usize| Moment {
            wave_generator: k as f64,
            output: -0.01 * k as f64,
            torsion: 1e-7 * k as f64,
        };
        (0..count).map(moment).collect()
    }

    #[test]
    fn frames_are_few_and_even_and_have_the_models_torque() {
        let file = GearFile::default_gear();
        let shape = shape(&file);
        let motion = Motion::of(&file, &shape, "s2", String::new(), &moments(5000));
        assert!(motion.frames.len() <= FRAMES && motion.frames.len() > FRAMES / 2);
        assert!((motion.interval - 6.0 * CONTROL_PERIOD).abs() < 1e-12);
        let [wave_generator, output, torque, torsion] = motion.frames[100];
        assert_eq!((wave_generator, output, torsion), (600.0, -6.0, 600.0 * 1e-7));
        assert!((torque - shape.reduced.torque(torsion, 1e-3)).abs() < 1e-6, "{torque}");
    }

    /// Either way as many teeth go by: the wave generator turns n times for one revolution of the flexspline over the
    /// circular spline, the other way.
    #[test]
    fn either_arrangement_is_seen_from_the_circular_spline() {
        let mut file = GearFile::default_gear();
        file.gear.arrangement = Arrangement::FlexsplineFixed;
        let n = f64::from(file.gear.ratio);
        let moment = Moment { wave_generator: n + 1.0, output: 1.0, torsion: 1e-4 };
        assert_eq!(seen(&file, &moment, 5.0), [n, -1.0, -5.0, -1e-4]);
        file.gear.arrangement = Arrangement::CircularSplineFixed;
        let moment = Moment { wave_generator: n, output: -1.0, torsion: 1e-4 };
        assert_eq!(seen(&file, &moment, 5.0), [n, -1.0, 5.0, 1e-4]);
    }
}
