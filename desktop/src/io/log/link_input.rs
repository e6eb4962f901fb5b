//! Input of an arm link, open loop: `t_s, theta_joint_rad`, and where the file has them `tip_force_n`, the external force ON the
//! tip across the link, and `voltage_v`, which is asked of the patch. Without the column each is 0.

use std::path::Path;

use super::columns::{Column, Columns, Extra, Schema};
use super::time::{TIME, Time};
use super::{ANGLE_LIMIT, LONGEST_FILE};
use crate::io::file::{self, BadInput};

/// Least rows: a curve of least jerk through two is not the only one.
const LEAST_ROWS: usize = 3;
const ANGLE: Column = Column {
    name: "theta_joint_rad",
    limit: ANGLE_LIMIT,
    other_names: &["theta_rad", "theta", "q", "angle_rad"],
};
const FORCE: Column = Column { name: "tip_force_n", limit: 1e6, other_names: &["force_n", "force", "f_n"] };
const VOLTAGE: Column = Column { name: "voltage_v", limit: 1e6, other_names: &["voltage", "u_v", "volt"] };
const SCHEMA: Schema =
    Schema { one_of: &[&[TIME], &[ANGLE]], optional: &[FORCE, VOLTAGE], may_ignore: false };

/// Motion of the joint and what acts on the link, row by row, as many of each column.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkInputLog {
    /// Time stamps.
    pub time: Time,
    /// Angle of the joint from the horizontal (rad).
    pub angle: Vec<f64>,
    /// External force on the tip (N).
    pub tip_force: Option<Vec<f64>>,
    /// Voltage asked of the patch (V).
    pub voltage: Option<Vec<f64>>,
}

impl LinkInputLog {
    /// Reads and checks `path`; a voltage is refused where there is no patch.
    ///
    /// # Errors
    /// One line that names the file, the row and the column.
    pub fn read(path: &Path, has_patch: bool) -> Result<Self, BadInput> {
        Self::parse(path, &file::read(path, LONGEST_FILE)?, has_patch)
    }

    /// The file in `bytes`; `path` is only named in errors.
    ///
    /// # Errors
    /// As [`LinkInputLog::read`].
    pub fn parse(path: &Path, bytes: &[u8], has_patch: bool) -> Result<Self, BadInput> {
        let mut columns = Columns::parse(path, bytes, SCHEMA, Extra::Refused)?;
        let refuse = |why: String| BadInput::new(path, why);
        let time = Time::check(columns.require(TIME)).map_err(refuse)?;
        let [angle, tip_force, voltage] = [ANGLE, FORCE, VOLTAGE].map(|column| columns.take(column));
        let angle = angle.expect("the header was checked");
        if angle.len() < LEAST_ROWS {
            let rows = angle.len();
            return Err(refuse(format!("{rows} rows after the header; allowed: at least {LEAST_ROWS}")));
        }
        if voltage.is_some() && !has_patch {
            let column = VOLTAGE.name;
            return Err(refuse(format!(
                "row 1, column {column}: the link file has no [piezo] to apply it to"
            )));
        }
        Ok(Self { time, angle, tip_force, voltage })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str, has_patch: bool) -> Result<LinkInputLog, String> {
        LinkInputLog::parse("in.csv".as_ref(), text.as_bytes(), has_patch).map_err(|why| why.to_string())
    }

    #[test]
    fn force_and_voltage_may_be_left_out() {
        let log = parse("theta_joint_rad,t_s\n0,0\n0.1,0.1\n0.2,0.2\n", false).unwrap();
        assert_eq!((log.angle[2], log.tip_force, log.voltage), (0.2, None, None));
        let log = parse("t_s,theta_joint_rad,voltage_v\n0,0,1\n0.1,0,2\n0.2,0,3\n", true).unwrap();
        assert_eq!(log.voltage, Some(vec![1.0, 2.0, 3.0]));
    }

    #[test]
    fn what_is_wrong_is_named_with_file_row_and_column() {
        let line = |text: &str| parse(text, false).unwrap_err();
        assert_eq!(
            line("t_s,theta_joint_rad\n0,0\n1,1\n"),
            "in.csv: 2 rows after the header; allowed: at least 3"
        );
        assert_eq!(
            line("t_s,theta_joint_rad,voltage_v\n0,0,1\n0.1,0,2\n0.2,0,3\n"),
            "in.csv: row 1, column voltage_v: the link file has no [piezo] to apply it to"
        );
        let unknown = line("t_s,theta_rad\n0,0\n0.1,0\n0.2,0\n");
        assert!(unknown.ends_with("tip_force_n, voltage_v; meant is perhaps theta_joint_rad"), "{unknown}");
    }
}
