//! The table of operations and the traits agree: a row for each method, no row without one.

use std::collections::BTreeSet;

const TRAITS: [&str; 6] = [
    include_str!("../src/vector/mask.rs"),
    include_str!("../src/vector/lanes.rs"),
    include_str!("../src/vector/float.rs"),
    include_str!("../src/vector/double.rs"),
    include_str!("../src/vector/integer.rs"),
    include_str!("../src/vector/narrow.rs"),
];
const TABLE: &str = include_str!("../src/vector/operations.md");

/// `Trait::method` of the public traits in a source file.
fn methods(source: &str) -> Vec<String> {
    let (mut methods, mut inside) = (Vec::new(), None);
    let name =
        |rest: &str| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or_default().to_owned();
    for line in source.lines() {
        if let Some(rest) = line.strip_prefix("pub trait ") {
            inside = Some(name(rest));
        } else if line == "}" {
            inside = None;
        } else if let (Some(of), Some(rest)) = (&inside, line.strip_prefix("    fn ")) {
            methods.push(format!("{of}::{}", name(rest)));
        }
    }
    methods
}

#[test]
fn table_and_traits_agree() {
    let mut rows = BTreeSet::new();
    for row in TABLE.lines().skip(2) {
        let row = row.replace("\\|", "/");
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        assert_eq!(cells.len(), 9, "{row}");
        assert!(cells[3..].iter().all(|cell| !cell.is_empty()), "what does it compile to: {row}");
        if cells[0].contains("::") {
            assert!(rows.insert(cells[0].trim_matches('`').to_owned()), "twice: {row}");
        }
    }
    let methods: Vec<String> = TRAITS.iter().flat_map(|source| methods(source)).collect();
    assert!(methods.len() > 100, "found only {} methods", methods.len());
    for method in &methods {
        assert!(rows.remove(method), "{method} has no row in operations.md");
    }
    assert!(rows.is_empty(), "rows without a method: {rows:?}");
}
