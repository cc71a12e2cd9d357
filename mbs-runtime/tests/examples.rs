//! Programs in `examples`: each runs and prints what its documentation promises.

use std::path::Path;
use std::process::Command;

/// Output of an example; it is compiled first where a test of this file alone is built.
fn output(example: &str) -> String {
    let here = std::env::current_exe().expect("the test's own path");
    let folder = here.parent().and_then(Path::parent).expect("the profile's folder").join("examples");
    let program = folder.join(format!("{example}{}", std::env::consts::EXE_SUFFIX));
    if !program.exists() {
        let built = Command::new(env!("CARGO"))
            .args(["build", "--quiet", "-p", "mbs-runtime", "--examples"])
            .status();
        assert!(built.is_ok_and(|status| status.success()), "the examples do not compile");
    }
    let run =
        Command::new(&program).output().unwrap_or_else(|error| panic!("{}: {error}", program.display()));
    let text = String::from_utf8(run.stdout).expect("UTF-8");
    assert!(run.status.success(), "{example} fails:\n{text}");
    text
}

#[test]
fn the_four_bar_prints_what_the_readme_shows() {
    // A package has it beside its manifest.
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |path: &str| std::fs::read_to_string(here.join(path));
    let readme = read("../README.md").or_else(|_| read("README.md")).expect("the README");
    let printed = output("four_bar");
    assert_eq!(printed.lines().count(), 6);
    assert!(readme.contains(&format!("```text\n{printed}```")), "README.md does not show\n{printed}");
}

#[test]
fn the_control_loop_comes_back_in_its_assembly() {
    let printed = output("control_loop");
    assert!(printed.contains("assembly kept: true") && !printed.contains("command held"), "{printed}");
}

#[test]
fn the_falling_crank_keeps_its_energy() {
    let printed = output("slider_crank_dynamics");
    let defect = printed.lines().find_map(|line| line.strip_prefix("energy not accounted for: "));
    let defect: f64 = defect.and_then(|text| text.strip_suffix(" J")?.parse().ok()).expect("a defect");
    assert!(defect < 1e-9, "{printed}");
}

#[test]
fn the_cam_follows_its_table() {
    let printed = output("cam_table");
    let error = printed.split("largest error of the lift ").nth(1).and_then(|rest| rest.split(' ').next());
    let error: f64 = error.and_then(|text| text.parse().ok()).expect("an error");
    // Far below a micrometre: the spline's error falls with the sixth power of ten degrees.
    assert!(error < 1e-8, "{printed}");
}

#[test]
fn seven_of_eight_designs_turn_around() {
    let printed = output("batch_design");
    assert_eq!(printed.matches('°').count(), 7, "{printed}");
    assert!(printed.contains("0.18 m  does not turn around"), "{printed}");
}

#[test]
fn scenes_share_their_parameters() {
    let printed = output("scenes");
    assert!(
        printed.contains("engine: ") && printed.contains("pump: the motor needs up to 0.849 N m"),
        "{printed}"
    );
}
