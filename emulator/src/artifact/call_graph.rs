//! Which function calls which, and how deep the stack is at that moment.

use std::collections::VecDeque;

use super::flow::{IndirectCall, Summary, summarise};
use super::{Error, Image};

/// One function of the graph.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Node {
    /// Its path.
    pub name: String,
    /// Summary of its code.
    pub summary: Summary,
}

/// The functions of an image, in the order of [`Image::functions`], and their calls.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CallGraph {
    nodes: Vec<Node>,
}

impl CallGraph {
    /// A graph from its nodes.
    pub fn new(nodes: Vec<Node>) -> Self {
        Self { nodes }
    }

    /// Follows every function that `roots` reach; `indirect` says where calls through pointers can go.
    ///
    /// # Errors
    /// [`Error::Indirect`] or [`Error::StackPointer`].
    pub fn of(image: &Image, roots: &[usize], indirect: &[IndirectCall]) -> Result<Self, Error> {
        let names = image.functions().iter().map(|f| f.name().to_owned());
        let mut graph = Self::new(names.map(|name| Node { name, ..Node::default() }).collect());
        let mut seen = vec![false; graph.nodes.len()];
        let mut waiting = roots.to_vec();
        while let Some(function) = waiting.pop() {
            if !std::mem::replace(&mut seen[function], true) {
                graph.nodes[function].summary = summarise(image, function, indirect)?;
                waiting.extend(graph.callees(function));
            }
        }
        Ok(graph)
    }

    /// The functions.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Callees of `function`.
    pub fn callees(&self, function: usize) -> impl Iterator<Item = usize> {
        self.nodes[function].summary.calls.iter().map(|call| call.callee)
    }

    /// The shortest way from one of `roots` to each function that they reach, as the index it comes from.
    fn reach(&self, roots: &[usize]) -> Vec<Option<usize>> {
        let mut from = vec![None; self.nodes.len()];
        let mut waiting: VecDeque<usize> = roots.iter().copied().collect();
        for root in roots {
            from[*root] = Some(*root);
        }
        while let Some(function) = waiting.pop_front() {
            for callee in self.callees(function) {
                if from[callee].is_none() {
                    from[callee] = Some(function);
                    waiting.push_back(callee);
                }
            }
        }
        from
    }

    /// Every function that `roots` reach, themselves included.
    pub fn reachable(&self, roots: &[usize]) -> Vec<usize> {
        let from = self.reach(roots);
        (0..self.nodes.len()).filter(|k| from[*k].is_some()).collect()
    }

    /// The names on the shortest way from one of `roots` to `function`; `None` when there is none.
    pub fn path(&self, roots: &[usize], function: usize) -> Option<Vec<String>> {
        let from = self.reach(roots);
        let mut way = vec![function];
        let mut here = function;
        while from[here]? != here {
            here = from[here]?;
            way.push(here);
        }
        Some(way.into_iter().rev().map(|k| self.nodes[k].name.clone()).collect())
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::flow::Call;
    use super::*;

    /// Name, deepest own stack, and calls as (callee, depth at the call).
    type Function<'a> = (&'a str, u32, &'a [(usize, u32)]);

    pub fn graph(functions: &[Function]) -> CallGraph {
        let node = |(name, depth, calls): &Function| Node {
            name: (*name).to_owned(),
            summary: Summary {
                depth: *depth,
                calls: calls.iter().map(|(callee, depth)| Call { callee: *callee, depth: *depth }).collect(),
                doubles: None,
            },
        };
        CallGraph::new(functions.iter().map(node).collect())
    }

    #[test]
    fn the_path_is_the_shortest() {
        let graph = graph(&[("a", 0, &[(1, 0), (2, 0)]), ("b", 0, &[(2, 0)]), ("c", 0, &[]), ("d", 0, &[])]);
        assert_eq!(graph.path(&[0], 2).unwrap(), ["a", "c"]);
        assert_eq!(graph.path(&[0], 0).unwrap(), ["a"]);
        assert_eq!(graph.path(&[0], 3), None);
        assert_eq!(graph.reachable(&[1]), [1, 2]);
    }
}
