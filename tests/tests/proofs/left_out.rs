//! Every effect left out of a text that has them all, one after the other: the machine code of the scene is that of a text in which the effect
//! was never written, instruction by instruction, and the linked program has no function of it.
//!
//! The library is `tests/proofs/left_out`, built twice. ELF alone.
#![cfg(target_os = "linux")]

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use mbs_tests::{proofs::Workshop, tools};

const PREFIX: &str = "left_out_";

/// The scene in which every effect is.
const NOTHING: &str = "nothing";

/// The only symbols that may come from elsewhere.
const MEMORY: [&str; 5] = ["memcpy", "memmove", "memset", "memcmp", "bcmp"];

/// Effects with functions that no other one calls as they do: curves, laws, sines, powers, `tanh`.
const WITH_FUNCTIONS: [&str; 6] = ["cam", "gas", "smooth", "table", "tyre", "wave"];

/// Machine code of a build.
struct Code {
    library: PathBuf,
    /// By left out effect and function.
    functions: BTreeMap<String, BTreeMap<String, Vec<String>>>,
    /// Of functions that these call.
    called: Vec<Vec<String>>,
}

fn code(workshop: &Workshop, features: &[&str], copy: &str) -> Code {
    let arguments = [&["--profile=linked", "--package=proof-left-out"], features].concat();
    let library = workshop
        .build(&arguments, "linked/libproof_left_out.a", copy)
        .unwrap_or_else(|complaint| panic!("the library does not compile:\n{complaint}"));
    let own = |name: &str| {
        name.starts_with(PREFIX) || ["proof_left_out", "mbs_runtime"].iter().any(|part| name.contains(part))
    };
    let listed = tools::disassembly(&library, own);
    let sections = tools::sections(&library, own);
    let by_section: BTreeMap<&String, &Vec<String>> =
        listed.iter().filter_map(|(name, code)| Some((sections.get(name)?, code))).collect();
    let mut functions: BTreeMap<String, BTreeMap<String, Vec<String>>> = BTreeMap::new();
    for (name, section) in &sections {
        if let Some((effect, function)) = name.strip_prefix(PREFIX).and_then(|name| name.split_once('.')) {
            let code = by_section.get(section).unwrap_or_else(|| panic!("`{name}` has no code"));
            functions.entry(effect.to_owned()).or_default().insert(function.to_owned(), (*code).clone());
        }
    }
    let mut called: Vec<_> =
        listed.into_iter().filter(|(name, _)| !name.starts_with(PREFIX)).map(|(_, code)| code).collect();
    called.sort();
    Code { library, functions, called }
}

/// Functions of the program that is linked from those without one effect, without their own names: name and size. Code of the texts has other
/// names in both builds.
fn program(code: &Code, effect: &str, target: &Path) -> Vec<(String, usize)> {
    let names = code.functions[effect].keys().map(|function| format!("{PREFIX}{effect}.{function}"));
    let mut link: Vec<String> =
        ["-nostdlib", "-static", "-no-pie", "-Wl,--gc-sections"].map(str::to_owned).to_vec();
    link.push(format!("-Wl,-e,{PREFIX}{effect}.force"));
    link.extend(names.map(|name| format!("-Wl,-u,{name}")));
    link.extend(MEMORY.map(|function| format!("-Wl,--defsym={function}=0")));
    let program = target.join("left_out");
    let mut link: Vec<&OsStr> = link.iter().map(OsStr::new).collect();
    link.extend([code.library.as_os_str(), OsStr::new("-o"), program.as_os_str()]);
    tools::compile(&link).unwrap_or_else(|complaint| panic!("without `{effect}`:\n{complaint}"));
    let mut functions: Vec<(String, usize)> = tools::functions(&program)
        .into_iter()
        .filter(|(name, _)| !name.starts_with(PREFIX))
        .map(|(name, size)| {
            let name = name.rsplit_once("17h").map_or(name.clone(), |(name, _)| name.to_owned());
            let named = if name.contains("proof_left_out") { "of the text".to_owned() } else { name };
            (named, size)
        })
        .collect();
    functions.sort();
    functions
}

#[test]
fn every_effect_that_is_left_out_leaves_no_instruction_and_no_function() {
    let workshop = Workshop::new(env!("CARGO_TARGET_TMPDIR"), "proofs", "");
    let scenes = code(&workshop, &["--features=scenes"], "left_out_scenes.a");
    let never_written = code(&workshop, &[], "left_out_never_written.a");
    assert_eq!(scenes.functions.len(), 25);
    let whole = &scenes.functions[NOTHING];
    let linked = |code, effect| program(code, effect, workshop.target());
    let everything = linked(&scenes, NOTHING);
    let lines = |code: &BTreeMap<String, Vec<String>>| code.values().map(Vec::len).sum::<usize>();
    for (effect, functions) in &scenes.functions {
        let expected = &never_written.functions[effect];
        assert_eq!(functions.len(), 24, "{effect}");
        for (name, code) in functions {
            assert!(!code.is_empty() && expected[name] == *code, "`{name}` without `{effect}`");
        }
        let symbols = linked(&scenes, effect);
        assert_eq!(symbols, linked(&never_written, effect), "without `{effect}`");
        // The control: each effect is in the code where it is in the scene.
        let gone = everything.iter().filter(|function| !symbols.contains(function)).count();
        assert!(effect == NOTHING || functions != whole, "{effect}");
        assert!(gone > 0 || !WITH_FUNCTIONS.contains(&effect.as_str()), "{effect}");
        println!(
            "without {effect}: {} of {} lines of machine code, {} of {} functions that they call, {gone} gone",
            lines(functions),
            lines(whole),
            symbols.len(),
            everything.len()
        );
    }
    assert!(scenes.called == never_written.called);
}
