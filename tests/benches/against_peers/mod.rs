//! Builds the peers, measures, writes table and plot: what the benches share.

mod goals;
mod plot;
mod run;
mod table;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

pub use goals::{Line, Peer};

/// What a bench compares.
pub struct Subject {
    /// Its name, as `proof-peers` knows it; files have it too.
    pub name: &'static str,
    /// Title of the table.
    pub title: &'static str,
    /// What is to be known about it.
    pub notes: &'static str,
    /// The ratios that the project wants to reach.
    pub lines: &'static [Line],
    /// Largest error by problem.
    pub limit: fn(&str) -> f64,
}

/// Measures the subject where `cargo bench` asks for it.
pub fn run(subject: &Subject) -> ExitCode {
    let arguments: Vec<String> = std::env::args().collect();
    let given = |name: &str| arguments.iter().any(|argument| argument == name);
    // `cargo test --benches` runs this program too, without the argument.
    if !given("--bench") {
        println!("nothing is measured without `cargo bench`");
        return ExitCode::SUCCESS;
    }
    let position = arguments.iter().position(|argument| argument == "--rounds");
    let rounds = position.and_then(|index| arguments.get(index + 1)).map_or("101", String::as_str);
    match measure(subject, rounds, given("--docs")) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("{reason}");
            ExitCode::FAILURE
        }
    }
}

fn measure(subject: &Subject, rounds: &str, docs: bool) -> Result<(), String> {
    let targets = run::all(subject.name, rounds)?;
    let [native, default] = &targets;
    let faults: Vec<String> = targets.iter().flat_map(|target| target.faults(subject.limit)).collect();
    let goals = goals::reached(subject.lines, native);
    let text = table::markdown(subject, native, default, &goals);
    let picture = plot::svg(&goals);
    println!("{text}");
    let mut directories = vec![Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("bench")];
    if docs {
        directories.push(PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/benches")));
    }
    for directory in directories {
        save(&directory, &format!("{}.md", subject.name), &text)?;
        save(&directory, &format!("{}.svg", subject.name), &picture)?;
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
