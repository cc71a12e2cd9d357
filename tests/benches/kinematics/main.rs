//! Emitted code against its peers in one run.
//!
//! ```text
//! cargo bench -p mbs-tests --bench kinematics
//! ```
//!
//! Builds the emitted code and its peers (`tests/proofs/peers`) for this processor and for the default target, runs
//! both, and writes a table and a plot to `bench/kinematics.md` and `bench/kinematics.svg` below the target directory;
//! with `-- --docs` also beside this file; `-- --rounds 5` is enough to see that everything works. Every ratio is the median over rounds in which all implementations took
//! turns; accuracy is checked before anything is timed. Needs Python 3 (for CasADi and SymPy) and a C compiler.
//!
//! Fails where a result is wrong, not where it is slow: how far a ratio is from its goal stands in the table.
#![forbid(unsafe_code)]

mod goals;
mod plot;
mod run;
mod table;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().collect();
    let given = |name: &str| arguments.iter().any(|argument| argument == name);
    // `cargo test --benches` runs this program too, without the argument.
    if !given("--bench") {
        println!("nothing is measured without `cargo bench`");
        return ExitCode::SUCCESS;
    }
    let position = arguments.iter().position(|argument| argument == "--rounds");
    let rounds = position.and_then(|index| arguments.get(index + 1)).map_or("101", String::as_str);
    match measure(rounds, given("--docs")) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("{reason}");
            ExitCode::FAILURE
        }
    }
}

fn measure(rounds: &str, docs: bool) -> Result<(), String> {
    let targets = run::all(rounds)?;
    let [native, default] = &targets;
    let faults: Vec<String> = targets.iter().flat_map(run::Measured::faults).collect();
    let goals = goals::reached(native);
    let text = table::markdown(native, default, &goals);
    let picture = plot::svg(&goals);
    println!("{text}");
    let mut directories = vec![Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("bench")];
    if docs {
        directories.push(PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/benches/kinematics")));
    }
    for directory in directories {
        save(&directory, "kinematics.md", &text)?;
        save(&directory, "kinematics.svg", &picture)?;
    }
    if faults.is_empty() { Ok(()) } else { Err(faults.join("\n")) }
}

fn save(directory: &Path, name: &str, text: &str) -> Result<(), String> {
    let file = directory.join(name);
    let written = fs::create_dir_all(directory).and_then(|()| fs::write(&file, text));
    written.map_err(|error| format!("cannot write {}: {error}", file.display()))?;
    println!("written to {}", file.display());
    Ok(())
}
