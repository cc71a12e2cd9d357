//! The program with mechanisms of one's own, as `examples/wiper.rs` has them.
#![cfg(feature = "program")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Runs the example, which stands beside this test's binary.
fn wiper(arguments: &[&str]) -> Output {
    let test = std::env::current_exe().expect("a path");
    let folder = test.ancestors().nth(2).expect("the profile's folder");
    Command::new(folder.join("examples/wiper")).args(arguments).output().expect("the example is built")
}

#[track_caller]
fn text(arguments: &[&str]) -> String {
    let output = wiper(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

fn scratch(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// Data of the report's page.
fn data(folder: &Path) -> serde_json::Value {
    let page = fs::read_to_string(folder.join("report.html")).expect("a report");
    let (_, rest) = page.split_once("id=\"data\">").expect("the data element");
    serde_json::from_str(rest.split_once("</script>").expect("its end").0).expect("JSON")
}

#[test]
fn mechanisms_are_listed_by_the_names_of_their_constructors() {
    let list = text(&["list"]);
    assert!(list.contains("wiper  Windscreen wiper\n"), "{list}");
    // A text without a title has the name of the mechanism.
    assert!(list.contains("cam    Follower\n"), "{list}");
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
fn several_mechanisms_of_a_file_are_listed_and_one_with_functions_is_referred_to_a_crate() {
    let file = format!("{}/examples/wiper.rs", env!("CARGO_MANIFEST_DIR"));
    let failed = |arguments: &[&str], code: i32| {
        let output = wiper(arguments);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{said}");
        said
    };
    let said = failed(&["run", &file], 2);
    assert!(said.contains(&format!("name one:\n  {file}:Wiper\n  {file}:Follower\n")), "{said}");
    let said = failed(&["run", &format!("{file}:Follower")], 1);
    assert!(said.contains("`lift`") && said.contains("mbs new NAME"), "{said}");
    let said = failed(&["compare", &format!("{file}:Wiper")], 2);
    assert!(said.contains("name one of `mbs list`"), "{said}");
}

#[test]
fn a_misspelt_name_gets_a_proposal() {
    let output = wiper(&["run", "wper"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("did you mean `wiper`?"), "{said}");
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
