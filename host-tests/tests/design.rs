//! The linear loops of `strainwave design` against those that the real code closes.
use strainwave_desktop::GearFile;
use strainwave_desktop::design::sweep::sweep;
use strainwave_desktop::io::gear_file::SensorSet;

/// Within 0.15 dB wherever the loop has a gain of more than a half.
#[test]
fn the_linear_loop_is_that_of_the_code() {
    for set in SensorSet::ALL {
        for point in sweep(&GearFile::default_gear(), set, &[5, 10, 20, 40, 60, 80]).unwrap() {
            assert!(point.linear < -6.0 || (point.measured - point.linear).abs() < 0.15, "{set:?} {point:?}");
        }
    }
}
