//! What must be reached.

use super::Report;
use crate::report::goals::{Bound, Goal};

/// Of the sort stage, and of reordering before a method.
pub fn all(report: &Report) -> Vec<Goal> {
    let sorting = &report.sorting;
    let largest = sorting.scans.last().map(|scan| scan.number);
    let random = || sorting.sorts.iter().filter(|sort| sort.keys == "random");
    let named = |sort: &crate::sort::keys::SortTimes| format!("{} keys", sort.number);
    vec![
        Goal {
            what: "exclusive scan over a copy of as many bytes".into(),
            bound: Bound::AtMost(1.3),
            values: sorting
                .scans
                .iter()
                .filter(|scan| Some(scan.number) == largest)
                .map(|scan| (format!("{} elements", scan.number), Some(scan.exclusive / scan.copy)))
                .collect(),
        },
        Goal {
            what: "radix sort over the best other, random keys".into(),
            bound: Bound::AtMost(1.2),
            values: random()
                .map(|sort| (named(sort), Some(sort.radix / sort.rdst.min(sort.voracious).min(sort.std))))
                .collect(),
        },
        Goal {
            what: "four copies of keys and values over radix sort, random keys".into(),
            bound: Bound::AtLeast(0.5),
            values: random().map(|sort| (named(sort), Some(4.0 * sort.copy / sort.radix))).collect(),
        },
        Goal {
            what: "radix sort over compression, sort and decompression, soft shadows".into(),
            bound: Bound::AtLeast(1.8),
            values: sorting
                .sorts
                .iter()
                .filter(|sort| sort.keys != "random")
                .map(|sort| (format!("{}: {} keys", sort.keys, sort.number), Some(sort.radix / sort.compressed)))
                .collect(),
        },
        Goal {
            what: "wide over wide with rays reordered, the sort charged, diffuse bounce 2".into(),
            bound: Bound::AtLeast(1.0),
            values: sorting
                .reorders
                .iter()
                .filter(|times| times.method == "wide")
                .map(|times| {
                    let of = format!("{}, {} batches, {}, cell {:.4}", times.scene, times.rays, times.by, times.cell);
                    (of, Some(times.unsorted / times.charged()))
                })
                .collect(),
        },
    ]
}
