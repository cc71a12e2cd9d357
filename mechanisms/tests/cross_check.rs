//! Emitted code against CasADi and 50 digits. Definitions are printed from the same text by the second back end, or
//! typed by hand from the lecture.

use std::fs;
use std::path::{Path, PathBuf};

use mbs_workbench::verify::compare::compare;
use mbs_workbench::verify::{
    DIGITS_STATES, Oracle, STATES, Summary, VerifyError, verify, verify_against, verify_digits,
};
use mechanisms::CATALOGUE;

fn oracle() -> Oracle {
    Oracle::new(&|_| ()).unwrap_or_else(|error| panic!("{error}"))
}

fn by_hand(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/casadi").join(name).with_extension("py")
}

#[test]
fn casadi_confirms_every_function_of_every_mechanism() {
    let oracle = oracle();
    let mut summary = Summary::default();
    for card in CATALOGUE.fixed() {
        let agreement = verify(card, &oracle, STATES).unwrap_or_else(|error| panic!("{error}"));
        assert!(agreement.holds(), "{agreement}");
        assert!(agreement.states >= 1000 && agreement.functions.len() >= 9);
        summary.add(agreement);
    }
    println!("{summary}");
}

#[test]
fn fifty_digits_confirm_every_function_of_every_mechanism() {
    let oracle = oracle();
    let mut summary = Summary::default();
    for card in CATALOGUE.fixed() {
        let agreement = verify_digits(card, &oracle, DIGITS_STATES).unwrap_or_else(|error| panic!("{error}"));
        assert!(agreement.holds(), "{agreement}");
        // A square mechanism has N² + 5N values in addition to its outputs; few of them may be uncertain at kinks.
        let n = card.equations().coordinates().len();
        assert!(agreement.values * 10 > 9 * DIGITS_STATES * n * (n + 5), "{agreement}");
        summary.add(agreement);
    }
    println!("{summary}");
}

#[test]
fn definitions_typed_by_hand_confirm_every_mechanism() {
    let oracle = oracle();
    for card in CATALOGUE.fixed() {
        let agreement = verify_against(card, &by_hand(&card.file_name()), &oracle);
        let agreement = agreement.unwrap_or_else(|error| panic!("{}: {error}", card.name()));
        println!("{agreement}");
        assert!(agreement.holds() && agreement.states >= 1000, "{agreement}");
    }
}

/// The control of the tests above: every one of these slips of the pen must be detected.
#[test]
fn a_slip_in_a_definition_is_found() {
    let slips = [
        ("four_bar", "- L3 * ca.sin(phi3)", "+ L3 * ca.sin(phi3)"),
        ("four_bar", "L5 * ca.cos(alpha + phi2)", "L5 * ca.cos(alpha - phi2)"),
        ("loop_relative", "psi1 + psi2 + psi3]", "psi1 + psi3]"),
        ("loop_length", "- L3 * ca.cos(guide)", "+ L3 * ca.cos(guide)"),
        ("open_chain", "ca.cos(2 * omega * t)", "ca.cos(omega * t)"),
        ("open_chain", "der(end[1])", "der(end[0])"),
        ("slider_crank", "- offset,", "+ offset,"),
        ("four_bar_natural", "- c * (xb - xa) + s", "- c * (xb - xa) - s"),
        ("determinant_guide", "[*b, 1], [*c, 1]]", "[*c, 1], [*b, 1]]"),
        ("stephenson", "- n * c]", "+ n * c]"),
        ("cam_flat", "2 * ca.sin(c) - ca.sin(2 * c)", "2 * ca.sin(c) + ca.sin(2 * c)"),
        ("planetary_gear", "rs + 2 * rp", "rs + rp"),
        ("slider_crank_scenes:TelescopingRod", "- L - reach", "- L + reach"),
    ];
    let oracle = oracle();
    for (name, right, wrong) in slips {
        let card = CATALOGUE.find(name).expect("in the list");
        let text = fs::read_to_string(by_hand(&card.file_name())).expect("a definition");
        assert!(text.contains(right), "{name}: {right}");
        let mut mechanism = card.equations();
        let agreement = compare(mechanism.as_mut(), &oracle, &text.replace(right, wrong), 50);
        assert!(!agreement.expect("values").holds(), "{name}: {wrong}");
    }
}

#[test]
fn quantities_that_cannot_be_compared_say_why() {
    let oracle = oracle();
    let four_bar = CATALOGUE.find("four_bar").expect("in the list");
    let missing = verify_against(four_bar, Path::new("no/such/file.py"), &oracle);
    assert!(matches!(missing, Err(VerifyError::File { .. })));
    let another = verify_against(four_bar, &by_hand("slider_crank"), &oracle).expect_err("another mechanism");
    assert!(another.to_string().contains("`SliderCrank` has 3 coordinates"), "{another}");
}
