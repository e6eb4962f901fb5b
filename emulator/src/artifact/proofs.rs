//! Proofs of absence in the image: panics, an allocator, and double precision in the control step.
//!
//! The linker has dropped every function that nothing refers to, so a symbol that is not there cannot be
//! called. (A panic handler small enough to be inlined would leave no symbol. The boards' handlers call a
//! function that exists nowhere, so that an image from which a panic is reachable does not even link.)
//!
//! Double precision is allowed elsewhere (start-up converts parameters); in what the control step
//! reaches, neither the run-time library's software routines nor an f64 instruction, which a Cortex-M4F
//! does not have, may occur.

use std::fmt;

use super::call_graph::CallGraph;

/// A proof that failed: what was found, and how it is reached.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// The symbol or instruction.
    pub what: String,
    /// The calls that lead to it; `None` when no direct call does.
    pub path: Option<Vec<String>>,
}

impl fmt::Display for Violation {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.path {
            Some(path) => write!(out, "{}: {}", self.what, path.join(" -> ")),
            None => write!(out, "{}: linked, reached by no call from a handler", self.what),
        }
    }
}

/// The code and data of panics among `symbols`; paths are from `roots`, the handlers.
pub fn panics(symbols: &[String], graph: &CallGraph, roots: &[usize]) -> Vec<Violation> {
    symbols_that(is_panic, symbols, graph, roots)
}

/// The allocator's symbols among `symbols`; paths are from `roots`, the handlers.
pub fn allocators(symbols: &[String], graph: &CallGraph, roots: &[usize]) -> Vec<Violation> {
    symbols_that(is_allocator, symbols, graph, roots)
}

/// Double precision in what `roots`, the control step, reaches.
pub fn doubles(graph: &CallGraph, roots: &[usize]) -> Vec<Violation> {
    let reached = graph.reachable(roots).into_iter();
    reached
        .filter_map(|function| {
            let node = &graph.nodes()[function];
            let routine = is_double_routine(&node.name).then(|| node.name.clone());
            let what = routine.or_else(|| node.summary.doubles.clone())?;
            Some(Violation { what, path: graph.path(roots, function) })
        })
        .collect()
}

fn symbols_that(
    expected: fn(&str) -> bool,
    symbols: &[String],
    graph: &CallGraph,
    roots: &[usize],
) -> Vec<Violation> {
    let mut found: Vec<&String> = symbols.iter().filter(|s| expected(s)).collect();
    found.sort();
    found.dedup();
    let path = |name: &str| {
        let function = graph.nodes().iter().position(|n| n.name == name)?;
        graph.path(roots, function)
    };
    found.into_iter().map(|s| Violation { what: s.clone(), path: path(s) }).collect()
}

/// `core::panicking::*`, the panic handler, and the `#[cold]` functions that end in them.
fn is_panic(path: &str) -> bool {
    const COLD: [&str; 5] =
        ["unwrap_failed", "expect_failed", "rust_begin_unwind", "len_mismatch_fail", "slice_error_fail"];
    let last = path.rsplit("::").next().unwrap_or(path);
    let slice_index = last.starts_with("slice_") && last.ends_with("_fail");
    slice_index || path.split("::").any(|s| s.starts_with("panic") || COLD.contains(&s))
}

fn is_allocator(path: &str) -> bool {
    const C: [&str; 4] = ["malloc", "calloc", "realloc", "free"];
    const PREFIXES: [&str; 4] = ["__rust_alloc", "__rust_realloc", "__rust_dealloc", "__rg_"];
    let last = path.rsplit("::").next().unwrap_or(path);
    let rust = PREFIXES.iter().any(|p| last.starts_with(p)) || last.starts_with("__rdl_");
    rust || C.contains(&path) || path.starts_with("alloc::")
}

/// The names of the ARM run-time ABI (`__aeabi_dadd`, `__aeabi_i2d`) and of the compilers' run-time library
/// (`__adddf3`, `__extendsfdf2`); DF is GCC's name for double.
fn is_double_routine(path: &str) -> bool {
    let last = path.rsplit("::").next().unwrap_or(path);
    if let Some(name) = last.strip_prefix("__aeabi_") {
        const FROM_DOUBLE: [&str; 13] = [
            "dadd", "dsub", "drsub", "dmul", "ddiv", "dneg", "d2f", "d2h", "d2iz", "d2uiz", "d2lz", "d2ulz",
            "drem",
        ];
        const TO_DOUBLE: [&str; 5] = ["f2d", "i2d", "ui2d", "l2d", "ul2d"];
        return FROM_DOUBLE.contains(&name)
            || TO_DOUBLE.contains(&name)
            || name.starts_with("dcmp")
            || name.starts_with("cdcmp")
            || name.starts_with("cdrcmp");
    }
    last.strip_prefix("__").is_some_and(|name| name.contains("df"))
}

#[cfg(test)]
mod tests {
    use super::super::call_graph::tests::graph;
    use super::*;

    fn owned(names: &[&str]) -> Vec<String> {
        names.iter().map(|n| (*n).to_owned()).collect()
    }

    #[test]
    fn a_panic_is_found_with_the_calls_that_lead_to_it() {
        let graph = graph(&[
            ("SysTick", 0, &[(1, 0)]),
            ("a::step", 0, &[(2, 0)]),
            ("core::panicking::panic_bounds_check", 0, &[]),
        ]);
        let symbols =
            owned(&["a::step", "core::panicking::panic_bounds_check", "core::option::unwrap_failed"]);
        let found: Vec<String> = panics(&symbols, &graph, &[0]).iter().map(Violation::to_string).collect();
        assert_eq!(
            found,
            [
                "core::option::unwrap_failed: linked, reached by no call from a handler",
                "core::panicking::panic_bounds_check: SysTick -> a::step -> core::panicking::panic_bounds_check",
            ]
        );
    }

    #[test]
    fn panicking_code_is_known_by_its_names() {
        for name in [
            "core::panicking::panic_fmt",
            "__rustc::rust_begin_unwind",
            "core::slice::index::slice_index_fail",
            "core::result::unwrap_failed",
            "core::panicking::panic_const::panic_const_div_by_zero",
            "core::cell::panic_already_borrowed",
        ] {
            assert!(is_panic(name), "{name}");
        }
        for name in
            ["strainwave::compensator::Compensator::step", "SysTick", "core::slice::copy", "__aeabi_memcpy"]
        {
            assert!(!is_panic(name), "{name}");
        }
    }

    #[test]
    fn an_allocator_is_known_by_its_names() {
        for name in ["__rust_alloc", "__rustc::__rust_dealloc", "alloc::vec::Vec::push", "malloc"] {
            assert!(is_allocator(name), "{name}");
        }
        for name in ["a::free::step", "a::allocate"] {
            assert!(!is_allocator(name), "{name}");
        }
    }

    #[test]
    fn doubles_are_only_sought_in_what_the_control_step_reaches() {
        let functions = [
            ("step", 0, &[(1, 0)][..]),
            ("friction", 0, &[(2, 0)]),
            ("__aeabi_dmul", 0, &[]),
            ("init", 0, &[(2, 0)]),
        ];
        let found = doubles(&graph(&functions), &[0]);
        assert_eq!(found[0].to_string(), "__aeabi_dmul: step -> friction -> __aeabi_dmul");
        assert_eq!(doubles(&graph(&[("step", 0, &[]), functions[3], functions[2]]), &[0]), []);
    }

    #[test]
    fn double_routines_are_known_by_their_names() {
        for name in [
            "__aeabi_dadd",
            "__aeabi_f2d",
            "__aeabi_cdcmple",
            "__adddf3",
            "__extendsfdf2",
            "compiler_builtins::float::conv::__floatsidf",
        ] {
            assert!(is_double_routine(name), "{name}");
        }
        for name in
            ["__aeabi_fadd", "__aeabi_memcpy", "__udivmoddi4", "__aeabi_uldivmod", "__addsf3", "a::df::step"]
        {
            assert!(!is_double_routine(name), "{name}");
        }
    }

    #[test]
    fn an_f64_instruction_is_found_too() {
        let mut nodes = graph(&[("step", 0, &[])]).nodes().to_vec();
        nodes[0].summary.doubles = Some("vadd.f64 d0, d1, d2".to_owned());
        assert_eq!(doubles(&CallGraph::new(nodes), &[0])[0].to_string(), "vadd.f64 d0, d1, d2: step");
    }
}
