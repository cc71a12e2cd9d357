//! A fault of a text is one message: rustc adds none that only follows from it, whatever else the text has and however its
//! mechanism is used.
//!
//! Texts of every kind, each with code that uses its fields, types, traits and sizes, are spoilt in many ways, one at a time. All
//! are modules of one crate, which is checked once.
#![forbid(unsafe_code)]

use std::fmt::Write;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;
use std::{env, fs};

const MANIFEST: &str = r#"
[package]
name = "nothing-follows"
edition = "2024"

[dependencies]
mbs-runtime = { path = "RUNTIME", default-features = false }

[workspace]
"#;

/// Texts, one statement a line, with the code that uses them.
const TEXTS: [(&str, &str, &str); 9] = [
    ("plain", include_str!("nothing_follows/plain.txt"), include_str!("nothing_follows/plain.rs")),
    ("inputs", include_str!("nothing_follows/inputs.txt"), include_str!("nothing_follows/inputs.rs")),
    (
        "functions",
        include_str!("nothing_follows/functions.txt"),
        include_str!("nothing_follows/functions.rs"),
    ),
    (
        "redundant",
        include_str!("nothing_follows/redundant.txt"),
        include_str!("nothing_follows/redundant.rs"),
    ),
    ("masses", include_str!("nothing_follows/masses.txt"), include_str!("nothing_follows/masses.rs")),
    ("driven", include_str!("nothing_follows/driven.txt"), include_str!("nothing_follows/driven.rs")),
    ("states", include_str!("nothing_follows/states.txt"), include_str!("nothing_follows/states.rs")),
    ("effects", include_str!("nothing_follows/effects.txt"), include_str!("nothing_follows/effects.rs")),
    ("surplus", include_str!("nothing_follows/surplus.txt"), include_str!("nothing_follows/surplus.rs")),
];

/// Each so many of the spoilt texts is looked at: all of them take minutes.
const STRIDE: usize = if cfg!(feature = "long") { 1 } else { 8 };

/// A way to spoil a statement: the spoilt one, `None` where the way does not apply.
type Slip = (&'static str, fn(&str) -> Option<String>);

/// The first occurrence of `from` replaced.
fn replaced(line: &str, from: &str, to: &str) -> Option<String> {
    line.contains(from).then(|| line.replacen(from, to, 1))
}

/// The last occurrence of `from` replaced.
fn last_replaced(line: &str, from: &str, to: &str) -> Option<String> {
    let at = line.rfind(from)?;
    Some(format!("{}{to}{}", &line[..at], &line[at + from.len()..]))
}

/// The first word of a line changed.
fn keyword(line: &str, to: fn(&str) -> String) -> Option<String> {
    let (word, rest) = line.split_once(' ')?;
    (!word.is_empty() && word.chars().all(char::is_alphabetic)).then(|| format!("{} {rest}", to(word)))
}

const SLIPS: [Slip; 35] = [
    ("no semicolon", |line| last_replaced(line, ";", "")),
    ("no colon", |line| replaced(line, ":", " ")),
    ("no equals sign", |line| replaced(line, "=", " ")),
    ("single equals sign", |line| replaced(line, "==", "=")),
    ("double equals sign", |line| replaced(line, " = ", " == ")),
    ("no comma", |line| replaced(line, ",", " ")),
    ("a semicolon as a comma", |line| replaced(line, ", ", "; ")),
    ("a comma too many", |line| last_replaced(line, ";", ",;")),
    ("an operator too many", |line| last_replaced(line, ";", " + ;")),
    ("an operand too many", |line| last_replaced(line, ";", " stray;")),
    ("two stars", |line| replaced(line, "^", "**")),
    ("no operator", |line| replaced(line, "*", " ")),
    ("unknown name", |line| last_replaced(line, ";", " + nowhere;")),
    ("unknown function", |line| last_replaced(line, ";", " + nothing(1);")),
    ("unknown unit", |line| replaced(line, ": m", ": metr")),
    ("unknown unit of angles", |line| replaced(line, ": rad", ": radiant")),
    ("unknown unit of a number", |line| replaced(line, "mm", "mmm")),
    ("unit that does not fit", |line| last_replaced(line, ";", " + 1A;")),
    ("unit that is declared instead", |line| replaced(line, ": m", ": kg")),
    ("vector for a number", |line| last_replaced(line, ";", " + [1m, 2m, 3m];")),
    ("number with a letter", |line| last_replaced(line, ";", " + 1q;")),
    ("number that is too large", |line| last_replaced(line, ";", " + 1e999;")),
    ("number in another base", |line| last_replaced(line, ";", " + 0x1F;")),
    ("array with a bad length", |line| replaced(line, "; 2]", "; 2.5]")),
    ("array with a length in another unit", |line| replaced(line, "; 2]", "; 2m]")),
    ("array with an unknown length", |line| replaced(line, "; 2]", "; count]")),
    ("array without a length", |line| replaced(line, "; 2]", "]")),
    ("array with a component of another kind", |line| replaced(line, "= [", "= [1A, ")),
    ("component beyond the last", |line| last_replaced(line, ";", " + [1, 2][2];")),
    ("keyword with a slip", |line| keyword(line, |word| word[1..].to_owned())),
    ("keyword of no kind", |line| keyword(line, |_| "gadget".to_owned())),
    ("rates without a comma", |line| replaced(line, ", rates", " rates")),
    ("redundant with a slip", |line| replaced(line, "redundant", "redundnt")),
    ("statement left out", |_| Some(String::new())),
    ("statement twice", |line| Some(format!("{line} {line}"))),
];

/// A text with a slip.
struct Spoilt {
    label: String,
    text: String,
    code: &'static str,
    faults: Vec<mbs_codegen::Fault>,
}

static SPOILT: LazyLock<Vec<Spoilt>> = LazyLock::new(|| {
    let (mut all, mut seen) = (Vec::new(), 0_usize);
    for (name, text, code) in TEXTS {
        assert!(mbs_codegen::outline(text).is_ok(), "{name}");
        let lines: Vec<&str> = text.lines().collect();
        for (number, line) in lines.iter().enumerate().skip(1) {
            for (slip, spoil) in SLIPS {
                let Some(spoilt) = spoil(line) else { continue };
                seen += 1;
                if !seen.is_multiple_of(STRIDE) {
                    continue;
                }
                let mut lines = lines.clone();
                lines[number] = &spoilt;
                let text = lines.join("\n");
                if let Err(faults) = mbs_codegen::outline(&text) {
                    all.push(Spoilt { label: format!("{name}, {slip}: {line}"), text, code, faults });
                }
            }
        }
    }
    all
});

/// Errors of a program that uses the runtime, one a line.
fn checked(program: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().expect("the workspace");
    let scratch = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let directory = scratch.join("nothing_follows");
    fs::create_dir_all(directory.join("src")).expect("a folder");
    let runtime = root.join("mbs-runtime").display().to_string().replace('\\', "/");
    fs::write(directory.join("Cargo.toml"), MANIFEST.replace("RUNTIME", &runtime)).expect("a manifest");
    fs::copy(root.join("Cargo.lock"), directory.join("Cargo.lock")).expect("a lock file");
    fs::write(directory.join("src/main.rs"), program).expect("a program");
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(["check", "--message-format=short", "--quiet"]).current_dir(&directory);
    command.env("CARGO_TARGET_DIR", scratch.parent().unwrap_or(scratch)).env("CARGO_INCREMENTAL", "0");
    let output = command.output().expect("the tests need cargo, which runs them");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn one_fault_is_one_message_of_the_compiler() {
    let mut program = String::from("#![allow(dead_code, unused)]\n#![deny(deprecated)]\nfn main() {}\n");
    let mut ends = Vec::new();
    let sound = TEXTS.map(|(name, text, code)| (format!("{name}, sound"), text.to_owned(), code, 0));
    let spoilt = SPOILT.iter().map(|s| (s.label.clone(), s.text.clone(), s.code, s.faults.len()));
    for (number, (label, text, code, faults)) in sound.into_iter().chain(spoilt).enumerate() {
        let _ = writeln!(program, "mod text_{number} {{\nmbs_runtime::mechanism! {{\n{text}}}\n{code}}}");
        ends.push((program.lines().count(), label, faults));
    }
    let said = checked(&program);
    let mut found = vec![Vec::new(); ends.len()];
    for line in said.lines() {
        let Some((place, message)) = line.split_once(": error") else { continue };
        let row: usize = place.split(':').nth(1).and_then(|row| row.parse().ok()).expect(line);
        let (_, label, _) = &ends[ends.partition_point(|(end, ..)| *end < row)];
        // A pattern names the field, and whether it is a parameter or a coordinate only the keyword tells. A name that the text
        // does not have any more is an error of the code that uses it.
        let is_pattern = message.starts_with("[E0026]");
        let is_name = ["[E0425]", "[E0433]"].iter().any(|code| message.starts_with(code));
        let left_out = label.contains("statement left out");
        if !(is_pattern && (left_out || label.contains("keyword of no kind")) || is_name && left_out) {
            found[ends.partition_point(|(end, ..)| *end < row)].push(message.to_owned());
        }
    }
    let mut complaints = String::new();
    for ((_, label, faults), found) in ends.iter().zip(&found) {
        if found.len() != *faults {
            let _ =
                writeln!(complaints, "{label}\n  {faults} faults, but rustc says{}", found.join("\n     "));
        }
    }
    assert!(ends.len() > 1600 / STRIDE, "{} texts", ends.len());
    assert!(complaints.is_empty(), "{complaints}\n{}", if found.concat().is_empty() { &said } else { "" });
}

/// Slips of the text's form are one fault, and so are a unit or a name that is unknown.
#[test]
fn a_slip_is_one_fault_of_the_text() {
    let mut several = String::new();
    for Spoilt { label, faults, .. } in SPOILT.iter() {
        // What a missing or double statement causes elsewhere is as many faults as there are places.
        // A call among effects is two: it is none, and they are added with `+`.
        let others = ["left out", "twice", "another base", "unknown function: scene"];
        let is_counted = !others.iter().any(|slip| label.contains(slip));
        if is_counted && faults.len() > 1 {
            let _ = writeln!(several, "{label}");
            for fault in faults {
                let _ = writeln!(several, "    {}: {} ({})", fault.line, fault.message, fault.help);
            }
        }
    }
    assert!(several.is_empty(), "{several}");
}
