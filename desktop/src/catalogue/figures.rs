//! Figures that were read in makers' catalogues, and how a figure of another size follows from them.
//!
//! A figure of a size that has none follows from the nearest size that has one by the dimensional law: a gear of the same
//! shape, x times as large, has x^3 times the torque and stiffness, x^5 times the inertia.
//!
//! | figure | source |
//! | --- | --- |
//! | stiffness, ratios 30 and 50 | Harmonic Drive CSF/CSG catalogue p. 50, Tables 41 and 42; K3 of 14-50: RSF-14B manual p. 12 |
//! | stiffness, ratio 100 | HFUS 14, 25; Schaeffler RT1-H-CS 17, 20 (K1, K3); HFUC-2UH 32: HFUS-2A manual p. 24 |
//! | rated torque | CSG 14 to 32 at 2000 revolutions a minute |
//! | inertia of the wave generator | CSG-2A/HFUC-2A 14 to 32 |
//! | starting and running torque, efficiency | Schaeffler RT1-H-CS 14 to 25, ratio 100, 20 degrees C, running at 2000 revolutions a minute (TPI 275) |
//! | positional accuracy | CSF/CSG catalogue p. 49, Table 40 |
//! | hysteresis loss | CSF/CSG catalogues, from memory: a starting point, no threshold |

/// Sizes that have a stiffness, a rated torque and an inertia of their own.
pub const SIZES: [u32; 5] = [14, 17, 20, 25, 32];

/// Slopes K1, K2, K3 (N m/rad) of [`SIZES`], NaN where none was read.
type Slopes = [[f64; 3]; SIZES.len()];

const NONE: f64 = f64::NAN;
/// Ratio 30.
const SLOPES_30: Slopes = [
    [1900.0, 2400.0, 3400.0],
    [3400.0, 4400.0, 6700.0],
    [5700.0, 7100.0, 11_000.0],
    [10_000.0, 13_000.0, 21_000.0],
    [24_000.0, 30_000.0, 49_000.0],
];
/// Ratio 50.
const SLOPES_50: Slopes = [
    [3400.0, 4700.0, 5700.0],
    [8100.0, 11_000.0, NONE],
    [13_000.0, 18_000.0, NONE],
    [25_000.0, 34_000.0, NONE],
    [54_000.0, 78_000.0, NONE],
];
/// Ratio 100; higher ones, and 80, have no row of their own.
const SLOPES_100: Slopes = [
    [4700.0, 6100.0, 7100.0],
    [10_000.0, NONE, 16_000.0],
    [16_000.0, NONE, 29_000.0],
    [31_000.0, 50_000.0, 57_000.0],
    [67_000.0, 110_000.0, 120_000.0],
];
/// Knees T1, T2 (N m), of any ratio.
const KNEES: [[f64; 2]; SIZES.len()] = [[2.0, 6.9], [3.9, 12.0], [7.0, 25.0], [14.0, 48.0], [29.0, 108.0]];
/// Of a row without K3: K3/K2 of 14-50. Of one without K2: where K2 lies between K1 and K3 in 25-100.
const THIRD_TO_SECOND: f64 = 5700.0 / 4700.0;
const SECOND_BETWEEN: f64 = (50.0 - 31.0) / (57.0 - 31.0);

/// Rated torque (N m) of the ratios 50 and 100.
const RATED: [[f64; 2]; SIZES.len()] = [[7.0, 10.0], [21.0, 31.0], [33.0, 52.0], [51.0, 87.0], [99.0, 178.0]];
/// Inertia of the wave generator (kg m^2).
const INERTIA: [f64; SIZES.len()] = [0.033e-4, 0.079e-4, 0.193e-4, 0.413e-4, 1.69e-4];

/// Sizes that have a starting torque, a running torque and an efficiency, of the ratio 100.
const FRICTION_SIZES: [u32; 4] = [14, 17, 20, 25];
/// Starting torque, running torque at [`RUNNING_SPEED`], both at the motor (N m), and efficiency at rated torque.
const FRICTION: [[f64; 3]; FRICTION_SIZES.len()] =
    [[0.021, 0.035, 0.67], [0.029, 0.051, 0.77], [0.037, 0.105, 0.77], [0.069, 0.195, 0.77]];
/// 2000 revolutions a minute (rad/s).
pub const RUNNING_SPEED: f64 = 209.44;

/// A figure of a size: where it was read, and how many times as large the gear is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Read {
    /// Index in its table.
    row: usize,
    /// Size that it was read of.
    pub size: u32,
    /// Requested size over that size.
    pub scale: f64,
}

impl Read {
    /// The nearest of `sizes`.
    fn nearest(size: u32, sizes: &[u32]) -> Self {
        let apart = |other: &u32| (f64::from(*other) / f64::from(size)).ln().abs();
        let nearest = sizes.iter().enumerate().min_by(|a, b| apart(a.1).total_cmp(&apart(b.1)));
        let (row, of) = nearest.expect("no table is empty");
        Self { row, size: *of, scale: f64::from(size) / f64::from(*of) }
    }

    /// Source of a size's stiffness, rated torque and inertia.
    pub fn of(size: u32) -> Self {
        Self::nearest(size, &SIZES)
    }

    /// Source of its friction.
    pub fn friction(size: u32) -> Self {
        Self::nearest(size, &FRICTION_SIZES)
    }
}

/// The ratio whose row a ratio has: 30, 50, or 100 from 80 on.
pub fn row_ratio(ratio: i32) -> i32 {
    match ratio {
        ..40 => 30,
        40..65 => 50,
        _ => 100,
    }
}

/// K1, K2, K3 (N m/rad).
pub fn slopes(size: u32, ratio: i32) -> [f64; 3] {
    let read = Read::of(size);
    let rows = match row_ratio(ratio) {
        30 => &SLOPES_30,
        50 => &SLOPES_50,
        _ => &SLOPES_100,
    };
    completed(rows[read.row]).map(|slope| slope * read.scale.powi(3))
}

/// The slopes of this size and ratio stand in a table, all three.
pub fn slopes_were_read(size: u32, ratio: i32) -> bool {
    let whole = match row_ratio(ratio) {
        30 => true,
        50 => size == 14,
        _ => [14, 25, 32].contains(&size),
    };
    SIZES.contains(&size) && row_ratio(ratio) == ratio && whole
}

fn completed([first, second, third]: [f64; 3]) -> [f64; 3] {
    let second = if second.is_nan() { first + SECOND_BETWEEN * (third - first) } else { second };
    [first, second, if third.is_nan() { THIRD_TO_SECOND * second } else { third }]
}

/// T1, T2 (N m).
pub fn knees(size: u32) -> [f64; 2] {
    let read = Read::of(size);
    KNEES[read.row].map(|knee| knee * read.scale.powi(3))
}

/// Rated torque (N m): a power of the ratio through the rows of 50 and 100, constant from 100 on.
pub fn rated_torque(size: u32, ratio: i32) -> f64 {
    let read = Read::of(size);
    let [at_50, at_100] = RATED[read.row];
    let octaves = (f64::from(ratio.min(100)) / 50.0).log2();
    at_50 * (at_100 / at_50).powf(octaves) * read.scale.powi(3)
}

/// Inertia of the wave generator without a motor (kg m^2).
pub fn wave_generator_inertia(size: u32) -> f64 {
    let read = Read::of(size);
    INERTIA[read.row] * read.scale.powi(5)
}

/// Friction of the whole gear as it is seen at the motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtMotor {
    /// Starting torque (N m).
    pub starting: f64,
    /// Running torque at [`RUNNING_SPEED`] without load (N m).
    pub running: f64,
    /// Torque that friction grows by with each N m that the gear's load asks of the motor.
    pub load: f64,
}

/// Of the row of a size; no row tells it of another ratio than 100, so that it is taken for that of every ratio. The
/// loss at rated torque that the running torque does not explain grows with the load.
pub fn friction(size: u32) -> AtMotor {
    let read = Read::friction(size);
    let [starting, running, efficiency] = FRICTION[read.row];
    let motor_torque = rated_torque(read.size, 100) / 100.0;
    let load = (1.0 / efficiency - 1.0) - running / motor_torque;
    let torque = read.scale.powi(3);
    AtMotor { starting: starting * torque, running: running * torque, load }
}

/// Largest less smallest position error over a revolution (rad).
pub fn positional_accuracy(size: u32, ratio: i32) -> f64 {
    match (size, ratio) {
        (..=14, ..40) => 5.8e-4,
        (..=17, _) | (_, ..40) => 4.4e-4,
        _ => 2.9e-4,
    }
}

/// Width of the hysteresis loop at no torque (arcmin).
pub fn hysteresis_loss(ratio: i32) -> f64 {
    match row_ratio(ratio) {
        30 => 3.0,
        50 => 2.0,
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_that_was_read_stands_as_it_is() {
        assert_eq!(slopes(25, 100), [31_000.0, 50_000.0, 57_000.0]);
        assert_eq!((knees(32), rated_torque(14, 50)), ([29.0, 108.0], 7.0));
        assert!(
            (rated_torque(14, 100) - 10.0).abs() < 1e-12 && rated_torque(25, 160) == rated_torque(25, 100)
        );
        assert!(slopes_were_read(14, 50) && !slopes_were_read(17, 50) && !slopes_were_read(40, 100));
    }

    #[test]
    fn what_was_not_read_keeps_the_order_of_the_slopes() {
        for size in [8, 14, 17, 20, 25, 32, 58] {
            for ratio in [30, 50, 80, 100, 160] {
                let [k1, k2, k3] = slopes(size, ratio);
                assert!(k1 < k2 && k2 < k3, "{size}-{ratio}: {k1} {k2} {k3}");
            }
        }
    }

    #[test]
    fn twice_the_size_has_8_times_the_torque_and_32_times_the_inertia() {
        let ratio = |of: fn(u32) -> f64| of(64) / of(32);
        assert!((ratio(|size| slopes(size, 100)[0]) - 8.0).abs() < 1e-12);
        assert!((ratio(|size| rated_torque(size, 50)) - 8.0).abs() < 1e-12);
        assert!((ratio(wave_generator_inertia) - 32.0).abs() < 1e-12);
        assert!((friction(50).starting / friction(25).starting - 8.0).abs() < 1e-12);
    }

    /// Losses at rated torque and 2000 revolutions a minute are those of the efficiency.
    #[test]
    fn the_losses_add_up_to_the_efficiency() {
        for (size, efficiency) in [(14, 0.67), (20, 0.77), (25, 0.77)] {
            let (motor_torque, of) = (rated_torque(size, 100) / 100.0, friction(size));
            let motor = motor_torque * (1.0 + of.load) + of.running;
            assert!((motor_torque / motor - efficiency).abs() < 1e-12 && of.load > 0.0, "{size}");
        }
    }
}
