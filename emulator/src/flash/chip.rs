//! Chip of a real board, as probe-rs calls it: `default.general.chip` in the board's `Embed.toml`, which cargo-embed reads too.

use super::Error;
use crate::firmware;

/// Name of the chip of a board.
///
/// # Errors
/// [`Error::Chip`] with the file that does not name it.
pub fn chip(board: &str) -> Result<String, Error> {
    let file = firmware::folder().join(board).join("Embed.toml");
    let bad = |what: String| Error::Chip { file: file.clone(), what };
    let text = std::fs::read_to_string(&file).map_err(|error| bad(error.to_string()))?;
    let table: toml::Table = toml::from_str(&text).map_err(|error| bad(error.message().to_owned()))?;
    chip_in(&table).ok_or_else(|| {
        bad("default.general.chip is missing, allowed: a name of `probe-rs chip list`".to_owned())
    })
}

fn chip_in(table: &toml::Table) -> Option<String> {
    let chip = table.get("default")?.get("general")?.get("chip")?.as_str()?;
    (!chip.trim().is_empty()).then(|| chip.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::Budget;

    /// `cargo run` in the board's folder flashes the same chip.
    #[test]
    fn every_real_board_names_its_chip_once() {
        let mut seen = 0;
        for board in firmware::boards().unwrap() {
            if Budget::read(&board).unwrap().emulated {
                continue;
            }
            let runner = firmware::folder().join(&board).join(".cargo/config.toml");
            let runner = std::fs::read_to_string(runner).unwrap();
            assert!(runner.contains(&format!("--chip {}\"", chip(&board).unwrap())), "{board}: {runner}");
            seen += 1;
        }
        assert!(seen > 0);
    }

    #[test]
    fn a_missing_chip_is_told_with_its_file() {
        let line = chip("mps2-an386").unwrap_err().to_string();
        assert!(line.contains("mps2-an386/Embed.toml: "), "{line}");
        let of = |text: &str| chip_in(&text.parse().unwrap());
        assert_eq!(of("[default.general]\nchip = \"A\"").as_deref(), Some("A"));
        assert_eq!(of("[default.general]\nchip = 3"), None);
        assert_eq!(of("[default.general]\nchip = \" \""), None);
        assert_eq!(of("[default.flashing]\nenabled = true"), None);
    }
}
