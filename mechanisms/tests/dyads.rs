//! Blocks of the ready mechanisms that the compiler recognises as dyads: a stored list.
//!
//! After a change that is meant, run `UPDATE_SNAPSHOTS=1 cargo test -p mechanisms --test dyads` and read the difference.

use std::fmt::Write;
use std::path::Path;

use mechanisms::CATALOGUE;

/// A line for each block that is solved: its coordinates, and the method of its assembly.
fn solved_blocks() -> String {
    let mut text = String::new();
    for card in CATALOGUE.fixed() {
        let mechanism = card.equations();
        let report = mbs_codegen::structure_of(mechanism.source(), Some(mechanism.scene()))
            .unwrap_or_else(|faults| panic!("{}: {faults}", card.name()));
        let _ = writeln!(text, "{}", card.name());
        for block in report.blocks.iter().filter(|block| !block.explicit) {
            let names: Vec<&str> =
                block.coordinates.iter().map(|index| report.coordinates[*index].name.as_str()).collect();
            let _ = writeln!(text, "    {}: {}", names.join(", "), block.dyad.unwrap_or("by a search"));
        }
    }
    text
}

#[test]
fn dyads_are_recognised_in_the_ready_mechanisms() {
    let stored = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/dyads.txt");
    let found = solved_blocks();
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        std::fs::write(&stored, &found).unwrap();
    }
    let expected = std::fs::read_to_string(&stored).unwrap();
    assert_eq!(found, expected);
}
