//! Writes the mechanisms and their exported functions: of each effect a text that has all, with a scene without it, or a text without it.

use std::fmt::Write;
use std::path::Path;
use std::{env, fs};

include!("../../tests/every_effect/text.rs");
include!("../../tests/every_effect/rows.rs");

macro_rules! strings {
    ([$($common:tt)*] $($name:ident { $($text:tt)* })*) => {
        (stringify!($($common)*), &[$((stringify!($name), stringify!($($text)*))),*])
    };
}

type Effect = (&'static str, &'static str);

/// The last effect of each text without one: loads of two numbers are made where a struct does not end.
const LAST: Effect = ("spare", "param spare: 1 = 0; param other: 1 = 0; out kept: 1 = spare + other;");

/// Effects that declare a function, in their order.
const FUNCTIONS: [&str; 3] = ["cam", "table", "face"];

/// Coordinates and rows without effects, and those that an effect adds.
const BODIES: (usize, usize) = (5, 0);
const ADDED: [(&str, (usize, usize)); 2] = [("face", (1, 1)), ("guide", (2, 3))];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    for file in ["text", "rows"] {
        println!("cargo::rerun-if-changed=../../tests/every_effect/{file}.rs");
    }
    let (common, forces): (&str, &[Effect]) = every_effect!(strings);
    let (_, rows): (&str, &[Effect]) = every_row!(strings);
    let effects = [forces, rows].concat();
    let in_scenes = env::var_os("CARGO_FEATURE_SCENES").is_some();
    let mut code = String::new();
    for left_out in ["nothing"].into_iter().chain(effects.iter().map(|(name, _)| *name)) {
        let (mut written, last): (Vec<&Effect>, Vec<&Effect>) =
            effects.iter().partition(|(name, _)| *name != left_out);
        written.push(&LAST);
        let has = |effect: &str| effect != left_out;
        let mut laws = vec!["crate::Law"; FUNCTIONS.iter().filter(|effect| has(effect)).count()];
        let of = |added: &dyn Fn((usize, usize)) -> usize| {
            ADDED.iter().filter(|(effect, _)| has(effect)).map(|(_, both)| added(*both)).sum::<usize>()
        };
        let (n, m) = (BODIES.0 + of(&|both| both.0), BODIES.1 + of(&|both| both.1));
        let (mut scenes, mut scene) = (String::new(), "");
        if in_scenes {
            let selected =
                |effects: &[&Effect]| effects.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(" + ");
            // Its fields come last in the struct that scenes share, so that the others have the same places.
            let without = selected(&written);
            written.extend(last);
            scenes = format!("scene Without = {without};\nscene Whole = {};\n", selected(&written));
            scene = "Without";
            laws.resize(FUNCTIONS.len(), "()");
        }
        let _ = writeln!(code, "mod text_{left_out} {{ {} }}", mechanism(common, &written, &scenes));
        let machine = format!("super::text_{left_out}::Library{scene}<{}>", laws.join(", "));
        let _ = writeln!(code, "mod {left_out} {{ export! {{ {left_out}, {machine}, {n}, {m} }} }}");
    }
    let file = Path::new(&env::var_os("OUT_DIR").expect("cargo sets it")).join("left_out.rs");
    fs::write(file, code).expect("the build's directory can be written");
}

fn mechanism(common: &str, effects: &[&Effect], scenes: &str) -> String {
    let effects: String =
        effects.iter().map(|(name, text)| format!("effect {name} {{ {text} }}\n")).collect();
    format!(
        "mbs_runtime::mechanism! {{\n/// Bodies under forces.\npub mechanism Library;\n{common}\n{effects}{scenes}}}\n"
    )
}
