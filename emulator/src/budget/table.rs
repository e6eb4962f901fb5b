//! The budget as a table for people.

use std::fmt::Write as _;
use std::iter::successors;

use comfy_table::{CellAlignment, Table, presets};
use strainwave::compensator::schedule::Slot;
use strainwave_desktop::Figure;

use super::{Budget, ElementaryFunction, Measurement};
use crate::any_input::{AnyInput, Step};
use crate::artifact::CONTROL_STEP;
use crate::counting::cycle_table::CORE;

impl Measurement {
    /// A table for people.
    pub fn table(&self, budget: &Budget) -> String {
        print(self, budget)
    }
}

/// Block by block, then the image, then what must not be in it.
fn print(measured: &Measurement, budget: &Budget) -> String {
    let mut text = header(measured, budget);
    let figures = measured.figures(budget);
    if !measured.counts.is_empty() {
        let _ = writeln!(text, "{}\n", counts(measured, budget, &figures));
    }
    let _ = writeln!(text, "{}", image(budget, &figures));
    text += &missed_targets(measured, budget);
    text.extend(measured.any_input.as_ref().map(|found| any_input(found, budget, &figures)));
    if !measured.elementary_functions.is_empty() {
        let _ = writeln!(text, "{}", elementary_functions(&measured.elementary_functions));
    }
    for (name, found) in measured.proofs() {
        for violation in found {
            let _ = writeln!(text, "{name}: {violation}");
        }
    }
    text
}

fn header(measured: &Measurement, budget: &Budget) -> String {
    let mut text = format!("{}, built with {}", budget.board, measured.compiler);
    if measured.compiler != budget.compiler {
        let _ = write!(text, " (bounds are for {})", budget.compiler);
    }
    text += if measured.counts.is_empty() {
        "; judged from the image, not run\n"
    } else if measured.core != CORE {
        "\nInstructions are exact. Cycles are not shown: the model of them is of another core.\n"
    } else {
        "\nInstructions are exact. Cycles are a model of the Cortex-M4F (emulator/src/counting/cycle_table.rs):\n\
         pessimistic end, zero wait states, emulated, not silicon.\n"
    };
    text
}

fn empty() -> Table {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    table
}

fn align_numbers(table: &mut Table) {
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
}

fn counts(measured: &Measurement, budget: &Budget, figures: &[Figure]) -> Table {
    let mut table = empty();
    table.set_header([
        "block",
        "calls",
        "instr. max",
        "mean",
        "bound",
        "cycles max",
        "mean",
        "bound",
        "any path",
        "holds",
    ]);
    let none = || "-".to_owned();
    for (name, counts) in &measured.counts {
        let find = |what: &str| {
            let full = format!("budget.{}.{name}.{what}", budget.board);
            figures.iter().find(|f| f.name == full)
        };
        let (instructions, cycles) = (find("instructions_max"), find("cycles_max"));
        let holds = [instructions, cycles].into_iter().flatten().all(|f| f.holds);
        table.add_row([
            name.clone(),
            counts.calls.to_string(),
            counts.instructions.max.to_string(),
            format!("{:.0}", counts.instructions.mean),
            bound(instructions),
            counts.cycles.map_or_else(none, |cycles| cycles.max.to_string()),
            counts.cycles.map_or_else(none, |cycles| format!("{:.0}", cycles.mean)),
            bound(cycles),
            measured.any_path.get(name).map_or_else(none, u64::to_string),
            yes(holds),
        ]);
    }
    align_numbers(&mut table);
    table
}

/// The rows of the control step on any input, and which step was the most costly.
fn any_input(found: &AnyInput, budget: &Budget, figures: &[Figure]) -> String {
    let prefix = format!("budget.{}.{CONTROL_STEP}.any_input.", budget.board);
    let table = rows("any input", &prefix, figures);
    let Step { cycles, seed, variations, number, .. } = &found.worst;
    let mut text = format!(
        "{table}\nmost costly: {cycles} cycles in step {number} of sequence {seed}, varied {variations} times\n"
    );
    if let Some(cycles) = found.from_flash {
        let _ = writeln!(
            text,
            "{cycles} with the wait states of an STM32F405's flash, by a model of its accelerator"
        );
    }
    let slots = found.slots.iter().zip(successors(Some(Slot::default()), |slot| Some(slot.next())));
    let slots: Vec<_> = slots.map(|(cycles, slot)| format!("{slot:?} {cycles}")).collect();
    let _ = writeln!(text, "most of each slot: {}", slots.join(", "));
    for (function, cycles) in &found.functions {
        let _ = writeln!(text, "{cycles:>8} in {function}");
    }
    let target = budget.any_input.and_then(|bounds| bounds.target);
    if let Some(target) = target.filter(|target| cycles > target) {
        let _ = writeln!(text, "any_input.cycles is {cycles}: target {target}, missed");
    }
    for (name, steps) in &found.unbounded {
        let _ = writeln!(text, "unbounded: {name} in {steps} steps");
    }
    text
}

/// A row each; errors of the square root and of 1 - e^-x are relative, those of sine and cosine absolute.
fn elementary_functions(functions: &[ElementaryFunction]) -> Table {
    let mut table = empty();
    table.set_header([
        "elementary function",
        "library",
        "cycles max",
        "mean",
        "code",
        "table",
        "largest error",
    ]);
    for function in functions {
        let cycles = function.counts.cycles;
        table.add_row([
            function.name.to_owned(),
            function.origin.to_owned(),
            cycles.map_or_else(|| "-".to_owned(), |cycles| cycles.max.to_string()),
            cycles.map_or_else(|| "-".to_owned(), |cycles| format!("{:.0}", cycles.mean)),
            function.code.to_string(),
            function.table.to_string(),
            format!("{:.1e}", function.error),
        ]);
    }
    align_numbers(&mut table);
    table
}

fn image(budget: &Budget, figures: &[Figure]) -> Table {
    // The others' figures have more segments.
    let of_image = figures.iter().filter(|figure| figure.name.matches('.').count() == 2);
    rows("image", &format!("budget.{}.", budget.board), of_image)
}

/// A line for each size of the image that is above its target.
fn missed_targets(measured: &Measurement, budget: &Budget) -> String {
    let sizes = measured.image_sizes().named().into_iter().zip(budget.image_target.named());
    let missed = sizes.filter_map(|((name, size), (_, target))| Some((name, size?, target?)));
    missed
        .filter(|(_, size, target)| size > target)
        .map(|(name, size, target)| format!("{name} is {size}: target {target}, missed\n"))
        .collect()
}

/// The figures whose names begin with `prefix`, a row each, named by the rest.
fn rows<'f>(header: &str, prefix: &str, figures: impl IntoIterator<Item = &'f Figure>) -> Table {
    let mut table = empty();
    table.set_header([header, "value", "unit", "bound", "holds"]);
    for figure in figures {
        let Some(name) = figure.name.strip_prefix(prefix) else { continue };
        let value = figure.value.to_string();
        let unit = figure.unit.clone();
        table.add_row([name.to_owned(), value, unit, bound(Some(figure)), yes(figure.holds)]);
    }
    align_numbers(&mut table);
    table
}

fn bound(figure: Option<&Figure>) -> String {
    figure.map_or_else(|| "-".to_owned(), |f| f.bound_text(|bound| bound.to_string()))
}

fn yes(holds: bool) -> String {
    if holds { "yes" } else { "NO" }.to_owned()
}

#[cfg(test)]
mod tests {
    use super::super::ImageSizes;
    use super::super::tests::{budget, measurement};
    use super::*;
    use crate::any_input::SLOTS;
    use crate::artifact::Violation;

    #[test]
    fn the_header_says_what_the_figures_are() {
        let text = print(&measurement(), &budget());
        for part in
            ["rustc 2", "bounds are for rustc 1", "pessimistic end", "zero wait states", "not silicon"]
        {
            assert!(text.contains(part), "{part}: {text}");
        }
        let other = Measurement { core: "Cortex-M7".to_owned(), ..measurement() };
        assert!(print(&other, &budget()).contains("Cycles are not shown"));
        let not_run = Measurement { counts: Vec::new(), ..measurement() };
        assert!(print(&not_run, &budget()).contains("not run"));
    }

    #[test]
    fn a_row_shows_what_is_exceeded() {
        let text = print(&measurement(), &budget());
        let row: Vec<&str> = text
            .lines()
            .find(|l| l.trim_start().starts_with("control_step"))
            .unwrap()
            .split_whitespace()
            .collect();
        assert_eq!(row, ["control_step", "3", "500", "2", "-", "1000", "2", "10", "-", "NO"]);
    }

    #[test]
    fn a_floor_is_told_from_a_ceiling() {
        let text = print(&measurement(), &budget());
        let row = text.lines().find(|l| l.trim_start().starts_with("literal_over_reduced")).unwrap();
        let cells: Vec<&str> = row.split_whitespace().collect();
        assert_eq!(cells, ["literal_over_reduced", "308", "1", ">=", "300", "yes"]);
    }

    #[test]
    fn the_most_costly_step_is_named() {
        let worst = Step { cycles: 1800, seed: 7, variations: 2, number: 31, ..Step::default() };
        let functions = vec![("a::plan".to_owned(), 1000)];
        let unbounded = [("torsion", 4)].into();
        let any_input = Some(AnyInput {
            steps: 99,
            unlike_host: 0,
            unbounded,
            worst,
            from_flash: Some(2100),
            functions,
            slots: [1800; SLOTS],
        });
        let text = print(&Measurement { any_input, ..measurement() }, &budget());
        assert!(text.contains("most costly: 1800 cycles in step 31 of sequence 7, varied 2 times"), "{text}");
        assert!(text.contains("1000 in a::plan") && text.contains("unbounded: torsion in 4 steps"), "{text}");
        let row =
            |name: &str| text.lines().map(str::trim).find(|line| line.starts_with(name)).unwrap().to_owned();
        assert!(text.contains("2100 with the wait states of an STM32F405's flash"), "{text}");
        assert!(row("cycles").ends_with("yes") && row("steps_unbounded").ends_with("NO"), "{text}");
    }

    #[test]
    fn a_missed_target_of_the_image_is_told() {
        let image_target = ImageSizes { flash: Some(999), ram: Some(200), ..ImageSizes::default() };
        let text = print(&measurement(), &Budget { image_target, ..budget() });
        assert!(text.contains("flash is 1000: target 999, missed\n") && !text.contains("ram is"), "{text}");
    }

    #[test]
    fn libraries_stand_beside_each_other() {
        let counts = measurement().counts[0].1;
        let function = ElementaryFunction {
            name: "sine_cosine",
            origin: "ours",
            counts,
            code: 80,
            table: 1024,
            error: 8e-8,
        };
        let measured = Measurement { elementary_functions: vec![function], ..measurement() };
        let text = print(&measured, &budget());
        let row = text.lines().find(|line| line.trim_start().starts_with("sine_cosine")).unwrap();
        let cells: Vec<&str> = row.split_whitespace().collect();
        assert_eq!(cells, ["sine_cosine", "ours", "1000", "2", "80", "1024", "8.0e-8"]);
        let figures = measured.figures(&budget());
        let last = &figures[figures.len() - 1];
        assert_eq!((last.name.as_str(), last.bound), ("budget.b.elementary.sine_cosine.ours.error", None));
    }

    #[test]
    fn a_failed_proof_shows_its_path() {
        let path = Some(vec!["step".to_owned(), "__aeabi_dmul".to_owned()]);
        let doubles = vec![Violation { what: "__aeabi_dmul".to_owned(), path }];
        let text = print(&Measurement { doubles, ..measurement() }, &budget());
        assert!(text.contains("doubles: __aeabi_dmul: step -> __aeabi_dmul"), "{text}");
    }
}
