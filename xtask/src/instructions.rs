//! Instructions of evaluations and steps, counted by callgrind and compared with stored counts.
//!
//! The stored counts are those of the default target, as valgrind does not know every form of AVX's instructions. Their first
//! line names the compiler. Under another compiler the counts are printed and not judged.

use std::collections::BTreeMap;
use std::fs;

use crate::shell::{command, compiler, install, output, root, target};

const STORED: &str = "tests/proofs/instructions/counts.txt";

/// Per cent that a count may move by; the same code built twice gives the same count.
const LIMIT: f64 = 2.0;

/// Repetitions of the two runs whose difference counts.
const REPETITIONS: [u64; 2] = [200, 1200];

/// Per cent that a loop of a chain may take more than one of the shortest chain of its kind. That has ten loops if every block
/// is straight-line code, 48 if the blocks are rounds of a loop.
const GROWTH: f64 = 10.0;

/// Per cent that a loop of any chain may take more than one of ten.
const CLIFF: f64 = 80.0;

/// Loops from which on the blocks of a chain are rounds of a loop.
const ROLLED: u64 = 48;

/// Works and their counts, in the order of the program.
type Counts = Vec<(String, u64)>;

/// Counts all works, and compares them with the stored counts, or stores them.
///
/// # Errors
/// A missing tool, a work that cannot be counted, a count changed by more than [`LIMIT`], or faster than linear growth of a
/// chain.
pub fn run(update: bool) -> Result<(), String> {
    if !cfg!(target_arch = "x86_64") {
        println!("\n== not run: instructions are counted on x86-64 alone");
        return Ok(());
    }
    println!("\n== instructions");
    install("valgrind", "valgrind")?;
    let (compiler, found) = (compiler()?, count_all()?);
    check_chains(&found)?;
    let path = root().join(STORED);
    if update {
        let lines: String = found.iter().map(|(work, count)| format!("{work} {count}\n")).collect();
        let text = format!("# {compiler}\n{lines}");
        print!("{text}");
        return fs::write(&path, text).map_err(|error| format!("{STORED}: {error}"));
    }
    let text = fs::read_to_string(&path).map_err(|error| format!("{STORED}: {error}"))?;
    let (first, rest) = text.split_once('\n').unwrap_or((&text, ""));
    if first != format!("# {compiler}") {
        println!("not judged: the stored counts are those of {first}, this is {compiler}");
        found.iter().for_each(|(work, count)| println!("{work} {count}"));
        return Ok(());
    }
    compare(&stored(rest)?, &found)
}

/// Builds the program where `tests/tests/proofs/panic_free.rs` does, and runs each of its works.
fn count_all() -> Result<Counts, String> {
    let target = target().join("tmp/proofs");
    let triple = output(&mut command("rustc", &["--print", "host-tuple"]))?;
    let triple = triple.trim();
    let options = ["build", "--quiet", "--locked", "--release", "--target", triple];
    let package = ["--manifest-path", "tests/proofs/Cargo.toml", "--package", "proof-instructions"];
    let mut build = command("cargo", &options);
    // With a target named, the flags are not those of the macro, which is there already.
    build.args(package).env("RUSTFLAGS", "-C target-cpu=x86-64").env("CARGO_TARGET_DIR", &target);
    output(&mut build)?;
    let program = target.join(triple).join("release/proof-instructions");
    let program = program.to_str().ok_or("the target directory is not UTF-8")?;
    let works = output(&mut command(program, &[]))?;
    works.split_whitespace().map(|work| Ok((work.to_string(), count(program, work)?))).collect()
}

/// Instructions of one repetition of `work`.
fn count(program: &str, work: &str) -> Result<u64, String> {
    let [few, many] = REPETITIONS;
    let (least, most) = (collected(program, work, few)?, collected(program, work, many)?);
    Ok(most.saturating_sub(least) / (many - few))
}

fn collected(program: &str, work: &str, repetitions: u64) -> Result<u64, String> {
    let options =
        ["--tool=callgrind", "--callgrind-out-file=/dev/null", program, work, &repetitions.to_string()];
    let mut valgrind = command("valgrind", &options);
    // One instruction that moves a thousand bytes would count as a thousand: long moves are counted as loops.
    let tunables =
        "glibc.cpu.x86_rep_movsb_threshold=0x10000000:glibc.cpu.x86_rep_stosb_threshold=0x10000000";
    let run =
        valgrind.env("GLIBC_TUNABLES", tunables).output().map_err(|error| format!("valgrind: {error}"))?;
    let text = String::from_utf8_lossy(&run.stderr);
    let count = text.split("Collected : ").nth(1).and_then(|rest| rest.split_whitespace().next());
    let count = count.and_then(|count| count.parse().ok()).filter(|_| run.status.success());
    count.ok_or_else(|| format!("{text}\n{work} cannot be counted"))
}

/// Instructions of a loop in chains of more and more loops.
fn check_chains(found: &Counts) -> Result<(), String> {
    let chain = |(work, count): &(String, u64)| {
        let loops: u64 = work.strip_prefix("step_chain_of_")?.parse().ok()?;
        Some((loops, *count as f64 / loops as f64))
    };
    let chains: BTreeMap<u64, f64> = found.iter().filter_map(chain).collect();
    let mut faults = Vec::new();
    for (loops, each) in &chains {
        let shortest = if *loops < ROLLED { 10 } else { ROLLED };
        let more = |least: u64| chains.get(&least).map_or(f64::NAN, |base| 100.0 * (each / base - 1.0));
        let (kind, ten) = (more(shortest), more(10));
        println!(
            "a loop of {loops:3}: {each:6.0} ({kind:+.0} % of one of {shortest}, {ten:+.0} % of one of 10)"
        );
        if *loops > 10 && (kind > GROWTH || ten > CLIFF) {
            faults.push(format!(
                "a loop of {loops} takes {kind:.0} % more than one of {shortest} (limit {GROWTH} %), {ten:.0} % more than one of 10 (limit {CLIFF} %)"
            ));
        }
    }
    if faults.is_empty() { Ok(()) } else { Err(faults.join("\n")) }
}

fn stored(text: &str) -> Result<Counts, String> {
    let line = |line: &str| {
        let (work, count) = line.split_once(' ')?;
        Some((work.to_string(), count.parse().ok()?))
    };
    text.lines().map(|text| line(text).ok_or_else(|| format!("{STORED}: not a count: {text}"))).collect()
}

fn compare(stored: &Counts, found: &Counts) -> Result<(), String> {
    let mut faults = Vec::new();
    for (work, count) in found {
        let Some(before) = get(stored, work) else {
            faults.push(format!("{work}: no stored count"));
            continue;
        };
        let change = 100.0 * (*count as f64 - before as f64) / before as f64;
        println!("{work:32} {count:6}, stored {before:6} ({change:+.1} %)");
        if change.abs() > LIMIT {
            faults.push(format!("{work} has moved by {change:+.1} %"));
        }
    }
    let gone = stored.iter().filter(|(work, _)| get(found, work).is_none());
    faults.extend(gone.map(|(work, _)| format!("{work} is no longer counted")));
    if faults.is_empty() {
        return Ok(());
    }
    Err(format!(
        "{}\nlimit {LIMIT} %; if it is meant: `cargo xtask instructions --update`",
        faults.join("\n")
    ))
}

fn get(counts: &Counts, work: &str) -> Option<u64> {
    counts.iter().find(|(name, _)| name == work).map(|(_, count)| *count)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(text: &str) -> Counts {
        stored(text).expect("counts")
    }

    #[test]
    fn a_count_that_moves_by_more_than_the_limit_fails_either_way() {
        let before = counts("step 1000\nrates 50");
        assert_eq!(compare(&before, &counts("step 1020\nrates 50")), Ok(()));
        for after in ["step 1021\nrates 50", "step 979\nrates 50", "step 1000", "step 1000\nrates 50\nnew 1"]
        {
            assert!(compare(&before, &counts(after)).is_err(), "{after}");
        }
        assert!(stored("step many").is_err());
    }

    #[test]
    fn chains_grow_linearly_within_each_kind() {
        let linear =
            "step_chain_of_10 1000\nstep_chain_of_40 4100\nstep_chain_of_48 8000\nstep_chain_of_200 33500";
        assert_eq!(check_chains(&counts(linear)), Ok(()));
        assert!(check_chains(&counts("step_chain_of_10 1000\nstep_chain_of_40 4500")).is_err());
        assert!(check_chains(&counts("step_chain_of_10 1000\nstep_chain_of_48 9000")).is_err(), "the cliff");
    }
}
