//! No allocation and no panic, proven by the linker: emitted code and solvers link as a static program without any
//! library. The only undefined symbols are the five functions on memory that the compiler itself calls.
//!
//! In `f64` at `opt-level` 3; in `f32` too, and at 1, 2, `"s"` and `"z"`, with the feature `long`. The program is `tests/proofs/freestanding`. ELF linkers only.
#![cfg(target_os = "linux")]

use std::ffi::OsStr;
use std::path::PathBuf;

use mbs_tests::{proofs::Workshop, tools};

/// One a mechanism and scalar type: all emitted functions and, but for lanes, all solvers.
const EXPORTS: [&str; 14] = [
    "proof_batch",
    "proof_cam_f64",
    "proof_cam_lanes",
    "proof_engine_f64",
    "proof_engine_lanes",
    "proof_entry",
    "proof_four_bar_f64",
    "proof_four_bar_lanes",
    "proof_hammer",
    "proof_parallelogram_f64",
    "proof_parallelogram_lanes",
    "proof_platform_f64",
    "proof_platform_lanes",
    "proof_sledge",
];

/// Further ones with the feature `single` of the program.
#[cfg(feature = "long")]
const SINGLE: [&str; 8] = [
    "proof_batch_f32",
    "proof_cam_f32",
    "proof_engine_f32",
    "proof_four_bar_f32",
    "proof_hammer_f32",
    "proof_parallelogram_f32",
    "proof_platform_f32",
    "proof_sleep",
];

/// The only symbols that may come from elsewhere.
const MEMORY: [&str; 5] = ["memcpy", "memmove", "memset", "memcmp", "bcmp"];

/// Parts of names that only code with a panic or an allocation contains.
const FORBIDDEN: [&str; 10] = [
    "panicking",
    "panic_fmt",
    "panic_bounds",
    "panic_const",
    "unwrap_failed",
    "expect_failed",
    "slice_index",
    "__rust_alloc",
    "alloc::",
    "proof_reached_a_panic",
];

/// Builds the library with a profile and a feature, if any, and links it; the program, or the linker's complaint.
fn linked(profile: &str, feature: Option<&str>) -> Result<PathBuf, String> {
    let workshop = Workshop::new(env!("CARGO_TARGET_TMPDIR"), "proofs", "");
    let name = format!("{}-{profile}", feature.unwrap_or("proof"));
    let chosen = format!("--profile={profile}");
    let mut arguments = vec![chosen.as_str(), "--package=proof-freestanding"];
    let feature = feature.map(|feature| format!("--features={feature}"));
    arguments.extend(feature.as_deref());
    let product = format!("{profile}/libproof_freestanding.a");
    let library = workshop
        .build(&arguments, &product, &format!("{name}.a"))
        .unwrap_or_else(|complaint| panic!("the library does not compile:\n{complaint}"));
    let program = workshop.target().join(name);
    let mut link: Vec<String> =
        ["-nostdlib", "-static", "-no-pie", "-Wl,--gc-sections", "-Wl,-e,proof_entry", "-Wl,-u,proof_entry"]
            .map(str::to_owned)
            .to_vec();
    link.extend(MEMORY.map(|function| format!("-Wl,--defsym={function}=0")));
    let mut link: Vec<&OsStr> = link.iter().map(OsStr::new).collect();
    link.extend([library.as_os_str(), OsStr::new("-o"), program.as_os_str()]);
    tools::compile(&link).map(|_| program)
}

/// Links the proof with a profile and a feature, if any, and looks at its symbols: `exports` are among them.
fn prove(profile: &str, feature: Option<&str>, exports: &[&str]) {
    let program = linked(profile, feature)
        .unwrap_or_else(|complaint| panic!("{profile}: a panic or an allocation:\n{complaint}"));
    let symbols = tools::symbols(&program);
    for &export in exports {
        assert!(symbols.iter().any(|(kind, name)| *kind == 'T' && name == export), "`{export}` is missing");
    }
    let undefined: Vec<_> = symbols.iter().filter(|(kind, _)| *kind == 'U').collect();
    assert!(undefined.is_empty(), "{profile}: {undefined:?}");
    let suspicious = |name: &str| FORBIDDEN.iter().any(|part| name.contains(part));
    let suspicious: Vec<_> = symbols.iter().filter(|(_, name)| suspicious(name)).collect();
    assert!(suspicious.is_empty(), "{profile}: {suspicious:?}");
}

/// Links a program with an index that may be out of range, which must fail.
fn reject_an_index_out_of_range(profile: &str) {
    let complaint = linked(profile, Some("control-panics")).expect_err("a panic path went unnoticed");
    let found = complaint.contains("undefined") && complaint.contains("proof_reached_a_panic");
    assert!(found, "{profile}: {complaint}");
}

#[test]
fn emitted_code_and_solvers_link_with_nothing_but_memory_functions() {
    prove("linked", None, &EXPORTS);
}

#[cfg(feature = "long")]
#[test]
fn at_every_level_they_do_in_single_precision_too() {
    for profile in ["linked", "linked-s", "linked-z", "linked-2", "linked-1"] {
        reject_an_index_out_of_range(profile);
        prove(profile, Some("single"), &[&EXPORTS[..], &SINGLE].concat());
    }
}

#[test]
fn an_index_out_of_range_is_rejected() {
    reject_an_index_out_of_range("linked");
}

#[test]
fn an_allocation_is_rejected() {
    let complaint = linked("linked", Some("control-allocates")).expect_err("an allocation went unnoticed");
    assert!(complaint.contains("undefined") && complaint.contains("malloc"), "{complaint}");
}
