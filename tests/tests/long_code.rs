//! Texts cut into parts and loops, as if they were long, move as they do in one piece. No long text is needed. Mechanisms with
//! known motions are compiled like long code: each kind of block in one loop, each row in parts.
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

/// Program of the crate, for a mechanism whose rows fix all coordinates and for one that forces move.
const PROGRAM: &str = include_str!("long_code/program.rs");

/// Rows with every operation that there is, and one that sets a coordinate equal to another; nothing in them is a loop.
const ODD: &str = "
pub mechanism Odd;
param gain: 1 = 0.3;
coord crank: 1 = 0.5;
coord x: 1 = 0.4;
coord y: 1 = 0.6;
coord follower: 1 = 0.5;
drive motor: crank == 0.5 + t/1s;
constraint follow { follower == crank; }
constraint rows {
    x + 0.1*sin(y) == 0.05*(exp(-crank) + ln(2 + crank) + sqrt(2 + x) + tan(0.3*crank) + asin(0.3*x) + acos(0.2*y)
        + atan(crank*gain) + cos(3*crank)*sin(x*y) + sinh(gain*x) + cosh(y)*tanh(crank));
    y + 0.1*cos(x) == 0.05*(follower - crank + atan2(x, 1 + y^2) + abs(crank - x) + min(x, y) + max(crank, y) + hypot(x, y + 2)
        + (x + 2)^y + cos(x - y)/(2 + sin(crank + x)));
}";

/// Functions of an array in loops: in order, backwards, and by numbers without a fixed step.
const LAWS: &str = "
pub mechanism Laws;
function law: [1; 12](1), C4;
coord crank: 1 = 0.5;
coord x: [1; 12] = [0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1];
coord y: [1; 5];
drive motor: crank == law[4](t/1s);
constraint chain {
    x[0] + 0.1*law[0](x[0]) == law[1](crank);
    for i in 1..12 { x[i] == law[i](x[i - 1]) + 0.1*law[11 - i](crank); }
    y[0] == law[7].d1(x[3]);
    y[1] == law[2].d1(x[11]);
    y[2] == law[9].d1(x[5]);
    y[3] == law[3].d1(x[0]);
    y[4] == law[10].d1(x[7]);
}
out total: 1 = sum(i in 0..12: law[i].d2(2*x[11 - i]));";

/// The text's module, the name of its type, the text, and its motion.
fn texts() -> [(&'static str, &'static str, &'static str, &'static str); 7] {
    [
        ("laws", "Laws<Law>", LAWS, "turn"),
        ("odd", "Odd", ODD, "turn"),
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
    let (mut calls, mut modules, mut lines) = (String::new(), String::new(), texts().len());
    for (module, name, source, motion) in texts() {
        let whole = mbs_codegen::expand_source(source).expect("a text without faults").to_string();
        let cut = mbs_codegen::expand_source_as_long(source).expect("a text without faults").to_string();
        // The control: the code is another one, in loops and parts.
        assert!(cut.contains("Passed") && !whole.contains("Passed"), "{name}");
        if module == "laws" {
            assert!((1..30).contains(&cut.matches("chunks :: jet").count()), "a call each, not in loops");
        }
        // Every operation is on a tape, where its results have the same bits in numbers of any kind.
        if module == "odd" {
            assert!(cut.contains("tape :: run"));
            for number in ["f64", "f32", "Lanes<f64, 4>"] {
                let of = |code: &str| format!("evaluated::<{number}, {module}_{code}::{name}<_>, _, _>()");
                calls += &format!("    same(\"{name} in {number}\", &{}, &{});\n", of("cut"), of("whole"));
                lines += 1;
            }
        }
        modules += &format!("mod {module}_cut {{\n{cut}\n}}\nmod {module}_whole {{\n{whole}\n}}\n");
        let [cut, whole] =
            ["cut", "whole"].map(|code| format!("{motion}::<{module}_{code}::{name}, _, _>()"));
        calls += &format!("    compared(\"{name}\", {cut}, {whole});\n");
    }
    written.write("src/main.rs", &(PROGRAM.replace("// COMPARISONS\n", &calls) + &modules));
    let mut run = written.cargo(&["run", "--quiet"]);
    let said = tools::output(&mut run, "the tests need cargo, which runs them");
    let said = said.unwrap_or_else(|said| panic!("{said}"));
    assert_eq!(said.lines().count(), lines, "{said}");
    print!("{said}");
}
