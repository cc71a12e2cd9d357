//! The programs that proofs and benches run.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::Path;
use std::process::{Command, Output};

const BINUTILS: &str = "install a C compiler and binutils (Debian, Ubuntu: package `build-essential`), or name them in CC, NM and OBJDUMP";

/// Output of `command`.
///
/// # Panics
/// If the program does not start; the message ends with `cure`.
pub fn run(command: &mut Command, cure: &str) -> Output {
    match command.env("LC_ALL", "C").output() {
        Ok(output) => output,
        Err(error) => panic!("{:?} does not start: {error}\n{cure}", command.get_program()),
    }
}

/// Standard output of a successful `command`.
///
/// # Errors
/// All output of `command`, if it fails.
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
/// Messages of the compiler or the linker.
///
/// # Panics
/// If there is no C compiler, with the cure.
pub fn compile(arguments: &[&OsStr]) -> Result<String, String> {
    output(program("CC", "cc").args(arguments), BINUTILS)
}

/// The symbols of a linked program as `nm` lists them: kind and name.
///
/// # Panics
/// If there is no `nm`, with the cure, or it does not understand the program.
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

/// The functions of a linked program: name, and size in bytes.
///
/// # Panics
/// As [`symbols`].
pub fn functions(program_file: &Path) -> Vec<(String, usize)> {
    let listed = output(program("NM", "nm").arg("--format=posix").arg(program_file), BINUTILS);
    let listed = listed.unwrap_or_else(|complaint| panic!("{complaint}"));
    let function = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let (name, kind, size) = (words.first()?, words.get(1)?, words.get(3)?);
        let size = usize::from_str_radix(size, 16).ok()?;
        ["t", "T"].contains(kind).then(|| ((*name).to_owned(), size))
    };
    listed.lines().filter_map(function).collect()
}

/// The sections of an archive that the functions are in which `wanted` picks by name. The compiler gives functions that are alike one
/// section, of which [`disassembly`] knows one name.
///
/// # Panics
/// As [`disassembly`].
pub fn sections(file: &Path, wanted: fn(&str) -> bool) -> BTreeMap<String, String> {
    let listed = output(program("OBJDUMP", "objdump").arg("--syms").arg(file), BINUTILS);
    let listed = listed.unwrap_or_else(|complaint| panic!("{complaint}"));
    let section = |line: &str| {
        let (head, tail) = line.split_once('\t')?;
        let (section, name) = (head.split_whitespace().last()?, tail.split_whitespace().last()?);
        (head.contains(" F ") && wanted(name)).then(|| (name.to_owned(), section.to_owned()))
    };
    listed.lines().filter_map(section).collect()
}

/// Functions of an object file or archive that `wanted` picks by name, with their instructions as bytes. An instruction is
/// followed by the reference that the linker resolves in it: offset within the function, kind, and target. The target is
/// left out if the compiler's naming hides it.
///
/// # Panics
/// If there is no `objdump`, with the cure, or it does not understand the file.
pub fn disassembly(file: &Path, wanted: fn(&str) -> bool) -> BTreeMap<String, Vec<String>> {
    let mut command = program("OBJDUMP", "objdump");
    let listed = output(command.args(["--disassemble", "--reloc"]).arg(file), BINUTILS);
    let listed = listed.unwrap_or_else(|complaint| panic!("{complaint}"));
    let mut functions: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut current = None;
    for line in listed.lines() {
        if let Some(head) = line.strip_suffix(">:") {
            let name = head.split_once('<').map_or("", |(_, name)| name).to_owned();
            current = wanted(&name).then(|| functions.entry(name).or_default());
        } else if let Some(function) = &mut current {
            function.extend(instruction(line));
        }
    }
    functions
}

/// Bytes of an instruction, or a reference of one; the rest of the listing is for readers.
fn instruction(line: &str) -> Option<String> {
    let mut columns = line.split('\t').map(str::trim).filter(|column| !column.is_empty());
    let (first, second) = (columns.next()?, columns.next());
    let (offset, rest) = first.split_once(':')?;
    u64::from_str_radix(offset, 16).ok()?;
    match rest.trim() {
        "" => Some(second?.to_owned()),
        kind => {
            // Mangled names and the functions' numbers in the names of their constants differ between builds.
            let target = second.filter(|target| !target.contains("_R") && !target.contains("_ZN"));
            let target = target.unwrap_or("a function");
            let constant = target.strip_prefix(".LCPI").and_then(|label| label.split_once('_'));
            Some(match constant {
                Some((_, number)) => format!("{offset}: {kind} constant {number}"),
                None => format!("{offset}: {kind} {target}"),
            })
        }
    }
}

fn program(variable: &str, usual: &str) -> Command {
    let named = std::env::var_os(variable).filter(|value| !value.is_empty());
    Command::new(named.unwrap_or_else(|| usual.into()))
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
