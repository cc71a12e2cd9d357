//! The program with mechanisms of one's own, as `examples/wiper.rs` has them.
#![cfg(feature = "program")]

mod program;

use std::fs;
use std::path::Path;

use program::{data, failure, scratch, text, wiper};

#[test]
fn mechanisms_are_listed_by_the_names_of_their_constructors() {
    let list = text(&["list"]);
    let names: Vec<Vec<&str>> = list.lines().map(|line| line.split_whitespace().collect()).collect();
    assert!(names.contains(&vec!["wiper", "Windscreen", "wiper"]), "{list}");
    // A text without a title has the name of the mechanism.
    assert!(names.contains(&vec!["cam", "Follower"]), "{list}");
}

#[test]
fn a_report_has_what_the_text_says_and_draws_points_that_are_no_outputs() {
    let folder = scratch("wiper");
    let printed = text(&["run", "wiper", "--steps", "24", "--out", folder.to_str().expect("a path")]);
    assert!(printed.contains("drizzle") && printed.contains("point blade"), "{printed}");
    let data = data(&folder);
    assert_eq!((&data["title"], &data["runs"][1]["label"]), (&"Windscreen wiper".into(), &"drizzle".into()));
    // One turn at 20 turns a minute.
    let time = data["runs"][1]["time"].as_array().and_then(|time| time.last()?.as_f64()).expect("times");
    assert!((time - 3.0).abs() < 1e-6, "{time}");
    let places = data["runs"][0]["places"].as_array().expect("places");
    let place = |name: &str| {
        let found = places.iter().find(|place| place["name"] == name).expect("a place");
        found["value"].as_array().expect("values").iter().map(|value| value.as_f64().expect("a number"))
    };
    let theta = data["runs"][0]["coordinates"][0]["q"].as_array().expect("values");
    // Angles of the page have seven digits.
    for (angle, (x, y)) in theta.iter().zip(place("A.0").zip(place("A.1"))) {
        let angle = angle.as_f64().expect("a number");
        assert!((x - 0.04 * angle.cos()).abs() < 1e-7 && (y - 0.04 * angle.sin()).abs() < 1e-7, "{x} {y}");
    }
}

#[test]
fn a_text_without_statements_runs_for_a_second_with_a_guessed_picture() {
    let folder = scratch("cam");
    text(&["run", "cam", "--steps", "10", "--out", folder.to_str().expect("a path")]);
    let data = data(&folder);
    assert_eq!((&data["runs"][0]["label"], &data["runs"][0]["time"][10]), (&"defaults".into(), &1.0.into()));
    assert!(data["drawing"].as_array().is_some_and(|shapes| !shapes.is_empty()), "{}", data["drawing"]);
    assert_eq!(data["description"], "A follower on a cam whose law the caller gives.");
}

#[test]
fn a_file_is_read_without_a_build_and_says_what_the_built_mechanism_says() {
    let file = format!("{}/examples/wiper.rs:Wiper", env!("CARGO_MANIFEST_DIR"));
    for [command, option] in
        [["structure", "wiper"], ["latex", "wiper"], ["expand", "wiper"], ["print", "--symbols"]]
    {
        let arguments = |name: &str| match option {
            "wiper" => text(&[command, name]),
            option => text(&[command, name, option, "q", "Phi", "Phi_q", "gamma"]),
        };
        let (built, read) = (arguments("wiper"), arguments(&file));
        // The emitted code has the lines and the source of the text, which are those of the file.
        match command {
            "expand" => assert_eq!(built.lines().count(), read.lines().count()),
            // The first line has the name on the command line, and the hash of the text.
            "latex" => {
                assert!(built.starts_with("% mbs ") && read.contains(", wiper.rs:Wiper, text "), "{read}");
                let [built, read] = [&built, &read].map(|text| text.split_once(", text ").expect("a hash").1);
                assert_eq!(built, read);
            }
            _ => assert_eq!(built, read, "{command}"),
        }
    }
    let [built, read] = ["wiper", &file].map(|name| text(&["dof", name]));
    for line in ["coordinates n ", "rows m ", "Grübler's count "] {
        let of = |text: &str| text.lines().find(|found| found.starts_with(line)).map(str::to_string);
        assert!(of(&built).is_some() && of(&built) == of(&read), "{read}");
    }
    assert!(read.contains(&format!("`mbs dof {file} --at 0`")), "{read}");
}

#[test]
fn several_mechanisms_of_a_file_are_listed_and_one_with_functions_asks_for_them() {
    let file = format!("{}/examples/wiper.rs", env!("CARGO_MANIFEST_DIR"));
    let failed = |arguments: &[&str], code: i32| {
        let output = wiper(arguments);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{said}");
        said
    };
    let said = failed(&["run", &file], 2);
    assert!(said.contains(&format!("name one:\n  {file}:Wiper\n  {file}:Follower\n")), "{said}");
    let said = failed(&["run", &format!("{file}:Follower")], 2);
    assert!(said.contains("--function lift=FILE.csv") && said.contains("m over rad"), "{said}");
    let said = failed(&["compare", &format!("{file}:Wiper")], 2);
    assert!(said.contains("name one of `mbs list`"), "{said}");
}

#[test]
fn functions_of_a_file_are_checked_before_anything_is_built() {
    let folder = scratch("given-functions");
    fs::create_dir_all(&folder).expect("a folder");
    let path = |name: &str, text: &str| {
        let path = folder.join(name);
        fs::write(&path, text).expect("a file");
        path.display().to_string()
    };
    let text = "pub mechanism Cam; function lift: [m; 2](rad), C3, periodic TAU; function push: N(m), C3; coord phi: rad; \
                coord y: [m; 2]; drive motor: phi == t*1 [rad/s]; \
                constraint c { for i in 0..2 { y[i] == lift[i](phi); } } out f: N = push(y[0]);";
    let file = path("cam.mbs", text);
    let bad = path("bad.csv", "angle (deg),lift (mm)\n0,1\n5,x\n");
    let short = path("short.csv", "angle (deg),lift (mm)\n0,1\n5,2\n10,1\n");
    let plain = path("plain.csv", "0,1\n1,2\n2,4\n");
    let law = "4567 --lift 8mm --rise 75deg";
    let said = |functions: &[String], code: i32| {
        let options = functions.iter().flat_map(|function| ["--function", function.as_str()]);
        let words: Vec<&str> = ["run", file.as_str()].into_iter().chain(options).collect();
        failure(&words, code)
    };
    let of = |name: &str, form: &str| format!("{name}={form}");
    let both = [of("lift[0]", law), of("lift[1]", law)];
    let cases: [(Vec<String>, i32, &str); 16] = [
        (vec![], 2, "--function lift[0]=FILE.csv --function lift[1]=FILE.csv --function push=FILE.csv"),
        (both.to_vec(), 2, "\n  push: N over m, 3 continuous derivatives\n"),
        (vec![of("lft[0]", law)], 2, "did you mean `lift[0]`?\nknown: lift[0], lift[1], push"),
        (vec![of("lift", law)], 2, "known: lift[0], lift[1], push"),
        (vec![both[0].clone(), both[0].clone()], 2, "is given 2 times"),
        (vec!["lift[0]".to_string()], 2, "write name and table or law"),
        (
            vec![of("lift[0]", &bad), both[1].clone(), of("push", &plain)],
            1,
            "bad.csv: line 3, column 2: `x` is not",
        ),
        (
            vec![of("lift[0]", &short), both[1].clone(), of("push", &plain)],
            1,
            "short.csv: line 4, column 1: the table ends",
        ),
        (
            vec![of("lift[0]", "cyclod"), both[1].clone(), of("push", &plain)],
            2,
            "did you mean the law `cycloid`?",
        ),
        (
            vec![of("lift[0]", "cycloid --lift 8mm --rise 75deg"), both[1].clone(), of("push", &plain)],
            2,
            "2 continuous derivatives, and the text counts on 3",
        ),
        (
            vec![of("lift[0]", "4567 --lift 8mm"), both[1].clone(), of("push", &plain)],
            2,
            "needs `--rise 90deg`",
        ),
        ([&both[..], &[of("push", law)]].concat(), 2, "`push` is in N over m"),
        (
            [&both[..], &[of("push", &format!("{plain}:mm,s"))]].concat(),
            1,
            "the columns are s over mm, and the text declares N over m",
        ),
        (
            [&both[..], &[of("push", &plain)]].concat(),
            1,
            "plain.csv:mm,N\"`, or write a header `x (mm), push (N)`",
        ),
        ([&both[..], &[of("push", &format!("{plain}:mm,Newtons"))]].concat(), 2, "`Newtons`"),
        ([&both[..], &[of("push", &format!("{plain}:mm,N"))]].concat(), 2, "declare `C2`, or a period"),
    ];
    for (functions, code, words) in cases {
        let found = said(&functions, code);
        assert!(found.contains(words), "{functions:?}: {found}");
    }
    // Of a mechanism of the list, and in a text without functions.
    let found = failure(&["run", "cam", "--function", &both[0]], 2);
    assert!(found.contains("from its crate"), "{found}");
    let file = path("bar.mbs", "pub mechanism Bar; coord phi: rad; drive motor: phi == t*1 [rad/s];");
    let found = failure(&["run", &file, "--function", &both[0]], 2);
    assert!(found.contains("`Bar` calls no function `lift[0]`\nit calls none"), "{found}");
}

#[test]
fn a_misspelt_name_gets_a_proposal() {
    let output = wiper(&["run", "wper"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("did you mean `wiper`?"), "{said}");
}

#[test]
fn numbers_of_the_command_line_have_units() {
    let folder = scratch("units");
    let run = |parameters: &[&str]| {
        let of = parameters.iter().flat_map(|parameter| ["--param", parameter]);
        let place = ["run", "wiper", "--steps", "8", "--out", folder.to_str().expect("a path")];
        text(&place.into_iter().chain(of).collect::<Vec<_>>());
        fs::read_to_string(folder.join("motion.csv")).expect("a table")
    };
    let plain = run(&["crank=0.03", "speed=6.283185307179586"]);
    assert_eq!(plain, run(&["crank=30mm", "speed=1 [turn/s]"]));
    assert_eq!(plain, run(&["crank=3cm", "speed=2*PI"]));
    assert_eq!(plain, run(&["crank=0.03 [m]", "speed=TAU"]));
    assert_ne!(plain, run(&["crank=30mm", "speed=61rpm"]));
    let guessed = text(&["newton", "wiper", "--guess", "phi=90deg"]);
    assert!(guessed.contains("phi = 1.570796 rad"), "{guessed}");
    for (arguments, words) in [
        (["run", "wiper", "--param", "crank=60rpm"], "`crank` is in `m`, `60rpm` is in `1/s`"),
        (["run", "wiper", "--param", "crank=30 mm"], "write `30mm`"),
        (["run", "wiper", "--param", "crank=two"], "`two` is not a number"),
        (["run", "wiper", "--param", "crank=nan"], "finite"),
        (["run", "wiper", "--param", "crank=-40mm"], "`crank` is -0.04 m: a link has no negative length"),
        (["run", "wiper", "--param", "rod=1e-300"], "lost in rounding"),
        (["run", "wiper", "--param", "crnk=30mm"], "did you mean `crank`?"),
        (["newton", "wiper", "--guess", "phi=30mm"], "`phi` is in `rad`, `30mm` is in `m`"),
    ] {
        let said = failure(&arguments, 2);
        assert!(said.contains(words), "{arguments:?}: {said}");
    }
}

#[test]
fn a_mechanism_that_locks_is_told_in_one_line_and_has_its_page() {
    // Crank and base in line are longer than rod and rocker: 0.335 m, 0.33 m.
    let folder = scratch("locks");
    let place = ["--out", folder.to_str().expect("a path")];
    let output =
        wiper(&[&["run", "wiper", "--param", "crank=75mm", "--param", "base=260mm"][..], &place].concat());
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    let row =
        said.lines().filter(|line| line.ends_with(" | A + rod*unit(phi) == [base, 0] + rocker*unit(psi);"));
    assert_eq!(row.count(), 1, "{said}");
    for line in said.lines().filter(|line| !line.contains(" | ")) {
        let (_, end) = line.split_once("the motion ends at t = ").expect(&said);
        assert!(end.contains("`closure.0` (line"), "{said}");
        assert!(end.split(' ').next().is_some_and(|time| time.len() <= 8), "{said}");
    }
    assert!(folder.join("report.html").is_file(), "{said}");
}

#[test]
fn a_name_of_a_mechanism_is_no_command_and_is_told_so() {
    for word in ["wiper", "WIPER", "wipr"] {
        let said = failure(&[word], 2);
        assert!(said.contains("`mbs run wiper`"), "{said}");
    }
    assert!(failure(&["lst"], 2).contains("list"));
    assert!(failure(&["run", "Wiper"], 2).contains("did you mean `wiper`?"));
    assert!(failure(&["structure", "wiper", "--out", "x.png"], 2).contains("name it FILE.svg"));
}

#[test]
fn a_place_that_cannot_be_written_is_told_before_anything_is_computed() {
    let file = scratch("in_the_way");
    fs::write(&file, "").expect("a file");
    let place = file.join("deep");
    let said = failure(&["run", "wiper", "--steps", "1000000", "--out", place.to_str().expect("a path")], 1);
    assert!(said.contains(place.to_str().expect("a path")) && said.contains("is no directory"), "{said}");
}

#[test]
fn a_file_is_checked_and_listed_without_a_build() {
    let file = format!("{}/examples/wiper.rs", env!("CARGO_MANIFEST_DIR"));
    let listed = text(&["list", &file]);
    assert!(
        listed.contains(&format!("{file}:Wiper  Windscreen wiper\n  crank=0.04 m, rod=0.25 m")),
        "{listed}"
    );
    assert!(listed.contains(&format!("{file}:Follower  Follower\n")), "{listed}");
    let checked = text(&["check", &file]);
    assert!(checked.contains("warning: `closure` has two positions of `phi`, `psi`"), "{checked}");
    assert!(checked.ends_with("4 texts without faults, 1 warning\n"), "{checked}");

    let bare = scratch("warned.mbs");
    let write = |rows: &str| fs::write(&bare, rows).expect("a file");
    let path = bare.to_str().expect("a path");
    write(
        "mechanism Rod;\nparam L: m = 0.2 in 0.1..300mm, tolerance 0.1mm;\nconst k: N/m = 3;\ninput u: m;\n\
         coord x: m = 5;\ncoord y: m = 0.2;\nconstraint ends { x == L + y; }\ndrive d: y == 0.2m;\n",
    );
    let checked = text(&["check", path]);
    for words in [
        "warning: constant `k` is used nowhere",
        "warning: input `u` is used nowhere",
        "warning: the guess leaves `ends` open by 4.6 m",
        "3 | const k: N/m = 3;",
        "1 text without faults, 3 warnings",
    ] {
        assert!(checked.contains(words), "{words} is missing in\n{checked}");
    }
    assert!(text(&["list", path]).contains("L=0.2 m (0.1 to 0.3), u=0 m"));
    // An end that follows from the begin is told, a pulse and a level above are not.
    write(
        "mechanism Ball;\ncoord y: m = 1;\nbody ball { mass: 1kg, com: [0, y] }\nevent low: y < 0 until y < 0.5m;\n\
         event up: y > 0 until y > 0.5m;\nevent late: t > 1s until t > 2s;\nforce f: 1N*(low + up + late) on y;\nstart y = 1 rate 0;\n",
    );
    let checked = text(&["check", path]);
    assert!(checked.contains("warning: `low` never begins"), "{checked}");
    assert!(checked.contains("1 text without faults, 1 warning"), "{checked}");
    write("mechanism Rod;\nparam L: m = 0.2 in 0.3..0.4;\ncoord x: m;\ndrive d: x == L;\n");
    let said = failure(&["check", path], 1);
    assert!(said.contains("the default of `L`, 0.2, is outside of its range"), "{said}");
    assert!(failure(&["check", "wiper"], 2).contains("is no file"));
}

#[test]
fn the_tutorial_shows_the_picture_of_the_example() {
    let read = |path: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
        fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    };
    let (example, tutorial) = (read("examples/wiper.rs"), read("../book/src/tutorial.md"));
    let from = example.find("    title ").expect("a title");
    let to = from + example[from..].find("}\n\n").expect("the end of the text");
    assert!(
        tutorial.contains(&example[from..to]),
        "book/src/tutorial.md does not show\n{}",
        &example[from..to]
    );
}
