//! The programs that proofs and benches run.

use std::ffi::OsStr;
use std::path::Path;
use std::process::{Command, Output};

const BINUTILS: &str = "install a C compiler and binutils (Debian, Ubuntu: package `build-essential`), or name them in CC and NM";

/// What `command` says.
///
/// # Panics
/// Where the program does not start; `cure` says what to do.
pub fn run(command: &mut Command, cure: &str) -> Output {
    match command.env("LC_ALL", "C").output() {
        Ok(output) => output,
        Err(error) => panic!("{:?} does not start: {error}\n{cure}", command.get_program()),
    }
}

/// What a successful `command` writes to its standard output.
///
/// # Errors
/// Everything it said, where it fails.
///
/// # Panics
/// As [`run`].
pub fn output(command: &mut Command, cure: &str) -> Result<String, String> {
    let output = run(command, cure);
    let (said, complained) = (text(&output.stdout), text(&output.stderr));
    if output.status.success() { Ok(said) } else { Err(format!("{command:?}\n{said}{complained}")) }
}

/// Compiles and links with the C compiler.
///
/// # Errors
/// What the compiler or the linker complains about.
///
/// # Panics
/// Where there is no C compiler, with the cure.
pub fn compile(arguments: &[&OsStr]) -> Result<String, String> {
    output(program("CC", "cc").args(arguments), BINUTILS)
}

/// The symbols of a linked program as `nm` lists them: kind and name.
///
/// # Panics
/// Where there is no `nm`, with the cure, or it does not understand the program.
pub fn symbols(program_file: &Path) -> Vec<(char, String)> {
    let listed = output(program("NM", "nm").arg("--format=posix").arg(program_file), BINUTILS);
    let listed = listed.unwrap_or_else(|complaint| panic!("{complaint}"));
    let symbol = |line: &str| {
        let mut words = line.split_whitespace();
        let name = words.next()?.to_owned();
        Some((words.next()?.chars().next()?, name))
    };
    listed.lines().filter_map(symbol).collect()
}

fn program(variable: &str, usual: &str) -> Command {
    let named = std::env::var_os(variable).filter(|value| !value.is_empty());
    Command::new(named.unwrap_or_else(|| usual.into()))
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
