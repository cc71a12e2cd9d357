//! Operations of the emitted functions of the ready mechanisms: a stored list with a line for each mechanism and function.
//!
//! After a change that is meant, run `UPDATE_SNAPSHOTS=1 cargo test -p mechanisms --test operations` and read the difference.

use std::fmt::Write;
use std::path::Path;

use mbs_codegen::Operations;
use mechanisms::CATALOGUE;

/// Functions that compute nothing are left out.
fn costs() -> String {
    let mut text = String::new();
    for card in CATALOGUE.fixed() {
        let mechanism = card.equations();
        let report = mbs_codegen::structure_of(mechanism.source(), Some(mechanism.scene()))
            .unwrap_or_else(|faults| panic!("{}: {faults}", card.name()));
        for (function, count) in report.costs {
            if count == Operations::default() {
                continue;
            }
            let Operations { additions, multiplications, divisions, sine_cosines, functions, selects, calls } =
                count;
            let _ = writeln!(
                text,
                "{} {function}: {additions} + −, {multiplications} ×, {divisions} ÷, {sine_cosines} sin cos, \
                 {functions} other functions, {selects} selections, {calls} declared functions",
                card.name()
            );
        }
    }
    text
}

#[test]
fn the_emitted_functions_of_the_ready_mechanisms_cost_what_they_did() {
    let stored = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/operations.txt");
    let found = costs();
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        std::fs::write(&stored, &found).unwrap();
    }
    let expected = std::fs::read_to_string(&stored).unwrap();
    for (expected, found) in expected.lines().zip(found.lines()) {
        assert_eq!(found, expected);
    }
    assert_eq!(found, expected);
}
