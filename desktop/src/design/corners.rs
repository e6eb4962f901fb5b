//! The corners of the box that a joint may lie in.

use super::mode::Mode;
use crate::io::gear_file::GearFile;

/// Damping ratio of the mode behind the flange: the least of the box.
pub const LINK_DAMPING: f64 = 0.005;
/// Presliding distance over the file's, where friction does not slide.
pub(super) const PRESLIDING: [f64; 2] = [0.3, 3.0];
/// Fraction of the load behind a mode, and its frequency (Hz).
const LINKS: [Option<(f64, f64)>; 4] = [None, Some((0.5, 20.0)), Some((0.3, 60.0)), Some((0.5, 60.0))];

/// Operating point on the gear's line, of model and gear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Point {
    /// Below the first knee.
    K1,
    /// Beyond the second.
    K3,
}

impl Point {
    /// Both ends.
    pub const ALL: [Self; 2] = [Self::K1, Self::K3];

    /// Stiffness of the model there (N m/rad).
    pub fn stiffness(self, file: &GearFile) -> f64 {
        match self {
            Self::K1 => file.stiffness.k1,
            Self::K3 => file.stiffness.k3,
        }
    }
}

/// One corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// On the line.
    pub point: Point,
    /// Factor on its stiffness.
    pub stiffness: f64,
    /// Factor on J_fs.
    pub load: f64,
    /// Factor on J_wg.
    pub rotor: f64,
    /// Torque constant over the file's.
    pub constant: f64,
    /// Delay of the drive beyond the control's own (control periods).
    pub delay: usize,
    /// Corner of its current loop (Hz).
    pub bandwidth: f64,
    /// Factor on the presliding distance; `None` where friction slides.
    pub presliding: Option<f64>,
    /// Fraction and frequency (Hz) of a load behind a mode.
    pub link: Option<(f64, f64)>,
}

fn both(span: f64) -> [f64; 2] {
    [1.0 - span, 1.0 + span]
}

impl Corner {
    /// The joint that the file describes, with an ideal drive.
    pub fn nominal(mode: Mode) -> Self {
        Self {
            point: Point::K1,
            stiffness: 1.0,
            load: 1.0,
            rotor: 1.0,
            constant: 1.0,
            delay: 0,
            bandwidth: f64::INFINITY,
            presliding: (mode == Mode::Standing).then_some(1.0),
            link: None,
        }
    }

    /// All corners of a mode: the file's `[drive]` and `[tolerances]`, presliding and a mode behind the flange.
    pub fn all(file: &GearFile, mode: Mode) -> Vec<Self> {
        let presliding = match mode {
            Mode::Moving => vec![None],
            Mode::Standing => PRESLIDING.map(Some).to_vec(),
        };
        let (drive, known) = (&file.drive, &file.tolerances);
        let mut corners = vec![Self::nominal(mode)];
        corners = spread(&corners, &Point::ALL, |c, x| c.point = x);
        corners = spread(&corners, &both(known.stiffness), |c, x| c.stiffness = x);
        corners = spread(&corners, &both(known.load_inertia), |c, x| c.load = x);
        corners = spread(&corners, &both(known.rotor_inertia), |c, x| c.rotor = x);
        corners = spread(&corners, &both(drive.torque_constant), |c, x| c.constant = x);
        corners = spread(&corners, &[0, drive.delay as usize], |c, x| c.delay = x);
        corners =
            spread(&corners, &[drive.least_current_loop, drive.largest_current_loop], |c, x| c.bandwidth = x);
        corners = spread(&corners, &presliding, |c, x| c.presliding = x);
        spread(&corners, &LINKS, |c, x| c.link = x)
    }

    /// For people.
    pub fn name(&self) -> String {
        let sign = |factor: f64| {
            if factor < 1.0 {
                "-"
            } else if factor > 1.0 {
                "+"
            } else {
                "="
            }
        };
        let friction = self.presliding.map_or_else(|| "sliding".into(), |x| format!("presliding x{x}"));
        let link = self.link.map_or_else(String::new, |(fraction, f)| format!(" link {fraction}@{f}Hz"));
        format!(
            "{:?}{} Jfs{} Jwg{} kt{} Td={} fc={} {friction}{link}",
            self.point,
            sign(self.stiffness),
            sign(self.load),
            sign(self.rotor),
            sign(self.constant),
            self.delay,
            self.bandwidth
        )
    }
}

fn spread<T: Copy>(corners: &[Corner], values: &[T], set: impl Fn(&mut Corner, T)) -> Vec<Corner> {
    let each = corners.iter().flat_map(|corner| values.iter().map(move |value| (*corner, *value)));
    each.map(|(mut corner, value)| {
        set(&mut corner, value);
        corner
    })
    .collect()
}
