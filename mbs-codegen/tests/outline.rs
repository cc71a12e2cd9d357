//! Names of a text, faults as data, texts in a Rust source.
#![forbid(unsafe_code)]

use std::fs;
use std::path::{Path, PathBuf};

use mbs_codegen::{Call, Fault, Outline, calls, expand_source, outline, variables};

/// Sources of the ready mechanisms.
fn ready() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../mechanisms/src");
    let files = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    files.filter(|path| path.extension().is_some_and(|ending| ending == "rs")).collect()
}

#[test]
fn texts_stand_at_their_own_lines_and_columns() {
    let mut found = 0;
    for path in ready() {
        let source = fs::read_to_string(&path).expect("a source");
        for Call { name, source: text, line, place } in calls(&source).expect("a Rust source") {
            let name = name.expect("a name");
            let here = text.lines().position(|line| line.contains(&format!("mechanism {name};")));
            let there = source.lines().position(|line| line.contains(&format!("mechanism {name};")));
            assert!(here.is_some() && here == there, "{}: {name}", path.display());
            assert!(source.lines().nth(line - 1).is_some_and(|line| line.contains("mechanism!")));
            assert_eq!(outline(&text).expect("no faults").name, name);
            assert!(text.ends_with(&source[place]), "{name}");
            found += 1;
        }
    }
    assert!(found >= 40, "{found} texts");
}

#[test]
fn scenes_functions_and_parameters_are_named() {
    let text = "pub mechanism Cam; param r: m = 30mm; param offset: [m; 2] = [1mm, 0]; function lift: m(rad), C3, periodic TAU; function push: [N; 2](m), C1; coord y: m; \
                constraint c { y == r + lift(0rad) + offset[0]; } out n: N = push[0](y) + push[1](y); \
                effect one { param a: rad = 1deg; } effect two {} scene First = one; scene Second = two;";
    let found = outline(text);
    let names = |list: &[&str]| list.iter().map(|name| name.to_string()).collect::<Vec<_>>();
    match found {
        Ok(Outline { name, scenes, has_whole, functions }) => {
            assert_eq!(name, "Cam");
            assert_eq!(scenes, names(&["First", "Second"]));
            assert!(has_whole);
            let called: Vec<_> = functions
                .iter()
                .map(|f| (f.name.as_str(), f.unit.as_str(), f.argument_unit.as_str(), f.continuity, f.period))
                .collect();
            let turn = Some(core::f64::consts::TAU);
            let push = |name| (name, "N", "m", 1, None);
            assert_eq!(called, [("lift", "m", "rad", 3, turn), push("push[0]"), push("push[1]")]);
        }
        Err(faults) => panic!("{faults:?}"),
    }
    let of = |scene| -> Vec<(String, String, f64)> {
        let variables = variables(text, Some(scene)).expect("no faults");
        variables.into_iter().map(|found| (found.name, found.unit, found.default)).collect()
    };
    let known = |name: &str, unit: &str, value: f64| (name.to_string(), unit.to_string(), value);
    let second = [known("r", "m", 0.03), known("offset.0", "m", 0.001), known("offset.1", "m", 0.0)];
    assert_eq!(of("Second"), second);
    assert_eq!(of("First")[..3], second);
}

#[test]
fn faults_are_those_of_the_macro_with_their_lengths() {
    let text = "pub mechanism Rod;\ncoord phi: rad;\ndrive motor: phi == omega*t;\nout x: m = 1kg;\n";
    let faults = outline(text).expect_err("faults");
    let told: String = faults
        .iter()
        .map(|Fault { line, column, message, help, .. }| {
            format!("{line}:{column}: {message}\n  help: {help}\n")
        })
        .collect();
    assert_eq!(told, expand_source(text).expect_err("faults"));
    assert_eq!(faults.iter().map(|fault| (fault.line, fault.width())).collect::<Vec<_>>(), [(3, 5), (4, 1)]);
}

#[test]
fn calls_are_found_in_any_brackets_and_not_in_macros_comments_or_strings() {
    let source = "mod a { fn f() { mbs_runtime::mechanism!( mechanism One; ); mechanism![ pub mechanism r#Two; ]; } }\n\
                  // mechanism! { mechanism No; }\n/// mechanism! { mechanism No; }\nconst S: &str = \"mechanism! { mechanism No; }\";\n\
                  macro_rules! mechanism { ($($t:tt)*) => { $crate::mechanism! { $($t)* } } }\nlet a = mechanism != b;\n\
                  mechanism! { coord x: m; }";
    let found = calls(source).expect("tokens");
    let names: Vec<Option<&str>> = found.iter().map(|call| call.name.as_deref()).collect();
    assert_eq!(names, [Some("One"), Some("Two"), None]);
    for broken in ["fn f( {", "\"", "mechanism! {", "'", "\u{0}", "é\u{301} mechanism! { ( }"] {
        let fault = calls(broken).expect_err("no tokens");
        assert!(!fault.help.is_empty(), "{broken}");
    }
    // Columns count characters, not bytes.
    let call = calls("/* größe */ mechanism! { mechanism M; }").expect("tokens").remove(0);
    assert_eq!(call.source.find("mechanism M"), Some("/* groesse */ mechanism! { ".chars().count() - 2));
}

#[test]
fn faults_of_the_form_are_told_without_those_of_names_and_units() {
    let form =
        |text: &str| mbs_codegen::faults_of_form(text).iter().map(|fault| fault.line).collect::<Vec<_>>();
    assert_eq!(form("mechanism A;\ncoord phi: rad;\nout a: m = nowhere + 1s;\n"), []);
    assert_eq!(form("mechanism A;\ncoord phi: rad\nout a: m = 1;\n"), [2]);
    assert_eq!(form("mechanism A;\ncoord phi: rad;\nout a: m = (1;\n").len(), 1);
    assert_eq!(form("").len(), 1);
}

#[test]
fn names_are_quoted_with_their_statements() {
    let text = "pub mechanism A;\n/// Length.\nparam L: m = 1; coord p: [m; 2];\nconstraint c {\n    for i in 0..2 {\n        \
                p[i] == // side\n            L;\n    }\n}\nbody b {\n    mass: 1kg, com: p }\nlet twice = 2*L;\n";
    let found = mbs_codegen::declarations(text, None).expect("a text");
    let of = |name: &str| {
        let found = found.iter().find(|declaration| declaration.name == name).expect(name);
        (found.line, found.text.as_str())
    };
    assert_eq!(of("L"), (3, "param L: m = 1;"));
    assert_eq!(of("p.1"), (3, "coord p: [m; 2];"));
    assert_eq!((of("c.0"), of("c.1")), ((6, "p[i] == L;"), (6, "p[i] == L;")));
    assert_eq!(of("c"), (4, "constraint c"));
    assert_eq!(of("b"), (10, "body b"));
    assert_eq!(of("twice"), (12, "let twice = 2*L;"));
    assert!(mbs_codegen::declarations("mechanism A;", None).is_err());
    assert!(mbs_codegen::declarations(text, Some("None")).is_err());
}
