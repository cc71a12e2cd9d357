//! Texts cut into parts and loops as if they were long move as they do in one piece. No long text is written for it: what long
//! code is made of, each block of a kind in one loop, each row in parts, stands here around mechanisms with known motions.
#![forbid(unsafe_code)]

use mbs_runtime::Mechanism;
use mbs_tests::tools;
use mbs_tests::written::WrittenCrate;
use mechanisms::double_parallelogram::DoubleParallelogram;
use mechanisms::heavy_top::HeavyTop;
use mechanisms::n_four_bar::NFourBar;
use mechanisms::peaucellier::Peaucellier;
use mechanisms::three_rrr::ThreeRrr;

const MANIFEST: &str = r#"
[package]
name = "long-code"
edition = "2024"

[dependencies]
mbs-runtime = { path = "../../mbs-runtime", default-features = false }

[workspace]
"#;

/// What the crate does with a mechanism of rows that fix all coordinates, and with one that forces move.
const PROGRAM: &str = include_str!("long_code/program.rs");

/// The text's module, the name of its type, what moves it.
fn texts() -> [(&'static str, &'static str, &'static str, &'static str); 5] {
    [
        ("peaucellier", "Peaucellier", Peaucellier::<f64>::SOURCE, "turn"),
        ("three_rrr", "ThreeRrr", ThreeRrr::<f64>::SOURCE, "turn"),
        ("double_parallelogram", "DoubleParallelogram", DoubleParallelogram::<f64>::SOURCE, "turn"),
        ("n_four_bar", "NFourBar", NFourBar::<f64>::SOURCE, "fall"),
        ("heavy_top", "HeavyTop", HeavyTop::<f64>::SOURCE, "fall"),
    ]
}

#[test]
fn mechanisms_cut_as_long_ones_move_as_in_one_piece() {
    let written = WrittenCrate::new(env!("CARGO_TARGET_TMPDIR"), "long_code", MANIFEST);
    let (mut calls, mut modules) = (String::new(), String::new());
    for (module, name, source, motion) in texts() {
        let whole = mbs_codegen::expand_source(source).expect("a text without faults").to_string();
        let cut = mbs_codegen::expand_source_as_long(source).expect("a text without faults").to_string();
        // The control: the code is another one, in loops and parts.
        assert!(cut.contains("Passed") && !whole.contains("Passed"), "{name}");
        modules += &format!("mod {module}_cut {{\n{cut}\n}}\nmod {module}_whole {{\n{whole}\n}}\n");
        let [cut, whole] =
            ["cut", "whole"].map(|code| format!("{motion}::<{module}_{code}::{name}, _, _>()"));
        calls += &format!("    compared(\"{name}\", {cut}, {whole});\n");
    }
    written.write("src/main.rs", &(PROGRAM.replace("// COMPARISONS\n", &calls) + &modules));
    let mut run = written.cargo(&["run", "--quiet"]);
    let said = tools::output(&mut run, "the tests need cargo, which runs them");
    let said = said.unwrap_or_else(|said| panic!("{said}"));
    assert_eq!(said.lines().count(), texts().len(), "{said}");
    print!("{said}");
}
