//! Common part of the benches: builds the peers, measures, writes table and plot.

mod goals;
mod machine;
mod plot;
mod run;
mod table;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

pub use goals::{Line, Peer, SHOWN};

/// Subject of a bench.
pub struct Subject {
    /// Its name, as `proof-peers` knows it; files have it too.
    pub name: &'static str,
    /// Title of the table.
    pub title: &'static str,
    /// Notes for the reader of the table.
    pub notes: &'static str,
    /// The ratios that the project wants to reach.
    pub lines: &'static [Line],
    /// Largest error by problem and implementation.
    pub limit: run::Limit,
    /// Limits of missed goals, and attempts to meet them: by the work of the goal.
    pub bounds: &'static [(&'static str, &'static str)],
}

/// Measures the subject if `cargo bench` asks for it.
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
    let [native, default] = &run::all(subject.name, rounds, subject.limit)?;
    let goals = goals::reached(subject.lines, native, default);
    let text = table::markdown(subject, rounds, native, default, &goals);
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
    Ok(())
}

fn save(directory: &Path, name: &str, text: &str) -> Result<(), String> {
    let file = directory.join(name);
    let written = fs::create_dir_all(directory).and_then(|()| fs::write(&file, text));
    written.map_err(|error| format!("cannot write {}: {error}", file.display()))?;
    println!("written to {}", file.display());
    Ok(())
}
