//! The golden file renewed: what was measured, plus the headroom, as the new bounds.

use toml_edit::{DocumentMut, Item, Table, value};

use super::{Budget, Error, LITERAL_MESH, Measurement, TORQUE_GAUGES};
use crate::artifact::CONTROL_STEP;

impl Budget {
    /// Writes what was measured, plus the headroom, as the new bounds; everything else in the file stays.
    ///
    /// # Errors
    /// [`Error::File`] or [`Error::Content`].
    pub fn overwrite(&self, measured: &Measurement) -> Result<(), Error> {
        let failed = |source| Error::File { file: self.file.clone(), source };
        let text = std::fs::read_to_string(&self.file).map_err(failed)?;
        let bad = |error: toml_edit::TomlError| Error::Content {
            file: self.file.clone(),
            what: error.message().to_owned(),
        };
        let mut document: DocumentMut = text.parse().map_err(bad)?;
        self.update(&mut document, measured);
        std::fs::write(&self.file, document.to_string()).map_err(failed)
    }

    fn update(&self, document: &mut DocumentMut, measured: &Measurement) {
        set(document, "compiler", value(measured.compiler.as_str()));
        let image = table(document, &self.of_image("image"));
        for (name, size) in measured.image_sizes().named() {
            size.into_iter().for_each(|size| set(image, name, self.bound(size)));
        }
        let fixed = |name: &str| self.rows().any(|(row, block)| row == name && block.fixed);
        for (name, counts) in measured.counts.iter().filter(|(name, _)| !fixed(name)) {
            let block = match name.as_str() {
                CONTROL_STEP => table(document, CONTROL_STEP),
                LITERAL_MESH => table(table(document, LITERAL_MESH), "period"),
                TORQUE_GAUGES => table(table(document, TORQUE_GAUGES), "step"),
                driven if self.worst_case.as_ref().is_some_and(|worst| worst.blocks.contains_key(driven)) => {
                    table(table(table(document, "worst_case"), "blocks"), driven)
                }
                part => table(table(document, "blocks"), part),
            };
            set(block, "instructions", self.bound(counts.instructions.max));
            if let Some(cycles) = counts.cycles {
                set(block, "cycles", self.bound(cycles.max));
            }
        }
    }

    /// The bound for a measured value.
    fn bound(&self, measured: u64) -> Item {
        // The headroom on its own: a sum that is rounded up to the next integer by its last bit would be a byte too large.
        value(measured as i64 + (measured as f64 * self.headroom).ceil() as i64)
    }
}

fn table<'d>(parent: &'d mut Table, key: &str) -> &'d mut Table {
    let item = parent.entry(key).or_insert_with(|| Item::Table(Table::new()));
    if !item.is_table() {
        *item = std::mem::take(item).into_table().map_or_else(|_| Item::Table(Table::new()), Item::Table);
    }
    item.as_table_mut().expect("made a table above")
}

/// Replaces a value and keeps the spaces and comments around it.
fn set(table: &mut Table, key: &str, mut new: Item) {
    let Some(old) = table.get_mut(key) else {
        table.insert(key, new);
        return;
    };
    if let (Some(old), Some(new)) = (old.as_value(), new.as_value_mut()) {
        *new.decor_mut() = old.decor().clone();
    }
    *old = new;
}

#[cfg(test)]
mod tests {
    use super::super::tests::{FILE, budget, measurement};
    use super::*;
    use crate::firmware::Program;

    #[test]
    fn overwriting_changes_the_bounds_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("budget.toml");
        std::fs::write(&file, FILE).unwrap();
        Budget::read_file("b", &file).unwrap().overwrite(&measurement()).unwrap();
        let written = std::fs::read_to_string(&file).unwrap();
        for line in [
            "# A board.",
            "compiler = \"rustc 2\"",
            "headroom = 0.1 # a tenth",
            "cycles = 1100 # by the model",
            "instructions = 44",
            "flash = 1100",
            "stack = 330",
            "thread_stack = 110",
            "interrupt_stack = 220",
            "at_least = 300 # times",
            "instructions = 13588",
        ] {
            assert!(written.lines().any(|l| l == line), "{line}: {written}");
        }
        let budget = Budget::read_file("b", &file).unwrap();
        assert_eq!(budget.blocks["observer"].cycles, Some(88));
        assert_eq!(budget.literal_mesh.as_ref().and_then(|mesh| mesh.period.cycles), Some(27_175));
        assert!(measurement().figures(&budget).iter().all(|f| f.holds));
        budget.overwrite(&measurement()).unwrap();
        assert_eq!(std::fs::read_to_string(&file).unwrap(), written);
    }

    #[test]
    fn the_image_that_serves_the_link_has_bounds_and_names_of_its_own() {
        assert_eq!(budget().of(Program::Served), None);
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("budget.toml");
        std::fs::write(&file, FILE.to_owned() + "\n[image]\nflash = 10\n\n[served_image]\nflash = 20\n")
            .unwrap();
        let served = Budget::read_file("b", &file).unwrap().of(Program::Served).unwrap();
        let figures = Measurement { counts: Vec::new(), ..measurement() }.figures(&served);
        let flash = &figures[0];
        assert_eq!((flash.name.as_str(), flash.bound), ("budget.b.served_flash", Some(20.0)));
        assert!(figures.iter().any(|figure| figure.name == "budget.b.served_panics"));
        served.overwrite(&measurement()).unwrap();
        let budget = Budget::read_file("b", &file).unwrap();
        assert_eq!(
            (budget.image.flash, budget.served_image.and_then(|image| image.flash)),
            (Some(10), Some(1100))
        );
    }

    #[test]
    fn a_fixed_bound_is_never_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("budget.toml");
        std::fs::write(&file, FILE.replace("cycles = 10 # by the model", "fixed = true\ncycles = 10"))
            .unwrap();
        Budget::read_file("b", &file).unwrap().overwrite(&measurement()).unwrap();
        let written = std::fs::read_to_string(&file).unwrap();
        assert!(written.contains("cycles = 10\n") && written.contains("instructions = 44\n"), "{written}");
        assert!(!written.contains("cycles = 1100"), "{written}");
    }
}
