//! A gear that has every key, and changes of it.

use strainwave_desktop::GearFile;
use strainwave_desktop::bench::baseline::{BaselineGains, Kind};
use strainwave_desktop::io::gear_file::friction::{Backward, Friction, StateRow};
use strainwave_desktop::io::gear_file::{Baselines, Hardening, Learnt};
use toml::{Table, Value};

use super::{LARA8, parse};

/// A gear that has every key.
pub fn full() -> Table {
    let mut gear = parse(LARA8).unwrap();
    gear.kinematic_error.flexspline = gear.kinematic_error.wave_generator.clone();
    gear.sensors.output_encoder_error = gear.kinematic_error.wave_generator.clone();
    gear.compensation.external_torque_wander = Some(3.0);
    (gear.sensors.output_encoder_delay, gear.sensors.output_encoder_period) = (3, 10);
    (gear.sensors.motor_encoder_noise, gear.sensors.output_encoder_noise) = (Some(1e-5), Some(2e-5));
    gear.sensors.motor_encoder_still = Some(40);
    gear.sensors.output_encoder_zero = Some(0.1);
    gear.learnt = Some(learnt());
    gear.baselines = Some(baselines(&gear));
    gear.flexspline.hardening = Hardening::Bends;
    gear.belt = GearFile::wrist().belt;
    gear.hysteresis.half_range = Some(2e-3);
    gear.hysteresis.weights = Some(vec![vec![0.1], vec![0.3, 0.2], vec![0.5, 0.3, 0.1]]);
    for side in [&mut gear.friction.input, &mut gear.friction.output] {
        *side = every_friction(side);
    }
    gear.to_toml().parse().unwrap()
}

/// Tuned baselines.
fn baselines(gear: &GearFile) -> Baselines {
    let mut tuned = Baselines::default();
    for kind in Kind::ALL {
        tuned.set(kind, &BaselineGains::untuned(gear, kind));
    }
    tuned
}

/// Learnt factors and ripple.
fn learnt() -> Learnt {
    Learnt {
        inertia: 1.1,
        input_friction: 0.9,
        output_friction: 1.2,
        compliance: 0.95,
        presliding: 0.6,
        presliding_stiffness: 1.3,
        position_cosines: vec![1e-6, -2e-6],
        position_sines: vec![3e-6],
        torque_cosines: vec![1e-3],
        torque_sines: vec![-1e-3, 2e-3],
    }
}

/// Keys of every friction model.
fn every_friction(side: &Friction) -> Friction {
    Friction {
        dead_band: Some(1e-3),
        frictional_memory: Some(1e-3),
        dwell: Some(2.0),
        dahl_exponent: Some(2),
        micro_damping: Some(1e-4),
        load_driving: Some(0.08),
        load_driven: Some(0.12),
        ripple_cosines: Some(vec![0.1, -0.2]),
        ripple_sines: Some(vec![0.3]),
        backward: Some(Backward {
            coulomb: side.coulomb,
            static_level: side.static_level.map(|level| 1.1 * level),
            stribeck_velocity: side.stribeck_velocity,
            viscous: side.viscous,
            ripple_cosines: Some(vec![0.2]),
            ripple_sines: Some(vec![0.1, 0.1]),
        }),
        state_space: Some(vec![
            StateRow { a: vec![-1e3, 4e3], b: 1e3, c: 0.1 },
            StateRow { a: vec![-4e3, -2e3], b: 500.0, c: 0.05 },
        ]),
        ..side.clone()
    }
}

/// The table that holds the last part of a path (in a list its first entry), and that part.
pub fn at<'t, 'p>(table: &'t mut Table, path: &'p str) -> (&'t mut Table, &'p str) {
    let Some((first, rest)) = path.split_once('.') else { return (table, path) };
    match table.get_mut(first.trim_end_matches("[]")).unwrap() {
        Value::Array(items) => at(items[0].as_table_mut().unwrap(), rest),
        inner => at(inner.as_table_mut().unwrap(), rest),
    }
}

pub fn set(table: &mut Table, path: &str, value: impl Into<Value>) {
    let (inner, name) = at(table, path);
    assert!(inner.insert(name.into(), value.into()).is_some(), "{path} is not in the full gear");
}

/// The full gear with one value changed.
pub fn changed(path: &str, value: impl Into<Value>) -> Result<GearFile, String> {
    let mut table = full();
    set(&mut table, path, value);
    parse(&table.to_string())
}

/// As messages show a path of [`KEYS`].
pub fn shown(path: &str) -> String {
    path.replace("[]", "[0]")
}
