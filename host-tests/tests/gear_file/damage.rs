//! Whatever the file holds is a gear or one line.

use std::path::Path;

use proptest::prelude::*;
use strainwave_desktop::GearFile;
use strainwave_desktop::io::gear_file::DEFAULT;

fn one_line_or_gear(bytes: &[u8]) -> Result<(), TestCaseError> {
    if let Err(error) = GearFile::parse(Path::new("g.toml"), bytes) {
        let line = error.to_string();
        prop_assert!(line.starts_with("g.toml: ") && !line.chars().any(char::is_control), "{line}");
    }
    Ok(())
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        one_line_or_gear(&bytes)?;
    }

    /// Damage to a good file reaches further into the checks than noise does.
    #[test]
    fn no_damage_panics(at in 0..DEFAULT.len(), cut in 0..40usize, put in prop::collection::vec(any::<u8>(), 0..8)) {
        let end = (at + cut).min(DEFAULT.len());
        one_line_or_gear(&[&DEFAULT.as_bytes()[..at], &put, &DEFAULT.as_bytes()[end..]].concat())?;
    }

    /// Well-formed text in the wrong places.
    #[test]
    fn no_rearranged_lines_panic(order in prop::collection::vec(0..100usize, 1..60)) {
        let lines: Vec<_> = DEFAULT.lines().filter(|line| !line.starts_with('#')).collect();
        let text: Vec<_> = order.iter().map(|index| lines[index % lines.len()]).collect();
        one_line_or_gear(text.join("\n").as_bytes())?;
    }
}
