//! Instructions of a step by their work: emitted code, code by hand and the peer's, counted by callgrind.
//!
//! Each instruction belongs to the innermost function on its way through inlined calls that one of the rules below names; in code by
//! hand, to the comment of one word above its line.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use mbs_tests::tools;

/// Parts of a step, in the order of the table.
pub const PARTS: [&str; 6] = ["sines", "evaluation", "elimination", "checks", "state", "merged"];

/// Motions of the two runs whose difference counts.
const MOTIONS: [u32; 2] = [1, 4];

/// Steps of a motion.
const STEPS: f64 = 360.0;

const SINES: usize = 0;
const EVALUATION: usize = 1;
const ELIMINATION: usize = 2;
const CHECKS: usize = 3;
const STATE: usize = 4;
const MERGED: usize = 5;

/// Parts of functions by what the path of their file holds.
const FILES: [(&str, usize); 8] = [
    ("/scalar/trigonometry/", SINES),
    ("/linear_algebra/", ELIMINATION),
    ("/block_solvers/", CHECKS),
    ("/kinematics/", CHECKS),
    ("/mechanism/margin.rs", CHECKS),
    ("/stepper/fast_step.rs", CHECKS),
    ("/stepper/", STATE),
    ("/tolerances/", CHECKS),
];

/// Functions of the runtime whose part is another one than that of their file.
const PREDICTION: [&str; 4] = ["predicted", "predicted_side_by_side", "foreseen", "added"];

/// Emitted functions that eliminate, and those that check.
const EMITTED_ELIMINATION: [&str; 5] = ["eliminate", "solve_once", "solve", "factorize", "solve_linear"];
const EMITTED_CHECKS: [&str; 2] = ["branches", "limits"];

/// Sections of code by hand: line of each comment of one word, and its part.
fn sections(by_hand: &str) -> BTreeMap<usize, usize> {
    let part = |line: &str| match line.trim() {
        "// Evaluation" => Some(EVALUATION),
        "// Elimination" => Some(ELIMINATION),
        "// Checks" => Some(CHECKS),
        "// State" | "// Prediction" => Some(STATE),
        _ => None,
    };
    by_hand.lines().zip(1..).filter_map(|(line, number)| Some((number, part(line)?))).collect()
}

/// Counts a step of `subject` of the linkage `name`, part by part.
pub fn parts(program: &Path, name: &str, subject: &str, by_hand: &str) -> Result<[f64; PARTS.len()], String> {
    let [few, many] = MOTIONS;
    let (least, most) = (collected(program, name, subject, few)?, collected(program, name, subject, many)?);
    let places: Vec<&Place> = most.keys().collect();
    let chains = chains(program, &places)?;
    let (sections, mut parts) = (sections(by_hand), [0.0; PARTS.len()]);
    let steps = STEPS * f64::from(many - few);
    for (place, chain) in places.iter().zip(&chains) {
        let count = most[*place].saturating_sub(least.get(*place).copied().unwrap_or(0));
        if count > 0 {
            parts[part(place, chain, &sections)] += count as f64 / steps;
        }
    }
    Ok(parts)
}

/// Address of an instruction of the program; of those elsewhere the name of their function alone.
type Place = (u64, String);

/// Instructions by their places.
fn collected(
    program: &Path,
    name: &str,
    subject: &str,
    motions: u32,
) -> Result<BTreeMap<Place, u64>, String> {
    let file = program.with_file_name(format!("{name}.{subject}.callgrind"));
    let mut valgrind = Command::new("valgrind");
    valgrind.args(["--tool=callgrind", "--dump-instr=yes", "--compress-pos=no", "--compress-strings=no"]);
    valgrind.arg(format!("--callgrind-out-file={}", file.display()));
    valgrind.arg(program).args([name, subject, &motions.to_string()]);
    tools::output(&mut valgrind, "install valgrind")?;
    let text = fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    let own = program.to_string_lossy();
    let (mut places, mut object, mut function, mut calls) = (BTreeMap::new(), "", "", false);
    for line in text.lines() {
        if let Some(path) = line.strip_prefix("ob=") {
            object = path;
        } else if let Some(name) = line.strip_prefix("fn=") {
            function = name;
        } else if line.starts_with("calls=") {
            calls = true;
        } else if line.starts_with("0x") {
            let mut words = line.split(' ');
            let address = words.next().and_then(|word| u64::from_str_radix(&word[2..], 16).ok());
            let count: Option<u64> = words.nth(1).and_then(|word| word.parse().ok());
            // The line after a call has what was counted within it.
            if let (false, Some(address), Some(count)) = (calls, address, count) {
                let place = match object == own {
                    true => (address, String::new()),
                    false => (0, function.to_string()),
                };
                *places.entry(place).or_default() += count;
            }
            calls = false;
        }
    }
    Ok(places)
}

/// A function on the way to an instruction: its name, file and line.
struct Frame {
    function: String,
    file: String,
    line: usize,
}

/// The functions that each place stands in, the innermost first.
fn chains(program: &Path, places: &[&Place]) -> Result<Vec<Vec<Frame>>, String> {
    let mut child = Command::new("addr2line")
        .args(["-f", "-i", "-a", "-C", "-e"])
        .arg(program)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| format!("addr2line: {error}; install binutils"))?;
    let addresses: String = places.iter().map(|(address, _)| format!("{address:#x}\n")).collect();
    let mut input = child.stdin.take().ok_or("addr2line has no input")?;
    let writer = std::thread::spawn(move || input.write_all(addresses.as_bytes()));
    let output = child.wait_with_output().map_err(|error| format!("addr2line: {error}"))?;
    writer.join().map_err(|_| "addr2line")?.map_err(|error| format!("addr2line: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let mut chains: Vec<Vec<Frame>> = Vec::new();
    let mut lines = text.lines();
    while let Some(function) = lines.next() {
        if function.starts_with("0x") {
            chains.push(Vec::new());
            continue;
        }
        let place = lines.next().unwrap_or_default();
        let (file, line) = place.rsplit_once(':').unwrap_or((place, "0"));
        let line = line.split(' ').next().and_then(|line| line.parse().ok()).unwrap_or(0);
        if let Some(chain) = chains.last_mut() {
            chain.push(Frame { function: function.into(), file: file.into(), line });
        }
    }
    Ok(chains)
}

/// The part that an instruction belongs to.
fn part((_, elsewhere): &Place, chain: &[Frame], sections: &BTreeMap<usize, usize>) -> usize {
    if !elsewhere.is_empty() {
        return if elsewhere.contains("sin") || elsewhere.contains("cos") { SINES } else { STATE };
    }
    let sines = chain.iter().any(|frame| frame.file.contains("/scalar/trigonometry/"));
    if sines {
        return SINES;
    }
    // The last section before the outermost line of code by hand that has one: operators stand above all sections.
    let by_hand = chain.iter().filter(|frame| frame.file.ends_with("by_hand.rs"));
    let section = by_hand.filter_map(|frame| sections.range(..=frame.line).next_back()).next();
    if let Some((_, part)) = section {
        return *part;
    }
    for Frame { function, file, line } in chain {
        // Vectors of several lines have none.
        if *line == 0 && file.contains("/mbs-runtime/src/") {
            return MERGED;
        }
        let name = function.split('<').next().unwrap_or(function);
        // Emitted code has the place of the macro.
        if file.ends_with("/mbs-runtime/src/lib.rs") {
            return match name {
                _ if EMITTED_ELIMINATION.contains(&name) => ELIMINATION,
                _ if EMITTED_CHECKS.contains(&name) => CHECKS,
                _ => EVALUATION,
            };
        }
        let of_file =
            FILES.iter().find(|(path, _)| file.contains("/mbs-runtime/src/") && file.contains(path));
        if let Some((_, part)) = of_file {
            return if PREDICTION.contains(&name) { STATE } else { *part };
        }
        if file.ends_with(".c") {
            return EVALUATION;
        }
        if file.ends_with("main.rs") {
            return match name {
                "factorized" | "solve" => ELIMINATION,
                "step" => CHECKS,
                _ => STATE,
            };
        }
    }
    STATE
}

/// The table, with the sums of each row, and that of the `times`: the peer's over the emitted step's, the emitted one's over that by hand.
pub fn table(rows: &[(&str, &str, [f64; PARTS.len()])], times: &[(&str, [f64; 2])]) -> String {
    let mut text = format!(
        "## Instructions of a step\n\n\
         `cargo bench -p mbs-tests --bench linkages -- --counts --docs` writes this table: instructions of a step, mean over 360 steps of a \
         motion, counted by callgrind with `target-cpu=skylake`. Sines: sines and cosines. Evaluation: rows, Jacobian, γ. Elimination: \
         factors and solutions. Checks: of closing, margin, branches and of the distance from the prediction, with the iteration itself. State: \
         prediction, storing of the state. Merged: vectors \
         that the compiler made of several lines, of rates and checks most of all. Code by hand is `tests/benches/linkages/by_hand.rs`, whose first lines say what it leaves out.\n\n\
         | linkage | step | {} | all |\n|---|---|{}---|\n",
        PARTS.join(" | "),
        "---|".repeat(PARTS.len()),
    );
    for (name, subject, parts) in rows {
        let numbers: String = parts.iter().map(|part| format!(" {part:.0} |")).collect();
        let all: f64 = parts.iter().sum();
        let _ = writeln!(text, "| {} | {subject} |{numbers} {all:.0} |", name.replace('_', " "));
    }
    text += "\n| linkage | LU over emitted, time | emitted over by hand, time | LU over by hand, time |\n|---|---|---|---|\n";
    for (name, [peer, hand]) in times {
        let _ = writeln!(text, "| {} | {peer:.2} | {hand:.2} | {:.2} |", name.replace('_', " "), peer * hand);
    }
    text
}
