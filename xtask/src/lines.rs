//! Lines of LLVM code that the workbench costs a mechanism, compared with those stored in `xtask/lines.txt`.
//!
//! Processor time of one further mechanism (s), each in a crate of its own, before and after facades and adaptive runs were shared.
//! Watt's linkage: 5.1 and 3.9 in release, 1.3 and 1.3 in debug. Andrews' squeezer: 18.7 and 14.0 in release, 4.1 and 4.2 in debug.
//!
//! Lines before and after integrators and block solvers were shared, and searches for absent statements were left out.
//! Watt's linkage: 95 311 and 85 591. Andrews' squeezer: 350 401 and 285 497.
//!
//! Lines before and after two changes: states and held rows that a text lacks are left out, and loops make arrays in place of `map`.
//! Watt's linkage: 95 908 and 91 700. Andrews' squeezer: 276 935 and 248 164.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::shell::{command, compiler, need, output, root, target};

/// Files of the catalogue: one without masses, one with them.
const MECHANISMS: [&str; 2] = ["watt", "andrews"];

/// Largest growth over the stored number.
const GROWTH: f64 = 1.05;

/// Compiles each mechanism for the workbench in a scratch crate and counts its lines; stores them if `update`.
///
/// # Errors
/// More than 5 % above the stored lines of the same compiler, a missing tool with its cure.
pub fn run(update: bool) -> Result<(), String> {
    need("cargo-llvm-lines", "`cargo install cargo-llvm-lines`")?;
    println!("\n== lines");
    let path = root().join("xtask/lines.txt");
    let stored = fs::read_to_string(&path).unwrap_or_default();
    let compiler = compiler()?;
    let judged = update || stored.contains(&compiler);
    if !judged {
        println!("not judged: the stored lines are of another compiler than {compiler}");
    }
    let mut found =
        format!("# Lines of LLVM code of a mechanism for the workbench, without optimisation; {compiler}\n");
    let mut grown = Vec::new();
    for name in MECHANISMS {
        let lines = lines(name)?;
        let before = stored.lines().find_map(|line| line.strip_prefix(name)?.trim().parse::<u32>().ok());
        let before = before.unwrap_or(lines);
        println!("{name:10} {lines:>8} lines, {before:>8} stored");
        let _ = writeln!(found, "{name} {lines}");
        if f64::from(lines) > GROWTH * f64::from(before) {
            grown.push(name);
        }
    }
    if update {
        return fs::write(&path, found).map_err(|error| format!("{}: {error}", path.display()));
    }
    if grown.is_empty() || !judged {
        Ok(())
    } else {
        Err(format!("more than 5 % above the stored lines: {}", grown.join(", ")))
    }
}

/// Lines of the crate that erases one mechanism of the catalogue.
fn lines(name: &str) -> Result<u32, String> {
    let scratch = target().join("lines");
    write_crate(&scratch, name)?;
    let mut count = command("cargo", &["llvm-lines", "--quiet", "--lib"]);
    count.current_dir(&scratch).env("CARGO_TARGET_DIR", scratch.join("target")).env("CARGO_INCREMENTAL", "0");
    let text = output(&mut count)?;
    let total = text.lines().find(|line| line.contains("(TOTAL)"));
    let number = total.and_then(|line| line.split_whitespace().next()?.parse().ok());
    number.ok_or_else(|| format!("no total in\n{text}"))
}

fn write_crate(scratch: &Path, name: &str) -> Result<(), String> {
    let failed = |error: std::io::Error| format!("{}: {error}", scratch.display());
    let file = fs::read_to_string(root().join(format!("mechanisms/src/{name}.rs"))).map_err(failed)?;
    let text = file.split_once("\nmechanism! {\n").and_then(|(_, rest)| rest.split_once("\n}\n"));
    let (text, _) = text.ok_or_else(|| format!("mechanisms/src/{name}.rs has no text"))?;
    let header = text.split_once("pub mechanism ").and_then(|(_, rest)| rest.split_once(';'));
    let (type_name, _) = header.ok_or_else(|| format!("mechanisms/src/{name}.rs has no header"))?;
    let path = |name: &str| root().join(name).display().to_string();
    let manifest = format!(
        "[package]\nname = \"lines\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[dependencies]\n\
         mbs-runtime = {{ path = {:?} }}\nmbs-workbench = {{ path = {:?}, features = [\"program\"] }}\n\n[workspace]\n",
        path("mbs-runtime"),
        path("mbs-workbench")
    );
    let library = format!(
        "//! One mechanism for the workbench.\n\nmbs_runtime::mechanism! {{\n{text}\n}}\n\n/// The mechanism.\n\
         pub fn make() -> mbs_workbench::erased::erase::Erased {{\n    \
         mbs_workbench::erased::erase::erase({type_name}::default())\n}}\n"
    );
    fs::create_dir_all(scratch.join("src")).map_err(failed)?;
    fs::write(scratch.join("Cargo.toml"), manifest).map_err(failed)?;
    fs::write(scratch.join("src/lib.rs"), library).map_err(failed)
}
