//! Accuracy of the stored solutions of friction, and their targets; the table of bounds is tighter.

use strainwave_desktop::verify::friction::lugre::StickSlip;
use strainwave_desktop::verify::friction::order_p;

/// Asked of general A, B, C, as a fraction of the level.
const ASKED_OF_ORDER_P: f64 = 1e-9;
/// Asked of LuGre's stick-slip.
const ASKED_OF_LUGRE: f64 = 5e-3;

#[test]
fn twenty_systems_of_order_1_to_4_move_as_scipys() {
    let systems = order_p::stored();
    assert_eq!(systems.len(), 20);
    for order in 1..=4 {
        assert_eq!(systems.iter().filter(|system| system.order() == order).count(), 5);
    }
    for (k, system) in systems.iter().enumerate() {
        assert!(system.distance() <= ASKED_OF_ORDER_P, "system {k}: {:e}", system.distance());
    }
}

#[test]
fn an_entry_of_a_off_by_1e_6_of_itself_shows_in_every_system() {
    for mut system in order_p::stored() {
        system.a_per_m[0][0] *= 1.0 + 1e-6;
        assert!(system.distance() > ASKED_OF_ORDER_P);
    }
}

#[test]
fn stick_slip_has_the_period_and_the_peak_of_the_equation() {
    let errors = StickSlip::stored().errors();
    assert!(errors.period <= ASKED_OF_LUGRE && errors.peak <= ASKED_OF_LUGRE, "{errors:?}");
}

#[test]
fn static_friction_off_by_3_percent_shows_in_both() {
    let mut other = StickSlip::stored();
    other.fs_n *= 1.03;
    let errors = other.errors();
    assert!(errors.period > ASKED_OF_LUGRE && errors.peak > ASKED_OF_LUGRE, "{errors:?}");
}
