//! Friction models compared: what each answers to one slow reversal from rest, and what it loses over a closed loop.
//!
//! Levels are those of a wave generator: 0.035 N m in sliding, 0.050 N m at standstill, presliding over about 20 mrad.

use strainwave::Error;
use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::friction::{
    ArmstrongParams, BlimanSorine, BristleParams, CoulombParams, DahlParams, FrictionModel, FrictionParams,
    KarnoppParams, LuGreParams, LubricatedContactParams, ResetIntegratorParams, Slip, StaticParams,
    StribeckParams,
};

const COULOMB: f64 = 0.035; // N m
const STATIC: f64 = 0.050; // N m
const PRESLIDING: f64 = 0.02; // rad
const SPEED: f64 = 0.5; // rad/s
/// Time of one stroke (s): 0.1 rad, five times the presliding distance.
const STROKE: f64 = 0.2;

/// Moves a contact forth, back and forth again, and prints what it answers.
fn compare<M: FrictionModel<f64>>(name: &str, model: M) {
    let (mut state, mut work, mut peak) = (M::State::default(), 0.0, 0.0f64);
    let mut ends = Vec::new();
    for direction in [1.0, -1.0, 1.0] {
        // What everything else applies is given to the models that ask for it at standstill.
        let slip = Slip::new(direction * SPEED, CONTROL_PERIOD).under(direction * STATIC, 0.0);
        for step in 0..(STROKE / CONTROL_PERIOD) as u32 {
            let force = model.step(&mut state, &slip).force;
            work += force * slip.displacement();
            peak = peak.max(force.abs());
            if step == 20 {
                ends.push(force); // 1 mrad after the start or the reversal
            }
        }
        ends.push(model.force(&state));
    }
    let [start, forwards, reversed, backwards, ..] = ends[..] else { return };
    println!(
        "{name:17} {:13.1} {:13.1} {:16.1} {:14.1} {:11.1} {:12.2}",
        start * 1e3,
        forwards * 1e3,
        reversed * 1e3,
        backwards * 1e3,
        peak * 1e3,
        work * 1e3
    );
}

fn main() -> Result<(), Error> {
    let contact = LubricatedContactParams {
        coulomb: COULOMB,
        static_level: STATIC,
        stribeck_velocity: 2.0,
        stribeck_exponent: 1.0,
        viscous: 1.2e-4,
    };
    let stiffness = COULOMB / PRESLIDING;
    println!("torque [mN m] at {SPEED} rad/s   1 mrad after      0.1 rad     1 mrad after        0.1 rad");
    println!(
        "                     the start       forwards     the reversal      backwards        peak    loss [mJ]"
    );
    compare("Coulomb", CoulombParams { coulomb: COULOMB }.build()?);
    compare("static", StaticParams { coulomb: COULOMB, static_level: STATIC }.build()?);
    compare("Stribeck", StribeckParams { contact }.build()?);
    compare("lubricated", contact.build()?);
    compare("Karnopp", KarnoppParams { contact, dead_band: 0.1 }.build()?);
    let armstrong = ArmstrongParams {
        stiffness,
        coulomb: COULOMB,
        viscous: 1.2e-4,
        stribeck: STATIC - COULOMB,
        stribeck_velocity: 2.0,
        memory: 5e-3,
        dwell: 0.1,
    };
    compare("Armstrong", armstrong.build()?);
    compare("Dahl", DahlParams { coulomb: COULOMB, stiffness, exponent: 1.0 }.build()?);
    compare("bristle", BristleParams::<f64, 20>::of_level(COULOMB, PRESLIDING).build()?);
    let reset = ResetIntegratorParams {
        stiffness,
        stick_gain: STATIC / COULOMB - 1.0,
        damping: 0.0,
        reach: PRESLIDING,
    };
    compare("reset integrator", reset.build()?);
    let (eta, level) = (0.3, COULOMB / 0.7);
    compare("Bliman-Sorine", BlimanSorine::order_2(level, eta * level, PRESLIDING, eta)?);
    let lugre = LuGreParams { contact, stiffness, damping: 0.01 };
    compare("LuGre", lugre.build()?);
    Ok(())
}
