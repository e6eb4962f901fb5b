//! Laws of the torque gauges: exact without flaws, still at a standstill, bounded for any bits, scaled by the ellipse.

use super::*;
use crate::flexspline::Reduced;
use crate::flexspline::calibration::tests::SIZE_25;
use proptest::prelude::*;

const PLACES: [((usize, usize), (i32, i32)); 4] =
    [((0, 0), (1, 1)), ((9, 0), (1, 1)), ((18, 0), (-1, 1)), ((27, 0), (-1, 1))];

fn params() -> TorqueGaugesParams<f64, 4> {
    let cup = Reduced::<f64, 36, 4>::build(&SIZE_25, 67.0).unwrap();
    let gauges = PLACES.map(|(node, direction)| StrainGauge::build(&cup, node, direction).unwrap());
    TorqueGaugesParams {
        gauges,
        rated_torque: 67.0,
        gain: 0.06,
        offset: 5e-5,
        noise: 1e-6,
        misplacement: 0.01,
        reference: 0.5,
    }
}

proptest! {
    #[test]
    fn gauges_without_flaws_are_right_at_once(torque in -300.0..300.0f64, counts: i64) {
        let (params, angle) = (params(), Angle::from_counts(counts));
        let sensor = params.build().unwrap();
        let strains = params.gauges.map(|gauge| gauge.strain(torque, angle));
        let read = sensor.step(&mut sensor.rest(), &strains, angle, None);
        prop_assert!((read.torque - torque).abs() < 1e-6, "{:?} at {}", read, torque);
    }

    #[test]
    fn nothing_is_learnt_at_a_standstill(
        strains: [f64; 4],
        counts: i64,
        reference in -67.0..67.0f64,
    ) {
        let sensor = params().build().unwrap();
        let mut state = sensor.rest();
        for _ in 0..20 {
            sensor.step(&mut state, &strains, Angle::from_counts(counts), Some(reference));
        }
        let learnt = |state: &TorqueGaugesState<f64, 4>| state.learnt.map(|gauge| gauge.coefficients);
        prop_assert_eq!(learnt(&state), learnt(&sensor.rest()));
        prop_assert_eq!(state.left, 1.0);
    }

    #[test]
    fn any_bits_give_bounded_torque_and_coefficients(
        bits: [[u64; 4]; 12],
        counts: [i64; 12],
        references: [u64; 12],
    ) {
        let sensor = params().build().unwrap();
        let mut state = sensor.rest();
        for ((strains, counts), reference) in bits.into_iter().zip(counts).zip(references) {
            let strains = strains.map(f64::from_bits);
            let reference = Some(f64::from_bits(reference));
            let read = sensor.step(&mut state, &strains, Angle::from_counts(counts), reference);
            prop_assert!(read.torque.abs() <= 5.0 * 67.0);
            prop_assert!(read.standard_deviation >= 0.0 && read.standard_deviation <= 5.0 * 67.0);
            let finite = |gauge: &Learnt<f64>| gauge.coefficients.iter().all(|learnt| learnt.is_finite());
            prop_assert!(state.learnt.iter().all(finite));
            // A correction is projected in the step after it.
            let projected = state.learnt.iter().zip(&sensor.gauges).filter(|_| state.slot != Slot::Project);
            for (gauge, prior) in projected {
                for ((learnt, expected), band) in
                    gauge.coefficients.iter().zip(prior.coefficients).zip(prior.band)
                {
                    prop_assert!((learnt - expected).abs() <= band * (1.0 + 1e-12));
                }
            }
        }
    }

    /// Gains come from the ellipse: a reference of any scale leads to the same torque.
    #[test]
    fn the_references_scale_does_not_matter(
        gains: [u8; 4],
        offset in -1e-4..1e-4f64,
        scale in 0.8..1.2f64,
    ) {
        let params = params();
        let sensor = params.build().unwrap();
        let gains = gains.map(|gain| 0.9 + 0.2 * f64::from(gain) / 255.0);
        let (mut state, mut angle) = (sensor.rest(), Angle::default());
        let mut worst = 0.0f64;
        for period in 0..30_000 {
            angle = angle.plus(0.03);
            let torque = 60.0 * (f64::from(period) * 1.3e-3).sin();
            let mut strains = gains;
            for (strain, gauge) in strains.iter_mut().zip(&params.gauges) {
                *strain = *strain * gauge.strain(torque, angle) + offset;
            }
            let read = sensor.step(&mut state, &strains, angle, Some(scale * torque));
            if period > 25_000 {
                worst = worst.max((read.torque - torque).abs());
            }
        }
        prop_assert!(worst < 0.7, "{} N m", worst);
    }
}

#[test]
fn what_is_out_of_range_is_named() {
    let refused = |change: fn(&mut TorqueGaugesParams<f64, 4>)| {
        let mut params = params();
        change(&mut params);
        params.build().err()
    };
    let named = |name| Some(Error::OutOfRange(name));
    assert_eq!(refused(|params| params.gain = 0.0), named("gain"));
    assert_eq!(refused(|params| params.offset = f64::NAN), named("offset"));
    assert_eq!(refused(|params| params.noise = 0.0), named("noise"));
    assert_eq!(refused(|params| params.misplacement = -0.1), named("misplacement"));
    assert_eq!(refused(|params| params.reference = f64::INFINITY), named("reference"));
    assert_eq!(refused(|params| params.rated_torque = 0.0), named("rated_torque"));
    assert_eq!(refused(|params| params.gauges[2].per_torque = 0.0), named("gauges"));
    let gauges = [params().gauges[0]];
    let one = TorqueGaugesParams {
        gauges,
        rated_torque: 67.0,
        gain: 0.06,
        offset: 0.0,
        noise: 1e-6,
        misplacement: 0.0,
        reference: 0.0,
    };
    assert_eq!(one.build().err(), named("gauges"));
}
