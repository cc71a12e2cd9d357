//! A crate that `mbs new` writes, as a stranger uses it: run, tested, its program on texts in files.
#![cfg(all(feature = "program", unix))]

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use mbs_workbench::card::{Card, DefaultMethod};
use mbs_workbench::erased::erase::Erased;
use mbs_workbench::forge::{Blueprint, Forge, ForgeError};

/// Profiles of crates that tests write (`tests/src/written.rs`): what they need is built once for all.
const PROFILE: &str = r#"
[profile.dev]
debug = false

[profile.dev.package.mbs-runtime]
opt-level = 2
"#;

const TEXT: &str = "\
// A crank alone.
pub mechanism Crank;
coord phi: rad;
drive motor: phi == 1rad/1s*t;
out A: [m; 2] = 1m*unit(phi);
";

/// The folder of a test, made anew.
fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    drop(fs::remove_dir_all(&folder));
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn mbs(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mbs"));
    command.current_dir(folder).args(arguments).output().expect("`mbs` starts")
}

/// Standard output of what succeeds.
#[track_caller]
fn said(output: Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// Exit code and error of what fails.
#[track_caller]
fn failed(output: Output) -> (Option<i32>, String) {
    assert!(!output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Files of a source tree, with their times.
fn files(folder: &Path) -> Vec<(PathBuf, std::time::SystemTime)> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            if path.is_dir() {
                folders.push(path);
            } else {
                let time = fs::metadata(&path).and_then(|data| data.modified()).expect("a time");
                found.push((path, time));
            }
        }
    }
    found.sort();
    found
}

#[test]
fn a_new_crate_shows_a_page_and_its_tests_pass_and_it_runs_texts_of_files() {
    let folder = scratch("own_crate");
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().expect("the target directory");
    said(mbs(&folder, &["new", "roof-wiper"]));
    let own = folder.join("roof-wiper");
    let manifest = fs::read_to_string(own.join("Cargo.toml")).expect("a manifest");
    let (packages, _) = manifest.split_once("# Your own crates are").expect("profiles at the end");
    fs::write(own.join("Cargo.toml"), format!("{packages}{PROFILE}")).expect("a manifest");
    let cargo = |arguments: &[&str]| {
        let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        command
            .args(arguments)
            .current_dir(&own)
            .env("CARGO_TARGET_DIR", target)
            .output()
            .expect("cargo starts")
    };

    let page = folder.join("page");
    let shown = ["run", "--quiet", "--", "run", "roof_wiper:Turning", "--steps", "24", "--out"];
    let printed = said(cargo(&[&shown[..], &[page.to_str().expect("a path")]].concat()));
    assert!(printed.starts_with("Roof wiper\n") && printed.contains("point P"), "{printed}");
    let report = fs::read_to_string(page.join("report.html")).expect("a page");
    assert!(report.contains("20 turns a minute"));

    let tests = said(cargo(&["test"]));
    assert!(tests.contains("casadi_and_50_digits_confirm_the_derivatives ... ok"), "{tests}");

    let lines = said(cargo(&["run", "--quiet", "-p", "roof-wiper", "--example", "control_loop"]));
    for line in ["after 2 s: rocker at ", "refused: ", "after a reset: rocker at "] {
        assert!(lines.contains(line), "{line} is missing in\n{lines}");
    }
    assert!(!lines.contains("is open by") && !lines.contains("is kept"), "{lines}");

    let before = files(&own);
    let program = target.join("debug/roof-wiper-mbs");
    let wiper = |arguments: &[&str]| {
        Command::new(&program).args(arguments).current_dir(&folder).output().expect("the program starts")
    };
    // What an earlier run of this test has built would be taken.
    for entry in fs::read_dir(target.join("mbs")).into_iter().flatten().flatten() {
        if entry.file_name().to_string_lossy().starts_with("crank-") {
            fs::remove_dir_all(entry.path()).expect("an old program");
        }
    }
    fs::write(folder.join("crank.mbs"), TEXT).expect("a text");
    let run = ["run", "crank.mbs", "--steps", "8", "--out", "crank"];
    let first = wiper(&run);
    assert!(String::from_utf8_lossy(&first.stderr).contains("building a program for `crank`"));
    assert!(said(first).starts_with("Crank\n"));
    assert!(
        fs::read_to_string(folder.join("crank/report.html")).expect("a page").contains("mbs run crank.mbs")
    );
    // It is there, for other commands as well.
    let again = wiper(&["print", "crank.mbs", "q", "--at", "0.5"]);
    assert!(again.stderr.is_empty(), "{}", String::from_utf8_lossy(&again.stderr));
    assert!(said(again).contains("phi (rad)"));
    // Cures name what the command line has.
    let (code, error) = failed(wiper(&["simulate", "crank.mbs"]));
    assert_eq!(code, Some(2));
    assert!(error.contains("use `mbs kinematics crank.mbs`"), "{error}");

    // The page follows the file; a faulty text leaves it as it is.
    let mut watch = Command::new(&program)
        .args(["watch", "crank.mbs", "--steps", "8", "--out", "watched"])
        .current_dir(&folder)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    let mut watched = BufReader::new(watch.stderr.take().expect("a pipe")).lines();
    let mut until_it_waits = || -> String {
        let lines = watched.by_ref().map_while(Result::ok);
        lines.take_while(|line| !line.starts_with("watching ")).collect::<Vec<_>>().join("\n")
    };
    let version = || fs::read_to_string(folder.join("watched/version.js")).expect("a version");
    assert_eq!(until_it_waits(), "");
    let first = version();
    fs::write(folder.join("crank.mbs"), TEXT.replace("unit(phi)", "unit(psi)")).expect("a text");
    let error = until_it_waits();
    assert!(error.contains("unknown name `psi`") && error.contains("crank.mbs:5:"), "{error}");
    assert_eq!(version(), first);
    fs::write(folder.join("crank.mbs"), TEXT.replace("1m*", "0.2m*")).expect("a text");
    assert!(until_it_waits().contains("building a program for `crank`"));
    assert_ne!(version(), first);
    let page = fs::read_to_string(folder.join("watched/report.html")).expect("a page");
    assert!(version().split('"').nth(1).is_some_and(|version| page.contains(version)));
    watch.kill().and_then(|()| watch.wait()).expect("it ends");

    // A fault that the compiler alone sees, at its line of the file.
    fs::write(folder.join("faulty.mbs"), TEXT.replace("pub", "#[derive(NoSuch)]\npub")).expect("a text");
    let (code, error) = failed(wiper(&["run", "faulty.mbs"]));
    assert_eq!(code, Some(1));
    let expected = "\n  --> faulty.mbs:2:10\n  |\n2 | #[derive(NoSuch)]\n  |          ^^^^^^\n";
    assert!(
        error.contains("error: cannot find derive macro `NoSuch`") && error.contains(expected),
        "{error}"
    );

    // A program of one's own on top of the library.
    let forge = Forge { target: target.to_path_buf(), workspace: own.clone(), ..Forge::of_caller(None) };
    let card = |constructor| Card {
        make: || -> Erased { unreachable!("only its constructor is used") },
        constructor,
        module: "roof_wiper_mbs",
        manifest: Box::leak(own.join("mbs").display().to_string().into_boxed_str()),
        default_method: DefaultMethod::Projection,
        stand_in: None,
        study: None,
        known: None,
    };
    let main =
        |constructor: &str| format!("fn main() {{\n    println!(\"{{}}\", {constructor}.crank);\n}}\n");
    let blueprint =
        Blueprint::of_card(&forge, &card("roof_wiper::RoofWiperTurning::<f32>::default()"), "length", main);
    let program = forge.program(&blueprint.expect("a library"), &mut |_| ()).expect("a program");
    assert_eq!(said(Command::new(program).output().expect("it starts")), "0.1\n");
    let none = Blueprint::of_card(&forge, &card("Local::default()"), "local", main).expect_err("no library");
    assert_eq!(none, ForgeError::NoLibrary { constructor: "Local::default()".into() });
    assert_eq!(files(&own), before, "the source tree is untouched");
}

#[test]
fn a_new_crate_needs_a_name_and_a_folder_of_its_own() {
    let folder = scratch("own_crate_refused");
    fs::write(folder.join("wiper"), "mine").expect("a file");
    let (code, error) = failed(mbs(&folder, &["new", "wiper"]));
    assert_eq!(code, Some(2));
    assert!(error.contains("wiper exists already; choose another name"), "{error}");
    let (code, error) = failed(mbs(&folder, &["new", "Roof Wiper"]));
    assert_eq!(code, Some(2));
    assert!(error.contains("for example `mbs new roof-wiper`"), "{error}");
    assert_eq!(files(&folder).len(), 1, "nothing is written");
    said(mbs(&folder, &["new", "rod", "--git", "https://example.org/mbs"]));
    let manifest = fs::read_to_string(folder.join("rod/mbs/Cargo.toml")).expect("a manifest");
    assert!(manifest.contains("mbs-workbench = { git = \"https://example.org/mbs\" }"), "{manifest}");
}
