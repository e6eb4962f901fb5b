//! Former names of keys, with which older gear files are still read.

use toml::{Table, Value};

/// Table, former name and name of a key.
const FORMER: [(&str, &str, &str); 4] = [
    ("compensation", "friction_share", "friction_gain"),
    ("baselines.b1", "friction_share", "friction_gain"),
    ("baselines.b2", "friction_share", "friction_gain"),
    ("baselines.b3", "friction_share", "friction_gain"),
];

/// Gives keys with a former name their name; one that has both stays as it is, and is refused as unknown.
pub(super) fn rename(file: &mut Table) {
    for (path, former, name) in FORMER {
        let inner = path
            .split('.')
            .try_fold(&mut *file, |table, part| table.get_mut(part).and_then(Value::as_table_mut));
        let Some(table) = inner.filter(|table| !table.contains_key(name)) else { continue };
        if let Some(value) = table.remove(former) {
            table.insert(name.to_owned(), value);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::io::gear_file::GearFile;

    const SECTION: &str = "[baselines.b1]\nfriction_gain = 0.7\n";

    fn parse(text: &str) -> Result<GearFile, String> {
        GearFile::parse(Path::new("old.toml"), text.as_bytes()).map_err(|error| error.to_string())
    }

    fn text() -> String {
        let mut file = GearFile::default_gear();
        file.baselines = None;
        format!("{}\n{SECTION}", file.to_toml())
    }

    #[test]
    fn a_file_with_former_names_reads_the_same() {
        let old = text().replace("friction_gain", "friction_share");
        assert_eq!(old.matches("friction_share").count(), 2);
        assert_eq!(parse(&old).unwrap(), parse(&text()).unwrap());
    }

    #[test]
    fn a_key_of_both_names_is_refused() {
        let error = parse(&format!("{}friction_share = 0.5\n", text())).unwrap_err();
        assert!(error.contains("baselines.b1.friction_share"), "{error}");
    }
}
