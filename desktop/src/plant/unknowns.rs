//! Uncertainties of the plant, row by row: the table from which judged plants are drawn.
//!
//! Every row stands on the old box (friction +-20 %, stiffness +-10 %, load inertia +-30 %; [`crate::plant::box_sample`]) and changes one
//! thing more. A row draws from a stream of its own, which follows from the seed and the row's name: a row that is added or
//! moved changes no other. All at once is every row, with one of the structures that friction may have.
//!
//! Uniform over the stated range where nothing else is said; factors of more than 2 over the logarithm.

use std::f64::consts::{PI, TAU};

use strainwave::Error;
use strainwave::friction::{Harmonics, LoadFactors, Order, RIPPLE_ORDERS};
use strainwave::hysteresis::HysteresisTable;
use strainwave::hysteresis::table::TABLE_LEVELS;
use strainwave::hysteresis::torsion::gap_for_width;
use strainwave::kinematic_error::Term;

use crate::design::capability::Capability;

use crate::io::gear_file::GearFile;

use super::friction::{Drift, Structure};
use super::load_side::LinkParams;
use super::sample::PlantSample;
use super::sample_stream::SampleStream;
use crate::sensor::Wave;

/// One unknown.
#[derive(Debug)]
pub struct Row {
    /// Dotted and stable.
    pub name: &'static str,
    /// Changed parameter, and its range.
    pub what: &'static str,
    /// Of the rows of one group a plant has one.
    pub group: Option<&'static str>,
    /// Changes a plant.
    pub sample: fn(&mut PlantSample, &mut SampleStream),
}

const fn row(name: &'static str, what: &'static str, sample: fn(&mut PlantSample, &mut SampleStream)) -> Row {
    Row { name, what, group: None, sample }
}

const fn structure(
    name: &'static str,
    what: &'static str,
    sample: fn(&mut PlantSample, &mut SampleStream),
) -> Row {
    Row { group: Some("structure"), ..row(name, what, sample) }
}

/// Every unknown.
pub const ROWS: &[Row] = &[
    row("box", "the old box alone: friction +-20 %, stiffness +-10 %, load inertia +-30 %", |_, _| ()),
    row("inertia.rotor", "rotor inertia +-10 %", |plant, random| {
        plant.params.wave_generator_inertia *= random.about_one(0.1);
    }),
    row("drive.constant", "torque constant +-10 %", |plant, random| {
        plant.sides.drive.torque_constant = random.about_one(0.1);
    }),
    row("drive.offset", "torque offset +-1 % of rated", |plant, random| {
        plant.sides.drive.offset = random.within(-0.01, 0.01) * rated_at_motor(plant);
    }),
    row("drive.delay", "0 to 2 control periods late", |plant, random| {
        plant.sides.drive.delay = random.within(0.0, 2.0);
    }),
    row("drive.bandwidth", "current loop of first order, 0.5 to 2 kHz", |plant, random| {
        plant.sides.drive.bandwidth = random.factor(500.0, 2000.0);
    }),
    row("drive.limit", "torque limit at 60 % of the nominal one", |plant, _| {
        plant.sides.drive.limit = 0.6 * plant.known.motor.peak_torque;
    }),
    structure("friction.bliman_sorine_1", "friction Bliman-Sorine of order 1", |plant, _| {
        order_one(plant);
    }),
    structure(
        "friction.bliman_sorine_2",
        "friction Bliman-Sorine of order 2, eta 0.15 to 0.6",
        |plant, random| {
            let eta = random.within(0.15, 0.6);
            for side in [&mut plant.params.input_friction, &mut plant.params.output_friction] {
                (side.order, side.presliding_ratio) = (Order::Two, eta);
            }
        },
    ),
    structure("friction.lugre", "friction LuGre, micro-damping 0.1 to 0.5", |plant, random| {
        order_one(plant);
        plant.structure = Structure::LuGre { damping: random.within(0.1, 0.5) };
    }),
    structure("friction.dahl", "friction Dahl: no Stribeck effect", |plant, _| {
        order_one(plant);
        for side in [&mut plant.params.input_friction, &mut plant.params.output_friction] {
            side.forward.static_level = side.forward.coulomb;
            side.backward.static_level = side.backward.coulomb;
        }
    }),
    structure("friction.stribeck", "friction Stribeck with static, without presliding", |plant, _| {
        plant.structure = Structure::Static;
    }),
    row("friction.presliding", "presliding distance x 0.3 to 3", |plant, random| {
        for side in [&mut plant.params.input_friction, &mut plant.params.output_friction] {
            side.presliding *= random.factor(0.3, 3.0);
        }
    }),
    row(
        "friction.load",
        "friction grows by 0 to 0.1 of the load, driving and driven apart",
        |plant, random| {
            for side in [&mut plant.params.input_friction, &mut plant.params.output_friction] {
                side.load = LoadFactors { driving: random.within(0.0, 0.1), driven: random.within(0.0, 0.1) };
            }
        },
    ),
    row(
        "friction.ripple",
        "friction ripples by 0 to 20 % over the wave generator's revolution",
        |plant, random| {
            for side in [&mut plant.params.input_friction, &mut plant.params.output_friction] {
                side.ripple.forward = rippled(random);
                side.ripple.backward = rippled(random);
            }
        },
    ),
    row(
        "friction.drift",
        "viscous x 2, Coulomb x 0.7 within 60 s, begun up to 45 s before",
        |plant, random| {
            plant.drift =
                Some(Drift { age: random.within(0.0, 45.0), duration: 60.0, coulomb: 0.7, viscous: 2.0 });
        },
    ),
    row("hysteresis.width", "width of the loop x 0.5 to 2", |plant, random| {
        let factor = random.factor(0.5, 2.0);
        plant.params.hysteresis_width *= factor;
        if let Some(table) = &mut plant.params.hysteresis_table {
            table.weights = table.weights.map(|weight| factor * weight);
        }
    }),
    row("hysteresis.shape", "weights of the loop fall or rise with the relays' width", |plant, random| {
        let fall = random.within(-1.5, 2.0);
        plant.params.hysteresis_table = shaped(plant, fall).or(plant.params.hysteresis_table);
    }),
    row(
        "kinematic.stored",
        "errors of the stored kinematic error: phases 0.3 rad, amplitudes 30 %",
        |plant, random| {
            let error = &mut plant.params.kinematic_error;
            for term in
                error.case.iter_mut().chain(&mut error.flexspline).filter(|term| term.amplitude != 0.0)
            {
                term.amplitude *= random.about_one(0.3);
                term.phase = wrapped(term.phase + random.within(-0.3, 0.3));
            }
        },
    ),
    row(
        "kinematic.orders",
        "kinematic error of orders 1, 3, 4, 6 and the flexspline's 1, 2 besides, each to 30 %",
        |plant, random| {
            let stored = plant
                .known
                .kinematic_error
                .wave_generator
                .iter()
                .chain(&plant.known.kinematic_error.flexspline);
            let most = 0.3 * stored.map(|harmonic| harmonic.amplitude.abs()).fold(0.0, f64::max);
            for order in [1, 3, 4, 6] {
                add(&mut plant.params.kinematic_error.case, random.wave(order, most));
            }
            for order in [1, 2] {
                add(&mut plant.params.kinematic_error.flexspline, random.wave(order, most));
            }
        },
    ),
    row("motor.cogging", "cogging to 2 % of rated, any order to 36", |plant, random| {
        let order = random.whole(1, 36);
        plant.sides.motor.cogging = random.wave(order, 0.02 * rated_at_motor(plant));
    }),
    row("motor.ripple", "ripple of the torque constant to 2 %, any order to 36", |plant, random| {
        let order = random.whole(1, 36);
        plant.sides.motor.ripple = random.wave(order, 0.02);
    }),
    row(
        "encoder.eccentricity",
        "once and twice a revolution: motor to 2 and 1 mrad, output to 100 and 30 urad",
        |plant, random| {
            for (errors, most) in plant.encoders.iter_mut().zip([[2e-3, 1e-3], [1e-4, 3e-5]]) {
                errors.waves[0] = random.wave(1, most[0]);
                errors.waves[1] = random.wave(2, most[1]);
            }
        },
    ),
    row(
        "encoder.interpolation",
        "to 0.3 % of the signal period, 1024 a revolution at the motor, 2048 at the output",
        |plant, random| {
            for (errors, periods) in plant.encoders.iter_mut().zip([1024, 2048]) {
                errors.waves[2] = random.wave(periods, 0.003 * TAU / f64::from(periods));
            }
        },
    ),
    row("encoder.bits", "motor 14 to 23 bits, output 16 to 19, as the controller knows", |plant, random| {
        plant.known.sensors.motor_encoder_bits = random.whole(14, 23);
        plant.known.sensors.output_encoder_bits = Some(random.whole(16, 19));
    }),
    row("encoder.noise", "noise of a count", |plant, _| {
        plant.encoders.iter_mut().for_each(|errors| errors.noise = 1.0);
    }),
    row(
        "load.flexible",
        "30 to 50 % of the load behind a mode of 20 to 60 Hz, damping ratio 0.005 to 0.02",
        |plant, random| {
            plant.sides.load.link = Some(LinkParams {
                fraction: random.within(0.3, 0.5),
                frequency: random.within(20.0, 60.0),
                damping: random.within(0.005, 0.02),
                backlash: plant.sides.load.link.map_or(0.0, |link| link.backlash),
            });
        },
    ),
    row("load.gravity", "gravity to 0.6 of rated torque, 40 N m of the default gear", |plant, random| {
        (plant.sides.load.gravity, plant.sides.load.hanging) =
            (random.within(0.0, 40.0 * rated_share(plant)), random.phase());
    }),
    row("load.backlash", "backlash to 1 arcmin between flange and link", |plant, random| {
        let backlash = random.within(0.0, 1.0) / 60.0 * PI / 180.0;
        let rigid =
            LinkParams { fraction: random.within(0.3, 0.5), frequency: 150.0, damping: 0.05, backlash };
        let link = plant.sides.load.link.unwrap_or(rigid);
        plant.sides.load.link = Some(LinkParams { backlash, ..link });
    }),
    row("time.jitter", "the step's instants jitter by +-25 us", |plant, _| {
        plant.clock.jitter = 25e-6;
    }),
    row("time.missed", "1 % of the steps are missed", |plant, _| {
        plant.clock.missed = 0.01;
    }),
];

/// A row, or all of them.
#[derive(Clone, Copy, Debug)]
pub enum Which {
    /// One of [`ROWS`].
    Row(&'static Row),
    /// All at once.
    All,
}

/// By name: every row has one of its own.
impl PartialEq for Which {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for Which {}

impl Which {
    /// The old box alone.
    pub const BOX: Self = Self::Row(&ROWS[0]);
    /// The name of all at once.
    pub const ALL_NAME: &'static str = "all";

    /// Every row, then all at once.
    pub fn every() -> impl Iterator<Item = Self> {
        ROWS.iter().map(Self::Row).chain([Self::All])
    }

    /// The one of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::every().find(|which| which.name() == name)
    }

    /// The name, as in `drive.delay`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Row(row) => row.name,
            Self::All => Self::ALL_NAME,
        }
    }

    /// Description of the uncertainty.
    pub fn what(self) -> &'static str {
        match self {
            Self::Row(row) => row.what,
            Self::All => "every row at once, with one structure of friction",
        }
    }

    /// The uncertainties of the plant of a seed.
    pub fn rows(self, seed: u64) -> Vec<&'static Row> {
        let Self::All = self else { return ROWS.iter().filter(|row| row.name == self.name()).collect() };
        let grouped: Vec<_> = ROWS.iter().filter(|row| row.group.is_some()).collect();
        let chosen =
            grouped[SampleStream::new(seed, Self::ALL_NAME).whole(0, grouped.len() as u32 - 1) as usize];
        ROWS.iter().filter(|row| row.group.is_none() || row.name == chosen.name).collect()
    }
}

/// Rated torque, in that of the default gear.
fn rated_share(plant: &PlantSample) -> f64 {
    Capability { rated_torque: plant.params.rated_torque, ..Capability::default() }.load(1.0)
}

/// Rated torque at the motor (N m).
fn rated_at_motor(plant: &PlantSample) -> f64 {
    plant.params.rated_torque / f64::from(plant.params.ratio.unsigned_abs())
}

fn order_one(plant: &mut PlantSample) {
    plant.params.input_friction.order = Order::One;
    plant.params.output_friction.order = Order::One;
}

/// Up to 20 % over all orders together.
fn rippled(random: &mut SampleStream) -> Harmonics<f64, RIPPLE_ORDERS> {
    let (mut cosines, mut sines) = ([0.0; RIPPLE_ORDERS], [0.0; RIPPLE_ORDERS]);
    let mut left = random.within(0.0, 0.2);
    for (cosine, sine) in cosines.iter_mut().zip(&mut sines) {
        let (amplitude, phase) = (random.within(0.0, left), random.phase());
        left -= amplitude;
        (*sine, *cosine) = (amplitude * phase.sin(), amplitude * phase.cos());
    }
    Harmonics { mean: 1.0, cosines, sines }
}

/// Weights that fall by e^`fall` from the narrowest relay to the widest, of the same gap at no torsion; none of a gear whose
/// line is none.
fn shaped(plant: &PlantSample, fall: f64) -> Option<HysteresisTable<f64>> {
    let line = plant.params.flexspline.line;
    let half_range = line.build().ok()?.torsion(plant.params.rated_torque);
    let gap = gap_for_width(line.stiffness[0], plant.params.hysteresis_width, half_range).ok()?;
    let weight = |i: usize, j: usize| {
        let fraction = if i == j { 0.5 } else { 1.0 };
        fraction * (-fall * (i - j) as f64 / TABLE_LEVELS as f64).exp()
    };
    // At no torsion the branches differ by twice the relays that are wide enough to tell up from down there.
    let middle = TABLE_LEVELS / 2;
    let wide: f64 = (middle..TABLE_LEVELS).flat_map(|i| (0..middle).map(move |j| weight(i, j))).sum();
    let scale = gap / (2.0 * wide);
    Some(HysteresisTable::from_fn(half_range, TABLE_LEVELS, |i, j| scale * weight(i, j)))
}

/// Adds a sine to terms, to that of its order where there is one; one for which there is no place is left out.
pub(crate) fn add<const K: usize>(terms: &mut [Term<f64>; K], wave: Wave) {
    let same = |term: &&mut Term<f64>| term.amplitude != 0.0 && term.order == wave.order;
    if let Some(term) = terms.iter_mut().find(same) {
        let (sine, cosine) = [(term.amplitude, term.phase), (wave.amplitude, wave.phase)]
            .map(|(amplitude, phase)| (amplitude * phase.sin(), amplitude * phase.cos()))
            .iter()
            .fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
        (term.amplitude, term.phase) = (f64::hypot(sine, cosine), f64::atan2(sine, cosine));
    } else if let Some(place) = terms.iter_mut().find(|term| term.amplitude == 0.0) {
        *place = Term { order: wave.order, amplitude: wave.amplitude, phase: wave.phase };
    }
}

/// Within +-pi.
fn wrapped(phase: f64) -> f64 {
    phase - TAU * (phase / TAU).round()
}

impl PlantSample {
    /// The plant that a gear file describes ([`PlantSample::boxed`]), with the uncertainties of a row, or of all.
    ///
    /// # Errors
    /// As [`PlantSample::boxed`].
    pub fn of(file: &GearFile, which: Which, seed: u64) -> Result<Self, Error> {
        let mut sample = Self::boxed(file, seed)?;
        for row in which.rows(seed) {
            (row.sample)(&mut sample, &mut SampleStream::new(seed, row.name));
        }
        Ok(sample)
    }
}

#[cfg(test)]
mod tests {
    use strainwave::hysteresis::torsion::TorsionHysteresis;

    use super::*;
    use crate::design::joint::firmware_gear_params;
    use crate::io::gear_file::GearFile;
    use crate::plant::box_sample::BoxSample;
    use crate::plant::{MEMORY, Plant, Sides, plant_params};

    fn sample(name: &str, seed: u64) -> PlantSample {
        PlantSample::of(&GearFile::default_gear(), Which::named(name).unwrap(), seed).unwrap()
    }

    #[test]
    fn names_are_dotted_and_single() {
        assert_eq!(Which::BOX.name(), "box");
        for (k, row) in ROWS.iter().enumerate() {
            assert!(ROWS[..k].iter().all(|other| other.name != row.name), "{}", row.name);
            assert!(
                row.name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b"._".contains(&b))
            );
        }
        assert!(Which::named("drive.delay").is_some() && Which::named("all").is_some());
        assert!(Which::named("drive").is_none());
    }

    #[test]
    fn the_box_is_the_plant_of_before() {
        let params = firmware_gear_params(&GearFile::default_gear()).unwrap();
        for seed in [0, 1, 10_007] {
            let sample = sample("box", seed);
            assert_eq!(sample.params, BoxSample::from_seed(seed).apply(&params));
            assert_eq!(sample.sides, Sides::IDEAL);
            assert_eq!(sample.plant_params(), plant_params(&sample.params));
        }
    }

    #[test]
    fn a_row_repeats_and_differs_from_seed_to_seed() {
        let delay = |seed| sample("drive.delay", seed).sides.drive.delay;
        assert_eq!(delay(10_000), delay(10_000));
        assert_ne!(delay(10_000), delay(10_001));
        assert!((1..200).all(|seed| (0.0..=2.0).contains(&delay(seed))));
        // Of all at once every row is as alone.
        assert_eq!(sample("all", 10_003).sides.drive.delay, delay(10_003));
        assert_eq!(sample("all", 10_003).clock.jitter, sample("time.jitter", 10_003).clock.jitter);
    }

    /// A plant has one structure, and over some seeds each of them.
    #[test]
    fn all_at_once_has_one_structure() {
        let structures = |seed| {
            let rows = Which::All.rows(seed);
            let found: Vec<_> = rows.iter().filter(|row| row.group.is_some()).map(|row| row.name).collect();
            assert_eq!(found.len(), 1);
            found[0]
        };
        let mut seen: Vec<_> = (1..100).map(structures).collect();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), ROWS.iter().filter(|row| row.group.is_some()).count());
    }

    /// Each can be built, and its spring stays a spring however wide the loop.
    #[test]
    fn every_plant_can_be_built() {
        for which in Which::every() {
            for seed in [1, 2, 10_000, 10_001, 10_002] {
                let sample = PlantSample::of(&GearFile::default_gear(), which, seed).unwrap();
                let plant = Plant::condensed_between(&sample.plant_params(), &sample.sides);
                assert!(plant.is_ok(), "{} {seed}: {:?}", which.name(), plant.err());
                let hysteresis: TorsionHysteresis<f64, 64, MEMORY> = sample.params.hysteresis().unwrap();
                let line = sample.params.flexspline.line.build().unwrap();
                assert!(hysteresis.inverse(&line).is_ok(), "{} {seed}", which.name());
            }
        }
    }

    /// Another shape has the same gap at no torsion.
    #[test]
    fn a_shaped_loop_is_as_wide() {
        let sample = sample("box", 1);
        let gap = |table: Option<HysteresisTable<f64>>| {
            let mut params = sample.clone().params;
            params.hysteresis_table = table;
            let model: TorsionHysteresis<f64, 64, MEMORY> = params.hysteresis().unwrap();
            let end = params.flexspline.line.build().unwrap().torsion(67.0);
            let mut state = Default::default();
            let [up, down] = [-end, end].map(|from| {
                model.step(&mut state, -from);
                model.step(&mut state, from);
                model.step(&mut state, 0.0).torque
            });
            up - down
        };
        for fall in [-1.5, 0.0, 2.0] {
            assert!((gap(shaped(&sample, fall)) / gap(None) - 1.0).abs() < 1e-6, "{fall}");
        }
    }

    #[test]
    fn sines_of_one_order_add() {
        let mut terms = [Term { order: 4, amplitude: 2e-5, phase: 0.3 }, Term::default()];
        let wave = Wave { order: 4, amplitude: 1e-5, phase: -2.0 };
        add(&mut terms, wave);
        add(&mut terms, Wave { order: 3, ..wave });
        add(&mut terms, Wave { order: 5, ..wave });
        assert_eq!((terms[1].order, terms[1].amplitude), (3, 1e-5));
        for x in [0.0, 0.4, 2.0] {
            let at = |term: &Term<f64>| term.amplitude * (f64::from(term.order) * x + term.phase).sin();
            let expected = 2e-5 * (4.0 * x + 0.3).sin() + 1e-5 * (4.0 * x - 2.0).sin();
            assert!((at(&terms[0]) - expected).abs() < 1e-18);
        }
    }
}
