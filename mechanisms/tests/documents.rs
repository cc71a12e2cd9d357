//! `--json`: every command prints one document, whose fields are those of `documents.txt` and of the book.
//!
//! `UPDATE_SNAPSHOTS=1` writes the fields anew; a field that goes or changes its kind needs a higher number in the schema.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn scratch() -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("documents-{}", std::process::id()));
    fs::create_dir_all(&path).expect("a directory");
    path
}

fn mbs(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mbs-catalogue"));
    command.current_dir(folder).args(arguments).arg("--json").output().expect("the program starts")
}

/// The one document that a command prints.
#[track_caller]
fn document(output: &Output) -> Value {
    let text = String::from_utf8(output.stdout.clone()).expect("UTF-8");
    let said = String::from_utf8_lossy(&output.stderr);
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}\n{said}"))
}

/// Paths of all fields with the kinds of their values; elements of a list are `[]`.
fn fields(value: &Value, path: &str, found: &mut BTreeMap<String, BTreeSet<&'static str>>) {
    let kind = match value {
        Value::Null => "null",
        Value::Bool(_) => "bool",
        Value::Number(_) => "number",
        Value::String(_) => "text",
        Value::Array(list) => {
            list.iter().for_each(|element| fields(element, &format!("{path}[]"), found));
            "list"
        }
        Value::Object(map) => {
            map.iter().for_each(|(name, value)| fields(value, &format!("{path}.{name}"), found));
            "object"
        }
    };
    found.entry(path.to_string()).or_default().insert(kind);
}

const TEXT: &str = "mechanism Bar;\nparam w: rad/s = 1 in 0.1..9, tolerance 0.1;\nparam unused: m = 1;\ncoord phi: rad;\n\
                    drive d: phi == w*t;\n";
const TABLE: &str = "t (s),x (mm)\n0,1\n1,2\n2,4\n3,8\n4,16\n";

/// A command line for each command, and more where the fields differ.
const COMMANDS: [&[&str]; 39] = [
    &["list"],
    &["list", "bar.mbs"],
    &["check", "bar.mbs"],
    &["check", "bad.mbs"],
    &["fmt", "--check", "bar.mbs", "bad.mbs"],
    &["new", "roof"],
    &["run", "four_bar", "--steps", "4", "--out", "a", "--svg", "a.svg"],
    &["kinematics", "four_bar", "--steps", "4", "--out", "a"],
    &["kinematics", "slider_crank", "--param", "r=0.2", "--steps", "40", "--out", "e"],
    &["simulate", "pendulum", "--steps", "4", "--out", "b"],
    &["inverse", "slider_crank_mass:Driven", "--steps", "4", "--out", "c"],
    &["equilibrium", "double_pendulum", "--out", "d"],
    &["modes", "double_pendulum", "--out", "d"],
    &["expand", "bar.mbs"],
    &["verify", "four_bar", "--states", "2"],
    &["print", "four_bar", "q", "Phi", "Phi_q"],
    &["print", "pendulum", "M", "energy"],
    &["print", "andrews", "--symbols", "Phi", "M"],
    &["latex", "four_bar"],
    &["latex", "four_bar", "--out", "x.tex"],
    &["structure", "four_bar", "--out", "s.svg"],
    &["newton", "four_bar"],
    &["basins", "four_bar", "--size", "8", "--out", "b.svg"],
    &["next", "four_bar", "--starts", "2"],
    &["dof", "four_bar"],
    &["dof", "bar.mbs"],
    &["drift", "pendulum", "--steps", "20", "--out", "d.svg"],
    &["compare", "four_bar"],
    // It builds a program; `cargo xtask browser` runs it.
    &["cost", "four_bar", "--watch", "swing"],
    &["hard-cases", "four_bar", "--methods", "projection"],
    &["effects", "four_bar"],
    &["table", "table.csv", "--out", "t.svg"],
    &[
        "cam",
        "345",
        "--lift",
        "4mm",
        "--rise",
        "60deg",
        "--follower",
        "roller",
        "--roller",
        "6mm",
        "--least",
        "base",
        "--radius",
        "2mm",
        "--out",
        "cam",
    ],
    &[
        "cam",
        "345",
        "--lift",
        "4mm",
        "--rise",
        "60deg",
        "--follower",
        "flat",
        "--base",
        "18mm",
        "--rust",
        "CAM",
    ],
    &[
        "cam",
        "345",
        "--lift",
        "4mm",
        "--rise",
        "60deg",
        "--follower",
        "desmodromic",
        "--base",
        "12mm",
        "--pivot",
        "19mm,-19mm",
        "--arm",
        "18.7mm",
        "--roller",
        "12mm",
        "--valve-pad",
        "-12mm,-12mm",
        "--closer",
        "--base 17mm --pivot 23mm,-29mm --arm 29mm --roller 12mm --side right --valve-pad -12mm,-32mm",
        "--out",
        "cam",
    ],
    &[
        "cam",
        "profile.csv",
        "--measured",
        "--follower",
        "roller",
        "--base",
        "18mm",
        "--roller",
        "6mm",
        "--out",
        "cam",
    ],
    &["study"],
    &["study", "four_bar"],
    &["run", "nowhere"],
];

#[test]
fn every_command_prints_one_document_of_a_stable_schema() {
    let folder = scratch();
    // A circle beside its centre, as a gauge gives its points.
    let point = |k: i32| {
        let (sine, cosine) = f64::from(k).to_radians().sin_cos();
        format!("{:.4},{:.4}\n", 1.0 + 18.0 * cosine, 18.0 * sine)
    };
    let profile = format!("x (mm),y (mm)\n{}", (0..360).map(point).collect::<String>());
    for (name, content) in [
        ("profile.csv", profile.as_str()),
        ("bar.mbs", TEXT),
        ("bad.mbs", "mechanism Bar;\ncoord phi: rad\n"),
        ("table.csv", TABLE),
    ] {
        fs::write(folder.join(name), content).expect("a file");
    }
    let mut schemas: BTreeMap<String, BTreeMap<String, BTreeSet<&str>>> = BTreeMap::new();
    for arguments in COMMANDS {
        let output = mbs(&folder, arguments);
        let document = document(&output);
        let schema = document["schema"].as_str().expect("a schema").to_string();
        let of_analysis = ["kinematics", "simulate", "inverse", "equilibrium", "modes"];
        let name = if of_analysis.contains(&arguments[0]) { "run" } else { arguments[0] };
        assert_eq!(schema, format!("mbs/{name}/1"));
        assert_eq!(document["version"], env!("CARGO_PKG_VERSION"));
        let given: Vec<&str> =
            document["arguments"].as_array().expect("a list").iter().filter_map(Value::as_str).collect();
        assert_eq!(given, [arguments, &["--json"]].concat());
        // An error stands in the document and on the other output, and its exit code is that of the program.
        let code = document["error"]["exit_code"].as_i64().unwrap_or(0);
        assert_eq!(output.status.code().map(i64::from), Some(code), "{arguments:?}: {}", document["error"]);
        assert_eq!(
            output.stderr.is_empty(),
            code == 0,
            "{arguments:?}: {}",
            String::from_utf8_lossy(&output.stderr)
        );
        for file in document["files"].as_array().into_iter().flatten() {
            let path = folder.join(file["path"].as_str().expect("a path"));
            assert!(path.exists(), "{}", path.display());
        }
        fields(&document, "", schemas.entry(schema).or_default());
    }
    let commands: BTreeSet<&str> = COMMANDS.iter().map(|arguments| arguments[0]).collect();
    let help =
        Command::new(env!("CARGO_BIN_EXE_mbs-catalogue")).arg("--help").output().expect("the program starts");
    let help = String::from_utf8(help.stdout).expect("UTF-8");
    let listed =
        help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    for command in listed.filter_map(|line| line.split_whitespace().next()) {
        // It does not end.
        assert!(
            command == "help" || command == "watch" || commands.contains(command),
            "`{command}` has no document"
        );
    }
    let mut text = String::new();
    for (schema, fields) in &schemas {
        text += &format!("{schema}\n");
        for (path, kinds) in fields.iter().filter(|(path, _)| !path.is_empty()) {
            let kinds: Vec<&str> = kinds.iter().copied().collect();
            text += &format!("  {path} {}\n", kinds.join(" "));
        }
    }
    let stored = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/documents.txt");
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        fs::write(&stored, &text).expect("the fields are stored");
    }
    let known = fs::read_to_string(&stored).unwrap_or_default();
    let differing: Vec<_> =
        known.lines().zip(text.lines()).filter(|(known, found)| known != found).take(3).collect();
    assert!(known == text, "fields differ, known and found: {differing:?}");
    // The book names each field at the top of a document.
    let book = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../book/src/documents.md"))
        .expect("the page");
    for (schema, fields) in &schemas {
        assert!(book.contains(&format!("`{schema}`")), "{schema}");
        for path in fields.keys() {
            let name = path.trim_start_matches('.');
            let is_top = !name.is_empty() && !name.contains(['.', '[']);
            assert!(!is_top || book.contains(&format!("`{name}`")), "{schema}: {name}");
        }
    }
    fs::remove_dir_all(folder).expect("scratch");
}

#[test]
fn a_motion_that_ends_early_is_told_beside_its_error() {
    let folder = scratch().with_extension("early");
    fs::create_dir_all(&folder).expect("a directory");
    let output = mbs(&folder, &["run", "slider_crank", "--param", "r=0.2", "--steps", "40", "--out", "e"]);
    let document = document(&output);
    assert_eq!(output.status.code(), Some(1));
    let times = document["runs"][0]["motion"]["time"].as_array().expect("times");
    assert!(times.len() > 1);
    let ended = document["runs"][0]["ended"].as_str().expect("a reason");
    assert!(ended.starts_with("the motion ends at t = ") && !ended.contains('\n'), "{ended}");
    assert!(
        document["error"]["message"].as_str().is_some_and(|message| message.contains("the motion ends at"))
    );
    fs::remove_dir_all(folder).expect("scratch");
}

#[test]
fn every_file_names_version_and_text() {
    let folder = scratch().with_extension("origins");
    fs::create_dir_all(&folder).expect("a directory");
    let of = |arguments: &[&str]| {
        document(&mbs(&folder, arguments))["text"]["hash"].as_str().expect("a hash").to_string()
    };
    let hash = of(&["run", "four_bar", "--steps", "4", "--out", ".", "--svg", "moving.svg"]);
    assert_eq!(hash.len(), 16);
    for arguments in [
        &["latex", "four_bar", "--out", "x.tex"][..],
        &["structure", "four_bar", "--out", "s.svg"],
        &["basins", "four_bar", "--size", "8", "--out", "b.svg"],
    ] {
        assert_eq!(of(arguments), hash, "{arguments:?}");
    }
    let line = format!("mbs {}, four_bar, text {hash}", env!("CARGO_PKG_VERSION"));
    for (file, form) in [
        ("motion.csv", format!("# {line}\nrun,t (s),")),
        ("report.html", format!("<meta name=\"generator\" content=\"{line}\">")),
        ("moving.svg", format!("<metadata>{line}</metadata>")),
        ("s.svg", format!("<metadata>{line}</metadata>")),
        ("b.svg", format!("<metadata>{line}</metadata>")),
        ("x.tex", format!("% {line}\n")),
    ] {
        let text = fs::read_to_string(folder.join(file)).expect(file);
        assert!(text.contains(&form), "{file}: {}", &text[..400.min(text.len())]);
    }
    let hash = of(&["modes", "double_pendulum", "--out", "m"]);
    let modes = fs::read_to_string(folder.join("m/modes.csv")).expect("modes");
    assert!(modes.starts_with(&format!(
        "# mbs {}, double_pendulum, text {hash}\nrun,mode,",
        env!("CARGO_PKG_VERSION")
    )));
    fs::remove_dir_all(folder).expect("scratch");
}
