//! `Debug`'s pretty text, one value a line, as people write it: a block that fits on a line is one.
//!
//! Dense text of an expression: an array of equal elements is written as `[0.0; 16]`.

/// Longest line (characters).
const WIDTH: usize = 110;

/// `pretty`, as `{:#?}` gives it, in as few lines as fit.
pub fn dense(pretty: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    for line in pretty.lines() {
        lines.push(line.to_owned());
        if line.trim_start().starts_with(['}', ']', ')']) {
            close(&mut lines);
        }
    }
    lines.join("\n")
}

/// The last line ends a block: makes it one line, when it fits.
fn close(lines: &mut Vec<String>) {
    let Some((end, before)) = lines.split_last() else { return };
    let Some(start) = before.iter().rposition(|line| indentation(line) == indentation(end)) else { return };
    let joined = joined(&before[start], &before[start + 1..], end.trim_start());
    if joined.len() <= WIDTH {
        lines.truncate(start);
        lines.push(joined);
    }
}

fn indentation(line: &str) -> usize {
    line.len() - line.trim_start().len()
}

/// A block on one line.
fn joined(start: &str, items: &[String], end: &str) -> String {
    let items: Vec<_> = items.iter().map(|item| item.trim().trim_end_matches(',')).collect();
    let inner = match items.as_slice() {
        [first, second, ..] if start.ends_with('[') && items.iter().all(|item| item == second) => {
            format!("{first}; {}", items.len())
        }
        _ => items.join(", "),
    };
    if start.ends_with('{') { format!("{start} {inner} {end}") } else { format!("{start}{inner}{end}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug)]
    #[expect(dead_code, reason = "read by Debug alone")]
    struct Block {
        name: Option<f32>,
        rows: [[f32; 3]; 2],
        last: [f32; 2],
    }

    #[test]
    fn what_fits_is_one_line_and_what_repeats_is_counted() {
        let block = Block { name: Some(1.5), rows: [[0.0; 3]; 2], last: [1.0, 2.0] };
        assert_eq!(
            dense(&format!("{block:#?}")),
            "Block { name: Some(1.5), rows: [[0.0; 3]; 2], last: [1.0, 2.0] }"
        );
    }

    #[test]
    fn what_does_not_fit_stays_a_value_a_line() {
        let pretty = format!("{:#?}", [(0..40).collect::<Vec<_>>(), vec![7]]);
        let lines: Vec<_> = pretty.lines().collect();
        let expected = [&lines[..43], &["    [7],", "]"]].concat().join("\n");
        assert_eq!(dense(&pretty), expected);
    }
}
