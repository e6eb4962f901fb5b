//! `pil`: processor in the loop.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use strainwave_desktop::bench::closed_loop::Run;
use strainwave_desktop::bench::scenario::Scenario;
use strainwave_desktop::bench::task::Task;
use strainwave_desktop::bench::{Conditions, Motion, Trajectory};
use strainwave_desktop::design::buildable::buildable;
use strainwave_desktop::identify::learn_gear;
use strainwave_desktop::io::gear_file::DEFAULT;
use strainwave_desktop::io::gear_file::SensorSet;
use strainwave_desktop::io::log::{CommandedMotion, MeasuredLog};
use strainwave_desktop::plant::box_sample::BoxSample;
use strainwave_desktop::plant::payload::Payload;
use strainwave_desktop::verify::bounds;
use strainwave_desktop::verify::compensator;
use strainwave_desktop::{BadInput, Figure, GearFile};
use strainwave_emulator::pil::{self, Replay, TargetRun, Trial, TrialRun};

use crate::figures::{Figures, FiguresArguments, complain, say};
use crate::files;
use crate::logs::Reading;
use crate::page::PageArguments;
use crate::payload::PayloadArguments;
use crate::pil_plots;
use crate::progress::Progress;
use crate::series;

/// Run a board's firmware in the emulator, in lockstep with the reference plant or on a measured log
///
/// Builds the firmware for the joint of the gear file, boots it, and closes the loop every 0.1 ms: sensors
/// in, torque command out. The same scenario runs with every baseline that the sensors allow: B0 is the motor-side
/// cascade alone, B1 adds a rigid joint's feed-forward, B2 the stored kinematic error and the wind-up, B3 the output's
/// encoder. A fault, more than 10 ms at the torque limit, or an error or vibration that is worse than a baseline's by more
/// than 5 % and 12 urad misses its bound. Every output of the firmware is compared bit for bit with the
/// host's f32 build, and the instructions (exact) and cycles (a model of a Cortex-M4F with zero wait states,
/// not silicon; of no other core) of the control step are counted. With --trajectory the joint follows a motion of the user
/// in the place of a scenario. With --replay a measured log goes through the firmware's observer instead, and the
/// output that it predicts is compared with the output encoder; with --learn the first part of the log first teaches the gear, as
/// `identify --moving` does, and what is compared is the rest. Gets the cross compiler and the emulator
/// when they are missing, and says so first.
#[derive(Args)]
pub struct Arguments {
    /// Which board's firmware; one that the emulator has
    #[arg(long, value_name = "BOARD", default_value = "mps2-an386")]
    board: String,
    /// Which scenario; or all of them, with the whole table of what is claimed: each row the worst of 20 samples of the
    /// plant on the desktop, then every scenario on that sample with the firmware, with either set of sensors
    #[arg(long, value_name = "S1..S6|all", default_value = "S2", ignore_case = true,
          value_parser = scenario_parser(), conflicts_with = "replay")]
    scenario: Scenarios,
    /// Motion of the user in the place of a scenario: t_s, theta_rad, and where it has them omega_rad_s, alpha_rad_s2, tau_load_nm
    ///
    /// Setpoints of the output, and the external torque on it (0 when left out), in SI units; time stamps may jitter. Speed
    /// and acceleration that the file does not have, jerk and snap are those of the curve of the least squared jerk through
    /// its rows, every 0.1 ms; loads are joined linearly. The joint starts at rest at the angle of the first row. A row that
    /// needs more speed or torque than the gear file's limits allow is refused. All of the motion is judged. 0.1 to 60 s.
    #[arg(long, value_name = "MY.csv", conflicts_with_all = ["scenario", "replay"])]
    trajectory: Option<PathBuf>,
    #[command(flatten)]
    payload: PayloadArguments,
    /// Gear file; the default gear hd25-100 when left out
    #[arg(long, value_name = "G.toml")]
    gear: Option<PathBuf>,
    /// Measured log for the observer; needs --gear
    #[arg(long, value_name = "LOG.csv", requires = "gear")]
    replay: Option<PathBuf>,
    /// First learn the gear from this fraction of the log's motion, 0.2 to 0.9, and judge on the rest
    #[arg(long, value_name = "FRACTION", requires = "replay", allow_hyphen_values = true)]
    learn: Option<f64>,
    /// The log's motor torque counts against its motor angle
    #[arg(long, requires = "replay")]
    reversed_torque: bool,
    /// Read a log that has other columns, too, without those
    #[arg(long, requires = "replay")]
    ignore_extra: bool,
    /// Which plant: a sample of the uncertainties; 0 is the nominal plant [default: 1; for all
    /// scenarios the sample that is worst in each]
    #[arg(long, conflicts_with = "replay")]
    seed: Option<u64>,
    /// Which encoders the compensator reads, after 10 s of work from which it may learn, as in the table of `verify
    /// compensator`; left out, those of the gear file, from rest
    #[arg(long, value_name = "motor|both", conflicts_with = "replay", value_parser = sensors_parser())]
    sensors: Option<SensorSet>,
    /// Write the gear file again, to this file, with what the compensator has learnt in the run as its [learnt]; one
    /// scenario only
    ///
    /// The next run, or the firmware of the joint, starts from it: factors on inertia, friction and compliance, and the ripple.
    /// All else of the file stays as it is, comments too; it may be the file that --gear names. Written complete or not
    /// at all, once the run has ended.
    #[arg(long, value_name = "KEPT.toml", conflicts_with = "replay")]
    keep: Option<PathBuf>,
    /// Write the time series of one run to this file (CSV), a row every 0.1 ms: what was asked, and what each controller made of it
    ///
    /// Complete or not at all, once the run has ended. The book's page on commands lists the columns.
    #[arg(long, value_name = "SERIES.csv", conflicts_with = "replay")]
    series: Option<PathBuf>,
    /// Folder for the plots: one SVG file a question
    ///
    /// `pil.s2.tracking.svg`: output and its error; `.torsion.svg`; `.torque.svg`: of the motor and external; `.estimates-motion.svg`
    /// and `.estimates-torque.svg`: errors of the estimates within three standard deviations; `.learnt.svg`: factors learnt;
    /// `.spectrum.svg`: vibration of the torsion over frequency. With --replay `pil.replay.svg`: measured and predicted output.
    /// Every controller has the same colour and stroke in all of them.
    #[arg(long, value_name = "DIR", default_value = "out")]
    plots: PathBuf,
    /// Draw the output error of one scenario, with and without the compensator, to this file (SVG)
    #[arg(long, value_name = "FILE.svg", conflicts_with = "replay")]
    picture: Option<PathBuf>,
    #[command(flatten)]
    page: PageArguments,
    #[command(flatten)]
    figures: FiguresArguments,
}

#[derive(Clone)]
struct Scenarios(Vec<Scenario>);

fn scenario_parser() -> impl TypedValueParser<Value = Scenarios> {
    PossibleValuesParser::new(["S1", "S2", "S3", "S4", "S5", "S6", "all"]).map(|name| {
        let chosen = |scenario: &Scenario| {
            name.eq_ignore_ascii_case("all") || name.eq_ignore_ascii_case(scenario.name())
        };
        Scenarios(Scenario::ALL.into_iter().filter(chosen).collect())
    })
}

fn sensors_parser() -> impl TypedValueParser<Value = SensorSet> {
    PossibleValuesParser::new(SensorSet::ALL.map(SensorSet::name))
        .try_map(|name| SensorSet::named(&name).ok_or("no such set of sensors"))
}

/// Builds, boots and runs.
pub fn run(arguments: &Arguments) -> Result<Figures, BadInput> {
    let json = arguments.figures.json.as_deref();
    files::require_distinct(&[
        ("--gear", arguments.gear.as_deref()),
        ("--replay", arguments.replay.as_deref()),
        ("--trajectory", arguments.trajectory.as_deref()),
        ("--series", arguments.series.as_deref()),
        ("--json", json),
    ])?;
    // The gear file itself may be kept anew.
    let (picture, page) = (arguments.picture.as_deref(), arguments.page.markdown.as_deref());
    files::require_distinct(&[
        ("--trajectory", arguments.trajectory.as_deref()),
        ("--series", arguments.series.as_deref()),
        ("--keep", arguments.keep.as_deref()),
        ("--picture", picture),
        ("--markdown", page),
        ("--json", json),
    ])?;
    require_keepable(arguments)?;
    require_one_run(arguments)?;
    let (mut gear, text) = arguments.gear.as_deref().map_or_else(|| Ok(default_gear()), firmware_gear)?;
    let Arguments { ignore_extra, reversed_torque, .. } = *arguments;
    let reading = Reading { ignore_extra, reversed_torque };
    let log = arguments.replay.as_deref().map(|path| replayable(path, &gear, reading)).transpose()?;
    let trajectory = arguments.trajectory.as_deref().map(|path| trajectory(path, &gear)).transpose()?;
    let payload = arguments.payload.of(&gear)?;
    for path in [arguments.keep.as_deref(), arguments.series.as_deref(), picture, json] {
        files::require_writable(path)?;
    }
    arguments.page.require_renewable()?;
    files::require_folder(&arguments.plots)?;
    let learnt = learn(arguments, &mut gear, log.as_ref())?;
    let firmware = pil::prepare(&arguments.board, &gear).map_err(BadInput::message)?;
    let figures = match &log {
        Some(log) => replay(arguments, &firmware.elf, &gear, log, learnt)?,
        None => trials(arguments, &firmware.elf, (&gear, &text), trajectory.as_ref(), payload)?,
    };
    arguments.page.renew(&figures)?;
    Ok(Figures::new(figures, &arguments.figures))
}

/// Picture and series are of one run, and the table of what is claimed is of joints without a payload.
fn require_one_run(arguments: &Arguments) -> Result<(), BadInput> {
    let of_one = [
        ("--picture", arguments.picture.is_some(), "a picture is of one run"),
        ("--series", arguments.series.is_some(), "a series is of one run"),
        ("--payload", arguments.payload.given(), "what is claimed is of joints without one"),
    ];
    match of_one.into_iter().find(|(_, given, _)| *given && arguments.scenario.0.len() > 1) {
        None => Ok(()),
        Some((name, _, why)) => {
            Err(BadInput::message(format_args!("{name} with --scenario all: {why}; allowed: one of S1..S6")))
        }
    }
}

/// A motion within the joint's limits; what limits its use is told on the error stream.
fn trajectory(path: &Path, gear: &GearFile) -> Result<Trajectory, BadInput> {
    let trajectory = Trajectory::of(&CommandedMotion::read(path)?);
    trajectory.require_within(gear).map_err(|why| BadInput::new(path, why))?;
    for warning in trajectory.warnings(gear) {
        complain(format_args!("{}", BadInput::new(path, format_args!("warning: {warning}"))));
    }
    Ok(trajectory)
}

/// A gear that the firmware can be built for, and its text.
fn firmware_gear(path: &Path) -> Result<(GearFile, String), BadInput> {
    let (gear, text) = GearFile::read_with_text(path)?;
    buildable(&gear).map_err(|why| BadInput::new(path, why))?;
    Ok((gear, text))
}

fn default_gear() -> (GearFile, String) {
    (GearFile::default_gear(), DEFAULT.into())
}

/// Learnt values can be kept from one run of a compensator with the complete gear file only.
fn require_keepable(arguments: &Arguments) -> Result<(), BadInput> {
    let refuse = |why: &str| Err(BadInput::message(format_args!("--keep {why}")));
    match (&arguments.keep, arguments.scenario.0.as_slice(), arguments.sensors) {
        (None, ..) => Ok(()),
        (_, [Scenario::S4], Some(SensorSet::Both)) => refuse(
            "with --scenario S4 --sensors both: there the kinematic error that the gear file has is learnt anew; allowed: \
             another scenario or --sensors motor",
        ),
        (_, [_], _) => Ok(()),
        _ => refuse("with --scenario all: what is learnt is of one plant; allowed: one of S1..S6"),
    }
}

/// A log that has what a replay compares with.
fn replayable(path: &Path, gear: &GearFile, reading: Reading) -> Result<MeasuredLog, BadInput> {
    let log = reading.log(path, gear)?;
    if log.output_position.is_none() {
        return Err(BadInput::new(path, "column theta_out_rad is missing; a replay compares with it"));
    }
    Ok(log)
}

/// Learns the gear from the chosen fraction of the log; the time up to which (s).
fn learn(
    arguments: &Arguments,
    gear: &mut GearFile,
    log: Option<&MeasuredLog>,
) -> Result<Option<f64>, BadInput> {
    let (Some(fraction), Some(log), Some(path)) = (arguments.learn, log, &arguments.replay) else {
        return Ok(None);
    };
    if !(0.2..=0.9).contains(&fraction) {
        let why = format_args!("--learn {fraction} is out of range; allowed: a number from 0.2 to 0.9");
        return Err(BadInput::message(why));
    }
    let mut progress = Progress::new(1000, "learning");
    let found = learn_gear(gear, log, fraction, |fraction| progress.set((fraction * 1e3) as u64))
        .map_err(|why| BadInput::new(path, why))?;
    drop(progress);
    *gear = found.gear;
    Ok(Some(found.learnt))
}

/// Everything that is run: one motion; or the whole table, and every scenario on the sample that is worst there.
fn trials(
    arguments: &Arguments,
    elf: &Path,
    (gear, text): (&GearFile, &str),
    trajectory: Option<&Trajectory>,
    payload: Payload,
) -> Result<Vec<Figure>, BadInput> {
    let mut figures: Vec<_> = trajectory
        .and_then(|trajectory| trajectory.time().jitter())
        .into_iter()
        .flat_map(|jitter| jitter.figures())
        .collect();
    let all = arguments.scenario.0.len() > 1;
    if all && arguments.seed.is_none() {
        figures = table(gear)?;
    }
    let chosen = arguments.sensors.map(|sensors| vec![sensors]);
    let sensor_sets = chosen.or_else(|| all.then(|| SensorSet::ALL.to_vec())).unwrap_or_default();
    let mut trials: Vec<Trial<'_>> = Vec::new();
    for motion in motions(arguments, trajectory) {
        let seed = arguments.seed.unwrap_or(1);
        let rest = Trial { payload, ..Trial::from_rest(gear, motion, seed) };
        trials.extend(sensor_sets.iter().filter(|_| !motion.blocked()).map(|sensors| {
            let worst = |scenario| compensator::worst_draw(&figures, scenario, *sensors);
            let given = arguments.seed.map(|seed| (seed, 0));
            let (seed, realisation) = given.or(motion.scenario().and_then(worst)).unwrap_or((seed, 0));
            let conditions = Conditions { seed, realisation, sensors: *sensors, ..rest.conditions };
            Trial { conditions, worked: true, ..rest }
        }));
        trials.extend((sensor_sets.is_empty() || motion.blocked()).then_some(rest));
    }
    for trial in &trials {
        let run = run_trial(arguments, elf, gear, trial)?;
        figures.extend(trial_figures(&run, gear)?);
        if let Some(path) = &arguments.keep {
            run.target.learnt.keep_in(text, path)?;
            say(format_args!("    learnt: {}", path.display()));
        }
    }
    Ok(figures)
}

/// The user's motion, or the scenarios.
fn motions<'a>(arguments: &Arguments, trajectory: Option<&'a Trajectory>) -> Vec<Motion<'a>> {
    match trajectory {
        Some(trajectory) => vec![trajectory.into()],
        None => arguments.scenario.0.iter().map(|scenario| (*scenario).into()).collect(),
    }
}

/// The compensator against the baselines on the desktop, every row the worst of many plant samples.
fn table(gear: &GearFile) -> Result<Vec<Figure>, BadInput> {
    let mut progress = Progress::new(1000, "compensator and baselines");
    let request =
        compensator::Request { samples: compensator::SAMPLES, noises: compensator::NOISES, box_samples: 0 };
    let judgement =
        compensator::against_baselines(gear, &request, |fraction| progress.set((fraction * 1e3) as u64))
            .map_err(BadInput::message)?;
    Ok(judgement.figures)
}

fn run_trial<'a>(
    arguments: &Arguments,
    elf: &Path,
    gear: &GearFile,
    trial: &Trial<'a>,
) -> Result<TrialRun<'a>, BadInput> {
    let (motion, seed) = (trial.motion, trial.conditions.seed);
    let mut progress = Progress::new(1000, motion.title());
    let learning = trial.learns_ripple().then(|| pil::build(&arguments.board, &trial.controller_gear(gear)));
    let learning = learning.transpose().map_err(BadInput::message)?;
    let elf = learning.as_ref().map_or(elf, |firmware| &firmware.elf);
    let run = pil::run(elf, gear, trial, |fraction| progress.set((fraction * 1e3) as u64))
        .map_err(BadInput::message)?;
    drop(progress);
    let plots = write_plots(&run, gear, &arguments.plots)?;
    if let Some(path) = &arguments.picture {
        pil_plots::comparison(&run).write(path)?;
    }
    if let Some(path) = &arguments.series {
        series::write(&run, path)?;
    }
    let sample = BoxSample::from_seed(seed);
    say(format_args!("{}: {}; plots {plots}", trial.name(), motion.title()));
    say(format_args!(
        "    plant of seed {seed}: friction x {:.3} (input) x {:.3} (output), stiffness x {:.3}, load inertia x {:.3}",
        sample.friction[0], sample.friction[1], sample.stiffness, sample.inertia
    ));
    if trial.payload != Payload::NONE {
        let Payload { inertia, gravity, hanging } = trial.payload;
        say(format_args!(
            "    payload: {inertia:.4} kg m^2, weight up to {gravity:.4} N m, hanging at {hanging:.4} rad"
        ));
    }
    Ok(run)
}

/// Writes one file a question; their names for people.
fn write_plots(run: &TrialRun<'_>, gear: &GearFile, folder: &Path) -> Result<String, BadInput> {
    files::make_folder(folder)?;
    let (start, pages) = (format!("pil.{}", run.trial.name()), pil_plots::trial(run, gear));
    for (question, page) in &pages {
        page.write(&folder.join(format!("{start}.{question}.svg")))?;
    }
    let questions: Vec<_> = pages.iter().map(|(question, _)| *question).collect();
    Ok(format!("{}: {}", folder.join(format!("{start}.*.svg")).display(), questions.join(", ")))
}

fn trial_figures(run: &TrialRun<'_>, gear: &GearFile) -> Result<Vec<Figure>, BadInput> {
    let mut figures = run.claims(gear).map_err(BadInput::message)?;
    figures.extend(run.health(gear).map_err(BadInput::message)?);
    figures.extend(scenario_figures(run));
    figures.extend(run.loop_figures().map_err(BadInput::message)?);
    Ok(figures)
}

fn scenario_figures(run: &TrialRun<'_>) -> Vec<Figure> {
    let name = |rest: &str| format!("pil.{}.{rest}", run.trial.name());
    let TargetRun { run: compensated, learnt, agreement, ending, .. } = &run.target;
    let (estimate, cost) = (&compensated.estimate, &run.control_step);
    let baselines = |what: &str, of: fn(&Run) -> f64| -> Vec<_> {
        let figure = |(baseline, run): &(&str, Run)| {
            Figure::reported(name(&format!("{baseline}.{what}")), of(run), "rad")
        };
        run.baselines.iter().map(figure).collect()
    };
    let errors = [
        vec![run.beside_baselines()],
        baselines("rms", |run| run.rms),
        vec![Figure::reported(name("compensated.max"), compensated.max, "rad")],
        baselines("max", |run| run.max),
    ];
    let others = vec![
        Figure::reported(name("estimate.output.rms"), estimate.output, "rad"),
        Figure::reported(name("estimate.external_torque.rms"), estimate.external_torque, "N m"),
        Figure::reported(name("learnt.inertia"), learnt.inertia, "1"),
        Figure::reported(name("learnt.input_friction"), learnt.input_friction, "1"),
        Figure::reported(name("learnt.output_friction"), learnt.output_friction, "1"),
        Figure::reported(name("learnt.compliance"), learnt.compliance, "1"),
        Figure::reported(name("learnt.presliding"), learnt.presliding, "1"),
        Figure::reported(name("learnt.presliding_stiffness"), learnt.presliding_stiffness, "1"),
        Figure::reported(name("control_step.instructions_max"), cost.instructions.max as f64, "instruction"),
        bounds::figure_as(name("power_balance"), "plant.power_balance", compensated.imbalance),
        Figure::reported(name("steps"), agreement.steps as f64, "1"),
        agreement.figure(name("steps_unlike_host")),
        Figure::reported(name("stack"), f64::from(ending.stack), "byte"),
    ];
    // Only the model's core has cycles.
    let cycles = cost.cycles.map(|cycles| cycles.max as f64);
    let cycles = cycles.map(|max| Figure::reported(name("control_step.cycles_max"), max, "cycle"));
    [errors.concat(), others, cycles.into_iter().collect()].concat()
}

fn replay(
    arguments: &Arguments,
    elf: &Path,
    gear: &GearFile,
    log: &MeasuredLog,
    learnt: Option<f64>,
) -> Result<Vec<Figure>, BadInput> {
    let mut progress = Progress::new(1000, "replay");
    let replay = pil::replay(elf, gear, log, learnt, |fraction| progress.set((fraction * 1e3) as u64))
        .map_err(BadInput::message)?;
    drop(progress);
    files::make_folder(&arguments.plots)?;
    let path = arguments.plots.join("pil.replay.svg");
    pil_plots::replay(&replay.rows, learnt).write(&path)?;
    say(format_args!("replay through the observer; plot {}", path.display()));
    let jitter = log.time.jitter().into_iter().flat_map(|jitter| jitter.figures());
    Ok(jitter.chain(replay_figures(&replay)).collect())
}

fn replay_figures(replay: &Replay) -> Vec<Figure> {
    let judgement = &replay.judgement;
    vec![
        // An observer that predicts worse than no model at all has failed.
        Figure::bounded("pil.replay.predicted.rms", judgement.rms, "rad", judgement.rigid_rms),
        Figure::reported("pil.replay.rigid.rms", judgement.rigid_rms, "rad"),
        Figure::reported("pil.replay.over_rigid", judgement.ratio(), "1"),
        Figure::reported("pil.replay.steps", replay.agreement.steps as f64, "1"),
        replay.agreement.figure("pil.replay.steps_unlike_host"),
    ]
}
