//! Fuzzing of texts and of calls on running mechanisms, from the inputs that are kept in `tests/fuzz/corpus`.
//!
//! An input is a line of hexadecimal digits there: thousands of small files would hide the tree.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use crate::shell::{command, need, output, root, step, target};

/// Longest input that is kept (bytes): longer ones are quickly found again from the texts of the hard cases.
const LONGEST: usize = 200;

const TARGETS: [&str; 3] = ["tokens", "texts", "states"];

/// Fuzzes each target for so many `seconds`; with `keep` the inputs that reach new code are added to the kept ones.
///
/// # Errors
/// A missing tool with its cure, a build that fails, or an input with a panic, whose file is named.
pub fn run(seconds: u32, keep: bool) -> Result<(), String> {
    need("cargo-fuzz", "`cargo install cargo-fuzz`")?;
    let folder = target().join("fuzz");
    let build = folder.display().to_string();
    // Coverage alone: sanitizers need a nightly compiler, and nothing here is unsafe.
    let options = ["--fuzz-dir", "tests/fuzz", "--sanitizer", "none", "-O", "--target-dir", &build];
    step(command("cargo", &["fuzz", "build"]).args(options).current_dir(root()))?;
    let triple = output(&mut command("rustc", &["--print", "host-tuple"]))?;
    for name in TARGETS {
        let corpus = folder.join("corpus").join(name);
        unpacked(name, &corpus)?;
        let program = folder.join(triple.trim()).join("release").join(name);
        let program = program.display().to_string();
        let findings = folder.join("found").join(name);
        fs::create_dir_all(&findings).map_err(|error| format!("{}: {error}", findings.display()))?;
        let mut fuzz = command(&program, &[]);
        fuzz.arg(&corpus)
            .arg(format!("-max_total_time={seconds}"))
            .arg(format!("-artifact_prefix={}/", findings.display()))
            .args(["-timeout=20", "-len_control=0", "-max_len=1024", "-verbosity=0", "-print_final_stats=1"]);
        if name == "tokens" {
            // Whole texts beside the kept parts: a second folder is read alone.
            fuzz.arg(root().join("mbs-workbench/hard_cases"))
                .arg(format!("-dict={}", root().join("tests/fuzz/tokens.dict").display()));
        }
        step(&mut fuzz).map_err(|failed| {
            format!("{failed}\nthe input is in {}; repeat it with `{program} FILE`", findings.display())
        })?;
        if keep {
            kept(name, &program, &corpus)?;
        }
    }
    Ok(())
}

/// File of the kept inputs of a target.
fn lines(name: &str) -> PathBuf {
    root().join("tests/fuzz/corpus").join(name).with_extension("hex")
}

/// Writes each kept input into a file of its own.
fn unpacked(name: &str, corpus: &Path) -> Result<(), String> {
    let (path, failed) = (lines(name), |path: &Path, error| format!("{}: {error}", path.display()));
    let text = fs::read_to_string(&path).map_err(|error| failed(&path, error))?;
    fs::create_dir_all(corpus).map_err(|error| failed(corpus, error))?;
    for (number, line) in text.lines().enumerate() {
        let bytes =
            bytes(line).ok_or_else(|| format!("{}:{}: not hexadecimal", path.display(), number + 1))?;
        let file = corpus.join(format!("kept_{number}"));
        fs::write(&file, bytes).map_err(|error| failed(&file, error))?;
    }
    Ok(())
}

/// Keeps the fewest inputs that reach all that `corpus` reaches, the shortest first.
fn kept(name: &str, program: &str, corpus: &Path) -> Result<(), String> {
    let fewest = corpus.with_extension("fewest");
    let failed = |error| format!("{}: {error}", fewest.display());
    let _ = fs::remove_dir_all(&fewest);
    fs::create_dir_all(&fewest).map_err(failed)?;
    step(command(program, &["-merge=1", "-verbosity=0", "-max_len=1024"]).arg(&fewest).arg(corpus))?;
    let mut inputs = Vec::new();
    for entry in fs::read_dir(&fewest).map_err(failed)? {
        let input = fs::read(entry.map_err(failed)?.path()).map_err(failed)?;
        if input.len() <= LONGEST {
            inputs.push(input);
        }
    }
    inputs.sort_by(|a, b| (a.len(), a).cmp(&(b.len(), b)));
    let mut text = String::new();
    for input in inputs {
        for byte in input {
            let _ = write!(text, "{byte:02x}");
        }
        text.push('\n');
    }
    let path = lines(name);
    fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))
}

/// Bytes of pairs of hexadecimal digits.
fn bytes(line: &str) -> Option<Vec<u8>> {
    let (pairs, rest) = line.as_bytes().as_chunks::<2>();
    let pair = |pair: &[u8; 2]| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok();
    if rest.is_empty() { pairs.iter().map(pair).collect() } else { None }
}
