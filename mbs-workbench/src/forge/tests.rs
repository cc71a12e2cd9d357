//! The forge with a stand-in for cargo, which counts its calls and writes what cargo would.

use std::os::unix::fs::PermissionsExt;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::*;
use crate::card::Card;
use crate::text_file::TextFile;

const TEXT: &str =
    "pub mechanism Crank;\ncoord phi: rad;\ndrive motor: phi == 1rad/1s*t;\nout A: [m; 2] = 1m*unit(phi);\n";

/// Program that the stand-in builds: a file of its own for each call.
const BUILD: &str = r#"
program="$target/debug/built"
mkdir -p "$target/debug/deps"
echo "$calls" > "$program"
touch "$target/debug/deps/$package"
printf '{"reason":"compiler-artifact","fresh":false,"target":{"name":"libm"},"executable":null}\n'
printf '{"reason":"compiler-artifact","fresh":false,"target":{"name":"crank"},"executable":"%s"}\n' "$program"
"#;

/// A forge in a folder of its own whose cargo is a script.
fn forge(name: &str, script: &str) -> Forge {
    let folder = target_directory().join("tmp").join(format!("forge-{name}-{}", std::process::id()));
    drop(fs::remove_dir_all(&folder));
    fs::create_dir_all(&folder).expect("a folder");
    let folder = folder.canonicalize().expect("a folder");
    let cargo = folder.join("cargo");
    let text = format!(
        "#!/bin/sh\nset -e\necho \"$@\" >> '{0}/calls'\ncalls=$(wc -l < '{0}/calls')\ntarget='{0}/target'\nwhile [ \"$1\" != --manifest-path ]; do \
         shift; done\npackage=$(basename $(dirname \"$2\") | tr - _)\n{script}",
        folder.display()
    );
    fs::write(&cargo, text).expect("a script");
    fs::set_permissions(&cargo, fs::Permissions::from_mode(0o755)).expect("a program");
    fs::write(folder.join("Cargo.lock"), "# versions\n").expect("a lock file");
    fs::write(folder.join("Cargo.toml"), "[workspace]\n[profile.dev]\nopt-level = 1\n").expect("a manifest");
    Forge { cargo: cargo.into(), target: folder.join("target"), workspace: folder, release: false, flags: "" }
}

fn calls(forge: &Forge) -> Vec<String> {
    let text = fs::read_to_string(forge.workspace.join("calls")).unwrap_or_default();
    text.lines().map(str::to_string).collect()
}

fn blueprint(forge: &Forge, text: &str) -> Blueprint {
    let path = forge.workspace.join("crank.mbs");
    fs::write(&path, text).expect("a text");
    let text = TextFile::read(&path.display().to_string()).expect("a text");
    Blueprint::of_text(&text)
}

fn program(forge: &Forge, blueprint: &Blueprint) -> Result<PathBuf, ForgeError> {
    forge.program(blueprint, &mut |_| ())
}

/// Number of the call that built a program.
fn content(path: &Path) -> String {
    fs::read_to_string(path).expect("a program").trim().to_string()
}

#[test]
fn a_program_is_built_once_and_a_changed_text_has_its_own() {
    let forge = forge("cache", BUILD);
    let first = blueprint(&forge, TEXT);
    let mut said = Vec::new();
    let path = forge.program(&first, &mut |step| said.push(step.to_string())).expect("a program");
    assert_eq!(said, ["building a program for `crank`", "built libm", "built crank"]);
    let again = program(&forge, &first).expect("a program");
    assert_eq!((&again, content(&again).as_str(), calls(&forge).len()), (&path, "1", 1));
    let changed = blueprint(&forge, &TEXT.replace("1m", "2m"));
    let other = program(&forge, &changed).expect("a program");
    assert_ne!(other, path);
    assert_eq!((content(&other).as_str(), content(&path).as_str(), calls(&forge).len()), ("2", "1", 2));
    assert_eq!(program(&forge, &first).expect("the first one"), path);
    // Another profile, other versions: other programs.
    let optimised = Forge { release: true, ..forge.clone() };
    assert_ne!(program(&optimised, &first).expect("a program"), path);
    fs::write(forge.workspace.join("Cargo.lock"), "# other versions\n").expect("a lock file");
    assert_ne!(program(&forge, &first).expect("a program"), path);
    assert_eq!(calls(&forge).len(), 4);
}

#[test]
fn the_crate_has_the_callers_lock_file_and_profiles_and_cargo_keeps_nothing_of_it() {
    let forge = forge("content", BUILD);
    let path = program(&forge, &blueprint(&forge, TEXT)).expect("a program");
    let folder = path.parent().expect("a folder");
    assert!(folder.starts_with(forge.target.join("mbs")));
    let read = |name: &str| fs::read_to_string(folder.join(name)).expect("a file");
    assert_eq!(read("Cargo.lock"), "# versions\n");
    assert!(
        read("Cargo.toml").ends_with("\n[workspace]\n\n[profile.dev]\nopt-level = 1\n"),
        "{}",
        read("Cargo.toml")
    );
    // The lines of the text are those of the file.
    let main = read("src/main.rs");
    assert!(main.lines().zip(TEXT.lines()).all(|(made, text)| made.ends_with(text)), "{main}");
    let left: Vec<_> = fs::read_dir(forge.target.join("debug/deps")).expect("a folder").collect();
    assert!(left.is_empty(), "{left:?}");
    let call = &calls(&forge)[0];
    assert!(
        call.contains("--offline") && call.contains(&format!("--target-dir {}", forge.target.display())),
        "{call}"
    );
}

#[test]
fn the_network_is_asked_for_what_is_not_on_this_machine() {
    let script = format!(
        "case \"$*\" in *--offline*) echo 'error: no matching package named `clap` found' >&2\n\
         echo \"As a reminder, you're using offline mode (--offline)\" >&2; exit 101;; esac\n{BUILD}"
    );
    let forge = forge("online", &script);
    program(&forge, &blueprint(&forge, TEXT)).expect("a program");
    let offline: Vec<bool> = calls(&forge).iter().map(|call| call.contains("--offline")).collect();
    assert_eq!(offline, [true, false]);
}

#[test]
fn an_error_of_the_compiler_is_shown_at_its_line_of_the_users_file() {
    // The first line of the source has a prefix, whose length is that of the blueprint.
    let error = |line: usize, column: usize| {
        format!(
            r#"printf '%s\n' '{{"reason":"compiler-message","message":{{"level":"error","message":"no such thing","rendered":"raw","children":[{{"level":"help","message":"a cure"}}],"spans":[{{"is_primary":true,"file_name":"/core/macros.rs","line_start":9,"line_end":9,"column_start":1,"column_end":2,"expansion":{{"span":{{"file_name":"src/main.rs","line_start":{line},"line_end":{line},"column_start":{column},"column_end":{}}}}}}}]}}}}'
"#,
            column + 5
        )
    };
    let shift = "mod crank { ::mbs_runtime::mechanism! { ".len();
    let summary = r#"printf '%s\n' '{"reason":"compiler-message","message":{"level":"error","message":"aborting due to 2 previous errors","rendered":"x","spans":[]}}'
"#;
    let left = "mkdir -p \"$target/debug/incremental\"; touch \"$target/debug/incremental/$package-1\"\n";
    let script = left.to_string() + &error(1, shift + 15) + &error(3, 7) + summary + "exit 101\n";
    let forge = forge("failed", &script);
    let text = blueprint(&forge, TEXT);
    let error = program(&forge, &text).expect_err("errors");
    let path = forge.workspace.join("crank.mbs");
    let expected = format!(
        "no such thing\n  --> {0}:1:15\n  |\n1 | pub mechanism Crank;\n  |               ^^^^^\n  = help: a cure\n\n\
         error: no such thing\n  --> {0}:3:7\n  |\n3 | drive motor: phi == 1rad/1s*t;\n  |       ^^^^^\n  = help: a cure",
        path.display()
    );
    assert_eq!(error, ForgeError::Faults(expected));
    let left = fs::read_dir(forge.target.join("debug/incremental")).expect("a folder").count();
    assert_eq!(left, 0);
    // A build that failed is no program, and is tried again.
    assert!(program(&forge, &text).is_err());
    assert_eq!(calls(&forge).len(), 2);
}

#[test]
fn cargos_own_failure_and_a_missing_cargo_are_told_apart() {
    let forge = forge("cargo", "echo 'error: failed to parse lock file' >&2\nexit 101\n");
    let text = blueprint(&forge, TEXT);
    let error = program(&forge, &text).expect_err("no build").to_string();
    assert!(
        error.contains("cargo could not build") && error.contains("failed to parse lock file"),
        "{error}"
    );
    let missing = Forge { cargo: "no-such-cargo".into(), ..forge };
    let error = program(&missing, &text).expect_err("no cargo").to_string();
    assert!(error.contains("`no-such-cargo` does not start") && error.contains("rustup.rs"), "{error}");
}

#[test]
fn two_at_once_build_one_program() {
    let forge = forge("together", &format!("sleep 0.2\n{BUILD}"));
    let text = blueprint(&forge, TEXT);
    let built = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| {
                let path = program(&forge, &text).expect("a program");
                assert_eq!(content(&path), "1");
                built.fetch_add(1, Ordering::Relaxed);
            });
        }
    });
    assert_eq!((built.into_inner(), calls(&forge).len()), (3, 1));
}

#[test]
fn programs_of_a_name_that_were_not_used_for_longest_are_deleted() {
    let forge = forge("retired", BUILD);
    let of = |metres: usize| {
        let text = blueprint(&forge, &TEXT.replace("1m", &format!("{metres}m")));
        program(&forge, &text).expect("a program")
    };
    let first = of(1);
    let second = of(2);
    for metres in 3..=KEPT {
        of(metres);
    }
    assert!(first.is_file() && second.is_file());
    // Used again, so that the second one is the oldest.
    std::thread::sleep(std::time::Duration::from_millis(20));
    assert_eq!(of(1), first);
    of(KEPT + 1);
    assert!(first.is_file() && !second.is_file());
}

#[test]
fn a_program_of_a_text_takes_its_functions_from_its_command_line() {
    let forge = forge("functions", BUILD);
    let path = forge.workspace.join("cam.mbs");
    let turn = "Some(6.283185307179586)";
    let given =
        |name: &str| format!("::mbs_workbench::given_function((\"{name}\", \"m\", \"rad\", 3, {turn}))");
    for (kind, call, made) in [
        ("m", "lift(t/1s)", given("lift")),
        ("[m; 2]", "lift[1](t/1s) + lift[0](t/1s)", format!("[{}, {}]", given("lift[0]"), given("lift[1]"))),
    ] {
        let text = format!(
            "pub mechanism Cam; coord y: m; function lift: {kind}(rad), C3, periodic TAU; function push: N(m), C1;\n\
             drive motor: y == {call}; out f: N = push(y);"
        );
        fs::write(&path, text).expect("a text");
        let text = TextFile::read(&path.display().to_string()).expect("a text");
        let push = "::mbs_workbench::given_function((\"push\", \"N\", \"m\", 1, None))";
        let call = format!("Cam::new({made}, {push})");
        for main in [Blueprint::of_text(&text).main, Blueprint::study_of_text(&Study::COST, &text).main] {
            assert!(main.contains(&format!("card!({call})")), "{main}");
        }
        let cost = Blueprint::study_of_text(&Study::COST, &text).main;
        assert!(cost.contains(&format!("comparable!({call})")), "{cost}");
    }
}

mod valves {
    //! Functions of the caller, some in arrays.

    use mbs_runtime::Function;
    use mbs_runtime::driver::Harmonic;

    use crate::erased::costs::Comparable;

    mbs_runtime::mechanism! {
        /// Two valves and a pump on one shaft.
        pub mechanism Valves;
        function lift: [m; 2](rad), C3, periodic TAU;
        function stroke: m(rad), C1, periodic TAU;
        coord theta: rad;
        coord y: [m; 2];
        drive cam: theta == 10 [rad/s]*t;
        constraint faces { for i in 0..2 { y[i] == lift[i](theta); } }
        out pumped: m = stroke(theta);
    }

    const LIFT: Harmonic = Harmonic { offset: 0.0, amplitude: 8e-3, frequency: 1.0, phase: 0.0 };

    /// A function in `f64` alone.
    #[derive(Clone)]
    struct InDoubles;

    impl Function<f64> for InDoubles {
        const ORDER: usize = 9;

        fn jet<const K: usize>(&self, x: f64) -> [f64; K] {
            LIFT.jet(x)
        }
    }

    /// All functions the same.
    pub fn valves() -> Valves<Harmonic, Harmonic> {
        Valves::new([LIFT; 2], LIFT)
    }

    /// Those of the array in `f64` alone.
    fn valves_in_doubles() -> Valves<InDoubles, Harmonic> {
        Valves::new([InDoubles, InDoubles], LIFT)
    }

    /// Functions in `f64` alone, as the program of `mbs cost` finds them.
    pub fn doubles() -> [Vec<&'static str>; 2] {
        let all: fn(&[(usize, f64)]) -> Comparable = crate::comparable!(valves(), Valves, [lift, stroke]);
        let some: fn(&[(usize, f64)]) -> Comparable =
            crate::comparable!(valves_in_doubles(), Valves, [lift, stroke]);
        [all, some].map(|studied| match studied(&[]) {
            Comparable::Driven(driven) => driven.doubles,
            _ => panic!("drives move it"),
        })
    }
}

#[test]
fn a_study_takes_each_function_of_an_array_and_makes_the_mechanism_of_the_arrays() {
    let forge = forge("arrays", BUILD);
    let card = crate::card!(valves::valves());
    let instance = card.equations();
    let functions = instance.functions();
    let names: Vec<&str> = functions.iter().map(|function| function.name).collect();
    assert_eq!(names, ["lift[0]", "lift[1]", "stroke"]);
    // A constructor of the text alone needs no library.
    let card = Card { constructor: "Valves::default()", ..card };
    let study = |study: &Study| {
        let text = ("Valves", instance.source(), functions);
        Blueprint::study_of_card(study, &forge, &card, text).expect("a blueprint").main
    };
    let main = study(&Study::COST);
    for law in ["(\"lift[0]\", ", "(\"lift[1]\", ", "(&mechanism.lift[0], x)", "(&mechanism.lift[1], x)"] {
        assert!(main.contains(law), "{law}: {main}");
    }
    let main = study(&Study::COST.in_doubles(NameFrom::Text));
    assert!(main.contains("comparable!(Valves::default(), Valves, [lift, stroke])"), "{main}");
    // That macro takes arrays.
    assert_eq!(valves::doubles(), [vec![], vec!["lift"]]);
}

#[test]
fn a_study_of_a_constructor_in_a_library_imports_the_type_that_takes_other_functions() {
    let forge = Forge { cargo: "cargo".into(), ..forge("paths", BUILD) };
    let instance = crate::card!(valves::valves()).equations();
    let own = instance.path();
    assert_eq!(own, "mbs_workbench::forge::tests::valves::Valves");
    let main = |constructor: &'static str, name_from| {
        // A module that is in no library, so names of the constructor alone tell the library.
        let module = if constructor.starts_with("mbs_workbench") { "elsewhere" } else { module_path!() };
        let card = Card { constructor, module, ..crate::card!(valves::valves()) };
        let text = (own.as_str(), instance.source(), instance.functions());
        Blueprint::study_of_card(&Study::COST.in_doubles(name_from), &forge, &card, text)
            .expect("a library")
            .main
    };
    let path = "mbs_workbench::forge::tests::valves::valves()";
    let text = main(path, NameFrom::Text);
    assert!(text.contains("use ::mbs_workbench::forge::tests::valves::Valves;\n"), "{text}");
    assert!(text.contains(&format!("comparable!({path}, Valves, [lift, stroke])")), "{text}");
    // The constructor's module, from the crate's root or from the module of the card; a type is no module.
    let import = |constructor, expected: &str| {
        let text = main(constructor, NameFrom::Constructor);
        assert!(text.contains(&format!("\nuse {expected};\n")), "{text}");
    };
    import(path, "mbs_workbench::forge::tests::valves::*");
    import("valves::valves()", "valves::*");
    import("mbs_workbench::valves::Valves::new(LIFT)", "mbs_workbench::valves::*");
    import("::mbs_workbench::valves()", "::mbs_workbench::*");
}
