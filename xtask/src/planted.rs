//! Planted faults: each patch in `xtask/planted` makes a copy of the sources wrong, and the matrix of hard cases must say so.

use std::fs;
use std::path::{Path, PathBuf};

use crate::shell::{self, command, need, output, root, target};

/// Folder of the patches.
const FOLDER: &str = "xtask/planted";

/// Folder of the cases: a text and a description each.
const LIST: &str = "mbs-workbench/hard_cases";

/// Head of the line of a patch that names its cases.
const CASES: &str = "Cases: ";

/// Head of the line of a patch that names its methods: all where there is none.
const METHODS: &str = "Methods: ";

/// A fault.
struct Fault {
    path: PathBuf,
    /// First line of its patch.
    title: String,
    shown: Shown,
}

/// Part of the matrix that shows a fault.
struct Shown {
    /// Names with commas between them.
    cases: String,
    /// Methods that the fault touches: others run as they do without it, and adaptive ones may take hours.
    methods: Option<String>,
}

/// Plants all faults, or those of these `names`, one after the other.
///
/// # Errors
/// A name without a patch, a patch that no longer applies, a build that fails, or a fault that no cell shows.
pub fn run(names: &[&str]) -> Result<(), String> {
    need("git", "install git")?;
    let mut faults = faults()?;
    if let Some(unknown) = names.iter().find(|name| !faults.iter().any(|fault| fault.name() == **name)) {
        let known: Vec<String> = faults.iter().map(Fault::name).collect();
        return Err(format!("there is no fault `{unknown}` in {FOLDER}\nknown: {}", known.join(", ")));
    }
    faults.retain(|fault| names.is_empty() || names.contains(&fault.name().as_str()));
    let folder = target().join("planted");
    let copy = folder.join("sources");
    copied(&copy)?;
    let mut cases: Vec<&str> = faults.iter().flat_map(|fault| fault.shown.cases.split(',')).collect();
    cases.sort_unstable();
    cases.dedup();
    println!("\n== sources as they are: {}", cases.join(", "));
    let all = Shown { cases: cases.join(","), methods: None };
    let wrong = wrong(&copy, &all, &folder.join("as_they_are"))?;
    if wrong > 0 {
        return Err(format!("{wrong} runs are wrong without a fault"));
    }
    let mut missed = Vec::new();
    for fault in &faults {
        let name = fault.name();
        println!("\n== {name}: {}", fault.title);
        applied(&copy, fault, &[])?;
        let found = self::wrong(&copy, &fault.shown, &folder.join(&name));
        // The next fault is planted alone.
        applied(&copy, fault, &["--reverse"])?;
        let found = found?;
        println!("{found} runs are wrong");
        if found == 0 {
            missed.push(name);
        }
    }
    match missed.as_slice() {
        [] => Ok(()),
        names => Err(format!(
            "no cell shows {}: add a case to mbs-workbench/hard_cases that does, and name it in the patch",
            names.join(", ")
        )),
    }
}

impl Fault {
    /// File name of its patch without the suffix.
    fn name(&self) -> String {
        self.path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
    }
}

fn faults() -> Result<Vec<Fault>, String> {
    let folder = root().join(FOLDER);
    let entries = fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|suffix| suffix == "patch"));
    paths.sort();
    paths.into_iter().map(fault).collect()
}

fn fault(path: PathBuf) -> Result<Fault, String> {
    let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let title = text.lines().next().unwrap_or_default().to_string();
    let cases = text.lines().find_map(|line| line.strip_prefix(CASES));
    let cases = cases.ok_or_else(|| format!("{}: no line `{CASES}name,name`", path.display()))?;
    let methods = text.lines().find_map(|line| line.strip_prefix(METHODS));
    let shown =
        Shown { cases: cases.trim().to_string(), methods: methods.map(|methods| methods.trim().to_string()) };
    Ok(Fault { title, shown, path })
}

/// Copies what git knows, and leaves alone what has not changed.
pub fn copied(copy: &Path) -> Result<(), String> {
    let names = output(&mut command("git", &["ls-files", "--cached", "--others", "--exclude-standard"]))?;
    for name in names.lines() {
        let (from, to) = (root().join(name), copy.join(name));
        // A file that was deleted and not yet committed.
        let Ok(content) = fs::read(&from) else { continue };
        if fs::read(&to).is_ok_and(|present| present == content) {
            continue;
        }
        let written = to.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::write(&to, content));
        written.map_err(|error| format!("{}: {error}", to.display()))?;
    }
    Ok(())
}

fn applied(copy: &Path, fault: &Fault, options: &[&str]) -> Result<(), String> {
    let patch = fault.path.display().to_string();
    // Within a work tree git would leave out paths that are not of it.
    let mut apply = command("git", &["apply", "--unsafe-paths"]);
    apply
        .args(options)
        .arg(&patch)
        .current_dir(copy)
        .env("GIT_CEILING_DIRECTORIES", copy.parent().unwrap_or(copy));
    shell::run(&mut apply).map_err(|reason| {
        format!(
            "{reason}\nthe patch no longer applies: plant the fault by hand in {}, and store `diff -u` of it with the lines before `---` \
             of {patch}",
            copy.display()
        )
    })
}

/// Leaves in the copy the files of some cases alone: the program of a study has all texts of the folder, and each takes the compiler
/// seconds.
fn chosen(copy: &Path, cases: &str) -> Result<(), String> {
    let folder = root().join(LIST);
    let unreadable = |error: std::io::Error| format!("{}: {error}", folder.display());
    for entry in fs::read_dir(&folder).map_err(unreadable)? {
        let from = entry.map_err(unreadable)?.path();
        let stem = from.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let Some(name) = from.file_name() else { continue };
        let to = copy.join(LIST).join(name);
        if cases.split(',').any(|case| case == stem) {
            fs::copy(&from, &to).map_err(|error| format!("{}: {error}", to.display()))?;
        } else if from.extension().is_some_and(|suffix| suffix == "mbs" || suffix == "toml") {
            drop(fs::remove_file(&to));
        }
    }
    Ok(())
}

/// Number of wrong runs of a part of the matrix.
fn wrong(copy: &Path, shown: &Shown, out: &Path) -> Result<usize, String> {
    chosen(copy, &shown.cases)?;
    let table = out.join("hard-cases.csv");
    // A table of an earlier run tells nothing.
    drop(fs::remove_file(&table));
    let out = out.display().to_string();
    let mut study =
        command("cargo", &["run", "--quiet", "--release", "-p", "mbs-workbench", "--bin", "mbs", "--"]);
    study.args(["hard-cases", "--quick", "--variants", "8", "--cases", &shown.cases, "--out", &out]);
    if let Some(methods) = &shown.methods {
        study.args(["--methods", methods]);
    }
    study.current_dir(copy).env("CARGO_TARGET_DIR", target().join("planted").join("target"));
    let status = study.stdout(std::process::Stdio::null()).status().map_err(|error| error.to_string())?;
    let table = fs::read_to_string(&table)
        .map_err(|error| format!("{}: {error}; the study ended with {status}", table.display()))?;
    Ok(table.lines().filter(|line| line.contains(",wrong,")).count())
}
