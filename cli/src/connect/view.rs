//! Readings for people: a table that is drawn anew on a terminal, and a line each elsewhere.

use std::fmt::Write as _;
use std::io::{self, IsTerminal as _, Write as _};
use std::time::{Duration, Instant};

use strainwave_service::tuning::Reading;

use super::quantities;
use crate::figures::say;

/// Shortest time between two drawings: nobody reads faster.
const REDRAWN: Duration = Duration::from_millis(100);

/// Where readings are shown.
pub enum View {
    Nowhere,
    Lines,
    Screen {
        /// What is written above the table.
        head: String,
        drawn: Option<Instant>,
    },
}

impl View {
    /// A table under this head on a terminal, lines elsewhere.
    pub fn of_output(head: String) -> Self {
        if io::stdout().is_terminal() { Self::Screen { head, drawn: None } } else { Self::Lines }
    }

    /// Shows a reading and its row.
    pub fn show(&mut self, reading: &Reading, row: &[f64]) {
        match self {
            Self::Nowhere => {}
            Self::Lines => say(format_args!("{}", line(reading, row))),
            Self::Screen { head, drawn } => {
                if drawn.is_none_or(|drawn| drawn.elapsed() >= REDRAWN) {
                    draw(&table(head, reading, row), drawn.is_none());
                    *drawn = Some(Instant::now());
                }
            }
        }
    }
}

/// Draws from the upper left corner of the screen, which is empty at first.
fn draw(table: &str, first: bool) {
    let mut text = String::from(if first { "\x1b[2J\x1b[H" } else { "\x1b[H" });
    for line in table.lines() {
        // The rest of a longer line that stood there goes.
        let _ = writeln!(text, "{line}\x1b[K");
    }
    text.push_str("\x1b[J");
    let mut output = io::stdout().lock();
    // A terminal that has gone is told by its signal.
    let _ = output.write_all(text.as_bytes()).and_then(|()| output.flush());
}

fn faults(reading: &Reading, between: &str) -> String {
    let names: Vec<_> = reading.faults().names().collect();
    if names.is_empty() { "none".into() } else { names.join(between) }
}

/// A reading as words `name=value`.
fn line(reading: &Reading, row: &[f64]) -> String {
    let faults = faults(reading, "+").replace(' ', "-");
    let mode = format!("{:?}", reading.mode()).to_lowercase();
    let mut line = format!("t_s={} mode={mode} faults={faults}", row[0]);
    for (quantity, value) in quantities::all().zip(row).skip(quantities::STATE) {
        // A log has all digits.
        let _ = write!(line, " {}={}", quantities::column(quantity), *value as f32);
    }
    line
}

fn table(head: &str, reading: &Reading, row: &[f64]) -> String {
    let mode = format!("{:?}", reading.mode()).to_lowercase();
    let mut table = format!("{head}\n{:.1} s   {mode}   faults: {}\n\n", row[0], faults(reading, ", "));
    let _ = writeln!(table, "{:<28}{:<6}{:>14}{:>14}", "quantity", "unit", "value", "deviation");
    for quantity in quantities::of(row) {
        let deviation = quantity.deviation.map_or(String::new(), |deviation| format!("{deviation:.2e}"));
        let name = quantity.name.replace('_', " ");
        let unit = match quantity.unit {
            "nm" => "N m",
            "rad_s" => "rad/s",
            unit => unit,
        };
        let _ = writeln!(table, "{name:<28}{unit:<6}{:>14.6}{deviation:>14}", quantity.value);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_is_a_line_or_a_table() {
        let reading = Reading::default();
        let mut row = quantities::row(0.25, &reading);
        row[quantities::STATE + 1] = -0.5;
        let line = line(&reading, &row);
        assert!(
            line.starts_with(
                "t_s=0.25 mode=ready faults=none motor_reference_rad=0 output_position_rad=-0.5 "
            )
        );
        assert_eq!(line.split(' ').count(), row.len());
        let table = table("hd25-100", &reading, &row);
        assert!(table.starts_with("hd25-100\n0.2 s   ready   faults: none\n"), "{table}");
        let position = table.lines().find(|line| line.starts_with("output position")).unwrap();
        assert_eq!(
            position.split_whitespace().collect::<Vec<_>>(),
            ["output", "position", "rad", "-0.500000", "0.00e0"]
        );
        // With head and names it fits on a terminal of 24 lines.
        assert!(table.lines().count() <= 23, "{table}");
    }
}
