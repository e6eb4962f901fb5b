//! Dense curves thinned to what a picture can show.
//!
//! A run of consecutive points within one pixel column becomes its first, lowest, highest and last
//! point, in their order. Runs follow the curve, not the axis: a loop keeps both of its branches.

/// Points whose vertical extremes, column by column, are those of `points`. `column` is the width of
/// a pixel column in units of x.
pub(super) fn thin(points: impl Iterator<Item = (f64, f64)>, column: f64) -> Vec<(f64, f64)> {
    let mut kept = Vec::new();
    let mut run: Option<Run> = None;
    for point in points {
        let here = (point.0 / column).floor();
        match &mut run {
            Some(run) if run.column == here => run.add(point),
            _ => {
                let finished = run.replace(Run::new(here, point));
                finished.into_iter().for_each(|run| run.write(&mut kept));
            }
        }
    }
    run.into_iter().for_each(|run| run.write(&mut kept));
    kept
}

/// Consecutive points in one column, numbered from 0.
struct Run {
    column: f64,
    count: usize,
    first: (f64, f64),
    lowest: (usize, (f64, f64)),
    highest: (usize, (f64, f64)),
    last: (f64, f64),
}

impl Run {
    fn new(column: f64, point: (f64, f64)) -> Self {
        Self { column, count: 1, first: point, lowest: (0, point), highest: (0, point), last: point }
    }

    fn add(&mut self, point: (f64, f64)) {
        if point.1 < self.lowest.1.1 {
            self.lowest = (self.count, point);
        }
        if point.1 > self.highest.1.1 {
            self.highest = (self.count, point);
        }
        self.last = point;
        self.count += 1;
    }

    fn write(self, kept: &mut Vec<(f64, f64)>) {
        let mut chosen = [(0, self.first), self.lowest, self.highest, (self.count - 1, self.last)];
        chosen.sort_by_key(|(index, _)| *index);
        let mut written = None;
        for (index, point) in chosen {
            if written != Some(index) {
                kept.push(point);
                written = Some(index);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spike_of_one_sample_survives() {
        let points =
            (0..100_000).map(|k| (f64::from(k), if k == 54_321 { 9.0 } else { (f64::from(k) * 0.3).sin() }));
        let kept = thin(points, 200.0);
        assert!(kept.len() <= 4 * 500);
        assert!(kept.contains(&(54_321.0, 9.0)));
        assert_eq!((kept[0].0, kept[kept.len() - 1].0), (0.0, 99_999.0));
        assert!(kept.windows(2).all(|pair| pair[0].0 < pair[1].0), "order is kept");
    }

    #[test]
    fn sparse_points_are_kept_as_they_are() {
        let points = [(0.0, 1.0), (5.0, 2.0), (10.0, -1.0), (3.0, 0.0)];
        assert_eq!(thin(points.into_iter(), 1.0), points);
    }

    #[test]
    fn both_branches_of_a_loop_stay() {
        let angle = |k: i32| f64::from(k) * std::f64::consts::TAU / 1e5;
        let kept = thin((0..100_000).map(|k| (angle(k).cos(), angle(k).sin())), 0.01);
        let at_middle: Vec<f64> = kept.iter().filter(|p| p.0.abs() < 0.01).map(|p| p.1).collect();
        assert!(at_middle.iter().any(|y| *y > 0.99) && at_middle.iter().any(|y| *y < -0.99));
        assert!(kept.len() < 2_000);
    }
}
