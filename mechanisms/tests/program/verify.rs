//! The cross-checks and the emitted code.

use super::*;

#[test]
fn the_emitted_code_is_printed() {
    let text = standard_output(mbs(&["expand", "four_bar"]));
    for part in ["pub struct FourBar", "fn phi_q", "fn gamma", "impl"] {
        assert!(text.contains(part), "{part} is missing");
    }
    assert!(text.lines().count() > 100);
}

#[test]
fn verify_confirms_every_mechanism_by_its_name() {
    let text = standard_output(mbs(&["verify", "--all", "--states", "2"]));
    assert!(!text.contains("DIFFERS"), "{text}");
    for name in ["CamLaw", "FourBar", "Andrews"] {
        assert!(text.contains(name), "{name}: {text}");
    }
}

#[test]
fn verify_prints_the_largest_error_of_each_function() {
    let text = standard_output(mbs(&["verify", "slider_crank"]));
    for part in ["SliderCrank at 1000 states", "Φ_q", "Φ_tt", "γ", "d² output/dt²", "agrees (bound 1e-13)"]
    {
        assert!(text.contains(part), "{part} is missing in\n{text}");
    }
    let first = BufReader::new(text.as_bytes()).lines().next().expect("a line").expect("UTF-8");
    assert!(first.contains("as a part of the row's scale"));
}

#[test]
fn verify_without_python_names_the_cure() {
    let output = Command::new(env!("CARGO_BIN_EXE_mbs-catalogue"))
        .args(["verify", "four_bar"])
        .env("MBS_PYTHON", "no-such-python")
        .output()
        .expect("the program starts");
    let message = failure(output, 1);
    assert!(message.contains("install Python 3") && message.contains("MBS_PYTHON"), "{message}");
}
