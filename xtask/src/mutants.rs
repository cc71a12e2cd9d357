//! Mutants of `cargo mutants`: a sample over seven areas, each change of which a test must notice.
//!
//! The sample stands in `xtask/mutants/sample.txt`, a mutant a line with its outcome. It is judged in pieces, and each outcome is stored at
//! once. A mutant is named by its file, its change and its place among equal changes of the file, so that it outlives shifted lines.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};

use crate::planted::copied;
use crate::shell::{command, need, output, root, target};

/// A part of the engine, and the tests that judge it in less than a minute.
struct Area {
    name: &'static str,
    /// Files, as patterns of `cargo mutants --file`.
    files: &'static [&'static str],
    /// Tests, those first that end soonest: the next ones run where none before failed.
    tests: &'static [&'static [&'static str]],
}

const AREAS: [Area; 7] = [
    Area {
        name: "differentiation",
        files: &[
            "mbs-codegen/src/symbolic/derivatives.rs",
            "mbs-codegen/src/symbolic/differentiate.rs",
            "mbs-codegen/src/equations/gradients.rs",
            "mbs-codegen/src/equations/power_of_time.rs",
            "mbs-codegen/src/equations/sparse.rs",
        ],
        tests: CODE_GENERATOR,
    },
    Area {
        name: "rewrite rules",
        files: &[
            "mbs-codegen/src/symbolic/rules.rs",
            "mbs-codegen/src/symbolic/powers.rs",
            "mbs-codegen/src/symbolic/operations.rs",
            "mbs-codegen/src/symbolic/graph.rs",
            "mbs-codegen/src/symbolic/angles.rs",
        ],
        tests: CODE_GENERATOR,
    },
    Area { name: "structure", files: &["mbs-codegen/src/structure/*.rs"], tests: CODE_GENERATOR },
    Area {
        name: "elimination",
        files: &["mbs-codegen/src/emit/rust/elimination/*.rs", "mbs-runtime/src/linear_algebra/*.rs"],
        tests: &[
            &["-p", "mbs-codegen", "--lib"],
            &["-p", "mbs-codegen", "--test", "emitted"],
            &["-p", "mbs-runtime", "--lib"],
            &["-p", "mbs-tests", "--test", "elimination"],
        ],
    },
    Area {
        name: "Newton's method",
        files: &["mbs-runtime/src/block_solvers/*.rs"],
        tests: &[
            &["-p", "mbs-runtime", "--lib"],
            &["-p", "mbs-runtime", "--test", "kinematics"],
            &["-p", "mbs-runtime", "--test", "change_points"],
            &["-p", "mbs-runtime", "--test", "positions"],
        ],
    },
    Area {
        name: "projection",
        files: &[
            "mbs-runtime/src/dynamics/formulations/projection.rs",
            "mbs-runtime/src/dynamics/formulations/velocity_transformation.rs",
            "mbs-runtime/src/dynamics/formulations/block_elimination.rs",
            "mbs-runtime/src/kinematics/position.rs",
        ],
        tests: &[
            &["-p", "mbs-runtime", "--lib"],
            &["-p", "mbs-runtime", "--test", "dynamics"],
            &["-p", "mbs-runtime", "--test", "kinematics"],
            &["-p", "mbs-motions", "--test", "singular"],
        ],
    },
    Area {
        name: "events",
        files: &["mbs-runtime/src/dynamics/integrators/event/*.rs"],
        tests: &[
            &["-p", "mbs-runtime", "--lib", "integrators"],
            &["-p", "mbs-runtime", "--test", "dynamics"],
            &["-p", "mbs-cases", "--test", "events"],
        ],
    },
];

const CODE_GENERATOR: &[&[&str]] = &[
    &["-p", "mbs-codegen", "--test", "emitted"],
    &["-p", "mbs-codegen", "--test", "scenes"],
    &["-p", "mbs-codegen", "--lib"],
    &["-p", "mbs-codegen", "--test", "repeated_rows"],
    &["-p", "mbs-tests", "--test", "scales"],
    &["-p", "mbs-tests", "--test", "random_texts"],
];

/// Least number of mutants of an area, and number of all.
const LEAST: usize = 20;
const ALL: usize = 400;

/// Share of caught mutants that the lower bound must reach.
const CAUGHT: f64 = 0.93;

/// Quantile of the normal distribution for a bound that holds in 95 of 100 samples.
const QUANTILE: f64 = 1.645;

/// Longest time of the tests of a mutant (s): a mutant that never ends is caught.
const TIMEOUT: &str = "600";

/// Outcomes, as they stand in the sample.
const OPEN: &str = "open";
const SURVIVED: &str = "survived";
const TIMED_OUT: &str = "timeout";
const UNVIABLE: &str = "unviable";
const NOTICED: &str = "caught";

/// A line of the sample.
struct Mutant {
    /// One of the outcomes, or `equivalent`, which a person has written with a reason.
    outcome: String,
    area: String,
    file: String,
    change: String,
    /// Place among equal changes of the file, from 1.
    place: usize,
    /// Reason of a person.
    note: String,
}

/// Draws a sample, which replaces the stored one.
///
/// # Errors
/// A missing tool with its cure, a file that cannot be written, or an area with too few mutants.
pub fn sampled(seed: u64) -> Result<(), String> {
    tool()?;
    let (mut first, mut rest) = (Vec::new(), Vec::new());
    for area in &AREAS {
        let mut listed: Vec<_> = listed(&root(), area.files)?.into_keys().collect();
        listed.sort_by_cached_key(|key| (drawn(seed, key), key.clone()));
        if listed.len() < LEAST {
            return Err(format!("{}: {} mutants, fewer than {LEAST}", area.name, listed.len()));
        }
        for (index, (file, change, place)) in listed.into_iter().enumerate() {
            let key = drawn(seed, &(file.clone(), change.clone(), place));
            let [outcome, note] = [OPEN, ""].map(String::from);
            let mutant = Mutant { outcome, area: area.name.to_string(), file, change, place, note };
            if index < LEAST { first.push(mutant) } else { rest.push((key, mutant)) }
        }
    }
    let number = first.len() + rest.len();
    rest.sort_by_key(|(key, _)| *key);
    first.extend(rest.into_iter().map(|(_, mutant)| mutant).take(ALL - first.len()));
    first.sort_by_key(|mutant| AREAS.iter().position(|area| area.name == mutant.area));
    println!("{} of {number} mutants", first.len());
    stored(&format!("seed {seed}, of {number} mutants"), &first)
}

/// Judges open mutants of the sample until so many `minutes` are over, and prints the shares.
///
/// # Errors
/// A missing tool with its cure, sources whose tests fail as they are. Once all are judged: survivors without a reason, or a share of
/// caught ones below 93 %.
pub fn judged(minutes: u64) -> Result<(), String> {
    tool()?;
    let (head, mut mutants) = read()?;
    let begin = Instant::now();
    let folder = target().join("mutants");
    let copy = folder.join("sources");
    copied(&copy)?;
    // Areas in turn, so that a piece says something about each.
    let mut order: Vec<(usize, usize)> = Vec::new();
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for (index, mutant) in mutants.iter().enumerate() {
        let count = counts.entry(mutant.area.as_str()).or_default();
        *count += 1;
        if mutant.outcome == OPEN {
            order.push((*count, index));
        }
    }
    order.sort_unstable();
    let mut sound: Vec<&str> = Vec::new();
    for (_, index) in order {
        if begin.elapsed() > Duration::from_secs(60 * minutes) {
            break;
        }
        let Some(area) = AREAS.iter().find(|area| mutants[index].area == area.name) else {
            return Err(format!("{}: unknown area `{}`", path().display(), mutants[index].area));
        };
        if !sound.contains(&area.name) {
            tested_as_they_are(&copy, area, &folder)?;
            sound.push(area.name);
        }
        let outcome = outcome(&copy, &mutants[index], area, &folder)?;
        println!("{outcome}: {} {}", mutants[index].file, mutants[index].change);
        mutants[index].outcome = outcome.to_string();
        stored(&head, &mutants)?;
    }
    verdict(&mutants)
}

/// Prints the shares of each area and the lower bound of all.
fn verdict(mutants: &[Mutant]) -> Result<(), String> {
    let count = |area: &str, outcomes: &[&str]| {
        let of_area = mutants.iter().filter(|mutant| area.is_empty() || mutant.area == area);
        of_area.filter(|mutant| outcomes.contains(&mutant.outcome.as_str())).count()
    };
    println!(
        "\n{:<16} {:>6} {:>8} {:>9} {:>8} {:>10} {:>5}",
        "area", "caught", "timeouts", "survived", "unviable", "equivalent", "open"
    );
    for area in AREAS.iter().map(|area| area.name).chain([""]) {
        let [caught, timeouts, survived, unviable, equivalent, open] =
            [NOTICED, TIMED_OUT, SURVIVED, UNVIABLE, "equivalent", OPEN]
                .map(|outcome| count(area, &[outcome]));
        let name = if area.is_empty() { "all" } else { area };
        println!(
            "{name:<16} {caught:>6} {timeouts:>8} {survived:>9} {unviable:>8} {equivalent:>10} {open:>5}"
        );
    }
    let (caught, survived) = (count("", &[NOTICED, TIMED_OUT]), count("", &[SURVIVED]));
    let bound = lower_bound(caught, caught + survived);
    println!("caught: {caught} of {}, at least {:.1} % (95 %)", caught + survived, 100.0 * bound);
    for mutant in mutants.iter().filter(|mutant| [SURVIVED, TIMED_OUT].contains(&mutant.outcome.as_str())) {
        println!("{}: {} {} #{}", mutant.outcome, mutant.file, mutant.change, mutant.place);
    }
    if count("", &[OPEN]) > 0 {
        return Ok(());
    }
    if survived > 0 {
        return Err(format!(
            "{survived} mutants survived: add a test, or `equivalent` and its reason to the line of each"
        ));
    }
    if bound < CAUGHT { Err(format!("the lower bound is below {CAUGHT}")) } else { Ok(()) }
}

/// Lower end of Wilson's interval of a share.
fn lower_bound(caught: usize, all: usize) -> f64 {
    if all == 0 {
        return 0.0;
    }
    #[expect(clippy::cast_precision_loss, reason = "counts of hundreds")]
    let (share, n) = (caught as f64 / all as f64, all as f64);
    let z2 = QUANTILE * QUANTILE / n;
    (share + z2 / 2.0 - QUANTILE * (share * (1.0 - share) / n + z2 / (4.0 * n)).sqrt()) / (1.0 + z2)
}

fn tool() -> Result<(), String> {
    need("cargo-mutants", "`cargo install --locked cargo-mutants`")
}

/// File, change, place: the name of a mutant in the sample. Its value: the name that `cargo mutants` gives it, with line and column.
type Listed = BTreeMap<(String, String, usize), String>;

/// Mutants of files of a tree.
fn listed(tree: &Path, files: &[&str]) -> Result<Listed, String> {
    let mut list = command("cargo", &["mutants", "--list", "--workspace", "--colors", "never"]);
    list.current_dir(tree);
    for file in files {
        list.args(["--file", file]);
    }
    let mut found = Listed::new();
    let mut places: BTreeMap<(String, String), usize> = BTreeMap::new();
    for name in output(&mut list)?.lines() {
        // file:line:column: change
        let mut parts = name.splitn(4, ':');
        let (Some(file), Some(_), Some(_), Some(change)) =
            (parts.next(), parts.next(), parts.next(), parts.next())
        else {
            continue;
        };
        let key = (file.to_string(), change.trim().to_string());
        // Unit tests beside the code are not mutated.
        if key.0.ends_with("tests.rs") {
            continue;
        }
        let place = places.entry(key.clone()).or_default();
        *place += 1;
        found.insert((key.0, key.1, *place), name.to_string());
    }
    Ok(found)
}

/// A number drawn for a mutant: its rank in the sample (FNV-1a).
fn drawn(seed: u64, key: &(String, String, usize)) -> u64 {
    let text = format!("{seed} {} {} {}", key.0, key.1, key.2);
    let hash = text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    // The last bytes alone reach the high bits late.
    (hash ^ (hash >> 32)).wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

/// Tests of an area on sources without a mutant.
fn tested_as_they_are(copy: &Path, area: &Area, folder: &Path) -> Result<(), String> {
    println!("\n== {}: sources as they are", area.name);
    for test in area.tests {
        let mut cargo = command("cargo", &["test", "--quiet"]);
        cargo.args(*test).current_dir(copy).env("CARGO_TARGET_DIR", folder.join("target"));
        let status = cargo.stdout(Stdio::null()).status().map_err(|error| error.to_string())?;
        if !status.success() {
            return Err(format!("cargo test {}: {status} without a mutant", test.join(" ")));
        }
    }
    Ok(())
}

/// Judges a mutant.
fn outcome(copy: &Path, mutant: &Mutant, area: &Area, folder: &Path) -> Result<&'static str, String> {
    let key = (mutant.file.clone(), mutant.change.clone(), mutant.place);
    let listed = listed(copy, &[&mutant.file])?;
    let name = listed.get(&key).ok_or_else(|| {
        format!("{} {} #{}: no longer there; draw a new sample", mutant.file, mutant.change, mutant.place)
    })?;
    let only = format!("^{}$", escaped(name));
    // Tests of the package that the mutant is in are built sooner than those that stand on it.
    let mut tests: Vec<_> = area.tests.iter().collect();
    tests.sort_by_key(|test| test.get(1).copied() != mutant.file.split('/').next());
    for test in tests {
        let out = folder.join("out");
        drop(fs::remove_dir_all(&out));
        let mut cargo = command(
            "cargo",
            &["mutants", "--in-place", "--workspace", "--baseline", "skip", "--timeout", TIMEOUT],
        );
        cargo.args(["--no-shuffle", "--colors", "never", "--file", &mutant.file, "--re", &only, "--output"]);
        // `--test-package` in place of `-p`: the mutant is not in the package that its tests are in.
        cargo.arg(&out).args(["--test-package", test.get(1).unwrap_or(&""), "--"]).args(&test[2..]);
        cargo.current_dir(copy).env("CARGO_TARGET_DIR", folder.join("target")).env("CARGO_INCREMENTAL", "1");
        let ended =
            cargo.stdout(Stdio::null()).stderr(Stdio::null()).status().map_err(|error| error.to_string())?;
        let has = |list: &str| {
            fs::read_to_string(out.join("mutants.out").join(list)).is_ok_and(|text| !text.trim().is_empty())
        };
        if has("caught.txt") {
            return Ok(NOTICED);
        }
        if has("timeout.txt") {
            return Ok(TIMED_OUT);
        }
        if has("unviable.txt") {
            return Ok(UNVIABLE);
        }
        if !has("missed.txt") {
            return Err(format!("{name}: `cargo mutants` ended with {ended} and without an outcome"));
        }
    }
    Ok(SURVIVED)
}

/// A regular expression that matches a text.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for character in text.chars() {
        // Not `<` and `>`: with a backslash they are edges of words.
        if r"\.+*?()|[]{}^$#&-~".contains(character) {
            escaped.push('\\');
        }
        escaped.push(character);
    }
    escaped
}

fn path() -> PathBuf {
    root().join("xtask/mutants/sample.txt")
}

/// Head and lines of the stored sample.
fn read() -> Result<(String, Vec<Mutant>), String> {
    let path = path();
    let text = fs::read_to_string(&path).map_err(|error| {
        format!("{}: {error}; draw one with `cargo xtask mutants --sample SEED`", path.display())
    })?;
    let head = text.lines().next().unwrap_or_default().trim_start_matches("# ").to_string();
    let mut mutants = Vec::new();
    for (number, line) in text.lines().enumerate().skip(1) {
        let fields: Vec<&str> = line.split('\t').collect();
        let [outcome, area, file, place, change, note] = fields[..] else {
            return Err(format!("{}:{}: not six fields with tabulators between", path.display(), number + 1));
        };
        let place = place.parse().map_err(|_| format!("{}:{}: `{place}`", path.display(), number + 1))?;
        let [outcome, area, file, change, note] = [outcome, area, file, change, note].map(String::from);
        mutants.push(Mutant { outcome, area, file, change, place, note });
    }
    Ok((head, mutants))
}

/// Writes the sample.
fn stored(head: &str, mutants: &[Mutant]) -> Result<(), String> {
    let mut text = format!("# {head}\n");
    for Mutant { outcome, area, file, change, place, note } in mutants {
        let written = writeln!(text, "{outcome}\t{area}\t{file}\t{place}\t{change}\t{note}");
        written.map_err(|error| error.to_string())?;
    }
    let path = path();
    let written = path.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::write(&path, text));
    written.map_err(|error| format!("{}: {error}", path.display()))
}
