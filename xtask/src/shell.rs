//! Programs that tasks run, and their cures where they are missing.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

/// Folder of the workspace.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map_or_else(PathBuf::new, Path::to_path_buf)
}

/// Target directory of the workspace.
pub fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// A command in the folder of the workspace.
pub fn command(program: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(program);
    command.args(arguments).current_dir(root());
    command
}

/// Runs a command to its end.
///
/// # Errors
/// The command line, if it cannot be started or fails.
pub fn run(command: &mut Command) -> Result<(), String> {
    let status = command.status().map_err(|error| format!("{}: {error}", written(command)))?;
    if status.success() { Ok(()) } else { Err(format!("{}: {status}", written(command))) }
}

/// Runs a command with its own line before it, and the time that it took behind.
///
/// # Errors
/// Those of [`run`].
pub fn step(command: &mut Command) -> Result<(), String> {
    println!("\n== {}", written(command));
    let begun = Instant::now();
    let done = run(command);
    println!("== {} s", begun.elapsed().as_secs());
    done
}

/// Standard output of a command; its standard error passes.
///
/// # Errors
/// The command line, if it cannot be started or fails.
pub fn output(command: &mut Command) -> Result<String, String> {
    let output = command
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| format!("{}: {error}", written(command)))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() {
        Ok(text)
    } else {
        Err(format!("{}: {}\n{text}", written(command), output.status))
    }
}

/// Environment and arguments as a shell takes them.
fn written(command: &Command) -> String {
    let environment = command.get_envs().filter_map(|(name, value)| Some((name, value?)));
    let environment =
        environment.map(|(name, value)| format!("{}={:?} ", name.display(), value.display().to_string()));
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    let words: Vec<String> = words.map(|word| word.display().to_string()).collect();
    environment.collect::<String>() + &words.join(" ")
}

/// `true` if the search path has the program.
pub fn exists(program: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(program).is_file())
}

/// A program that a task cannot do without.
///
/// # Errors
/// Its name and its cure, if it is missing.
pub fn need(program: &str, cure: &str) -> Result<(), String> {
    if exists(program) { Ok(()) } else { Err(format!("missing: {program}; {cure}")) }
}

/// A program of a Debian package, installed if it is missing.
///
/// # Errors
/// The cure, if there is no `apt-get` or it fails.
pub fn install(program: &str, package: &str) -> Result<(), String> {
    if exists(program) {
        return Ok(());
    }
    need("apt-get", &format!("`{program}` is missing as well: install the package {package} and run again"))?;
    output(&mut command("apt-get", &["update", "-qq"]))?;
    output(&mut command("apt-get", &["install", "-y", "-qq", package])).map(drop)
}

/// First line of `rustc --version`.
///
/// # Errors
/// Those of [`output`].
pub fn compiler() -> Result<String, String> {
    Ok(output(&mut command("rustc", &["--version"]))?.trim().to_string())
}
