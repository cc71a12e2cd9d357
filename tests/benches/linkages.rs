//! Every ready linkage and twenty random ones against CasADi's C with dense LU and with nalgebra's, at equal accuracy.
//!
//! ```text
//! cargo bench -p mbs-tests --bench linkages
//! ```
//!
//! Writes a crate with the texts of all ready mechanisms whose rows fix them, and of random linkages that assemble and turn, and
//! CasADi's C of each. The peers take the coarsest tolerance that is as accurate as the emitted code. `-- --only NAME,NAME` takes some,
//! `-- --rounds 5` is a quick trial, `-- --docs` writes the table next to this file as well. `-- --counts` counts instructions of four
//! linkages, whose steps are typed by hand too. Fails if a result is wrong, not if it is slow.
#![forbid(unsafe_code)]

#[path = "linkages/counts.rs"]
mod counts;
#[path = "linkages/random.rs"]
mod random;

use std::collections::BTreeMap;
use std::env;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use mbs_codegen::{casadi_definition, structure_of};
use mbs_tests::tools;
use mbs_workbench::verify::environment::Environment;
use mechanisms::CATALOGUE;

const REQUIREMENTS: &str = include_str!("../proofs/peers/requirements.txt");
const PEERS: &str = include_str!("linkages/peers.py");
const PROGRAM: &str = include_str!("linkages/program.rs");
const BY_HAND: &str = include_str!("linkages/by_hand.rs");

/// Linkages whose steps are typed by hand too, with the name of their type there.
const TYPED: [(&str, &str); 4] = [
    ("stephenson", "Stephenson"),
    ("jansen", "Jansen"),
    ("four_bar", "FourBar"),
    ("slider_crank", "SliderCrank"),
];

/// Random linkages.
const RANDOM: usize = 20;

/// Largest error of a step, relative to the largest position, velocity and acceleration.
const LARGEST_ERROR: f64 = 1e-10;

/// Processor whose instructions are counted: those of `x86-64-v3`, for which the compiler takes an encoding that valgrind 3.19 cannot read.
const PROCESSOR: &str = "skylake";

/// Largest linkage that a dense peer is worth being compared with.
const LARGEST: usize = 24;

/// Steps whose instructions are counted, and their names in the table.
const SUBJECTS: [(&str, &str); 4] = [
    ("emitted", "emitted"),
    ("constants", "emitted, dimensions as `const`"),
    ("hand", "by hand"),
    ("peer", "CasADi's C, LU"),
];

/// Copies of the program, each of which runs: on some machines a step takes up to
/// three times as long where the pages of its code lie unluckily.
const COPIES: u32 = 5;

/// Linkages whose steps are timed with constants in place of parameters too.
const WITH_CONSTANTS: [&str; 4] = ["four_bar", "slider_crank", "stephenson", "jansen"];

/// Largest time of a step with parameters over that with constants.
const MOST_OF_CONSTANTS: f64 = 1.03;

/// A text with what the peers need.
struct Linkage {
    /// Name of the module and of the peer's functions.
    name: String,
    type_name: String,
    text: String,
    definition: String,
    values: Vec<f64>,
    duration: f64,
    coordinates: usize,
    class: &'static str,
    /// `true` if a quarter of the coordinates or more are angles.
    has_sines: bool,
}

/// Measured ratios of a linkage: evaluation, step, step against nalgebra; times (ns) of evaluation and step; errors.
struct Ratios {
    ratios: [f64; 3],
    times: [f64; 2],
    errors: [f64; 2],
}

const CLASSES: [(&str, f64, f64); 4] = [
    ("blocks of three and more unknowns", 4.5, 6.0),
    ("chains of dyads", 7.0, 9.0),
    ("single dyads", 10.0, 12.0),
    ("no dyad", f64::NAN, f64::NAN),
];

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().collect();
    if !arguments.iter().any(|argument| argument == "--bench") {
        println!("nothing is measured without `cargo bench`");
        return ExitCode::SUCCESS;
    }
    let after = |name: &str| {
        arguments.iter().position(|argument| argument == name).and_then(|index| arguments.get(index + 1))
    };
    let rounds = after("--rounds").map_or("31", String::as_str);
    let only: Option<Vec<&str>> = after("--only").map(|names| names.split(',').collect());
    let (name, made) = match arguments.iter().any(|argument| argument == "--counts") {
        true => ("linkages_counts.md", counted(rounds)),
        false => ("linkages.md", measured(rounds, only.as_deref())),
    };
    match made {
        Ok(text) => {
            println!("{text}");
            let mut files = vec![Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("bench").join(name)];
            if arguments.iter().any(|argument| argument == "--docs") {
                files.push(Path::new(env!("CARGO_MANIFEST_DIR")).join("benches").join(name));
            }
            for file in files {
                let made = fs::create_dir_all(file.with_file_name("")).and_then(|()| fs::write(&file, &text));
                made.unwrap_or_else(|error| eprintln!("cannot write {}: {error}", file.display()));
            }
            ExitCode::SUCCESS
        }
        Err(reason) => {
            eprintln!("{reason}");
            ExitCode::FAILURE
        }
    }
}

/// Instructions of the steps that are typed by hand too, of the emitted ones and of the peer's, and their times in `rounds`.
fn counted(rounds: &str) -> Result<String, String> {
    let mut linkages = ready();
    linkages.retain(|linkage| TYPED.iter().any(|(name, _)| *name == linkage.name));
    let program = build(&linkages, "linkages_counts", PROCESSOR)?;
    let mut rows = Vec::new();
    for (name, _) in TYPED {
        for (subject, words) in SUBJECTS {
            rows.push((name, words, counts::parts(&program, name, subject, BY_HAND)?));
        }
    }
    let lines = tools::output(Command::new(program).arg(rounds), "it was built a moment ago")?;
    let (mut peers, mut typed) = (BTreeMap::new(), BTreeMap::new());
    for (name, rest) in lines.lines().filter_map(|line| line.split_once(' ')) {
        let numbers =
            |text: &str| -> Vec<f64> { text.split(' ').filter_map(|word| word.parse().ok()).collect() };
        if let Some(hand) = rest.strip_prefix("hand ") {
            if let [error, ratio] = numbers(hand)[..]
                && error < LARGEST_ERROR
            {
                typed.insert(name, ratio);
            }
        } else if let [_, _, _, step, ..] = numbers(rest)[..] {
            peers.insert(name, step);
        }
    }
    let mut times = Vec::new();
    for (name, _) in TYPED {
        match (peers.get(name), typed.get(name)) {
            (Some(peer), Some(hand)) => times.push((name, [*peer, *hand])),
            _ => return Err(format!("{name}: no step by hand that is right\n{lines}")),
        }
    }
    Ok(counts::table(&rows, &times))
}

fn measured(rounds: &str, only: Option<&[&str]>) -> Result<String, String> {
    let mut linkages = ready();
    linkages.extend(random::texts(RANDOM).into_iter().map(|(name, text)| of_random(&name, text)));
    linkages.retain(|linkage| only.is_none_or(|only| only.contains(&linkage.name.as_str())));
    let program = build(&linkages, "linkages", "native")?;
    let mut lines: BTreeMap<(&str, bool), Vec<Vec<f64>>> = BTreeMap::new();
    let mut notes = String::new();
    for copy in 0..COPIES {
        let copied = program.with_file_name(format!("linkages_{copy}"));
        let text = fs::copy(&program, &copied).map_err(|error| format!("{}: {error}", copied.display()));
        let text =
            text.and_then(|_| tools::output(Command::new(&copied).arg(rounds), "it was copied a moment ago"));
        let _ = fs::remove_file(&copied);
        for line in text?.lines() {
            let (name, rest) = line.split_once(' ').unwrap_or((line, ""));
            let Some(linkage) = linkages.iter().find(|linkage| linkage.name == name) else { continue };
            if rest.starts_with("hand ") {
                continue;
            }
            let (rest, constants) = match rest.strip_prefix("parameters ") {
                Some(rest) => (rest, true),
                None => (rest, false),
            };
            let numbers: Vec<f64> = rest.split(' ').filter_map(|word| word.parse().ok()).collect();
            if numbers.len() == if constants { 2 } else { 7 } {
                lines.entry((&linkage.name, constants)).or_default().push(numbers);
            } else if copy == 0 {
                let _ = writeln!(notes, "- {name}: {rest}");
            }
        }
    }
    let (mut found, mut constants, mut faults) = (Vec::new(), Vec::new(), Vec::new());
    for linkage in &linkages {
        let of = |constants| lines.get(&(linkage.name.as_str(), constants)).map_or(&[][..], Vec::as_slice);
        if let ([one, ..], all) = (of(false), of(false))
            && let [error, peers_error, ..] = one[..]
        {
            if error.is_nan() || error > LARGEST_ERROR {
                faults.push(format!("{}: error {error:e}, allowed are {LARGEST_ERROR:e}", linkage.name));
            }
            let ratios = [2, 3, 4].map(|column| median(all, column));
            let times = [5, 6].map(|column| least(all, column));
            found.push((linkage, Ratios { ratios, times, errors: [error, peers_error] }));
        }
        if !of(true).is_empty() {
            constants.push((linkage, least(of(true), 0) / least(of(true), 1)));
        }
    }
    if faults.is_empty() { Ok(table(&found, &constants, &notes)) } else { Err(faults.join("\n")) }
}

/// The least number of a column.
fn least(lines: &[Vec<f64>], column: usize) -> f64 {
    lines.iter().filter_map(|line| line.get(column)).copied().fold(f64::INFINITY, f64::min)
}

/// The median of a column.
fn median(lines: &[Vec<f64>], column: usize) -> f64 {
    let mut values: Vec<f64> = lines.iter().filter_map(|line| line.get(column)).copied().collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Ready mechanisms of as many rows as coordinates, without functions of the caller.
fn ready() -> Vec<Linkage> {
    let mut linkages = Vec::new();
    for card in CATALOGUE.fixed() {
        let Ok(mechanism) = card.mechanism() else { continue };
        let (coordinates, scene) = (mechanism.coordinates().len(), mechanism.scene());
        let fits = mechanism.rows().len() == coordinates && coordinates <= LARGEST;
        if !fits || !mechanism.functions().is_empty() || scene != "AllEffects" {
            continue;
        }
        let count = mechanism.variables().len();
        let values: Option<Vec<f64>> = (0..count).map(|index| mechanism.get(index)).collect();
        let (Some(values), Ok(duration)) = (values, card.duration(mechanism.as_ref())) else { continue };
        linkages.push(of((card.name(), mechanism.type_name()), mechanism.source().into(), values, duration));
    }
    linkages
}

fn of_random(name: &str, text: String) -> Linkage {
    of((name.to_lowercase(), name), text, Vec::new(), 1.0)
}

fn of((name, type_name): (String, &str), text: String, values: Vec<f64>, duration: f64) -> Linkage {
    let definition = casadi_definition(&text, None).unwrap_or_else(|fault| panic!("{name}: {fault}\n{text}"));
    let structure = structure_of(&text, None).unwrap_or_else(|fault| panic!("{name}: {fault}\n{text}"));
    let solved = structure.blocks.iter().filter(|block| !block.explicit).map(|block| block.rows.len());
    let sizes: Vec<usize> = solved.collect();
    let class = match sizes.iter().max() {
        None => CLASSES[3].0,
        Some(3..) => CLASSES[0].0,
        Some(_) if sizes.len() > 1 => CLASSES[1].0,
        Some(_) => CLASSES[2].0,
    };
    let angles = structure.coordinates.iter().filter(|coordinate| coordinate.unit == "rad").count();
    let coordinates = structure.coordinates.len();
    Linkage {
        name,
        type_name: type_name.into(),
        text,
        definition,
        values,
        duration,
        coordinates,
        class,
        has_sines: 4 * angles >= coordinates,
    }
}

/// Writes the crate and the peers' C to a `folder`, and builds both for `processor`; for another than this one with lines of the code.
fn build(linkages: &[Linkage], folder: &str, processor: &str) -> Result<PathBuf, String> {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(folder);
    let sources = directory.join("peers");
    let wrong = |error: std::io::Error| format!("{}: {error}", directory.display());
    let _ = fs::remove_dir_all(&sources);
    fs::create_dir_all(&sources).map_err(wrong)?;
    fs::create_dir_all(directory.join("src")).map_err(wrong)?;
    for Linkage { name, definition, values, .. } in linkages {
        let text = format!("{definition}\n\nVALUES = {values:?}\n");
        fs::write(sources.join(format!("{name}.py")), text).map_err(wrong)?;
    }
    let environment = Environment::ready_for(REQUIREMENTS, &|step| eprintln!("{step}"));
    let environment = environment.map_err(|error| error.to_string())?;
    let script = directory.join("peers.py");
    fs::write(&script, PEERS).map_err(wrong)?;
    eprintln!("generating the peers' code of {} linkages", linkages.len());
    tools::output(Command::new(environment.python()).arg(&script).arg(&sources), "CasADi writes the peers")?;
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let manifest = format!(
        "[package]\nname = \"linkages\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n[dependencies]\n\
         mbs-runtime = {{ path = {:?}, default-features = false, features = [\"fma\"] }}\nnalgebra = \"0.35\"\n\n\
         [build-dependencies]\ncc = \"1.2\"\n\n[profile.release]\nlto = \"fat\"\ncodegen-units = 1\npanic = \"abort\"\n\n\
         [profile.release.package.mbs-codegen]\nopt-level = 0\ncodegen-units = 16\n\n[workspace]\n",
        workspace.join("mbs-runtime")
    );
    fs::write(directory.join("Cargo.toml"), manifest).map_err(wrong)?;
    fs::write(directory.join("build.rs"), BUILD).map_err(wrong)?;
    let lock = "tests/proofs/Cargo.lock";
    fs::copy(workspace.join(lock), directory.join("Cargo.lock")).map_err(wrong)?;
    fs::write(directory.join("src/main.rs"), program(linkages)).map_err(wrong)?;
    fs::write(directory.join("src/by_hand.rs"), BY_HAND).map_err(wrong)?;
    eprintln!("building");
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(["build", "--release", "--quiet"]).current_dir(&directory);
    let triple = tools::output(Command::new("rustc").args(["--print", "host-tuple"]), "cargo has it")?;
    // With a target named, the flags are not those of the macro.
    let mut flags = format!("-C target-cpu={processor}");
    if processor != "native" {
        // Addresses of what is counted are those of the file.
        flags += " -C relocation-model=static";
        cargo.env("CARGO_PROFILE_RELEASE_DEBUG", "line-tables-only");
    }
    cargo.args(["--target", triple.trim()]).env("RUSTFLAGS", flags);
    cargo.env("CARGO_TARGET_DIR", directory.join("target")).env("PEERS_PROCESSOR", processor);
    tools::output(&mut cargo, "the bench needs cargo, which runs it")?;
    Ok(directory.join("target").join(triple.trim()).join("release/linkages"))
}

/// Compiles the C code.
const BUILD: &str = r#"fn main() {
    println!("cargo::rerun-if-changed=peers");
    let processor = std::env::var("PEERS_PROCESSOR").expect("the bench sets it");
    let files = std::fs::read_dir("peers").expect("the directory").map(|entry| entry.expect("an entry").path());
    let files = files.filter(|path| path.extension().is_some_and(|extension| extension == "c"));
    cc::Build::new().opt_level(3).flag(format!("-march={processor}")).warnings(false).files(files).compile("peers");
}
"#;

fn program(linkages: &[Linkage]) -> String {
    let (mut calls, mut functions, mut modules) = (String::new(), String::new(), String::new());
    let mut counts = String::new();
    for Linkage { name, type_name, text, duration, coordinates, .. } in linkages {
        let _ = writeln!(
            calls,
            "    linkage::<{name}::{type_name}, {coordinates}, {{ <{name}::{type_name} as Mechanism<f64, {coordinates}, {coordinates}>>::SPARSITY.len() }}>(\"{name}\", \
             Peer {{ all: {name}_all, rows: {name}_rows, gamma: {name}_gamma }}, {duration:?}, rounds);"
        );
        if let Some((_, typed)) = TYPED.iter().find(|(typed, _)| typed == name) {
            let types = format!("by_hand::{typed}, {coordinates}");
            let _ = writeln!(
                calls,
                "    by_hand_too::<{name}::{type_name}, {types}>(\"{name}\", {duration:?}, rounds);"
            );
            let _ = writeln!(
                counts,
                "        if name == \"{name}\" {{ counted::<{name}::{type_name}, {name}_const::{type_name}, {types}>(Peer {{ all: {name}_all, rows: {name}_rows, gamma: {name}_gamma }}, \
                 {duration:?}, asked); }}"
            );
        }
        for part in ["all", "rows", "gamma"] {
            let _ = writeln!(
                functions,
                "    fn {name}_{part}(a: *const *const f64, r: *mut *mut f64, i: *mut c_longlong, w: *mut f64, m: c_int) -> c_int;"
            );
        }
        let _ = writeln!(modules, "mod {name} {{\n    mbs_runtime::mechanism! {{\n{text}\n    }}\n}}");
        if WITH_CONSTANTS.contains(&name.as_str()) {
            let text = with_constants(text);
            let _ =
                writeln!(modules, "mod {name}_const {{\n    mbs_runtime::mechanism! {{\n{text}\n    }}\n}}");
            let _ = writeln!(
                calls,
                "    as_parameters::<{name}::{type_name}, {name}_const::{type_name}, {coordinates}>(\"{name}\", {duration:?}, rounds);"
            );
        }
    }
    PROGRAM
        .replace("// LINKAGES\n", &calls)
        .replace("// COUNTS\n", &counts)
        .replace("// FUNCTIONS\n", &functions)
        + &modules
}

/// The text with constants in place of parameters, and without presets and span, which name parameters.
fn with_constants(text: &str) -> String {
    let mut kept = text.to_string();
    for (word, end) in [("preset ", '}'), ("span ", ';')] {
        while let Some(start) = kept.find(word) {
            let Some(length) = kept[start..].find(end) else { break };
            kept.replace_range(start..=start + length, "");
        }
    }
    kept.replace("param ", "const ")
}

/// Smallest, median and largest of the ratios.
fn spread(mut ratios: Vec<f64>) -> [f64; 3] {
    ratios.sort_by(f64::total_cmp);
    let at = |index: usize| ratios.get(index).copied().unwrap_or(f64::NAN);
    [at(0), at(ratios.len() / 2), at(ratios.len().saturating_sub(1))]
}

fn table(found: &[(&Linkage, Ratios)], constants: &[(&Linkage, f64)], notes: &str) -> String {
    let mut text = String::from(
        "# Linkages against their peers\n\n\
         `cargo bench -p mbs-tests --bench linkages -- --docs` writes this file. Ratios are the peer's time over ours, medians of rounds \
         in which all took turns, with `target-cpu=native`; of five copies of the program the median, of times the least. A peer's step is Newton's method from the prediction on CasADi's C, with dense \
         LU by hand or nalgebra's, to the coarsest tolerance of its rows that is as accurate as the emitted code, then both rates from one \
         factorization. Steps: 360 a motion. Targets that are missed fail nothing.\n\n\
         | compared | linkages | smallest | median | largest | must | aim |\n|---|---|---|---|---|---|---|\n",
    );
    let mut line = |work: &str, ratios: Vec<f64>, [must, aim]: [f64; 2]| {
        if ratios.is_empty() {
            return;
        }
        let (count, [least, median, most]) = (ratios.len(), spread(ratios));
        let [must, aim] = [must, aim].map(|x| if x.is_nan() { String::new() } else { format!("{x:.1}") });
        let _ =
            writeln!(text, "| {work} | {count} | {least:.2} | {median:.2} | {most:.2} | {must} | {aim} |");
    };
    for (sines, work, goals) in
        [(false, "evaluation, few sines", [1.1, f64::NAN]), (true, "evaluation, with sines", [3.5, f64::NAN])]
    {
        let of = found.iter().filter(|(linkage, _)| linkage.has_sines == sines);
        line(work, of.map(|(_, ratios)| ratios.ratios[0]).collect(), goals);
    }
    for (class, must, aim) in CLASSES {
        for (index, peer) in [(1, "LU"), (2, "nalgebra")] {
            let of = found.iter().filter(|(linkage, _)| linkage.class == class);
            let ratios = of.map(|(_, ratios)| ratios.ratios[index]).collect();
            line(&format!("step, {class}, against {peer}"), ratios, [must, aim]);
        }
    }
    for (index, work) in
        ["evaluation, all", "step, all, against LU", "step, all, against nalgebra"].into_iter().enumerate()
    {
        line(work, found.iter().map(|(_, ratios)| ratios.ratios[index]).collect(), [f64::NAN; 2]);
    }
    if !constants.is_empty() {
        let _ = write!(
            text,
            "\n| step with dimensions as `param`, time over that with `const` | least of each | must |\n|---|---|---|\n"
        );
        for (linkage, ratio) in constants {
            let name = linkage.name.replace('_', " ");
            let _ = writeln!(text, "| {name} | {ratio:.3} | at most {MOST_OF_CONSTANTS:.2} |");
        }
    }
    text += "\n| linkage | coordinates | structure | evaluation | step, LU | step, nalgebra | evaluation, ns | step, ns | error | peer's error |\n\
             |---|---|---|---|---|---|---|---|---|---|\n";
    for (linkage, Ratios { ratios: [a, b, c], times: [time, step], errors: [own, peers] }) in found {
        let Linkage { name, coordinates, class, .. } = linkage;
        let _ = writeln!(
            text,
            "| {} | {coordinates} | {class} | {a:.2} | {b:.2} | {c:.2} | {time:.1} | {step:.1} | {own:.1e} | {peers:.1e} |",
            name.replace('_', " ")
        );
    }
    if !notes.is_empty() {
        text += &format!("\nLeft out:\n\n{notes}");
    }
    text
}
