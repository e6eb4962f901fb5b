//! The torque-torsion curve of five gear sizes against the catalogue's K1, K2, K3 line, up to rated torque.
//!
//! Lines: the rows of ratio 100 in `catalogue/stiffness.csv` (sizes 14 and 25 HFUS, 17 and 20 RT1-H-CS, 32 HFUC-2UH).
//! Read in catalogues and manuals but for T1, T2 and K2 of sizes 17 and 20, which are recalled: there the figure says
//! that the mesh follows this line, not that it is the maker's.
//!
//! Rated torque: RT1-H-CS, ratio 100, of `catalogue/misc.csv` for sizes 14, 17 and 20 (10, 31, 52 N m); the default
//! gear's own for 25 (67 N m); none is there for 32: by the cube of the size from that (141 N m).
//!
//! The cup is the default gear's, size 25, all its lengths in proportion to the size, hence its stiffness by the cube;
//! J_fs, which only the damping follows from, by the fifth power. A line that is stiffer than that cup is an error.

use std::path::Path;

use serde::Deserialize;
use strainwave::Error;
use strainwave::flexspline::stiffness_line::StiffnessLineParams;
use strainwave::flexspline::{Cup, FlexsplineParams};

use super::stiffness::worst_off_line;
use crate::design::joint::gear_params;
use crate::io::data;
use crate::io::file::{self, BadInput};
use crate::io::gear_file::GearFile;
use crate::verify::Measured;
use crate::verify::bounds;

const LINES: &str = "catalogue/stiffness.csv";
const TORQUES: &str = "catalogue/misc.csv";
/// Longest catalogue (bytes).
const LONGEST: u64 = 1 << 20;
const RATIO: &str = "100";
/// Size of the default gear.
const DEFAULT_SIZE: u32 = 25;
/// The sizes, with their figures' names.
const SIZES: [(u32, &str, &str); 5] = [
    (14, "flexspline.8x3.size_14", "flexspline.36x4.size_14"),
    (17, "flexspline.8x3.size_17", "flexspline.36x4.size_17"),
    (20, "flexspline.8x3.size_20", "flexspline.36x4.size_20"),
    (25, "flexspline.8x3.size_25", "flexspline.36x4.size_25"),
    (32, "flexspline.8x3.size_32", "flexspline.36x4.size_32"),
];

pub(super) fn measure(gear: &GearFile) -> Result<Measured, BadInput> {
    let (Some(lines), Some(torques)) = (data::find(LINES), data::find(TORQUES)) else {
        return Ok(Measured::skipped(format!("flexspline.*.size_*: skipped: no data ({LINES}, {TORQUES})")));
    };
    let catalogue = Catalogue { lines: rows(&lines)?, torques: rows(&torques)? };
    let mut figures = Vec::new();
    for (size, coarse, reference) in SIZES {
        let off = |error: Error| BadInput::new(&lines, format_args!("size {size}: {error}"));
        let line = catalogue.line(size).ok_or_else(|| missing(&lines, size))?;
        let rated = catalogue.rated_torque(size, gear.gear.rated_torque);
        let params = scaled(&gear_params(gear).flexspline, line, size);
        figures.push(bounds::figure(coarse, worst_off_line::<8, 3>(&params, rated).map_err(off)?));
        figures.push(bounds::figure(reference, worst_off_line::<36, 4>(&params, rated).map_err(off)?));
    }
    Ok(figures.into())
}

/// The default gear's flexspline, scaled to a size, with that size's line.
fn scaled(
    default: &FlexsplineParams<f64>,
    line: StiffnessLineParams<f64>,
    size: u32,
) -> FlexsplineParams<f64> {
    let (share, cup) = (share(size), default.cup);
    let cup = Cup {
        radius: share * cup.radius,
        length: share * cup.length,
        wall: share * cup.wall,
        ellipse: share * cup.ellipse,
        ..cup
    };
    FlexsplineParams { cup, line, inertia: share.powi(5) * default.inertia, ..*default }
}

/// A size in sizes of the default gear.
fn share(size: u32) -> f64 {
    f64::from(size) / f64::from(DEFAULT_SIZE)
}

/// A row of the stiffness lines; a catalogue that was cut off lacks the last columns.
#[derive(Debug, Deserialize)]
struct Line {
    size: String,
    ratio: String,
    #[serde(rename = "T1_Nm")]
    t1: f64,
    #[serde(rename = "K1_Nm_per_rad")]
    k1: f64,
    #[serde(rename = "T2_Nm")]
    t2: f64,
    #[serde(rename = "K2_Nm_per_rad")]
    k2: Option<f64>,
    #[serde(rename = "K3_Nm_per_rad")]
    k3: Option<f64>,
}

/// A row of the other quantities: lists of sizes and of their values, with strokes between.
#[derive(Debug, Deserialize)]
struct Quantity {
    quantity: String,
    series: String,
    size: String,
    ratio: String,
    value: String,
}

struct Catalogue {
    lines: Vec<Line>,
    torques: Vec<Quantity>,
}

impl Catalogue {
    fn line(&self, size: u32) -> Option<StiffnessLineParams<f64>> {
        let rows = self.lines.iter().filter(|row| row.ratio == RATIO && row.size == size.to_string());
        rows.filter_map(|row| {
            Some(StiffnessLineParams { stiffness: [row.k1, row.k2?, row.k3?], knee_torque: [row.t1, row.t2] })
        })
        .next()
    }

    fn rated_torque(&self, size: u32, default: f64) -> f64 {
        let rows =
            self.torques.iter().filter(|row| row.quantity == "rated_torque" && row.series == "RT1-H-CS");
        let listed =
            rows.filter(|row| row.ratio == RATIO && size != DEFAULT_SIZE).find_map(|row| row.of(size));
        listed.unwrap_or(default * share(size).powi(3))
    }
}

impl Quantity {
    fn of(&self, size: u32) -> Option<f64> {
        let place = self.size.split('/').position(|listed| listed == size.to_string())?;
        self.value.split('/').nth(place)?.parse().ok()
    }
}

fn missing(path: &Path, size: u32) -> BadInput {
    BadInput::new(path, format_args!("size {size}, ratio {RATIO}: no row with K1, K2 and K3"))
}

fn rows<T: for<'de> Deserialize<'de>>(path: &Path) -> Result<Vec<T>, BadInput> {
    let bytes = file::read(path, LONGEST)?;
    let rows = csv::Reader::from_reader(bytes.as_slice()).into_deserialize();
    rows.map(|row| row.map_err(|error| BadInput::new(path, error))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(k3: &str) -> String {
        format!(
            "series,size,ratio,T1_Nm,K1_Nm_per_rad,T2_Nm,K2_Nm_per_rad,K3_Nm_per_rad,status,source\n\
                 X,17C,100,1,2,3,4,5,READ,x\nX,17,50,1,2,3,4,5,READ,x\nX,17,100,3.9,1e4,12,14e3,{k3},READ,x\n"
        )
    }

    fn parsed<T: for<'de> Deserialize<'de>>(text: &str) -> Result<Vec<T>, BadInput> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("stiffness.csv");
        std::fs::write(&path, text).unwrap();
        rows(&path)
    }

    fn catalogue(k3: &str) -> Catalogue {
        let torques = "quantity,series,size,ratio,value,unit,status,source\n\
                       rated_torque,RT1-H-CS,14/17/20/25,100,10/31/52/87,Nm,READ,x\n";
        Catalogue { lines: parsed(&line(k3)).unwrap(), torques: parsed(torques).unwrap() }
    }

    #[test]
    fn a_line_is_that_of_its_size_and_ratio_and_complete() {
        let found = catalogue("16000").line(17).unwrap();
        assert_eq!((found.stiffness, found.knee_torque), ([1e4, 1.4e4, 1.6e4], [3.9, 12.0]));
        assert!(catalogue("").line(17).is_none() && catalogue("16000").line(20).is_none());
    }

    #[test]
    fn rated_torque_is_the_rows_the_default_gears_or_its_cubes() {
        let rated = |size| catalogue("16000").rated_torque(size, 67.0);
        assert_eq!([14, 17, 20, 25].map(rated), [10.0, 31.0, 52.0, 67.0]);
        assert!((rated(32) - 140.5).abs() < 0.05, "{}", rated(32));
    }

    #[test]
    fn a_line_that_is_stiffer_than_the_cup_is_an_error_by_name() {
        let default = gear_params(&GearFile::default_gear()).flexspline;
        let off = |k3| worst_off_line::<8, 3>(&scaled(&default, catalogue(k3).line(17).unwrap(), 17), 31.0);
        assert_eq!(off("5.1e4"), Err(Error::OutOfRange("stiffness")));
        assert!(off("1.6e4").is_ok());
    }

    #[test]
    fn a_row_that_is_none_is_refused_with_its_line() {
        let error = parsed::<Line>(&line("stiff")).unwrap_err().to_string();
        assert!(error.contains("stiffness.csv: ") && error.contains("line: 4"), "{error}");
    }
}
