//! Counts of the plugin.

use std::str::FromStr;

/// Smallest, largest and mean over the calls of a function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Of the cheapest call.
    pub min: u64,
    /// Of the most costly call.
    pub max: u64,
    /// Over all calls.
    pub mean: f64,
}

/// Counts of one tracked function, its callees included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counts {
    /// Calls.
    pub calls: u64,
    /// Instructions of a call.
    pub instructions: Spread,
    /// Cycles of a call, by the model of [`super::cycle_table`]; `None` of another core than the model's.
    pub cycles: Option<Spread>,
}

/// Counts of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// One for each tracked function, in the plan's order; `None` when it was never called.
    pub counts: Vec<Option<Counts>>,
    /// Every instruction that the guest executed.
    pub executed: u64,
    /// Cycles of every call of the first tracked function, where they were asked for.
    pub calls: Vec<u64>,
    /// Addresses of the instructions of one of its calls, where they were asked for.
    pub path: Vec<u32>,
    /// Anomaly that invalidates the counts, in the plugin's words.
    pub anomaly: Option<String>,
}

impl Outcome {
    /// The same without cycles: the model is not of the core.
    pub fn without_cycles(mut self) -> Self {
        self.calls.clear();
        self.counts.iter_mut().flatten().for_each(|counts| counts.cycles = None);
        self
    }

    /// Two runs of one image as one; single calls are kept of the first alone.
    pub fn and(self, other: &Self) -> Self {
        let pairs = self.counts.into_iter().zip(&other.counts);
        Self {
            counts: pairs.map(|(a, b)| merge(a.into_iter().chain(*b))).collect(),
            executed: self.executed + other.executed,
            calls: self.calls,
            path: self.path,
            anomaly: self.anomaly.or_else(|| other.anomaly.clone()),
        }
    }
}

/// Reads the plugin's result.
pub fn parse(text: &str) -> Option<Outcome> {
    let mut outcome =
        Outcome { counts: Vec::new(), executed: 0, calls: Vec::new(), path: Vec::new(), anomaly: None };
    let mut complete = false;
    for line in text.lines() {
        match line.split_once(' ')? {
            ("executed", count) => {
                outcome.executed = count.parse().ok()?;
                complete = true;
            }
            ("calls", cycles) => outcome.calls = numbers(cycles)?,
            ("path", addresses) => outcome.path = numbers(addresses)?,
            ("anomaly", what) => outcome.anomaly = Some(what.to_owned()),
            _ => outcome.counts.push(counts(line)?),
        }
    }
    complete.then_some(outcome)
}

fn numbers<T: FromStr>(words: &str) -> Option<Vec<T>> {
    words.split(' ').map(|word| word.parse().ok()).collect()
}

/// `CALLS INSTRUCTIONS_MIN MAX SUM CYCLES_MIN MAX SUM`.
fn counts(line: &str) -> Option<Option<Counts>> {
    let numbers: Vec<u64> = numbers(line)?;
    let [calls, i_min, i_max, i_sum, c_min, c_max, c_sum] = numbers[..] else { return None };
    let spread = |min, max, sum: u64| Spread { min, max, mean: sum as f64 / calls as f64 };
    let (instructions, cycles) = (spread(i_min, i_max, i_sum), spread(c_min, c_max, c_sum));
    Some((calls > 0).then_some(Counts { calls, instructions, cycles: Some(cycles) }))
}

/// One count for functions that share a row of the budget: the most costly call of any of them.
pub fn merge(counts: impl IntoIterator<Item = Counts>) -> Option<Counts> {
    counts.into_iter().reduce(|a, b| {
        let calls = a.calls + b.calls;
        let spread = |x: Spread, y: Spread| Spread {
            min: x.min.min(y.min),
            max: x.max.max(y.max),
            mean: (x.mean * a.calls as f64 + y.mean * b.calls as f64) / calls as f64,
        };
        Counts {
            calls,
            instructions: spread(a.instructions, b.instructions),
            cycles: a.cycles.zip(b.cycles).map(|(a, b)| spread(a, b)),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_result_is_read_back() {
        let outcome = parse(
            "2 3 5 8 10 20 30\n0 18446744073709551615 0 0 18446744073709551615 0 0\nexecuted 99\ncalls 10 20\npath 16 18\n",
        );
        let outcome = outcome.unwrap();
        let counts = outcome.counts[0].unwrap();
        assert_eq!((counts.calls, counts.instructions), (2, Spread { min: 3, max: 5, mean: 4.0 }));
        assert_eq!(counts.cycles, Some(Spread { min: 10, max: 20, mean: 15.0 }));
        assert_eq!((&outcome.calls[..], &outcome.path[..]), (&[10, 20][..], &[16, 18][..]));
        assert_eq!((outcome.counts[1], outcome.executed, outcome.anomaly), (None, 99, None));
    }

    #[test]
    fn two_runs_make_one() {
        let first = parse("1 3 3 3 10 10 10\n0 9 0 0 9 0 0\nexecuted 5\n").unwrap();
        let second = parse("1 5 5 5 20 20 20\n0 9 0 0 9 0 0\nexecuted 7\nanomaly jump 0x2 0x4\n").unwrap();
        let both = first.and(&second);
        let counts = both.counts[0].unwrap();
        assert_eq!((counts.calls, counts.instructions), (2, Spread { min: 3, max: 5, mean: 4.0 }));
        assert_eq!(
            (both.counts[1], both.executed, both.anomaly.as_deref()),
            (None, 12, Some("jump 0x2 0x4"))
        );
    }

    #[test]
    fn without_cycles_the_instructions_stay() {
        let counts = parse("1 3 3 3 10 10 10\nexecuted 5\ncalls 10\n").unwrap().without_cycles();
        let first = counts.counts[0].unwrap();
        assert_eq!((first.instructions.max, first.cycles, counts.calls.len()), (3, None, 0));
    }

    #[test]
    fn half_a_result_is_none() {
        assert_eq!(parse("2 3 5 8 10 20 30\n"), None);
        assert_eq!(parse("2 3 5\nexecuted 4"), None);
    }

    #[test]
    fn functions_of_one_row_share_their_extremes() {
        let one = |calls, max: u64| Counts {
            calls,
            instructions: Spread { min: 1, max, mean: max as f64 },
            cycles: Some(Spread { min: 2, max: 2 * max, mean: 2.0 * max as f64 }),
        };
        let merged = merge([one(1, 10), one(3, 30)]).unwrap();
        assert_eq!(
            (merged.calls, merged.instructions.max, merged.cycles.map(|c| c.mean)),
            (4, 30, Some(50.0))
        );
    }
}
