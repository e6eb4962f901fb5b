//! The deepest that the stack can get.
//!
//! In a thread, and in each handler, the stack is deepest along one chain of calls, each with the depth of
//! its caller's frame at the moment of the call. The bound is the deepest chain from the reset handler, and
//! on top of it, for every other handler in the vector table, the exception frame and its deepest chain:
//! an exception does not interrupt itself, so with any priorities each handler is on the stack once at
//! most. (Several unassigned vectors share one default handler, which does not return: it counts once.)
//!
//! Reference: ARMv7-M Architecture Reference Manual (DDI 0403), B1.5.6 and B1.5.7.

use super::call_graph::CallGraph;
use super::{Error, Image};

/// Words that the core pushes for an exception when the floating-point unit is in use: r0-r3, r12, lr, pc,
/// xPSR, s0-s15, FPSCR and one reserved; and one to align the stack pointer to 8 bytes.
pub const EXCEPTION_FRAME: u32 = 4 * (26 + 1);

/// One chain of calls and the stack it takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chain {
    /// Stack [byte].
    pub depth: u32,
    /// The functions on it, the outermost first.
    pub path: Vec<String>,
}

/// The deepest that the stack can get.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StackBound {
    /// Stack [byte].
    pub total: u32,
    /// The deepest chain of the program outside of handlers.
    pub thread: Chain,
    /// The deepest chain of every handler.
    pub handlers: Vec<Chain>,
}

impl StackBound {
    /// The bound for an image whose call graph is `graph`.
    ///
    /// # Errors
    /// [`Error::Recursion`].
    pub fn of(image: &Image, graph: &CallGraph) -> Result<Self, Error> {
        let vectors = image.vectors()?;
        Self::from_roots(graph, vectors[0], &vectors[1..])
    }

    /// The bound for a program that starts at `reset` and is interrupted by `handlers`.
    ///
    /// # Errors
    /// [`Error::Recursion`].
    pub fn from_roots(graph: &CallGraph, reset: usize, handlers: &[usize]) -> Result<Self, Error> {
        let thread = deepest(graph, reset)?;
        let handlers = handlers.iter().map(|h| deepest(graph, *h)).collect::<Result<Vec<_>, _>>()?;
        let interrupts: u32 = handlers.iter().map(|chain| EXCEPTION_FRAME + chain.depth).sum();
        Ok(Self { total: thread.depth + interrupts, thread, handlers })
    }
}

/// The deepest chain from `root`.
///
/// # Errors
/// [`Error::Recursion`].
pub fn deepest(graph: &CallGraph, root: usize) -> Result<Chain, Error> {
    let mut search = Search { graph, done: vec![None; graph.nodes().len()], open: Vec::new() };
    let depth = search.visit(root)?;
    let mut path = vec![graph.nodes()[root].name.clone()];
    let mut here = root;
    while let Some((_, Some(callee))) = search.done[here] {
        path.push(graph.nodes()[callee].name.clone());
        here = callee;
    }
    Ok(Chain { depth, path })
}

struct Search<'g> {
    graph: &'g CallGraph,
    /// Depth, and the callee that it is reached through.
    done: Vec<Option<(u32, Option<usize>)>>,
    open: Vec<usize>,
}

impl Search<'_> {
    fn visit(&mut self, function: usize) -> Result<u32, Error> {
        if let Some((depth, _)) = self.done[function] {
            return Ok(depth);
        }
        if let Some(start) = self.open.iter().position(|f| *f == function) {
            return Err(self.recursion(start));
        }
        self.open.push(function);
        let summary = &self.graph.nodes()[function].summary;
        let mut deepest = (summary.depth, None);
        for call in &summary.calls {
            let depth = call.depth + self.visit(call.callee)?;
            if depth > deepest.0 {
                deepest = (depth, Some(call.callee));
            }
        }
        self.open.pop();
        self.done[function] = Some(deepest);
        Ok(deepest.0)
    }

    fn recursion(&self, start: usize) -> Error {
        let circle = self.open[start..].iter().chain([&self.open[start]]);
        Error::Recursion { path: circle.map(|f| self.graph.nodes()[*f].name.clone()).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::call_graph::tests::graph;
    use super::*;

    #[test]
    fn the_deepest_chain_counts_each_frame_as_it_is_at_the_call() {
        // `main` is 100 deep itself, but only 8 when it calls.
        let graph = graph(&[
            ("main", 100, &[(1, 8), (2, 16)]),
            ("a", 90, &[]),
            ("b", 24, &[(3, 24)]),
            ("c", 64, &[]),
        ]);
        let chain = deepest(&graph, 0).unwrap();
        assert_eq!((chain.depth, chain.path), (16 + 24 + 64, vec!["main".into(), "b".into(), "c".into()]));
    }

    #[test]
    fn every_handler_can_be_on_top_of_the_thread() {
        let graph =
            graph(&[("reset", 40, &[]), ("tick", 16, &[(2, 16)]), ("step", 200, &[]), ("nmi", 8, &[])]);
        let bound = StackBound::from_roots(&graph, 0, &[1, 3]).unwrap();
        assert_eq!(bound.total, 40 + (108 + 216) + (108 + 8));
        assert_eq!(bound.handlers[0].path, ["tick", "step"]);
    }

    #[test]
    fn recursion_is_refused_by_name() {
        let graph = graph(&[("main", 0, &[(1, 0)]), ("a", 8, &[(2, 8)]), ("b", 8, &[(1, 8)])]);
        let error = deepest(&graph, 0).unwrap_err();
        assert_eq!(error.to_string(), "recursion: a -> b -> a, allowed: none");
    }
}
