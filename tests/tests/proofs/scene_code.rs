//! Effects that a scene leaves out cause no instruction: the machine code of its functions equals, byte by byte, that of a
//! text without them.
//!
//! The library is `tests/proofs/scenes`, built three times. ELF alone.
#![cfg(target_os = "linux")]

use std::collections::BTreeMap;

use mbs_tests::{proofs::Workshop, tools};

/// Functions of the library, all emitted ones of the slider-crank but the copy of the whole struct. Of the bodies powers, rates of states
/// and slopes of forces are compared too; without an effect those are empty or one function.
const FUNCTIONS: [&str; 27] = [
    "parameters",
    "guess",
    "coordinate_scales",
    "row_scales",
    "position",
    "phi",
    "phi_q",
    "phi_q_entries",
    "phi_t",
    "phi_tt",
    "phi_qt_qd",
    "gamma",
    "branches",
    "limits",
    "outputs",
    "evaluate",
    "solve_blocks",
    "factorize",
    "solve_linear",
    "get",
    "set",
    "bodies_parameters",
    "bodies_position",
    "bodies_mass",
    "bodies_mass_times",
    "bodies_force",
    "bodies_energy",
];

/// Those that no effect on the bodies changes: forces have no mass.
const WITHOUT_EFFECT: [&str; 2] = ["bodies_mass", "bodies_mass_times"];

/// Machine code: functions by name, and the functions of the machine and of the runtime that they call. The latter have
/// different names in the three builds.
#[derive(Debug, PartialEq)]
struct Code {
    functions: BTreeMap<String, Vec<String>>,
    called: Vec<Vec<String>>,
}

const PREFIX: &str = "scene_";

fn code(feature: &str) -> Code {
    let workshop = Workshop::new(env!("CARGO_TARGET_TMPDIR"), "proofs", "");
    let features = format!("--features={feature}");
    let arguments = ["--profile=linked", "--package=proof-scenes", &features];
    let library = workshop
        .build(&arguments, "linked/libproof_scenes.a", &format!("scenes_{feature}.a"))
        .unwrap_or_else(|complaint| panic!("the library does not compile:\n{complaint}"));
    let own = |name: &str| {
        name.starts_with(PREFIX) || ["proof_scenes", "mbs_runtime"].iter().any(|part| name.contains(part))
    };
    let listed = tools::disassembly(&library, own);
    let (functions, called): (BTreeMap<_, _>, BTreeMap<_, _>) =
        listed.into_iter().partition(|(name, _)| name.starts_with(PREFIX));
    let mut called: Vec<_> = called.into_values().collect();
    called.sort();
    Code { functions, called }
}

#[test]
fn a_scene_without_an_effect_is_the_machine_code_of_the_text_without_it() {
    let (alone, without, with) = (code("alone"), code("without"), code("with"));
    let names: Vec<_> = FUNCTIONS.map(|name| format!("{PREFIX}{name}")).into();
    assert!(names.iter().all(|name| alone.functions.get(name).is_some_and(|code| !code.is_empty())));
    for (name, expected) in &alone.functions {
        assert_eq!(&without.functions[name], expected, "`{name}`");
    }
    assert!(!alone.called.is_empty());
    assert_eq!(without, alone);
    // The control: the effect is in the code where it is in the scene.
    let changes = |name: &&String| !WITHOUT_EFFECT.contains(&&name[PREFIX.len()..]);
    let same: Vec<_> =
        names.iter().filter(changes).filter(|name| with.functions[*name] == alone.functions[*name]).collect();
    assert!(same.is_empty(), "the effect leaves no trace in {same:?}");
    let lines = |code: &Code| code.functions.values().chain(&code.called).map(Vec::len).sum::<usize>();
    println!(
        "{} functions and {} that they call: {} lines of machine code without the effect, {} with it",
        alone.functions.len(),
        alone.called.len(),
        lines(&alone),
        lines(&with)
    );
}
