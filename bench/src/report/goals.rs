//! What must be reached, and whether it was.

use super::text;
use serde::Serialize;

/// A ratio with its bound.
#[derive(Debug, Clone, Serialize)]
pub struct Goal {
    pub what: String,
    pub bound: Bound,
    /// What was found, and of what; none where nothing was counted.
    pub values: Vec<(String, Option<f64>)>,
}

/// A bound.
#[derive(Debug, Clone, Copy, Serialize)]
pub enum Bound {
    AtLeast(f64),
    AtMost(f64),
}

impl Bound {
    /// `reached` or `missed`.
    pub fn verdict(self, value: Option<f64>) -> &'static str {
        match (self, value) {
            (Self::AtLeast(bound), Some(value)) if value >= bound => "reached",
            (Self::AtMost(bound), Some(value)) if value <= bound => "reached",
            (_, Some(_)) => "missed",
            (_, None) => "not counted",
        }
    }
}

/// A line for each value, in Markdown.
pub fn table(goals: &[Goal]) -> String {
    let rows = goals.iter().flat_map(|goal| {
        goal.values.iter().map(|&(ref name, value)| {
            let (sign, bound) = match goal.bound {
                Bound::AtLeast(bound) => ("≥", bound),
                Bound::AtMost(bound) => ("≤", bound),
            };
            let found = value.map_or("–".into(), |value| format!("{value:.2}"));
            let verdict = goal.bound.verdict(value).to_owned();
            vec![goal.what.clone(), name.clone(), format!("{sign} {bound}"), found, verdict]
        })
    });
    text::table(&["ratio", "of", "bound", "found", ""], &rows.collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts() {
        for (bound, value, expected) in [
            (Bound::AtLeast(1.5), Some(1.5), "reached"),
            (Bound::AtLeast(1.5), Some(1.49), "missed"),
            (Bound::AtMost(0.4), Some(0.4), "reached"),
            (Bound::AtMost(0.4), Some(0.41), "missed"),
            (Bound::AtMost(0.4), Some(f64::NAN), "missed"),
            (Bound::AtMost(0.4), None, "not counted"),
        ] {
            assert_eq!(bound.verdict(value), expected, "{bound:?} {value:?}");
        }
    }
}
