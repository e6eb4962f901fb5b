//! State of every cell along an input, whatever the state before it.
//!
//! ```text
//! x_ij = up - down,   parts of the cell (i, j)        x = x at the last turn +-2*(part of the cell between the two)
//! ```
//!
//! Up are the relays that the input has passed since it was last below them, down those since it was last above. What no input has
//! switched yet is neither: relays that switch up beyond the highest place and down below the lowest one. Their state
//! before the first input is not known. The input comes to know all of it when it reaches either end of the range.
//!
//! The turns of the input that still matter are kept with the states there: the extremum that was reached last, then ever smaller
//! turns, each wiped out when the input passes it (I. Mayergoyz, "Mathematical models of hysteresis and their
//! applications", 2003, section 1.2).

use super::grid::{Grid, fraction};

/// States along an input.
#[derive(Clone, Debug)]
pub(super) struct History {
    grid: Grid,
    /// Highest and lowest place; `None` before the first input.
    ends: Option<[f64; 2]>,
    /// Places of the turns that matter with the states there; the last is the present one.
    turns: Vec<(f64, Vec<f64>)>,
}

impl History {
    pub fn new(grid: Grid) -> Self {
        Self { grid, ends: None, turns: Vec::new() }
    }

    /// Fraction of the triangle that is not known, and the distance of highest and lowest place (cells).
    pub fn unknown(&self) -> (f64, f64) {
        let [high, low] = self.ends.unwrap_or_default();
        let levels = self.grid.levels as f64;
        (2.0 * (levels - high) * low / (levels * levels), high - low)
    }

    /// x of every cell at the next input.
    pub fn step(&mut self, input: f64) -> &[f64] {
        let place = self.grid.place(input);
        let [high, low] = self.ends.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
        if place >= high || place <= low {
            self.ends = Some([high.max(place), low.min(place)]);
            self.turns.clear();
            self.turns.push((place, self.at_an_end(high.max(place), low.min(place), place)));
        } else {
            self.forget(place);
            let next = self.after_the_last_turn(place);
            self.turns.push((place, next));
        }
        self.turns.last().map_or(&[], |(_, states)| states)
    }

    /// States at the extremum that was reached last.
    fn at_an_end(&self, high: f64, low: f64, place: f64) -> Vec<f64> {
        let levels = self.grid.levels as f64;
        let state = |cell| {
            let (up, down) = (fraction(cell, high, 0.0), fraction(cell, levels, low));
            // Between the two all relays went with the last.
            let between = fraction(cell, high, low);
            up - down + if place == high { between } else { -between }
        };
        self.grid.cells().map(state).collect()
    }

    /// Removes the turns that are none any more, or are wiped out.
    fn forget(&mut self, place: f64) {
        while let [.., (before, _), (last, _)] = self.turns.as_slice() {
            if (last - before) * (place - last) >= 0.0 {
                self.turns.pop();
            } else if (before - last) * (place - before) >= 0.0 {
                self.turns.truncate(self.turns.len() - 2);
            } else {
                break;
            }
        }
    }

    fn after_the_last_turn(&self, place: f64) -> Vec<f64> {
        let Some((turn, states)) = self.turns.last() else { return Vec::new() };
        let (high, low) = (turn.max(place), turn.min(place));
        let sign = if place > *turn { 2.0 } else { -2.0 };
        let cells = self.grid.cells().zip(states);
        cells.map(|(cell, state)| state + sign * fraction(cell, high, low)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    const GRID: Grid = Grid { low: -1.0, high: 1.0, levels: 6 };

    /// Relays finer than the cells, each by itself: `None` until it has switched.
    struct Relays {
        fine: usize,
        states: Vec<Option<bool>>,
    }

    impl Relays {
        fn new(fine: usize) -> Self {
            Self { fine, states: vec![None; GRID.levels * GRID.levels * fine * fine] }
        }

        fn step(&mut self, place: f64) {
            let count = GRID.levels * self.fine;
            let at = |k: usize| (k as f64 + 0.5) / self.fine as f64;
            for alpha in 0..count {
                for beta in 0..=alpha {
                    let state = &mut self.states[alpha * count + beta];
                    if place > at(alpha) {
                        *state = Some(true);
                    } else if place < at(beta) {
                        *state = Some(false);
                    }
                }
            }
        }

        /// x of a cell that is not on the diagonal.
        fn of(&self, (i, j): (usize, usize)) -> f64 {
            let (fine, count) = (self.fine, GRID.levels * self.fine);
            let cells = (0..fine * fine).map(|k| (i * fine + k / fine) * count + j * fine + k % fine);
            let sum: f64 = cells.map(|k| self.states[k].map_or(0.0, |up| if up { 1.0 } else { -1.0 })).sum();
            sum / (fine * fine) as f64
        }
    }

    #[test]
    fn the_states_are_those_of_relays_from_an_unknown_start_too() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        for _ in 0..20 {
            let (mut history, mut relays) = (History::new(GRID), Relays::new(10));
            let reach = random.random_range(0.2..1.2);
            for _ in 0..60 {
                let input = reach * random.random_range(-1.0..1.0);
                let states = history.step(input).to_vec();
                relays.step(GRID.place(input));
                for (cell, state) in GRID.cells().zip(states).filter(|((i, j), _)| i != j) {
                    // A tenth of a cell at either edge of what switched.
                    assert!((state - relays.of(cell)).abs() < 0.41, "{cell:?} {state} {}", relays.of(cell));
                }
            }
        }
    }

    /// At fine relays' own edges both agree to rounding.
    #[test]
    fn the_states_are_exact_at_the_edges_of_relays() {
        let mut random = ChaCha8Rng::seed_from_u64(2);
        let (mut history, mut relays) = (History::new(GRID), Relays::new(4));
        for _ in 0..400 {
            let place: f64 = random.random_range(0..=24_u32).into();
            let input = place / 12.0 - 1.0;
            let states = history.step(input).to_vec();
            relays.step(place / 4.0);
            for (cell, state) in GRID.cells().zip(states).filter(|((i, j), _)| i != j) {
                assert!((state - relays.of(cell)).abs() < 1e-9, "{cell:?} {state} {}", relays.of(cell));
            }
        }
    }

    #[test]
    fn an_end_of_the_range_tells_the_whole_state() {
        let mut history = History::new(GRID);
        history.step(0.1);
        let (unknown, apart) = history.unknown();
        assert!((unknown - 0.495).abs() < 1e-12 && apart == 0.0, "{unknown}");
        history.step(0.4);
        assert!(history.unknown().0 > 0.0);
        assert!(history.step(1.0).iter().all(|state| (state - 1.0).abs() < 1e-12));
        assert_eq!(history.unknown().0, 0.0);
        assert!(history.step(-1.0).iter().all(|state| (state + 1.0).abs() < 1e-12));
    }

    #[test]
    fn what_is_wiped_out_leaves_nothing_behind() {
        let (mut one, mut other) = (History::new(GRID), History::new(GRID));
        for input in [-1.0, 0.8, -0.2, 0.3, 0.1, 0.25, 0.0, 0.5] {
            one.step(input);
        }
        for input in [-1.0, 0.8, -0.2] {
            other.step(input);
        }
        let other = other.step(0.5);
        assert!(one.turns.last().unwrap().1.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}
